//! The friction-law contract: what an interface point remembers, and how a law answers one increment.
//!
//! A law is a pure function of (committed state, increment). Its arguments are scalars in the frame that rotates with
//! the interface, never nodes or meshes, so the same law serves a finite-element interface, a point mass or a test.
//!
//! Signs: `q` resists positive slip of the slave along +s; pressure is positive in compression.
//!
//! Laws: [`SuperSubloading`], [`SlipWeakening`], [`RateAndState`], [`Coulomb`], [`Frictionless`], [`PrescribedSlip`].
//! [`FrictionParameters`] reads any of them from a case, and laws from elsewhere that are [registered](register);
//! [`ContactLaw`] is any of them at the points of a contact, with dilatancy and wear beside it.
//!
//! What a law is asked is [`Sliding`], the increment of one point; why it could not answer is a [`LawFailure`]. Laws whose slip
//! rate follows from traction and state are [`RateLaw`]s as well.

mod contact_law;
mod coulomb;
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

use std::fmt::Debug;

use thiserror::Error;

pub use contact_law::{ContactLaw, Dilatancy, Offsets};
pub use coulomb::{Coulomb, CoulombParameters};
pub use frictionless::Frictionless;
pub use parameters::{FrictionParameters, RegisteredParameters, register};
pub use prescribed::{PrescribedSlip, PrescribedSlipParameters};
pub use rate_and_state::{RateAndState, RateAndStateParameters, StateEvolution};
pub use sensitivity::SensitiveLaw;
pub use slip_weakening::{SlipWeakening, SlipWeakeningParameters};
pub use state::{FrictionState, MOST_VARIABLES, Regime};
pub use super_subloading::{Approach, Integration, Onset, Rise, SuperSubloading, SuperSubloadingParameters};

/// No law answers a tangent |∂q/∂Δu_t| above this many times α_t, or |∂q/∂p| above it. Where two roots of a law's equation
/// of plastic slip merge the traction snaps, and just before it the derivative grows without bound, like the inverse of the
/// root of the distance to the snap. It is exact up to here; beyond, the distance is lost in round-off.
pub const STEEPEST: f64 = 1e8;

/// Least −∂G/∂Δλ over α_t of an equation of plastic slip that a tangent is computed with.
const LEAST_SLOPE: f64 = 1.0 / STEEPEST;

/// The answer of a law to one increment. Its tangent is that of exactly what was computed.
///
/// ```text
/// δq = ∂q/∂Δu_t δΔu_t + ∂q/∂p δp,   δd = ∂d/∂Δu_t δΔu_t + ∂d/∂p δp        d: opening, 0 for most laws
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
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
    /// ∂d/∂p, below 1/α_n: an opening that grew faster with the pressure than the contact compliance would be unbounded
    /// [L³/F]
    pub dopening_dpressure: f64,
    /// Evaluations of the scalar equation of plastic slip that this answer took; 0 where it has a closed form
    pub evaluations: usize,
}

impl FrictionResponse {
    /// The answer of a law whose surfaces stay as far apart as they are, with ∂q/∂Δu_t and ∂q/∂p.
    pub fn new(state: FrictionState, dtraction_dslip: f64, dtraction_dpressure: f64) -> Self {
        Self { state, dtraction_dslip, dtraction_dpressure, ..Self::default() }
    }

    /// The answer that `state` follows without plastic slip, where q has the tangent `stiffness` by slip.
    pub fn elastic(state: FrictionState, stiffness: f64) -> Self {
        Self::new(state, stiffness, 0.0)
    }

    /// The answer of surfaces that do not ride up on each other in this increment, from the state `old` on: neither lift nor its
    /// work. Where wear outweighs dilation it stays as it is.
    pub fn without_lift(mut self, old: &FrictionState) -> Self {
        let lift = self.state.opening - old.opening;
        if lift > 0.0 {
            self.state.dissipation += 0.5 * (old.pressure + self.state.pressure) * lift;
            (self.state.opening, self.state.wear) = (old.opening, old.wear);
            (self.dopening_dslip, self.dopening_dpressure) = (0.0, 0.0);
        }
        self
    }

