//! The page of all warnings says what the source says.

use std::fs;
use std::path::Path;

use crate::common::repository;
use crate::common::warnings::listed;

/// The text of all files of a folder, with strings that go on in the next line in one.
fn source(folder: &Path) -> String {
    let mut text = String::new();
    for entry in fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()) {
        text += &match entry.is_dir() {
            true => source(&entry),
            false => fs::read_to_string(&entry).expect("a text"),
        };
    }
    let mut lines = text.split("\\\n");
    let first = lines.next().unwrap_or_default().to_owned();
    lines.fold(first, |all, line| all + line.trim_start())
}

#[test]
fn every_entry_of_the_page_stands_in_the_source() {
    let (source, entries) = (source(&repository("src")), listed());
    let pieces = entries.iter().flat_map(|(words, _)| words);
    let missing: Vec<&String> = pieces.filter(|piece| !source.contains(piece.as_str())).collect();
    assert_eq!(missing, Vec::<&String>::new(), "words that no warning says");
    let bounds = entries.iter().flat_map(|(_, measured)| measured.split('`').skip(1).step_by(2));
    let bounds: Vec<&str> = bounds.filter(|code| code.contains(" = ")).collect();
    assert!(entries.len() > 40 && bounds.len() > 20, "{} {}", entries.len(), bounds.len());
    let stands = |bound: &str| {
        let (name, value) = bound.split_once(" = ").expect("a value");
        let kind = if name.contains(':') { name.to_owned() } else { format!("{name}: f64") };
        source.contains(&format!("const {kind} = {value};"))
    };
    let wrong: Vec<&str> = bounds.into_iter().filter(|bound| !stands(bound)).collect();
    assert_eq!(wrong, Vec::<&str>::new(), "bounds that are others in the source");
}
