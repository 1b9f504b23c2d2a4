//! Contacts in the report of `check`.
//!
//! Laws are listed with their parameters.

use std::collections::BTreeMap;

use serde::Serialize;
use serde_json::Value;

use crate::case::file::Case;
use crate::case::resolved::written_out;
use crate::contact::conduit::{Conduit, Gives};
use crate::contact::pair::ContactPair;
use crate::contact::small_sliding::LITTLE_TURN;
use crate::laws::friction::{Bond, Cohesion, Dilatancy, Onset};
use crate::model::Model;
use crate::model::boundary::Profile;
use crate::model::builder::{Contact, FADES, InitialTractions, MasterSide, default_over, regime, tangential_over};
use crate::model::method::{Chosen, Method};
use crate::model::scheme::Regime;
use crate::model::text::{count, number, vector};
use crate::model::warnings::gaps;
use crate::output::concerns::several_answers;

/// Lists every contact, with the position of its surfaces at the start.
pub fn contacts(case: &Case, model: &Model) -> Vec<String> {
    let mut case = case.clone();
    case.contacts.iter_mut().for_each(|(name, contact)| written_out(contact, name, model));
    let (case, mut lines) = (&case, Vec::new());
    for (pair, chosen) in model.contacts.iter().zip(&model.methods) {
        lines.push(pair.name.clone());
        lines.extend(contact(case, model, pair, chosen.as_ref()).into_iter().map(|line| format!("  {line}")));
        let start = match &case.contacts[&pair.name].initial {
            Some(_) if pair.comes_stressed => {
                "added later, closed under the stress that acts there at that time".into()
            }
            Some(initial) => initial_tractions(initial, pair),
            None => gaps(model, pair, case.contacts[&pair.name].shrink_fit),
        };
        lines.push(format!("  {start}"));
    }
    lines
}

fn initial_tractions(initial: &InitialTractions, pair: &ContactPair) -> String {
    let tractions = pair.initial.iter().flatten();
    let points = || pair.points.iter();
    let observed = |name| {
        points().map(move |point| pair.law(point)).map(move |law| law.observe(name, &law.law.initial_state(0.0, 0.0)))
    };
    let p = range(tractions.clone().map(|initial| initial.pressure));
    let q = range(tractions.map(|initial| initial.traction));
    let (structure, mu) = (range(observed("structure")), range(observed("mu")));
    let balanced = match (initial.balanced, initial.of_bodies) {
        (true, _) => ", balanced by an initial stress of the bodies",
        (false, true) => ", from the initial stress of the slave's body",
        (false, false) => "",
    };
    format!("starts closed: pressure {p}, traction {q}{balanced}; mu {mu}, structure {structure}")
}

/// Warns of an initial pressure above the uniqueness bound, which a run meets in its first increment unless the law has one response to
/// little slip.
pub fn pressed_too_hard(pair: &ContactPair) -> Option<String> {
    let pressed = pair.points.iter().zip(pair.initial.iter().flatten());
    let pressed = pressed.map(|(point, initial)| (initial.pressure, pair.law(point).description));
    let limits = pressed
        .filter(|(_, law)| law.unique_slip == 0.0)
        .filter_map(|(pressure, law)| Some((pressure, law.uniqueness_limit()?)));
    let (pressure, limit) = limits.filter(|(pressure, limit)| pressure > limit).max_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(format!("contact `{}`: {}", pair.name, several_answers(pressure, limit)))
}

fn three_digits(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}

/// Formats one number, or the range of several.
fn range(values: impl Iterator<Item = f64> + Clone) -> String {
    let low = values.clone().fold(f64::INFINITY, f64::min);
    let high = values.fold(f64::NEG_INFINITY, f64::max);
    if number(low) == number(high) { number(low) } else { format!("{} to {}", number(low), number(high)) }
}

