//! Loads as they are written.

use schemars::JsonSchema;
use serde::Deserialize;

use super::drive::{Components, DriveInput};
use super::place::{Place, present};

/// A load: exactly one kind an entry.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LoadInput {
    /// Where
    pub on: Place,
    /// Pressure on edges that follows the surface, positive toward the body [F/L²]
    #[serde(default, deserialize_with = "present")]
    pub pressure: Option<Option<DriveInput>>,
    /// Pressure on edges that keeps the force and direction it has on the undeformed edges, positive toward the body [F/L²]
    #[serde(default, deserialize_with = "present")]
    pub dead_pressure: Option<Option<DriveInput>>,
    /// Traction on reference edges that keeps its direction [F/L²]
    #[serde(default, deserialize_with = "present")]
    pub traction: Option<Option<Components>>,
    /// Acceleration of gravity on a body or on point masses [L/T²]
    #[serde(default, deserialize_with = "present")]
    pub gravity: Option<Option<Components>>,
    /// Force on every node of the group [F]
    #[serde(default, deserialize_with = "present")]
    pub force: Option<Option<Components>>,
    /// Force on edges as a whole, spread over them as an even traction: a unit of depth in plane strain, the thickness of a
    /// plate, the full turn of a ring. Its expressions depend on t alone [F]
    #[serde(default, deserialize_with = "present")]
    pub total_force: Option<Option<Components>>,
    /// Moment on a plate that moves as a rigid body, counter-clockwise; it turns with the plate [F L]
    #[serde(default, deserialize_with = "present")]
    pub moment: Option<Option<DriveInput>>,
    /// Spring at every node of the group, to the ground or to a moving driver; what it does to the node counts as work
    /// from outside
    #[serde(default, deserialize_with = "present")]
    pub spring: Option<Option<SpringInput>>,
    /// Dashpot at every node of the group, to the ground or to a moving driver
    #[serde(default, deserialize_with = "present")]
    pub dashpot: Option<Option<DashpotInput>>,
    /// true: a side of a body absorbs waves, as if the body went on (Lysmer-Kuhlemeyer: dashpots rho c_p along the normal
    /// and rho c_s along the side, of the undeformed body); false or null ends it
    #[serde(default, deserialize_with = "present")]
    pub absorbing: Option<Option<bool>>,
}

/// A spring.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpringInput {
    /// Stiffness in x [F/L]
    #[serde(default)]
    pub kx: f64,
    /// Stiffness in y [F/L]
    #[serde(default)]
    pub ky: f64,
    /// Displacement of the far end; the ground unless given [L]
    pub driver: Option<Components>,
}

/// A dashpot: force c (v_driver − v). In statics v is the mean velocity of the increment.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DashpotInput {
    /// Coefficient in x [F T/L]
    #[serde(default)]
    pub cx: f64,
    /// Coefficient in y [F T/L]
    #[serde(default)]
    pub cy: f64,
    /// Velocity of the far end; the ground unless given [L/T]
    pub driver: Option<Components>,
}
