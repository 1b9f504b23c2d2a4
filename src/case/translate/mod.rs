//! From the case as written to the builder of the model.

mod contact;
mod drive;
mod step;

pub use drive::drive;

use super::error::{Checked, Complaint};
use super::file::{Case, DampingInput, Formulation, NewtonInput};
use crate::mesh::Mesh;
use crate::model::builder::Builder;
use crate::model::{Damping, Model, NewtonSettings};

/// The builder of a case on its mesh.
pub fn model(case: &Case, mesh: Mesh) -> Checked<Builder> {
    let NewtonInput { tolerance, max_iterations } = case.newton;
    let mut builder = Model::builder(mesh).title(&case.title).newton(NewtonSettings { tolerance, max_iterations });
    for (name, body) in &case.bodies {
        let complain = |error| Complaint::new(format!("bodies.{name}.material"), error);
        let DampingInput { mass, stiffness } = body.damping;
        builder = builder.body(name, body.material.build().map_err(complain)?);
        builder = builder.damping(name, Damping { mass, retardation: stiffness });
        if body.element == Formulation::FBar {
            builder = builder.f_bar(name);
        }
    }
    for (name, point) in &case.point_masses {
        builder = match point.velocity {
            Some(velocity) => builder.moving_point_mass(name, point.mass, velocity),
            None => builder.point_mass(name, point.mass),
        };
    }
    builder = case.periodic.iter().fold(builder, |builder, [side, other]| builder.periodic(side, other));
    for (name, input) in &case.contacts {
        builder = builder.contact(contact::contact(name, input)?);
    }
    for (name, velocity) in &case.initial_velocity {
        builder = builder.initial_velocity(name, *velocity);
    }
    for (k, input) in case.steps.iter().enumerate() {
        builder = builder.step(step::step(&format!("steps[{k}]"), input)?);
    }
    builder = case.watch.iter().fold(builder, |builder, group| builder.watch(group));
    Ok(match case.output.interval {
        Some(interval) => builder.interval(interval),
        None => builder,
    })
}
