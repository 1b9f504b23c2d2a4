//! Bodies and point masses: materials on groups of the mesh.
//!
//! Initial stresses and temperatures are imposed on bodies.

use std::collections::BTreeMap;
use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::error::{Checked, ModelError, check_finite, check_not_negative, check_positive, check_size, refuse_if};
use super::friction::{check_profile, defined};
use super::groups;
use super::groups::{TIMES, group, kind, some_of};
use super::load_step::LoadStep;
use super::pore_flow;
use super::pore_pressure;
use crate::laws::bulk::{self, BodyLaw, Material, MaterialParameters, Sections, Surroundings};
use crate::mesh::{Group, Mesh, Section};
use crate::model::boundary::{Amplitude, Drive, Span};
use crate::model::element::{Formulation, SolidElement, consistent_mass};
use crate::model::imposed::{InitialStress, PoreFluid, PorePressure, Temperature, Thermal};
use crate::model::text::{distinct, number, vector};
use crate::model::{Body, Damping, Model, PointMass};

/// A body.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BodyInput {
    /// Bulk law
    #[schemars(with = "MaterialParameters")]
    pub material: BulkLaw,
    /// Element formulation
    #[serde(default)]
    pub element: Formulation,
    /// Damping of the body in dynamic steps; default: none
    #[serde(default)]
    pub damping: Damping,
    /// Stress of the undeformed body at the start; default: none
    pub initial_stress: Option<InitialStress>,
    /// Fluid in the pores, which is trapped in an undrained body, or flows; default: none
    pub pore_fluid: Option<PoreFluid>,
    /// Pressure given in the pores, by place and time; default: none
    pub pore_pressure: Option<PorePressure>,
    /// Thermal expansion; default: none
    pub thermal: Option<Thermal>,
}

/// Bulk law of a body, given by its parameters as in a case, or as an object from code.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(untagged, from = "MaterialParameters")]
pub enum BulkLaw {
    /// The parameters
    Parameters(MaterialParameters),
    /// The law itself
    #[serde(skip)]
    FromCode(Arc<dyn Material>),
}

impl From<MaterialParameters> for BulkLaw {
    fn from(parameters: MaterialParameters) -> Self {
        Self::Parameters(parameters)
    }
}

/// A point mass at every node of a group.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PointMassInput {
    /// Mass of each node, added to that of a body there [M]
    pub mass: f64,
    /// Initial velocity [x, y] of the nodes [L/T]
    pub velocity: Option<[f64; 2]>,
}

