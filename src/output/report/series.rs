//! Frames of bodies and interfaces for the page, as many as fit.
//!
//! Maps of interface quantities over place and time.

use std::collections::BTreeSet;
use std::path::Path;

use rayon::prelude::*;
use serde_json::{Value, json};

use super::table::{Pack, Packed};
use crate::laws::bulk::principal_values;
use crate::output::quantities::OF_YIELDING;
use crate::output::results::{Array, Frame, Grid, Unreadable, frames};
use crate::output::store::STORE;
use crate::output::store::read::StoredContact;
use crate::output::vtu::GHOSTS;

/// Undeformed positions are stored relative to the center, so that single precision suffices far from the origin.
fn middle(points: &[[f64; 2]]) -> [f64; 2] {
    [0, 1].map(|i| {
        let [low, high] = range(points.iter().map(|x| x[i]));
        0.5 * (low + high)
    })
}

/// Frames of one kind.
pub struct Series {
    /// readable frames
    frames: Vec<(Frame, Grid)>,
}

/// A frame, packed for the page.
struct PackedFrame {
    time: f64,
    /// numbers of the bodies that are absent
    hidden: BTreeSet<u32>,
    /// largest displacement [L]
    largest: f64,
    displacement: Option<Packed>,
    fields: Vec<Field>,
}

/// A field of a frame, packed.
struct Field {
    name: String,
    /// for each component: its full range, its typical range, and its values
    components: Vec<([f64; 2], [f64; 2], Packed)>,
    /// length of the longest vector, and of the longest typical one
    longest: [f64; 2],
    /// of a tensor, of each principal value its range, and that of most: the page computes them from the components
    principal: Vec<[[f64; 2]; 2]>,
}

impl PackedFrame {
    fn size(&self) -> usize {
        let fields = self.fields.iter().flat_map(|field| &field.components);
        self.displacement.as_ref().map_or(0, Packed::size) + fields.map(|(_, _, packed)| packed.size()).sum::<usize>()
    }
}

impl Series {
    /// Reads frames listed by `NAME.pvd`, evenly spaced and as many as fit into `room` bytes of a page; unreadable ones are
    /// noted.
    pub fn read(folder: &Path, name: &str, room: usize, notes: &mut Vec<String>) -> Option<Self> {
        let listed = match frames(folder, name) {
            Ok(listed) => listed?,
            Err(fault) => {
                notes.push(format!("{fault}; it is not shown"));
                return None;
            }
        };
        if listed.is_empty() {
            return None;
        }
        let read = |&k: &usize| (listed[k].clone(), Grid::read(&folder.join(&listed[k].file)));
        // Frames of an undeformed state compress to almost nothing; the largest of some samples is representative.
        let samples = spread(listed.len(), 7).into_iter().filter_map(|k| Some((listed[k].clone(), read(&k).1.ok()?)));
        let samples = Self { frames: samples.collect() };
        let most = (room.saturating_sub(samples.mesh()) / samples.estimate()).min(MOST);
        if most == 0 {
            notes.push(format!("{name}.pvd: a single frame is too large for a page; look at it with ParaView"));
            return None;
        }
        let chosen = spread(listed.len(), most);
        if chosen.len() < listed.len() {
            let shown = chosen.len();
            notes.push(format!("{name}.pvd: {shown} of {} frames are shown: the page holds no more", listed.len()));
        }
        let all: Vec<(Frame, Result<Grid, Unreadable>)> = chosen.par_iter().map(read).collect();
        let mut series = Self { frames: Vec::new() };
        for (frame, grid) in all {
            match grid {
                Ok(grid) if series.frames.first().is_none_or(|(_, first)| first.is_like(&grid)) => {
                    notes.extend(not_numbers(&grid).map(|what| format!("{}: {what}; left blank", frame.file)));
                    series.frames.push((frame, grid));
                }
                Ok(_) => {
                    notes.push(format!("{} has different points or cells from the first frame: left out", frame.file))
                }
                Err(fault) => notes.push(format!("{} {fault}: this frame is left out", frame.file)),
            }
        }
        Some(series).filter(|series| !series.frames.is_empty())
    }

