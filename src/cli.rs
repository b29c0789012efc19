//! The command line: one file a command.

mod budget;
mod check;
mod demo;
mod examples;
mod generate;
mod list;
mod listen;
mod options;
mod progress;
mod run;
mod score;
mod shell;
mod study;
mod summary;
mod terminal;
mod timing;

use clap::error::ErrorKind;
use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// A rate table in software: plays a scene and writes its gyro, accelerometer and magnetometer readings, on time, to
/// a flight controller; or makes a dataset of them with exact truth.
#[derive(Debug, Parser)]
#[command(name = "ratetable", version, about, propagate_version = true, arg_required_else_help = true, after_help = examples::PROGRAM)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Stream a scene in real time; without a link, demonstrate it on a pty pair with an AHRS on the other end
    #[command(after_help = examples::RUN)]
    Run(run::Arguments),
    /// Measure how late and how even a stream is, at both ends and against a bare timer
    #[command(after_help = examples::TIMING)]
    Timing(timing::Arguments),
    /// Make a dataset: readings, exact truth, manifest
    #[command(after_help = examples::GENERATE)]
    Generate(generate::Arguments),
    /// Read a scene and show the plan: sensors, noise, bytes a second, warnings
    #[command(after_help = examples::CHECK)]
    Check(check::Arguments),
    /// Measure anybody's stream: rates, intervals, losses and damage of each sensor
    #[command(after_help = examples::LISTEN)]
    Listen(listen::Arguments),
    /// Judge recorded attitude estimates and filters against the truth: errors, delay, mistakes of axes and order
    #[command(after_help = examples::SCORE)]
    Score(score::Arguments),
    /// Compare the attitude methods: error against cost on many motions, and what breaks each
    #[command(after_help = examples::STUDY)]
    Study(study::Arguments),
    /// Show what there is: scenes, parts, motions, methods, keys, protocols, targets, links, formats, fields, logs, ports
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
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => return unreadable(&error),
    };
    let verdict = match arguments.command {
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
            eprintln!("{message}");
            ExitCode::from(2)
        }
    }
}

/// Says what is wrong with the arguments, or the help that they ask for.
fn unreadable(error: &clap::Error) -> ExitCode {
    if error.kind() != ErrorKind::InvalidUtf8 {
        error.exit()
    }
    let broken = std::env::args_os().enumerate().skip(1).filter(|(_, argument)| argument.to_str().is_none());
    for (i, argument) in broken {
        eprintln!(
            "argument {i}, {argument:?}, is no UTF-8: scenes, keys and links are named in UTF-8, and only the folder of --out may be called otherwise; rename the file, or set the terminal to UTF-8"
        );
    }
    ExitCode::from(2)
}

/// Writes to standard output; a reader that has left is no failure of ours.
fn say(text: &str) {
    use std::io::Write;
    let mut out = std::io::stdout().lock();
    let _ = out.write_all(text.as_bytes()).and_then(|()| out.flush());
}
