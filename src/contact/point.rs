//! A contact point: where it is on both sides, what it remembers, and what a linear solve presumes about it.
//!
//! # Points
//!
//! Points of the two sides of a contact: where it is evaluated on the slave, and where they meet the master.
//!
//! # State
//!
//! What a contact point remembers between increments, and what it says of itself.
//!
//! # Presumptions
//!
//! The increment in which a contact is evaluated, and what a linear solve presumes about a point of it.

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use crate::laws::friction::{FrictionState, Regime};
use crate::mesh::configuration::Configuration;
use crate::mesh::few::Few;
use crate::mesh::shape;

/// A linear combination of nodal positions, Σ w_a x_a.
pub type Weights = Vec<(usize, f64)>;

/// Contribution of one edge to the tributary length of a slave point: `factor` × |Σ w_a x_a| × w of the section there.
#[derive(Clone, Debug, PartialEq)]
pub struct LengthShare {
    /// Quadrature weight
    pub factor: f64,
    /// Shape functions of the quadrature point
    pub at: Weights,
    /// Weights of the tangent vector dx/dξ
    pub tangent: Weights,
}

/// A point of the slave surface where contact is evaluated.
#[derive(Clone, Debug, PartialEq)]
pub struct SlavePoint {
    /// Shape functions of the point
    pub position: Weights,
    /// Its current length is the sum of these shares and `area` [L]
    pub length: Vec<LengthShare>,
    /// Area of a point that belongs to no edge, as a point mass has it, given as a whole; it does not change [L]
    pub area: f64,
    /// Gap between the surfaces at which the point touches: 0, but for a contact that starts closed under a given
    /// pressure [L]
    pub touch: f64,
    /// Number of its friction law among those of the pair
    pub law: usize,
    /// Initial overlap of the point in a shrink fit, applied gradually over the first step [L]
    pub overlap: f64,
}

impl SlavePoint {
    /// Current position of the point.
    pub fn at(&self, x: &Configuration) -> Vector2<f64> {
        let [reference, displacement] = x.apart(&self.position, Vector2::zeros());
        reference + displacement
    }

    /// g: gap of the surfaces − gap at touch, an overlap counted but for the share that fades.
    pub fn gap(&self, surfaces: f64, fading: f64) -> f64 {
        surfaces - self.touch + fading * self.overlap
    }

    /// x − x_node.
    pub fn offset(&self, node: usize, x: &Configuration) -> Vector2<f64> {
        self.position.iter().map(|&(own, w)| x.between(node, own) * w).sum()
    }

    /// Current tributary length of the point [L].
    pub fn current_length(&self, x: &Configuration) -> f64 {
        let weighted = |share: &LengthShare| share.factor * x.combine(&share.tangent).norm() * x.weight(&share.at);
        self.area + self.length.iter().map(weighted).sum::<f64>()
    }

    /// Current length of the longest edge the point belongs to, if it belongs to any [L].
    pub fn edge_length(&self, x: &Configuration) -> Option<f64> {
        // dx/dξ on an edge from −1 to 1 is half its length.
        self.length.iter().map(|share| 2.0 * x.combine(&share.tangent).norm()).max_by(f64::total_cmp)
    }

    /// Unit normal out of the slave body: the edge direction, body on its left, turned by −90°. A point of no edge has
    /// none.
    pub fn outward(&self, x: &Configuration) -> Option<Vector2<f64>> {
        let along: Vector2<f64> = self.length.iter().map(|share| x.combine(&share.tangent) * share.factor).sum();
        (!self.length.is_empty()).then(|| Vector2::new(along.y, -along.x).normalize())
    }
}

/// The points of a slave surface: Gauss points of each edge, or its nodes.
///
/// `edges` are (start, end[, middle]) with the body on the left, in order along the surface.
pub fn gauss_points(edges: &[Vec<usize>], per_edge: usize) -> Vec<SlavePoint> {
    let rule = shape::gauss(per_edge);
    edges.iter().flat_map(|edge| rule.iter().map(|&(xi, weight)| edge_point(edge, xi, weight))).collect()
}

/// Nodes with their tributary lengths: the end-point rule (linear edges) or Simpson's (quadratic edges).
pub fn nodal_points(edges: &[Vec<usize>]) -> Vec<SlavePoint> {
    at_nodes(edges, |edge, xi, weight| edge_point(edge, xi, weight).length)
}