fn contact(case: &Case, model: &Model, pair: &ContactPair, chosen: Option<&Chosen>) -> Vec<String> {
    let input = &case.contacts[&pair.name];
    let regime = regime(&case.steps);
    let method = chosen.map(|chosen| chosen.method);
    let alpha_n = match input.normal.alpha_n {
        Some(_) => "given".into(),
        None => {
            let over = default_over(input, method, regime);
            let because = match regime {
                Regime::Explicit => ": a step is explicit",
                Regime::QuasiDynamic if input.fluid_pressure.is_some() => ": for a fluid",
                Regime::QuasiDynamic => ": a step is quasi_dynamic",
                Regime::Dynamic if !pair.tied => ": a step has inertia",
                Regime::Dynamic | Regime::Static => "",
            };
            format!("{} (λ + 2G)/h of the softer body, h the depth of the slave's elements{because}", number(over))
        }
    };
    let mut lines = vec![
        format!("slave {} against master {}{}", input.slave, master(input), moves(input)),
        format!("{}: {}", evaluated(input, chosen), count(pair.points.len(), "contact point")),
        format!("alpha_n {} ({alpha_n})", number(pair.alpha_n)),
    ];
    if let Some(small) = &pair.small {
        let slips = small.little_slip().map(|slip| format!("slips up to {} and ", number(slip))).unwrap_or_default();
        lines.push(format!(
            "small sliding: every point keeps its initial projection, normal and length; valid for {slips}rotations up \
             to {LITTLE_TURN} rad"
        ));
    }
    if input.massless {
        lines.push("the slave's nodes carry no mass in dynamic steps".into());
    }
    if let Some(given) = gives_alpha_t(input) {
        let penalty = pair.laws.iter().all(|law| law.description.stiffness_is_penalty);
        let chosen = match (given, input.normal.alpha_n) {
            (true, _) => "given".into(),
            (false, Some(_)) => "alpha_n/2".into(),
            (false, None) => {
                let penalties = pair.laws.iter().map(|law| law.description.stiffness_is_penalty);
                let over = penalties.map(|penalty| tangential_over(penalty, input, method, regime));
                format!("{} (λ + 2G)/h", range(over))
            }
        };
        let what =
            if penalty { "penalty of sticking points" } else { "parameter of the law, whose slip is elastic at first" };
        let alpha_t = range(pair.laws.iter().map(|law| law.stiffness));
        lines.push(format!("alpha_t {alpha_t} ({chosen}): {what}"));
    }
    if pair.tied {
        let facing = pair.points.iter().zip(pair.small.iter().flat_map(|small| &small.points));
        let free = facing.filter(|(_, point)| point.is_none()).count();
        let free =
            if free > 0 { format!("; {} without a projection stay free", count(free, "point")) } else { String::new() };
        lines.push(format!("tied: the surfaces neither part nor slide{free}"));
        return lines;
    }
    lines.push(format!("friction {}", parameters(&input.friction, "law", &["alpha_t"])));
    let vary = |along: &BTreeMap<String, Profile>| -> Option<String> {
        let random = |profile: &Profile| matches!(profile, Profile::Random(_));
        let name = |(name, profile): (&String, &Profile)| {
            if random(profile) { format!("{name} at random") } else { name.clone() }
        };
        let names: Vec<String> = along.iter().map(name).collect();
        (!names.is_empty()).then(|| format!("varies along the interface: {}", names.join(", ")))
    };
    lines.extend(vary(&input.along.parameters));
    for choice in &input.along.law {
        lines.push(format!("on part of the interface: {}", parameters(&choice.friction, "law", &["alpha_t"])));
        lines.extend(vary(&choice.along));
    }
    lines.extend(strength(pair));
    lines.extend(onset(pair));
    if pair.radiation > 0.0 {
        lines.push(format!("radiation damping η = {} in static steps", number(pair.radiation)));
    }
    lines.extend(moving(input, model, pair));
    if let Some(limit) = pair.laws.iter().filter_map(|law| law.description.uniqueness_limit()).reduce(f64::min) {
        let limit = number(limit);
        lines.push(format!(
            "unique response for p < {limit}; above, slip weakening may exceed the contact stiffness alpha_t"
        ));
    }
    lines
}

