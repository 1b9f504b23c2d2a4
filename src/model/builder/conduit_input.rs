//! Water that flows along a contact: its input.

use nalgebra::Vector2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::error::{Checked, ModelError, check_finite, check_not_negative, check_positive, refuse_if};
use crate::contact::conduit::InTime;
use crate::laws::parameter::ratio;
use crate::model::boundary::{Drive, Expression, Profile, Span, check_table};
use crate::model::written::written;

/// Water that flows along a contact: S ∂p/∂t + ∂w/∂t = ∂/∂s(T/η ∂p/∂s) + Q − c (p − p̄) along the undeformed slave, with the aperture w that
/// opens and the dilatancy that lifts. Its ends are impervious; periodic sides are joined
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Flow {
    /// S: volume per length and pressure that is stored, S > 0 [L³/F]
    pub storage: f64,
    /// T: transmissivity, permeability times thickness, zero or positive, by place. Or `aperture` [L³]
    pub transmissivity: Option<Profile>,
    /// w_h: hydraulic aperture of closed surfaces, for T = (w_h + w)³/12 (cubic law) [L]
    pub aperture: Option<f64>,
    /// k₁: T grows by k₁ |slip|; default 0 [L²]
    #[serde(default)]
    pub per_slip: f64,
    /// σ: T is multiplied by exp(−p′/σ), p′ the effective pressure of the contact; default: it does not depend on it [F/L²]
    pub closing: Option<f64>,
    /// η: viscosity [F T/L²]
    pub viscosity: f64,
    /// p_w at the start by place, zero or positive; default 0 [F/L²]
    #[serde(default)]
    pub initial: Profile,
    /// Q: what flows in per length, by place and time; default 0 [L/T]
    pub source: Option<Profile>,
    /// Wells
    #[serde(default)]
    pub wells: Vec<FlowWell>,
    /// Flow through the walls into the bodies; default: none
    pub leak: Option<FlowLeak>,
    /// Error of the pressure that is allowed by what the surfaces do within an increment, over its largest change in the run so far: it
    /// takes part in the choice of static and implicit increments, but not beside bodies whose water flows, where `dt.pore_pressure` does; default 0.01
    #[serde(default = "ratio::<1, 100>")]
    pub error: f64,
}

/// Well of a contact, which has either a pressure or a rate.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct FlowWell {
    /// Reference position [x, y] on the slave: a pressure is prescribed at the nearest node, a rate is shared by the two beside it [L]
    pub at: [f64; 2],
    /// Pressure that is prescribed, from its start on [F/L²]
    pub pressure: Option<Schedule>,
    /// Volume that flows in, out if negative; over the thickness of the section, 1 unless given [L³/T]
    pub rate: Option<Schedule>,
    /// Start; it is shut before. Default: that of the run [T]
    pub from: Option<f64>,
    /// End; it is shut from then on. Default: never [T]
    pub until: Option<f64>,
}

/// Flow c (p − p̄) through the walls of a contact.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct FlowLeak {
    /// c: volume per length, pressure and time, zero or positive [L³/(F T)]
    pub coefficient: f64,
    /// p̄ by place; default: `initial` [F/L²]
    pub pressure: Option<Profile>,
}

/// A quantity that varies in time.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(remote = "Self", rename_all = "snake_case")]
#[schemars(!remote)]
#[non_exhaustive]
pub enum Schedule {
    /// Pairs of run time and value, times ascending; linear between, constant outside
    Table(Vec<[f64; 2]>),
    /// The same all the time
    #[serde(skip)]
    #[schemars(!skip, untagged)]
    Constant(f64),
    /// Expression in the run time t
    #[serde(skip)]
    #[schemars(!skip, untagged)]
    Expression(Expression),
}

written!(
    Schedule,
    "a number, an expression in t such as \"min(t, 10)\", or {\"table\": [[t, v], …]}",
    number: Constant,
    text: Expression
);

impl From<f64> for Schedule {
    fn from(value: f64) -> Self {
        Self::Constant(value)
    }
}

