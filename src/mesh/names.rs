//! Names that a user gives: which known one is near a wrong one, and how they are shown.

use std::borrow::Cow;

use thiserror::Error;

/// Names that agree in this share of their letters are near each other, a swap of neighbours counted once.
const NEAR: f64 = 0.6;

/// The known name that was probably meant: one that begins the same, or differs by few letters.
pub fn nearest<'n>(name: &str, known: impl DoubleEndedIterator<Item = &'n str>) -> Option<&'n str> {
    let name = name.to_lowercase();
    let near = |other: &&str| {
        let other = other.to_lowercase();
        let begins_alike = !name.is_empty() && (other.starts_with(&name) || name.starts_with(&other));
        begins_alike || strsim::normalized_damerau_levenshtein(&name, &other) >= NEAR
    };
    let likeness = |other: &&str| strsim::jaro_winkler(&other.to_lowercase(), &name);
    known.rev().filter(near).max_by(|a, b| likeness(a).total_cmp(&likeness(b)))
}

/// A text for a terminal: characters that steer it, or turn the direction of writing, are spelled out; line breaks are kept.
pub fn printable(text: &str) -> Cow<'_, str> {
    spelled(text, |c| c != '\n' && steers(c))
}

/// The text in one line, without line breaks.
pub fn in_line(text: &str) -> Cow<'_, str> {
    spelled(text, steers)
}

fn spelled(text: &str, wanted: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.contains(&wanted) {
        return text.into();
    }
    let spell = |c: char| if wanted(c) { c.escape_default().collect::<String>() } else { c.into() };
    text.chars().map(spell).collect::<String>().into()
}

/// Whether a character can stand in no name, table or figure: it steers a device, or XML has none such.
pub fn is_unwritable(c: char) -> bool {
    c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}')
}

fn steers(c: char) -> bool {
    let direction =
        matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' | '\u{061c}');
    direction || matches!(c, '\u{2028}' | '\u{2029}') || c.is_control()
}

/// A name that no group of the mesh has.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("the mesh has no group `{name}`{}; it has {}", suggestion(nearest), listing(groups))]
#[non_exhaustive]
pub struct UnknownGroup {
    /// the name that was asked for
    pub name: String,
    /// the group whose name resembles it most
    pub nearest: Option<String>,
    /// the groups there are
    pub groups: Vec<String>,
}

fn suggestion(nearest: &Option<String>) -> String {
    nearest.as_ref().map_or_else(String::new, |name| format!(" (did you mean `{name}`?)"))
}

fn listing(groups: &[String]) -> String {
    if groups.is_empty() { "no groups at all".into() } else { format!("`{}`", groups.join("`, `")) }
}