    /// Bounds the tangent to what [`FrictionLaw::respond`] promises for the stiffness α_t, and refuses numbers that have
    /// overflowed, and those of a committed state that was not finite.
    ///
    /// # Errors
    /// [`LawFailure::Overflow`].
    pub fn checked(mut self, stiffness: f64) -> Result<Self, LawFailure> {
        self.dtraction_dslip = self.dtraction_dslip.clamp(-STEEPEST * stiffness, STEEPEST * stiffness);
        self.dtraction_dpressure = self.dtraction_dpressure.clamp(-STEEPEST, STEEPEST);
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

/// A friction law, integrated over one increment. Pure: the same `old` and `sliding` give the same answer.
///
/// ```text
/// (q, variables, d)₁ = law((q, p, variables, d)₀; Δu_t, p₁, Δt)       q resists +Δu_t, p > 0 in compression
/// p = p̄ − α_n (g − d)                                                d: how far the law holds the surfaces apart (dilatancy)
/// W₁ − W₀ = ∫ q dλ − ∫ p dd ≥ 0                                     dissipation [F/L]; q²/(2 α_t) is stored
/// ```
/// Units: q, p [F/L²], Δu_t, d [L], α_t [F/L³], Δt [T]. A law is called with the pressure that it responds to, so that it never receives
/// penalty or multiplier; the contact finds the pressure that goes with the opening.
///
/// Where Δt = 0 the law answers to slip and pressure that come up at once, and q stays as it was if neither does: a step begins with
/// the traction that the one before has ended with. With p ≤ 0 the surfaces have parted.
///
/// A law of one parameter, a film of oil, is written like this. A law that can be cloned is friction of a contact as it is,
/// `Contact::new("base", "block_bottom", "ground_top", Oil { viscosity: 2.0 })`; nothing has to be registered. What it remembers
/// besides, at most [`MOST_VARIABLES`] numbers, it names in [`Description::variables`] (the k-th name is that of
/// `state.variables[k]`), and they appear by name in tables, frames and `Simulation::contact_field`:
///
/// ```
/// use fecontact::laws::friction::{
///     Description, FrictionLaw, FrictionResponse, FrictionState, LawFailure, Regime, Sliding,
/// };
///
/// /// Viscous friction, q = η v.
/// #[derive(Clone, Debug)]
/// struct Oil {
///     /// η: viscosity over thickness of the film, η > 0 [F·T/L³]
///     viscosity: f64,
/// }
///
/// impl FrictionLaw for Oil {
///     fn respond(&self, old: &FrictionState, sliding: Sliding) -> Result<FrictionResponse, LawFailure> {
///         let Sliding { slip, pressure, dt, .. } = sliding.checked()?;
///         if pressure <= 0.0 || dt == 0.0 {
///             let traction = if pressure > 0.0 { old.traction } else { 0.0 };
///             return FrictionResponse::elastic(old.stuck(traction, pressure.max(0.0)), 0.0).checked(1.0);
///         }
///         let dtraction_dslip = self.viscosity / dt;
///         let traction = dtraction_dslip * slip;
///         let mut state = old.stuck(traction, pressure);
///         state.plastic_slip += slip;
///         state.plastic_increment = slip;
///         state.dissipation += traction * slip;
///         state.regime = if slip == 0.0 { Regime::Stick } else { Regime::Slip };
///         FrictionResponse::new(state, dtraction_dslip, 0.0).checked(dtraction_dslip)
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

    /// State of a point that has not slipped, closed from the start under these tractions, or open where they are 0.
    fn initial_state(&self, pressure: f64, traction: f64) -> FrictionState {
        FrictionState::default().loaded(pressure, traction)
    }

    /// q, the law's variables, its regime and the opening at the end of the increment, with the consistent tangent,
    /// ∂q/∂Δu_t and ∂q/∂p being limited to ± [`STEEPEST`] times α_t, or 1.
    ///
    /// # Errors
    /// [`LawFailure`] when the increment or the answer is not finite, time goes backwards, or the law's equations are not
    /// solved to their tolerance.
    fn respond(&self, old: &FrictionState, sliding: Sliding) -> Answer;

    /// The answers of many points, each the same as alone. A law that has a quicker way than one after the other takes it
    /// here.
    fn respond_many(&self, old: &[FrictionState], sliding: &[Sliding], answers: &mut [Answer]) {
        for ((old, sliding), answer) in old.iter().zip(sliding).zip(answers) {
            *answer = self.respond(old, *sliding);
        }
    }

    /// The value of an observable in a state: of a variable, unless the law says otherwise; none if the law does not know it.
    fn observe(&self, name: &str, state: &FrictionState) -> Option<f64> {
        let variables = self.description().variables.iter().zip(state.variables);
        variables.into_iter().find_map(|(own, value)| (*own == name).then_some(value))
    }

    /// The law as it answers along a path that is given, such as a record of a test: with sub-steps where the error of an
    /// increment asks for them. None of a law whose increments are right whatever their length, or as they are.
    fn controlled(&self) -> Option<Box<dyn FrictionLaw>> {
        None
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

/// Description of a friction law, independent of the state of a point. Fields that do not apply stay as in
/// [`default`](Self::default): no stiffness, no variables, no bounds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct Description {
    /// α_t: tangential contact stiffness; the contact stores q²/(2 α_t). 0 where it stores nothing [F/L³]
    pub stiffness: f64,
    /// Whether α_t is a penalty: the law knows no elastic slip, and q/α_t is an error as a penetration is
    pub stiffness_is_penalty: bool,
    /// Names of the [`FrictionState::variables`] that the law uses: its own, and not those of what outputs show anyway
    /// ([`observables::check_names`])
    pub variables: &'static [&'static str],
    /// Names of what outputs show of a state beside what all laws have, see [`FrictionLaw::observe`]; the variables unless given
    pub observables: Option<&'static [&'static str]>,
    /// Names of the parts of the opening that outputs show, `dilation` and `wear`, as far as the law has them. A law whose opening
    /// changes names one: then a point is closed by what slip makes of its opening, not by that of the old state
    pub opening: &'static [&'static str],
    /// True of a law whose q is 0 whatever the slip: there is no slip to resolve, and nothing to break
    pub is_frictionless: bool,
    /// Whether parameters that vary in time enter by their mean over an increment, as rates do, and not by their value at its
    /// end, as strengths do
    pub takes_means: bool,
    /// Largest |q|/p that a point which has not slipped yet may start with; none for a law that lets an excess slip off [-]
    pub starting_coefficient: Option<f64>,
    /// Lowest |q|/p of a point in continued sliding, at any rate and state; none where there is no such bound, or the
    /// law does not say [-]
    pub least_coefficient: Option<f64>,
    /// −d(q/p)/dδ at its largest: how much friction fast slip takes over its way δ, 0 where it takes none [1/L]
    pub weakening: f64,
}

