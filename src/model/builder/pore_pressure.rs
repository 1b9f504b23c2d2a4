//! Checks of the pressures given in the pores of bodies, and what contacts take from them.

use std::collections::BTreeSet;

use super::error::{Checked, ModelError, refuse_if};
use super::fluid::of_table;
use super::friction;
use super::groups::TIMES;
use crate::contact::pair::Fluid;
use crate::laws::bulk::Material;
use crate::mesh::{Group, Mesh};
use crate::model::Model;
use crate::model::imposed::PorePressure;
use crate::model::measured::PoreField;
use crate::model::text::{number, vector};

/// Checks a pressure at the start, and its body; a table of nodes comes to know its columns.
pub fn checked(
    law: &dyn Material,
    given: &PorePressure,
    nodes: &[usize],
    mesh: &Mesh,
    place: &str,
) -> Checked<PorePressure> {
    let mut given = given.clone();
    let message = format!("is {}: it must be above 0 and at most 1, that of soil", given.biot);
    refuse_if(!(given.biot > 0.0 && given.biot <= 1.0), format!("{place}.biot"), message)?;
    let message = "needs a law with an out-of-plane stretch: take another material, or leave it out";
    refuse_if(!law.description().sections.any_stretch(), place, message)?;
    let place = format!("{place}.pressure");
    match &mut given.pressure {
        PoreField::Given(profile) => friction::check_in_time(profile, &place)?,
        PoreField::Measured(measured) => {
            measured.resolve(nodes, mesh).map_err(|message| ModelError::new(&place, message))?;
        }
    }
    nodes.iter().try_for_each(|&node| is_finite(&given, node, 0.0, mesh, &place))?;
    let message = "is not zero at t = 0: pressures at nodes count from the start, so give what they change by";
    refuse_if(given.pressure.nodal().is_some() && acts_at_start(&given, nodes, mesh), place, message)?;
    Ok(given)
}

/// Whether a pressure acts at the start, before anything moves.
pub fn acts_at_start(given: &PorePressure, nodes: &[usize], mesh: &Mesh) -> bool {
    nodes.iter().any(|&node| given.pressure.at_node(node, mesh, 0.0) != 0.0)
}

fn is_finite(given: &PorePressure, node: usize, time: f64, mesh: &Mesh, place: &str) -> Checked<()> {
    let value = given.pressure.at_node(node, mesh, time);
    let at = || vector(mesh.nodes[node]);
    let message = || format!("is {} at {} and t = {}: must be a finite number", number(value), at(), number(time));
    if value.is_finite() { Ok(()) } else { Err(ModelError::new(place, message())) }
}

/// Maximum number of values that are checked before the run.
const VALUES: usize = 2_000_000;

/// Checks pressures at evenly spaced times of the steps, as long as their times are certain.
pub fn check_in_time(model: &Model) -> Checked<()> {
    for body in &model.bodies {
        let Some(given) = body.pore_pressure.as_ref().filter(|given| given.pressure.depends_on_time()) else {
            continue;
        };
        let looks = (VALUES / (body.nodes.len().max(1) * model.steps.len().max(1))).clamp(1, TIMES as usize) as u32;
        let place = format!("bodies.{}.pore_pressure.pressure", body.name);
        for step in model.steps.iter().take_while(|step| step.until.is_none()) {
            for time in step.span.times(looks).skip(1) {
                body.nodes.iter().try_for_each(|&node| is_finite(given, node, time, &model.mesh, &place))?;
            }
        }
    }
    Ok(())
}

/// The fluid of a contact that takes its pressure from the one given in the pores of the slave's body; `None` if none is given there.
pub fn fluid_of_bodies(slave: &str, model: &Model, place: &str) -> Checked<Option<Fluid>> {
    let Some(Group::Edges(edges)) = model.mesh.groups.get(slave) else { return Ok(None) };
    let bodies: BTreeSet<usize> = edges.iter().map(|edge| model.body_of_element[edge.element]).collect();
    let given = |body: &usize| model.bodies[*body].pore_pressure.as_ref();
    let Some(given) = bodies.iter().find_map(given) else { return Ok(None) };
    let message = format!(
        "of bodies takes the pore_pressure of one body, and the slave `{slave}` lies on several: give the pressure here"
    );
    refuse_if(bodies.len() > 1, format!("{place}.fluid_pressure"), message)?;
    Ok(Some(match given.pressure.clone() {
        PoreField::Given(pressure) => Fluid::new(move |at, time| pressure.value_at(at, time)),
        PoreField::Measured(measured) => of_table(measured),
    }))
}
