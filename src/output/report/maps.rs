//! What interfaces did over place and time, for the page.

use serde_json::{Value, json};

use super::pack::{Pack, Packed};
use crate::output::interface::STORE;
use crate::output::results::InterfaceMap;

/// Places in order: those of a further line of the interface go on behind the one before.
fn end_to_end(positions: &[f64]) -> (Vec<f64>, bool) {
    let mut along: Vec<f64> = Vec::with_capacity(positions.len());
    let (mut offset, mut lines) = (0.0, 1);
    for (k, position) in positions.iter().enumerate() {
        if k > 0 && *position < positions[k - 1] {
            offset = along[k - 1];
            lines += 1;
        }
        along.push(offset + position);
    }
    (along, lines > 1)
}

/// The values of the rows that are shown; of slip rates the fastest since the row before.
fn thinned(name: &str, values: &[f64], shown: &[usize], points: usize) -> Vec<f64> {
    let mut all = Vec::with_capacity(shown.len() * points);
    let mut first = 0;
    for &row in shown {
        for point in 0..points {
            let of = |row: usize| values[row * points + point];
            let fastest = (first..=row).map(of).max_by(|a, b| a.abs().total_cmp(&b.abs()));
            all.push(if name == "slip_rate" { fastest.unwrap_or(f64::NAN) } else { of(row) });
        }
        first = row + 1;
    }
    all
}

/// The map of the contact of a number for the page, with at most so many values a quantity; what is left out goes to the notes.
pub fn map((number, map): (usize, &InterfaceMap), most: usize, pack: &mut Pack, notes: &mut Vec<String>) -> Value {
    let InterfaceMap { contact, times, positions, quantities } = map;
    let (points, rows) = (positions.len(), times.len());
    let group = (rows * points).div_ceil(most.max(points)).max(1);
    // The last of each group is shown.
    let shown: Vec<usize> = (0..rows).filter(|row| (row + 1) % group == 0 || row + 1 == rows).collect();
    if group > 1 {
        notes.push(format!(
            "{STORE}: {} of {rows} times of {contact} are shown, with the fastest slip since the time before",
            shown.len()
        ));
    }
    let mut packed: Vec<Value> = Vec::new();
    for (name, values) in quantities {
        let bad = values.iter().filter(|value| !value.is_finite()).count();
        if bad == values.len() {
            continue;
        }
        if bad > 0 {
            notes.push(format!("{STORE}: {bad} values of {name} are no numbers; they are left blank"));
        }
        let values = thinned(name, values, &shown, points);
        let range = range(values.iter().copied());
        packed.push(json!({ "name": name, "range": range, "chunk": pack.add(&Packed::rounded(values.into_iter())) }));
    }
    let (along, several_lines) = end_to_end(positions);
    let times: Vec<f64> = shown.iter().map(|&row| times[row]).collect();
    json!({
        "contact": contact,
        "number": number,
        "from": STORE,
        "rows": shown.len(),
        "points": points,
        "several_lines": several_lines,
        "times": pack.add(&Packed::exact(&times)),
        "positions": pack.add(&Packed::exact(&along)),
        "quantities": packed,
    })
}

/// The lowest and the highest number of all.
pub fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let numbers = values.filter(|value| value.is_finite());
    let [low, high] = numbers.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], value| [value.min(a), value.max(b)]);
    if low <= high { [low, high] } else { [0.0, 0.0] }
}

/// Two numbers between which nearly all lie, but for a fiftieth at either end: zeros, where nothing happens, are between them
/// and do not count.
pub fn most(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let mut numbers: Vec<f64> = values.filter(|value| value.is_finite()).collect();
    let all = numbers.len();
    numbers.retain(|value| *value != 0.0);
    let zero = if numbers.len() < all { 0.0 } else { f64::NAN };
    let last = numbers.len().saturating_sub(1);
    let mut at = |k: usize| if numbers.is_empty() { 0.0 } else { *numbers.select_nth_unstable_by(k, f64::total_cmp).1 };
    [at(last / 50).min(zero), at(last - last / 50).max(zero)]
}
