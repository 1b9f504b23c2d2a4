//! The Japanese README says what the English one says: its commands and numbers stand there, or in the pages that it shortens.

use std::collections::BTreeSet;
use std::fs;

use crate::common::repository;

fn text(file: &str) -> String {
    fs::read_to_string(repository(file)).unwrap()
}

/// Lines of the fenced blocks of a shell.
fn commands(page: &str) -> Vec<&str> {
    let blocks = page.split("```sh\n").skip(1).filter_map(|block| block.split("```").next());
    blocks.flat_map(str::lines).map(|line| line.split('#').next().unwrap_or_default().trim()).collect()
}

/// Numbers with a decimal point.
fn numbers(page: &str) -> BTreeSet<&str> {
    let words = page.split(|c: char| !(c.is_ascii_digit() || c == '.')).map(|word| word.trim_matches('.'));
    words.filter(|word| word.contains('.')).collect()
}

#[test]
fn the_japanese_readme_says_what_the_english_one_says() {
    let (japanese, english) = (text("README.ja.md"), text("README.md"));
    let given = commands(&english);
    let first_two: Vec<&str> = commands(&japanese).into_iter().take(2).collect();
    assert_eq!(first_two, given[..2]);
    let first_steps = commands(&japanese)[2..].to_vec();
    assert_eq!(first_steps, ["fecontact init tribology", "fecontact run tribology.json"]);
    let known = numbers(&english);
    let others: Vec<&str> = numbers(&japanese).into_iter().filter(|number| !known.contains(number)).collect();
    assert!(others.is_empty(), "README.md has no {others:?}");
}