    /// Rough size of points and cells [bytes].
    fn mesh(&self) -> usize {
        let count = |(_, grid): &(Frame, Grid)| 9 * grid.points.len() + 3 * grid.connectivity.len();
        self.frames.first().map_or(0, count)
    }

    /// Upper bound of the size of a frame [bytes].
    fn estimate(&self) -> usize {
        let size = self.size();
        self.frames.iter().map(|(frame, grid)| self.packed(frame, grid, size).size()).max().unwrap_or(0).max(1)
    }

    /// Times of the frames.
    pub fn times(&self) -> Vec<f64> {
        self.frames.iter().map(|(frame, _)| frame.time).collect()
    }

    /// Largest displacement of all frames.
    fn size(&self) -> f64 {
        let all = self.frames.iter().filter_map(|(_, grid)| displacement(grid)).flat_map(|u| &u.values);
        all.filter(|u| u.is_finite()).fold(0.0, |size, u| u.abs().max(size))
    }

    fn packed(&self, frame: &Frame, grid: &Grid, size: f64) -> PackedFrame {
        let moved = displacement(grid).map(|u| {
            let values: Vec<f64> = u.values.chunks_exact(u.components).flat_map(|u| [u[0], u[1]]).collect();
            Packed::stepped(&values, 2, size, DISPLACEMENT_ERROR)
        });
        // Bars have values of their segments, too.
        let of_cells = grid.at_cells.iter().filter(|array| !NUMBERS_OF_CELLS.contains(&array.name.as_str()));
        let of_points = grid.at_points.iter().filter(|array| array.name != DISPLACEMENT);
        let fields = of_points.chain(of_cells).map(|array| {
            // VTK stores three components, the plane has two.
            let components = if array.components == 3 { 2 } else { array.components };
            let component = |i: usize| {
                let values: Vec<f64> = array.values.iter().skip(i).step_by(array.components).copied().collect();
                let all = || values.iter().copied();
                let [low, high] = range(all());
                let size = low.abs().max(high.abs());
                ([low, high], most(all()), Packed::stepped(&values, 1, size, FIELD_ERROR))
            };
            let components = (0..components).map(component).collect();
            Field { name: array.name.clone(), components, longest: longest(array), principal: principal(array) }
        });
        let largest = displacement(grid).map_or(0.0, |moved| longest(moved)[0]);
        PackedFrame { time: frame.time, hidden: hidden(grid), largest, displacement: moved, fields: fields.collect() }
    }

    /// Page data of the frames at these times.
    pub fn show(&self, times: &[f64], pack: &mut Pack) -> Value {
        let grid = &self.frames[0].1;
        let size = self.size();
        let chosen: Vec<&(Frame, Grid)> = self.frames.iter().filter(|(frame, _)| times.contains(&frame.time)).collect();
        let packed: Vec<PackedFrame> =
            chosen.into_par_iter().map(|(frame, grid)| self.packed(frame, grid, size)).collect();
        let origin = middle(&grid.points);
        let places: Vec<f64> = grid.points.iter().flat_map(|x| [x[0] - origin[0], x[1] - origin[1]]).collect();
        let of_cells = |name: &str| grid.at_cells.iter().find(|array| array.name == name);
        let ids = |array: &Array| Packed::counts(&array.values.iter().map(|id| *id as u32).collect::<Vec<_>>());
        let body = OWNERS.iter().find_map(|name| of_cells(name)).map(|array| pack.add(&ids(array)));
        let frames: Vec<Value> = packed.iter().map(|frame| shown(frame, pack)).collect();
        json!({
            "points": grid.points.len(),
            "cells": grid.ends.len(),
            "origin": origin,
            "places": pack.add(&Packed::single(&places)),
            "connectivity": pack.add(&Packed::counts(&grid.connectivity)),
            "ends": pack.add(&Packed::counts(&grid.ends)),
            "kinds": pack.add(&Packed::bytes(&grid.kinds)),
            "body": body,
            "largest": size,
            "errors": { "fields": FIELD_ERROR, "displacement": DISPLACEMENT_ERROR },
            "frames": frames,
        })
    }
}

