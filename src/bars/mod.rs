//! Bars: trusses, beams, anchors and geogrids along a polyline of vertices.
//!
//! A vertex is a node, or a point of a body that moves with the nodes of its element. What a bar exerts follows from vectors that are
//! linear in the displacements of nodes ([`vectors`]), so that shared nodes, points of bodies, clamped ends and bond need no
//! constraints:
//!
//! ```text
//! e = x_b − x_a                                            a segment, between two vertices
//! N = EA (ε − ε_l),   ε = (|e| − l)/l                       ([`segment`]), l: its length when it came
//! M = EI (θ − θ₀)/l_m                                       ([`turn`]), θ: angle between two segments
//! q(s), k_n v along and across a segment                   ([`grip`]), at points that lie in a body
//! ```
//! This is the discrete elastic rod in the plane: the edges are straight, rotations are as large as they come, all forces derive
//! from energies of invariants, so that momentum and angular momentum are kept and tangents are symmetric, and errors are of second
//! order in the length of a segment. The angle itself, not a function of it, is taken for the curvature: under constant moment the
//! rotations are exact then.

pub mod fields;
pub mod grip;
pub mod segment;
pub mod turn;
pub mod vectors;

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use grip::{Grip, GripState};
use segment::{Segment, SegmentState};
use turn::{Turn, TurnState};
use vectors::{Answer, Vertex};

/// A bar.
#[derive(Clone, Debug, PartialEq)]
pub struct Bar {
    /// name
    pub name: String,
    /// EA: axial stiffness [F]
    pub ea: f64,
    /// EI: bending stiffness, 0 for a truss [F L²]
    pub ei: f64,
    /// Largest |N|; infinite without one [F]
    pub limit: f64,
    /// mass per length [M/L]
    pub mass: f64,
    /// η: damping force per momentum [1/T]
    pub drag: f64,
    /// τ: time by which EA and EI are multiplied to resist the rates of stretch and curvature [T]
    pub retardation: f64,
    /// vertices along it
    pub vertices: Vec<Vertex>,
    /// segments, between one vertex and the next
    pub segments: Vec<Segment>,
    /// angles between segments, and at clamped ends
    pub turns: Vec<Turn>,
    /// points that are bonded to a body
    pub grips: Vec<Grip>,
    /// bodies that it is joined to
    pub bodies: Vec<String>,
    /// nodes that belong to it alone, ascending
    pub own: Vec<usize>,
    /// whether some of these are between its ends
    pub is_free_between: bool,
}

/// State of a bar.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BarState {
    /// whether it is there
    pub is_there: bool,
    /// that of each segment
    pub segments: Vec<SegmentState>,
    /// that of each angle
    pub turns: Vec<TurnState>,
    /// that of each bonded point
    pub grips: Vec<GripState>,
    /// stored by stretching and bending [F·L]
    pub strain: f64,
    /// stored by bond [F·L]
    pub bonded: f64,
    /// dissipated by yielding in the last increment [F·L]
    pub plastic: f64,
    /// dissipated by bond in the last increment [F·L]
    pub friction: f64,
    /// work of the jack in the last increment [F·L]
    pub jacked: f64,
}

impl BarState {
    /// Whether it has as many parts as a bar.
    pub fn fits(&self, bar: &Bar) -> bool {
        [self.segments.len(), self.turns.len(), self.grips.len()]
            == [bar.segments.len(), bar.turns.len(), bar.grips.len()]
    }
}

impl Bar {
    /// Length of the polyline at the start [L].
    pub fn length(&self) -> f64 {
        self.segments.iter().map(|segment| segment.length).sum()
    }

    /// Position of each vertex along the polyline at the start [L].
    pub fn places(&self) -> Vec<f64> {
        let ends = self.segments.iter().scan(0.0, |sum, segment| {
            *sum += segment.length;
            Some(*sum)
        });
        std::iter::once(0.0).chain(ends).collect()
    }

    /// Masses of its nodes: those of a vertex are shared by their weights, but for nodes without mass [M].
    pub fn nodal_masses<'a>(&'a self, massless: &'a [bool]) -> impl Iterator<Item = (usize, f64)> + 'a {
        self.vertices.iter().zip(self.masses()).flat_map(move |(vertex, mass)| {
            let share = |(node, weight): (usize, f64)| if massless[node] { 0.0 } else { weight.abs() };
            let total: f64 = vertex.terms().map(share).sum();
            vertex.terms().filter(move |_| total > 0.0).map(move |term| (term.0, mass * share(term) / total))
        })
    }

