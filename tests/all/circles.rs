//! No circle of files inside a room: data flows one way from file to file too, read from the sources.
//!
//! A file and the file of a folder that it lies in may use each other: a parent hands on what its children have.

use super::architecture::{is_for_tests, sources};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use syn::visit::{self, Visit};

/// A module by its path from the crate's root.
type Module = Vec<String>;

/// What one source names: paths that it uses, and those that it hands on.
#[derive(Debug, Default)]
struct Names {
    used: Vec<Vec<String>>,
    handed_on: Vec<Vec<String>>,
}

impl Names {
    fn of(text: &str) -> Names {
        let mut names = Names::default();
        names.visit_file(&syn::parse_file(text).expect("a source that compiles parses"));
        names
    }

    fn tree(tree: &syn::UseTree, before: &[String], all: &mut Vec<Vec<String>>) {
        let with = |ident: &syn::Ident| [before, &[ident.to_string()]].concat();
        match tree {
            syn::UseTree::Path(path) => Names::tree(&path.tree, &with(&path.ident), all),
            syn::UseTree::Name(name) => all.push(with(&name.ident)),
            syn::UseTree::Rename(rename) => all.push(with(&rename.ident)),
            syn::UseTree::Glob(_) => all.push(before.to_vec()),
            syn::UseTree::Group(group) => {
                group.items.iter().for_each(|tree| Names::tree(tree, before, all));
            }
        }
    }
}

impl<'ast> Visit<'ast> for Names {
    fn visit_item(&mut self, item: &'ast syn::Item) {
        if !is_for_tests(item) {
            visit::visit_item(self, item);
        }
    }

    fn visit_item_use(&mut self, item: &'ast syn::ItemUse) {
        let is_public = !matches!(item.vis, syn::Visibility::Inherited);
        Names::tree(&item.tree, &[], if is_public { &mut self.handed_on } else { &mut self.used });
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        self.used.push(path.segments.iter().map(|segment| segment.ident.to_string()).collect());
        visit::visit_path(self, path);
    }
}

fn module(file: &Path) -> Module {
    let stem = file.with_extension("");
    let parts = stem.components().map(|part| part.as_os_str().to_string_lossy().into_owned());
    parts.filter(|part| part != "lib" && part != "main").collect()
}

/// The module and the rest of a path that is written in `from`; `None` where it leads out of the crate.
fn resolve(names: &BTreeMap<Module, Names>, from: &Module, path: &[String]) -> Option<(Module, Vec<String>)> {
    let mut at = from.clone();
    let mut rest = path.to_vec();
    match rest.first()?.as_str() {
        "crate" => {
            at.clear();
            rest.remove(0);
        }
        "self" => {
            rest.remove(0);
        }
        "super" => {
            while rest.first().is_some_and(|first| first == "super") {
                at.pop();
                rest.remove(0);
            }
        }
        first => {
            let child = [at.as_slice(), &[first.to_string()]].concat();
            names.contains_key(&child).then_some(())?;
        }
    }
    while let Some(first) = rest.first() {
        let child = [at.as_slice(), std::slice::from_ref(first)].concat();
        if !names.contains_key(&child) {
            break;
        }
        at = child;
        rest.remove(0);
    }
    Some((at, rest))
}

/// Which module each module uses, those above and below itself left out.
fn arrows(sources: &[(PathBuf, String)]) -> BTreeMap<Module, BTreeSet<Module>> {
    let names: BTreeMap<Module, Names> =
        sources.iter().map(|(file, text)| (module(file), Names::of(text))).collect();
    let owner = |from: &Module, path: &[String]| -> Option<Module> {
        let (at, rest) = resolve(&names, from, path)?;
        // What a module hands on is its owner's.
        let handed = rest.first().and_then(|name| {
            let hands = names.get(&at)?.handed_on.iter();
            hands.filter(|path| path.last() == Some(name)).find_map(|path| resolve(&names, &at, path))
        });
        Some(handed.map_or(at, |(owner, _)| owner))
    };
    let above = |a: &Module, b: &Module| a.starts_with(b) || b.starts_with(a);
    names
        .iter()
        .map(|(from, said)| {
            let used = said.used.iter().filter_map(|path| owner(from, path));
            (from.clone(), used.filter(|to| !above(from, to)).collect())
        })
        .collect()
}

/// The modules in circles: those that are left when all that lead nowhere, and all that nothing leads to, are gone.
fn in_circles(mut arrows: BTreeMap<Module, BTreeSet<Module>>) -> BTreeMap<Module, BTreeSet<Module>> {
    loop {
        let used: BTreeSet<Module> = arrows.values().flatten().cloned().collect();
        let before = arrows.len();
        arrows.retain(|from, to| !to.is_empty() && used.contains(from));
        let left: BTreeSet<Module> = arrows.keys().cloned().collect();
        arrows.values_mut().for_each(|to| to.retain(|to| left.contains(to)));
        if arrows.len() == before {
            return arrows;
        }
    }
}

#[test]
fn no_files_of_a_room_use_each_other_in_a_circle() {
    let sources = sources();
    let names = arrows(&sources);
    assert!(names.values().map(BTreeSet::len).sum::<usize>() > 500, "the arrows are found");
    let found = in_circles(names);
    let lines: Vec<_> = found
        .iter()
        .flat_map(|(from, to)| to.iter().map(|to| format!("{} -> {}", from.join("/"), to.join("/"))))
        .collect();
    assert!(lines.is_empty(), "\n{}\n", lines.join("\n"));
}

#[test]
fn a_circle_is_found_however_it_is_written() {
    let of = |a: &str, b: &str, c: &str| {
        let files =
            [("x.rs", "mod a; mod b; mod c;\npub use b::B;"), ("x/a.rs", a), ("x/b.rs", b), ("x/c.rs", c)];
        let files: Vec<_> =
            files.iter().map(|(file, text)| (PathBuf::from(file), text.to_string())).collect();
        in_circles(arrows(&files)).len()
    };
    assert_eq!(of("use super::b::B;", "pub struct B;", "use super::a::A; use super::B;"), 0);
    assert_eq!(of("use super::b::B;", "use super::a::A;", ""), 2);
    assert_eq!(
        of("use super::B;", "use crate::x::c::C;", "fn f() { super::a::g(); }"),
        3,
        "by way of the parent"
    );
    assert_eq!(
        of("use super::B;", "#[cfg(test)]\nmod tests { use super::super::a::A; }", ""),
        0,
        "tests may"
    );
}
