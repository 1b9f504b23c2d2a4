//! What the plane stands for.

use schemars::JsonSchema;
use serde::Deserialize;

/// What the plane stands for in space.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SectionInput {
    /// A slice of thickness 1 of bodies that go on without end across the plane: forces, masses and energies per unit of
    /// thickness
    #[default]
    PlaneStrain,
    /// A plate, free of stress across the plane: forces, masses and energies of its whole thickness. Pressures and tractions,
    /// those of contact included, count the undeformed thickness
    PlaneStress(PlateInput),
    /// Rings about the axis x = 0: x is the radius and y the axis. Forces, masses and energies are per full turn, pressures
    /// and tractions per area, and zz is the hoop direction. No node may have x < 0, and nodes on the axis keep ux = 0 without
    /// being told. A contact's length is the area of its full turn
    Axisymmetric,
}

/// A plate.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlateInput {
    /// Undeformed thickness, above 0 [L]
    pub thickness: f64,
}