impl Schedule {
    pub(super) fn check(&self, place: &str) -> Checked<()> {
        match self {
            Self::Constant(value) => check_finite(place, [*value]),
            Self::Table(table) => {
                check_finite(place, table.iter().flatten().copied())?;
                check_table(table, "time").map_err(|error| ModelError::new(place, error))
            }
            Self::Expression(expression) => {
                let message = "depends on x or y, and is that of one place: leave them out";
                refuse_if(expression.depends_on_position(), place, message)
            }
        }
    }

    /// Values that are given.
    pub(super) fn values(&self) -> impl Iterator<Item = f64> + '_ {
        let (constant, table) = match self {
            Self::Constant(value) => (Some(*value), &[][..]),
            Self::Table(table) => (None, &table[..]),
            Self::Expression(_) => (None, &[][..]),
        };
        constant.into_iter().chain(table.iter().map(|row| row[1]))
    }

    pub(super) fn corners(&self) -> Vec<f64> {
        match self {
            Self::Table(table) => table.iter().map(|row| row[0]).collect(),
            _ => Vec::new(),
        }
    }

    /// Values from a first time on.
    pub(super) fn in_time(&self) -> InTime {
        let span = Span { start: 0.0, end: 1.0 };
        match self.clone() {
            Self::Constant(value) => Box::new(move |_| value),
            Self::Table(table) => {
                let drive = Drive::Table(table);
                Box::new(move |time| drive.value(Vector2::zeros(), time, span, 0.0))
            }
            Self::Expression(expression) => Box::new(move |time| expression.value(Vector2::zeros(), time)),
        }
    }
}

impl Flow {
    /// Water with a storage S [L³/F], a transmissivity T [L³] and a viscosity η [F T/L²].
    pub fn new(storage: f64, transmissivity: impl Into<Profile>, viscosity: f64) -> Self {
        Self {
            storage,
            transmissivity: Some(transmissivity.into()),
            aperture: None,
            per_slip: 0.0,
            closing: None,
            viscosity,
            initial: Profile::default(),
            source: None,
            wells: Vec::new(),
            leak: None,
            error: 0.01,
        }
    }

    /// Holds a pressure at the node nearest to a place.
    #[must_use]
    pub fn hold(mut self, at: [f64; 2], pressure: impl Into<Schedule>) -> Self {
        self.wells.push(FlowWell { at, pressure: Some(pressure.into()), rate: None, from: None, until: None });
        self
    }

    /// Lets a volume per time flow in at a place [L³/T].
    #[must_use]
    pub fn inject(mut self, at: [f64; 2], rate: impl Into<Schedule>) -> Self {
        self.wells.push(FlowWell { at, pressure: None, rate: Some(rate.into()), from: None, until: None });
        self
    }

    /// Checks the numbers that stand alone.
    pub(super) fn check(&self, place: &str) -> Checked<()> {
        check_positive(
            &format!("{place}.storage"),
            self.storage,
            ": without it the pressure of closed surfaces has no value",
        )?;
        check_positive(&format!("{place}.viscosity"), self.viscosity, "")?;
        check_not_negative(&format!("{place}.per_slip"), self.per_slip)?;
        check_positive(&format!("{place}.error"), self.error, "")?;
        let both = "is given beside `aperture`, by which the cubic law gives it: leave one of them out";
        refuse_if(self.transmissivity.is_some() && self.aperture.is_some(), format!("{place}.transmissivity"), both)?;
        let none = "is missing: give it, or the hydraulic `aperture` of the cubic law";
        refuse_if(self.transmissivity.is_none() && self.aperture.is_none(), format!("{place}.transmissivity"), none)?;
        let why = "is for a given `transmissivity`; by the cubic law it follows from the aperture, which dilatancy opens: leave it out";
        refuse_if(self.per_slip > 0.0 && self.aperture.is_some(), format!("{place}.per_slip"), why)?;
        self.aperture.map_or(Ok(()), |value| check_not_negative(&format!("{place}.aperture"), value))?;
        self.closing.map_or(Ok(()), |value| check_positive(&format!("{place}.closing"), value, ""))?;
        self.leak
            .as_ref()
            .map_or(Ok(()), |leak| check_not_negative(&format!("{place}.leak.coefficient"), leak.coefficient))
    }
}
