//! Interface of friction laws: state of an interface point, and response of a law to one increment.
//!
//! A law is a pure function of (committed state, increment). Its arguments are scalars in the frame that rotates with
//! the interface, never nodes or meshes, so the same law serves a finite-element interface, a point mass or a test.
//!
//! Signs: `q` resists positive slip of the slave along +s; pressure is positive in compression.
//!
//! Laws: [`SuperSubloading`], [`SlipWeakening`], [`RateAndState`], [`Coulomb`], [`Adhesion`], [`Frictionless`], [`PrescribedSlip`].
//! [`FrictionParameters`] reads any of them from a case, and [registered](register) laws from other programs;
//! [`ContactLaw`] combines any of them with dilatancy and wear at the points of a contact, and [`Confinement`] says how the pressure
//! on an interface alone answers to its opening.
//!
//! The input of a law is [`Sliding`], the increment of one point; its failure is a [`LawFailure`]. Laws whose slip rate follows
//! from traction and state also implement [`RateLaw`].

mod adhesion;
mod bond;
mod confinement;
mod contact_law;
mod coulomb;
mod extrapolation;
mod frictionless;
pub mod observables;
mod parameters;
mod prescribed;
mod rate_and_state;
mod root;
pub mod sensitivity;
mod slip_weakening;
mod state;
mod super_subloading;
mod tie;

use std::fmt::Debug;

use thiserror::Error;

pub use adhesion::{Adhesion, AdhesionParameters};
pub use bond::{Bond, BondParameters, BondResponse, BondState, BondSurfaces};
pub(crate) use confinement::{Bracket, MOST_ANSWERS, Opened};
pub use confinement::{Confined, Confinement};
pub use contact_law::{Beyond, Cohesion, ContactLaw, Dilatancy, Offsets};
pub use coulomb::{Coulomb, CoulombParameters};
pub use frictionless::Frictionless;
pub use parameters::{FrictionParameters, RegisteredParameters, register};
pub use prescribed::{PrescribedSlip, PrescribedSlipParameters};
pub use rate_and_state::{RateAndState, RateAndStateParameters, StateEvolution};
pub use sensitivity::SensitiveLaw;
pub use slip_weakening::{SlipWeakening, SlipWeakeningParameters};
pub use state::{FrictionState, Regime, Variables};
pub use super_subloading::{Approach, Integration, Onset, Rise, SuperSubloading, SuperSubloadingParameters};
pub(crate) use tie::Tie;

/// Bound of the tangent: |∂q/∂Δu_t| is limited to this many times α_t, |∂q/∂p| to this value. Where two roots of a law's
/// equation of plastic slip merge, the traction jumps, and just before it the derivative grows without bound, like the inverse
/// square root of the distance to the jump. It is exact up to this bound; beyond, the distance is dominated by round-off.
pub const STEEPEST: f64 = 1e8;

/// Smallest −∂G/∂Δλ of an equation of plastic slip, relative to α_t, used for a tangent.
const LEAST_SLOPE: f64 = 1.0 / STEEPEST;

/// Response of a law to one increment, with the consistent tangent of the computed values.
///
/// ```text
/// δq = ∂q/∂Δu_t δΔu_t + ∂q/∂p δp,   δd = ∂d/∂Δu_t δΔu_t + ∂d/∂p δp        d: opening, 0 for most laws
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
#[must_use]
pub struct FrictionResponse {
    /// State at the end of the increment
    pub state: FrictionState,
    /// ∂q/∂Δu_t [F/L³]
    pub dtraction_dslip: f64,
    /// ∂q/∂p [-]
    pub dtraction_dpressure: f64,
    /// ∂d/∂Δu_t [-]
    pub dopening_dslip: f64,
    /// ∂d/∂p, below 1/α_n: an opening that increased faster with the pressure than the contact compliance would be unbounded
    /// [L³/F]
    pub dopening_dpressure: f64,
    /// Number of evaluations of the scalar equation of plastic slip; 0 for a closed form
    pub evaluations: usize,
}

impl FrictionResponse {
    /// Creates the response of a law with constant opening, with ∂q/∂Δu_t and ∂q/∂p.
    pub fn new(state: FrictionState, dtraction_dslip: f64, dtraction_dpressure: f64) -> Self {
        Self { state, dtraction_dslip, dtraction_dpressure, ..Self::default() }
    }

