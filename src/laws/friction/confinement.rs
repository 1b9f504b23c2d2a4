//! Confinement of an interface alone: how its pressure answers to its opening.

use super::{Answer, ContactLaw, FrictionState, LawFailure, Sliding};

/// Normal stiffness K_n against which an interface opens, and its own normal stiffness α_n.
///
/// ```text
/// p = p_a + K_n g,   g = d − (p − p₀)/α_n        p_a: applied pressure, p₀ at the start; g: opening since the start; d: that of the law
/// K_n = 0                                        constant normal load, p = p_a
/// K_n = 4 G/D                                    constant normal stiffness, of a shaft of diameter D in soil of the shear modulus G
/// K_n → ∞                                        constant volume, g = 0: p = p₀ + α_n d
/// p = p_f + K d,   K = K_n/(1 + K_n/α_n),   p_f = (p_a + p₀ K_n/α_n)/(1 + K_n/α_n)                                      (1)
/// ```
/// 4 G/D is the stiffness of a cylindrical cavity in elastic soil, dσ_r = 2 G dr/r.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct Confinement {
    /// K_n: normal stiffness of what surrounds the interface; infinite for constant volume [F/L³]
    pub stiffness: f64,
    /// α_n: normal stiffness of the interface; infinite for a rigid one [F/L³]
    pub alpha_n: f64,
}

impl Default for Confinement {
    /// Constant normal load on an interface that does not give way.
    fn default() -> Self {
        Self { stiffness: 0.0, alpha_n: f64::INFINITY }
    }
}

/// Pressure where the law has no opening, and stiffness against its opening.
#[derive(Clone, Copy, Debug, PartialEq)]
#[doc(hidden)]
pub struct Confined {
    /// p_f [F/L²]
    pub pressure: f64,
    /// K [F/L³]
    pub stiffness: f64,
}

impl Confinement {
    /// (1), under the applied pressure p_a of an interface that started with p₀.
    #[doc(hidden)]
    pub fn confined(&self, applied: f64, start: f64) -> Confined {
        let Self { stiffness, alpha_n } = *self;
        if stiffness.is_infinite() {
            return Confined { pressure: start, stiffness: alpha_n };
        }
        let ratio = stiffness / alpha_n;
        Confined { pressure: (applied + ratio * start) / (1.0 + ratio), stiffness: stiffness / (1.0 + ratio) }
    }

    /// g: opening of the interface since the start, where it had the pressure p₀ [L]
    pub fn gap(&self, state: &FrictionState, start: f64) -> f64 {
        state.opening - (state.pressure - start) / self.alpha_n
    }
}

/// Largest number of evaluations of the law until its opening and the pressure agree.
pub(crate) const MOST_ANSWERS: usize = 100;

/// Relative tolerance of the pressure.
const AGREE: f64 = 1e-14;

/// Pressures between which the one lies that agrees with the opening of the law: zero is too low where the surfaces stay closed.
pub(crate) struct Bracket {
    low: f64,
    high: f64,
}

/// What a response says about the pressure under which it was asked for.
pub(crate) struct Opened {
    /// pressure that its opening makes [F/L²]
    pub found: f64,
    /// pressure by a step along its tangent [F/L²]
    pub next: f64,
    /// size of the pressures in it, for round-off [F/L²]
    pub size: f64,
    /// pressure by a slip as large as the whole [F/L²]
    pub slipped: f64,
}

impl Bracket {
    /// All pressures.
    pub const fn new() -> Self {
        Self { low: 0.0, high: f64::INFINITY }
    }

    /// The pressure to ask for after `asked`; `None` if that agrees.
    pub fn after(&mut self, asked: f64, Opened { found, next, size, slipped }: Opened) -> Option<f64> {
        *(if asked < found { &mut self.low } else { &mut self.high }) = asked;
        let Self { low, high } = *self;
        let middle = 0.5 * (low + high.min(4.0 * asked));
        // Where they are neighbouring numbers: the law takes the plastic slip as a difference from the whole slip, so its
        // opening is only as exact as that.
        let size = if middle <= low || high <= middle { size + slipped } else { size };
        if (next - asked).abs() <= AGREE * size {
            return None;
        }
        // Slip sets in with a kink, across which tangent steps alternate.
        Some(if low < next && next < high { next } else { middle })
    }
}

impl ContactLaw {
    /// Response to an increment of slip under the pressure that agrees with the opening, p = p_f + K d(p); that of `sliding` is not
    /// asked for. At most one pressure does: as it rises, less slip is plastic, and the surfaces open less.
    ///
    /// # Errors
    /// Returns the failure of the law, or [`LawFailure::Opening`].
    pub fn respond_confined(
        &self,
        old: &FrictionState,
        sliding: Sliding,
        Confined { pressure: free, stiffness }: Confined,
    ) -> Answer {
        let respond = |pressure: f64| self.respond(old, Sliding { pressure, ..sliding });
        if stiffness == 0.0 || self.description.opening.is_empty() {
            return respond(free);
        }
        // A law has no response at p = 0, but near it its slip no longer changes.
        let size = old.pressure
            + old.traction.abs()
            + free.abs()
            + (stiffness + self.description.stiffness) * sliding.slip.abs();
        let highest = free + stiffness * respond(f64::EPSILON * size)?.state.opening;
        if highest <= 0.0 {
            return respond(highest);
        }
        let mut bracket = Bracket::new();
        let mut asked = if old.pressure > 0.0 { old.pressure.min(highest) } else { highest };
        let mut opening = 0.0;
        for _ in 0..MOST_ANSWERS {
            let response = respond(asked)?;
            opening = response.state.opening;
            let found = free + stiffness * opening;
            let next = asked + (found - asked) / (1.0 - stiffness * response.dopening_dpressure);
            let size = asked + free.abs() + stiffness * opening.abs();
            match bracket.after(asked, Opened { found, next, size, slipped: stiffness * sliding.slip.abs() }) {
                None => return Ok(response),
                Some(next) => asked = next,
            }
        }
        Err(LawFailure::Opening { opening, pressure: asked })
    }
}
