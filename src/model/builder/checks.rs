//! Checks of settings, and of combinations of features.
//!
//! Quasi-dynamic steps have requirements on the model.

use std::collections::{BTreeMap, BTreeSet};

use super::contact::Contact;
use super::error::{Checked, ModelError, check_positive, check_size, refuse_if};
use super::supports::axis;
use crate::contact::pair::ContactPair;
use crate::laws::friction::{Cohesion, PointLoad, RateLaw};
use crate::mesh::{Mesh, Section};
use crate::model::boundary::{Amplitude, Drive, Span};
use crate::model::support::{Inclined, Motion, Prescribed};
use crate::model::text::{number, vector};
use crate::model::{Body, Model, NewtonSettings, Step};

/// Maximum accepted limit of Newton iterations.
const MOST_ITERATIONS: usize = 1000;

/// Largest accepted tolerance; a larger one would leave residual forces visible in the results.
const LOOSEST: f64 = 1e-2;

/// Checks the stopping criteria of Newton's method.
pub fn checked_newton(newton: NewtonSettings) -> Checked<NewtonSettings> {
    let message = format!(
        "is {}: must be above 0 and at most {LOOSEST}, the fraction of the forces that may be out of balance (1e-8 \
         is the default)",
        newton.tolerance
    );
    refuse_if(!(newton.tolerance > 0.0 && newton.tolerance <= LOOSEST), "newton.tolerance", message)?;
    let message = format!("is {}: must be 1 to {MOST_ITERATIONS}", newton.max_iterations);
    refuse_if(!(1..=MOST_ITERATIONS).contains(&newton.max_iterations), "newton.max_iterations", message)?;
    Ok(newton)
}

/// Checks that a thickness is positive and axisymmetric bodies do not cross the axis.
pub fn check_section(mesh: &Mesh) -> Checked<()> {
    match mesh.section {
        Section::PlaneStress { thickness } => {
            check_positive("section.plane_stress.thickness", thickness, "")?;
            check_size("section.plane_stress", "thickness", thickness)
        }
        Section::Axisymmetric => {
            let near = axis(mesh);
            let Some(node) = (0..mesh.nodes.len()).find(|&node| mesh.nodes[node].x < -near[node]) else {
                return Ok(());
            };
            let (tag, at) = (mesh.node_tags[node], mesh.nodes[node]);
            let message = format!(
                "is axisymmetric about x = 0, and node {tag} lies at x = {}: x is the radius, so move the mesh to x >= 0 and \
                 model one side of the axis",
                number(at.x)
            );
            Err(ModelError::new("section", message))
        }
        Section::PlaneStrain | Section::Graded { .. } => Ok(()),
    }
}

/// Checks combinations of schemes and contact: explicit steps solve no equations, and can neither augment pressures nor
/// determine the position of massless nodes. In Wilson-θ, equilibrium and its multipliers lie beyond the increment.
pub fn check_schemes(contacts: &[Contact], model: &Model) -> Checked<()> {
    let augmented = model.contacts.iter().find_map(|pair| match (pair.penetration, pair.stick) {
        (Some(_), _) => Some((&pair.name, "normal.penetration", "alpha_n")),
        (None, Some(_)) => Some((&pair.name, "stick", "alpha_t")),
        (None, None) => None,
    });
    let refused =
        |name: &str, key: &str, message: String| Err(ModelError::new(format!("contacts.{name}.{key}"), message));
    if let (Some((name, key, _)), Some(step)) = (augmented, model.steps.iter().find(|step| step.scheme.theta() > 1.0)) {
        let message = format!(
            "the step `{}` solves for equilibrium beyond the end of its increments (Wilson-θ), where multipliers have \
             no meaning: leave it out, or take another scheme",
            step.name
        );
        return refused(name, key, message);
    }
    let flowing = model.contacts.iter().find(|pair| pair.conduit.is_some());
    if let (Some(pair), Some(step)) = (flowing, model.steps.iter().find(|step| step.scheme.theta() > 1.0)) {
        let message = format!(
            "is not for the step `{}`, which solves for equilibrium beyond the end of its increments (Wilson-θ): take another scheme",
            step.name
        );
        return refused(&pair.name, "fluid_pressure.flow", message);
    }
    let Some(Step { name: step, .. }) = model.steps.iter().find(|step| step.may_be_explicit()) else { return Ok(()) };
    if let Some(contact) = contacts.iter().find(|contact| contact.massless) {
        let message = format!("the explicit step `{step}` needs the mass of every node: leave it out");
        return refused(&contact.name, "massless", message);
    }
    let Some((name, key, stiffness)) = augmented else { return Ok(()) };
    refused(
        name,
        key,
        format!("the explicit step `{step}` takes the plain penalty: leave it out, and raise {stiffness}"),
    )
}