    /// Creates a response without plastic slip, where q has the tangent `stiffness` with respect to slip.
    pub fn elastic(state: FrictionState, stiffness: f64) -> Self {
        Self::new(state, stiffness, 0.0)
    }

    /// Removes dilation, and its work, from the response in this increment, which started in the state `old`. Where wear
    /// exceeds dilation the response is unchanged.
    pub fn without_lift(mut self, old: &FrictionState) -> Self {
        let lift = self.state.opening - old.opening;
        if lift > 0.0 {
            self.state.dissipation += 0.5 * (old.pressure + self.state.pressure) * lift;
            (self.state.opening, self.state.wear) = (old.opening, old.wear);
            (self.dopening_dslip, self.dopening_dpressure) = (0.0, 0.0);
        }
        self
    }

    /// Limits the tangent as [`FrictionLaw::respond`] requires for the stiffness α_t, and refuses numbers that have overflowed
    /// or a non-finite committed state. A law without stiffness, α_t = 0, has a ∂q/∂Δu_t of its own, which is not limited.
    ///
    /// # Errors
    /// Returns [`LawFailure::Overflow`] for such numbers.
    pub fn checked(mut self, stiffness: f64) -> Result<Self, LawFailure> {
        if stiffness > 0.0 {
            self.dtraction_dslip = self.dtraction_dslip.clamp(-STEEPEST * stiffness, STEEPEST * stiffness);
        }
        self.dtraction_dpressure = self.dtraction_dpressure.clamp(-STEEPEST, STEEPEST);
        self.finite()
    }

    /// Refuses numbers that have overflowed.
    fn finite(self) -> Result<Self, LawFailure> {
        let tangent = self.dtraction_dslip + self.dtraction_dpressure + self.dopening_dslip + self.dopening_dpressure;
        if self.state.is_finite() && tangent.is_finite() {
            Ok(self)
        } else {
            Err(LawFailure::Overflow { traction: self.state.traction })
        }
    }
}

/// Response of a law at one point.
pub type Answer = Result<FrictionResponse, LawFailure>;

/// A friction law, integrated over one increment. Pure: the same `old` and `sliding` give the same response.
///
/// ```text
/// (q, variables, d)₁ = law((q, p, variables, d)₀; Δu_t, p₁, Δt)       q resists +Δu_t, p > 0 in compression
/// p = p̄ − α_n (g − d)                                                d: opening of the surfaces by the law (dilatancy)
/// W₁ − W₀ = ∫ q dλ − ∫ p dd ≥ 0                                     dissipation [F/L]; q²/(2 α_t) is stored
/// ```
/// Units: q, p [F/L²], Δu_t, d [L], α_t [F/L³], Δt [T]. A law receives the effective pressure, never a penalty or multiplier;
/// the contact finds the pressure that is consistent with the opening.
///
/// For Δt = 0 the law responds to instantaneous slip and pressure, and q is unchanged if both are zero: a step starts with the
/// traction at the end of the previous one. For p ≤ 0 the surfaces are separated.
///
/// The following example is a law with one parameter, an oil film. A law that implements `Clone` can be used as the friction of
/// a contact directly, `Contact::new("base", "block_bottom", "ground_top", Oil { viscosity: 2.0 })`; no registration is needed.
/// It names its internal variables, any number of them, in [`Description::variables`] (the k-th name is that of
/// `state.variables[k]`); they appear by name in tables, frames and `Simulation::contact_field`:
///
/// ```
/// use fecontact::laws::friction::{
///     Description, FrictionLaw, FrictionResponse, FrictionState, LawFailure, Regime, Sliding,
/// };
///
/// /// Viscous friction, q = η v.
/// #[derive(Clone, Debug)]
/// struct Oil {
///     /// η: viscosity divided by the film thickness, η > 0 [F·T/L³]
///     viscosity: f64,
/// }
///
/// impl FrictionLaw for Oil {
///     fn respond(&self, old: &FrictionState, sliding: Sliding) -> Result<FrictionResponse, LawFailure> {
///         let Sliding { slip, pressure, dt, .. } = sliding.checked()?;
///         if pressure <= 0.0 || dt == 0.0 {
///             let traction = if pressure > 0.0 { old.traction } else { 0.0 };
///             return FrictionResponse::elastic(old.stuck(traction, pressure.max(0.0)), 0.0).checked(0.0);
///         }
///         let dtraction_dslip = self.viscosity / dt;
///         let traction = dtraction_dslip * slip;
///         let mut state = old.stuck(traction, pressure);
///         state.plastic_slip += slip;
///         state.plastic_increment = slip;
///         state.dissipation += traction * slip;
///         state.regime = if slip == 0.0 { Regime::Stick } else { Regime::Slip };
///         FrictionResponse::new(state, dtraction_dslip, 0.0).checked(0.0) // no α_t
///     }
///
///     fn description(&self) -> Description {
///         Description::default()
///     }
/// }
///
/// let oil = Oil { viscosity: 2.0 };
/// let answer = oil.respond(&oil.initial_state(0.0, 0.0), Sliding::new(0.3, 5.0, 0.1))?;
/// assert_eq!((answer.state.traction, answer.state.regime), (6.0, Regime::Slip));
/// # Ok::<(), LawFailure>(())
/// ```
pub trait FrictionLaw: Debug + Send + Sync {
    /// Description of the law, independent of the state of a point.
    fn description(&self) -> Description;

