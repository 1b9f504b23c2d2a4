//! A contact point: its position on both sides, its state, and predictions of the linear solve.
//!
//! Slave points are the evaluation points of contact; master points are their projections.
//!
//! The state of a contact point is kept between increments.
//!
//! A contact is evaluated in an increment, with predictions of a linear solve about each point.

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use crate::laws::friction::{BondState, FrictionState, Regime};
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
    /// Contributions to its current length, in addition to `area` [L]
    pub length: Vec<LengthShare>,
    /// Constant area of a point without edges, such as a point mass, given as a total [L]
    pub area: f64,
    /// Gap between the surfaces at closure: 0, except for a contact that starts closed under a given pressure [L]
    pub touch: f64,
    /// Number of its friction law in the pair
    pub law: usize,
    /// Initial overlap of the point in a shrink fit, applied gradually over the first step [L]
    pub overlap: f64,
    /// Largest depth behind a master segment, other than the nearest, that it may be in contact with: half the thickness of its
    /// body [L]
    pub depth: f64,
}

impl SlavePoint {
    /// Current position of the point.
    pub fn at(&self, x: &Configuration) -> Vector2<f64> {
        let [reference, displacement] = x.split(&self.position, Vector2::zeros());
        reference + displacement
    }

    /// g: gap of the surfaces − gap at closure, with the applied fraction of an overlap.
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

    /// Mean of a function along the undeformed length of a point that is not a node, but a part of edges; else its value there.
    pub fn mean(&self, value: impl Fn(Vector2<f64>) -> f64, x: &Configuration) -> f64 {
        if self.position.len() < 2 || self.length.len() < 2 {
            return value(self.at(x));
        }
        let of = |share: &LengthShare| {
            let length = share.factor * x.combine(&share.tangent).norm() * x.weight(&share.at);
            let at = share.at.iter().map(|&(node, w)| x.reference(node) * w).sum();
            Vector2::new(length, length * value(at))
        };
        let sum: Vector2<f64> = self.length.iter().map(of).sum();
        sum.y / sum.x
    }

    /// Current length of the longest edge of the point; `None` without edges [L].
    pub fn edge_length(&self, x: &Configuration) -> Option<f64> {
        // dx/dξ on an edge from −1 to 1 is half its length.
        self.length.iter().map(|share| 2.0 * x.combine(&share.tangent).norm()).max_by(f64::total_cmp)
    }

    /// Unit normal out of the slave body: the edge direction, body on its left, turned by −90°; `None` without edges.
    pub fn outward(&self, x: &Configuration) -> Option<Vector2<f64>> {
        let along: Vector2<f64> = self.length.iter().map(|share| x.combine(&share.tangent) * share.factor).sum();
        (!self.length.is_empty()).then(|| Vector2::new(along.y, -along.x).normalize())
    }
}

/// Returns the Gauss points of each edge as slave points.
///
/// `edges` are (start, end[, middle]) with the body on the left, in order along the surface.
pub fn gauss_points(edges: &[Vec<usize>], per_edge: usize) -> Vec<SlavePoint> {
    let rule = shape::gauss(per_edge);
    edges.iter().flat_map(|edge| rule.iter().map(|&(xi, weight)| edge_point(edge, xi, weight))).collect()
}

/// Returns the Gauss points of each edge, but for edges at an end or corner of the surface: there the points of Radau's or, at
/// both, Lobatto's rule, of which one is the corner itself. Linear edges have two, quadratic ones four or, with one end, three: products
/// of two shape functions are integrated exactly.
pub fn gauss_points_and_corners(edges: &[Vec<usize>], is_corner: impl Fn(usize, usize) -> bool) -> Vec<SlavePoint> {
    let rule = |edge: usize| -> Vec<(f64, f64)> {
        let (linear, root) = (edges[edge].len() == 2, |x: f64| x.sqrt());
        let radau = |side: f64| match linear {
            true => vec![(side, 0.5), (-side / 3.0, 1.5)],
            false => vec![
                (side, 2.0 / 9.0),
                (-side * (1.0 - root(6.0)) / 5.0, (16.0 + root(6.0)) / 18.0),
                (-side * (1.0 + root(6.0)) / 5.0, (16.0 - root(6.0)) / 18.0),
            ],
        };
        match [0, 1].map(|end| is_corner(edge, end)) {
            [false, false] => shape::gauss(if linear { 2 } else { 4 }).to_vec(),
            [true, false] => radau(-1.0),
            [false, true] => radau(1.0).into_iter().rev().collect(),
            [true, true] if linear => vec![(-1.0, 1.0 / 3.0), (0.0, 4.0 / 3.0), (1.0, 1.0 / 3.0)],
            [true, true] => {
                let inner = root(0.2);
                vec![(-1.0, 1.0 / 6.0), (-inner, 5.0 / 6.0), (inner, 5.0 / 6.0), (1.0, 1.0 / 6.0)]
            }
        }
    };
    let points = |(edge, nodes): (usize, &Vec<usize>)| -> Vec<SlavePoint> {
        rule(edge).into_iter().map(|(xi, weight)| edge_point(nodes, xi, weight)).collect()
    };
    edges.iter().enumerate().flat_map(points).collect()
}

