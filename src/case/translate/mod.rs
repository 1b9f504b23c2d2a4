//! From the case as written to the builder of the model.

mod blocks;

pub use blocks::blocks;

use super::error::{Checked, Complaint};
use super::file::{
    BodyInput, Case, Formulation, LoadingPlateInput, NewtonInput, PlateInput, PlateMotion, ProbeInput, SectionInput,
};
use super::labels;
use crate::mesh::Mesh;
use crate::mesh::section::Section;
use crate::model::builder::{Builder, Contact, Gauge, Plate};
use crate::model::{Model, NewtonSettings};

fn plate(moves: PlateMotion) -> Plate {
    match moves {
        PlateMotion::AsOne => Plate::AsOne,
        PlateMotion::UxAlike => Plate::UxAlike,
        PlateMotion::UyAlike => Plate::UyAlike,
        PlateMotion::Rigid => Plate::Rigid,
    }
}

/// The builder of a case on its mesh.
pub fn model(case: &Case, mesh: Mesh) -> Checked<Builder> {
    let NewtonInput { tolerance, max_iterations } = case.newton;
    let section = match case.section {
        SectionInput::PlaneStrain => mesh.section,
        SectionInput::PlaneStress(PlateInput { thickness }) => Section::PlaneStress { thickness },
        SectionInput::Axisymmetric => Section::Axisymmetric,
    };
    labels::check(&case.title, &case.units)?;
    let mut builder = Model::builder(mesh).title(&case.title).section(section);
    builder = builder.newton(NewtonSettings { tolerance, max_iterations });
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
        builder = builder.plate_that(group, plate(moves));
    }
    for (name, contact) in &case.contacts {
        builder = builder.contact(Contact { name: name.clone(), ..contact.clone() });
    }
    for (name, velocity) in &case.initial_velocity {
        builder = builder.initial_velocity(name, *velocity);
    }
    builder = case.steps.iter().cloned().fold(builder, Builder::step);
    builder = case.watch.iter().fold(builder, |builder, group| builder.watch(group));
    for (name, input) in &case.probes {
        builder = builder.probe(gauge(name, input)?);
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

fn gauge(name: &str, input: &ProbeInput) -> Checked<Gauge> {
    let gauge = match (input.at, input.from, input.to, input.number) {
        (Some(at), None, None, None) => Gauge::at(name, at),
        (None, Some(from), Some(to), Some(number)) => Gauge::line(name, from, to, number),
        _ => {
            let message = "give `at` for a point, or `from`, `to` and `number` for a line of points";
            return Err(Complaint::new(format!("probes.{name}"), message));
        }
    };
    Ok(match &input.body {
        Some(body) => gauge.of(body),
        None => gauge,
    })
}
