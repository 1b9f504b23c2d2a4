//! Steps as written: `null` ends what an earlier step gave.

use super::drive::{components, drive, place as at, temperature};
use crate::case::error::{Checked, Complaint};
use crate::case::file::{
    Components, DampingInput, DashpotInput, IncrementsInput, LoadInput, RotationInput, RuptureInput, SpringInput,
    StepInput, SupportInput, UntilInput,
};
use crate::model::Damping;
use crate::model::builder::{
    Action, Change, IncrementSettings, Link, Load, LoadStep, Rotation, RuptureSettings, Support, UntilSettings,
};
use crate::model::until::Part;

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
    let vector = |key: &str, of: &Option<Option<Components>>| {
        change(of, |given| components(given, ["x", "y"].map(|name| format!("{place}.{key}.{name}"))))
    };
    let link = |key: &str, coefficients: [f64; 2], driver: &Option<Components>| {
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
