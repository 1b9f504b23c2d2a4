//! Input of loads, and their changes by a step.

use std::fmt::{Display, Formatter, Result as Written};

use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::groups::Place;
use crate::model::boundary::Drive;
use crate::model::text::number;

/// A load: exactly one kind per entry. It replaces the load of the same kind and place of an earlier step.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct Load {
    /// Group, or single node, on which it acts
    pub on: Place,
    /// Pressure on edges that follows the surface, positive toward the body [F/L²]
    #[serde(default, deserialize_with = "present", skip_serializing_if = "Option::is_none")]
    pub pressure: Option<Change<Drive>>,
    /// Pressure on edges with the force and direction that it has on the undeformed edges, positive toward the body [F/L²]
    #[serde(default, deserialize_with = "present", skip_serializing_if = "Option::is_none")]
    pub dead_pressure: Option<Change<Drive>>,
    /// Traction on reference edges with constant direction [F/L²]
    #[serde(default, deserialize_with = "present", skip_serializing_if = "Option::is_none")]
    pub traction: Option<Change<Components>>,
    /// Acceleration of gravity on a body or on point masses [L/T²]
    #[serde(default, deserialize_with = "present", skip_serializing_if = "Option::is_none")]
    pub gravity: Option<Change<Components>>,
    /// Force on every node of the group [F]
    #[serde(default, deserialize_with = "present", skip_serializing_if = "Option::is_none")]
    pub force: Option<Change<Components>>,
    /// Resultant force on edges, applied as a uniform traction: per unit of depth in plane strain, for the thickness in
    /// plane stress, per full turn in axisymmetry. Its expressions depend on t only [F]
    #[serde(default, deserialize_with = "present", skip_serializing_if = "Option::is_none")]
    pub total_force: Option<Change<Components>>,
    /// Moment on a rigid body, or on a loading plate that moves as one, with which it rotates; counter-clockwise [F L]
    #[serde(default, deserialize_with = "present", skip_serializing_if = "Option::is_none")]
    pub moment: Option<Change<Drive>>,
    /// Spring at every node of the group, to the ground or to a moving driver; its work on the node counts as external
    /// work
    #[serde(default, deserialize_with = "present", skip_serializing_if = "Option::is_none")]
    pub spring: Option<Change<SpringLoad>>,
    /// Dashpot at every node of the group, to the ground or to a moving driver
    #[serde(default, deserialize_with = "present", skip_serializing_if = "Option::is_none")]
    pub dashpot: Option<Change<DashpotLoad>>,
    /// true: an absorbing side, as if the body were unbounded there (Lysmer-Kuhlemeyer: dashpots rho c_p along the
    /// normal and rho c_s along the side, of the undeformed body); false or null ends it
    #[serde(default, deserialize_with = "present", skip_serializing_if = "Option::is_none")]
    pub absorbing: Option<Change<bool>>,
}

/// Kind of a load; a load replaces an earlier one of the same kind at the same place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// follower pressure
    Pressure,
    /// pressure on reference edges
    DeadPressure,
    /// traction on reference edges
    Traction,
    /// acceleration of gravity
    Gravity,
    /// force on every node
    Force,
    /// resultant on edges
    TotalForce,
    /// springs
    Spring,
    /// dashpots
    Dashpot,
    /// absorbing side
    Absorbing,
    /// moment
    Moment,
}

impl Kind {
    /// Key of the input.
    pub fn key(self) -> &'static str {
        match self {
            Self::Pressure => "pressure",
            Self::DeadPressure => "dead_pressure",
            Self::Traction => "traction",
            Self::Gravity => "gravity",
            Self::Force => "force",
            Self::TotalForce => "total_force",
            Self::Spring => "spring",
            Self::Dashpot => "dashpot",
            Self::Absorbing => "absorbing",
            Self::Moment => "moment",
        }
    }

    /// Whether a load that ends decreases to zero over the step, and does not end at once.
    pub fn fades(self) -> bool {
        !matches!(self, Self::Spring | Self::Dashpot | Self::Absorbing)
    }

    /// Whether it acts on edges, at whose Gauss points it is evaluated.
    fn is_evaluated_on_edges(self) -> bool {
        matches!(self, Self::Pressure | Self::DeadPressure | Self::Traction)
    }
}

