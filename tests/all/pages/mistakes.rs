//! The table of typical mistakes in `docs/scene.md`: each message is what `check` says of it.

use assert_cmd::Command;

/// A row: what is written, in TOML of a table of its own, and what is said.
#[derive(Debug)]
struct Row {
    written: Vec<String>,
    said: String,
}

/// The rows below the heading.
fn rows(page: &str) -> Vec<Row> {
    let (_, below) = page.split_once("## Typical mistakes").expect("the heading");
    let lines = below
        .lines()
        .skip_while(|line| !line.starts_with("|---"))
        .skip(1)
        .take_while(|line| line.starts_with('|'));
    lines.map(row).collect()
}

fn row(line: &str) -> Row {
    let (written, said) = line.trim_matches('|').split_once(" | ").expect("two cells");
    // A span with backticks in it stands between two of them and a space.
    let said = said.trim();
    let said =
        said.strip_prefix("`` ").and_then(|said| said.strip_suffix(" ``")).unwrap_or(said.trim_matches('`'));
    let spans = written.split('`').skip(1).step_by(2);
    Row { written: spans.map(String::from).collect(), said: said.to_string() }
}

/// The smallest scene in which it is written: each key in the table that it belongs to.
fn scene(written: &[String]) -> String {
    let has = |key: &str| written.iter().any(|line| line.starts_with(key));
    let of = |keys: &[&str]| {
        let in_it = written.iter().filter(|line| keys.iter().any(|key| line.starts_with(key)));
        in_it.map(|line| format!("{line}\n")).collect::<String>()
    };
    let motion = of(&["kind ="]);
    let output = of(&["to =", "pace ="]);
    let others = written.iter().filter(|line| !motion.contains(&**line) && !output.contains(&**line));
    let mut scene = String::new();
    if !written.is_empty() {
        scene += "duration = \"1 s\"\n";
    }
    if !motion.is_empty() {
        scene += &format!("[[motion]]\nduration = \"1 s\"\n{motion}");
    }
    scene += "[gyro]\n";
    if !has("rate =") {
        scene += "rate = \"100 Hz\"\n";
    }
    scene += &others.map(|line| format!("{line}\n")).collect::<String>();
    if !output.is_empty() {
        scene += &format!("[[output]]\n{output}");
    }
    scene
}

/// What `check` says, each message without its place.
fn said(scene: &str) -> Vec<String> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("s.toml"), scene).unwrap();
    let mut check = Command::cargo_bin("ratetable").unwrap();
    let output = check.current_dir(folder.path()).args(["check", "s.toml"]).output().unwrap();
    assert_eq!(output.status.code(), Some(2), "{scene}");
    let text = String::from_utf8(output.stderr).unwrap();
    text.lines().map(|line| line.split_once(": ").map_or(line, |(_, said)| said).to_string()).collect()
}

fn wrong(page: &str) -> Vec<String> {
    let faults = rows(page).into_iter().filter_map(|row| {
        let scene = scene(&row.written);
        let said = said(&scene);
        (!said.contains(&row.said))
            .then(|| format!("quoted: {}\nsaid:   {}\nof\n{scene}", row.said, said.join("\n        ")))
    });
    faults.collect()
}

const PAGE: &str = include_str!("../../../docs/scene.md");

#[test]
fn each_message_of_the_table_of_typical_mistakes_is_what_is_said() {
    assert!(rows(PAGE).len() >= 12, "{:?}", rows(PAGE));
    assert!(wrong(PAGE).is_empty(), "{}", wrong(PAGE).join("\n"));
}

#[test]
fn a_message_that_is_another_is_found() {
    let page = PAGE.replacen("has no unit", "no unit at all is there", 1);
    assert_eq!(wrong(&page).len(), wrong(PAGE).len() + 1);
}
