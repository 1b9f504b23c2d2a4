//! Contacts as written.

use serde_json::Value;

use super::drive::profile;
use crate::case::error::{Checked, Complaint};
use crate::case::explain::explain;
use crate::case::file::{
    CircleInput, ContactInput, InitialInput, MasterInput, PlaneInput, PolylineInput, RigidInput, SlidingInput,
};
use crate::laws::friction::FrictionParameters;
use crate::model::boundary::Profile;
use crate::model::builder::{Contact, Friction, InitialTractions, MasterSide, ModelError};

/// A contact of a name.
pub fn contact(name: &str, input: &ContactInput) -> Checked<Contact> {
    let place = format!("contacts.{name}");
    Ok(Contact {
        name: name.into(),
        slave: input.slave.clone(),
        area: input.area,
        master: master(&input.master),
        method: input.method,
        points: input.points,
        smooth: input.smooth,
        small_sliding: input.sliding == SlidingInput::Small,
        alpha_n: input.normal.alpha_n,
        penetration: input.normal.penetration,
        shrink_fit: input.shrink_fit,
        massless: input.massless,
        friction: friction(input, &place)?,
        initial: input.initial.as_ref().map(|initial| tractions(initial, &format!("{place}.initial"))).transpose()?,
    })
}

fn master(input: &MasterInput) -> MasterSide {
    match input {
        MasterInput::Group(group) => MasterSide::Group(group.clone()),
        MasterInput::Rigid(RigidInput::Plane(PlaneInput { point, normal })) => {
            MasterSide::Plane { point: *point, normal: *normal }
        }
        MasterInput::Rigid(RigidInput::Circle(CircleInput { centre, radius, hole })) => {
            MasterSide::Circle { centre: *centre, radius: *radius, hole: *hole }
        }
        MasterInput::Rigid(RigidInput::Polyline(PolylineInput { points })) => MasterSide::Polyline(points.clone()),
    }
}

fn tractions(input: &InitialInput, place: &str) -> Checked<InitialTractions> {
    Ok(InitialTractions {
        pressure: profile(&input.pressure, &format!("{place}.pressure"))?,
        traction: profile(&input.traction, &format!("{place}.traction"))?,
        balanced: input.balanced,
    })
}

/// The law, with those of its parameters replaced that vary along the slave; an initial structure is one of them.
fn friction(input: &ContactInput, place: &str) -> Checked<Friction> {
    let parameters = input.friction;
    let mut varying = Vec::new();
    for (name, input) in &input.along {
        varying.push((name.clone(), format!("along.{name}"), profile(input, &format!("{place}.along.{name}"))?));
    }
    if let Some(structure) = input.initial.as_ref().and_then(|initial| initial.structure.as_ref()) {
        let place = format!("{place}.initial.structure");
        if !parameters.has_structure() {
            return Err(Complaint::new(place, "this friction law has no structure: leave it out"));
        }
        if input.along.contains_key("structure") {
            return Err(Complaint::new(place, "is given by `along` already: leave one of them out"));
        }
        varying.push(("structure".into(), "initial.structure".into(), profile(structure, &place)?));
    }
    if varying.is_empty() {
        return Ok(parameters.into());
    }
    // The numbers that are replaced must be good as well; any α_t will do for that.
    parameters.build(1.0).map_err(|error| Complaint::new(format!("{place}.friction"), error))?;
    let names: Vec<[String; 2]> =
        varying.iter().map(|(name, within, _)| [name.clone(), format!("{place}.{within}")]).collect();
    let profiles: Vec<(String, Profile)> = varying.into_iter().map(|(_, within, profile)| (within, profile)).collect();
    Ok(Friction::varying(profiles, move |values, alpha_t| {
        let mut parameters = parameters;
        for ([name, place], &value) in names.iter().zip(values) {
            parameters = with(&parameters, name, value).map_err(|message| ModelError::new(place, message))?;
        }
        Ok(parameters.build(alpha_t)?)
    }))
}

/// The parameters with one of them replaced.
fn with(parameters: &FrictionParameters, name: &str, value: f64) -> Result<FrictionParameters, String> {
    let complain = |error: serde_json::Error| explain(&error.to_string());
    let mut fields = serde_json::to_value(parameters).map_err(complain)?;
    fields[name] = Value::from(value);
    serde_json::from_value(fields).map_err(complain)
}