/// Builds the bodies, and the body number of each element.
pub fn bodies(given: &[(String, BodyInput)], mesh: &Mesh) -> Checked<(Vec<Body>, Vec<usize>)> {
    let mut bodies = Vec::new();
    let mut body_of_element = vec![usize::MAX; mesh.elements.len()];
    for (name, BodyInput { material, element, damping, initial_stress, pore_fluid, pore_pressure, thermal }) in given {
        let place = format!("bodies.{name}");
        let law = match material {
            BulkLaw::Parameters(parameters) => {
                parameters.build().map_err(|error| ModelError::new(format!("{place}.material"), error))?.into()
            }
            BulkLaw::FromCode(law) => law.clone(),
        };
        let group = group(mesh, name, &place)?;
        let Group::Elements(elements) = group else {
            let message = format!("`{name}` is a group of {}, not of solid elements", kind(group));
            return Err(ModelError::new(place, message));
        };
        let law = at_initial_pressure(law, initial_stress.as_ref(), &mesh.nodes_of(group), mesh);
        check_imposed(&*law, initial_stress.is_some(), *thermal, &place)?;
        if let Some(fluid) = pore_fluid {
            check_fluid(&*law, fluid, &mesh.nodes_of(group), mesh, &format!("{place}.pore_fluid"))?;
            pore_flow::check_fluid(&*law, fluid, *element, &place)?;
        }
        let mut pore_pressure = pore_pressure.clone();
        if let Some(given) = &mut pore_pressure {
            let place = format!("{place}.pore_pressure");
            let message =
                "is given in addition to a pore_fluid, which has a pressure of its own: leave one of them out";
            refuse_if(pore_fluid.is_some(), &place, message)?;
            *given = pore_pressure::checked(&*law, given, &mesh.nodes_of(group), mesh, &place)?;
        }
        check_section(&*law, *element == Formulation::FBar, mesh.section, &place)?;
        let fluid = pore_fluid.as_ref();
        let surroundings = Surroundings {
            stressed: initial_stress.is_some(),
            expansion: thermal.map(|thermal| thermal.expansion),
            fluid: fluid
                .filter(|fluid| !fluid.flows())
                .map(|fluid| bulk::PoreFluid { modulus: fluid.modulus(), cavitation: fluid.cavitation }),
            biot: (pore_pressure.as_ref().map(|given| given.biot))
                .or(fluid.filter(|fluid| fluid.flows()).map(PoreFluid::coefficient)),
            plate: mesh.section.is_plate() && law.description().sections != Sections::Plate,
        };
        // A law that nothing but its water makes remember answers as a dry one, and the pressure is added to it (`equations/wet_elements.rs`).
        let own = law.description();
        let is_alone = !surroundings.stressed && surroundings.expansion.is_none() && !surroundings.plate;
        let is_elastic = is_alone && own.variables.is_empty() && own.is_symmetric;
        let flows = fluid.is_some_and(PoreFluid::flows);
        let skeleton = (flows && is_elastic).then(|| law.clone());
        let material = BodyLaw::around(law, surroundings)
            .ok_or_else(|| ModelError::new(format!("{place}.material"), NEEDS_STRETCH))?;
        check_size(&format!("{place}.material"), "the stiffness lambda + 2 G", material.description().p_wave_modulus)?;
        check_damping(*damping, &*material, &format!("{place}.damping"))?;
        elements.iter().for_each(|&element| body_of_element[element] = bodies.len());
        let (elements, nodes) = (elements.clone(), mesh.nodes_of(group));
        if let Some(stress) = initial_stress {
            let place = format!("{place}.initial_stress");
            check_stress(stress, &nodes, mesh, &place)?;
            check_stiffness(stress, &*material, &nodes, mesh, &place)?;
        }
        bodies.push(Body {
            name: name.clone(),
            material,
            skeleton,
            damping: *damping,
            initial_stress: initial_stress.clone(),
            pore_fluid: pore_fluid.clone(),
            starts_pressed: pore_pressure
                .as_ref()
                .is_some_and(|given| pore_pressure::acts_at_start(given, &nodes, mesh))
                || pore_flow::acts_at_start(fluid, &nodes, mesh),
            pore_pressure,
            thermal: *thermal,
            elements,
            nodes,
        });
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

/// Checks damping parameters.
pub fn check_damping(damping: Damping, material: &dyn Material, place: &str) -> Checked<()> {
    let Damping { mass, retardation } = damping;
    check_not_negative(&format!("{place}.mass"), mass)?;
    check_not_negative(&format!("{place}.stiffness"), retardation)?;
    let message = "has no effect on a body without mass: give material.density, or damp by stiffness";
    refuse_if(mass > 0.0 && material.description().density == 0.0, format!("{place}.mass"), message)?;
    Ok(())
}

/// Builds the integration geometry of every element.
pub fn solids(mesh: &Mesh, given: &[(String, BodyInput)], body_of_element: &[usize]) -> Checked<Vec<SolidElement>> {
    let mut solids = Vec::with_capacity(mesh.elements.len());
    for (e, (element, &body)) in mesh.elements.iter().zip(body_of_element).enumerate() {
        let positions = mesh.places(e);
        let (name, body) = &given[body];
        let complain = |error| ModelError::new(format!("bodies.{name}.element"), error);
        solids.push(SolidElement::new(element.kind, body.element, mesh.section, &positions).map_err(complain)?);
        consistent_mass(element.kind, mesh.section, &positions, 1.0).map_err(complain)?;
    }
    Ok(solids)
}

/// Builds the point masses.
pub fn point_masses(given: &[(String, PointMassInput)], mesh: &Mesh) -> Checked<Vec<PointMass>> {
    let point_mass = |(name, PointMassInput { mass, .. }): &(String, PointMassInput)| {
        let place = format!("point_masses.{name}");
        let group = group(mesh, name, &place)?;
        check_positive(&format!("{place}.mass"), *mass, " (leave the group out for none)")?;
        check_size(&place, "mass", *mass)?;
        Ok(PointMass { name: name.clone(), mass: *mass, nodes: mesh.nodes_of(group) })
    };
    given.iter().map(point_mass).collect()
}

/// Tolerance by which a body may extend above the ground surface, relative to its depth: positions are rounded.
const ROUNDED: f64 = 1e-9;

/// Returns the law with the moduli that it has under the mean pressure of the initial stress of its body, over the nodes.
fn at_initial_pressure(
    law: Arc<dyn Material>,
    stress: Option<&InitialStress>,
    nodes: &[usize],
    mesh: &Mesh,
) -> Arc<dyn Material> {
    let Some(stress) = stress else { return law };
    let pressure = |&node: &usize| {
        let [xx, yy, _, zz] = stress.at(mesh.nodes[node], mesh.section.is_plate());
        -(xx + yy + zz) / 3.0
    };
    let mean = nodes.iter().map(pressure).sum::<f64>() / nodes.len().max(1) as f64;
    if mean.is_finite() { law.at_pressure(mean).unwrap_or(law) } else { law }
}

/// Checks the fluid in the pores of a body.
fn check_fluid(law: &dyn Material, fluid: &PoreFluid, nodes: &[usize], mesh: &Mesh, place: &str) -> Checked<()> {
    let PoreFluid { bulk_modulus, porosity, pressure, cavitation, .. } = fluid;
    check_positive(&format!("{place}.bulk_modulus"), *bulk_modulus, " (2.2e9 Pa of water)")?;
    let message = format!("is {porosity}: it must be above 0 and below 1, e/(1 + e) of a void ratio e");
    refuse_if(!(*porosity > 0.0 && *porosity < 1.0), format!("{place}.porosity"), message)?;
    check_size(place, "the stiffness bulk_modulus/porosity", fluid.modulus())?;
    let message = "is not for plane stress: a fluid leaves a plate through its faces; take plane strain";
    refuse_if(mesh.section.is_plate(), place, message)?;
    check_profile(pressure, &format!("{place}.pressure"))?;
    if let Some(least) = cavitation {
        check_finite(&format!("{place}.cavitation"), [*least])?;
    }
    for &node in nodes {
        let (at, place) = (mesh.nodes[node], format!("{place}.pressure"));
        let value = defined(pressure, at, &place)?;
        if cavitation.is_some_and(|least| value < least) {
            let message = format!("is {value} at {}, below cavitation: raise one or lower the other", vector(at));
            return Err(ModelError::new(place, message));
        }
    }
    let message = "is not for the material linear: take hencky, or leave it out";
    let follows = cavitation.is_some() && !fluid.flows();
    refuse_if(law.description().is_linear && follows, format!("{place}.cavitation"), message)?;
    refuse_if(!law.description().sections.any_stretch(), place, NEEDS_STRETCH)
}

/// Checks that a law serves in a section.
fn check_section(law: &dyn Material, f_bar: bool, section: Section, place: &str) -> Checked<()> {
    let (served, material) = (law.description().sections, format!("{place}.material"));
    match section {
        Section::PlaneStress { .. } => {
            let message = "f_bar is not needed in plane stress, where the thickness is free to change and elements do not lock for \
                           nu near 1/2: leave it out";
            refuse_if(f_bar, format!("{place}.element"), message)?;
            let message = "does not support plane stress: take another law, or plane strain";
            refuse_if(!matches!(served, Sections::Plate | Sections::All), material, message)
        }
        Section::Axisymmetric => {
            let message = "does not support the hoop stretch of axisymmetric bodies: take another law";
            refuse_if(!served.any_stretch(), material, message)
        }
        Section::PlaneStrain | Section::Graded { .. } => {
            refuse_if(served == Sections::Plate, material, "is a law of plates: take plane stress")
        }
    }
}

/// What is added to the deformation of a law must have an out-of-plane part.
const NEEDS_STRETCH: &str = "needs a law with an out-of-plane stretch: take another material, or leave it out";

/// Checks what is imposed on a body: an initial stress and thermal expansion.
fn check_imposed(law: &dyn Material, stressed: bool, thermal: Option<Thermal>, place: &str) -> Checked<()> {
    if let Some(Thermal { expansion, reference }) = thermal {
        check_finite(&format!("{place}.thermal.expansion"), [expansion])?;
        check_finite(&format!("{place}.thermal.reference"), [reference])?;
    }
    let own = law.description();
    let adjacent = stressed && !own.holds_initial_stress;
    let key = if adjacent { "initial_stress" } else { "thermal" };
    let alone = !own.sections.any_stretch() && (adjacent || thermal.is_some());
    refuse_if(alone, format!("{place}.{key}"), NEEDS_STRETCH)
}

/// Checks an initial stress: finite throughout the body, ground below its surface, and no out-of-plane stress in plane stress.
pub fn check_stress(stress: &InitialStress, nodes: &[usize], mesh: &Mesh, place: &str) -> Checked<()> {
    match stress {
        InitialStress::Geostatic { surface, weight, k0, surcharge, below } => {
            for (key, value) in [("surface", surface), ("weight", weight), ("K0", k0), ("surcharge", surcharge)] {
                check_finite(&format!("{place}.geostatic.{key}"), [*value])?;
            }
            let along_y = ", the density times gravity that acts along -y";
            check_positive(&format!("{place}.geostatic.weight"), *weight, along_y)?;
            check_not_negative(&format!("{place}.geostatic.K0"), *k0)?;
            check_not_negative(&format!("{place}.geostatic.surcharge"), *surcharge)?;
            let mut above = *surface;
            for (k, layer) in below.iter().enumerate() {
                let place = format!("{place}.geostatic.below[{k}]");
                let message = format!(
                    "is {}: layers follow each other downwards, and the one above begins at {above}",
                    layer.top
                );
                refuse_if(layer.top >= above || layer.top.is_nan(), format!("{place}.top"), message)?;
                check_positive(&format!("{place}.weight"), layer.weight, along_y)?;
                check_not_negative(&format!("{place}.K0"), layer.k0)?;
                above = layer.top;
            }
            let top = nodes.iter().map(|&node| mesh.nodes[node].y).fold(f64::NEG_INFINITY, f64::max);
            let [level, reached] = distinct([*surface, top]);
            let message = format!(
                "is {level}, and the body reaches up to y = {reached}: ground lies below its surface, so give the level of its \
                 top or above"
            );
            refuse_if(
                top > surface + ROUNDED * mesh.size_of(nodes.iter().copied()),
                format!("{place}.geostatic.surface"),
                message,
            )
        }
        InitialStress::Components { xx, yy, xy, zz } => {
            let message = "is missing: give the out-of-plane stress as well, 0 if there is none";
            refuse_if(zz.is_none() && !mesh.section.is_plate(), format!("{place}.components.zz"), message)?;
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

/// Checks that the initial stress is below the shear modulus: otherwise a large-strain law has no positive stiffness; in most
/// cases the units differ.
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
    let shear = material.description().shear_modulus;
    let found = nodes.iter().map(largest).max_by(|a, b| a.0.total_cmp(&b.0));
    let Some((largest, node)) = found.filter(|(largest, _)| !material.description().is_linear && *largest >= shear)
    else {
        return Ok(());
    };
    let ([largest, shear], at) = ([largest, shear].map(number), vector(mesh.nodes[node]));
    let message = format!(
        "reaches {largest} at {at}, and the shear modulus is {shear}: too much for a body at rest; check the \
         units, or take material linear, which superposes stresses without limit"
    );
    Err(ModelError::new(place, message))
}

/// Sets prescribed temperatures of bodies from the start of a step on.
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
        let number = groups::body(model, name, &place)?;
        let Some(thermal) = model.bodies[number].thermal else {
            let message = format!("has no effect on a body that does not expand: give bodies.{name}.thermal");
            return Err(ModelError::new(place, message));
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

/// Checks that a temperature is finite throughout the step and does not shrink the body to zero size.
fn check_expansion(amplitude: &Amplitude, body: usize, thermal: Thermal, place: &str, model: &Model) -> Checked<()> {
    let places = model.bodies[body].nodes.iter().map(|&node| model.mesh.nodes[node]).collect();
    for at in some_of(places) {
        for time in amplitude.span.times(TIMES).skip(1) {
            let value = amplitude.value(at, time);
            let stretch = 1.0 + thermal.expansion * (value - thermal.reference);
            if !value.is_finite() || stretch <= 0.0 {
                let ([value, time], at) = ([value, time].map(number), vector(at));
                let cause = if stretch <= 0.0 { ", at which the body has no volume left" } else { "" };
                let message =
                    format!("is {value} at t = {time}, (x, y) = {at}{cause}: check temperature and expansion");
                return Err(ModelError::new(place, message));
            }
        }
    }
    Ok(())
}

/// Prescribed temperatures of bodies.
pub fn prescribed_temperatures(temperatures: &BTreeMap<usize, Amplitude>) -> Vec<Temperature> {
    temperatures.iter().map(|(&body, amplitude)| Temperature { body, amplitude: amplitude.clone() }).collect()
}
