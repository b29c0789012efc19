//! The rooms of the program and the arrows between them, read from the sources: an arrow that is not in the table
//! fails, with the file and the path that makes it.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::path::{Path, PathBuf};
use syn::visit::{self, Visit};

/// Rooms without a view of the program: numbers, units, time, frames, declared keys and random streams. Any room
/// may use them, and they use one another as listed.
const FOUNDATION: [&str; 7] = ["double", "quantity", "time", "keys", "random", "geometry", "table"];

/// Each room and those it uses besides the foundation, as `docs/architecture.md` draws them.
const ARROWS: &[(&str, &[&str])] = &[
    ("double", &[]),
    ("time", &["double"]),
    ("quantity", &["double"]),
    // Normal numbers are made with the processor's widest vectors, which only `os` may ask for; so are the columns of
    // motion, sensor and study.
    ("random", &["double", "os"]),
    ("geometry", &[]),
    // A key is declared with the kind of quantity it takes, and a value may be a time or an attitude.
    ("keys", &["double", "quantity", "time", "geometry"]),
    // A column that is not there has a nearest name, and a table without times a rate.
    ("table", &["keys", "time"]),
    // The system calls, the only place of `unsafe`.
    ("os", &[]),
    // Whether a signal is ignored is the kernel's to say.
    ("interrupt", &["os"]),
    ("earth", &[]),
    // Motion and sensor declare their keys as data, so they need `keys` and `quantity`; a sensor's streams are
    // named by it and seeded from outside, so it needs `random`: all three are foundation.
    ("motion", &["os"]),
    // A receiver's fix is a place, and a barometer's pressure that of an altitude.
    ("sensor", &["earth", "os"]),
    ("schedule", &[]),
    // An output names its protocol and its link, whose spellings and parameters are theirs.
    ("scene", &["earth", "motion", "sensor", "wire", "link"]),
    // Where the vehicle is follows from where the scene begins.
    ("player", &["scene", "motion", "sensor", "schedule", "earth"]),
    // A driver sets the sensors of a plan, which a player plays.
    ("bus", &["player", "scene", "sensor"]),
    // The sizes of effects follow from the plan: its motion, place, sensors and their parts. The player's error-free
    // reading is what they are sizes beside, and a report's short numbers stand in their notes.
    ("effects", &["scene", "player", "motion", "sensor", "earth", "report"]),
    ("clock", &[]),
    // Some packets carry the truth. A config packet is in scene time and SYSTEM_TIME carries the scene's date; the
    // load is counted over ticks.
    ("wire", &["motion", "sensor", "earth", "schedule"]),
    // A pty that plays a UART takes its time.
    ("link", &["os", "clock"]),
    ("score", &[]),
    ("filters", &[]),
    // The report of a run holds its score, plain data.
    ("report", &["score"]),
    // The scene's plan, its trajectory and its sensors are what a session plays and reports on.
    (
        "session",
        &[
            "bus",
            "player",
            "wire",
            "clock",
            "link",
            "score",
            "scene",
            "sensor",
            "motion",
            "report",
            "os",
            "interrupt",
        ],
    ),
    ("listen", &["link", "wire", "clock", "sensor", "report", "interrupt"]),
    // A dataset writes the plan as well as the readings: axes, rates, values drawn.
    ("dataset", &["player", "scene", "sensor", "motion", "parallel", "ros"]),
    // Whether a scene needs a term is for the filters to say.
    ("study", &["player", "motion", "scene", "sensor", "filters", "parallel", "os"]),
    ("parallel", &[]),
    ("ros", &[]),
    // What happens is shown as events of a session or of what listens; the scene is played again for its readings.
    ("live", &["player", "scene", "motion", "sensor", "session", "listen", "report", "ros"]),
    (
        "cli",
        &[
            "scene",
            "effects",
            "filters",
            "bus",
            "session",
            "listen",
            "live",
            "dataset",
            "score",
            "study",
            "report",
            "motion",
            "sensor",
            "wire",
            "link",
            "os",
            "clock",
            "earth",
            "parallel",
            "interrupt",
        ],
    ),
];

/// What of the outside only some rooms may touch.
const OUTSIDE: &[(&str, &[&str])] = &[
    // The demonstration of `cli` runs a firmware, which has a processor of its own; `parallel` spreads jobs that have
    // nothing to do with one another over the processors; `clock` parks the thread that waits on it.
    ("std::thread", &["session", "link", "live", "cli", "parallel", "clock", "interrupt"]),
    // `os` reads what the kernel shows as files of its own: who holds a port, what a device is.
    ("std::fs", &["scene", "dataset", "link", "os", "score"]),
    ("std::net", &["link", "live"]),
    ("println!", &["cli"]),
    ("print!", &["cli"]),
];

/// Something that a source does and may not.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Breach {
    file: String,
    what: String,
}