/// Value of a load.
#[derive(Clone, Copy)]
pub enum Value<'l> {
    /// one drive
    Scalar(&'l Drive),
    /// components
    Vector(&'l Components),
    /// a spring
    Spring(&'l SpringLoad),
    /// a dashpot
    Dashpot(&'l DashpotLoad),
    /// an absorbing side, which has no value
    Absorbing,
}

impl<'l> Value<'l> {
    /// Returns the components of the load, or those of its driver.
    pub fn components(self) -> Option<&'l Components> {
        match self {
            Self::Vector(components) => Some(components),
            Self::Spring(SpringLoad { driver, .. }) | Self::Dashpot(DashpotLoad { driver, .. }) => driver.as_ref(),
            Self::Scalar(_) | Self::Absorbing => None,
        }
    }

    /// Returns the drives of the load, with their keys within the key of the load.
    pub fn drives(self) -> Vec<(&'static str, &'l Drive)> {
        let keys = match self {
            Self::Scalar(drive) => return vec![("", drive)],
            Self::Vector(_) => [".x", ".y"],
            _ => [".driver.x", ".driver.y"],
        };
        let along = |i: usize| Some((keys[i], self.components()?.along(i)?));
        (0..2).filter_map(along).collect()
    }
}

impl Display for Value<'_> {
    fn fmt(&self, f: &mut Formatter) -> Written {
        match self {
            Self::Scalar(drive) => drive.fmt(f),
            Self::Vector(components) => components.fmt(f),
            Self::Spring(SpringLoad { kx, ky, .. }) => write!(f, "kx {}, ky {}", number(*kx), number(*ky)),
            Self::Dashpot(DashpotLoad { cx, cy, .. }) => write!(f, "cx {}, cy {}", number(*cx), number(*cy)),
            Self::Absorbing => f.write_str("rho c_p and rho c_s of its body"),
        }?;
        match self {
            Self::Spring(SpringLoad { driver: Some(driver), .. }) => write!(f, ", far end displaced by {driver}"),
            Self::Dashpot(DashpotLoad { driver: Some(driver), .. }) => write!(f, ", far end moving with {driver}"),
            _ => Ok(()),
        }
    }
}

/// Components of a vector; default: zero.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct Components {
    /// x component
    pub x: Option<Drive>,
    /// y component
    pub y: Option<Drive>,
}

impl Components {
    /// The component along x (0) or y (1).
    pub fn along(&self, component: usize) -> Option<&Drive> {
        if component == 0 { self.x.as_ref() } else { self.y.as_ref() }
    }
}

impl Display for Components {
    fn fmt(&self, f: &mut Formatter) -> Written {
        let part = |part: &Option<Drive>| part.as_ref().map_or("0".into(), Drive::to_string);
        write!(f, "({}, {})", part(&self.x), part(&self.y))
    }
}

impl<D: Into<Drive>> From<[D; 2]> for Components {
    fn from([x, y]: [D; 2]) -> Self {
        Self { x: Some(x.into()), y: Some(y.into()) }
    }
}

impl<D: Into<Drive>> From<[D; 2]> for Change<Components> {
    fn from(components: [D; 2]) -> Self {
        Self::To(components.into())
    }
}

/// A spring.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Spring")]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct SpringLoad {
    /// Stiffness in x [F/L]
    #[serde(default)]
    pub kx: f64,
    /// Stiffness in y [F/L]
    #[serde(default)]
    pub ky: f64,
    /// Displacement of the far end; default: the ground [L]
    pub driver: Option<Components>,
}

