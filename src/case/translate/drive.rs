//! Drives, profiles and places as written.

use crate::case::error::{Checked, Complaint};
use crate::case::file::{
    Components as Written, DriveInput, Place as Where, ProfileInput, ProfileTable, SpotInput, TemperatureInput,
    TemperatureVariation, TimeInput,
};
use crate::model::boundary::{Drive, Expression, Profile};
use crate::model::builder::{Components, Place};

/// How a quantity varies in time; its expression is read.
pub fn drive(input: &DriveInput, place: &str) -> Checked<Drive> {
    Ok(match input {
        DriveInput::Constant(value) => Drive::Constant(*value),
        DriveInput::Expression(text) => Drive::Expression(expression(text, place)?),
        DriveInput::InTime(TimeInput::Rate(rate)) => Drive::Rate(*rate),
        DriveInput::InTime(TimeInput::Table(table)) => Drive::Table(table.clone()),
    })
}

/// How warm a body is; its expression is read.
pub fn temperature(input: &TemperatureInput, place: &str) -> Checked<Drive> {
    Ok(match input {
        TemperatureInput::Constant(value) => Drive::Constant(*value),
        TemperatureInput::Expression(text) => Drive::Expression(expression(text, place)?),
        TemperatureInput::Varying(TemperatureVariation::Rate(rate)) => Drive::Rate(*rate),
        TemperatureInput::Varying(TemperatureVariation::Table(table)) => Drive::Table(table.clone()),
        TemperatureInput::Varying(TemperatureVariation::X(table)) => Drive::ByPlace(0, table.clone()),
        TemperatureInput::Varying(TemperatureVariation::Y(table)) => Drive::ByPlace(1, table.clone()),
    })
}

/// How a quantity varies along a surface; its expression is read.
pub fn profile(input: &ProfileInput, place: &str) -> Checked<Profile> {
    Ok(match input {
        ProfileInput::Constant(value) => Profile::Constant(*value),
        ProfileInput::Expression(text) => Profile::Expression(expression(text, place)?),
        ProfileInput::Table(ProfileTable::X(table)) => Profile::Table(0, table.clone()),
        ProfileInput::Table(ProfileTable::Y(table)) => Profile::Table(1, table.clone()),
    })
}

/// Components of a vector; each is named by `places`.
pub fn components(input: &Written, places: [String; 2]) -> Checked<Components> {
    let [x, y] = places;
    Ok(Components {
        x: input.x.as_ref().map(|input| drive(input, &x)).transpose()?,
        y: input.y.as_ref().map(|input| drive(input, &y)).transpose()?,
    })
}

/// Where something acts.
pub fn place(on: &Where) -> Place {
    match on {
        Where::Group(name) => Place::Group(name.clone()),
        Where::Spot(SpotInput::Node(tag)) => Place::Node(*tag),
        Where::Spot(SpotInput::Near(point)) => Place::Near(*point),
    }
}

fn expression(text: &str, place: &str) -> Checked<Expression> {
    Expression::parse(text).map_err(|message| Complaint::new(place, message))
}
