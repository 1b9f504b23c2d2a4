//! The page of all warnings says what the source says.

use std::fs;
use std::path::Path;

use crate::common::repository;
use crate::common::warnings::listed;
use fecontact::model::text::{at_least, distinct, number, readable};

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

#[test]
fn numbers_without_end_are_written_with_an_exponent() {
    assert_eq!(readable(&format!("is {} at ({}, 0.25)", -1e300, 1e-40)), "is -1e300 at (1e-40, 0.25)");
    assert_eq!(readable(&format!("at ({:.6}, {:.6})", 3e99, 0.5)), "at (3e99, 0.500000)");
    let names = "out/12345678901234567890123456/case_00000000000000000000000001.json: `9999999999999999999999999`";
    assert_eq!(readable(names), names);
}

#[test]
fn numbers_are_short_and_told_apart() {
    assert_eq!([number(0.1 + 0.2), number(-1e300), number(2.0 / 3e9)], ["0.3", "-1e300", "6.66667e-10"]);
    assert_eq!(distinct([1.0, 2.0]), ["1", "2"]);
    assert_eq!(distinct([50.0, 50.000_000_3]), ["50", "50.0000003"]);
    assert_eq!(distinct([1.0, 1.0 + f64::EPSILON]), ["1", "1.0000000000000002"]);
    assert_eq!(distinct([1.0, 1.0]), ["1", "1"]);
}

#[test]
fn a_number_to_be_reached_is_rounded_up() {
    for (value, text) in
        [(50.000_01, "50.0001"), (50.0, "50"), (1e-9 / 3.0, "3.33334e-10"), (-0.123_456_7, "-0.123456")]
    {
        assert_eq!(at_least(value), text);
        assert!(text.parse::<f64>().unwrap() >= value);
    }
}
