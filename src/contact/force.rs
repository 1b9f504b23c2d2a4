//! Traction at a contact point, the nodal forces, and their tangent.
//!
//! ```text
//! p = ⟨p̄ − α_n (g − d)⟩,   q and d from the friction law,   t = p n − q s
//!                                      p̄: multiplier, 0 for the plain penalty; g: gap of the surfaces − gap at closure;
//!                                      d: opening, 0 for laws that do not dilate
//! f_a = −w_a t ℓ                                      ℓ: current length, x_s − x_foot = Σ w_a x_a
//! δt = (δp − q δθ) n − (δq + p δθ) s,   δp = −α_n (δg − δd),   δq = ∂q/∂Δu_t δΔu_t + ∂q/∂p δp,   δd likewise
//! ```
//!
//! Dilating surfaces separate at the opening of p → 0, not at that of the old state: between these two gaps they are lifted
//! by slip and carry the pressure that compresses them. A point is closed where
//!
//! ```text
//! p̄ − α_n (g − d(Δu_t, p → 0)) > 0
//! ```
//!
//! A fluid adds its pressure p_w to p in the forces only, see `pair.rs`; it acts on open points too. That of water which flows through bodies
//! is an unknown, see `seam.rs`. One in the pores of a body takes its
//! part of p from friction, see `pores.rs`.
//!
//! With radiation damping, q + η Δu_t/Δt replaces q in static increments: without inertia the slip rate is unbounded;
//! in unbounded bodies, shear waves radiated by slip would reduce the traction by η v.
//!
//! In an increment that starts open, at the gap g₀, only the slip after closure counts; all of it if the point had no
//! projection at its start. The surfaces approach at a constant rate, first by the gap and then by the compression under
//! pressure:
//!
//! ```text
//! Δu_t d/(g₀ + d),   d = c p + p/α_n             c: compliance of the bodies; 0 in central differences, which move first;
//!                                                no p/α_n under the augmented Lagrangian, which leaves no penetration
//! ```
//!
//! In such an increment the surfaces do not dilate either; dilation starts with the next. From the final state alone two states
//! could not be distinguished: open at a gap g > 0, never closed, or closed at the same gap by dilation after closure. A point
//! is closed if the surfaces overlap, g < d₀, as without dilatancy; the effect of the omitted opening on the pressure is part
//! of the uncertainty by which static increments end at contact closure ([`ContactPair::arrival`]).
//!
//! The control of static increments limits the dependence of accepted results on c: increments in which friction depends on
//! the counted fraction are repeated. Without c, a point that closes with a high pressure would stick because of its stiff
//! penalty alone, and release the missed slip in the next increment.
//!
//! A contact point is located at the end of an increment, and its contact status determined.

pub use super::kinematics::Meeting;
use super::kinematics::{Kinematics, kinematics};
use super::nodal_forces::Additional;
pub use super::nodal_forces::{Closed, ClosedPoints, nodal_forces};
use super::pair::ContactPair;
pub use super::point::{ContactState, PointIncrement, PredictedStatus, Tractions};
use super::point::{MasterPoint, Prediction, SlavePoint};
use super::pores::effective;
use super::projection::Projection;
use crate::laws::friction::{Answer, Bracket, ContactLaw, FrictionResponse, LawFailure, MOST_ANSWERS, Opened, Sliding};
use crate::mesh::configuration::Configuration;

/// Evaluation of a point's law: first its arguments, then the results of its response.
#[derive(Debug)]
pub struct PointEvaluation<'a> {
    pub(super) pair: &'a ContactPair,
    slave: &'a SlavePoint,
    /// Law of the increment
    pub(super) law: &'a ContactLaw,
    pub(super) old: &'a ContactState,
    pub(super) increment: PointIncrement,
    pub(super) place: PointPlace,
    pub(super) kinematics: &'a mut Kinematics,
    /// Total slip, including slip before closure [L]
    pub(super) whole: f64,
    pub(super) alpha_n: f64,
    /// p if the surfaces open no further than at present [F/L²]
    pub(super) free: f64,
    /// Additional pressure by the opening at p → 0 [F/L²]
    lift: f64,
    /// d/p of slip after closure; `None` where all slip counts [L³/F]
    compliance: Option<f64>,
    /// δ over which the cohesion of the law fades, within which all slip counts [L]
    fading: f64,
    /// p for which the law is asked, with the part of it that a fluid in the pores bears [F/L²]
    pub(super) asked: f64,
    /// Arguments of the law
    pub sliding: Sliding,
}

