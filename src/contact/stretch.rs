//! Closed stretches of a slave surface between open parts that curve away, and how long the contact there really is.
//!
//! On edges that are longer than a contact its points are closed one or two at a time. Their force is about right, and so are the gaps at
//! open points some edges away: by Hertz's theory the two tell the half-width a, without the radii of the surfaces.
//!
//! ```text
//! a² = 4 F R/(π E*)          g(x) π E*/2F = s √(s² − 1) − arcosh s                                   in a plane, F: force per depth
//! a³ = 3 F R/(4 E*)          g(r) 4 r E*/3F = s ((s² − 2)(½ − arcsin(1/s)/π) + √(s² − 1)/π)          about an axis
//! s = x/a, E* = G*: 1/E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂
//! ```
//! Where a gap grows in proportion to the distance surfaces meet at a corner. There one point is right where a block rests on its side; a ridge,
//! which presses with both flanks of slope m, has the width of contact of a wedge,
//!
//! ```text
//! 2a = 2 F/(m E*)
//! ```
//! and bears too much on longer edges, by as much as these are longer. Source: K. L. Johnson, Contact Mechanics, 1985, chapters 3, 4 and 5.

use nalgebra::Vector2;

use super::master::{Master, Shape};
use super::pair::ContactPair;
use super::point::ContactState;
use super::scatter::PointSequence;
use super::surface::{CORNER, Surface};
use crate::mesh::configuration::Configuration;

/// A contact between curved surfaces, as its points see it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// Its middle [L]
    pub at: Vector2<f64>,
    /// Number of its closed points
    pub closed: usize,
    /// Whether it is a ridge that presses
    pub is_ridge: bool,
    /// 2a by Hertz's theory or of a wedge, or the distance between the outermost closed points where that is more, as of bodies that yield or are thin [L]
    pub length: f64,
    /// Longest edge of both surfaces there [L]
    pub edge: f64,
    /// Tractions that an edge can have of its own: 2 on quadratic edges but by mortar, which has one, else 1
    pub per_edge: f64,
}

/// Least power of the distance by which the gap beside a contact of curved surfaces grows; it is 2 or more in Hertz's theory, and 1 or
/// less at a corner [-]
const CURVED: f64 = 1.4;

/// Lengths of closed stretches that are not looked at, over an edge.
const LONG: f64 = 8.0;

/// Distance of the nearer of two open points from the closed ones, and between the two, in edges.
const SEPARATED: [f64; 2] = [0.5, 0.9];

/// Number of bisections for s.
const HALVINGS: usize = 60;

/// An open point: its distance from the middle of the contact and its gap [L].
#[derive(Clone, Copy, Debug)]
struct Open {
    way: f64,
    gap: f64,
}

/// What is beside a closed stretch on one side.
#[derive(Clone, Copy, Debug)]
enum Side {
    /// The surface ends: number of the closed point there
    End(usize),
    /// Open points, with the number of the first of them
    Open([Open; 2], usize),
}

/// Surface, state and configuration of a contact.
struct Seen<'a> {
    pair: &'a ContactPair,
    states: &'a [ContactState],
    x: &'a Configuration<'a>,
    sequence: PointSequence,
    /// Longest edge at the closed stretch
    edge: f64,
}