/// Peak, residual and healing of a law as in a law test; ranges where its parameters vary along the interface.
fn onset(pair: &ContactPair) -> Option<String> {
    let laws: Vec<Onset> = pair.laws.iter().filter_map(|law| law.law.onset()).collect();
    if laws.is_empty() {
        return None;
    }
    let over = |of: fn(&Onset) -> Option<f64>| {
        let known: Vec<f64> = laws.iter().filter_map(of).map(three_digits).collect();
        (!known.is_empty()).then(|| range(known.iter().copied()))
    };
    let of = |of: fn(&Onset) -> f64| range(laws.iter().map(of).map(three_digits));
    let rises = match over(|law| law.rested.slip) {
        Some(slip) => format!("peak q/p {} at a plastic slip of {slip}", of(|law| law.rested.peak)),
        None => format!("q/p rises to {} without a peak", of(|law| law.rested.peak)),
    };
    let fresh = match laws.iter().all(|law| law.fresh == law.rested) {
        true => String::new(),
        false => format!(" ({} at the start of the run)", of(|law| law.fresh.peak)),
    };
    let falls = over(|law| law.half_lost).map_or("no weakening with slip".into(), |slip| {
        format!("residual q/p {}, half of the weakening from mu_s within {slip} of slip", of(|law| law.residual))
    });
    let heals = over(|law| law.half_healed);
    let heals = heals.map_or("no healing".into(), |time| format!("half recovers in {time}"));
    Some(format!("rapid slip after a long hold: {rises}{fresh}, {falls}; {heals}"))
}

/// Strength without pressure, and the opening over which it fades.
fn strength(pair: &ContactPair) -> Option<String> {
    let fades = pair.fades?;
    let bonds = || pair.laws.iter().filter_map(|law| law.cohesion.as_ref()).map(Cohesion::bond);
    let of = |value: fn(&Bond) -> f64| range(bonds().map(value).collect::<Vec<_>>().into_iter());
    let chosen = if fades.is_chosen {
        format!("{} c h/E of the softer side, h the slave's longest edge", number(FADES))
    } else {
        "given".into()
    };
    let has_bond = pair.laws.iter().any(|law| matches!(law.cohesion, Some(Cohesion::Parallel(_))));
    let softens = || bonds().all(|bond| bond.slip().is_finite());
    let further = [
        (bonds().any(|bond| bond.residual() < bond.strength()), format!(", residual {}", of(Bond::residual))),
        (softens(), format!(", softens within the slip {}", of(Bond::slip))),
        (bonds().any(|bond| bond.tension() > 0.0), format!(", tension {}", of(Bond::tension))),
        (bonds().all(|bond| bond.limit().is_finite()), format!(", shear of at most {}", of(Bond::limit))),
        (has_bond, format!(", alpha_t {} of the bond", of(Bond::stiffness))),
    ];
    let further: String = further.into_iter().filter(|(is, _)| *is).map(|(_, what)| what).collect();
    let (strength, opening) = (of(Bond::strength), of(Bond::opening));
    Some(format!("strength without pressure {strength}{further}; fades over the opening {opening} ({chosen})"))
}

/// Dilatancy, wear, and fluid pressure.
fn moving(input: &Contact, model: &Model, pair: &ContactPair) -> Vec<String> {
    let mut lines = Vec::new();
    if let Some(Dilatancy { rate, structure, limit }) = input.dilatancy {
        let limit = limit.map_or("without limit".into(), |limit| format!("up to {}", number(limit)));
        let rate = rate.map(number).or_else(|| Some(format!("{} (1/R* − 1)", number(structure?))));
        lines.push(format!("dilatancy: {} per plastic slip, {limit}", rate.unwrap_or_default()));
    }
    lines.extend(input.wear.map(|wear| format!("wear: {} × pressure × plastic slip", number(wear))));
    if let Some(conduit) = &pair.conduit {
        lines.push(water(conduit, model));
    }
    if pair.fluid.is_some() {
        let x = model.mesh.undeformed();
        let pressures = pair.points.iter().map(|point| pair.fluid_pressure(point, &x, 0.0));
        lines.push(format!("fluid pressure in the interface: {} at the start", range(pressures)));
    }
    if pair.pores.is_some() {
        let x = model.mesh.undeformed();
        let pressures = (0..pair.points.len()).map(|k| pair.pore_pressure(k, &x));
        let pressures = range(pressures);
        lines.push(format!(
            "friction by effective stress, fluid pressure in the pores of the slave: {pressures} at the start"
        ));
    }
    lines
}