/// Nodes of rings with their tributary areas ∫ N_a 2π r ds, by Gauss's rule: the rules above know r at the nodes alone, and
/// leave nothing to one on the axis. (Nor has the end of a quadratic edge anything there in truth.)
pub fn nodal_points_of_rings(edges: &[Vec<usize>]) -> Vec<SlavePoint> {
    let shares = |edge: &[usize], node: f64| -> Vec<LengthShare> {
        let share = |(xi, weight): (f64, f64)| edge_point(edge, xi, 0.5 * (1.0 + node * xi) * weight).length;
        shape::gauss(2).into_iter().flat_map(share).collect()
    };
    at_nodes(edges, |edge, xi, weight| match edge.len() {
        2 => shares(edge, xi),
        _ => edge_point(edge, xi, weight).length,
    })
}

/// The nodes with what each edge gives them, by their ξ and the weight of the rule.
fn at_nodes(edges: &[Vec<usize>], shares: impl Fn(&[usize], f64, f64) -> Vec<LengthShare>) -> Vec<SlavePoint> {
    let mut points: Vec<(usize, SlavePoint)> = Vec::new();
    for edge in edges {
        let ends = [(edge[0], -1.0), (edge[1], 1.0)];
        let stations: Vec<(usize, f64, f64)> = match edge.get(2) {
            None => ends.map(|(node, xi)| (node, xi, 1.0)).to_vec(),
            Some(&middle) => vec![(ends[0].0, -1.0, 1.0 / 3.0), (middle, 0.0, 4.0 / 3.0), (ends[1].0, 1.0, 1.0 / 3.0)],
        };
        for (node, xi, weight) in stations {
            let share = shares(edge, xi, weight);
            match points.iter_mut().rev().find(|(other, _)| *other == node) {
                Some((_, point)) => point.length.extend(share),
                None => points.push((node, SlavePoint { length: share, ..lone_point(node, 0.0) })),
            }
        }
    }
    points.into_iter().map(|(_, point)| point).collect()
}

/// A node that belongs to no edge, with an area of its own [L].
pub fn lone_point(node: usize, area: f64) -> SlavePoint {
    SlavePoint { position: vec![(node, 1.0)], length: Vec::new(), area, touch: 0.0, law: 0, overlap: 0.0 }
}

/// The point of an edge at ξ, with its share of the edge's length as tributary length.
pub fn edge_point(edge: &[usize], xi: f64, weight: f64) -> SlavePoint {
    let with = |values: Few<f64, 3>| -> Weights { edge.iter().copied().zip(values).collect() };
    let position = with(shape::edge_values(edge.len(), xi));
    let tangent = with(shape::edge_derivatives(edge.len(), xi));
    SlavePoint {
        length: vec![LengthShare { factor: weight, at: position.clone(), tangent }],
        position,
        area: 0.0,
        touch: 0.0,
        law: 0,
        overlap: 0.0,
    }
}

/// A material point of the master: segment and coordinate along it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct MasterPoint {
    /// Segment number; of a rigid body the number of its line
    pub segment: usize,
    /// 0 … 1 along the segment; on a rigid body the arc length along s (of line number `segment`) from where the
    /// point's reference position has its foot [-] or [L]
    pub xi: f64,
}

/// Memory of one contact point between increments.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ContactState {
    /// What friction remembers
    pub friction: FrictionState,
    /// Foot on the master, open or closed; `None` where no part of the master faces the point
    pub foot: Option<MasterPoint>,
    /// Tributary length of the point: its own or, by mortar, the part of it that the master faces; once open, the last
    /// one (that of now where a fluid acts) [L]
    pub length: f64,
    /// g at the foot; a contact that starts closed counts it from where its points touch [L]
    pub gap: f64,
    /// Δu_t of the last increment, what came before touch included; 0 while open [L]
    pub slip: f64,
    /// η v of the last increment, what slip radiates; 0 without radiation damping, and in dynamic steps [F/L²]
    pub radiation: f64,
    /// Energy radiated so far per contact area [F/L]
    pub radiated: f64,
    /// p̄: pressure at zero gap, raised until the penetration is small enough; 0 for the plain penalty [F/L²]
    pub multiplier: f64,
    /// e: elastic slip that the multiplier of the traction leaves, lowered until it is small enough; 0 for the plain penalty [L]
    pub elastic_slip: f64,
    /// p_w: pressure of the fluid where the master faces the point [F/L²]
    pub fluid: f64,
}