impl<'a> PointEvaluation<'a> {
    /// Prepares the arguments of the law at a located point, with these kinematics if it is closed.
    ///
    /// # Errors
    /// Returns [`LawFailure`] if the law has no opening at p → 0.
    pub fn new(
        pair: &'a ContactPair,
        slave: &'a SlavePoint,
        law: &'a ContactLaw,
        old: &'a ContactState,
        increment: PointIncrement,
        place: PointPlace,
        kinematics: &'a mut Kinematics,
    ) -> Result<Self, LawFailure> {
        let alpha_n = pair.normal_stiffness(increment.during.stiffening);
        let free = old.multiplier - alpha_n * (place.gap - old.friction.opening);
        let sliding = Sliding { slip: 0.0, pressure: 0.0, dt: increment.during.dt };
        let fading = pair.fading(slave);
        let separation = place.closes && !pair.tied && old.is_separated(pair.touch + fading);
        let compliance = separation.then(|| pair.compliance_after_touch(increment.during.settles));
        let whole = kinematics.slip;
        let mut loading = Self {
            pair,
            slave,
            law,
            old,
            increment,
            place,
            kinematics,
            whole,
            alpha_n,
            free,
            lift: 0.0,
            compliance,
            fading,
            asked: 0.0,
            sliding,
        };
        if place.closes {
            loading.close()?;
        }
        Ok(loading)
    }

    /// Sets the pressure of a point that is closed by its gap or, with dilatancy, by its slip.
    fn close(&mut self) -> Result<(), LawFailure> {
        let Prediction { active_pressure, predicted, .. } = self.increment.prediction;
        let clearance = self.place.gap - self.old.friction.opening;
        if may_alternate(self.pair, self.slave, self.old) {
            self.lift = self.alpha_n * (self.parting()? - self.old.friction.opening);
            self.place.closes =
                active_pressure > 0.0 || !self.parts() || touches(self.pair, clearance, self.old, predicted);
        }
        if self.place.closes {
            let (lifted, before) = (self.free + self.lift, self.old.friction.pressure);
            let free = if self.free > 0.0 && !self.parts() { self.free } else { lifted };
            // The lift by slip alone far exceeds that limited by friction.
            let first = if self.lift > 0.0 && before > 0.0 { free.min(before) } else { free };
            // A tie pulls as well.
            self.load(if self.pair.tied { free } else { friction_pressure(first, self.increment.prediction) });
        }
        Ok(())
    }

    /// Whether no pressure remains.
    fn parts(&self) -> bool {
        self.free + self.lift <= 0.0
    }

    /// d at p → 0: a law has no response at 0, but near 0 it no longer changes.
    fn parting(&self) -> Result<f64, LawFailure> {
        let (old, slip) = (&self.old.friction, self.whole * self.counted(0.0).share);
        let size = old.pressure + old.traction.abs() + (self.alpha_n + self.law.stiffness) * slip.abs();
        if size == 0.0 {
            return Ok(old.opening);
        }
        let sliding = Sliding { slip, pressure: f64::EPSILON * size, ..self.sliding };
        Ok(self.law.respond(old, sliding)?.state.opening)
    }

    /// Sets a pressure, and the slip that counts under it.
    fn load(&mut self, pressure: f64) {
        self.sliding.slip = self.whole * self.counted(pressure).share;
        self.asked = pressure;
        self.sliding.pressure = self.effective(pressure)[0];
    }