/// Water that flows along the contact, with its wells where they act.
fn water(conduit: &Conduit, model: &Model) -> String {
    let place = |node: usize| vector(model.mesh.nodes[conduit.line.nodes[node]]);
    let wells = conduit.wells.iter().map(|well| {
        let at = well.at.iter().map(|&(node, _)| place(node)).collect::<Vec<_>>().join(" and ");
        let what = if matches!(well.gives, Gives::Pressure(_)) { "a prescribed pressure" } else { "a rate given" };
        format!("{what} at {at}")
    });
    let wells: Vec<String> = wells.collect();
    let wells = if wells.is_empty() { "no wells".into() } else { wells.join(", ") };
    let by = if conduit.transmissivity.aperture.is_some() {
        "by the cubic law"
    } else if conduit.transmissivity.varies() {
        "by a transmissivity that changes"
    } else {
        "by a constant transmissivity"
    };
    format!("water flows along {} nodes {by}; {wells}", conduit.line.count())
}

fn master(input: &Contact) -> String {
    match &input.master {
        MasterSide::Group(group) if *group == input.slave => "itself".into(),
        MasterSide::Group(group) => group.clone(),
        MasterSide::Plane { point, normal } => {
            format!("the rigid plane through {} with the normal {}", vector(*point), vector(*normal))
        }
        MasterSide::Circle { centre, radius, hole } => {
            let kind = if *hole { "hole" } else { "disk" };
            format!("the rigid {kind} of radius {} about {}", number(*radius), vector(*centre))
        }
        MasterSide::Polyline { points } => format!("the rigid polyline through {}", count(points.len(), "point")),
        MasterSide::Outline { group } => format!("the rigid outline {group}"),
    }
}

/// Motion of a rigid master.
fn moves(input: &Contact) -> String {
    input.rigid_body.as_ref().map_or(String::new(), |body| format!(", part of the rigid body {body}"))
}

/// Method and contact points, with the reason for the method if it was selected automatically.
fn evaluated(input: &Contact, chosen: Option<&Chosen>) -> String {
    let Some(Chosen { method, points, because, .. }) = chosen else {
        return format!("area of each point: {}", number(input.area.unwrap_or_default()));
    };
    let how = match method {
        Method::GaussToSegment => format!("{points} points per edge"),
        Method::NodeToSegment => "a point at each node".into(),
        Method::Mortar => "averaged around each node".into(),
    };
    let because = because.map_or(String::new(), |because| format!(" ({because})"));
    format!("{}, {how}{because}", method.name())
}

/// Whether the case specifies `alpha_t`; `None` for a law without it.
fn gives_alpha_t(input: &Contact) -> Option<bool> {
    let law = serde_json::to_value(&input.friction).ok()?;
    law.get("alpha_t").map(|given| !given.is_null())
}

/// The law named by `tag`, and its parameters except those in `skip`.
pub fn parameters(law: &impl Serialize, tag: &str, skip: &[&str]) -> String {
    let Ok(Value::Object(fields)) = serde_json::to_value(law) else { return String::new() };
    let name = fields.get(tag).and_then(Value::as_str).unwrap_or_default();
    let shown = fields.iter().filter(|(key, value)| *key != tag && !skip.contains(&key.as_str()) && !value.is_null());
    let shown: Vec<String> = shown.map(|(key, value)| format!("{key} {}", plain(value))).collect();
    if shown.is_empty() { name.into() } else { format!("{name}: {}", shown.join(", ")) }
}

/// A value without quotation marks or needless digits.
pub fn plain(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        value => value.as_f64().map_or_else(|| value.to_string(), number),
    }
}
