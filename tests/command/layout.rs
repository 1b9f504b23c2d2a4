//! What a checkpoint stores, as its types are declared: postcard writes values without names, so that a field which is new, gone
//! or elsewhere makes nonsense of older files. It stands in `tests/command/surface/checkpoint.txt`, below the version in the head
//! of the file.
//!
//! Whoever changes a stored type raises `VERSION` in `src/output/checkpoint.rs`, and renews the file with
//! `SURFACE=renew cargo test --release --test command layout`. A mere change of a name leaves the bytes as they are: delete the file
//! before it is renewed.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use fecontact::output::checkpoint::VERSION;

/// Files of `src`, by their paths.
fn sources(folder: &Path) -> BTreeMap<PathBuf, String> {
    let mut found = BTreeMap::new();
    for path in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        match path.is_dir() {
            true => found.extend(sources(&path)),
            false if path.extension().is_some_and(|end| end == "rs") => {
                drop(found.insert(path.clone(), fs::read_to_string(path).unwrap()));
            }
            false => {}
        }
    }
    found
}

/// Declarations of types that can be stored, and of constants, by their names: without comments, fields that are skipped, attributes
/// other than serde's, and who may see what.
fn declarations(sources: &BTreeMap<PathBuf, String>) -> BTreeMap<String, Vec<String>> {
    let mut found: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for text in sources.values() {
        let lines: Vec<&str> = text.lines().map(|line| line.split("//").next().unwrap_or_default()).collect();
        let is_attribute = |line: &str| line.trim_start().starts_with('#');
        for (k, line) in lines.iter().enumerate().filter(|(_, line)| !line.starts_with(' ')) {
            let declared = seen_by_all(line);
            let Some((kind, rest)) = declared.split_once(' ') else { continue };
            let attributes = lines[..k].iter().rev().take_while(|line| is_attribute(line) || line.trim().is_empty());
            let is_stored = || {
                attributes.clone().any(|line| {
                    line.contains("Deserialize") && line.contains(" Serialize") || line.contains("(Serialize")
                })
            };
            let end = match kind {
                "type" | "const" => lines[k..].iter().position(|line| line.ends_with(';')),
                "struct" | "enum" if is_stored() => {
                    lines[k..].iter().position(|line| line.starts_with('}') || line.ends_with(");"))
                }
                _ => None,
            };
            let Some(end) = end else { continue };
            let name = rest.split(|c: char| !is_of_word(c)).next().unwrap_or_default();
            let is_skipped =
                |at: &usize| lines[at - 1].trim() == "#[serde(skip)]" || lines[*at].trim() == "#[serde(skip)]";
            let kept = (k..=k + end).filter(|at| *at == k || !is_skipped(at)).map(|at| lines[at]);
            let kept = kept.filter(|line| !is_attribute(line) || line.contains("serde"));
            let words: Vec<String> =
                kept.map(|line| seen_by_all(line.trim())).filter(|line| !line.is_empty()).collect();
            found.entry(name.into()).or_default().push(words.join(" "));
        }
    }
    found
}

fn is_of_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// A declaration without the names of variants.
fn types(declaration: &str) -> String {
    if !declaration.starts_with("enum ") {
        return declaration.into();
    }
    let mut depth = 0;
    let within = |c: &char| {
        depth += i32::from("{(".contains(*c)) - i32::from("})".contains(*c));
        depth > 1
    };
    declaration.chars().filter(within).collect()
}

/// A line without who may see what it declares.
fn seen_by_all(line: &str) -> String {
    ["pub(super) ", "pub(crate) ", "pub "].iter().fold(line.to_owned(), |line, word| line.replace(word, ""))
}

/// What a checkpoint stores: the types that its parts are read as, and those that these name.
fn layout() -> String {
    let sources = sources(&crate::common::repository("src"));
    let declarations = declarations(&sources);
    // The checkpoint, the run in it, and what every observer of the run remembers.
    let mut roots: Vec<String> = vec!["Checkpoint".into(), "Written".into()];
    let recalled = sources.values().flat_map(|text| text.split("recalled::<").skip(1));
    roots.extend(recalled.filter_map(|rest| Some(rest.split_once(">(")?.0.to_owned())));
    let untold = |text: &&String| text.contains("csv::recalled(") || text.contains(" recalled(");
    assert_eq!(sources.values().filter(untold).count(), 0, "say what is recalled: recalled::<TYPE>(…)");
    assert!(roots.len() > 7, "what observers remember is not found: {roots:?}");
    let mut stored: BTreeSet<String> = BTreeSet::new();
    let mut seen: BTreeSet<&str> = BTreeSet::new();
    let mut open = roots.clone();
    while let Some(text) = open.pop() {
        for word in types(&text).split(|c: char| !is_of_word(c)) {
            let Some((name, declared)) = declarations.get_key_value(word) else { continue };
            if seen.insert(name) {
                stored.extend(declared.iter().cloned());
                open.extend(declared.iter().cloned());
            }
        }
    }
    assert!(seen.contains("State") && seen.contains("Phase") && seen.contains("FrictionState"), "{seen:?}");
    roots.sort();
    roots.dedup();
    let lines: Vec<String> = roots.into_iter().map(|root| format!("read as {root}")).chain(stored).collect();
    lines.join("\n") + "\n"
}

#[test]
fn another_layout_has_another_version() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("command/surface/checkpoint.txt");
    let found = format!("version {VERSION}\n{}", layout());
    let known = fs::read_to_string(&file).unwrap_or_default();
    if known == found {
        return;
    }
    let lines = |text: &str| text.lines().skip(1).map(String::from).collect::<BTreeSet<_>>();
    let (before, now) = (lines(&known), lines(&found));
    let was: Vec<&String> = before.difference(&now).collect();
    let is: Vec<&String> = now.difference(&before).collect();
    let same_version = known.lines().next() == found.lines().next();
    assert!(
        was.is_empty() && is.is_empty() || !same_version,
        "a checkpoint stores something else, under the same version: raise VERSION in src/output/checkpoint.rs, then renew {} with \
         `SURFACE=renew cargo test --release --test command layout`. It was {was:#?} and is {is:#?}",
        file.display()
    );
    assert!(
        std::env::var("SURFACE").is_ok_and(|way| way == "renew"),
        "{}: renew it with `SURFACE=renew cargo test --release --test command layout`",
        file.display()
    );
    fs::write(&file, found).unwrap();
}