    /// What friction sees of a contact pressure, and its derivative.
    fn effective(&self, pressure: f64) -> [f64; 2] {
        self.place.pore_pressure.map_or([pressure, 1.0], |pores| effective(pressure, pores))
    }

    /// Fraction of the slip that counts under a pressure, d/(g₀ + d) in an increment that starts open and 1 otherwise, and the
    /// derivative of the slip with respect to pressure.
    fn counted(&self, pressure: f64) -> Counted {
        let Some(compliance) = self.compliance else { return Counted { share: 1.0, dslip_dpressure: 0.0 } };
        let (way, old_gap, within) = (compliance * pressure, self.old.clearance(), self.fading);
        Counted {
            share: (within + way) / (old_gap + way),
            dslip_dpressure: self.whole * compliance * (old_gap - within) / (old_gap + way).powi(2),
        }
    }

    /// Computes the state of the point from the response of its law; contributions of a closed point are added to `closed`.
    ///
    /// # Errors
    /// Returns [`LawFailure`] of the law, or if its opening and its pressure do not converge.
    pub fn finish(mut self, answer: Answer, closed: &mut ClosedPoints) -> Result<ContactState, LawFailure> {
        let mut response = self.met(answer?);
        let PointPlace { gap, master_point, closes, fluid, .. } = self.place;
        if !closes && self.place.bonded {
            return Ok(self.opened(response.state, closed));
        }
        if !closes {
            let torn = self.torn();
            let lost = torn.map_or(0.0, |(_, lost)| lost);
            response.state.dissipation += lost;
            let bond = torn.map(|(bond, _)| bond);
            let length = closed.push_open(self.kinematics, fluid).unwrap_or(self.old.length);
            let parted =
                ContactState { slip: 0.0, radiation: 0.0, multiplier: 0.0, elastic_slip: 0.0, ..self.old.clone() };
            return Ok(ContactState {
                friction: response.state,
                master_point,
                gap,
                length,
                fluid,
                pores: 0.0,
                bond,
                ..parted
            });
        }
        let (pressure, asked) = (self.agree(&mut response)?, self.asked);
        let (seen, [_, by_pressure]) = (self.effective(pressure)[0], self.effective(asked));
        response.dtraction_dpressure *= by_pressure;
        let counted = self.counted(asked);
        // To a node the point is held by α_n in either direction: where it was off the node by more than it goes in, no other
        // tractions turn as its own do.
        let at_node = master_point.is_some_and(|master_point| master_point.xi == 1.0)
            && self.increment.prediction.alternating.is_some();
        let predicted_tractions = self.increment.prediction.predicted_tractions.filter(|_| !at_node);
        let bond_answer = self.bond_answer();
        let Self { pair, law, old, increment, kinematics, whole, alpha_n, sliding, compliance, .. } = self;
        let stiffness = law.stiffness;
        if increment.prediction.predicted == PredictedStatus::Stick {
            response.state.traction = old.friction.traction + stiffness * sliding.slip;
            response.dtraction_dslip = stiffness;
            response.dtraction_dpressure = 0.0;
        }
        let opening_rate = response.dopening_dpressure + response.dopening_dslip * counted.dslip_dpressure;
        if asked > 0.0 {
            let along = response.dtraction_dpressure + response.dtraction_dslip * counted.dslip_dpressure;
            response.state.traction += along * (pressure - asked);
            response.state.opening += opening_rate * (pressure - asked);
            response.state.pressure = seen;
        }
        let clearance = gap - response.state.opening;
        // At p = 0 the law has no response, and near it round-off decides.
        if touches(pair, clearance, old, increment.prediction.predicted) {
            response.dtraction_dslip = stiffness;
        }
        let bond = bond_answer.map_or(0.0, |answer| answer.response.state.traction);
        let limited = law.cohesion.is_some() && increment.prediction.predicted != PredictedStatus::Stick;
        let limited = limited && law.limit(&old.friction, &mut response, bond);
        kinematics.slip = sliding.slip;
        if kinematics.varied {
            let alpha = alpha_n / (1.0 - alpha_n * opening_rate);
            let lift = alpha * response.dopening_dslip;
            if let Some(answer) = bond_answer.filter(|_| !limited) {
                let share = compliance.map_or(1.0, |_| counted.share);
                closed.push_bond(kinematics, answer.varies(compliance, [alpha, lift], share));
            }
            let counted = compliance.map(|_| counted);
            vary(kinematics, alpha, lift, counted, closed);
        }
        let radiates @ [radiation, _] = pair.radiated(increment.during, sliding.slip);
        let pores = pressure - seen;
        closed.push(kinematics, &response, Additional { radiates, fluid, pores, bond }, predicted_tractions);
        let elastic_slip = pair.left_of_stick(law, old, response.state.traction);
        if let Some(answer) = bond_answer {
            answer.adds_to(&mut response.state, law.stiffness > 0.0);
        }
        Ok(ContactState {
            friction: response.state,
            master_point,
            length: kinematics.length,
            gap,
            slip: whole,
            radiation,
            radiated: old.radiated + 0.5 * (old.radiation + radiation) * sliding.slip,
            // The next increment starts with the same pressure, but the given stiffness.
            multiplier: old.multiplier - (alpha_n - pair.alpha_n) * clearance,
            elastic_slip,
            fluid,
            pores,
            bond: bond_answer.map(|answer| answer.response.state),
            water: old.water,
            came: old.came,
            closures: old.closures + u32::from(!(old.is_closed() || increment.during.settles)),
        })
    }