    /// State of a point without previous slip, closed from the start under these tractions, or open if they are 0.
    fn initial_state(&self, pressure: f64, traction: f64) -> FrictionState {
        FrictionState::default().loaded(pressure, traction)
    }

    /// q, the internal variables, contact status and opening at the end of the increment, with the consistent tangent;
    /// ∂q/∂Δu_t and ∂q/∂p are limited to ± [`STEEPEST`] times α_t, or 1.
    ///
    /// # Errors
    /// Returns [`LawFailure`] if the increment or the response is not finite, Δt is negative, or the equations of the law are
    /// not solved to their tolerance.
    fn respond(&self, old: &FrictionState, sliding: Sliding) -> Answer;

    /// Responses at several points, identical to those of single points. A law with a faster evaluation of several points
    /// overrides this.
    fn respond_many(&self, old: &[FrictionState], sliding: &[Sliding], answers: &mut [Answer]) {
        for ((old, sliding), answer) in old.iter().zip(sliding).zip(answers) {
            *answer = self.respond(old, *sliding);
        }
    }

    /// Value of an observable in a state, by default that of a variable; `None` if the law does not define it.
    fn observe(&self, name: &str, state: &FrictionState) -> Option<f64> {
        let variables = self.description().variables.iter().zip(state.variables.values());
        variables.into_iter().find_map(|(own, value)| (*own == name).then_some(value))
    }

    /// Returns the law for a prescribed path, such as a test record, with error-controlled sub-steps of each increment; `None`
    /// if its increments are exact for any length or no such integration exists.
    fn controlled(&self) -> Option<Box<dyn FrictionLaw>> {
        None
    }

    /// S = ∫ (1/R* − 1) |dλ|: plastic slip of an increment, weighted by the structure beyond the residual, and its derivatives by
    /// Δu_t and p; `None` for laws without structure ([`Description::full_structure`]) [L], [-], [L³/F]
    fn structured_slip(&self, _old: &FrictionState, _sliding: Sliding) -> Option<Result<[f64; 3], LawFailure>> {
        None
    }

    /// c of its strength c + μ p while surfaces are in contact: at points of a contact it fades as they open; 0 for most laws [F/L²]
    fn cohesion(&self) -> f64 {
        0.0
    }

    /// Slip rate under a given traction, for laws that define one.
    fn rates(&self) -> Option<&dyn RateLaw> {
        None
    }

    /// Derivatives with respect to the parameters, for laws that provide them.
    fn sensitivities(&self) -> Option<&dyn SensitiveLaw> {
        None
    }

    /// Peak, weakening and healing by its parameters, for laws that provide them.
    fn onset(&self) -> Option<Onset> {
        None
    }
}

