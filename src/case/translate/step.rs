//! Steps as written: `null` ends what an earlier step gave.
//!
//! Drives, profiles and places as written.

use self::place as at;
use crate::case::error::{Checked, Complaint};
use crate::case::file::{
    Components as Written, DampingInput, DashpotInput, DriveInput, IncrementsInput, LoadInput, Place as Where,
    ProfileInput, ProfileTable, RotationInput, RuptureInput, SpotInput, SpringInput, StepInput, SupportInput,
    TemperatureInput, TemperatureVariation, TimeInput, UntilInput,
};
use crate::model::Damping;
use crate::model::boundary::{Drive, Expression, Profile};
use crate::model::builder::{
    Action, Change, Components, IncrementSettings, Link, Load, LoadStep, Place, Rotation, RuptureSettings, Support,
    UntilSettings,
};
use crate::model::step::Part;

/// A step; `place` is where it stands.
pub fn step(place: &str, input: &StepInput) -> Checked<LoadStep> {
    let settings = |IncrementsInput { initial, min, max, error }| IncrementSettings { initial, min, max, error };
    let rupture = |RuptureInput { slip_rate, safety }| RuptureSettings { slip_rate, safety };
    let supports = input.supports.iter().enumerate();
    let loads = input.loads.iter().enumerate();
    Ok(LoadStep {
        name: input.name.clone(),
        duration: input.duration,
        scheme: input.scheme,
        increments: input.dt.map(settings),
        stabilize: input.stabilize,
        rupture: input.rupture.map(rupture),
        damping: input.damping.iter().map(|(name, damping)| (name.clone(), self::damping(damping))).collect(),
        until: input.until.as_ref().map(|given| until(&format!("{place}.until"), given)).transpose()?,
        velocities: input.velocity.iter().map(|(name, velocity)| (name.clone(), *velocity)).collect(),
        temperatures: input
            .temperature
            .iter()
            .map(|(name, input)| Ok((name.clone(), temperature(input, &format!("{place}.temperature.{name}"))?)))
            .collect::<Checked<_>>()?,
        supports: supports
            .map(|(k, input)| support(&format!("{place}.supports[{k}]"), input))
            .collect::<Checked<_>>()?,
        loads: loads.map(|(k, input)| load(&format!("{place}.loads[{k}]"), input)).collect::<Checked<_>>()?,
    })
}

/// Damping of a body.
pub fn damping(&DampingInput { mass, stiffness }: &DampingInput) -> Damping {
    Damping { mass, retardation: stiffness }
}

fn until(place: &str, input: &UntilInput) -> Checked<UntilSettings> {
    let parts = [(Part::X, input.fx), (Part::Y, input.fy), (Part::Size, input.force)];
    let mut given = parts.into_iter().filter_map(|(part, value)| Some((part, value?)));
    match (given.next(), given.next()) {
        (Some((part, value)), None) => Ok(UntilSettings { on: at(&input.on), part, value, tolerance: input.tolerance }),
        _ => Err(Complaint::new(place, "must give exactly one of fx, fy and force")),
    }
}

/// What is given: `null` is the end of it, and what is not there changes nothing.
fn change<T, U>(input: &Option<Option<T>>, translate: impl FnOnce(&T) -> Checked<U>) -> Checked<Option<Change<U>>> {
    Ok(match input {
        Some(Some(given)) => Some(Change::To(translate(given)?)),
        Some(None) => Some(Change::End),
        None => None,
    })
}

fn support(place: &str, input: &SupportInput) -> Checked<Support> {
    let rotation = |RotationInput { about, angle }: &RotationInput| {
        Ok(Rotation { about: *about, angle: drive(angle, &format!("{place}.rotation.angle"))? })
    };
    let along = match (input.along, change(&input.u, |given| drive(given, &format!("{place}.u")))?) {
        (None, None) => None,
        (Some(direction), Some(u)) => Some((direction, u)),
        (Some(_), None) => return Err(Complaint::new(place, "gives a direction `along` and no displacement: give u")),
        (None, Some(_)) => return Err(Complaint::new(place, "gives u and no direction: give `along`, [x, y]")),
    };
    Ok(Support {
        on: at(&input.on),
        along,
        un: change(&input.un, |given| drive(given, &format!("{place}.un")))?,
        ux: change(&input.ux, |given| drive(given, &format!("{place}.ux")))?,
        uy: change(&input.uy, |given| drive(given, &format!("{place}.uy")))?,
        rotation: change(&input.rotation, rotation)?,
    })
}

/// A load; `place` is where it stands.
pub fn load(place: &str, input: &LoadInput) -> Checked<Load> {
    let vector = |key: &str, of: &Option<Option<Written>>| {
        change(of, |given| components(given, ["x", "y"].map(|name| format!("{place}.{key}.{name}"))))
    };
    let link = |key: &str, coefficients: [f64; 2], driver: &Option<Written>| {
        let driver = driver.as_ref().map(|given| components(given, [(); 2].map(|()| format!("{place}.{key}.driver"))));
        Ok(Link { coefficients, driver: driver.transpose()? })
    };
    let spring = |SpringInput { kx, ky, driver }: &SpringInput| link("spring", [*kx, *ky], driver);
    let dashpot = |DashpotInput { cx, cy, driver }: &DashpotInput| link("dashpot", [*cx, *cy], driver);
    let given = [
        change(&input.pressure, |given| drive(given, &format!("{place}.pressure")))?.map(Action::Pressure),
        change(&input.dead_pressure, |given| drive(given, &format!("{place}.dead_pressure")))?
            .map(Action::DeadPressure),
        vector("traction", &input.traction)?.map(Action::Traction),
        vector("gravity", &input.gravity)?.map(Action::Gravity),
        vector("force", &input.force)?.map(Action::Force),
        vector("total_force", &input.total_force)?.map(Action::TotalForce),
        change(&input.moment, |given| drive(given, &format!("{place}.moment")))?.map(Action::Moment),
        change(&input.spring, spring)?.map(Action::Spring),
        change(&input.dashpot, dashpot)?.map(Action::Dashpot),
        input
            .absorbing
            .map(|absorbs| Action::Absorbing(if absorbs == Some(true) { Change::To(()) } else { Change::End })),
    ];
    let mut given = given.into_iter().flatten();
    match (given.next(), given.next()) {
        (Some(action), None) => Ok(Load { on: at(&input.on), action }),
        _ => Err(Complaint::new(
            place,
            "must give exactly one of pressure, dead_pressure, traction, gravity, force, total_force, moment, spring, dashpot, absorbing",
        )),
    }
}

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
