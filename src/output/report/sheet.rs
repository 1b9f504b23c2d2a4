//! Tables for the page: columns packed, with fewer rows where there are too many.

use std::path::Path;

use serde_json::{Value, json};

use super::pack::{Pack, Packed};
use crate::output::plot::read::Columns;

/// Columns in which single precision would not tell rows apart.
const EXACT: [&str; 6] = ["time", "onset", "arrival", "place", "position", "increment"];

/// Read a table up to what cannot be understood, which goes to the notes; nothing if there is no such table.
pub fn read(folder: &Path, file: &str, notes: &mut Vec<String>) -> Option<Columns> {
    let path = folder.join(file);
    if !path.is_file() {
        return None;
    }
    match Columns::read_to_fault(&path, |_| true) {
        Ok((columns, fault)) => {
            notes.extend(fault.map(|fault| format!("{fault}; only the rows before it are shown")));
            Some(columns)
        }
        Err(fault) => {
            notes.push(format!("{fault}; it is not shown"));
            None
        }
    }
}

/// The rows of a table that are shown: all, or the first, last, lowest and highest of every column in each of as many
/// groups of rows as there is room for.
pub fn rows(columns: &Columns, most: usize) -> Vec<usize> {
    let all: Vec<&[f64]> = columns.names().filter_map(|name| columns.get(name).ok()).collect();
    let count = all.first().map_or(0, |column| column.len());
    if count <= most {
        return (0..count).collect();
    }
    let numbers: Vec<&[f64]> = columns
        .names()
        .filter(|name| columns.words(name).is_none())
        .filter_map(|name| columns.get(name).ok())
        .collect();
    // Columns that never change, and the ones that only grow, have their extremes at the ends of the groups.
    let swinging: Vec<&[f64]> = numbers.into_iter().filter(|column| !column.is_sorted()).collect();
    let group = (count * (2 + 2 * swinging.len())).div_ceil(most).max(1);
    let mut kept = Vec::with_capacity(most);
    for start in (0..count).step_by(group) {
        let rows = start..(start + group).min(count);
        let mut some = vec![rows.start, rows.end - 1];
        for column in &swinging {
            let by_value = |a: &usize, b: &usize| column[*a].total_cmp(&column[*b]);
            some.extend(rows.clone().min_by(by_value));
            some.extend(rows.clone().max_by(by_value));
        }
        some.sort_unstable();
        some.dedup();
        kept.extend(some);
    }
    kept
}

/// A column of a table for the page: its name, what its values stand for if they are words, and its values.
pub type Column<'a> = (&'a str, Option<&'a [String]>, Vec<f64>);

/// Columns of a table for the page.
pub fn sheet(columns: Vec<Column>, pack: &mut Pack) -> Value {
    let rows = columns.first().map_or(0, |(_, _, values)| values.len());
    let column = |(name, words, values): Column| {
        let exact = EXACT.contains(&name);
        let packed = if exact { Packed::exact(&values) } else { Packed::single(&values) };
        json!({ "name": name, "words": words, "type": if exact { "f64" } else { "f32" }, "chunk": pack.add(&packed) })
    };
    let packed: Vec<Value> = columns.into_iter().map(column).collect();
    json!({ "rows": rows, "columns": packed })
}

/// Some rows of a table.
pub fn some<'a>(columns: &'a Columns, rows: &[usize]) -> Vec<Column<'a>> {
    let column = |name: &'a String| {
        let all = columns.get(name).unwrap_or_default();
        (name.as_str(), columns.words(name), rows.iter().map(|&row| all[row]).collect())
    };
    columns.names().map(column).collect()
}

/// How many values of a table are not numbers, by column.
pub fn not_numbers(columns: &Columns) -> Vec<(String, usize)> {
    let bad = |name: &String| {
        let count = columns.get(name).unwrap_or_default().iter().filter(|value| !value.is_finite()).count();
        (count > 0).then(|| (name.clone(), count))
    };
    columns.names().filter_map(bad).collect()
}
