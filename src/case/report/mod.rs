//! What `check` prints: how the case was understood.

mod contact;
mod parameters;
mod steps;

use std::fmt::Write;

use contact::{contacts, pressed_too_hard};
use parameters::parameters;
use steps::steps;

use super::file::{BodyInput, Case, DampingInput, Formulation, MeshSource};
use crate::mesh::Group;
use crate::mesh::shape::ElementKind;
use crate::model::told::{count, number};
use crate::model::{Model, PointMass};

/// A readable account of a checked case.
pub fn report(case: &Case, model: &Model) -> String {
    let mut warnings = model.warnings();
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
