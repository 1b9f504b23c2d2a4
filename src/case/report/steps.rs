//! Steps in the report of `check`: supports and loads in force in each, and those that it ends.

use std::collections::BTreeMap;

use serde_json::Value;

use super::contact::plain;
use crate::case::file::Case;
use crate::model::boundary::Drive;
use crate::model::builder::{Action, Components, DashpotLoad, Load, LoadStep, Place, SpringLoad};
use crate::model::step::Until;
use crate::model::text::{count, number};
use crate::model::{Damping, Model, Step};
use crate::time::step_size::EVENT_LOCATION;

/// Lines about every step: scheme, increments, supports and loads in force.
pub fn steps(case: &Case, model: &Model) -> Vec<String> {
    let mut lines = Vec::new();
    let (mut supports, mut loads) = (InForce::new(), InForce::new());
    let on = |place: &Place| on(place, model);
    for (step, input) in model.steps.iter().zip(&case.steps) {
        lines.push(step.name.clone());
        let mut own = step_lines(step);
        own.extend(input.velocity.iter().map(|(name, velocity)| {
            let [vx, vy] = velocity.map(number);
            format!("{name}: initial velocity ({vx}, {vy})")
        }));
        own.extend(input.damping.iter().map(|(name, Damping { mass, retardation })| {
            format!("damping of {name} from this step on: mass {}, stiffness {}", number(*mass), number(*retardation))
        }));
        own.extend(
            input.temperature.iter().map(|(name, given)| format!("temperature of {name}: {}", drive(&given.into()))),
        );
        let fades = if step.scheme.is_dynamic() { "at once" } else { "its reaction fades over the step" };
        let released = supports.step(written_supports(input, on));
        own.extend(released.map(|(on, kind)| format!("support {on}: {kind} released, {fades}")));
        own.extend(loads.step(input.loads.iter().filter_map(|load| written_load(load, on))).map(|(on, kind)| {
            let fades = if ENDS_AT_ONCE.contains(&kind) { "at once" } else { "it fades over the step" };
            format!("load {on}: {kind} ended, {fades}")
        }));
        own.extend(supports.lines("support").into_iter().chain(loads.lines("load")));
        lines.extend(own.into_iter().map(|line| format!("  {line}")));
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
        format!("dt: initial {initial}, min {min}, max {max}"),
    ];
    if !step.stabilization.is_empty() {
        lines.push("stabilized: fading dashpots constrain bodies until contact does".into());
    }
    lines.extend(step.until.as_ref().map(|until| {
        let Until { on, part, value, tolerance, .. } = until;
        let [value, tolerance] = [value, tolerance].map(|number_of| number(*number_of));
        format!("ends when {} of {on} reaches {value}, relative tolerance {tolerance}", part.name())
    }));
    let dynamic = step.scheme.is_dynamic();
    lines.extend(
        increments
            .error
            .filter(|_| !dynamic)
            .map(|error| format!("error per increment at most {} in the slip of any contact point", number(error))),
    );
    lines.extend(increments.error.filter(|_| dynamic).map(|error| {
        let located = number(EVENT_LOCATION * error);
        format!(
            "error per increment at most {} in any displacement, contact events located within {located}",
            number(error)
        )
    }));
    lines.extend(step.rupture.as_ref().map(|rupture| {
        let [rate, calm] = [rupture.slip_rate, rupture.calm].map(number);
        format!(
            "explicit integration while a contact slips faster than {rate}; implicit again from the mean motion over \
             {calm}"
        )
    }));
    lines
}

/// Supports or loads in force in a step, by place and kind, as last written; `null` ends an entry.
struct InForce(BTreeMap<(String, &'static str), Written>);

struct Written {
    text: String,
    kept: bool,
}

/// Loads without a value that could be ramped to zero.
const ENDS_AT_ONCE: [&str; 3] = ["spring", "dashpot", "absorbing side"];

/// Place, kind and value of one entry of a step.
type Entry = (String, &'static str, Option<String>);

impl InForce {
    fn new() -> Self {
        Self(BTreeMap::new())
    }

    /// Adds the written entries; returns those that are ended.
    fn step(&mut self, entries: impl IntoIterator<Item = Entry>) -> impl Iterator<Item = (String, &'static str)> {
        self.0.values_mut().for_each(|written| written.kept = true);
        let mut ended = Vec::new();
        for (on, kind, text) in entries {
            match text {
                Some(text) => drop(self.0.insert((on, kind), Written { text, kept: false })),
                None => {
                    self.0.remove(&(on.clone(), kind));
                    ended.push((on, kind));
                }
            }
        }
        ended.into_iter()
    }

    fn lines(&self, what: &str) -> Vec<String> {
        let line = |((on, kind), written): (&(String, &str), &Written)| {
            let equals = if written.text.starts_with(char::is_alphabetic) { "" } else { "= " };
            let kept = if written.kept { " (kept)" } else { "" };
            format!("{what} {on}: {kind} {equals}{}{kept}", written.text)
        };
        self.0.iter().map(line).collect()
    }
}

/// Describes a place; a single node is described by its tag.
fn on(place: &Place, model: &Model) -> String {
    place.settled(&model.mesh).map_or_else(|_| place.to_string(), |settled| settled.to_string())
}

/// Describes a watched place by its name in results, with the tag of the node nearest to a point.
pub fn watched(place: &Place, model: &Model) -> String {
    match place {
        Place::Near(_) => format!("{} ({})", place.column(), on(place, model)),
        _ => place.column(),
    }
}

fn written_supports(step: &LoadStep, on: impl Fn(&Place) -> String) -> Vec<Entry> {
    let mut entries: Vec<Entry> = Vec::new();
    for support in &step.supports {
        let mut add = |kind, text| entries.push((on(&support.on), kind, text));
        for (kind, given) in [("ux", &support.ux), ("uy", &support.uy), ("un", &support.un), ("angle", &support.angle)]
        {
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
            entries.push((on, "u", given.given().map(drive)));
        }
    }
    entries
}

fn written_load(load: &Load, place: impl Fn(&Place) -> String) -> Option<Entry> {
    let spring = |SpringLoad { kx, ky, driver }: &SpringLoad| {
        format!("kx {}, ky {}{}", number(*kx), number(*ky), driven("displaced by", driver))
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
    Some((place(&load.on), kind, text))
}

fn driven(how: &str, driver: &Option<Components>) -> String {
    driver.as_ref().map_or(String::new(), |driver| format!(", far end {how} {}", components(driver)))
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
