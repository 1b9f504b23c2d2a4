//! Steps, as `check` understood them: what is in force in each, and what it ends.

use std::collections::BTreeMap;

use serde_json::Value;

use super::contact::plain;
use crate::case::file::Case;
use crate::model::boundary::Drive;
use crate::model::builder::{Action, Components, DashpotLoad, Load, LoadStep, Place, SpringLoad};
use crate::model::step::Until;
use crate::model::told::{count, number};
use crate::model::{Damping, Model, Step};
use crate::time::step_size::EVENT_LOCATION;

/// Every step.
pub fn steps(case: &Case, model: &Model) -> Vec<String> {
    let mut lines = Vec::new();
    // The text of each, and the number of the step that gave it last.
    let mut in_force: BTreeMap<Key, (String, usize)> = BTreeMap::new();
    for (k, (step, input)) in model.steps.iter().zip(&case.steps).enumerate() {
        lines.push(step.name.clone());
        let mut told = step_lines(step);
        told.extend(input.velocity.iter().map(|(name, velocity)| {
            let [vx, vy] = velocity.map(number);
            format!("{name} starts with the velocity ({vx}, {vy})")
        }));
        told.extend(input.damping.iter().map(|(name, Damping { mass, retardation })| {
            format!("damping of {name} from here on: mass {}, stiffness {}", number(*mass), number(*retardation))
        }));
        told.extend(
            input.temperature.iter().map(|(name, given)| format!("temperature of {name}: {}", drive(&given.into()))),
        );
        let on = |place: &Place| on(place, model);
        let loads = input.loads.iter().filter_map(|load| written_load(load, on));
        for (key, text) in written_supports(input, on).into_iter().chain(loads) {
            match text {
                Some(text) => drop(in_force.insert(key, (text, k))),
                None => {
                    in_force.remove(&key);
                    told.push(end(key, step.scheme.is_dynamic()));
                }
            }
        }
        told.extend(in_force.iter().map(|((verb, on, kind), (text, given))| {
            let kept = if *given == k { "" } else { " (kept)" };
            format!("{verb} {on}: {kind} {text}{kept}")
        }));
        lines.extend(told.into_iter().map(|line| format!("  {line}")));
        lines.push(format!("  {} prescribed", count(step.supports.len(), "dof")));
    }
    lines
}

fn step_lines(step: &Step) -> Vec<String> {
    let increments = &step.increments;
    let scheme = match serde_json::to_value(step.scheme) {
        Ok(Value::Object(scheme)) => scheme.iter().map(|(name, numbers)| format!("{name} {numbers}")).collect(),
        scheme => scheme.map(|name| plain(&name)).unwrap_or_default(),
    };
    let [initial, min, max] = [increments.initial, increments.min, increments.max].map(number);
    let mut lines = vec![
        format!("time {} to {}, {scheme}", number(step.span.start), number(step.span.end)),
        format!("increments start at {initial}, at least {min}, at most {max}"),
    ];
    if !step.stabilization.is_empty() {
        lines.push("stabilized: dashpots that fade away hold bodies until contact does".into());
    }
    lines.extend(step.until.as_ref().map(|until| {
        let Until { on, part, value, tolerance, .. } = until;
        let [value, tolerance] = [value, tolerance].map(|number_of| number(*number_of));
        format!("ends when {} of {on} comes to {value}, met to {tolerance} of it", part.name())
    }));
    let dynamic = step.scheme.is_dynamic();
    lines.extend(
        increments
            .error
            .filter(|_| !dynamic)
            .map(|error| format!("each in error by at most {} in the slip of a contact point", number(error))),
    );
    lines.extend(increments.error.filter(|_| dynamic).map(|error| {
        let located = number(EVENT_LOCATION * error);
        format!("each in error by at most {} in a displacement, events of contact located to {located}", number(error))
    }));
    lines.extend(step.rupture.as_ref().map(|rupture| {
        let [rate, calm] = [rupture.slip_rate, rupture.calm].map(number);
        format!("explicit while a contact slips faster than {rate}, on the mean of {calm} when it returns")
    }));
    lines
}

/// A support or load in words: whether it holds or loads, where, and its kind.
type Key = (&'static str, String, &'static str);

