//! Bodies and point masses: materials on groups of the mesh.
//!
//! What is imposed on bodies: their initial stress, and their temperatures.

use std::collections::BTreeMap;

use nalgebra::Vector2;

use super::error::{Checked, ModelError, check_finite, check_not_negative, check_size};
use super::friction::{check_profile, defined};
use super::groups::{group, kind};
use super::load_step::LoadStep;
use super::section;
use crate::laws::bulk::{Imposed, Material};
use crate::mesh::{Group, Mesh};
use crate::model::boundary::{Amplitude, Drive, Span};
use crate::model::element::{SolidElement, consistent_mass};
use crate::model::imposed::{InitialStress, Temperature, Thermal};
use crate::model::text::number;
use crate::model::{Body, Damping, Model, PointMass};

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
        let material = with_imposed(material, initial_stress.as_ref(), thermal, &place)?;
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
            check_stress(stress, &nodes, mesh, &place)?;
            check_stiffness(stress, &*material, &nodes, mesh, &place)?;
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

/// Share of the depth by which a body may reach above the surface of the ground: positions are rounded.
const ROUNDED: f64 = 1e-9;

/// Times of a step, evenly spaced, at which a temperature is looked at.
const TIMES: u32 = 100;

/// The most nodes of a body at which it is.
const PLACES: usize = 50;

/// The law of a body under what is imposed on it.
pub fn with_imposed(
    given: Box<dyn Material>,
    stress: Option<&InitialStress>,
    thermal: Option<Thermal>,
    place: &str,
) -> Checked<Box<dyn Material>> {
    if let Some(Thermal { expansion, reference }) = thermal {
        check_finite(&format!("{place}.thermal.expansion"), [expansion])?;
        check_finite(&format!("{place}.thermal.reference"), [reference])?;
    }
    if stress.is_none() && thermal.is_none() {
        return Ok(given);
    }
    match Imposed::new(given, stress.is_some(), thermal.map(|thermal| thermal.expansion)) {
        Some(imposed) => Ok(Box::new(imposed)),
        None => {
            let key = if stress.is_some() { "initial_stress" } else { "thermal" };
            let message = "needs a law with an out-of-plane stretch: take another material, or leave it out";
            Err(ModelError::new(format!("{place}.{key}"), message))
        }
    }
}

/// An initial stress must have a value all over the body, the ground lies below its surface, and a plate has no stress across it.
pub fn check_stress(stress: &InitialStress, nodes: &[usize], mesh: &Mesh, place: &str) -> Checked<()> {
    let refused = |key: &str, message: String| Err(ModelError::new(format!("{place}.{key}"), message));
    match stress {
        InitialStress::Geostatic { surface, weight, k0 } => {
            for (key, value) in [("surface", surface), ("weight", weight), ("K0", k0)] {
                check_finite(&format!("{place}.geostatic.{key}"), [*value])?;
            }
            if *weight <= 0.0 {
                let message = format!("is {weight}: must be positive, the density times gravity that acts along -y");
                return refused("geostatic.weight", message);
            }
            if *k0 < 0.0 {
                return refused("geostatic.K0", format!("is {k0}: must be zero or positive"));
            }
            let top = nodes.iter().map(|&node| mesh.nodes[node].y).fold(f64::NEG_INFINITY, f64::max);
            if top > surface + ROUNDED * mesh.diagonal() {
                let message = format!(
                    "is {}, and the body reaches up to y = {}: ground lies below its surface, so give the level of its top or \
                     above",
                    number(*surface),
                    number(top)
                );
                return refused("geostatic.surface", message);
            }
            Ok(())
        }
        InitialStress::Components { xx, yy, xy, zz } => {
            if zz.is_none() && !mesh.section.is_plate() {
                return refused(
                    "components.zz",
                    "is missing: give the out-of-plane stress as well, 0 if there is none".into(),
                );
            }
            let given = [("xx", xx), ("yy", yy), ("xy", xy)].into_iter().chain(zz.as_ref().map(|zz| ("zz", zz)));
            for (key, profile) in given {
                let place = format!("{place}.components.{key}");
                check_profile(profile, &place)?;
                for &node in nodes {
                    let value = defined(profile, mesh.nodes[node], &place)?;
                    if key == "zz" && value != 0.0 && mesh.section.is_plate() {
                        let message = format!("is {value}: plane stress has no out-of-plane stress, so leave it out");
                        return Err(ModelError::new(place, message));
                    }
                }
            }
            Ok(())
        }
    }
}

