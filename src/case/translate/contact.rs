//! Contacts as written.

use std::collections::BTreeMap;

use serde_json::Value;

use crate::case::error::{Checked, Complaint};
use crate::case::file::{
    CircleInput, ContactInput, DilatancyInput, InitialInput, LawChoiceInput, MasterInput, PlaneInput, PolylineInput,
    RadiationInput, RigidInput, SlidingInput,
};
use crate::case::read::explain;
use crate::laws::friction::{Dilatancy, FrictionParameters};
use crate::model::boundary::Profile;
use crate::model::builder::{Contact, Friction, InitialTractions, MasterSide, ModelError, Radiation};

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
        dilatancy: input.dilatancy.map(|DilatancyInput { rate, limit }| Dilatancy { rate, limit }),
        wear: input.wear,
        radiation: match input.radiation_damping {
            RadiationInput::OfBodies(false) => None,
            RadiationInput::OfBodies(true) => Some(Radiation::OfBodies),
            RadiationInput::Given(damping) => Some(Radiation::Given(damping)),
        },
        fluid_pressure: input.fluid_pressure.clone(),
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
    let InitialInput { pressure, traction, balanced, of_bodies, .. } = input;
    let refused = |key: &str, message: &str| Err(Complaint::new(format!("{place}.{key}"), message));
    match (of_bodies, pressure, traction) {
        (true, Some(_), _) => return refused("pressure", "has no meaning together with of_bodies: leave one out"),
        (true, _, Some(_)) => return refused("traction", "has no meaning together with of_bodies: leave one out"),
        (false, None, _) => return refused("pressure", "is missing: give it, or \"of_bodies\": true"),
        _ => {}
    }
    Ok(InitialTractions {
        pressure: pressure.clone().unwrap_or_default(),
        traction: traction.clone().unwrap_or_default(),
        balanced: *balanced,
        of_bodies: *of_bodies,
    })
}

/// The laws, with those of their parameters replaced that vary along the slave; an initial structure is one of them.
fn friction(input: &ContactInput, place: &str) -> Checked<Friction> {
    let mut varying = profiles(&input.along.parameters, "along");
    if let Some(structure) = input.initial.as_ref().and_then(|initial| initial.structure.as_ref()) {
        let place = format!("{place}.initial.structure");
        if !input.friction.has_structure() {
            return Err(Complaint::new(place, "this friction law has no structure: leave it out"));
        }
        if input.along.parameters.contains_key("structure") {
            return Err(Complaint::new(place, "is given by `along` already: leave one of them out"));
        }
        varying.push(("structure".into(), "initial.structure".into(), structure.clone()));
    }
    let mut friction = with_varying(input.friction.clone(), varying, place, "friction")?;
    for (k, LawChoiceInput { place: positive, friction: law, along }) in input.along.law.iter().enumerate() {
        let name = format!("along.law[{k}]");
        let varying = profiles(along, &format!("{name}.along"));
        let other = with_varying(law.clone(), varying, place, &format!("{name}.friction"))?;
        friction = friction.but_where(&name, positive.clone(), other);
    }
    Ok(friction)
}

/// A parameter, where it stands in a contact, and how it varies.
type Varying = (String, String, Profile);

fn profiles(along: &BTreeMap<String, Profile>, within: &str) -> Vec<Varying> {
    along.iter().map(|(name, profile)| (name.clone(), format!("{within}.{name}"), profile.clone())).collect()
}

/// A law some of whose parameters vary; it stands at `own` in the contact.
fn with_varying(parameters: FrictionParameters, varying: Vec<Varying>, place: &str, own: &str) -> Checked<Friction> {
    if let Some(message) = parameters.unknown() {
        return Err(Complaint::new(format!("{place}.{own}.name"), message));
    }
    if varying.is_empty() {
        return Ok(parameters.into());
    }
    // The numbers that are replaced must be good as well; any α_t will do for that.
    parameters.build(1.0).map_err(|error| Complaint::new(format!("{place}.{own}"), error))?;
    let names: Vec<[String; 2]> =
        varying.iter().map(|(name, within, _)| [name.clone(), format!("{place}.{within}")]).collect();
    let profiles: Vec<(String, Profile)> = varying.into_iter().map(|(_, within, profile)| (within, profile)).collect();
    Ok(Friction::varying(profiles, move |values, alpha_t| {
        let mut parameters = parameters.clone();
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
