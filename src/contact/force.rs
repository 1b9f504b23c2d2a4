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

pub use super::closed::{Closed, nodal_forces};
pub use super::kinematics::Meeting;
use super::kinematics::{Kinematics, kinematics};
use super::pair::ContactPair;
use super::point::{MasterPoint, SlavePoint};
use super::presumption::Presumption;
pub use super::presumption::{Increment, Presume, Tractions};
use super::projection::Projection;
use super::state::TOUCH;
pub use super::state::{ContactState, SLIPPING, Status};
use crate::laws::friction::{LawFailure, Sliding};
use crate::mesh::configuration::Configuration;

/// Trial state of one point and, if closed, what it adds to the equations.
pub type PointResponse = Result<(ContactState, Option<Closed>), LawFailure>;

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
    let (gap, foot) = (slave.gap(projection.gap, increment.during.fading), projection.foot);
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
    let promised = increment.presumption.promised.is_some_and(|promised| promised.pressure > 0.0);
    let pressure = old.multiplier - pair.normal_stiffness(increment.during.stiffening) * gap;
    promised || pressure > 0.0 || touches(gap, slave.current_length(x), old, increment)
}

/// Whether a zero gap is presumed to be closed, and to stick.
fn touches(gap: f64, length: f64, old: &ContactState, increment: Increment) -> bool {
    let zero = TOUCH * length;
    increment.presumption.presume == Presume::Touch && old.foot.is_some() && old.gap.abs() <= zero && gap.abs() <= zero
}

/// The state of a point without pressure.
pub fn open(
    pair: &ContactPair,
    slave: &SlavePoint,
    met: Option<(f64, MasterPoint)>,
    old: &ContactState,
    increment: Increment,
) -> PointResponse {
    let sliding = Sliding { slip: 0.0, pressure: 0.0, dt: increment.during.dt };
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
    let alpha_n = pair.normal_stiffness(increment.during.stiffening);
    let pressure = old.multiplier - alpha_n * gap;
    let carried = carried(pressure, increment.presumption);
    let compliance = pair.compliance_after_touch(increment.during.settles);
    let dslip_dpressure =
        if apart { count_slip_after_touch(&mut kinematics, old.gap, compliance, carried, alpha_n) } else { 0.0 };
    let sliding = Sliding { slip: kinematics.slip, pressure: carried, dt: increment.during.dt };
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
    if carried == 0.0 || touches(gap, kinematics.length, old, increment) {
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
    Ok((state, Some(super::closed::closed(&kinematics, &response, alpha_n, increment.presumption.promised))))
}

/// The pressure under which friction answers: that of a point which only a promise keeps closed is the promised one, from
/// where its answer goes on in a straight line.
fn carried(pressure: f64, presumption: Presumption) -> f64 {
    let promised = || presumption.promised.map_or(0.0, |promised| promised.pressure);
    presumption.carried.unwrap_or_else(|| if pressure > 0.0 { pressure } else { promised() })
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