/// A stress beyond the shear modulus leaves no stiffness that a law of large strains could rest on; most often it has other units.
pub fn check_stiffness(
    stress: &InitialStress,
    material: &dyn Material,
    nodes: &[usize],
    mesh: &Mesh,
    place: &str,
) -> Checked<()> {
    let largest = |&node: &usize| {
        let components = stress.at(mesh.nodes[node], mesh.section.is_plate());
        (components.into_iter().fold(0.0, |most: f64, component| most.max(component.abs())), node)
    };
    let shear = material.shear_modulus();
    let found = nodes.iter().map(largest).max_by(|a, b| a.0.total_cmp(&b.0));
    let Some((largest, node)) = found.filter(|(largest, _)| !material.is_linear() && *largest >= shear) else {
        return Ok(());
    };
    let [largest, shear, x, y] = [largest, shear, mesh.nodes[node].x, mesh.nodes[node].y].map(number);
    let message = format!(
        "reaches {largest} at ({x}, {y}), and the shear modulus is {shear}: too much for a body at rest; check the \
         units, or take material linear, which superposes stresses without limit"
    );
    Err(ModelError::new(place, message))
}

/// Give bodies temperatures from the start of a step on.
pub fn temperatures(
    in_force: &mut BTreeMap<usize, Amplitude>,
    given: &LoadStep,
    place: &str,
    span: Span,
    model: &Model,
) -> Checked<()> {
    for (name, temperature) in &given.temperature {
        let drive = Drive::from(temperature);
        let place = format!("{place}.temperature.{name}");
        let refused = |message: String| Err(ModelError::new(place.clone(), message));
        let Some(number) = model.bodies.iter().position(|body| body.name == *name) else {
            let known: Vec<&str> = model.bodies.iter().map(|body| body.name.as_str()).collect();
            return refused(format!("there is no body `{name}`; the bodies are {}", known.join(", ")));
        };
        let Some(thermal) = model.bodies[number].thermal else {
            return refused(format!("has no effect on a body that does not expand: give bodies.{name}.thermal"));
        };
        drive.check().map_err(|message| ModelError::new(&place, message))?;
        let at_rest = || Amplitude { drive: Drive::Table(vec![[0.0, thermal.reference]]), span, before: None };
        let before = in_force.remove(&number).unwrap_or_else(at_rest);
        let amplitude = Amplitude { drive, span, before: Some(Box::new(before)) };
        check_expansion(&amplitude, number, thermal, &place, model)?;
        in_force.insert(number, amplitude);
    }
    Ok(())
}

/// A temperature must have a value throughout the step, at which the body does not shrink to nothing.
fn check_expansion(amplitude: &Amplitude, body: usize, thermal: Thermal, place: &str, model: &Model) -> Checked<()> {
    let (nodes, Span { start, end }) = (&model.bodies[body].nodes, amplitude.span);
    let step = nodes.len().div_ceil(PLACES).max(1);
    for at in nodes.iter().step_by(step).map(|&node| model.mesh.nodes[node]) {
        for time in (1..=TIMES).map(|k| start + f64::from(k) / f64::from(TIMES) * (end - start)) {
            let value = amplitude.value(at, time);
            let stretch = 1.0 + thermal.expansion * (value - thermal.reference);
            if !value.is_finite() || stretch <= 0.0 {
                let [value, time, x, y] = [value, time, at.x, at.y].map(number);
                let cause = if stretch <= 0.0 { ", at which the body has no volume left" } else { "" };
                let message =
                    format!("is {value} at t = {time}, (x, y) = ({x}, {y}){cause}: check temperature and expansion");
                return Err(ModelError::new(place, message));
            }
        }
    }
    Ok(())
}

/// Temperatures of the bodies that have been given one.
pub fn in_force(temperatures: &BTreeMap<usize, Amplitude>) -> Vec<Temperature> {
    temperatures.iter().map(|(&body, amplitude)| Temperature { body, amplitude: amplitude.clone() }).collect()
}