impl Description {
    /// Names of what outputs show of a state beside what all laws have.
    pub fn observables(&self) -> &'static [&'static str] {
        self.observables.unwrap_or(self.variables)
    }

    /// Largest |q| that a point which has not slipped yet may start with under the pressure p; infinite for a law that
    /// lets an excess slip off [F/L²]
    pub fn starting_limit(&self, pressure: f64) -> f64 {
        self.starting_coefficient.map_or(f64::INFINITY, |coefficient| coefficient * pressure)
    }

    /// Pressure from which the rate problem may have several answers, α_t over the weakening, if there is one [F/L²]
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

    /// The increment Δu_t under the pressure p at its end, in the time Δt.
    pub const fn new(slip: f64, pressure: f64, dt: f64) -> Self {
        Self { slip, pressure, dt }
    }

    /// Refuses what no law can answer.
    ///
    /// # Errors
    /// [`LawFailure`] when a number is not finite, or time goes backwards.
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

/// Why a law could not answer; the increment is tried again with a smaller step.
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
    /// The increment goes back in time.
    #[error("the friction law was evaluated for a negative time increment {dt}")]
    NegativeTime {
        /// increment length [T]
        dt: f64,
    },
    /// The equation of plastic slip was not solved, or the sub-steps of the increment did not come to agree.
    #[error(
        "the friction law did not converge within {evaluations} evaluations: residual {rest:.3e} of the trial traction \
         {trial:.3e}"
    )]
    NotConverged {
        /// evaluations of the equation of plastic slip
        evaluations: usize,
        /// what is left out of balance, or the difference between sub-steps [F/L²]
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
    /// Parameters that vary in time have no good value at a time.
    #[error("the parameters of the friction law are not finite, or out of their range, at t = {time}: check `along`")]
    Undefined {
        /// t [T]
        time: f64,
    },
    /// Parameters that vary in time let the surfaces dilate more than they rub.
    #[error(
        "the opening per slip {rate} (dilatancy.rate) is not below the lowest friction coefficient {least} of the law \
         at t = {time}, and sliding would produce energy: lower dilatancy.rate, or keep `along` above it"
    )]
    Dilates {
        /// t [T]
        time: f64,
        /// tan ψ [-]
        rate: f64,
        /// least coefficient of the law then [-]
        least: f64,
    },
    /// The state was not finite, or the increment is so large that it no longer is.
    #[error("the friction state is not finite: the traction is {traction}")]
    Overflow {
        /// q: traction [F/L²]
        traction: f64,
    },
    /// A registered law has failed, for a reason of its own.
    #[error("a registered friction law returned no result")]
    Registered,
}