/// Description of a friction law, independent of the state of a point. Fields that do not apply keep the values of
/// [`default`](Self::default): no stiffness, no variables, no bounds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct Description {
    /// α_t: tangential contact stiffness; the contact stores q²/(2 α_t). 0 if it stores no energy [F/L³]
    pub stiffness: f64,
    /// Whether α_t is a penalty: the law has no elastic slip, and q/α_t is an error like a penetration
    pub stiffness_is_penalty: bool,
    /// Names of the [`FrictionState::variables`] of the law; names used by other outputs are not allowed
    /// ([`observables::check_names`])
    pub variables: &'static [&'static str],
    /// Names of observables in addition to those of all laws, see [`FrictionLaw::observe`]; default: the variables
    pub observables: Option<&'static [&'static str]>,
    /// Names of the parts of the opening in the output, `dilation` and `wear`, as far as the law has them. A law with variable
    /// opening names one: a point is then closed according to the opening after slip, not according to that of the old state
    pub opening: &'static [&'static str],
    /// True if q is 0 for any slip: no slip needs to be resolved, and no rupture can occur
    pub is_frictionless: bool,
    /// Whether time-dependent parameters are averaged over an increment, like rates, instead of taking their value at its
    /// end, like strengths
    pub takes_means: bool,
    /// Largest initial |q|/p of a point without previous slip; `None` for a law that releases an excess by slip [-]
    pub starting_coefficient: Option<f64>,
    /// Strength at zero pressure of a bond in parallel with the law: 0 without one [F/L²]
    pub bond: f64,
    /// c and μ of the strength c + μ p at the start of a law that releases an excess over it by slip; `None` for laws without
    /// [F/L²], [-]
    pub released_above: Option<[f64; 2]>,
    /// Lower bound of |q|/p in continued sliding, at any rate and state; `None` if there is no such bound, or the
    /// law does not define it [-]
    pub least_coefficient: Option<f64>,
    /// Largest 1/R*, which the law comes to by healing; `None` for laws without structure [-]
    pub full_structure: Option<f64>,
    /// Maximum of −d(q/p)/dδ: weakening of friction in fast slip δ, 0 without weakening [1/L]
    pub weakening: f64,
    /// Slip of an increment up to which its response has no other solution nearby at any pressure, of a law whose strength grows with the
    /// slip rate; 0 for others [L]
    pub unique_slip: f64,
    /// D_c: slip over which a state evolves that increments integrate to first order in time, so that the error of their slip
    /// must be small against it; `None` if the state depends on slip alone, or increments integrate it exactly [L]
    pub critical_slip: Option<f64>,
}

impl Description {
    /// Names of observables in addition to those of all laws.
    pub fn observables(&self) -> &'static [&'static str] {
        self.observables.unwrap_or(self.variables)
    }

    /// Largest initial |q| of a point without previous slip under the pressure p; infinite for a law that releases an excess by
    /// slip [F/L²]
    pub fn starting_limit(&self, pressure: f64) -> f64 {
        self.starting_coefficient.map_or(f64::INFINITY, |coefficient| coefficient * pressure + self.bond)
    }

    /// Uniqueness bound: pressure above which the rate problem may have several solutions, α_t/weakening, if there is one; in increments that
    /// slip by less than [`unique_slip`](Self::unique_slip) it has one even so [F/L²]
    pub fn uniqueness_limit(&self) -> Option<f64> {
        let pressure = self.stiffness / self.weakening;
        pressure.is_finite().then_some(pressure)
    }
}

/// Relative motion of the two surfaces during one increment.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct Sliding {
    /// Δu_t: slip increment of the slave relative to the master along +s [L]
    pub slip: f64,
    /// p: effective pressure at the end of the increment, ≤ 0 where the point is open [F/L²]
    pub pressure: f64,
    /// Δt: length of the increment [T]
    pub dt: f64,
}

impl Sliding {
    /// Whether another increment is the same in every bit.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        let bits = |of: &Self| [of.slip, of.pressure, of.dt].map(f64::to_bits);
        bits(self) == bits(other)
    }

    /// Creates the increment Δu_t under the pressure p at its end, in the time Δt.
    pub const fn new(slip: f64, pressure: f64, dt: f64) -> Self {
        Self { slip, pressure, dt }
    }

    /// Refuses invalid increments.
    ///
    /// # Errors
    /// Returns [`LawFailure`] if a number is not finite or Δt is negative.
    pub fn checked(self) -> Result<Self, LawFailure> {
        let Self { slip, pressure, dt } = self;
        if !(slip.is_finite() && pressure.is_finite() && dt.is_finite()) {
            return Err(LawFailure::NotFinite { slip, pressure, dt });
        }
        if dt < 0.0 {
            return Err(LawFailure::NegativeTime { dt });
        }
        Ok(self)
    }
}