impl fmt::Display for Breach {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.file, self.what)
    }
}

/// What one source uses: rooms of the crate, things outside it, `unsafe`.
#[derive(Debug, Default)]
struct Uses {
    rooms: BTreeSet<String>,
    outside: BTreeSet<String>,
    is_unsafe: bool,
    /// How deep the module lies that is being read: `super` out of it this often is the crate's root.
    depth: usize,
}

impl Uses {
    /// Of a source whose module lies `depth` below the crate's root.
    fn of(text: &str, depth: usize) -> Uses {
        let mut uses = Uses { depth, ..Uses::default() };
        uses.visit_file(&syn::parse_file(text).expect("a source that compiles parses"));
        uses
    }

    /// Takes a path in, segment by segment.
    fn path(&mut self, segments: &[String]) {
        let ups = segments.iter().take_while(|segment| *segment == "super").count();
        let from_root = match segments.first().map(String::as_str) {
            Some("crate" | "ratetable") => segments.get(1),
            Some("super") if ups == self.depth => segments.get(ups),
            Some("self") if self.depth == 0 => segments.get(1),
            _ => None,
        };
        self.rooms.extend(from_root.cloned());
        if let [std, module, ..] = segments
            && ["std", "core"].contains(&std.as_str())
        {
            self.outside.insert(format!("std::{module}"));
        }
    }

    /// Every path of a `use`, nested groups included.
    fn tree(&mut self, tree: &syn::UseTree, before: &[String]) {
        let with = |ident: &syn::Ident| [before, &[ident.to_string()]].concat();
        match tree {
            syn::UseTree::Path(path) => self.tree(&path.tree, &with(&path.ident)),
            syn::UseTree::Name(name) => self.path(&with(&name.ident)),
            syn::UseTree::Rename(rename) => self.path(&with(&rename.ident)),
            syn::UseTree::Glob(_) => self.path(before),
            syn::UseTree::Group(group) => group.items.iter().for_each(|tree| self.tree(tree, before)),
        }
    }
}

/// Whether an item is compiled for tests alone.
pub(super) fn is_for_tests(item: &syn::Item) -> bool {
    let attributes: &[syn::Attribute] = match item {
        syn::Item::Mod(item) => &item.attrs,
        syn::Item::Use(item) => &item.attrs,
        syn::Item::Fn(item) => &item.attrs,
        syn::Item::Impl(item) => &item.attrs,
        _ => &[],
    };
    attributes.iter().any(|attribute| {
        let is_test = |tokens: &syn::MetaList| {
            tokens.tokens.to_string().split(|c: char| !c.is_alphanumeric()).any(|word| word == "test")
        };
        attribute.path().is_ident("cfg") && attribute.meta.require_list().is_ok_and(is_test)
    })
}

impl<'ast> Visit<'ast> for Uses {
    fn visit_item(&mut self, item: &'ast syn::Item) {
        if !is_for_tests(item) {
            visit::visit_item(self, item);
        }
    }

    fn visit_item_mod(&mut self, module: &'ast syn::ItemMod) {
        self.depth += 1;
        visit::visit_item_mod(self, module);
        self.depth -= 1;
    }

    fn visit_item_use(&mut self, item: &'ast syn::ItemUse) {
        self.tree(&item.tree, &[]);
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        self.path(&path.segments.iter().map(|segment| segment.ident.to_string()).collect::<Vec<_>>());
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, called: &'ast syn::Macro) {
        if let Some(last) = called.path.segments.last() {
            self.outside.insert(format!("{}!", last.ident));
        }
        // What is inside is only tokens: paths in it are found by their shape, `crate` `::` `room`.
        let tokens = called.tokens.to_string();
        let words: Vec<_> = tokens
            .split_whitespace()
            .flat_map(|word| word.split_inclusive("::"))
            .map(|word| word.trim_end_matches("::"))
            .filter(|word| !word.is_empty())
            .collect();
        for pair in words.windows(2).filter(|pair| pair[0].ends_with("crate")) {
            self.path(&["crate".to_string(), pair[1].to_string()]);
        }
        visit::visit_macro(self, called);
    }

    fn visit_expr_unsafe(&mut self, expression: &'ast syn::ExprUnsafe) {
        self.is_unsafe = true;
        visit::visit_expr_unsafe(self, expression);
    }

    fn visit_item_impl(&mut self, item: &'ast syn::ItemImpl) {
        self.is_unsafe |= item.unsafety.is_some();
        visit::visit_item_impl(self, item);
    }

    fn visit_signature(&mut self, signature: &'ast syn::Signature) {
        self.is_unsafe |= matches!(signature.safety, syn::Safety::Unsafe(_));
        visit::visit_signature(self, signature);
    }
}

