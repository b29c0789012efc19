//! `ratetable generate`: a dataset.

use super::{Refusal, Verdict};
use crate::report::Report;
use crate::scene::Plan;
use crate::session::Outcome;
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// A TOML file or the name of a built-in scene
    scene: String,
    /// The folder to make
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Override one key of the scene, such as gyro.rate='8 kHz'
    #[arg(long = "set", value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Draw the paper's four figures as SVG too
    #[arg(long)]
    figures: bool,
    /// Replace the folder if there is one
    #[arg(long)]
    force: bool,
}

pub fn generate(arguments: &Arguments) -> Result<Verdict, Refusal> {
    let _ = (&arguments.scene, &arguments.out, &arguments.set, arguments.figures, arguments.force);
    Err(Refusal("merging".into()))
}

pub fn may_write(_dir: &Path, _force: bool) -> Result<(), Refusal> { Ok(()) }
pub fn after_run(_: &Plan, _: &Outcome, _: &Report, _: &Path, _: bool) -> Result<(), Refusal> { Ok(()) }
