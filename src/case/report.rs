//! What `check` prints: how the case was understood.

use std::collections::BTreeMap;
use std::fmt::Write;

use serde::Serialize;
use serde_json::Value;

use super::file::{
    BodyInput, Case, CircleInput, Components, ContactInput, DampingInput, DashpotInput, DriveInput, Formulation,
    InitialInput, LoadInput, MasterInput, MeshSource, Method, PlaneInput, PolylineInput, RigidInput, SpringInput,
    StepInput, TimeInput,
};
use super::method::{Chosen, choose};
use super::start;
use crate::contact::pair::ContactPair;
use crate::laws::friction::observables;
use crate::mesh::shape::ElementKind;
use crate::mesh::{Group, Mesh};
use crate::model::{Model, PointMass, Step};
use crate::output::warnings::several_answers;
use crate::time::step_size::EVENT_LOCATION;

/// A readable account of a checked case.
pub fn report(case: &Case, model: &Model) -> String {
    let mut warnings = start::warnings(case, model);
    warnings.extend(model.contacts.iter().filter_map(pressed_too_hard));
    let mut text = String::new();
    if !model.title.is_empty() {
        text += &format!("{}\n\n", model.title);
    }
    section(&mut text, "units", case.units.iter().map(|(of, unit)| format!("{of} in {unit}")).collect());
    section(&mut text, "mesh", mesh(case, model));
    section(&mut text, "groups", groups(model));
    section(&mut text, "bodies", bodies(case));
    section(&mut text, "periodic", periodic(case, model));
    section(&mut text, "points", point_masses(case, model));
    section(&mut text, "contacts", contacts(case, model));
    section(&mut text, "steps", steps(case, model));
    section(&mut text, "newton", vec![newton(case)]);
    section(&mut text, "output", output(case));
    section(&mut text, "warnings", if warnings.is_empty() { vec!["none".into()] } else { warnings });
    text
}

/// Lines behind a heading in the margin; nothing if there are none.
fn section(text: &mut String, heading: &str, lines: Vec<String>) {
    for (k, line) in lines.iter().enumerate() {
        let heading = if k == 0 { heading } else { "" };
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{heading:<10}{line}");
    }
}

/// Rows with their cells padded to the width of the widest in their column.
fn aligned(rows: &[[String; 2]]) -> Vec<String> {
    let width = rows.iter().map(|[name, _]| name.chars().count()).max().unwrap_or(0);
    rows.iter().map(|[name, rest]| format!("{name:<width$}  {rest}")).collect()
}

/// A number with at most six digits, in powers of ten where it is very large or small.
pub(super) fn number(value: f64) -> String {
    let rounded = format!("{value:.5e}").parse().unwrap_or(value);
    match rounded {
        0.0 => "0".into(),
        value if (1e-3..1e5).contains(&f64::abs(value)) => format!("{value}"),
        value => format!("{value:e}"),
    }
}

pub(super) fn count(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

fn mesh(case: &Case, model: &Model) -> Vec<String> {
    let source = match &case.mesh {
        MeshSource::File(file) => file.as_str(),
        MeshSource::Inline(_) => "given in the case file",
    };
    let mut kinds: Vec<(ElementKind, usize)> = Vec::new();
    for element in &model.mesh.elements {
        match kinds.iter_mut().find(|(kind, _)| *kind == element.kind) {
            Some((_, count)) => *count += 1,
            None => kinds.push((element.kind, 1)),
        }
    }
    let kinds: Vec<String> = kinds.iter().map(|(kind, count)| format!("{count} {kind:?}")).collect();
    let [low, high] = model.mesh.bounding_box();
    let [x0, x1, y0, y1] = [low.x, high.x, low.y, high.y].map(number);
    vec![
        source.into(),
        format!(
            "{}, {}{}, {}",
            count(model.mesh.nodes.len(), "node"),
            count(model.mesh.elements.len(), "element"),
            if kinds.is_empty() { String::new() } else { format!(" ({})", kinds.join(", ")) },
            count(model.dofs(), "dof")
        ),
        format!("x from {x0} to {x1}, y from {y0} to {y1}"),
    ]
}

fn groups(model: &Model) -> Vec<String> {
    let size = |group: &Group| match group {
        Group::Elements(elements) => count(elements.len(), "element"),
        Group::Edges(edges) => count(edges.len(), "edge"),
        Group::Nodes(nodes) => count(nodes.len(), "point"),
    };
    aligned(&model.mesh.groups.iter().map(|(name, group)| [name.clone(), size(group)]).collect::<Vec<_>>())
}

fn bodies(case: &Case) -> Vec<String> {
    let row = |(name, input): (&String, &BodyInput)| {
        let f_bar = if input.element == Formulation::FBar { ", f_bar elements" } else { "" };
        let DampingInput { mass, stiffness } = input.damping;
        let damping = match mass > 0.0 || stiffness > 0.0 {
            true => format!(", damping: mass {}, stiffness {}", number(mass), number(stiffness)),
            false => String::new(),
        };
        [name.clone(), format!("{}{f_bar}{damping}", parameters(&input.material, "model", &[]))]
    };
    let mut lines = aligned(&case.bodies.iter().map(row).collect::<Vec<_>>());
    for (name, [vx, vy]) in &case.initial_velocity {
        lines.push(format!("{name} starts with the velocity ({}, {})", number(*vx), number(*vy)));
    }
    lines
}

fn periodic(case: &Case, model: &Model) -> Vec<String> {
    let mut lines: Vec<String> = case.periodic.iter().map(|[a, b]| format!("{a} and {b}")).collect();
    if !lines.is_empty() {
        lines.push(format!("{} tied", count(model.ties.pairs().len(), "node")));
    }
    lines
}

fn point_masses(case: &Case, model: &Model) -> Vec<String> {
    let row = |point: &PointMass| {
        let velocity = case.point_masses[&point.name].velocity;
        let start = velocity.map(|[vx, vy]| format!(", starts with the velocity ({}, {})", number(vx), number(vy)));
        let mass = format!("mass {} at {}", number(point.mass), count(point.nodes.len(), "node"));
        [point.name.clone(), mass + &start.unwrap_or_default()]
    };
    aligned(&model.point_masses.iter().map(row).collect::<Vec<_>>())
}

/// The law named by `tag`, and its parameters but those in `skip`.
fn parameters(law: &impl Serialize, tag: &str, skip: &[&str]) -> String {
    let Ok(Value::Object(fields)) = serde_json::to_value(law) else { return String::new() };
    let name = fields.get(tag).and_then(Value::as_str).unwrap_or_default();
    let shown = fields.iter().filter(|(key, value)| *key != tag && !skip.contains(&key.as_str()) && !value.is_null());
    let shown: Vec<String> = shown.map(|(key, value)| format!("{key} {}", plain(value))).collect();
    if shown.is_empty() { name.into() } else { format!("{name}: {}", shown.join(", ")) }
}

fn plain(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        value => value.as_f64().map_or_else(|| value.to_string(), number),
    }
}