impl ContactPair {
    /// The closed stretch that bears most, if both its sides open as curved surfaces do, or one does and the slave ends at a line of
    /// symmetry on the other: at a node that is constrained along the surface. None where gaps are not those of the surfaces.
    pub fn stretch(
        &self,
        states: &[ContactState],
        x: &Configuration,
        is_constrained: impl Fn(usize, Vector2<f64>) -> bool,
    ) -> Option<Stretch> {
        if self.tied || self.is_own() || self.initial.is_some() || self.modulus <= 0.0 || self.is_offset() {
            return None;
        }
        let [first, last] = most_loaded(states)?;
        let edges = (first..=last).filter_map(|k| self.edge_at(k, &states[k], x));
        let (edge, per_edge) = edges.max_by(|a, b| (a.0 / a.1).total_cmp(&(b.0 / b.1)))?;
        let force = |k: usize| states[k].contact_pressure() * states[k].length;
        let total: f64 = (first..=last).map(force).sum();
        let places = (first..=last).map(|k| self.points[k].at(x) * force(k));
        let centre = places.sum::<Vector2<f64>>() / total;
        if let Some(slope) = self.ridge_at(centre, edge, x) {
            let closed: f64 = states[first..=last].iter().map(|state| state.length).sum();
            let weight = x.section().weight(centre);
            let length = (2.0 * total / (weight * slope * self.modulus)).max(closed / weight);
            return Some(Stretch { at: centre, closed: last + 1 - first, is_ridge: true, length, edge, per_edge });
        }
        let seen = Seen { pair: self, states, x, sequence: PointSequence::new(&self.points, x), edge };
        let ways: Vec<f64> =
            std::iter::once(Some(0.0)).chain((first..last).map(|k| seen.sequence.after(k))).collect::<Option<_>>()?;
        let ways: Vec<f64> = ways
            .iter()
            .scan(0.0, |sum, way| {
                *sum += way;
                Some(*sum)
            })
            .collect();
        let span = ways[ways.len() - 1];
        if span > LONG * edge {
            return None;
        }
        let middle = (first..=last).zip(&ways).map(|(k, way)| force(k) * way).sum::<f64>() / total;
        let [before, after] = [seen.side(first, false, middle)?, seen.side(last, true, span - middle)?];
        let (at, doubled, opens) = match [before, after] {
            [Side::Open(before, left), Side::Open(after, right)] => {
                if self.corner_between(left, right, states, x) {
                    return None;
                }
                let mean = |k: usize| Open {
                    way: 0.5 * (before[k].way + after[k].way),
                    gap: 0.5 * (before[k].gap + after[k].gap),
                };
                (centre, 1.0, [mean(0), mean(1)])
            }
            [Side::End(end), Side::Open(opens, other)] | [Side::Open(opens, other), Side::End(end)] => {
                if self.corner_between(end.min(other), end.max(other), states, x) {
                    return None;
                }
                let at = seen.constrained_end(end, other, is_constrained)?;
                // From the line of symmetry, and not from the middle of the half that is there.
                let arm = if end == first { middle } else { span - middle } + (self.points[end].at(x) - at).norm();
                (at, 2.0, opens.map(|open| Open { way: open.way + arm, ..open }))
            }
            _ => return None,
        };
        let [near, far] = opens;
        let power = (far.gap / near.gap).ln() / (far.way / near.way).ln();
        if near.gap > 0.0 && power < CURVED {
            return None;
        }
        let on_axis = x.section().is_axisymmetric() && at.x < edge * f64::EPSILON.sqrt();
        let half = if on_axis {
            half_width(far, 0.75 * total / (self.modulus * far.way), about_axis)
        } else {
            let weight = x.section().weight(at);
            half_width(far, 2.0 * doubled * total / (weight * std::f64::consts::PI * self.modulus), in_plane)
        };
        let length = (2.0 * half).max(doubled * span);
        Some(Stretch { at, closed: last + 1 - first, is_ridge: false, length, edge, per_edge })
    }

    /// Edge of the slave at a point, or of the master under it, whichever has the longer part to a traction, and the number of these parts.
    fn edge_at(&self, k: usize, state: &ContactState, x: &Configuration) -> Option<(f64, f64)> {
        let is_quadratic = self.points[k].length.iter().any(|share| share.tangent.len() > 2);
        let slave = (self.points[k].edge_length(x)?, if is_quadratic && self.mortar.is_none() { 2.0 } else { 1.0 });
        let under = state.master_point.and_then(|master_point| self.master.segments().get(master_point.segment));
        let master = under.map(|segment| {
            let [start, end] = segment.ends;
            (x.between(start, end).norm(), if segment.middle.is_some() { 2.0 } else { 1.0 })
        });
        [Some(slave), master].into_iter().flatten().max_by(|a, b| (a.0 / a.1).total_cmp(&(b.0 / b.1)))
    }

    /// Slope of the flanks of a ridge that presses within an edge of a place.
    fn ridge_at(&self, place: Vector2<f64>, edge: f64, x: &Configuration) -> Option<f64> {
        let (Some(mortar), Master::Mesh(surface)) = (&self.mortar, &self.master) else { return None };
        let (distance, slope) = mortar.nearest_ridge(&self.master, surface, place, x)?;
        (distance < edge).then_some(slope)
    }

