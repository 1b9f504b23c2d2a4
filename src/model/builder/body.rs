//! Bodies and point masses: materials on groups of the mesh.

use nalgebra::Vector2;

use super::error::{Checked, ModelError};
use super::groups::{group, kind};
use super::limits::{check_not_negative, check_size};
use super::{imposed, section};
use crate::laws::bulk::Material;
use crate::mesh::{Group, Mesh};
use crate::model::element::{SolidElement, consistent_mass};
use crate::model::imposed::{InitialStress, Thermal};
use crate::model::{Body, Damping, PointMass};

/// A body as it is given.
pub struct GivenBody {
    /// name of its group
    pub name: String,
    /// bulk law
    pub material: Box<dyn Material>,
    /// mean dilatation (F-bar) instead of full integration
    pub f_bar: bool,
    /// damping in dynamic steps
    pub damping: Damping,
    /// stress at the start
    pub initial_stress: Option<InitialStress>,
    /// thermal expansion
    pub thermal: Option<Thermal>,
}

/// A point mass as it is given.
pub struct GivenMass {
    /// name of its group
    pub name: String,
    /// m of each node [M]
    pub mass: f64,
    /// initial velocity [L/T]
    pub velocity: Option<[f64; 2]>,
}

/// The bodies, and the number of that which each element belongs to.
pub fn bodies(given: Vec<GivenBody>, mesh: &Mesh) -> Checked<(Vec<Body>, Vec<usize>)> {
    let mut bodies = Vec::new();
    let mut body_of_element = vec![usize::MAX; mesh.elements.len()];
    for GivenBody { name, material, f_bar, damping, initial_stress, thermal } in given {
        let place = format!("bodies.{name}");
        let material = imposed::material(material, initial_stress.as_ref(), thermal, &place)?;
        let material = section::material(material, f_bar, mesh.section, &place)?;
        let group = group(mesh, &name, &place)?;
        let Group::Elements(elements) = group else {
            let message = format!("`{name}` is a group of {}, not of solid elements", kind(group));
            return Err(ModelError::new(place, message));
        };
        check_size(&format!("{place}.material"), "the stiffness lambda + 2 G", material.p_wave_modulus())?;
        check_damping(damping, &*material, &format!("{place}.damping"))?;
        elements.iter().for_each(|&element| body_of_element[element] = bodies.len());
        let (elements, nodes) = (elements.clone(), mesh.nodes_of(group));
        if let Some(stress) = &initial_stress {
            let place = format!("{place}.initial_stress");
            imposed::check_stress(stress, &nodes, mesh, &place)?;
            imposed::check_stiffness(stress, &*material, &nodes, mesh, &place)?;
        }
        bodies.push(Body { name, material, damping, initial_stress, thermal, elements, nodes });
    }
    match body_of_element.iter().position(|&body| body == usize::MAX) {
        Some(element) => {
            let name = mesh.body_of(element).unwrap_or("?");
            Err(ModelError::new(
                "bodies",
                format!("`{name}` of the mesh has no material: add \"{name}\": {{\"material\": …}}"),
            ))
        }
        None => Ok((bodies, body_of_element)),
    }
}

/// Damping that makes sense.
pub fn check_damping(damping: Damping, material: &dyn Material, place: &str) -> Checked<()> {
    let Damping { mass, retardation } = damping;
    check_not_negative(&format!("{place}.mass"), mass)?;
    check_not_negative(&format!("{place}.stiffness"), retardation)?;
    if mass > 0.0 && material.density() == 0.0 {
        let message = "has no effect on a body without mass: give material.density, or damp by stiffness";
        return Err(ModelError::new(format!("{place}.mass"), message));
    }
    Ok(())
}

/// Integration geometry of every element; `f_bar` says which bodies take the mean dilatation.
pub fn solids(mesh: &Mesh, bodies: &[Body], body_of_element: &[usize], f_bar: &[bool]) -> Checked<Vec<SolidElement>> {
    let mut solids = Vec::with_capacity(mesh.elements.len());
    for (element, &body) in mesh.elements.iter().zip(body_of_element) {
        let positions: Vec<Vector2<f64>> = element.nodes.iter().map(|&node| mesh.nodes[node]).collect();
        let complain = |error| ModelError::new(format!("bodies.{}.element", bodies[body].name), error);
        solids.push(SolidElement::new(element.kind, f_bar[body], mesh.section, &positions).map_err(complain)?);
        consistent_mass(element.kind, mesh.section, &positions, 1.0).map_err(complain)?;
    }
    Ok(solids)
}

/// The point masses.
pub fn point_masses(given: &[GivenMass], mesh: &Mesh) -> Checked<Vec<PointMass>> {
    let point_mass = |GivenMass { name, mass, .. }: &GivenMass| {
        let place = format!("point_masses.{name}");
        let group = group(mesh, name, &place)?;
        if *mass <= 0.0 {
            let message = format!("is {mass}: must be positive (leave the group out for none)");
            return Err(ModelError::new(format!("{place}.mass"), message));
        }
        check_size(&place, "mass", *mass)?;
        Ok(PointMass { name: name.clone(), mass: *mass, nodes: mesh.nodes_of(group) })
    };
    given.iter().map(point_mass).collect()
}