    /// Response of the law, without dilation in an increment in which the surfaces close.
    fn met(&self, response: FrictionResponse) -> FrictionResponse {
        if self.compliance.is_some() { response.without_lift(&self.old.friction) } else { response }
    }

    /// Pressure consistent with the opening of the law, p = p̄ − α_n (g − d): iterated until both agree, or by the tangent of
    /// one response if a prediction prescribes the pressure of the law.
    fn agree(&mut self, response: &mut FrictionResponse) -> Result<f64, LawFailure> {
        let is_predicted = self.increment.prediction.predicted_pressure.is_some() || self.parts();
        // p − p̄ + α_n (g − d) changes its sign in it.
        let mut bracket = Bracket::new();
        for _ in 0..MOST_ANSWERS {
            let asked = self.asked;
            let dslip = self.counted(asked).dslip_dpressure;
            let opened = response.state.opening - self.old.friction.opening;
            let rate = response.dopening_dpressure + response.dopening_dslip * dslip;
            let lifted = self.alpha_n * (opened + rate * (self.free - asked)) / (1.0 - self.alpha_n * rate);
            let (found, next) = (self.free + self.alpha_n * opened, self.free + lifted);
            // Round-off of the opening affects a small pressure.
            let size = asked.abs() + self.alpha_n * (opened.abs() + response.state.opening.abs());
            let slipped = self.alpha_n * self.sliding.slip.abs();
            match bracket.after(asked, Opened { found, next, size, slipped }) {
                Some(pressure) if !is_predicted => self.load(pressure),
                _ => return Ok(next),
            }
            *response = self.met(self.law.respond(&self.old.friction, self.sliding)?);
        }
        Err(LawFailure::Opening { opening: response.state.opening, pressure: self.asked })
    }
}

/// The slip of an increment that counts under a pressure.
#[derive(Clone, Copy)]
struct Counted {
    /// Fraction of the whole slip [-]
    share: f64,
    /// Derivative of the counted slip with respect to pressure [L³/F]
    dslip_dpressure: f64,
}

