//! The page of all warnings, `docs/reference/warnings.md`.

use super::repository;

/// The rows of its tables: what each warning says in pieces between what varies, and what is measured.
pub fn listed() -> Vec<(Vec<String>, String)> {
    let page = std::fs::read_to_string(repository("docs/reference/warnings.md")).expect("the page of warnings");
    let rows = page.lines().filter(|line| line.starts_with("| `"));
    let row = |line: &str| {
        let cells: Vec<&str> = line.trim_matches('|').split(" | ").map(str::trim).collect();
        let words = cells[0].trim_matches('`').split('…').map(|piece| piece.trim().to_owned());
        (words.collect(), cells[1].to_owned())
    };
    rows.map(row).collect()
}

/// Whether the page has an entry for a warning.
pub fn is_listed(warning: &str) -> bool {
    let says = |words: &[String]| {
        let mut rest = Some(warning);
        for piece in words {
            rest = rest.and_then(|rest| rest.split_once(piece.as_str())).map(|(_, after)| after);
        }
        rest.is_some()
    };
    listed().iter().any(|(words, _)| says(words))
}