/// Tractions at a point of an interface with radiation damping.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointLoad {
    /// τ = q + η V: what friction and radiation damping carry together [F/L²]
    pub traction: f64,
    /// p [F/L²]
    pub pressure: f64,
    /// η [F T/L³]
    pub damping: f64,
}

/// A law whose slip rate follows from traction and state, so that an interface can be integrated by itself.
///
/// ```text
/// τ = q(V, x, p) + η V          solved for V, which has the sign of τ; x: the state, a number without dimension
/// ẋ = ẋ(V, x)
/// ```
pub trait RateLaw: Debug + Send + Sync {
    /// V; not a number where the law has no answer [L/T].
    fn slip_rate(&self, x: f64, loading: PointLoad) -> f64;

    /// ẋ at a slip rate [1/T].
    fn evolution(&self, _x: f64, _slip_rate: f64) -> f64 {
        0.0
    }

    /// x of what a point remembers.
    fn evolving(&self, _state: &FrictionState) -> f64 {
        0.0
    }

    /// The state with x in its variables.
    fn remember(&self, _x: f64, state: FrictionState) -> FrictionState {
        state
    }

    /// |∂(q/p)/∂x|: what an error of x does to the coefficient of friction [-].
    fn weight(&self) -> f64 {
        0.0
    }

    /// Whether the point sticks or slips.
    fn regime(&self, x: f64, slip_rate: f64) -> Regime;
}

/// |q| where plastic slip sets in, in an increment along which the elastic traction and the strength both go evenly from
/// their first value to their second, and the traction ends above. One that is above from the start slips from there.
///
/// Both lines are counted along the sign of the trial, so a traction of the other sign unloads elastically, passes zero,
/// and loads elastically up to the strength.
fn traction_at_yield(elastic: [f64; 2], strength: [f64; 2]) -> f64 {
    let (below, above) = (strength[0] - elastic[0], elastic[1] - strength[1]);
    if below <= 0.0 || above <= 0.0 {
        return elastic[0].max(0.0);
    }
    strength[0] + below / (below + above) * (strength[1] - strength[0])
}
