//! Checks of the pressures given in the pores of bodies, and what contacts take from them.

use std::collections::BTreeSet;

use super::error::{Checked, ModelError, refuse_if};
use super::friction;
use super::groups::TIMES;
use crate::contact::pair::Fluid;
use crate::laws::bulk::Material;
use crate::mesh::{Group, Mesh};
use crate::model::Model;
use crate::model::imposed::PorePressure;
use crate::model::text::{number, vector};

/// Checks a pressure at the start, and its body.
pub fn check(law: &dyn Material, given: &PorePressure, nodes: &[usize], mesh: &Mesh, place: &str) -> Checked<()> {
    let PorePressure { pressure, biot } = given;
    let message = format!("is {biot}: it must be above 0 and at most 1, that of soil");
    refuse_if(!(*biot > 0.0 && *biot <= 1.0), format!("{place}.biot"), message)?;
    let message = "needs a law with an out-of-plane stretch: take another material, or leave it out";
    refuse_if(!law.description().sections.any_stretch(), place, message)?;
    let place = format!("{place}.pressure");
    friction::check_in_time(pressure, &place)?;
    nodes.iter().try_for_each(|&node| is_finite(given, node, 0.0, mesh, &place))
}

/// Whether a pressure acts at the start, before anything moves.
pub fn acts_at_start(given: &PorePressure, nodes: &[usize], mesh: &Mesh) -> bool {
    nodes.iter().any(|&node| given.pressure.value(mesh.nodes[node]) != 0.0)
}

fn is_finite(given: &PorePressure, node: usize, time: f64, mesh: &Mesh, place: &str) -> Checked<()> {
    let at = mesh.nodes[node];
    let value = given.pressure.value_at(at, time);
    let message =
        || format!("is {} at {} and t = {}: must be a finite number", number(value), vector(at), number(time));
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
    let Some(pressure) = bodies.iter().find_map(given) else { return Ok(None) };
    let message = format!(
        "of bodies takes the pore_pressure of one body, and the slave `{slave}` lies on several: give the pressure here"
    );
    refuse_if(bodies.len() > 1, format!("{place}.fluid_pressure"), message)?;
    let pressure = pressure.pressure.clone();
    Ok(Some(Fluid::new(move |at, time| pressure.value_at(at, time))))
}