    /// Whether the master has a sharp corner between the projections of two points, or near the points between them.
    fn corner_between(&self, from: usize, to: usize, states: &[ContactState], x: &Configuration) -> bool {
        match &self.master {
            Master::Rigid(rigid) => match &rigid.shape {
                Shape::Plane(_) | Shape::Circle(_) => false,
                Shape::Polyline(line) => {
                    let corners: Vec<Vector2<f64>> =
                        line.sharp_corners().map(|corner| rigid.place(corner, x)).collect();
                    self.points[from..=to].iter().any(|point| {
                        let (at, edge) = (point.at(x), point.edge_length(x).unwrap_or(0.0));
                        corners.iter().any(|corner| (corner - at).norm() < edge)
                    })
                }
            },
            Master::Mesh(surface) => {
                let master_points = [states[from].master_point, states[to].master_point];
                let [Some(from), Some(to)] = master_points else { return true };
                surface.path(from, to).is_none_or(|path| bends(surface, path.parts().map(|part| part.segment), x))
            }
        }
    }
}

/// Whether successive segments of a surface meet at a corner.
fn bends(surface: &Surface, segments: impl Iterator<Item = usize>, x: &Configuration) -> bool {
    let along = |segment: usize| {
        let [start, end] = surface.segments[segment].ends;
        x.between(start, end)
    };
    let along: Vec<Vector2<f64>> = segments.map(along).collect();
    along.windows(2).any(|pair| pair[0].dot(&pair[1]) <= CORNER * pair[0].norm() * pair[1].norm())
}

impl Seen<'_> {
    /// What is beside a closed stretch that ends, ahead or back, at a point so far from its middle; none where that is neither the end of the
    /// surface nor open points with a projection.
    fn side(&self, from: usize, ahead: bool, way: f64) -> Option<Side> {
        let step = |k: usize| match ahead {
            true => self.sequence.after(k).map(|way| (k + 1, way)),
            false => k.checked_sub(1).and_then(|before| Some((before, self.sequence.after(before)?))),
        };
        let (mut at, mut gone) = (from, 0.0);
        let mut near: Option<(Open, f64)> = None;
        let Some((first, _)) = step(from) else { return Some(Side::End(from)) };
        while let Some((next, length)) = step(at) {
            (at, gone) = (next, gone + length);
            let state = &self.states[at];
            if state.is_closed() || state.master_point.is_none() {
                return None;
            }
            let open = Open { way: way + gone, gap: state.clearance() };
            match near {
                None if gone >= SEPARATED[0] * self.edge => near = Some((open, gone)),
                Some((near, start)) if gone - start >= SEPARATED[1] * self.edge => {
                    return Some(Side::Open([near, open], first));
                }
                _ => {}
            }
        }
        None
    }

    /// Place of the end of the surface at a closed point, on the side away from another one, if its node is constrained along the surface.
    fn constrained_end(
        &self,
        end: usize,
        other: usize,
        is_constrained: impl Fn(usize, Vector2<f64>) -> bool,
    ) -> Option<Vector2<f64>> {
        let away = self.pair.points[other].at(self.x);
        let nodes = self.pair.points[end].length.iter().flat_map(|share| &share.tangent).map(|&(node, _)| node);
        let distance = |node: &usize| (self.x.at(*node) - away).norm();
        let node = nodes.max_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        let outward = self.pair.points[end].outward(self.x)?;
        is_constrained(node, Vector2::new(-outward.y, outward.x)).then(|| self.x.at(node))
    }
}

/// First and last point of the closed stretch with the largest force.
fn most_loaded(states: &[ContactState]) -> Option<[usize; 2]> {
    let mut runs: Vec<([usize; 2], f64)> = Vec::new();
    for (k, state) in states.iter().enumerate().filter(|(_, state)| state.is_closed()) {
        let force = state.contact_pressure() * state.length;
        match runs.last_mut() {
            Some(([_, last], sum)) if *last + 1 == k => (*last, *sum) = (k, *sum + force),
            _ => runs.push(([k, k], force)),
        }
    }
    let (run, force) = runs.into_iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    (force > 0.0).then_some(run)
}

/// a of a contact under a force, by the gap at a distance over which that has the given unit.
fn half_width(Open { way, gap }: Open, unit: f64, shape: fn(f64) -> f64) -> f64 {
    let (mut inside, mut outside) = (0.0, 1.0);
    for _ in 0..HALVINGS {
        // 1/s between 0 and 1
        let middle = 0.5 * (inside + outside);
        if shape(1.0 / middle) * unit > gap { inside = middle } else { outside = middle }
    }
    way * outside
}

fn in_plane(s: f64) -> f64 {
    s * (s * s - 1.0).sqrt() - s.acosh()
}

fn about_axis(s: f64) -> f64 {
    let turn = std::f64::consts::FRAC_1_PI;
    s * ((s * s - 2.0) * (0.5 - turn * (1.0 / s).asin()) + turn * (s * s - 1.0).sqrt())
}
