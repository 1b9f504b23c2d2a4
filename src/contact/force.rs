//! Traction at one contact point, the forces it puts on the nodes, and their tangent.
//!
//! ```text
//! p = ⟨p̄ − α_n g⟩,   q from the friction law,   t = p n − q s            p̄: multiplier, 0 for the plain penalty;
//!                                                                        g: gap of the surfaces − gap at touch
//! f_a = −w_a t ℓ                                      ℓ: current length, x_s − x_foot = Σ w_a x_a
//! δt = (δp − q δθ) n − (δq + p δθ) s,   δp = −α_n δg,   δq = ∂q/∂Δu_t δΔu_t + ∂q/∂p δp
//! ```
//!
//! In an increment that starts open, at the gap g₀, only the slip after touch counts; all where nothing faced the point at
//! its start. The surfaces approach at a steady rate, first through the gap and then by what the pressure pushes in:
//!
//! ```text
//! Δu_t d/(g₀ + d),   d = c p + p/α_n             c: compliance of the bodies; 0 in central differences, which move first;
//!                                                no p/α_n under the augmented Lagrangian, which leaves no penetration
//! ```
//!
//! What is accepted depends on c by no more than the control of static increments allows: it repeats those in which friction
//! would change with the share that counts. Without c a point that comes in with a high pressure would stick for its stiff
//! penalty alone, and spring away by all it has missed in the increment after.

use nalgebra::{DVector, Vector2};
use serde::{Deserialize, Serialize};

use super::kinematics::{Kinematics, kinematics};
use super::pair::{ContactIncrement, ContactPair, Presumption};
use super::projection::Projection;
use super::surface::{MasterPoint, SlavePoint};
use crate::laws::friction::{FrictionResponse, FrictionState, LawFailure, Sliding};
use crate::linear::system::Contribution;
use crate::mesh::configuration::Configuration;

/// Memory of one contact point between increments.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ContactState {
    /// What friction remembers
    pub friction: FrictionState,
    /// Foot on the master, open or closed; `None` where no part of the master faces the point
    pub foot: Option<MasterPoint>,
    /// Length the point stands for: its own or, by mortar, the part of it that the master faces; once open, the last one [L]
    pub length: f64,
    /// g at the foot; a contact that starts closed counts it from where its points touch [L]
    pub gap: f64,
    /// Δu_t of the last increment, what came before touch included; 0 while open [L]
    pub slip: f64,
    /// p̄: pressure at zero gap, raised until the penetration is small enough; 0 for the plain penalty [F/L²]
    pub multiplier: f64,
}

/// Whether a point is open, sticks or slips.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// No pressure
    Open,
    /// Pressed, and held by friction
    Stick,
    /// Plastic slip in this increment at R ≥ 0.9
    Slip,
}

/// R from which on plastic slip counts as slipping.
pub const SLIPPING: f64 = 0.9;

impl ContactState {
    /// Whether a point that stands for this length is open at a gap that counts.
    pub fn apart(&self, length: f64) -> bool {
        self.friction.pressure == 0.0 && self.gap > TOUCH * length
    }

    /// Open, stick or slip. The super/subloading law slips plastically a little whenever it is loaded, so only plastic
    /// slip near the peak surface counts as slipping.
    pub fn status(&self) -> Status {
        let friction = &self.friction;
        if friction.pressure <= 0.0 {
            Status::Open
        } else if friction.plastic_increment != 0.0 && (friction.mu == 0.0 || friction.ratio() >= SLIPPING) {
            Status::Slip
        } else {
            Status::Stick
        }
    }
}

/// Increment of a contact point, and what the iteration presumes about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Increment {
    /// Length of the increment, and what it changes about every point
    pub moment: ContactIncrement,
    /// What the linear solve presumes about the point
    pub presumption: Presumption,
}

/// Pressure and traction of a point, as one linear solve promised them to the next.
///
/// A stiff penalty turns every error of a displacement into a pressure far too high, and that into a geometric stiffness
/// p δn ℓ that leads the next iterate astray, or opens a point that should be closed. The promise p + δp of the linear
/// solve is off by the square of the correction only: it makes the geometric stiffness, and says which points stay closed.
/// The residual that a solution must meet knows no promises.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tractions {
    /// p [F/L²]
    pub pressure: f64,
    /// q [F/L²]
    pub traction: f64,
}

impl Tractions {
    /// Those of a state.
    pub fn of(friction: &FrictionState) -> Self {
        Self { pressure: friction.pressure, traction: friction.traction }
    }

    /// Both in proportion, so that the pressure is not above a limit.
    pub fn limited(self, most: f64) -> Self {
        let share = if self.pressure > most { most / self.pressure } else { 1.0 };
        Self { pressure: share * self.pressure, traction: share * self.traction }
    }
}

