//! From the case as written to the builder of the model.

mod blocks;

pub use blocks::blocks;

use super::error::{Checked, Complaint};
use super::file::{BodyInput, Case, Formulation, LoadingPlateInput};
use super::labels;
use crate::mesh::Mesh;
use crate::mesh::section::Section;
use crate::model::Model;
use crate::model::builder::{Builder, Contact, Gauge};

/// The builder of a case on its mesh.
pub fn model(case: &Case, mesh: Mesh) -> Checked<Builder> {
    let section = if case.section == Section::PlaneStrain { mesh.section } else { case.section };
    labels::check(&case.title, &case.units)?;
    let mut builder = Model::builder(mesh).title(&case.title).section(section);
    builder = builder.newton(case.newton);
    for (name, given) in &case.bodies {
        builder = body(builder, name, given)?;
    }
    for (name, point) in &case.point_masses {
        builder = match point.velocity {
            Some(velocity) => builder.moving_point_mass(name, point.mass, velocity),
            None => builder.point_mass(name, point.mass),
        };
    }
    builder = case.periodic.iter().fold(builder, |builder, [side, other]| builder.periodic(side, other));
    for (group, moves) in case.plates.iter().map(LoadingPlateInput::parts) {
        builder = builder.plate_moving(group, moves);
    }
    for (name, contact) in &case.contacts {
        builder = builder.contact(Contact { name: name.clone(), ..contact.clone() });
    }
    for (name, velocity) in &case.initial_velocity {
        builder = builder.initial_velocity(name, *velocity);
    }
    builder = case.steps.iter().cloned().fold(builder, Builder::step);
    builder = case.watch.iter().fold(builder, |builder, group| builder.watch(group));
    for (name, gauge) in &case.probes {
        builder = builder.probe(Gauge { name: name.clone(), ..gauge.clone() });
    }
    builder = builder.times(case.output.times.clone());
    Ok(match case.output.interval {
        Some(interval) => builder.interval(interval),
        None => builder,
    })
}

fn body(mut builder: Builder, name: &str, given: &BodyInput) -> Checked<Builder> {
    let complain = |error| Complaint::new(format!("bodies.{name}.material"), error);
    builder = builder.body(name, given.material.build().map_err(complain)?);
    builder = builder.damping(name, given.damping);
    if given.element == Formulation::FBar {
        builder = builder.f_bar(name);
    }
    if let Some(stress) = &given.initial_stress {
        builder = builder.initial_stress(name, stress.clone());
    }
    Ok(match given.thermal {
        Some(thermal) => builder.thermal(name, thermal),
        None => builder,
    })
}