/// Failure of a law; the increment is repeated with a smaller length.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum LawFailure {
    /// The increment itself is not a finite number.
    #[error(
        "the friction law was evaluated for a slip {slip}, pressure {pressure} and time increment {dt} that are not \
         all finite"
    )]
    NotFinite {
        /// slip increment [L]
        slip: f64,
        /// pressure [F/L²]
        pressure: f64,
        /// increment length [T]
        dt: f64,
    },
    /// The length of the increment is negative.
    #[error("the friction law was evaluated for a negative time increment {dt}")]
    NegativeTime {
        /// increment length [T]
        dt: f64,
    },
    /// The equation of plastic slip was not solved, or the sub-steps of the increment did not converge.
    #[error(
        "the friction law did not converge within {evaluations} evaluations: residual {rest:.3e} of the trial traction \
         {trial:.3e}"
    )]
    NotConverged {
        /// evaluations of the equation of plastic slip
        evaluations: usize,
        /// residual, or difference between sub-steps [F/L²]
        rest: f64,
        /// |q_tr|: traction without plastic slip [F/L²]
        trial: f64,
    },
    /// The opening of a dilating law grows faster with the pressure than the contact compliance.
    #[error(
        "the opening {opening:.6e} of the friction law and the pressure {pressure:.6e} did not converge to a common \
         solution"
    )]
    Opening {
        /// d [L]
        opening: f64,
        /// p [F/L²]
        pressure: f64,
    },
    /// Time-dependent parameters are invalid at a time.
    #[error("the parameters of the friction law are not finite, or out of their range, at t = {time}: check `along`")]
    Undefined {
        /// t [T]
        time: f64,
    },
    /// Time-dependent parameters give a dilatancy above the friction coefficient.
    #[error(
        "the opening per slip {rate} ({key}) is not below the friction coefficient {least} of the law at t = {time}, and \
         sliding would produce energy: lower {key}, or keep `along` above it"
    )]
    Dilates {
        /// t [T]
        time: f64,
        /// key of the dilatancy
        key: &'static str,
        /// tan ψ [-]
        rate: f64,
        /// lowest friction coefficient of the law at that time, or that of its full structure [-]
        least: f64,
    },
    /// The state was not finite, or is no longer because of a too large increment.
    #[error("the friction state is not finite: the traction is {traction}")]
    Overflow {
        /// q: traction [F/L²]
        traction: f64,
    },
    /// A registered law failed for a reason of its own.
    #[error("a registered friction law returned no result")]
    Registered,
}

/// Tractions at a point of an interface with radiation damping.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointLoad {
    /// τ = q + η V: friction and radiation damping together [F/L²]
    pub traction: f64,
    /// p [F/L²]
    pub pressure: f64,
    /// η [F T/L³]
    pub damping: f64,
}

/// Number of states that a [`RateLaw`] may have.
pub const MOST_STATES: usize = 2;

/// A value of every state of a [`RateLaw`]; 0 where a law has no further one.
pub type States<T = f64> = [T; MOST_STATES];

/// A law whose slip rate follows from traction and states, so that an interface can be integrated separately.
///
/// ```text
/// τ = q(V, x, p) + η V          solved for V, which has the sign of τ; x: the states, numbers without dimension
/// ẋ = ẋ(V, x)
/// ```
pub trait RateLaw: Debug + Send + Sync {
    /// V; NaN if the law has no solution [L/T].
    fn slip_rate(&self, x: States, loading: PointLoad) -> f64;

    /// ẋ at a slip rate [1/T].
    fn evolution(&self, _x: States, _slip_rate: f64) -> States {
        States::default()
    }

    /// x in a state.
    fn evolving(&self, _state: &FrictionState) -> States {
        States::default()
    }

    /// The state with x in its variables.
    fn remember(&self, _x: States, state: FrictionState) -> FrictionState {
        state
    }

    /// |∂(q/p)/∂x|: effect of an error of x on the friction coefficient [-].
    fn weights(&self) -> States {
        States::default()
    }

    /// Whether the point sticks or slips.
    fn regime(&self, x: States, slip_rate: f64) -> Regime;
}

/// |q| at the onset of plastic slip, in an increment in which the elastic traction and the strength both vary linearly from
/// their first value to their second, and the traction is above at the end. If it is above from the start, slip starts there.
///
/// Both are measured along the sign of the trial, so a traction of the opposite sign unloads elastically, passes zero,
/// and loads elastically up to the strength.
fn traction_at_yield(elastic: [f64; 2], strength: [f64; 2]) -> f64 {
    let (below, above) = (strength[0] - elastic[0], elastic[1] - strength[1]);
    if below <= 0.0 || above <= 0.0 {
        return elastic[0].max(0.0);
    }
    strength[0] + below / (below + above) * (strength[1] - strength[0])
}
