//! Contact points that are open and carry tractions over their gap, and bonds in parallel with friction.
//!
//! ```text
//! w = ⟨(g − d) − p̄/α_n⟩                                        opening; δg of it, d being constant where friction does not slip
//! p = −T,  q = q_b;   δT = ∂T/∂w δg + ∂T/∂Δu δΔu_b,   δq likewise
//! ```
//! The cohesion of a friction law is its own while the surfaces are closed; where they are open its traction goes on as that of a bond with
//! c_r = c, and the law takes it over again once they meet. A bond in parallel with friction has a traction of its own.
//!
//! In an increment that starts farther apart than δ, only the slip on the way within δ counts:
//!
//! ```text
//! Δu_b = Δu_t (δ + y)/(g₀ + y),   y = −w of an open point, d of `force.rs` of a closed one
//! ```
//!
//! Radiation damping fades with φ as the surfaces open.

use super::force::PointEvaluation;
use super::nodal_forces::{Additional, ClosedPoints};
use super::pair::ContactPair;
use super::point::{ContactState, PointIncrement, PredictedStatus};
use super::surface::SlavePoint;
use crate::laws::friction::{BondResponse, BondState, Cohesion, FrictionResponse, FrictionState, Regime};

/// A bond in parallel with friction at a closed point.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct BondAnswer {
    pub response: BondResponse,
    /// Share of the slip that counts for it, and Δu_b by y
    counted: [f64; 2],
}

impl ContactPair {
    /// Opening δ over which the cohesion of the friction law itself fades; 0 where it has none [L].
    pub(super) fn fading(&self, slave: &SlavePoint) -> f64 {
        match &self.law(slave).cohesion {
            Some(Cohesion::Own(bond)) => bond.opening(),
            _ => 0.0,
        }
    }

    /// Whether a point that is open by this gap may carry tractions, or carried some when the increment began.
    pub(super) fn reaches(&self, slave: &SlavePoint, gap: f64, old: &ContactState, increment: PointIncrement) -> bool {
        let Some(cohesion) = &self.law(slave).cohesion else { return false };
        let alpha_n = self.normal_stiffness(increment.during.stiffening);
        let opening = (gap - old.friction.opening - old.multiplier / alpha_n).max(0.0);
        old.shear() != 0.0 || old.tension() != 0.0 || cohesion.bond().reaches(opening, &old.bond.unwrap_or_default())
    }

    /// State of a bond in parallel with friction at the start, which has this part of the traction, of surfaces that touch or lie apart by a gap.
    pub fn bond_at_start(&self, slave: &SlavePoint, gap: Option<f64>, traction: f64) -> Option<BondState> {
        match &self.law(slave).cohesion {
            Some(Cohesion::Parallel(bond)) => Some(bond.start(gap, traction)),
            _ => None,
        }
    }

    /// How far a bond in parallel with friction would be off if it had slipped by so much since it was out of reach [F/L²].
    pub(super) fn bond_off(&self, slave: &SlavePoint, [old, now]: [&ContactState; 2], slip: f64) -> f64 {
        match (&self.law(slave).cohesion, old.bond, now.bond) {
            (Some(Cohesion::Parallel(bond)), Some(before), Some(now))
                if old.is_separated(self.touch + bond.opening()) =>
            {
                bond.respond(&before, 0.0, slip, false).state.traction - now.traction
            }
            _ => 0.0,
        }
    }

    /// An observable that a bond in parallel with friction has: what is left of it and, where friction is none, q over its strength.
    pub(super) fn observed_of_bond(&self, slave: &SlavePoint, name: &str, state: &ContactState) -> Option<f64> {
        let law = self.law(slave);
        let (Some(Cohesion::Parallel(bond)), Some(own)) = (&law.cohesion, &state.bond) else { return None };
        match name {
            "bond" => Some(bond.intact(own)),
            "R" if law.stiffness == 0.0 => {
                let strength = bond.strength_left(own);
                Some(if strength > 0.0 { own.traction.abs() / strength } else { 0.0 })
            }
            _ => None,
        }
    }

    /// Elastic slip of a bond in parallel with friction, or what of it multipliers leave; 0 without a bond [L].
    pub fn elastic_slip_of_bond(&self, slave: &SlavePoint, state: &ContactState) -> f64 {
        match (&self.law(slave).cohesion, state.bond) {
            (Some(Cohesion::Parallel(_)), Some(bond)) if self.stick.is_some() => bond.elastic_slip,
            (Some(Cohesion::Parallel(law)), Some(bond)) => bond.traction / law.stiffness(),
            _ => 0.0,
        }
    }
}