/// A closed point: what it adds to the equations, and how its tractions vary with its nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct Closed {
    /// Forces and tangent
    pub contribution: Contribution,
    /// p and q
    pub tractions: Tractions,
    /// δp [F/L³]
    pub dpressure: DVector<f64>,
    /// δq [F/L³]
    pub dtraction: DVector<f64>,
}

impl Closed {
    /// p + δp and q + δq for a correction of the nodes' displacements; none where the pressure would be negative.
    pub fn promise(&self, correction: impl Fn(usize) -> f64) -> Tractions {
        let dofs = || self.contribution.nodes.iter().flat_map(|&node| [2 * node, 2 * node + 1]);
        let along = |rates: &DVector<f64>| dofs().zip(rates).map(|(dof, rate)| rate * correction(dof)).sum::<f64>();
        let pressure = self.tractions.pressure + along(&self.dpressure);
        let traction = self.tractions.traction + along(&self.dtraction);
        if pressure > 0.0 { Tractions { pressure, traction } } else { Tractions::default() }
    }
}

/// What the next linear solve presumes about a point, for the sake of convergence; an accepted state presumes nothing.
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

/// Contact closes at a zero gap when it is below this share of the length the point stands for.
const TOUCH: f64 = 1e-9;

/// Trial state of one point and, if closed, what it adds to the equations.
pub type PointResponse = Result<(ContactState, Option<Closed>), LawFailure>;

/// Where a slave point meets the master: its kinematics, its gap and its foot.
#[derive(Clone, Debug, PartialEq)]
pub struct Meeting {
    /// Kinematics, with slip counted from the committed state
    pub kinematics: Kinematics,
    /// g [L]
    pub gap: f64,
    /// The foot
    pub foot: MasterPoint,
}

/// The trial state of one point and, if closed, what it adds to the equations, in the committed configuration and that of
/// the trial.
pub fn respond(
    pair: &ContactPair,
    slave: &SlavePoint,
    projection: Option<Projection>,
    old: &ContactState,
    increment: Increment,
    [before, x]: [&Configuration; 2],
) -> PointResponse {
    let Some(projection) = projection else { return open(pair, slave, None, old, increment) };
    let (gap, foot) = (slave.gap(projection.gap, increment.moment.fading), projection.foot);
    if !closes(pair, slave, gap, old, increment, x) {
        return open(pair, slave, Some((gap, foot)), old, increment);
    }
    let mut kinematics = kinematics(slave, &pair.master, &projection, old.foot, x);
    if old.foot.is_none() {
        kinematics.count_from(before, x);
    }
    press(pair, slave, Meeting { kinematics, gap, foot }, old, increment)
}

/// Whether a point with this gap carries pressure, or is presumed to.
pub fn closes(
    pair: &ContactPair,
    slave: &SlavePoint,
    gap: f64,
    old: &ContactState,
    increment: Increment,
    x: &Configuration,
) -> bool {
    let kept = increment.presumption.kept > 0.0;
    let pressure = old.multiplier - pair.normal_stiffness(increment.moment.stiffening) * gap;
    kept || pressure > 0.0 || touches(gap, slave.current_length(x), old, increment.presumption.presume)
}

/// Whether a zero gap is presumed to be closed, and to stick.
pub fn touches(gap: f64, length: f64, old: &ContactState, presume: Presume) -> bool {
    let zero = TOUCH * length;
    presume == Presume::Touch && old.foot.is_some() && old.gap.abs() <= zero && gap.abs() <= zero
}

/// The state of a point without pressure.
pub fn open(
    pair: &ContactPair,
    slave: &SlavePoint,
    met: Option<(f64, MasterPoint)>,
    old: &ContactState,
    increment: Increment,
) -> PointResponse {
    let sliding = Sliding { slip: 0.0, pressure: 0.0, dt: increment.moment.dt };
    let friction = pair.law(slave).respond(&old.friction, sliding)?.state;
    let (gap, foot) = met.unzip();
    let state =
        ContactState { friction, foot, length: old.length, gap: gap.unwrap_or(0.0), slip: 0.0, multiplier: 0.0 };
    Ok((state, None))
}