/// The room that a file of `src` belongs to; the crate's root and `main` wire the rooms together and are none.
fn room(file: &Path) -> Option<String> {
    let first = file.components().next()?.as_os_str().to_str()?;
    let name = first.strip_suffix(".rs").unwrap_or(first);
    (!["lib", "main"].contains(&name)).then(|| name.to_string())
}

/// How deep a file's module lies: `motion.rs` 1, `motion/circle.rs` 2, `link/mod.rs` 1.
fn depth(file: &Path) -> usize {
    let is_mod = file.file_name().is_some_and(|name| name == "mod.rs");
    file.components().count() - usize::from(is_mod)
}

fn allowed(room: &str) -> Option<BTreeSet<&'static str>> {
    let (_, arrows) = ARROWS.iter().find(|(name, _)| *name == room)?;
    // `os` lies under one of the foundation.
    let below = room == "os" || FOUNDATION.contains(&room);
    let foundation: &[&str] = if below { &[] } else { &FOUNDATION };
    Some(foundation.iter().chain(*arrows).copied().collect())
}

/// Everything that a source of a room does and may not.
fn breaches(file: &Path, text: &str) -> Vec<Breach> {
    let breach = |what: String| Breach { file: file.display().to_string(), what };
    let uses = Uses::of(text, depth(file));
    let mut found = Vec::new();
    if uses.is_unsafe && file != Path::new("os.rs") {
        found.push(breach("`unsafe` belongs in os.rs".into()));
    }
    let Some(room) = room(file) else { return found };
    let Some(may) = allowed(&room) else {
        found.push(breach(format!("`{room}` is no room of the table of arrows")));
        return found;
    };
    let known = |used: &&String| ARROWS.iter().any(|(name, _)| name == used);
    for used in uses.rooms.iter().filter(known).filter(|used| **used != room && !may.contains(used.as_str()))
    {
        found.push(breach(format!("{room} -> {used} is no arrow of the architecture")));
    }
    for (what, rooms) in OUTSIDE {
        if uses.outside.contains(*what) && !rooms.contains(&room.as_str()) {
            found.push(breach(format!("`{what}` belongs in {}", rooms.join(", "))));
        }
    }
    found
}

pub(super) fn sources() -> Vec<(PathBuf, String)> {
    fn collect(folder: &Path, root: &Path, into: &mut Vec<(PathBuf, String)>) {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let is_tests = path
                .file_stem()
                .is_some_and(|stem| stem == "tests" || stem.to_string_lossy().ends_with("_tests"));
            if path.is_dir() && !is_tests {
                collect(&path, root, into);
            } else if path.extension().is_some_and(|end| end == "rs") && !is_tests {
                into.push((
                    path.strip_prefix(root).unwrap().to_path_buf(),
                    std::fs::read_to_string(&path).unwrap(),
                ));
            }
        }
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut all = Vec::new();
    collect(&root, &root, &mut all);
    all.sort();
    all
}

#[test]
fn no_source_breaks_the_architecture() {
    let sources = sources();
    assert!(sources.len() > 40, "the sources are found");
    let found: Vec<_> = sources
        .iter()
        .flat_map(|(file, text)| breaches(file, text))
        .map(|breach| breach.to_string())
        .collect();
    assert!(found.is_empty(), "\n{}\n", found.join("\n"));
}

/// The rooms that can be reached from `room` by arrows of `graph`.
fn reachable<'a>(graph: &BTreeMap<&'a str, BTreeSet<&'a str>>, room: &'a str) -> BTreeSet<&'a str> {
    let (mut seen, mut open) = (BTreeSet::new(), vec![room]);
    while let Some(next) = open.pop() {
        for used in graph.get(next).into_iter().flatten() {
            if seen.insert(*used) {
                open.push(used);
            }
        }
    }
    seen
}

#[test]
fn the_arrows_make_no_circle() {
    let graph: BTreeMap<_, _> = ARROWS.iter().map(|(room, _)| (*room, allowed(room).unwrap())).collect();
    for room in graph.keys() {
        assert!(!reachable(&graph, room).contains(room), "{room} reaches itself");
    }
    let circle = BTreeMap::from([
        ("a", BTreeSet::from(["b"])),
        ("b", BTreeSet::from(["c"])),
        ("c", BTreeSet::from(["a"])),
    ]);
    assert!(reachable(&circle, "a").contains("a"), "and a circle would be seen");
}

#[test]
fn every_arrow_leads_to_a_room() {
    for (room, arrows) in ARROWS {
        for arrow in *arrows {
            assert!(ARROWS.iter().any(|(name, _)| name == arrow), "{room} -> {arrow}");
        }
    }
}