impl SpringLoad {
    /// Creates a spring with the stiffness along x and along y, to the ground [F/L].
    pub fn new(kx: f64, ky: f64) -> Self {
        Self { kx, ky, driver: None }
    }
}

setters! { spring: SpringLoad;
    /// Sets the displacement of the far end [L].
    driver(driver: impl Into<Components>) { spring.driver = Some(driver.into()); }
}

/// A dashpot: force c (v_driver − v). In statics v is the mean velocity of the increment.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Dashpot")]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct DashpotLoad {
    /// Coefficient in x [F T/L]
    #[serde(default)]
    pub cx: f64,
    /// Coefficient in y [F T/L]
    #[serde(default)]
    pub cy: f64,
    /// Velocity of the far end; default: the ground [L/T]
    pub driver: Option<Components>,
}

impl DashpotLoad {
    /// Creates a dashpot with the coefficient along x and along y, to the ground [F T/L].
    pub fn new(cx: f64, cy: f64) -> Self {
        Self { cx, cy, driver: None }
    }
}

setters! { dashpot: DashpotLoad;
    /// Sets the velocity of the far end [L/T].
    driver(driver: impl Into<Components>) { dashpot.driver = Some(driver.into()); }
}

conversions! {
    SpringLoad => Change<SpringLoad>: |spring| Self::To(spring);
    DashpotLoad => Change<DashpotLoad>: |dashpot| Self::To(dashpot);
    /// A spring to the ground.
    [f64; 2] => Change<SpringLoad>: |[kx, ky]| Self::To(SpringLoad::new(kx, ky));
    /// A dashpot to the ground.
    [f64; 2] => Change<DashpotLoad>: |[cx, cy]| Self::To(DashpotLoad::new(cx, cy));
    f64 => Change<f64>: |value| Self::To(value);
    f64 => Change<Drive>: |value| Self::To(value.into());
    Drive => Change<Drive>: |drive| Self::To(drive);
}

impl Load {
    /// Creates an empty load at a place.
    fn on(place: impl Into<Place>) -> Self {
        Self {
            on: place.into(),
            pressure: None,
            dead_pressure: None,
            traction: None,
            gravity: None,
            force: None,
            total_force: None,
            moment: None,
            spring: None,
            dashpot: None,
            absorbing: None,
        }
    }

    /// Returns what it gives if it is exactly one: the kind, and the value unless the load ends.
    pub(super) fn action(&self) -> Option<(Kind, Option<Value<'_>>)> {
        let scalars =
            [(Kind::Pressure, &self.pressure), (Kind::DeadPressure, &self.dead_pressure), (Kind::Moment, &self.moment)];
        let vectors = [
            (Kind::Traction, &self.traction),
            (Kind::Gravity, &self.gravity),
            (Kind::Force, &self.force),
            (Kind::TotalForce, &self.total_force),
        ];
        let spring = self.spring.as_ref().map(|change| (Kind::Spring, change.given().map(Value::Spring)));
        let dashpot = self.dashpot.as_ref().map(|change| (Kind::Dashpot, change.given().map(Value::Dashpot)));
        let absorbs = |change: &Change<bool>| (change.given() == Some(&true)).then_some(Value::Absorbing);
        let absorbing = self.absorbing.as_ref().map(|change| (Kind::Absorbing, absorbs(change)));
        let scalars = scalars.map(|(kind, change)| Some((kind, change.as_ref()?.given().map(Value::Scalar))));
        let vectors = vectors.map(|(kind, change)| Some((kind, change.as_ref()?.given().map(Value::Vector))));
        let mut given = scalars.into_iter().chain(vectors).chain([spring, dashpot, absorbing]).flatten();
        given.next().filter(|_| given.next().is_none())
    }

    /// Returns the drives with their keys, and whether each is evaluated on edges.
    pub(super) fn drives(&self) -> impl Iterator<Item = (String, bool, &Drive)> {
        let given = self.action().and_then(|(kind, value)| Some((kind, value?)));
        let drives = given.map(|(kind, value)| value.drives().into_iter().map(move |drive| (kind, drive)));
        drives
            .into_iter()
            .flatten()
            .map(|(kind, (within, drive))| (format!("{}{within}", kind.key()), kind.is_evaluated_on_edges(), drive))
    }

