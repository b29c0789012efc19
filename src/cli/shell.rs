//! `ratetable completions` and `ratetable man`: shell completions and manual pages from the command line's definition.

use super::{Refusal, Verdict, say, tell};
use crate::dataset::{self, Holds};
use clap::{Command, CommandFactory};
use clap_complete::Shell;
use clap_mangen::Man;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct CompletionsArguments {
    /// The shell
    shell: Shell,
}

#[derive(Debug, clap::Args)]
pub struct ManArguments {
    /// Write a page for the program and one for each command into this folder, which must be new or empty
    /// [default: the program's page on standard output]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

pub fn completions(arguments: &CompletionsArguments) -> Result<Verdict, Refusal> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut super::Arguments::command(), NAME, &mut script);
    say(&String::from_utf8_lossy(&script))?;
    Ok(Verdict::Fine)
}

pub fn man(arguments: &ManArguments) -> Result<Verdict, Refusal> {
    let mut program = super::Arguments::command();
    program.build();
    let Some(dir) = &arguments.out else {
        say(&String::from_utf8_lossy(&page(program)?))?;
        return Ok(Verdict::Fine);
    };
    let mut files = Vec::new();
    for command in program.get_subcommands().filter(|command| command.get_name() != "help") {
        let name = format!("{NAME}-{}.1", command.get_name());
        files.push((name, page(command.clone())?));
    }
    files.push((format!("{NAME}.1"), page(program)?));
    let files: Vec<_> = files.iter().map(|(name, page)| (name.as_str(), page.clone())).collect();
    dataset::put_all(dir, false, Holds::Manual, &files)?;
    tell(&format!("{}: {} pages", dir.display(), files.len()));
    Ok(Verdict::Fine)
}

/// What the program is called on a command line.
const NAME: &str = "ratetable";

/// A command's page, in roff.
fn page(command: Command) -> Result<Vec<u8>, Refusal> {
    let mut page = Vec::new();
    Man::new(command).render(&mut page)?;
    Ok(page)
}
