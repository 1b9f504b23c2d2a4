//! What `check` prints: how the case was understood.

use std::fmt::Write;

use super::file::Case;
use crate::configuration::Configuration;
use crate::contact::surface::Master;
use crate::model::Model;

/// A readable account of a checked case.
pub fn report(case: &Case, model: &Model) -> String {
    let mut text = String::new();
    // Writing to a String cannot fail.
    let _ = write_report(&mut text, case, model);
    text
}

fn write_report(out: &mut String, case: &Case, model: &Model) -> std::fmt::Result {
    if !model.title.is_empty() {
        writeln!(out, "{}", model.title)?;
    }
    writeln!(out, "{} nodes, {} elements, {} dofs", model.mesh.nodes.len(), model.mesh.elements.len(), model.dofs())?;
    let [low, high] = model.mesh.bounding_box();
    writeln!(out, "x from {} to {}, y from {} to {}", low.x, high.x, low.y, high.y)?;
    let groups: Vec<&str> = model.mesh.groups.keys().map(String::as_str).collect();
    writeln!(out, "groups: {}", groups.join(", "))?;
    for body in &model.bodies {
        let input = &case.bodies[&body.name];
        writeln!(out, "body {}: {} elements, {}", body.name, body.elements.len(), json(&input.material))?;
    }
    for pair in &model.contacts {
        write_contact(out, pair, model, case)?;
    }
    for step in &model.steps {
        let increments = &step.increments;
        writeln!(
            out,
            "step {}: t = {} to {}, {}, increments {} ({} to {}), {} prescribed dofs",
            step.name,
            step.span.start,
            step.span.end,
            json(&step.scheme),
            increments.initial,
            increments.min,
            increments.max,
            step.supports.len(),
        )?;
    }
    Ok(())
}

fn write_contact(
    out: &mut String,
    pair: &crate::contact::pair::ContactPair,
    model: &Model,
    case: &Case,
) -> std::fmt::Result {
    let master = match &pair.master {
        Master::Mesh(surface) => format!("{} segments", surface.segments.len()),
        Master::Plane(plane) => format!("a rigid plane with normal ({:.6}, {:.6})", plane.normal.x, plane.normal.y),
    };
    let given = if case.contacts[&pair.name].normal.alpha_n.is_some() { "given" } else { "10 E/h" };
    writeln!(
        out,
        "contact {}: {} points against {master}, alpha_n = {:.6e} ({given}), alpha_t = {:.6e}, {}",
        pair.name,
        pair.points.len(),
        pair.alpha_n,
        pair.law.stiffness(),
        json(&case.contacts[&pair.name].friction),
    )?;
    if let Some(limit) = pair.law.uniqueness_limit() {
        writeln!(out, "  one answer as long as the pressure stays below {limit:.6e}")?;
    }
    let states = pair.initial_states(&Configuration::undeformed(&model.mesh.nodes));
    let gaps: Vec<f64> = states.iter().filter(|state| state.foot.is_some()).map(|state| state.gap).collect();
    let free = states.len() - gaps.len();
    match gaps.iter().copied().reduce(f64::min).zip(gaps.iter().copied().reduce(f64::max)) {
        Some((low, high)) => writeln!(out, "  initial gap from {low:.3e} to {high:.3e}")?,
        None => writeln!(out, "  warning: no point of the slave faces the master")?,
    }
    if free > 0 && !gaps.is_empty() {
        writeln!(out, "  {free} points face no part of the master")?;
    }
    let overlap = gaps.iter().fold(0.0f64, |m, g| m.max(-g));
    if overlap > 0.0 {
        writeln!(out, "  warning: initial overlap of {overlap:.3e}; it presses from the first increment on")?;
    }
    Ok(())
}

/// The parameters as they stand in the case.
fn json(parameters: &impl serde::Serialize) -> String {
    serde_json::to_string(parameters).unwrap_or_default()
}