fn contacts(case: &Case, model: &Model) -> Vec<String> {
    let mut lines = Vec::new();
    for pair in &model.contacts {
        lines.push(pair.name.clone());
        lines.extend(contact(case, &model.mesh, pair).into_iter().map(|line| format!("  {line}")));
        let start = match &case.contacts[&pair.name].initial {
            Some(initial) => initial_tractions(initial, pair),
            None => start::gaps(model, pair, &case.contacts[&pair.name]),
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
fn pressed_too_hard(pair: &ContactPair) -> Option<String> {
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

fn contact(case: &Case, mesh: &Mesh, pair: &ContactPair) -> Vec<String> {
    let input = &case.contacts[&pair.name];
    let master = match &input.master {
        MasterInput::Group(_) if input.is_own() => "itself".into(),
        MasterInput::Group(group) => group.clone(),
        MasterInput::Rigid(rigid) => {
            let pair = |v: [f64; 2]| v.map(number).join(", ");
            match rigid {
                RigidInput::Plane(PlaneInput { point, normal }) => {
                    format!("the rigid plane through ({}) with the normal ({})", pair(*point), pair(*normal))
                }
                RigidInput::Circle(CircleInput { centre, radius, hole }) => {
                    let kind = if *hole { "hole" } else { "disk" };
                    format!("the rigid {kind} of radius {} about ({})", number(*radius), pair(*centre))
                }
                RigidInput::Polyline(PolylineInput { points }) => {
                    format!("the rigid polyline through {}", count(points.len(), "point"))
                }
            }
        }
    };
    let where_evaluated = match input {
        ContactInput { area: Some(area), .. } => format!("each point stands for the area {}", number(*area)),
        _ => {
            let Chosen { method, points, because, .. } = choose(input, mesh);
            let how = match method {
                Method::GaussToSegment => format!("{points} points an edge"),
                Method::NodeToSegment => "a point at each node".into(),
                Method::Mortar => "averaged around each node".into(),
            };
            let because = because.map_or(String::new(), |because| format!(" ({because})"));
            format!("{}, {how}{because}", method.name())
        }
    };
    let alpha_n = match input.normal.alpha_n {
        Some(_) => "given",
        None => "10 (λ + 2G)/h: of the softer side, over the depth of the slave's elements",
    };
    let mut lines = vec![
        format!("slave {} against master {master}", input.slave),
        format!("{where_evaluated}: {}", count(pair.points.len(), "contact point")),
        format!("alpha_n {} ({alpha_n})", number(pair.alpha_n)),
    ];
    if input.massless {
        lines.push("the slave's nodes carry no mass in dynamic steps".into());
    }
    if let Some(given) = input.gives_alpha_t() {
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

fn steps(case: &Case, model: &Model) -> Vec<String> {
    let mut lines = Vec::new();
    let (mut supports, mut loads) = (InForce::new(), InForce::new());
    for (step, input) in model.steps.iter().zip(&case.steps) {
        lines.push(step.name.clone());
        let mut told = step_lines(step);
        let freed = if step.scheme.is_dynamic() { "at once" } else { "its reaction fades over the step" };
        told.extend(supports.step(written_supports(input)).map(|(on, kind)| format!("freed {on}: {kind}, {freed}")));
        told.extend(loads.step(input.loads.iter().map(written_load)).map(|(on, kind)| {
            let ended = if ENDS_AT_ONCE.contains(&kind) { "at once" } else { "it fades over the step" };
            format!("ended {on}: {kind}, {ended}")
        }));
        told.extend(supports.lines("held").into_iter().chain(loads.lines("loaded")));
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

/// What is in force in a step, by place and kind, as it was last written; `null` ends it.
struct InForce(BTreeMap<(String, &'static str), Written>);

struct Written {
    text: String,
    kept: bool,
}

/// Loads without a value that could fade.
const ENDS_AT_ONCE: [&str; 3] = ["spring", "dashpot", "absorbing side"];

/// Place, kind and value of one entry of a step.
type Entry = (String, &'static str, Option<String>);

impl InForce {
    fn new() -> Self {
        Self(BTreeMap::new())
    }

    /// Take over what is written; returns what is ended.
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

    fn lines(&self, verb: &str) -> Vec<String> {
        let kept = |written: &Written| if written.kept { " (kept)" } else { "" };
        let line = |((on, kind), written): (&(String, &str), &Written)| {
            format!("{verb} {on}: {kind} {}{}", written.text, kept(written))
        };
        self.0.iter().map(line).collect()
    }
}

fn written_supports(step: &StepInput) -> Vec<Entry> {
    let mut entries: Vec<Entry> = Vec::new();
    for support in &step.supports {
        let mut add = |kind, text| entries.push((support.on.to_string(), kind, text));
        for (kind, given) in [("ux", &support.ux), ("uy", &support.uy)] {
            if let Some(given) = given {
                add(kind, given.as_ref().map(drive));
            }
        }
        if let Some(given) = &support.rotation {
            let turning = |about: [f64; 2], angle| format!("{angle} about ({})", about.map(number).join(", "));
            add("rotation", given.as_ref().map(|given| turning(given.about, drive(&given.angle))));
        }
    }
    entries
}

fn written_load(load: &LoadInput) -> Entry {
    let LoadInput { on, pressure, traction, gravity, force, spring, dashpot, absorbing } = load;
    let (kind, text) = if let Some(pressure) = pressure {
        ("pressure", pressure.as_ref().map(drive))
    } else if let Some(absorbing) = absorbing {
        ("absorbing side", absorbing.then(|| "rho c_p and rho c_s of its body".into()))
    } else if let Some(spring) = spring {
        let stiffness = |SpringInput { kx, ky, driver }: &SpringInput| {
            format!("kx {}, ky {}{}", number(*kx), number(*ky), driven("moved by", driver))
        };
        ("spring", spring.as_ref().map(stiffness))
    } else if let Some(dashpot) = dashpot {
        let coefficients = |DashpotInput { cx, cy, driver }: &DashpotInput| {
            format!("cx {}, cy {}{}", number(*cx), number(*cy), driven("moving with", driver))
        };
        ("dashpot", dashpot.as_ref().map(coefficients))
    } else if let Some(traction) = traction {
        ("traction", traction.as_ref().map(components))
    } else if let Some(gravity) = gravity {
        ("gravity", gravity.as_ref().map(components))
    } else {
        ("force", force.as_ref().and_then(Option::as_ref).map(components))
    };
    (on.to_string(), kind, text)
}

fn driven(how: &str, driver: &Option<Components>) -> String {
    driver.as_ref().map_or(String::new(), |driver| format!(", its far end {how} {}", components(driver)))
}

fn components(of: &Components) -> String {
    let part = |part: &Option<DriveInput>| part.as_ref().map_or("0".into(), drive);
    format!("({}, {})", part(&of.x), part(&of.y))
}

fn drive(drive: &DriveInput) -> String {
    match drive {
        DriveInput::Constant(value) => number(*value),
        DriveInput::Expression(text) => format!("\"{text}\""),
        DriveInput::InTime(TimeInput::Rate(rate)) => format!("at the rate {}", number(*rate)),
        DriveInput::InTime(TimeInput::Table(table)) => format!("by a table of {}", count(table.len(), "time")),
    }
}

fn newton(case: &Case) -> String {
    let newton = case.newton;
    format!("tolerance {}, at most {}", number(newton.tolerance), count(newton.max_iterations, "iteration"))
}

fn output(case: &Case) -> Vec<String> {
    let fields = match (case.output.fields, case.output.every) {
        (false, _) => "no fields".into(),
        (true, 1) => "fields with every row of the history".into(),
        (true, every) => format!("fields with every {every}th row of the history, and at the end of each step"),
    };
    let watched = if case.watch.is_empty() { "no group".into() } else { case.watch.join(", ") };
    let mut lines = vec![format!("history watches {watched}"), fields];
    if let Some(interval) = case.output.interval {
        lines.push(format!("explicit steps write at multiples of {}", number(interval)));
    }
    if let Some(fronts) = case.output.fronts {
        lines.push(format!("slip map, and fronts at the slip rate {}", number(fronts.slip_rate)));
    }
    lines
}