/// Checks the requirements of quasi-dynamic steps: linear bodies, small sliding with matching nodes, and time functions that are linear within a step.
pub fn check_quasi_dynamic(model: &Model) -> Checked<()> {
    let steps = model.steps.iter().enumerate();
    for (k, step) in steps.filter(|(_, step)| step.scheme.is_quasi_dynamic()) {
        let place = format!("steps[{k}]");
        let scheme = format!("{place}.scheme");
        let message = "quasi_dynamic integrates the slip of contacts, and there is none";
        refuse_if(model.contacts.is_empty(), &scheme, message)?;
        if let Some(body) = model.bodies.iter().find(|body| !body.material.description().is_linear) {
            let message =
                format!("quasi_dynamic takes linear bodies, and `{}` is not: take material linear", body.name);
            return Err(ModelError::new(scheme, message));
        }
        if let Some(body) = model.bodies.iter().find(|body| body.is_imposed()) {
            let key = match body {
                Body { initial_stress: Some(_), .. } => "initial_stress",
                Body { pore_fluid: Some(_), .. } => "pore_fluid",
                Body { pore_pressure: Some(_), .. } => "pore_pressure",
                _ => "thermal",
            };
            let message = "is not for quasi_dynamic steps: leave it out, and give the tractions of the contacts (initial, \
                           balanced), on top of whose stress the run counts";
            return Err(ModelError::new(format!("bodies.{}.{key}", body.name), message));
        }
        let message = "are not for quasi_dynamic steps: drive the side by supports";
        refuse_if(!(model.plates.is_empty() && model.linkage.is_empty()), "plates", message)?;
        if let Some(bar) = model.bars.first() {
            let message = "is not for quasi_dynamic steps: take static steps with radiation_damping";
            return Err(ModelError::new(format!("bars.{}", bar.name), message));
        }
        if let Some(body) = model.mesh.rigid_bodies.first() {
            let message = "is not for quasi_dynamic steps: leave it out, and move the body by supports";
            return Err(ModelError::new(format!("rigid_bodies.{}", body.name), message));
        }
        model.contacts.iter().try_for_each(check_contact)?;
        check_implicit(model)?;
        check_nodes(model)?;
        check_supports(&place, step, model)?;
        check_loads(&place, step)?;
    }
    Ok(())
}

fn check_contact(pair: &ContactPair) -> Checked<()> {
    let refuse_if = |fails: bool, key: &str, why: &str| refuse_if(fails, format!("contacts.{}.{key}", pair.name), why);
    refuse_if(pair.small.is_none(), "sliding", "is finite, and quasi_dynamic steps need small")?;
    let why = "is missing: without it slip in quasi_dynamic steps has no bound";
    refuse_if(pair.radiation == 0.0, "radiation_damping", why)?;
    let why = "is not for quasi_dynamic steps: leave it out, and raise alpha_n";
    refuse_if(pair.penetration.is_some(), "normal.penetration", why)?;
    let why = "comes from pores, whose bodies are not for quasi_dynamic steps: give it by place and time";
    refuse_if(pair.pores.is_some(), "fluid_pressure", why)?;
    let why = "is not for quasi_dynamic steps, which know no opening: leave it out, or take static steps with radiation_damping";
    let bonds = || pair.laws.iter().filter_map(|law| law.cohesion.as_ref()).map(Cohesion::bond);
    refuse_if(bonds().any(|bond| bond.tension() > 0.0), "bond.tension", why)?;
    refuse_if(bonds().any(|bond| bond.limit().is_finite()), "bond.limit", why)?;
    refuse_if(pair.fades.is_some_and(|fades| !fades.is_chosen), "bond.opening", why)?;
    let opening = pair.laws.iter().find_map(|law| law.description.opening.first());
    let key = if opening == Some(&"wear") { "wear" } else { "dilatancy" };
    let why = "is not for quasi_dynamic steps, which ignore changes of pressure: leave it out";
    refuse_if(opening.is_some(), key, why)?;
    Ok(())
}