/// The state of a closed point and what it adds to the equations.
pub fn press(
    pair: &ContactPair,
    slave: &SlavePoint,
    meeting: Meeting,
    old: &ContactState,
    increment: Increment,
) -> PointResponse {
    let law = pair.law(slave);
    let Meeting { mut kinematics, gap, foot } = meeting;
    let (apart, whole) = (old.apart(kinematics.length), kinematics.slip);
    let alpha_n = pair.normal_stiffness(increment.moment.stiffening);
    let pressure = old.multiplier - alpha_n * gap;
    let carried = carried(pressure, increment.presumption);
    let compliance = pair.compliance_after_touch(increment.moment.settles);
    let dslip_dpressure =
        if apart { count_slip_after_touch(&mut kinematics, old.gap, compliance, carried, alpha_n) } else { 0.0 };
    let sliding = Sliding { slip: kinematics.slip, pressure: carried, dt: increment.moment.dt };
    let mut response = law.respond(&old.friction, sliding)?;
    let stiffness = law.stiffness();
    if increment.presumption.presume == Presume::Stick {
        response.state.traction = old.friction.traction + stiffness * sliding.slip;
        response.dtraction_dslip = stiffness;
        response.dtraction_dpressure = 0.0;
    }
    if carried > 0.0 {
        let along = response.dtraction_dpressure + response.dtraction_dslip * dslip_dpressure;
        response.state.traction += along * (pressure - carried);
        response.state.pressure = pressure;
    }
    // At p = 0 the law has no answer to give, and near it round-off decides which.
    if touches(gap, kinematics.length, old, increment.presumption.presume) {
        response.dtraction_dslip = stiffness;
    }
    let state = ContactState {
        friction: response.state,
        foot: Some(foot),
        length: kinematics.length,
        gap,
        slip: whole,
        // The next increment begins with the same pressure, but the stiffness given.
        multiplier: old.multiplier - (alpha_n - pair.alpha_n) * gap,
    };
    Ok((state, Some(closed(&kinematics, &response, alpha_n, increment.presumption.promised))))
}

/// The pressure under which friction answers: that of a point which is only kept closed is the one it is kept by, from
/// where its answer goes on in a straight line.
fn carried(pressure: f64, Presumption { carried, kept, .. }: Presumption) -> f64 {
    carried.unwrap_or(if pressure > 0.0 { pressure } else { kept })
}

/// Δu_t d/(g₀ + d) in an increment that starts open, at the gap g₀, with d the pressure times the compliance; returns its
/// derivative by the pressure.
fn count_slip_after_touch(k: &mut Kinematics, old_gap: f64, compliance: f64, pressure: f64, alpha_n: f64) -> f64 {
    let way = compliance * pressure;
    let share = way / (old_gap + way);
    let dslip_dpressure = k.slip * compliance * old_gap / (old_gap + way).powi(2);
    k.dslip *= share;
    k.dslip -= &k.dgap * (alpha_n * dslip_dpressure);
    k.slip *= share;
    dslip_dpressure
}

/// What a traction puts on the nodes: w_a (p n − q s) ℓ [F].
pub fn nodal_forces(k: &Kinematics, p: f64, q: f64) -> Vec<(usize, Vector2<f64>)> {
    let force = (k.normal * p - k.tangent * q) * k.length;
    k.nodes.iter().zip(&k.relative).map(|(&node, &w)| (node, force * w)).collect()
}

/// Nodal forces of the traction and their derivative: the exact one unless tractions are promised or a pressure carried.
fn closed(k: &Kinematics, response: &FrictionResponse, alpha_n: f64, promised: Option<Tractions>) -> Closed {
    let tractions = Tractions::of(&response.state);
    let turned = |Tractions { pressure: p, traction: q }: Tractions| k.normal * p - k.tangent * q;
    let traction = turned(tractions);
    let dpressure = &k.dgap * -alpha_n;
    let dtraction = &k.dslip * response.dtraction_dslip + &dpressure * response.dtraction_dpressure;
    let promised = promised.unwrap_or(tractions);
    let turned = turned(promised);
    let along_normal = &dpressure - &k.drotation * promised.traction;
    let along_tangent = -(&dtraction + &k.drotation * promised.pressure);
    // δ(t ℓ), one row a component
    let dforce =
        |i: usize| (&along_normal * k.normal[i] + &along_tangent * k.tangent[i]) * k.length + &k.dlength * turned[i];
    let rows = [dforce(0), dforce(1)];

    let mut result = Contribution::zero(k.nodes.clone());
    let add = |result: &mut Contribution, node: usize, i: usize, row: &DVector<f64>, factor: f64| {
        for (column, value) in row.iter().enumerate() {
            result.tangent[(2 * node + i, column)] += factor * value;
        }
    };
    for (node, &w) in k.relative.iter().enumerate() {
        for (i, row) in rows.iter().enumerate() {
            result.force[2 * node + i] = -w * traction[i] * k.length;
            add(&mut result, node, i, row, -w);
        }
    }
    for (node, dw) in &k.drelative {
        for i in 0..2 {
            add(&mut result, *node, i, dw, -turned[i] * k.length);
        }
    }
    Closed { contribution: result, tractions, dpressure, dtraction }
}
