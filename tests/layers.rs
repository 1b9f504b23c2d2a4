//! The layers of the house: a room imports only from lower ones, and no files import each other in a circle. A file is one
//! idea, and no longer than that takes.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// The sources of the library
const SOURCES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../src");

/// Rooms from the bottom to the top. A new one must be listed.
const ROOMS: [&str; 13] = [
    "laws",
    "mesh",
    "linear",
    "contact",
    "bars",
    "model",
    "equations",
    "solve",
    "time",
    "run",
    "output",
    "case",
    "cli",
];

/// A file as its module path: `src/mesh/shape.rs` is `mesh::shape`, `src/mesh/mod.rs` is `mesh`.
type Module = Vec<String>;

fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("src can be read").map(|entry| entry.expect("an entry").path());
    entries.flat_map(|path| if path.is_dir() { sources(&path) } else { vec![path] }).collect()
}

fn module(file: &Path, root: &Path) -> Module {
    let below = file.strip_prefix(root).expect("below src").with_extension("");
    let mut parts: Module = below.iter().map(|part| part.to_string_lossy().into_owned()).collect();
    parts.pop_if(|last| last == "mod");
    parts
}

/// Module of every file of the library, and its code without comments and unit tests.
fn modules() -> BTreeMap<Module, String> {
    let root = Path::new(SOURCES);
    let read = |file: &PathBuf| {
        let text = std::fs::read_to_string(file).expect("a source file");
        let program = text.split("#[cfg(test)]").next().unwrap_or_default();
        program.lines().map(|line| line.split("//").next().unwrap_or_default()).collect::<Vec<_>>().join("\n")
    };
    let all = sources(root).into_iter().map(|file| (module(&file, root), read(&file)));
    all.filter(|(module, _)| !matches!(module.last().map(String::as_str), Some("lib" | "main"))).collect()
}

/// Modules that a file names behind `crate::`, `self::` and `super::`, braces followed one level deep.
fn imports(own: &Module, text: &str, modules: &BTreeMap<Module, String>) -> BTreeSet<Module> {
    let mut found = BTreeSet::new();
    for (at, _) in text.match_indices("::") {
        let word = |text: &str| text.chars().rev().take_while(|c| c.is_alphanumeric() || *c == '_').count();
        let start = at - word(&text[..at]);
        let mut base = match &text[start..at] {
            "crate" => Vec::new(),
            "super" if !text[..start].ends_with("super::") => own[..own.len() - 1].to_vec(),
            "self" => own.clone(),
            _ => continue,
        };
        let mut rest = &text[at + 2..];
        while let Some(after) = rest.strip_prefix("super::") {
            base.pop();
            rest = after;
        }
        let path = |text: &str| -> Vec<String> {
            let end = text.find(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':')).unwrap_or(text.len());
            text[..end].split("::").filter(|part| !part.is_empty()).map(String::from).collect()
        };
        let trunk = path(rest);
        let after = rest[trunk.join("::").len()..].trim_start_matches("::");
        let braces = after.strip_prefix('{').and_then(|inside| inside.split('}').next());
        let branches =
            braces.map_or(vec![Vec::new()], |inside| inside.split(',').map(|name| path(name.trim())).collect());
        for branch in branches {
            let mut full: Module = base.iter().chain(&trunk).chain(&branch).cloned().collect();
            while !full.is_empty() && !modules.contains_key(&full) {
                full.pop();
            }
            if !full.is_empty() && full != *own {
                found.insert(full);
            }
        }
    }
    found
}

fn graph() -> BTreeMap<Module, BTreeSet<Module>> {
    let modules = modules();
    let graph: BTreeMap<Module, BTreeSet<Module>> =
        modules.iter().map(|(module, text)| (module.clone(), imports(module, text, &modules))).collect();
    let seen: usize = graph.values().map(BTreeSet::len).sum();
    assert!(seen > 200, "only {seen} imports were found: the test does not see them");
    graph
}

#[test]
fn rooms_import_only_from_lower_ones() {
    let layer = |module: &Module| {
        let room = ROOMS.iter().position(|room| *room == module[0]);
        room.unwrap_or_else(|| panic!("{} is no room: list it", module[0]))
    };
    for (module, imports) in graph() {
        for import in imports {
            assert!(layer(&import) <= layer(&module), "{} imports {}", module.join("::"), import.join("::"));
        }
    }
}

#[test]
fn no_files_import_each_other_in_a_circle() {
    let mut graph = graph();
    // Files that import none of those left are in no circle.
    loop {
        let done: Vec<Module> = graph
            .iter()
            .filter(|(_, imports)| imports.iter().all(|import| !graph.contains_key(import)))
            .map(|(module, _)| module.clone())
            .collect();
        if done.is_empty() {
            break;
        }
        done.iter().for_each(|module| drop(graph.remove(module)));
    }
    let message = |(module, imports): (Module, BTreeSet<Module>)| {
        let imports: Vec<String> = imports.iter().map(|import| import.join("::")).collect();
        format!("{} imports {}", module.join("::"), imports.join(", "))
    };
    assert!(
        graph.is_empty(),
        "in circles, or above one:\n{}",
        graph.into_iter().map(message).collect::<Vec<_>>().join("\n")
    );
}

/// Who needs a property of a friction law asks it: no other room knows the laws by name.
#[test]
fn only_the_laws_know_each_other_by_name() {
    let laws =
        ["Adhesion", "SuperSubloading", "SlipWeakening", "RateAndState", "Coulomb", "Frictionless", "PrescribedSlip"];
    for (module, text) in modules().iter().filter(|(module, _)| module[0] != "laws") {
        let named = text.split(|c: char| !c.is_alphanumeric()).find(|word| laws.contains(word));
        assert_eq!(named, None, "in {}", module.join("::"));
    }
}

/// A file is one idea; a longer one is two.
const LONGEST_FILE: usize = 600;

#[test]
fn a_file_is_one_idea_and_no_longer() {
    let lines = |file: &PathBuf| std::fs::read_to_string(file).expect("a source file").lines().count();
    let files = sources(Path::new(SOURCES)).into_iter();
    let measured =
        files.filter(|file| file.extension().is_some_and(|end| end == "rs")).map(|file| (lines(&file), file));
    let long: Vec<String> = measured
        .filter(|(length, _)| *length > LONGEST_FILE)
        .map(|(length, file)| format!("{}: {length} lines", file.display()))
        .collect();
    assert!(long.is_empty(), "of more than {LONGEST_FILE} lines:\n{}", long.join("\n"));
}
