//! The command line: one file a command.

mod check;
mod clash;
mod demo;
mod examples;
mod generate;
mod list;
mod listen;
mod options;
mod progress;
mod run;
mod score;
mod sheet;
mod shell;
mod show;
mod study;
mod summary;
mod terminal;
mod timing;

use clap::{Parser, Subcommand};
use std::io::{self, ErrorKind, Write};
use std::process::ExitCode;

/// A rate table in software: plays a scene and writes its gyro, accelerometer and magnetometer readings, on time, to
/// a flight controller, or makes a dataset of them with exact truth.
#[derive(Debug, Parser)]
#[command(name = "ratetable", version, about, propagate_version = true, arg_required_else_help = true, after_help = examples::PROGRAM)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Stream a scene in real time; without a link, run a demonstration over a pty with an AHRS on the other end
    #[command(after_help = examples::RUN)]
    Run(run::Arguments),
    /// Measure a stream's lateness and jitter, at both ends and against a bare timer
    #[command(after_help = examples::TIMING)]
    Timing(timing::Arguments),
    /// Make a dataset: readings, exact truth, manifest
    #[command(after_help = examples::GENERATE)]
    Generate(generate::Arguments),
    /// Read a scene and show the plan: sensors, noise, bytes a second, warnings
    #[command(after_help = examples::CHECK)]
    Check(check::Arguments),
    /// Measure any stream: rates, intervals, losses and damage of each sensor
    #[command(after_help = examples::LISTEN)]
    Listen(listen::Arguments),
    /// Score recorded attitude estimates and filters against the truth: errors, delay, axis and order mistakes
    #[command(after_help = examples::SCORE)]
    Score(score::Arguments),
    /// Compare the attitude methods: error against cost on many motions, and what makes each fail
    #[command(after_help = examples::STUDY)]
    Study(study::Arguments),
    /// List scenes, parts, motions, methods, keys, protocols, targets, links, formats, fields, logs or ports
    #[command(after_help = examples::LIST)]
    List(list::Arguments),
    /// Print a shell's completions of this command line
    #[command(after_help = examples::COMPLETIONS)]
    Completions(shell::CompletionsArguments),
    /// Print the manual page, or write one for each command
    #[command(after_help = examples::MAN)]
    Man(shell::ManArguments),
}

/// What a command came to.
enum Verdict {
    /// Done and within limits.
    Fine,
    /// Ran, but a limit failed or samples were lost.
    Failed,
    /// The exit code of the command that was run.
    Code(u8),
}

/// Why a command could not run: the message for the user.
#[derive(Debug)]
struct Refusal(String);

impl<E: std::error::Error> From<E> for Refusal {
    /// The error and its causes, each once.
    fn from(error: E) -> Refusal {
        let mut message = error.to_string();
        let mut cause = error.source();
        while let Some(error) = cause {
            let text = error.to_string();
            if !message.contains(&text) {
                message += &format!(": {text}");
            }
            cause = error.source();
        }
        Refusal(message)
    }
}

/// Runs the program: exit code 0 = done and within limits, 1 = a limit failed or samples were lost, 2 = could not run.
pub fn main() -> ExitCode {
    let command = match Arguments::try_parse() {
        Ok(arguments) => arguments.command,
        Err(error) => return ExitCode::from(explained(&error)),
    };
    let verdict = match command {
        Command::Run(arguments) => run::run(&arguments),
        Command::Timing(arguments) => timing::timing(&arguments),
        Command::Generate(arguments) => generate::generate(&arguments),
        Command::Check(arguments) => check::check(&arguments),
        Command::Listen(arguments) => listen::listen(&arguments),
        Command::Score(arguments) => score::score(&arguments),
        Command::Study(arguments) => study::study(&arguments),
        Command::List(arguments) => list::list(&arguments),
        Command::Completions(arguments) => shell::completions(&arguments),
        Command::Man(arguments) => shell::man(&arguments),
    };
    match verdict {
        Ok(Verdict::Fine) => ExitCode::SUCCESS,
        Ok(Verdict::Failed) => ExitCode::from(1),
        Ok(Verdict::Code(code)) => ExitCode::from(code),
        Err(Refusal(message)) => {
            tell(&message);
            ExitCode::from(2)
        }
    }
}

/// Shows help that was asked for, or what is wrong with the arguments: the exit code.
fn explained(error: &clap::Error) -> u8 {
    if error.kind() == clap::error::ErrorKind::InvalidUtf8 {
        unreadable();
        return 2;
    }
    let shown = error.print();
    if error.use_stderr() {
        return 2;
    }
    match written(shown) {
        Ok(()) => 0,
        Err(Refusal(message)) => {
            tell(&message);
            2
        }
    }
}

/// Names the arguments that are not UTF-8.
fn unreadable() {
    let broken = std::env::args_os().enumerate().skip(1).filter(|(_, argument)| argument.to_str().is_none());
    for (i, argument) in broken {
        tell(&format!(
            "argument {i}, {argument:?}, is not UTF-8: scenes, keys and links need UTF-8 names, and only the --out folder may have another; rename the file, or set the terminal to UTF-8"
        ));
    }
}

/// Writes a result to standard output.
///
/// # Errors
/// It was not written, for example because the disk is full. A reader that has left, as
/// `head` does, is not a failure.
fn say(text: &str) -> Result<(), Refusal> {
    let mut out = io::stdout().lock();
    written(out.write_all(text.as_bytes()).and_then(|()| out.flush()))
}

fn written(result: io::Result<()>) -> Result<(), Refusal> {
    match result {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Refusal(format!("cannot write to standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Writes a line for a person to standard error. If that is closed or full the line is lost: the exit
/// code gives the command's outcome.
fn tell(line: &str) {
    let _ = writeln!(io::stderr().lock(), "{}", line.strip_suffix('\n').unwrap_or(line));
}