/// Returns the nodes with their tributary lengths: trapezoidal rule (linear edges) or Simpson's rule (quadratic edges).
pub fn nodal_points(edges: &[Vec<usize>]) -> Vec<SlavePoint> {
    at_nodes(edges, |edge, xi, weight| edge_point(edge, xi, weight).length)
}

/// Returns the nodes of axisymmetric edges with their tributary areas ∫ N_a 2π r ds, by Gauss quadrature: the rules above use r
/// at the nodes only, and give zero to a node on the axis. (The exact area at the end of a quadratic edge there is zero too.)
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

/// Returns the nodes with the contributions of each edge, by ξ and weight of the rule.
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

/// Returns a node without edges, with an area of its own [L].
pub fn lone_point(node: usize, area: f64) -> SlavePoint {
    SlavePoint {
        position: vec![(node, 1.0)],
        length: Vec::new(),
        area,
        touch: 0.0,
        law: 0,
        overlap: 0.0,
        depth: f64::INFINITY,
    }
}

/// Returns the point of an edge at ξ, with its part of the edge's length as tributary length.
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
        depth: f64::INFINITY,
    }
}

/// A material point of the master: segment and coordinate along it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct MasterPoint {
    /// Segment number; for a rigid body the number of its line
    pub segment: usize,
    /// 0 … 1 along the segment; on a rigid body the arc length along s (on the line `segment`) from the projection of the
    /// point's reference position [-] or [L]
    pub xi: f64,
}

/// Water at a contact point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WaterPoint {
    /// p_w, at the end of the increment that is solved [F/L²]
    pub pressure: f64,
    /// flow along the slave, in the order of its points [L³/T]
    pub flow: f64,
    /// w, with the hydraulic aperture if there is one [L]
    pub aperture: f64,
}

/// Memory of one contact point between increments.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ContactState {
    /// State of friction
    pub friction: FrictionState,
    /// Projection on the master, open or closed; `None` without a projection
    pub master_point: Option<MasterPoint>,
    /// Tributary length of the point: its own or, with mortar, its part that overlaps the master; for an open point the last
    /// value (the current one under fluid pressure) [L]
    pub length: f64,
    /// g at the projection; in a contact that starts closed, relative to the gap at closure [L]
    pub gap: f64,
    /// Δu_t of the last increment, including slip before closure; 0 while open [L]
    pub slip: f64,
    /// η v of the last increment (radiation damping); 0 if not used, and in dynamic steps [F/L²]
    pub radiation: f64,
    /// Energy radiated so far per contact area [F/L]
    pub radiated: f64,
    /// p̄: pressure at zero gap, increased until the penetration is small enough; 0 for the plain penalty method [F/L²]
    pub multiplier: f64,
    /// e: elastic slip that the multiplier of the traction leaves, lowered until it is small enough; 0 for the plain penalty [L]
    pub elastic_slip: f64,
    /// p_w: pressure of the fluid if the point has a projection [F/L²]
    pub fluid: f64,
    /// Part of the contact pressure that the fluid in the pores of a body bears, beside that of friction's state [F/L²]
    pub pores: f64,
    /// Memory of a bond in parallel with friction, in a contact that has one
    pub bond: Option<BondState>,
    /// Water that flows along the contact, in one that has it
    pub water: Option<WaterPoint>,
    /// How the point came, in a contact that has come under stress; nothing in others
    pub came: Came,
    /// How often it has closed in explicit increments
    pub closures: u32,
}

/// How a point of a contact came that has come under stress.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Came {
    /// Gap of the surfaces from which that of the point is counted [L]
    pub gap: f64,
    /// p that acted at once [F/L²]
    pub pressure: f64,
    /// q that acted at once [F/L²]
    pub traction: f64,
}

impl ContactState {
    /// g − d: separation of the surfaces beyond the opening of the law, negative under the penalty [L]
    pub fn clearance(&self) -> f64 {
        self.gap - self.friction.opening
    }

    /// Contact pressure of the penalty or the multiplier: that of friction's state, and what a fluid in pores bears [F/L²]
    pub fn contact_pressure(&self) -> f64 {
        self.friction.pressure + self.pores
    }

    /// q of friction and a bond together [F/L²]
    pub fn shear(&self) -> f64 {
        self.bond.map_or(self.friction.traction, |bond| self.friction.traction + bond.traction)
    }

    /// T of a bond [F/L²]
    pub fn tension(&self) -> f64 {
        self.bond.map_or(0.0, |bond| bond.tension)
    }

    /// p − T and q + η v: tractions between the surfaces, friction, a bond and radiation damping together [F/L²]
    pub fn tractions(&self) -> [f64; 2] {
        [self.friction.pressure - self.tension(), self.shear() + self.radiation]
    }