impl ContactState {
    /// g − d: what parts the surfaces beyond the opening of the law, negative under the penalty [L]
    pub fn clearance(&self) -> f64 {
        self.gap - self.friction.opening
    }

    /// p and q + η v: what the surfaces put on each other, friction and what slip radiates together [F/L²]
    pub fn tractions(&self) -> [f64; 2] {
        [self.friction.pressure, self.friction.traction + self.radiation]
    }

    /// Whether a point is open at a gap that counts, more than [`ContactPair::touch`](super::pair::ContactPair::touch).
    pub fn apart(&self, touch: f64) -> bool {
        !self.is_closed() && self.clearance() > touch
    }

    /// Whether the surfaces press on each other, or are tied.
    pub fn is_closed(&self) -> bool {
        self.friction.pressure > 0.0 || self.friction.regime == Regime::Tied
    }

    /// Open, stick or slip, as the law says; a point that only a promise keeps closed is open.
    pub fn regime(&self) -> Regime {
        if self.is_closed() { self.friction.regime } else { Regime::Open }
    }
}

/// Time, increment and step data at which a pair is evaluated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactIncrement {
    /// t at its end [T]
    pub time: f64,
    /// Δt [T]
    pub dt: f64,
    /// Whether slip radiates, where the contact has a radiation damping: in motions without inertia
    pub radiates: bool,
    /// Share of an initial overlap that does not count yet
    pub fading: f64,
    /// α_n is this many times the one given: [`super::pair::ContactPair::normal_stiffness`]
    pub stiffening: f64,
    /// Whether the bodies deform under the pressures that arise within the increment
    pub settles: bool,
}

impl ContactIncrement {
    /// Start and end time of the increment.
    pub fn span(&self) -> [f64; 2] {
        [self.time - self.dt, self.time]
    }
}

/// Increment of a contact point, and what the iteration presumes about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointIncrement {
    /// Length of the increment, and what it changes about every point
    pub during: ContactIncrement,
    /// What the linear solve presumes about the point
    pub presumption: Presumption,
}

/// Data of a point that a linear solve takes over from earlier ones; empty in an accepted state.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Presumption {
    /// Presumption about its state
    pub presume: Presume,
    /// Tractions that the tangent turns and stretches with the surface; those of the trial state unless given
    pub promised: Option<Tractions>,
    /// Pressure of a point that is closed whatever its gap, and under which friction answers unless its own is positive;
    /// none if it is 0
    pub kept: f64,
    /// Pressure under which friction answers, and beyond which its response is extrapolated linearly, at a point that
    /// has just closed: a stiff penalty presses a point far too hard that goes too deep in one iterate, and would make
    /// it stick where it is to slip.
    pub carried: Option<f64>,
    /// Two segments between which its projection alternates
    pub astride: Option<[usize; 2]>,
}

/// Assumption of the next linear solve about a point, for convergence; an accepted state assumes nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Presume {
    /// The laws answer as they are
    #[default]
    Nothing,
    /// A zero gap is closed and sticks: it would open and close for ever at p = 0
    Touch,
    /// The point sticks, q = q₀ + α_t Δu_t whatever its size. From one iterate to the next it slipped one way and then
    /// the other, past the narrow and stiff range of sticking that lies between: the tangents on both sides are soft,
    /// and Newton's method would jump to and fro for ever. It is presumed again where the point then slips although the
    /// tractions that were promised would have held it.
    Stick,
}

/// Pressure and traction of a point, as one linear solve promised them to the next.
///
/// A stiff penalty turns every error of a displacement into a pressure far too high, and that into a geometric
/// stiffness p δn ℓ that leads the next iterate astray, or opens a point that should be closed. The promise p + δp of
/// the linear solve is off by the square of the correction only: it makes the geometric stiffness, and says which
/// points stay closed. The residual of a solution contains no predicted pressures.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tractions {
    /// p [F/L²]
    pub pressure: f64,
    /// q [F/L²]
    pub traction: f64,
}

impl Tractions {
    /// Tractions of a friction state.
    pub fn of(friction: &FrictionState) -> Self {
        Self { pressure: friction.pressure, traction: friction.traction }
    }

    /// Both scaled by one factor, so that the pressure does not exceed a limit.
    pub fn limited(self, most: f64) -> Self {
        let share = if self.pressure > most { most / self.pressure } else { 1.0 };
        Self { pressure: share * self.pressure, traction: share * self.traction }
    }
}