    /// Creates a follower pressure on edges, positive toward the body [F/L²]; [`Change::End`] reduces it to zero over the step.
    pub fn pressure(on: impl Into<Place>, pressure: impl Into<Change<Drive>>) -> Self {
        Self { pressure: Some(pressure.into()), ..Self::on(on) }
    }

    /// Creates a pressure on reference edges with constant force and direction, positive toward the body [F/L²].
    pub fn dead_pressure(on: impl Into<Place>, pressure: impl Into<Change<Drive>>) -> Self {
        Self { dead_pressure: Some(pressure.into()), ..Self::on(on) }
    }

    /// Creates a traction on reference edges with constant direction [F/L²].
    pub fn traction(on: impl Into<Place>, traction: impl Into<Change<Components>>) -> Self {
        Self { traction: Some(traction.into()), ..Self::on(on) }
    }

    /// Creates gravity on a body or on point masses [L/T²].
    pub fn gravity(on: impl Into<Place>, acceleration: impl Into<Change<Components>>) -> Self {
        Self { gravity: Some(acceleration.into()), ..Self::on(on) }
    }

    /// Creates a force on every node [F].
    pub fn force(on: impl Into<Place>, force: impl Into<Change<Components>>) -> Self {
        Self { force: Some(force.into()), ..Self::on(on) }
    }

    /// Creates a resultant force on edges, applied as a uniform traction: per unit of depth in plane strain, for the thickness
    /// in plane stress, per full turn in axisymmetry [F].
    pub fn total_force(on: impl Into<Place>, force: impl Into<Change<Components>>) -> Self {
        Self { total_force: Some(force.into()), ..Self::on(on) }
    }

    /// Creates a moment on a platen that can rotate, counter-clockwise [F L].
    pub fn moment(on: impl Into<Place>, moment: impl Into<Change<Drive>>) -> Self {
        Self { moment: Some(moment.into()), ..Self::on(on) }
    }

    /// Creates springs with the stiffnesses k_x, k_y at every node [F/L]; [`Change::End`] removes them at once.
    pub fn spring(on: impl Into<Place>, stiffness: impl Into<Change<SpringLoad>>) -> Self {
        Self { spring: Some(stiffness.into()), ..Self::on(on) }
    }

    /// Creates dashpots with the coefficients c_x, c_y at every node [F T/L].
    pub fn dashpot(on: impl Into<Place>, coefficients: impl Into<Change<DashpotLoad>>) -> Self {
        Self { dashpot: Some(coefficients.into()), ..Self::on(on) }
    }

    /// Creates an absorbing side.
    pub fn absorbing(on: impl Into<Place>) -> Self {
        Self { absorbing: Some(Change::To(true)), ..Self::on(on) }
    }
}

/// Change of a support, a load or an error control by a step: a new value, or its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Change<T> {
    /// New value
    To(T),
    /// It ends
    End,
}

impl<T> Change<T> {
    /// Returns the new value, if it does not end.
    pub fn given(&self) -> Option<&T> {
        match self {
            Self::To(given) => Some(given),
            Self::End => None,
        }
    }
}

impl<T: Serialize> Serialize for Change<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.given().serialize(serializer)
    }
}

impl<T: JsonSchema> JsonSchema for Change<T> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> std::borrow::Cow<'static, str> {
        Option::<T>::schema_name()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        Option::<T>::json_schema(generator)
    }
}

/// Distinguishes a key that is `null`, which ends an earlier entry, from an absent one, which changes nothing.
pub(super) fn present<'de, T: Deserialize<'de>, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Option<Change<T>>, D::Error> {
    let given = Option::deserialize(deserializer)?;
    Ok(Some(given.map_or(Change::End, Change::To)))
}