impl PointEvaluation<'_> {
    /// Share of the slip that counts for a bond, and the derivative of that slip by y.
    fn counted_by_bond(&self, opening: f64, y: f64) -> [f64; 2] {
        let (old, from) = (self.old, self.old.clearance());
        if !old.is_separated(self.pair.touch + opening) || old.master_point.is_none() {
            return [1.0, 0.0];
        }
        let share = ((opening + y) / (from + y)).max(0.0);
        [share, self.whole * (from - opening) / (from + y).powi(2)]
    }

    /// What a multiplier of the traction leaves of a bond's elastic slip.
    fn left_of_bond(&self, before: &BondState, traction: f64, stiffness: f64) -> f64 {
        match self.pair.stick {
            Some(_) => before.elastic_slip + (traction - before.traction) / stiffness,
            None => 0.0,
        }
    }

    /// Response of a bond in parallel with friction at a closed point.
    pub(super) fn bond_answer(&self) -> Option<BondAnswer> {
        let Some(Cohesion::Parallel(bond)) = &self.law.cohesion else { return None };
        let before = self.old.bond.unwrap_or_default();
        let way = self.pair.compliance_after_touch(self.increment.during.settles) * self.asked;
        let counted = self.counted_by_bond(bond.opening(), way);
        let sticks = self.increment.prediction.predicted == PredictedStatus::Stick;
        let mut response = bond.respond(&before, 0.0, self.whole * counted[0], sticks);
        response.state.elastic_slip = self.left_of_bond(&before, response.state.traction, bond.stiffness());
        Some(BondAnswer { response, counted })
    }

    /// State of a point that is open and within reach of its bond; its tractions are added to `closed`. `parted` is the state of friction.
    pub(super) fn opened(self, parted: FrictionState, closed: &mut ClosedPoints) -> ContactState {
        let Self { pair, law, old, increment, place, whole, alpha_n, free, .. } = self;
        let Some(cohesion) = &law.cohesion else { return old.clone() };
        let (bond, is_own) = (cohesion.bond(), matches!(cohesion, Cohesion::Own(_)));
        // A point at p = 0 is at the beginning of its opening.
        let opening = (-free / alpha_n).max(f64::MIN_POSITIVE);
        let was = if old.is_closed() { 0.0 } else { (old.clearance() - old.multiplier / pair.alpha_n).max(0.0) };
        let of_law = BondState { traction: old.friction.traction, opening: was, ..BondState::default() };
        let before = if is_own { of_law } else { old.bond.unwrap_or_default() };
        let [share, by_way] = self.counted_by_bond(bond.opening(), -opening);
        let slip = whole * share;
        let sticks = increment.prediction.predicted == PredictedStatus::Stick;
        let mut answer = bond.respond(&before, opening, slip, sticks);
        answer.state.elastic_slip = self.left_of_bond(&before, answer.state.traction, bond.stiffness());
        let [faded, fades] = bond.fading(opening);
        let [resists, damping] = pair.radiated(increment.during, slip);
        let radiation = faded * resists;
        let BondResponse { state, plastic, dissipation, dtension, dtraction, .. } = answer;
        let k = self.kinematics;
        if k.varied {
            let of = |[by_opening, by_slip]: [f64; 2]| [by_opening - by_slip * by_way, by_slip * share];
            let [by_gap, by_slip] = of(dtension);
            closed.push_dpressure(k, [-by_gap, -by_slip]);
            closed.push_bond(k, of([dtraction[0] + fades * resists, dtraction[1] + faded * damping]));
        }
        let acting = FrictionState { pressure: -state.tension, traction: state.traction, ..FrictionState::default() };
        let acting = FrictionResponse { state: acting, ..FrictionResponse::default() };
        let additional = Additional { radiates: [radiation, 0.0], fluid: place.fluid, ..Additional::default() };
        closed.push(k, &acting, additional, None);
        closed.leave_open(true);
        let carries = state.traction != 0.0 || state.tension != 0.0;
        let regime = match (carries, plastic == 0.0) {
            (false, _) => Regime::Open,
            (true, true) => Regime::Stick,
            (true, false) => Regime::Slip,
        };
        let base = if is_own { FrictionState { pressure: 0.0, ..old.friction.clone() } } else { parted };
        let friction = FrictionState {
            traction: if is_own { state.traction } else { 0.0 },
            plastic_slip: base.plastic_slip + plastic,
            plastic_increment: plastic,
            dissipation: base.dissipation + dissipation,
            regime,
            ..base
        };
        ContactState {
            friction,
            master_point: place.master_point,
            length: k.length,
            gap: place.gap,
            slip: whole,
            radiation,
            radiated: old.radiated + 0.5 * (old.radiation + radiation) * slip,
            // The same opening with the given stiffness
            multiplier: old.multiplier * (pair.alpha_n / alpha_n),
            elastic_slip: if is_own { state.elastic_slip } else { 0.0 },
            fluid: place.fluid,
            pores: 0.0,
            bond: (!is_own)
                .then_some(BondState { elastic_slip: if is_own { 0.0 } else { state.elastic_slip }, ..state }),
            water: old.water,
            came: old.came,
            closures: old.closures,
        }
    }

    /// Memory of a bond in parallel with friction at a point that is farther apart than it reaches, with what it dissipates.
    pub(super) fn torn(&self) -> Option<(BondState, f64)> {
        let Some(Cohesion::Parallel(bond)) = &self.law.cohesion else { return None };
        let before = self.old.bond.unwrap_or_default();
        let answer = bond.respond(&before, bond.opening().max(before.opening), 0.0, false);
        Some((answer.state, answer.dissipation))
    }
}

impl BondAnswer {
    /// Adds its slip and dissipation to a state of friction, whose slip is its own unless friction is rough.
    pub fn adds_to(&self, friction: &mut FrictionState, is_rough: bool) {
        let BondResponse { plastic, dissipation, strength, .. } = self.response;
        friction.dissipation += dissipation;
        if !is_rough {
            friction.plastic_slip += plastic - friction.plastic_increment;
            friction.plastic_increment = plastic;
            friction.regime = if plastic == 0.0 { Regime::Stick } else { Regime::Slip };
        } else if strength > 0.0 && plastic == 0.0 {
            friction.regime = Regime::Stick;
        }
    }

    /// δq_b by δg and by the slip in the increment, where δp is −a δg + b (share δΔu_t) and y = d p; d is `None` where all slip counts.
    pub fn varies(&self, way: Option<f64>, [by_gap, lift]: [f64; 2], share: f64) -> [f64; 2] {
        let [counted, by_way] = self.counted;
        let by_pressure = way.map_or(0.0, |way| by_way * way);
        let by_slip = self.response.dtraction[1];
        [-by_slip * by_pressure * by_gap, by_slip * (counted + by_pressure * lift * share)]
    }
}
