//! Snapshots of the tractions along an interface.

use std::ops::Range;

use super::axis::Axis;
use super::chart::{Curve, Figure, Look, Panel};
use super::interface::Interface;
use super::source::{Source, Units, subtitle};

/// Times that are shown of an interface without events.
const TIMES: usize = 6;

/// Rows that are shown with the words for them: of the largest event its start, thirds of the way of its front, when the
/// front has arrived everywhere it goes, and its end; the last row of the run.
fn rows(interface: &Interface, fast: f64) -> Vec<(usize, &'static str)> {
    let last = interface.times.len() - 1;
    let Some(event) = interface.largest_events(fast, 1).pop() else {
        return (1..=TIMES).map(|k| (k * last / TIMES, "")).collect();
    };
    let Range { start, end } = event.rows;
    let reaching = |share: f64| interface.row_reaching(&event, share, fast);
    vec![
        (start.saturating_sub(1), "before the largest event"),
        (reaching(1.0 / 3.0), "a third of its length slips"),
        (reaching(2.0 / 3.0), "two thirds"),
        (reaching(1.0), "all of its length"),
        (end - 1, "it has ended"),
        (last, "end of the run"),
    ]
}

/// The figure of an interface: traction and strength at a handful of times.
pub fn figure(interface: &Interface, name: &str, source: &Source) -> Figure {
    let units = Units::of(std::slice::from_ref(source));
    let mut rows = rows(interface, interface.fast(source.about.front_slip_rate));
    rows.dedup_by_key(|(row, _)| *row);
    let start = interface.times[rows[0].0];
    // All panels have the same axes.
    let all = rows.iter().flat_map(|(row, _)| [interface.tractions(*row), interface.strengths(*row)].concat());
    let (low, high) = all.fold((0.0, 0.0), |(low, high): (f64, f64), q| (low.min(q), high.max(q)));
    let panel = |&(row, what): &(usize, &str)| {
        let points = |values: &[f64]| {
            let mut points: Vec<[f64; 2]> =
                interface.positions.iter().zip(values).map(|(s, value)| [*s, *value]).collect();
            points.sort_by(|a, b| a[0].total_cmp(&b[0]));
            points
        };
        let curves = vec![
            Curve { name: "traction q".into(), points: points(interface.tractions(row)), look: Look::Line(0) },
            Curve { name: "peak μ p".into(), points: points(interface.strengths(row)), look: Look::Bound(0) },
        ];
        let since = interface.times[row] - start;
        let (time, unit) = (format!("{start:.6}"), units.get("time"));
        let when = if since > 0.0 { format!("{time} + {since:.2e} {unit}") } else { format!("{time} {unit}") };
        let title = if what.is_empty() {
            format!("t = {}", when.trim_end())
        } else {
            format!("{what}: t = {}", when.trim_end())
        };
        Panel {
            title,
            x: Axis::new("position along the slave", units.get("length")),
            y: Axis::new("traction", units.stress()).including(low).including(high),
            curves,
        }
    };
    Figure {
        title: format!("Tractions along {name}"),
        subtitle: subtitle(std::slice::from_ref(source)),
        columns: 2,
        panels: rows.iter().map(panel).collect(),
    }
}
