//! State of friction at a contact point.

use std::ops::{Index, IndexMut};

use serde::{Deserialize, Serialize};

/// Internal variables of a law at a point, any number of them; those that were never set are 0.
///
/// The first four stand in the state itself, so that laws with few variables allocate no memory.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Variables {
    first: [f64; 4],
    more: Vec<f64>,
}

impl Variables {
    /// All zero.
    pub(super) const ZERO: Self = Self { first: [0.0; 4], more: Vec::new() };

    /// All values; at least four, as many as were set.
    pub fn values(&self) -> impl Iterator<Item = f64> {
        self.first.iter().chain(&self.more).copied()
    }

    /// Values to be changed; at least four, as many as were set.
    pub fn values_mut(&mut self) -> impl Iterator<Item = &mut f64> {
        self.first.iter_mut().chain(&mut self.more)
    }
}

impl Index<usize> for Variables {
    type Output = f64;

    fn index(&self, k: usize) -> &f64 {
        self.first.get(k).or_else(|| self.more.get(k - self.first.len())).unwrap_or(&0.0)
    }
}

impl IndexMut<usize> for Variables {
    fn index_mut(&mut self, k: usize) -> &mut f64 {
        let inside = self.first.len();
        if k < inside {
            return &mut self.first[k];
        }
        if self.more.len() <= k - inside {
            self.more.resize(k - inside + 1, 0.0);
        }
        &mut self.more[k - inside]
    }
}

impl FromIterator<f64> for Variables {
    fn from_iter<I: IntoIterator<Item = f64>>(values: I) -> Self {
        let mut values = values.into_iter();
        let first = [(); 4].map(|()| values.next().unwrap_or(0.0));
        Self { first, more: values.collect() }
    }
}

/// Internal state of friction at one contact point between increments.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
#[must_use]
pub struct FrictionState {
    /// q: traction that resists the slip of the slave along +s [F/L²]
    pub traction: f64,
    /// p: contact pressure, positive in compression [F/L²]
    pub pressure: f64,
    /// Total plastic slip, signed along +s [L]
    pub plastic_slip: f64,
    /// Plastic slip of the last increment, signed along +s [L]
    pub plastic_increment: f64,
    /// Work dissipated by friction so far per contact area [F/L]
    pub dissipation: f64,
    /// d: opening of the surfaces by the law, negative after wear; 0 for laws without dilatancy and wear [L]
    pub opening: f64,
    /// w: wear depth, included in `opening` [L]
    pub wear: f64,
    /// Open, stick or slip in the law's last increment
    pub regime: Regime,
    /// Further internal variables, named by [`variables`](super::Description::variables)
    pub variables: Variables,
}

/// Contact status of a point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Regime {
    /// No pressure
    #[default]
    Open,
    /// Closed and sticking
    Stick,
    /// Closed and sliding
    Slip,
    /// Held under any pressure, by a tie
    Tied,
}

impl FrictionState {
    /// Returns the state with these internal variables.
    pub fn with_variables(self, values: impl IntoIterator<Item = f64>) -> Self {
        Self { variables: values.into_iter().collect(), ..self }
    }

    /// Returns the state under initial tractions, without slip.
    pub fn loaded(&self, pressure: f64, traction: f64) -> Self {
        let regime = if pressure > 0.0 { Regime::Stick } else { Regime::Open };
        Self { pressure, traction, regime, ..self.clone() }
    }

    /// |q|/(μ p): traction relative to the strength μ p; 0 if that is zero [-]
    pub fn ratio(&self, mu: f64) -> f64 {
        let strength = mu * self.pressure;
        if strength > 0.0 { self.traction.abs() / strength } else { 0.0 }
    }

    /// Returns the state after separation of the surfaces: the elastic energy q²/(2 α_t) of the contact spring is lost, if it has
    /// one, with α_t > 0.
    pub fn parted(&self, stiffness: f64) -> Self {
        let lost = if stiffness > 0.0 { self.traction * self.traction / (2.0 * stiffness) } else { 0.0 };
        let dissipation = self.dissipation + lost;
        Self { traction: 0.0, pressure: 0.0, plastic_increment: 0.0, dissipation, regime: Regime::Open, ..self.clone() }
    }

    /// Returns the state after an increment with purely elastic slip.
    pub fn stuck(&self, traction: f64, pressure: f64) -> Self {
        Self { plastic_increment: 0.0, ..self.loaded(pressure, traction) }
    }

    /// Returns the state after plastic slip along sgn q has reduced the traction from the elastic `trial` to `traction`.
    ///
    /// ```text
    /// Δλ = (|q_tr| − |q|)/α_t       plastic slip
    /// ΔW = ∫ |q| dλ = q̄ Δλ ≥ 0      work dissipated; q̄, the mean of |q| over the plastic slip, is the law's to know
    /// ```
    /// The work ∫ q du of the increment, along the path followed by the law, is Δ(q²/2α_t) + ΔW.
    pub fn slid(&self, trial: f64, traction: f64, mean: f64, pressure: f64, stiffness: f64) -> Self {
        let sign = traction.signum();
        let slip = ((trial - traction) * sign / stiffness).max(0.0);
        Self {
            traction,
            pressure,
            plastic_slip: self.plastic_slip + sign * slip,
            plastic_increment: sign * slip,
            dissipation: self.dissipation + mean * slip,
            regime: if slip > 0.0 { Regime::Slip } else { Regime::Stick },
            ..self.clone()
        }
    }

    /// Whether another state is the same in every bit.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        let bits = |state: &Self| {
            let Self { traction, pressure, plastic_slip, plastic_increment, dissipation, opening, wear, .. } = state;
            [traction, pressure, plastic_slip, plastic_increment, dissipation, opening, wear]
                .map(|value| value.to_bits())
        };
        let same = self.variables.values().map(f64::to_bits).eq(other.variables.values().map(f64::to_bits));
        bits(self) == bits(other) && same && self.regime == other.regime
    }

    /// Whether all its numbers are finite.
    pub(super) fn is_finite(&self) -> bool {
        let Self { traction, pressure, plastic_slip, plastic_increment, dissipation, opening, wear, variables, .. } =
            self;
        let common = traction + pressure + plastic_slip + plastic_increment + dissipation + opening + wear;
        (common + variables.values().sum::<f64>()).is_finite()
    }
}