/// Checks what the implicit integration of laws without a slip rate does not have.
fn check_implicit(model: &Model) -> Checked<()> {
    let mut laws = model.contacts.iter().flat_map(|pair| &pair.laws);
    if laws.all(|law| law.law.rates().is_some()) {
        return Ok(());
    }
    for pair in &model.contacts {
        let refuse_if =
            |fails: bool, key: &str, why: &str| refuse_if(fails, format!("contacts.{}.{key}", pair.name), why);
        let adjacent = pair.laws.iter().any(|law| matches!(law.cohesion, Some(Cohesion::Parallel(_))));
        let why = "in parallel with friction is for quasi_dynamic steps whose laws all have a slip rate (rate_and_state, prescribed): leave it out, \
                   or take static steps with radiation_damping";
        refuse_if(adjacent, "bond", why)?;
        let why = "of water that flows is for quasi_dynamic steps whose laws all have a slip rate (rate_and_state, prescribed): give it by \
                   place and time, or take static steps with radiation_damping";
        refuse_if(pair.conduit.is_some(), "fluid_pressure", why)?;
        let why = "is not for quasi_dynamic steps: leave it out, and raise alpha_t";
        refuse_if(pair.stick.is_some(), "stick", why)?;
    }
    Ok(())
}

/// Checks that every point is a node opposite a node or a rigid body, and that no node is used twice but where periodic sides meet.
fn check_nodes(model: &Model) -> Checked<()> {
    let mut seen: BTreeMap<usize, Partner> = BTreeMap::new();
    for (number, pair) in model.contacts.iter().enumerate() {
        let refused = |message: String| Err(ModelError::new(format!("contacts.{}", pair.name), message));
        let points = pair.points.iter().zip(pair.small.iter().flat_map(|small| &small.points)).enumerate();
        for (index, (slave, point)) in points {
            let tags = |nodes: &[usize]| -> String {
                let tags: BTreeSet<String> = nodes.iter().map(|&node| model.mesh.node_tags[node].to_string()).collect();
                tags.into_iter().collect::<Vec<_>>().join(", ")
            };
            let Some(point) = point else {
                let own: Vec<usize> = slave.position.iter().map(|(node, _)| *node).collect();
                return refused(format!(
                    "the slave node {} has no projection on the master, as quasi_dynamic steps need it",
                    tags(&own)
                ));
            };
            let Some((own, master)) = point.facing(|node| model.ties.original(node)) else {
                let across = pair.mortar.is_some() && point.nodes.iter().any(|&node| is_tied(model, node));
                let why = "averages by mortar reach across periodic sides: take method node_to_segment, which is the default of \
                           quasi_dynamic steps";
                refuse_if(across, format!("contacts.{}.method", pair.name), why)?;
                return refused(format!(
                    "nodes {} coincide: quasi_dynamic steps need a master node opposite every slave node (and method \
                     node_to_segment, which is the default)",
                    tags(&point.nodes)
                ));
            };
            let this = Partner { contact: number, faces: master, point: index };
            let periodic = match seen.get(&own) {
                Some(before) if before.contact == number && before.faces == master => Some(before.point),
                Some(_) => {
                    return refused(format!("node {} has two partners: quasi_dynamic steps need pairs", tags(&[own])));
                }
                None => None,
            };
            if let Some(other) = periodic {
                check_ends(model, pair, [other, index])?;
                continue;
            }
            let of_master = master.filter(|master| seen.insert(*master, this).is_some());
            if let Some(master) = of_master {
                return refused(format!("node {} has two partners: quasi_dynamic steps need pairs", tags(&[master])));
            }
            seen.insert(own, this);
        }
    }
    Ok(())
}

/// Whether periodic sides join a node with another.
fn is_tied(model: &Model, node: usize) -> bool {
    model.ties.pairs().iter().any(|(copy, original)| node == *copy || node == *original)
}

/// Use of a node at a contact.
#[derive(Clone, Copy)]
struct Partner {
    contact: usize,
    /// master node, none on a rigid body
    faces: Option<usize>,
    /// number of the point
    point: usize,
}

/// Relative difference up to which two ends of a contact that periodic sides join are alike [-].
const ALIKE: f64 = 1e-6;