    /// Nodes with their share of the mass, and the place in the mesh of the vertex that has it: the weight per acceleration [M].
    pub fn weights(&self) -> impl Iterator<Item = (usize, f64, Vector2<f64>)> + '_ {
        let of = |(vertex, mass): (&'_ Vertex, f64)| {
            let shares: Vec<_> = vertex.terms().map(|(node, weight)| (node, mass * weight, vertex.at)).collect();
            shares
        };
        self.vertices.iter().zip(self.masses()).flat_map(of)
    }

    /// Masses of the vertices: half of those of the segments on both sides [M].
    fn masses(&self) -> Vec<f64> {
        let mut masses = vec![0.0; self.vertices.len()];
        for (k, segment) in self.segments.iter().enumerate() {
            let half = 0.5 * self.mass * segment.length;
            masses[k] += half;
            masses[k + 1] += half;
        }
        masses
    }

    /// Bounds of the stiffness at its nodes, by Gershgorin's theorem: the sum of a row of a part, in magnitude.
    pub fn bounds(&self, mut add: impl FnMut(usize, f64)) {
        let mut of = |vectors: &vectors::Vectors, stiffness: f64, slopes: [f64; 2]| {
            let size = |shares: [f64; 2]| (shares[0] * slopes[0]).abs() + (shares[1] * slopes[1]).abs();
            let total: f64 = vectors.terms().map(|(_, shares)| size(shares)).sum();
            vectors.terms().for_each(|(node, shares)| add(node, stiffness * size(shares) * total));
        };
        for segment in &self.segments {
            of(&segment.vectors, self.ea / segment.length, [1.0, 0.0]);
        }
        for turn in &self.turns {
            of(&turn.vectors, self.ei / turn.length, turn.vectors.at.map(|e| 1.0 / e.norm()));
        }
        for grip in &self.grips {
            of(&grip.vectors, grip.length * grip.bond.stiffness().max(grip.normal), [1.0, 0.0]);
        }
    }

    /// Groups of nodes that it couples.
    pub fn groups(&self) -> impl Iterator<Item = &[usize]> {
        let segments = self.segments.iter().map(|segment| segment.vectors.nodes());
        let turns = self.turns.iter().map(|turn| turn.vectors.nodes());
        let grips = self.grips.iter().map(|grip| grip.vectors.nodes());
        segments.chain(turns).chain(grips).chain(self.vertices.iter().map(|vertex| &vertex.nodes[..]))
    }

    /// All nodes that it acts on, ascending.
    pub fn nodes(&self) -> Vec<usize> {
        let mut nodes: Vec<usize> = self.groups().flatten().copied().collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }

    /// State of a bar without forces that comes at displacements.
    pub fn activated(&self, u: &[f64]) -> BarState {
        BarState {
            is_there: true,
            segments: self.segments.iter().map(|segment| segment.activated(u)).collect(),
            turns: self.turns.iter().map(|turn| turn.activated(u)).collect(),
            grips: self.grips.iter().map(|grip| grip.activated(u)).collect(),
            ..BarState::default()
        }
    }

    /// State of a bar that is not there.
    pub fn absent(&self, u: &[f64]) -> BarState {
        BarState { is_there: false, ..self.activated(u) }
    }

    /// Viscous forces of its retardation at displacements and velocities: `add` takes those of each part, with the derivatives by the
    /// displacements, and with those by the velocities.
    pub fn resist(&self, state: &BarState, [u, v]: [&[f64]; 2], mut add: impl FnMut(&vectors::Vectors, [Answer; 2])) {
        for (segment, state) in self.segments.iter().zip(&state.segments) {
            let c = self.retardation * self.ea / (segment.length + state.natural);
            add(&segment.vectors, Answer::viscous(c, segment.stretch(u), segment.vectors.ways(v)));
        }
        for turn in &self.turns {
            let c = self.retardation * self.ei / turn.length;
            add(&turn.vectors, Answer::viscous(c, turn.bend(u), turn.vectors.ways(v)));
        }
    }

    /// Evaluates the bar at displacements: `add` takes the nodes, forces and tangent of each part. A jack sets its
    /// force to a value; `pressures` are those of the body at the bonded points, if they count.
    pub fn respond(
        &self,
        old: &BarState,
        u: &[f64],
        jack: Option<f64>,
        pressures: &[f64],
        mut add: impl FnMut(&[usize], &Answer, &vectors::Vectors),
    ) -> BarState {
        let mut state = BarState { is_there: true, ..BarState::default() };
        // Between free nodes the force of the first segment is that of all others.
        let jacked = if self.is_free_between { 1 } else { self.segments.len() };
        for (k, (segment, old)) in self.segments.iter().zip(&old.segments).enumerate() {
            let (answer, found) = segment.respond(self, old, u, jack.filter(|_| k < jacked));
            add(segment.vectors.nodes(), &answer, &segment.vectors);
            state.strain += found.stored;
            state.plastic += found.plastic;
            state.jacked += found.jacked;
            state.segments.push(found.state);
        }
        for (turn, old) in self.turns.iter().zip(&old.turns) {
            let (answer, found, stored) = turn.respond(self.ei, old, u);
            add(turn.vectors.nodes(), &answer, &turn.vectors);
            state.strain += stored;
            state.turns.push(found);
        }
        for (k, (grip, old)) in self.grips.iter().zip(&old.grips).enumerate() {
            let pressure = pressures.get(k).copied().unwrap_or(0.0);
            let (answer, found) = grip.respond(old, u, pressure);
            add(grip.vectors.nodes(), &answer, &grip.vectors);
            state.bonded += found.stored;
            state.friction += found.dissipated;
            state.grips.push(found.state);
        }
        state
    }
}