    /// Whether surfaces that are open carry tractions over their gap.
    pub fn carries_open(&self) -> bool {
        !self.is_closed() && (self.shear() != 0.0 || self.tension() != 0.0)
    }

    /// Whether any traction acts between the surfaces.
    pub fn acts(&self) -> bool {
        self.is_closed() || self.carries_open()
    }

    /// Whether a point is open by more than [`ContactPair::touch`](super::pair::ContactPair::touch).
    pub fn is_separated(&self, touch: f64) -> bool {
        !self.is_closed() && self.clearance() > touch
    }

    /// Whether the surfaces press on each other, or are tied.
    pub fn is_closed(&self) -> bool {
        self.friction.pressure > 0.0 || self.friction.regime == Regime::Tied
    }

    /// Open, stick or slip according to the law; a point closed only by a prediction is open.
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
    /// Whether radiation damping acts, if the contact has one: in motions without inertia
    pub radiates: bool,
    /// Fraction of an initial overlap that is not applied yet
    pub fading: f64,
    /// Factor on the given α_n: [`super::pair::ContactPair::normal_stiffness`]
    pub stiffening: f64,
    /// Whether the bodies deform under the pressures that arise within the increment
    pub settles: bool,
    /// Δt/β of water that flows [T]
    pub seeps: f64,
}

impl ContactIncrement {
    /// Start and end time of the increment.
    pub fn span(&self) -> [f64; 2] {
        [self.time - self.dt, self.time]
    }
}

/// Increment of a contact point, and the predictions of the iteration about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointIncrement {
    /// Length of the increment, and other data common to all points
    pub during: ContactIncrement,
    /// Predictions of the linear solve about the point
    pub prediction: Prediction,
}

/// Predictions of a linear solve about a point, from earlier solves; empty in an accepted state.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Prediction {
    /// Prediction about its state
    pub predicted: PredictedStatus,
    /// Predicted tractions for the geometric tangent; those of the trial state if `None`
    pub predicted_tractions: Option<Tractions>,
    /// Pressure of a point in the active set, which is closed whatever its gap, also used by friction unless its own pressure is positive;
    /// 0 if it is not in it
    pub active_pressure: f64,
    /// Pressure used by friction, beyond which its response is extrapolated linearly, at a point that has just closed: a stiff
    /// penalty gives far too high a pressure to a point that penetrates deeply in one iterate, and would make it stick where it
    /// is to slip.
    pub predicted_pressure: Option<f64>,
    /// Two segments between which its projection alternates
    pub alternating: Option<[usize; 2]>,
}

/// Prediction of the next linear solve about a point, for convergence; an accepted state has none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PredictedStatus {
    /// The laws respond without predictions
    #[default]
    Nothing,
    /// A zero gap is closed and sticks; otherwise it would alternate between open and closed at p = 0
    Touch,
    /// The point sticks, q = q₀ + α_t Δu_t whatever its size. From one iterate to the next it slipped in opposite directions,
    /// past the narrow and stiff range of sticking in between: the tangents on both sides are soft, and Newton's method would
    /// alternate indefinitely. It is predicted again if the point then slips although the predicted tractions would have held
    /// it.
    Stick,
}

/// Pressure and traction of a point, predicted by one linear solve for the next.
///
/// A stiff penalty turns every error of a displacement into a pressure far too high, and this into a geometric stiffness
/// p δn ℓ that misleads the next iterate, or opens a point that should be closed. The linearized prediction p + δp has an error
/// of second order in the correction only: it defines the geometric stiffness and the points that stay closed. The residual
/// of a solution contains no predicted pressures.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tractions {
    /// p [F/L²]
    pub pressure: f64,
    /// q [F/L²]
    pub traction: f64,
}

impl Tractions {
    /// Returns the tractions of a state, with all of its contact pressure.
    pub fn of(state: &ContactState) -> Self {
        Self { pressure: state.contact_pressure() - state.tension(), traction: state.shear() }
    }

    /// Scales both by one factor, so that the pressure does not exceed a limit.
    pub fn limited(self, most: f64) -> Self {
        let share = if self.pressure > most { most / self.pressure } else { 1.0 };
        Self { pressure: share * self.pressure, traction: share * self.traction }
    }
}

/// Shares of nodes at a contact point: linear between neighbours at a place on an edge, also of quadratic ones; those of its position where it
/// is a mean.
pub fn linear_shares(point: &SlavePoint) -> Weights {
    match point.position[..] {
        [(a, at_a), (b, at_b), (middle, at_middle)] => {
            let xi = at_b - at_a;
            let is_place = (at_middle - (1.0 - xi * xi)).abs() < PLACE && (at_a + at_b - xi * xi).abs() < PLACE;
            if !is_place {
                return point.position.clone();
            }
            let end = if xi < 0.0 { a } else { b };
            vec![(end, xi.abs()), (middle, 1.0 - xi.abs())]
        }
        _ => point.position.clone(),
    }
}

/// Difference of weights from shape functions that is round-off [-]
const PLACE: f64 = 1e-12;