/// Error of a field component relative to its largest value in the frame.
const FIELD_ERROR: f64 = 1.0 / 16_384.0;

/// Error of a displacement component relative to the largest displacement of the run.
const DISPLACEMENT_ERROR: f64 = 1.0 / 1_048_576.0;

/// Upper bound of the number of frames of one kind.
const MOST: usize = 2000;

/// Arrays that number the owner of a cell: its body, its contact or its bar.
const OWNERS: [&str; 3] = ["body", "contact", "bar"];

/// Arrays of cells that are no quantities.
const NUMBERS_OF_CELLS: [&str; 5] = [OWNERS[0], OWNERS[1], OWNERS[2], "material", GHOSTS];

/// Array that displaces the points.
const DISPLACEMENT: &str = "displacement";

fn displacement(grid: &Grid) -> Option<&Array> {
    grid.at_points.iter().find(|array| array.name == DISPLACEMENT && array.components >= 2)
}

/// Numbers of the bodies or bars whose cells a frame hides.
fn hidden(grid: &Grid) -> BTreeSet<u32> {
    let of = |name: &str| grid.at_cells.iter().find(|array| array.name == name);
    let (Some(body), Some(ghosts)) = (OWNERS.iter().find_map(|name| of(name)), of(GHOSTS)) else {
        return BTreeSet::new();
    };
    let cells = body.values.iter().zip(&ghosts.values);
    cells.filter(|(_, ghost)| **ghost != 0.0).map(|(body, _)| *body as u32).collect()
}

/// Length of the longest vector in the plane, and of the longest typical one.
fn longest(array: &Array) -> [f64; 2] {
    if array.components < 2 {
        return [0.0; 2];
    }
    let lengths = || array.values.chunks_exact(array.components).map(|vector| vector[0].hypot(vector[1]));
    [range(lengths())[1], most(lengths())[1]]
}

/// Ranges of the principal values of a tensor xx, yy, zz, xy, of all and of most; none of other arrays.
fn principal(array: &Array) -> Vec<[[f64; 2]; 2]> {
    let (tensors, rest) = array.values.as_chunks::<4>();
    if array.components != 4 || !rest.is_empty() {
        return Vec::new();
    }
    let values: Vec<[f64; 3]> = tensors.iter().map(|tensor| principal_values(*tensor)).collect();
    let of = |i: usize| values.iter().map(move |values| values[i]);
    (0..3).map(|i| [range(of(i)), most(of(i))]).collect()
}

/// Page data of a packed frame.
fn shown(frame: &PackedFrame, pack: &mut Pack) -> Value {
    let mut fields = serde_json::Map::new();
    for Field { name, components, longest, principal } in &frame.fields {
        let component = |(range, most, packed): &([f64; 2], [f64; 2], Packed)| json!({ "range": range, "most": most, "chunk": pack.add(packed) });
        let components: Vec<Value> = components.iter().map(component).collect();
        fields.insert(name.clone(), json!({ "components": components, "longest": longest, "principal": principal }));
    }
    let displacement = frame.displacement.as_ref().map(|packed| pack.add(packed));
    json!({ "time": frame.time, "hidden": frame.hidden, "displacement": displacement, "largest": frame.largest, "fields": fields })
}

/// Evenly spaced numbers below `count`, including the first and last; the last alone if `most` is one.
fn spread(count: usize, most: usize) -> Vec<usize> {
    match most {
        _ if count <= most => (0..count).collect(),
        0 => Vec::new(),
        1 => vec![count - 1],
        _ => (0..most).map(|k| k * (count - 1) / (most - 1)).collect(),
    }
}

