//! A command must not overwrite what it reads, or write two outputs to one place: refused before anything is
//! touched.

use super::Refusal;
use crate::link::{Address, Identity};
use crate::scene::{Output, Plan};
use std::path::{Path, PathBuf};

/// What a command writes besides its outputs.
#[derive(Default)]
pub struct Besides<'a> {
    /// The folder of its results.
    pub out: Option<&'a Path>,
    /// The ground station that it speaks to.
    pub ground: Option<&'a Address>,
    /// Whether standard output gets a report.
    pub report: bool,
}

/// Refuses outputs that are one another, a file that the scene is read from, or in the output folder.
pub fn outputs(plan: &Plan, outputs: &[Output], besides: &Besides<'_>) -> Result<(), Refusal> {
    let out = besides.out.map(|out| (out, Identity::of(out)));
    for (i, output) in outputs.iter().enumerate() {
        let (to, address) = (&output.to, &output.to.address);
        let other = outputs[..i].iter().find(|other| other.to.address.is_same(address));
        if let Some(other) = other {
            return Err(Refusal(format!(
                "{} and {to} go to the same place and their packets would mix: give each its own place",
                other.to
            )));
        }
        if besides.ground.is_some_and(|ground| ground.is_same(address)) {
            return Err(Refusal(format!("{to} goes to the port that --qgc uses: give each its own port")));
        }
        if besides.report && !address.is_stdout() && address.is_same(&Address::Stdout) {
            return Err(Refusal(format!(
                "{to} is the file that standard output and the report go to: give each its own file"
            )));
        }
        let Some(identity) = address.identity() else { continue };
        if let Some(file) = plan.files.iter().find(|file| Identity::of(file).is(&identity)) {
            let file = file.display();
            return Err(Refusal(format!(
                "{to} would replace {file}, which the scene reads: name another file"
            )));
        }
        if let Some((out, _)) = out.as_ref().filter(|(_, out)| identity.is_within(out)) {
            let out = out.display();
            return Err(Refusal(format!(
                "{to} is in the output folder {out}, which holds only a dataset's files: name a file outside it"
            )));
        }
    }
    Ok(())
}

/// Refuses to replace a file that the scene is read from: `replaced` are the files that would be.
pub fn folder(plan: &Plan, replaced: &[PathBuf]) -> Result<(), Refusal> {
    for file in &plan.files {
        let identity = Identity::of(file);
        if let Some(at) = replaced.iter().find(|at| at.exists() && Identity::of(at).is(&identity)) {
            return Err(Refusal(format!(
                "{} would be replaced, but the scene reads it: name another folder",
                at.display()
            )));
        }
    }
    Ok(())
}