/// Checks that two points that periodic sides join, which are one node with one slip, are under the same conditions.
fn check_ends(model: &Model, pair: &ContactPair, ends: [usize; 2]) -> Checked<()> {
    let x = model.mesh.undeformed();
    let states = pair.initial_states(&x);
    let alike = |[a, b]: [f64; 2]| (a - b).abs() <= ALIKE * a.abs().max(b.abs()) || a.is_nan() && b.is_nan();
    let of_laws = |time: f64| {
        let of = |k: usize| {
            let (slave, friction) = (&pair.points[k], &states[k].friction);
            let loading =
                PointLoad { traction: friction.traction, pressure: friction.pressure, damping: pair.radiation };
            let ask = |law: &dyn RateLaw| {
                let states = law.evolving(friction);
                let slip_rate = law.slip_rate(states, loading);
                [states, [slip_rate; 2], law.evolution(states, slip_rate), law.evolution(states, 2.0 * slip_rate)]
            };
            let stiffness = pair.law(slave).description.stiffness;
            let rates = pair.ask_law(slave, [time, time], |law| law.law.rates().map(ask)).ok().flatten();
            let rates = rates.unwrap_or([[f64::NAN; 2]; 4]);
            [rates.concat(), vec![stiffness, pair.fluid_pressure(slave, &x, time)]].concat()
        };
        let [one, other] = ends.map(of);
        one.into_iter().zip(other).all(|(a, b)| alike([a, b]))
    };
    let [one, other] = ends.map(|k| &states[k].friction);
    let starts = alike([one.pressure, other.pressure]) && alike([one.traction, other.traction]);
    let mut times = model.steps.iter().flat_map(|step| [step.span.start, step.span.end]);
    let [one, other] = ends.map(|k| vector(pair.points[k].at(&x)));
    let message = format!(
        "periodic sides make one node of {one} and {other}, and its friction, initial tractions or fluid_pressure are not the same at both: \
         let them be periodic too"
    );
    refuse_if(!(starts && times.all(of_laws)), format!("contacts.{}", pair.name), message)
}

/// Checks that supports vary linearly and constrain no node of a contact.
fn check_supports(place: &str, step: &Step, model: &Model) -> Checked<()> {
    let at_contacts: BTreeSet<usize> = model
        .contacts
        .iter()
        .flat_map(|pair| pair.small.iter().flat_map(|small| small.points.iter().flatten()))
        .flat_map(|point| point.nodes.iter().map(|&node| model.ties.original(node)))
        .collect();
    for Prescribed { at, motion } in &step.supports {
        let node = at.node();
        let refuse_if = |fails: bool, why: &str| {
            refuse_if(fails, format!("{place}.supports"), format_args!("node {}: {why}", model.mesh.node_tags[node]))
        };
        let why = "in quasi_dynamic steps no node of a contact is supported: let the supports end before it, and friction (law \
                   prescribed) say how it slips";
        refuse_if(at_contacts.contains(&node), why)?;
        let turns = matches!(motion, Motion::Rotation { .. });
        refuse_if(turns, "quasi_dynamic steps have no rotating supports")?;
        let is_even = match motion {
            Motion::Rotation { .. } => false,
            Motion::Displacement(drive, span) => is_even(drive, *span, step.span),
            Motion::Inclined(parts) => {
                parts.iter().all(|Inclined { drive, span, .. }| is_even(drive, *span, step.span))
            }
        };
        let why = "supports vary linearly within a quasi_dynamic step: give a value or a rate, and one step per kink";
        refuse_if(!is_even, why)?;
    }
    Ok(())
}

/// Checks that loads vary linearly and do not depend on rates or the deformation.
fn check_loads(place: &str, step: &Step) -> Checked<()> {
    let loads = &step.loads;
    let place = format!("{place}.loads");
    let why = "dashpots and absorbing sides are not for quasi_dynamic steps: end them by null";
    refuse_if(!(loads.dashpots.is_empty() && loads.absorbers.is_empty()), &place, why)?;
    let why =
        "pressures rotate with the surface, and are not for quasi_dynamic steps: take a dead_pressure or a traction";
    refuse_if(!loads.pressures.is_empty(), &place, why)?;
    let of_springs = loads.springs.iter().filter_map(|spring| spring.driver.as_ref());
    let mut amplitudes = loads.dead.iter().map(|load| &load.amplitude).chain(of_springs);
    let why = "loads vary linearly within a quasi_dynamic step: give a value or a rate, and one step per kink";
    refuse_if(amplitudes.any(|Amplitude { drive, span, .. }| !is_even(drive, *span, step.span)), place, why)
}

/// Whether a drive is linear in time within a step.
fn is_even(drive: &Drive, own: Span, step: Span) -> bool {
    match drive {
        Drive::Constant(_) | Drive::ByPlace(..) => own.end >= step.end || own.end <= step.start,
        Drive::Rate(_) => true,
        Drive::Table(table) => table.iter().all(|[time, _]| *time <= step.start || *time >= step.end),
        Drive::Expression(expression) => !expression.depends_on_time(),
    }
}