/// δp = −α δg + lift (fraction δΔu_t), with α = α_n/(1 − α_n dd/dp) and lift = α ∂d/∂Δu_t; if slip is `counted` by a
/// pressure-dependent fraction, its variation becomes that of the counted slip.
fn vary(k: &mut Kinematics, alpha: f64, lift: f64, counted: Option<Counted>, closed: &mut ClosedPoints) {
    if let Some(Counted { share, .. }) = counted {
        k.dslip.iter_mut().for_each(|dslip| *dslip *= share);
    }
    closed.push_dpressure(k, [-alpha, lift]);
    if let Some(Counted { dslip_dpressure, .. }) = counted {
        let rates = k.dslip.iter_mut().zip(&k.dgap);
        rates.for_each(|(dslip, dgap)| {
            *dslip = *dslip * (1.0 + lift * dslip_dpressure) - dgap * (alpha * dslip_dpressure);
        });
    }
}

/// Pressure of the friction response: for a point that is only predicted closed the predicted one, beyond which its
/// response is extrapolated linearly.
fn friction_pressure(pressure: f64, Prediction { predicted_pressure, active_pressure, .. }: Prediction) -> f64 {
    predicted_pressure.unwrap_or(if pressure > 0.0 { pressure } else { active_pressure })
}

/// Kinematics of a contact point at the end of an increment.
#[derive(Clone, Copy, Debug, Default)]
pub struct PointPlace {
    /// g; 0 without a projection [L]
    pub gap: f64,
    /// Closest-point projection on the master, if there is one
    pub master_point: Option<MasterPoint>,
    /// Whether it is closed, and has kinematics
    pub closes: bool,
    /// Whether it may carry tractions where it is open; it has kinematics too
    pub bonded: bool,
    /// p_w; if it is not 0, the point has kinematics too [F/L²]
    pub fluid: f64,
    /// p_w in the pores of the slave's bodies, at a closed point of a contact whose friction goes by it [F/L²]
    pub pore_pressure: Option<f64>,
}

/// Locates a point with known projection, in the committed and the trial configuration, and its kinematics if it is
/// closed.
pub fn place(
    pair: &ContactPair,
    slave: &SlavePoint,
    projection: Option<Projection>,
    old: &ContactState,
    increment: PointIncrement,
    [before, x]: [&Configuration; 2],
    k: &mut Kinematics,
) -> PointPlace {
    let Some(projection) = projection else { return PointPlace::default() };
    let gap = slave.gap(projection.gap - old.came.gap, increment.during.fading);
    let closes = closes(pair, slave, gap, old, increment);
    let fluid = pair.acting_pressure(slave, old, x, increment.during.time);
    let bonded = pair.reaches(slave, gap, old, increment);
    if closes || bonded || fluid != 0.0 || pair.seam.is_some() {
        kinematics(slave, &pair.master, &projection, old.master_point, x, k);
        if old.master_point.is_none() {
            k.count_from(pair.master.rigid_body(), before, x);
        }
    }
    PointPlace { gap, master_point: Some(projection.master_point), closes, bonded, fluid, pore_pressure: None }
}

/// Whether a point with this gap carries pressure or is predicted to.
pub fn closes(pair: &ContactPair, slave: &SlavePoint, gap: f64, old: &ContactState, increment: PointIncrement) -> bool {
    let is_active = increment.prediction.active_pressure > 0.0;
    let clearance = gap - old.friction.opening;
    let pressure = old.multiplier - pair.normal_stiffness(increment.during.stiffening) * clearance;
    let predicted = increment.prediction.predicted;
    pair.tied && old.master_point.is_some()
        || is_active
        || pressure > 0.0
        || touches(pair, clearance, old, predicted)
        || may_alternate(pair, slave, old)
}

/// Whether slip may keep a point closed or open it, whatever its gap; this is known once its slip is.
fn may_alternate(pair: &ContactPair, slave: &SlavePoint, old: &ContactState) -> bool {
    old.master_point.is_some() && !pair.law(slave).description.opening.is_empty() && !old.is_separated(pair.touch)
}

/// Whether a zero gap is predicted closed and sticking.
pub fn touches(pair: &ContactPair, clearance: f64, old: &ContactState, predicted: PredictedStatus) -> bool {
    let is_predicted = predicted == PredictedStatus::Touch && old.master_point.is_some();
    is_predicted && [old.clearance(), clearance].iter().all(|gap| gap.abs() <= pair.touch)
}
