//! Names given by users: suggestions for misspelled ones, and their display.

use std::borrow::Cow;

use thiserror::Error;

/// Similarity above which names count as near: fraction of equal letters, a swap of neighbours counting as one difference.
const NEAR: f64 = 0.6;

/// Returns the known name that was probably meant: one that starts the same, or differs by few letters.
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

/// Message for an unknown name, with the one that was probably meant, and all that are known.
pub fn not_known(name: &str, known: &[&str]) -> String {
    let meant = nearest(name, known.iter().copied());
    let meant = meant.map_or_else(|| ".".into(), |near| format!("; did you mean `{near}`?"));
    format!("`{name}` is not known here{meant} Known are `{}`", known.join("`, `"))
}

/// Makes a text safe for a terminal: escapes control characters and those that change the writing direction; keeps line breaks.
pub fn printable(text: &str) -> Cow<'_, str> {
    spelled(text, |c| c != '\n' && steers(c))
}

/// Returns the text in one line, without line breaks.
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

/// Whether a character cannot occur in a name, table or figure: it is a control character or not allowed in XML.
pub fn is_unwritable(c: char) -> bool {
    c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}')
}

fn steers(c: char) -> bool {
    let direction =
        matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' | '\u{061c}');
    direction || matches!(c, '\u{2028}' | '\u{2029}') || c.is_control()
}

/// Error: no group of the mesh has this name.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("the mesh has no group `{name}`{}; it has {}", suggestion(nearest), listing(groups))]
#[non_exhaustive]
pub struct UnknownGroup {
    /// requested name
    pub name: String,
    /// name of the most similar group
    pub nearest: Option<String>,
    /// existing groups
    pub groups: Vec<String>,
}

fn suggestion(nearest: &Option<String>) -> String {
    nearest.as_ref().map_or_else(String::new, |name| format!(" (did you mean `{name}`?)"))
}

fn listing(groups: &[String]) -> String {
    if groups.is_empty() { "no groups at all".into() } else { format!("`{}`", groups.join("`, `")) }
}