/// Arrays of a grid with non-finite values. An additional field that some laws lack is NaN there, which is no defect.
fn not_numbers(grid: &Grid) -> impl Iterator<Item = String> {
    let bad = |array: &&Array| array.values.iter().filter(|value| !value.is_finite()).count();
    let of_all = |array: &&Array| OF_YIELDING.iter().all(|quantity| quantity.name != array.name);
    let arrays = grid.at_points.iter().filter(of_all).map(move |array| (array, bad(&array)));
    let some = arrays.filter(|(array, bad)| *bad > 0 && (*bad < array.values.len() || array.name == DISPLACEMENT));
    some.map(|(array, bad)| format!("{bad} values of {} are not numbers", array.name))
}

/// Positions in order; each further line of the interface follows behind the previous one.
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

/// Values of the rows shown; for slip rates, the largest since the previous row shown.
fn thinned(name: &str, values: &[f32], shown: &[usize], points: usize) -> Vec<f64> {
    let mut all = Vec::with_capacity(shown.len() * points);
    let mut first = 0;
    for &row in shown {
        for point in 0..points {
            let of = |row: usize| f64::from(values[row * points + point]);
            let fastest = (first..=row).map(of).max_by(|a, b| a.abs().total_cmp(&b.abs()));
            all.push(if name == "slip_rate" { fastest.unwrap_or(f64::NAN) } else { of(row) });
        }
        first = row + 1;
    }
    all
}

/// The map of the contact of a number for the page, with at most `most` values per quantity; what is left out goes to the notes.
pub fn map(number: usize, map: &StoredContact, most: usize, pack: &mut Pack, notes: &mut Vec<String>) -> Value {
    let StoredContact { name: contact, times, positions, places, lines, quantities } = map;
    let (points, rows) = (positions.len(), times.len());
    let group = (rows * points).div_ceil(most.max(points)).max(1);
    // The last row of each group is shown.
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
            notes.push(format!("{STORE}: {bad} values of {name} are not numbers and are left blank"));
        }
        let values = thinned(name, values, &shown, points);
        let range = range(values.iter().copied());
        packed.push(json!({ "name": name, "range": range, "chunk": pack.add(&Packed::rounded(values.into_iter())) }));
    }
    let (along, several_lines) = end_to_end(positions);
    let times: Vec<f64> = shown.iter().map(|&row| times[row]).collect();
    let coordinates = [0, 1].map(|i| pack.add(&Packed::exact(&places.iter().map(|x| x[i]).collect::<Vec<_>>())));
    json!({
        "contact": contact,
        "number": number,
        "from": STORE,
        "rows": shown.len(),
        "points": points,
        "several_lines": several_lines,
        "times": pack.add(&Packed::exact(&times)),
        "positions": pack.add(&Packed::exact(&along)),
        "places": coordinates,
        "lines": pack.add(&Packed::counts(&lines.iter().map(|&line| line as u32).collect::<Vec<_>>())),
        "quantities": packed,
    })
}

/// Smallest and largest of all numbers.
pub fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let numbers = values.filter(|value| value.is_finite());
    let [low, high] = numbers.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], value| [value.min(a), value.max(b)]);
    if low <= high { [low, high] } else { [0.0, 0.0] }
}

/// Bounds that contain nearly all numbers, except a fiftieth at either end. Zeros, where nothing happens, lie between them and
/// are not counted.
pub fn most(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let mut numbers: Vec<f64> = values.filter(|value| value.is_finite()).collect();
    let all = numbers.len();
    numbers.retain(|value| *value != 0.0);
    let zero = if numbers.len() < all { 0.0 } else { f64::NAN };
    let last = numbers.len().saturating_sub(1);
    let mut at = |k: usize| if numbers.is_empty() { 0.0 } else { *numbers.select_nth_unstable_by(k, f64::total_cmp).1 };
    [at(last / 50).min(zero), at(last - last / 50).max(zero)]
}