const HELD: &str = "held";
const LOADED: &str = "loaded";

/// One entry of a step; without a text it ends what was in force.
type Entry = (Key, Option<String>);

/// Loads without a value that could fade.
const ENDS_AT_ONCE: [&str; 3] = ["spring", "dashpot", "absorbing side"];

/// How a support or load ends.
fn end((verb, on, kind): Key, dynamic: bool) -> String {
    match verb == HELD {
        true if dynamic => format!("freed {on}: {kind}, at once"),
        true => format!("freed {on}: {kind}, its reaction fades over the step"),
        false if ENDS_AT_ONCE.contains(&kind) => format!("ended {on}: {kind}, at once"),
        false => format!("ended {on}: {kind}, it fades over the step"),
    }
}

/// A place in words, one of a single node by its tag.
fn on(place: &Place, model: &Model) -> String {
    place.settled(&model.mesh).map_or_else(|_| place.to_string(), |settled| settled.to_string())
}

fn written_supports(step: &LoadStep, on: impl Fn(&Place) -> String) -> Vec<Entry> {
    let mut entries: Vec<Entry> = Vec::new();
    for support in &step.supports {
        let mut add = |kind, text| entries.push(((HELD, on(&support.on), kind), text));
        for (kind, given) in [("ux", &support.ux), ("uy", &support.uy), ("along its normal", &support.un)] {
            if let Some(given) = given {
                add(kind, given.given().map(drive));
            }
        }
        if let Some(given) = &support.rotation {
            let turning = |about: [f64; 2], angle| format!("{angle} about ({})", about.map(number).join(", "));
            add("rotation", given.given().map(|given| turning(given.about, drive(&given.angle))));
        }
        if let (Some(direction), Some(given)) = (support.along, &support.u) {
            let on = format!("{} along ({})", on(&support.on), direction.map(number).join(", "));
            entries.push(((HELD, on, "u"), given.given().map(drive)));
        }
    }
    entries
}

fn written_load(load: &Load, place: impl Fn(&Place) -> String) -> Option<Entry> {
    let spring = |SpringLoad { kx, ky, driver }: &SpringLoad| {
        format!("kx {}, ky {}{}", number(*kx), number(*ky), driven("moved by", driver))
    };
    let dashpot = |DashpotLoad { cx, cy, driver }: &DashpotLoad| {
        format!("cx {}, cy {}{}", number(*cx), number(*cy), driven("moving with", driver))
    };
    let (kind, text) = match load.action()? {
        Action::Pressure(given) => ("pressure", given.map(drive)),
        Action::DeadPressure(given) => ("dead pressure", given.map(drive)),
        Action::Moment(given) => ("moment", given.map(drive)),
        Action::Absorbing(absorbs) => ("absorbing side", absorbs.then(|| "rho c_p and rho c_s of its body".into())),
        Action::Spring(given) => ("spring", given.map(spring)),
        Action::Dashpot(given) => ("dashpot", given.map(dashpot)),
        Action::Traction(given) => ("traction", given.map(components)),
        Action::Gravity(given) => ("gravity", given.map(components)),
        Action::TotalForce(given) => ("total force", given.map(components)),
        Action::Force(given) => ("force", given.map(components)),
    };
    Some(((LOADED, place(&load.on), kind), text))
}

fn driven(how: &str, driver: &Option<Components>) -> String {
    driver.as_ref().map_or(String::new(), |driver| format!(", its far end {how} {}", components(driver)))
}

fn components(of: &Components) -> String {
    let part = |part: &Option<Drive>| part.as_ref().map_or("0".into(), drive);
    format!("({}, {})", part(&of.x), part(&of.y))
}

fn by_table(table: &[[f64; 2]], of: &str) -> String {
    format!("by a table of {}", count(table.len(), of))
}

fn drive(drive: &Drive) -> String {
    match drive {
        Drive::Constant(value) => number(*value),
        Drive::Expression(expression) => format!("\"{}\"", expression.as_ref()),
        Drive::Rate(rate) => format!("at the rate {}", number(*rate)),
        Drive::Table(table) => by_table(table, "time"),
        Drive::ByPlace(_, table) => by_table(table, "place"),
    }
}