/// Negative controls: each way of writing a forbidden thing is caught, and what is allowed is not.
#[test]
fn a_forbidden_arrow_is_caught_however_it_is_written() {
    for (file, text, says) in [
        ("motion/x.rs", "use crate::link::Address;", "motion -> link"),
        ("motion/x.rs", "use crate::{geometry::Attitude, link::{self, Address}};", "motion -> link"),
        ("motion/x.rs", "use crate::scene as s;", "motion -> scene"),
        ("motion/x.rs", "use crate::wire::*;", "motion -> wire"),
        ("motion/x.rs", "use super::super::player::Player;", "motion -> player"),
        ("motion.rs", "use super::player::Player;", "motion -> player"),
        ("motion/x.rs", "fn f() { let a = crate::link::ports::all(); }", "motion -> link"),
        ("motion/x.rs", "fn f(p: &crate::scene::Plan) {}", "motion -> scene"),
        ("motion/x.rs", "fn f() { vec![crate::link::x()]; }", "motion -> link"),
        ("link/mod.rs", "use super::sensor::Reading;", "link -> sensor"),
        ("sensor/x.rs", "mod inner { use super::super::super::wire::Packet; }", "sensor -> wire"),
        ("double.rs", "use crate::time::SimTime;", "double -> time"),
        ("cellar/x.rs", "", "no room"),
        ("player.rs", "fn f() { std::thread::spawn(|| ()); }", "`std::thread` belongs"),
        ("player.rs", "use std::{fs::File, fmt};", "`std::fs` belongs"),
        ("wire/x.rs", "use std::net::TcpStream;", "`std::net` belongs"),
        ("session/x.rs", "fn f() { println!(\"x\"); }", "`println!` belongs"),
        ("link/x.rs", "fn f() { unsafe { g() } }", "`unsafe` belongs"),
        ("link/x.rs", "unsafe impl Send for X {}", "`unsafe` belongs"),
        ("link/x.rs", "unsafe fn f() {}", "`unsafe` belongs"),
    ] {
        let found = breaches(Path::new(file), text);
        assert!(found.len() == 1 && found[0].what.contains(says), "{text} in {file}: {found:?}");
    }
    for (file, text) in [
        (
            "motion/x.rs",
            "use crate::{geometry::{Attitude, exp}, keys::Key};\nuse super::Motion;\nuse super::link;",
        ),
        ("motion/x.rs", "#[cfg(test)]\nmod tests { use crate::scene::Plan; fn f() { println!(\"x\"); } }"),
        ("motion/x.rs", "#[cfg(test)]\nuse crate::scene::Plan;"),
        ("wire/x.rs", "use std::{fmt, sync::Arc};\nfn f() { crate::sensor::lsb(); writeln!(s, \"x\"); }"),
        ("os.rs", "fn f() { unsafe { g() } }"),
        ("lib.rs", "pub mod link;\nuse crate::scene::Plan;"),
        ("cli/run.rs", "fn f() { println!(\"x\"); crate::session::run(); }"),
    ] {
        assert_eq!(breaches(Path::new(file), text), [], "{text} in {file}");
    }
}

#[test]
fn every_arrow_is_used() {
    let mut used = BTreeMap::<String, BTreeSet<String>>::new();
    for (file, text) in sources() {
        if let Some(room) = room(&file) {
            used.entry(room).or_default().extend(Uses::of(&text, depth(&file)).rooms);
        }
    }
    for (room, arrows) in ARROWS {
        for arrow in *arrows {
            assert!(used[*room].contains(*arrow), "{room} -> {arrow} may go");
        }
    }
}

/// The arrows of a page: lines of `room, room  -> room room`, with what is not a room in parentheses.
fn drawn(page: &str) -> BTreeMap<String, BTreeSet<String>> {
    fn words(text: &str) -> impl Iterator<Item = String> {
        text.split([',', ' ']).filter(|word| !word.is_empty()).map(str::to_string)
    }
    let mut drawn = BTreeMap::new();
    for line in page.lines().filter(|line| line.starts_with("    ")) {
        let Some((rooms, arrows)) = line.split_once(" -> ") else { continue };
        let arrows: BTreeSet<String> = words(arrows).filter(|_| !arrows.starts_with('(')).collect();
        drawn.extend(words(rooms).map(|room| (room, arrows.clone())));
    }
    drawn
}

#[test]
fn the_page_draws_the_arrows_that_there_are() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/architecture.md");
    let page = std::fs::read_to_string(page).unwrap();
    let drawn = drawn(&page);
    for (room, arrows) in ARROWS.iter().filter(|(room, _)| *room != "cli") {
        let arrows: BTreeSet<_> = arrows.iter().map(ToString::to_string).collect();
        assert_eq!(drawn.get(*room), Some(&arrows), "{room}");
        let is_in_the_tree = ["/`", ".rs`"].iter().any(|end| page.contains(&format!("`{room}{end}")));
        assert!(is_in_the_tree, "{room} is in the table of rooms");
    }
    assert_eq!(drawn.len(), ARROWS.len(), "and no other rooms");
}
