//! Contacts, as `check` understood them.

use super::parameters::parameters;
use crate::case::file::{
    Case, CircleInput, ContactInput, InitialInput, MasterInput, PlaneInput, PolylineInput, RigidInput,
};
use crate::contact::pair::ContactPair;
use crate::contact::small_sliding::LITTLE_TURN;
use crate::laws::friction::observables;
use crate::model::Model;
use crate::model::method::{Chosen, Method};
use crate::model::told::{count, number};
use crate::model::warnings::gaps;
use crate::output::warnings::several_answers;

/// Every contact, with how its surfaces lie at the start.
pub fn contacts(case: &Case, model: &Model) -> Vec<String> {
    let mut lines = Vec::new();
    for (pair, chosen) in model.contacts.iter().zip(&model.methods) {
        lines.push(pair.name.clone());
        lines.extend(contact(case, pair, chosen.as_ref()).into_iter().map(|line| format!("  {line}")));
        let start = match &case.contacts[&pair.name].initial {
            Some(initial) => initial_tractions(initial, pair),
            None => gaps(model, pair, case.contacts[&pair.name].shrink_fit),
        };
        lines.push(format!("  {start}"));
    }
    lines
}

fn initial_tractions(initial: &InitialInput, pair: &ContactPair) -> String {
    let tractions = pair.initial.iter().flatten();
    let points = || pair.points.iter();
    let observed =
        |name| points().map(move |point| observables::value(pair.law(point), name, &pair.law(point).initial_state()));
    let p = range(tractions.clone().map(|initial| initial.pressure));
    let q = range(tractions.map(|initial| initial.traction));
    let (structure, mu) = (range(observed("structure")), range(observed("mu")));
    let balanced = if initial.balanced { ", balanced by an initial stress of the bodies" } else { "" };
    format!("starts closed with the pressure {p} and the traction {q}{balanced}; mu {mu}, structure {structure}")
}

/// An initial pressure under which the answer may snap; a run meets it in its first increment.
pub fn pressed_too_hard(pair: &ContactPair) -> Option<String> {
    let pressed = pair.points.iter().zip(pair.initial.iter().flatten());
    let limits = pressed.filter_map(|(point, initial)| Some((initial.pressure, pair.law(point).uniqueness_limit()?)));
    let (pressure, limit) = limits.filter(|(pressure, limit)| pressure > limit).max_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(format!("contact `{}`: {}", pair.name, several_answers(pressure, limit)))
}

/// One number, or the range of several.
fn range(values: impl Iterator<Item = f64> + Clone) -> String {
    let low = values.clone().fold(f64::INFINITY, f64::min);
    let high = values.fold(f64::NEG_INFINITY, f64::max);
    if number(low) == number(high) { number(low) } else { format!("{} to {}", number(low), number(high)) }
}

fn contact(case: &Case, pair: &ContactPair, chosen: Option<&Chosen>) -> Vec<String> {
    let input = &case.contacts[&pair.name];
    let alpha_n = match input.normal.alpha_n {
        Some(_) => "given",
        None => "10 (λ + 2G)/h: of the softer side, over the depth of the slave's elements",
    };
    let mut lines = vec![
        format!("slave {} against master {}", input.slave, master(input)),
        format!("{}: {}", evaluated(input, chosen), count(pair.points.len(), "contact point")),
        format!("alpha_n {} ({alpha_n})", number(pair.alpha_n)),
    ];
    if let Some(small) = &pair.small {
        let slips = small.little_slip().map(|slip| format!("slips up to {} and ", number(slip))).unwrap_or_default();
        lines.push(format!(
            "small sliding: every point keeps its foot, normal and length of the start; for {slips}turns up to {LITTLE_TURN} rad"
        ));
    }
    if input.massless {
        lines.push("the slave's nodes carry no mass in dynamic steps".into());
    }
    if let Some(given) = gives_alpha_t(input) {
        let chosen = if given { "given" } else { "alpha_n/2" };
        let alpha_t = range(pair.laws.iter().map(|law| law.stiffness()));
        lines.push(format!("alpha_t {alpha_t} ({chosen})"));
    }
    lines.push(format!("friction {}", parameters(&input.friction, "law", &["alpha_t"])));
    if !input.along.is_empty() {
        let names: Vec<&str> = input.along.keys().map(String::as_str).collect();
        lines.push(format!("along it vary {}", names.join(", ")));
    }
    if let Some(limit) = pair.laws.iter().filter_map(|law| law.uniqueness_limit()).reduce(f64::min) {
        let limit = number(limit);
        lines.push(format!(
            "one answer while the pressure stays below {limit}; above, slip may weaken faster than alpha_t"
        ));
    }
    lines
}

fn master(input: &ContactInput) -> String {
    let pair = |v: [f64; 2]| v.map(number).join(", ");
    match &input.master {
        MasterInput::Group(group) if *group == input.slave => "itself".into(),
        MasterInput::Group(group) => group.clone(),
        MasterInput::Rigid(RigidInput::Plane(PlaneInput { point, normal })) => {
            format!("the rigid plane through ({}) with the normal ({})", pair(*point), pair(*normal))
        }
        MasterInput::Rigid(RigidInput::Circle(CircleInput { centre, radius, hole })) => {
            let kind = if *hole { "hole" } else { "disk" };
            format!("the rigid {kind} of radius {} about ({})", number(*radius), pair(*centre))
        }
        MasterInput::Rigid(RigidInput::Polyline(PolylineInput { points })) => {
            format!("the rigid polyline through {}", count(points.len(), "point"))
        }
    }
}

/// Where contact is evaluated, and why if that was left open.
fn evaluated(input: &ContactInput, chosen: Option<&Chosen>) -> String {
    let Some(Chosen { method, points, because, .. }) = chosen else {
        return format!("each point stands for the area {}", number(input.area.unwrap_or_default()));
    };
    let how = match method {
        Method::GaussToSegment => format!("{points} points an edge"),
        Method::NodeToSegment => "a point at each node".into(),
        Method::Mortar => "averaged around each node".into(),
    };
    let because = because.map_or(String::new(), |because| format!(" ({because})"));
    format!("{}, {how}{because}", method.name())
}

/// Whether the case gives `alpha_t`; `None` for a law that has none.
fn gives_alpha_t(input: &ContactInput) -> Option<bool> {
    let law = serde_json::to_value(input.friction).ok()?;
    law.get("alpha_t").map(|given| !given.is_null())
}
