//! `ratetable study`: what is measured about methods, samples and noise. One file a study.

mod accuracy;
mod allan;
mod cost;
mod filters;
mod normals;
mod outcome;
mod parsimony;
mod picture;
mod stability;

use super::show::PAGE;
use super::terminal::Stream;
use super::{Refusal, Verdict, say, tell};
use crate::dataset::{self, Holds};
use crate::live::{self, About, End, Paths};
use crate::scene::{Plan, builtin, nearest};
use outcome::Outcome;
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// accuracy, stability, filters, cost, normals, allan, parsimony or all (default); or the scene directly
    study: Option<String>,
    /// A TOML file or the name of a built-in scene: joins the built-in motions and scenes, and its samples' cost is measured
    scene: Option<String>,
    /// Write the numbers as CSV and JSON and the charts as SVG into this folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Fewer motions, scenes, filters and seeds at 100 Hz and 1 kHz, a tenth of the drift steps, and few cost rounds
    #[arg(long)]
    quick: bool,
    /// Print every row as JSON on standard output
    #[arg(long)]
    json: bool,
    /// Replace the files of an earlier study in the folder
    #[arg(long)]
    force: bool,
}

/// A study: what it writes and how it runs.
struct Study {
    /// As users call it.
    name: &'static str,
    /// The files that it writes besides its JSON.
    files: &'static [&'static str],
    run: fn(&Request) -> Result<Outcome, Refusal>,
}

/// What a study is asked for.
struct Request<'a> {
    quick: bool,
    scene: Option<&'a Plan>,
    /// What the user calls the scene: a file or a built-in name.
    source: Option<&'a str>,
    /// One study is asked for, so a scene that does not suit it is a mistake.
    is_alone: bool,
}

/// Every study, in the order of `all`.
static STUDIES: [&Study; 7] = [
    &accuracy::STUDY,
    &stability::STUDY,
    &filters::STUDY,
    &cost::STUDY,
    &normals::STUDY,
    &allan::STUDY,
    &parsimony::STUDY,
];

/// For all of them.
const ALL: &str = "all";

pub fn study(arguments: &Arguments) -> Result<Verdict, Refusal> {
    let (studies, scene) = asked(arguments)?;
    let plan = scene.map(|scene| Plan::load(scene, &[])).transpose()?;
    if let Some(dir) = &arguments.out {
        let names = studies.iter().flat_map(|study| {
            study.files.iter().map(|file| file.to_string()).chain([format!("{}.json", study.name)])
        });
        let names = names.chain([PAGE.to_string()]);
        dataset::may_write(dir, arguments.force, Holds::Study, &names.collect::<Vec<_>>())?;
    }
    let request =
        Request { quick: arguments.quick, scene: plan.as_ref(), source: scene, is_alone: studies.len() == 1 };
    let outcomes = studies.iter().map(|study| (study.run)(&request)).collect::<Result<Vec<_>, _>>()?;
    if let Some(dir) = &arguments.out {
        let mut files: Vec<(String, Vec<u8>)> = Vec::new();
        for (study, outcome) in studies.iter().zip(&outcomes) {
            files.extend(outcome.files.iter().cloned());
            files.push((
                format!("{}.json", study.name),
                outcome::json(request.quick, [outcome])?.into_bytes(),
            ));
        }
        files.push((PAGE.into(), page(&studies, &outcomes, scene).into_bytes()));
        let files: Vec<_> = files.iter().map(|(name, bytes)| (name.as_str(), bytes.clone())).collect();
        dataset::put_all(dir, arguments.force, Holds::Study, &files)?;
        tell(&format!("{}: written", dir.display()));
    }
    if arguments.json {
        say(&outcome::json(request.quick, &outcomes)?)?;
    } else {
        let text = outcomes.iter().map(|outcome| outcome.text.as_str()).collect::<Vec<_>>().join("\n");
        say(&Stream::Out.fold(&text))?;
    }
    Ok(Verdict::Fine)
}

/// The studies as a page to ask: points to read, methods to pick.
fn page(studies: &[&Study], outcomes: &[Outcome], scene: Option<&str>) -> String {
    let names: Vec<_> = studies.iter().map(|study| study.name).collect();
    let of = scene.map_or(String::new(), |scene| format!(" of {scene}"));
    let end = End {
        ok: true,
        charts: outcomes.iter().flat_map(|outcome| outcome.charts.clone()).collect(),
        grids: outcomes.iter().flat_map(|outcome| outcome.grids.clone()).collect(),
        ..End::default()
    };
    live::page(&About::of_data("study", format!("{}{of}", names.join(", "))), &Paths::default(), &end)
}

/// Which studies, and of which scene: the first word is a study's name, or else the scene of all studies.
fn asked(arguments: &Arguments) -> Result<(Vec<&'static Study>, Option<&str>), Refusal> {
    let (first, second) = (arguments.study.as_deref(), arguments.scene.as_deref());
    let Some(word) = first.filter(|word| *word != ALL) else { return Ok((STUDIES.to_vec(), second)) };
    if let Some(study) = STUDIES.into_iter().find(|study| study.name == word) {
        return Ok((vec![study], second));
    }
    let studies = || STUDIES.into_iter().map(|study| study.name).chain([ALL]);
    let is_scene = builtin::text(word).is_some() || Path::new(word).exists();
    if is_scene && second.is_none() {
        return Ok((STUDIES.to_vec(), Some(word)));
    }
    let names = studies().collect::<Vec<_>>().join(", ");
    let near = nearest(word, studies().chain(builtin::SCENES.map(|(name, _)| name)));
    let near = near.map_or(String::new(), |near| format!("; did you mean `{near}`?"));
    Err(Refusal(match second {
        None => format!("`{word}` is neither a study ({names}) nor a scene, built in or a file{near}"),
        Some(scene) if is_scene => {
            format!(
                "`{word}` is a scene, so `{scene}` is a second one: write a study ({names}), then one scene"
            )
        }
        Some(_) => format!("`{word}` is not a study ({names}){near}"),
    }))
}
