//! Radiation damping: what inertia would do to slip, in motions that leave it out.
//!
//! ```text
//! τ = τ_static − Z₁ v₁ = τ_static − Z₂ v₂,   v₁ + v₂ = v     plane shear waves leave on both sides,    Z = ρ c_s = G/c_s     (1)
//! τ = τ_static − η v,   1/η = 1/Z₁ + 1/Z₂                     v₁ and v₂ eliminated; alike: η = G/(2 c_s)                   (2)
//! ```
//! A side that slips away with v₁ sends off a wave that changes the traction by Z₁ v₁; both sides see the same traction, so
//! that the slip rate is shared between them as between dashpots in series. A rigid master takes no share: η = Z of the slave.
//!
//! Source: Rice (1993), J. Geophys. Res. 98, 9885.

use super::contact::{Contact, MasterSide, Radiation};
use super::error::{Checked, ModelError};
use super::groups::edges;
use super::limits::check_size;
use crate::mesh::Edge;
use crate::model::Model;

/// η of a contact, 0 for none.
pub fn radiation(place: &str, contact: &Contact, model: &Model) -> Checked<f64> {
    let at = format!("{place}.radiation_damping");
    let damping = match contact.radiation {
        None => return Ok(0.0),
        Some(Radiation::Given(damping)) => damping,
        Some(Radiation::OfBodies) => of_bodies(place, &at, contact, model)?,
    };
    if !(damping > 0.0 && damping.is_finite()) {
        return Err(ModelError::new(at, format!("is {damping}: must be positive (leave it out for none)")));
    }
    check_size(place, "radiation_damping", damping)?;
    Ok(damping)
}

/// η of (2); on each side the mean over its edges.
fn of_bodies(place: &str, at: &str, contact: &Contact, model: &Model) -> Checked<f64> {
    if contact.area.is_some() {
        let message = "has no default for a slave group of points, behind which there is no body: give a number";
        return Err(ModelError::new(at, message));
    }
    let impedance = |edge: &Edge| {
        let body = &model.bodies[model.body_of_element[edge.element]];
        let (density, modulus) = (body.material.density(), body.material.shear_modulus());
        if density > 0.0 {
            return Ok((density * modulus).sqrt());
        }
        let message =
            format!("needs the density of body `{}`, which is {density}: give it, or a number here", body.name);
        Err(ModelError::new(at, message))
    };
    let side = |name: &str, key: &str| -> Checked<f64> {
        let edges = edges(&model.mesh, name, &format!("{place}.{key}"))?;
        let all = edges.iter().map(impedance).collect::<Checked<Vec<f64>>>()?;
        Ok(all.iter().sum::<f64>() / all.len() as f64)
    };
    let slave = side(&contact.slave, "slave")?;
    let MasterSide::Group(master) = &contact.master else { return Ok(slave) };
    let master = side(master, "master")?;
    Ok(slave * master / (slave + master))
}
