//! Whether supports that meet at a node agree, throughout a step.
//!
//! Two directions determine the displacement of a node, u = D⁻¹ ū. A third one agrees if d₃·u = ū₃ at all times of the step; values are
//! compared at evenly spaced times and at those of tables. A value that is reached from the position at the start depends on that
//! position: none at the start of the run, later the one at which the others hold the node then.

use nalgebra::{Matrix2, Vector2};

use super::groups::TIMES;
use crate::model::boundary::{Drive, Span};
use crate::model::support::Inclined;

/// Relative tolerance of values that agree.
const ROUNDED: f64 = 1e-9;

/// An instant at which supports contradict each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clash {
    /// run time
    pub time: f64,
    /// displacement along the third direction by the first two [L]
    pub moved: f64,
    /// displacement that the third support gives [L]
    pub said: f64,
}

/// How a drive depends on the position at the start of the step.
#[derive(PartialEq, Eq)]
enum From {
    /// It counts from there
    Counts,
    /// It comes from there
    Comes,
    /// Not at all
    Nowhere,
}

fn from(drive: &Drive) -> From {
    match drive {
        Drive::Rate(_) => From::Counts,
        Drive::Constant(_) | Drive::ByPlace(..) => From::Comes,
        Drive::Table(_) | Drive::Expression(_) => From::Nowhere,
    }
}

/// The first instant at which the third support contradicts the first two of a node; `inverse` is D⁻¹ of these.
pub fn clash(
    position: Vector2<f64>,
    two: [&Inclined; 2],
    inverse: Matrix2<f64>,
    third: &Inclined,
) -> Result<(), Clash> {
    let value = |of: &Inclined, time: f64, start: Vector2<f64>| {
        of.drive.value(position, time, of.span, of.direction.dot(&start))
    };
    let span = third.span;
    let all = [two[0], two[1], third];
    let alike = all.iter().all(|of| from(&of.drive) == from(&third.drive));
    let start = if alike || span.start == 0.0 {
        Vector2::zeros()
    } else {
        // What comes to its value has come to it in an earlier step.
        let constrained = two.map(|of| match of.drive {
            Drive::Constant(end) => end,
            _ => value(of, span.start, Vector2::zeros()),
        });
        inverse * Vector2::from(constrained)
    };
    let compared = |time: f64| {
        let constrained = two.map(|of| value(of, time, start));
        let moved = third.direction.dot(&(inverse * Vector2::from(constrained)));
        let said = value(third, time, start);
        let size = constrained.into_iter().chain([said]).map(f64::abs).fold(0.0, f64::max);
        (Clash { time, moved, said }, size)
    };
    let all: Vec<(Clash, f64)> = times(span, &all.map(|of| &of.drive)).map(compared).collect();
    let size = all.iter().map(|(_, size)| *size).fold(0.0, f64::max);
    let clashes = |Clash { moved, said, .. }: &Clash| (moved - said).is_nan() || (moved - said).abs() > ROUNDED * size;
    all.into_iter().map(|(at, _)| at).find(clashes).map_or(Ok(()), Err)
}

/// Whether two motions along one direction agree.
pub fn is_same(position: Vector2<f64>, [a, b]: [&Inclined; 2]) -> bool {
    let across = Inclined {
        share: 1.0,
        direction: Vector2::new(-a.direction.y, a.direction.x),
        drive: Drive::Constant(0.0),
        span: a.span,
    };
    let rows = [a.direction.transpose(), across.direction.transpose()];
    Matrix2::from_rows(&rows).try_inverse().is_some_and(|inverse| clash(position, [a, &across], inverse, b).is_ok())
}

/// Whether a drive moves nothing at a position within a step, beyond a tolerance [L].
pub fn rests(drive: &Drive, position: Vector2<f64>, span: Span, tolerance: f64) -> bool {
    times(span, &[drive]).all(|time| drive.value(position, time, span, 0.0).abs() <= tolerance)
}

/// Times at which motions are compared.
fn times<'d>(span: Span, drives: &[&'d Drive]) -> impl Iterator<Item = f64> + use<'d> {
    let tables: Vec<&'d [[f64; 2]]> = drives
        .iter()
        .filter_map(|drive| match drive {
            Drive::Table(table) => Some(&table[..]),
            _ => None,
        })
        .collect();
    let kinks = tables.into_iter().flatten().map(|[time, _]| *time);
    span.times(TIMES).skip(1).chain(kinks.filter(move |time| span.start < *time && *time <= span.end))
}
