//! Initial state of a run: velocities of bodies and point masses, and contacts that start closed.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Matrix2, Vector2};

use super::body::PointMassInput;
use super::contact::{Contact, InitialTractions};
use super::error::{Checked, ModelError, check_finite, check_place, refuse_if};
use super::friction::{check_profile, defined, position};
use super::groups;
use super::load_step::LoadStep;
use crate::contact::pair::{ContactPair, InitialTraction};
use crate::contact::pores::effective;
use crate::contact::surface::SlavePoint;
use crate::laws::bulk::CauchyStress;
use crate::mesh::Group;
use crate::model::Model;
use crate::model::boundary::Profile;
use crate::model::scheme::Scheme;
use crate::model::text::{distinct, number, vector};

/// Fraction by which an initial traction may exceed the strength μ p: numbers are written with a few digits.
const WRITTEN: f64 = 1e-6;

/// Round-off of tractions that follow from stresses, relative to the largest.
const ROUNDED: f64 = 1e-9;

/// Returns the initial velocity of every dof, from those of bodies and of point masses [L/T].
pub fn velocities(
    of_bodies: &[(String, [f64; 2])],
    masses: &[(String, PointMassInput)],
    model: &Model,
) -> Checked<Vec<f64>> {
    check_velocities("initial_velocity", of_bodies.iter().map(|(name, value)| (name, value)), model)?;
    let mut given = Given { velocity: vec![None; model.mesh.nodes.len()], model };
    for (name, value) in of_bodies {
        let place = format!("initial_velocity.{name}");
        let body = groups::body(model, name, &place)?;
        given.give(place, &model.bodies[body].nodes, *value)?;
    }
    for (point, (_, mass)) in model.point_masses.iter().zip(masses) {
        if let Some(value) = mass.velocity {
            given.give(format!("point_masses.{}.velocity", point.name), &point.nodes, value)?;
        }
    }
    let velocity: Vec<[f64; 2]> = given.velocity.into_iter().map(Option::unwrap_or_default).collect();
    tied("initial_velocity", &velocity, model)?;
    Ok(velocity.into_iter().flatten().collect())
}

/// Returns the velocities assigned to nodes at the start of a step [L/T].
pub fn launch(step: &LoadStep, scheme: Scheme, place: &str, model: &Model) -> Checked<Vec<(usize, [f64; 2])>> {
    let place = format!("{place}.velocity");
    let message = "is for dynamic and explicit steps: a static one has no velocities";
    refuse_if(!step.velocity.is_empty() && !scheme.is_dynamic(), &place, message)?;
    check_velocities(&place, &step.velocity, model)?;
    let mut given = Given { velocity: vec![None; model.mesh.nodes.len()], model };
    for (name, value) in &step.velocity {
        let place = format!("{place}.{name}");
        let (body, masses) = groups::bodies_and_masses(model, name, "", &place)?;
        let nodes = body.map(|body| &body.nodes).or(masses.map(|masses| &masses.nodes));
        given.give(place, nodes.map_or(&[], Vec::as_slice), *value)?;
    }
    tied(&place, &given.velocity, model)?;
    Ok(given.velocity.into_iter().enumerate().filter_map(|(node, velocity)| Some((node, velocity?))).collect())
}

/// Refuses radial initial velocities in axisymmetry.
fn check_velocities<'v>(
    place: &str,
    given: impl IntoIterator<Item = (&'v String, &'v [f64; 2])>,
    model: &Model,
) -> Checked<()> {
    let message = "x is the radius of axisymmetric bodies, along which they cannot move as a whole: give [0, vy]";
    let fails = |velocity: &[f64; 2]| velocity[0] != 0.0 && model.mesh.section.is_axisymmetric();
    let mut given = given.into_iter();
    given.try_for_each(|(name, velocity)| refuse_if(fails(velocity), format!("{place}.{name}"), message))
}

/// Velocities assigned to nodes so far.
struct Given<'m> {
    velocity: Vec<Option<[f64; 2]>>,
    model: &'m Model,
}

impl Given<'_> {
    fn give(&mut self, place: String, nodes: &[usize], value: [f64; 2]) -> Checked<()> {
        check_finite(&place, value)?;
        for &node in nodes {
            let earlier = self.velocity[node].replace(value).filter(|earlier| *earlier != value);
            if let Some([x, y]) = earlier {
                let tag = self.model.mesh.node_tags[node];
                let message =
                    format!("node {tag} starts with the velocity [{x}, {y}] already: a node can have one only");
                return Err(ModelError::new(place, message));
            }
        }
        Ok(())
    }
}

/// Checks that tied nodes have equal initial velocities.
fn tied<V: PartialEq>(place: &str, velocity: &[V], model: &Model) -> Checked<()> {
    let followers = model.linkage.followers.iter().map(|follower| (follower.node, follower.leaders[0].0));
    let rigid = model.linkage.rigid.iter().map(|&[a, b]| (b, a));
    let pairs: Vec<(usize, usize)> = model.ties.pairs().iter().copied().chain(followers).chain(rigid).collect();
    let differ = |&&(copy, original): &&(usize, usize)| velocity[copy] != velocity[original];
    let Some((copy, original)) = pairs.iter().find(differ) else { return Ok(()) };
    let [a, b] = [copy, original].map(|node| model.mesh.node_tags[*node]);
    let message =
        format!("nodes {a} and {b} of periodic sides or a plate start with different velocities: give them the same");
    Err(ModelError::new(place, message))
}

/// Sets the initial state of the surfaces: as in the mesh, closed, with a given gap, or with an overlap to be fitted.
pub fn start(pair: &mut ContactPair, contact: &Contact, model: &Model, place: &str) -> Checked<()> {
    if let Some(initial) = contact.initial.as_ref().filter(|_| pair.comes_stressed) {
        check_of_bodies(initial, contact, &format!("{place}.initial"))?;
    } else if let Some(initial) = &contact.initial {
        close(pair, initial, &contact.slave, model, &format!("{place}.initial"))?;
    }
    for (key, given) in [("shrink_fit", contact.shrink_fit), ("clearance", contact.clearance.is_some())] {
        let message = "has no meaning together with `initial`, which closes every gap and overlap: leave one out";
        refuse_if(given && contact.initial.is_some(), format!("{place}.{key}"), message)?;
    }
    if let Some(gap) = contact.clearance {
        let message = "is for two surfaces, and here one touches itself: leave it out";
        refuse_if(contact.is_own(), format!("{place}.clearance"), message)?;
        check_place(&format!("{place}.clearance"), [gap])?;
        pair.start_at_gap(gap, &model.mesh.undeformed());
    }
    if contact.shrink_fit {
        pair.start_fitting(&model.mesh.undeformed());
    }
    Ok(())
}

/// Starts a contact closed, if its tractions and its law permit it.
fn close(pair: &mut ContactPair, given: &InitialTractions, slave: &str, model: &Model, place: &str) -> Checked<()> {
    let initial = match given.of_bodies {
        true => of_bodies(pair, given, slave, model, place)?,
        false => as_given(pair, given, model, place)?,
    };
    let undeformed = model.mesh.undeformed();
    for (k, (point, InitialTraction { pressure: total, traction })) in pair.points.iter().zip(&initial).enumerate() {
        let law = pair.law(point);
        let pressure = effective(*total, pair.pore_pressure(k, &undeformed))[0];
        let limit = law.starting_limit(pressure);
        if traction.abs() > limit * (1.0 + WRITTEN) {
            let mu = law.observe("mu", &law.law.initial_state(0.0, 0.0));
            let [is, limit] = distinct([traction.abs(), limit]);
            let adjacent = if law.description.bond > 0.0 { "bond.strength + " } else { "" };
            let message = format!(
                "is {}{is} at {}: it exceeds the initial strength, {adjacent}mu p = {limit} with mu = {mu} and p = {}",
                sign(*traction),
                vector(position(point, &model.mesh)),
                number(pressure)
            );
            return Err(ModelError::new(format!("{place}.traction"), message));
        }
    }
    let closed = pair.start_closed(initial, &undeformed);
    closed.map_err(|point| without_projection(pair, point, model, place))
}

fn sign(value: f64) -> &'static str {
    if value < 0.0 { "-" } else { "" }
}

/// Refuses initial tractions above the strength where the first step is static: what the interface cannot carry accelerates the bodies.
pub fn check_excess(model: &Model) -> Checked<()> {
    let undeformed = model.mesh.undeformed();
    for pair in &model.contacts {
        let Some(first) = model.steps.iter().find(|step| step.joins(pair)) else { continue };
        let has_inertia = first.scheme.is_dynamic() || first.may_be_explicit();
        let initial = pair.initial.as_deref().filter(|_| !has_inertia && !pair.tied).unwrap_or_default();
        for (k, (point, InitialTraction { pressure: total, traction })) in pair.points.iter().zip(initial).enumerate() {
            let Some([cohesion, mu]) = pair.law(point).description.released_above else { continue };
            let pressure = effective(*total, pair.pore_pressure(k, &undeformed))[0];
            let strength = cohesion + mu * pressure;
            if traction.abs() > strength * (1.0 + WRITTEN) {
                let [is, strength] = distinct([traction.abs(), strength]);
                let message = format!(
                    "is {}{is} at {}: it exceeds the initial strength, {strength} under the pressure {}, which a static step cannot follow; lower it, \
                     or begin with a dynamic or explicit step, or one with `rupture`",
                    sign(*traction),
                    vector(position(point, &model.mesh)),
                    number(pressure)
                );
                return Err(ModelError::new(format!("contacts.{}.initial.traction", pair.name), message));
            }
        }
    }
    Ok(())
}

/// Lets a tie carry the initial stress of the bodies of its slave, if they have any.
pub fn carry(pair: &mut ContactPair, slave: &str, model: &Model) {
    let Some(Group::Edges(edges)) = model.mesh.groups.get(slave) else { return };
    let mut bodies: BTreeMap<usize, BTreeSet<usize>> = BTreeMap::new();
    for (edge, &node) in edges.iter().flat_map(|edge| edge.nodes.iter().map(move |node| (edge, node))) {
        bodies.entry(node).or_default().insert(model.body_of_element[edge.element]);
    }
    if !bodies.values().flatten().any(|&body| model.bodies[body].is_stressed()) {
        return;
    }
    let x = model.mesh.undeformed();
    let stress = |point: &SlavePoint| {
        // An edge belongs to one body, its ends perhaps to two.
        let sides: Vec<_> = point.position.iter().filter_map(|(node, _)| bodies.get(node)).collect();
        let body =
            sides.first().and_then(|first| first.iter().find(|body| sides.iter().all(|side| side.contains(body))));
        let total = |&body: &usize| model.bodies[body].total_stress(point.at(&x), model.mesh.section.is_plate());
        let CauchyStress { xx, yy, xy, .. } = body.and_then(total).unwrap_or_default();
        Matrix2::new(xx, xy, xy, yy)
    };
    pair.carry(stress, &x);
}

fn without_projection(pair: &ContactPair, point: usize, model: &Model, place: &str) -> ModelError {
    let at = pair.points[point].at(&model.mesh.undeformed());
    let message =
        format!("the slave point at ({}, {}) has no projection on the master: it cannot carry a pressure", at.x, at.y);
    ModelError::new(place, message)
}

fn as_given(pair: &ContactPair, given: &InitialTractions, model: &Model, place: &str) -> Checked<Vec<InitialTraction>> {
    let [at_pressure, at_traction] = ["pressure", "traction"].map(|key| format!("{place}.{key}"));
    let Some(pressures) = &given.pressure else {
        return Err(ModelError::new(at_pressure, "is missing: give it, or \"of_bodies\": true"));
    };
    let tractions = given.traction.clone().unwrap_or_default();
    check_profile(pressures, &at_pressure)?;
    check_profile(&tractions, &at_traction)?;
    let undeformed = model.mesh.undeformed();
    let mut initial = Vec::with_capacity(pair.points.len());
    for (k, point) in pair.points.iter().enumerate() {
        // A point that stands for an edge takes its mean, so that the resultant is that of the profile.
        let mean = |profile: &Profile, place: &str| -> Checked<f64> {
            let at = position(point, &model.mesh);
            defined(profile, at, place)?;
            let mean = point.mean(|at| profile.value(at), &undeformed);
            let message = || format!("is not a finite number around ({}, {})", at.x, at.y);
            if mean.is_finite() { Ok(mean) } else { Err(ModelError::new(place, message())) }
        };
        let (pressure, traction) = (mean(pressures, &at_pressure)?, mean(&tractions, &at_traction)?);
        if pressure < 0.0 {
            let message = format!("is {pressure}: must be zero or positive, which is compression");
            return Err(ModelError::new(at_pressure, message));
        }
        let total = pressure + pair.pore_pressure(k, &undeformed);
        let message =
            format!("is {pressure}, {total} with the fluid in the pores, which contact cannot carry: raise it");
        refuse_if(total < 0.0, &at_pressure, message)?;
        initial.push(InitialTraction { pressure: total, traction });
    }
    Ok(initial)
}

/// Checks the initial tractions of a contact that comes later, under the stress in force by then.
fn check_of_bodies(given: &InitialTractions, contact: &Contact, place: &str) -> Checked<()> {
    check_alone(given, place)?;
    let message = "needs a slave of edges, behind which there is a stress: leave it out";
    refuse_if(contact.area.is_some(), format!("{place}.of_bodies"), message)
}

/// Checks that tractions that follow from the stress of bodies are not given besides.
fn check_alone(given: &InitialTractions, place: &str) -> Checked<()> {
    let others = [("pressure", &given.pressure), ("traction", &given.traction)];
    if let Some((key, _)) = others.iter().find(|(_, it)| it.is_some()) {
        let message = "has no meaning together with of_bodies: leave one out";
        return Err(ModelError::new(format!("{place}.{key}"), message));
    }
    let message = "counts the stress of the bodies, and balanced would count it again: leave one out";
    refuse_if(given.balanced, format!("{place}.of_bodies"), message)
}

/// Returns the tractions of the initial stress of the slave's body at the contact.
fn of_bodies(
    pair: &ContactPair,
    given: &InitialTractions,
    slave: &str,
    model: &Model,
    place: &str,
) -> Checked<Vec<InitialTraction>> {
    check_alone(given, place)?;
    let place = format!("{place}.of_bodies");
    let refused = |message: String| Err(ModelError::new(place.clone(), message));
    let Some(Group::Edges(edges)) = model.mesh.groups.get(slave) else {
        return refused("needs a slave of edges: give pressure and traction".into());
    };
    let bodies: BTreeSet<usize> = edges.iter().map(|edge| model.body_of_element[edge.element]).collect();
    let body = bodies.first().map(|&body| &model.bodies[body]);
    let Some(body) = body.filter(|body| bodies.len() == 1 && body.is_stressed()) else {
        return refused(format!("needs a slave `{slave}` on one body, and that with an initial_stress"));
    };
    let tensor = |at: Vector2<f64>| {
        let CauchyStress { xx, yy, xy, .. } = body.total_stress(at, model.mesh.section.is_plate()).unwrap_or_default();
        Matrix2::new(xx, xy, xy, yy)
    };
    let found = pair.tractions_under(tensor, &model.mesh.undeformed());
    let largest = found.iter().flatten().map(|traction| traction.pressure).fold(0.0, f64::max);
    let mut initial = Vec::with_capacity(found.len());
    for (point, traction) in found.into_iter().enumerate() {
        let Some(InitialTraction { pressure, traction }) = traction else {
            return Err(without_projection(pair, point, model, &place));
        };
        if pressure < -ROUNDED * largest || largest == 0.0 && pressure < 0.0 {
            let at = position(&pair.points[point], &model.mesh);
            return refused(format!(
                "gives the pressure {pressure} at ({}, {}): the stress is tensile there, which contact cannot carry",
                at.x, at.y
            ));
        }
        // A shear stress within the round-off of the surface's direction is set to zero.
        let traction = if traction.abs() > ROUNDED * largest { traction } else { 0.0 };
        initial.push(InitialTraction { pressure: pressure.max(0.0), traction });
    }
    Ok(initial)
}

/// Lets the elements start under the initial stress of their bodies, which must be one that their laws can have.
pub fn start_under_stresses(model: &mut Model) -> Checked<()> {
    for e in 0..model.solids.len() {
        let body = model.body_of(e);
        let in_plate = model.mesh.section.is_plate();
        let law = body.material.description();
        let mut variables = vec![0.0; law.variables.len()];
        if body.initial_stress.is_none() && law.holds_initial_stress {
            body.material.begin(Vector2::zeros(), &CauchyStress::default(), &mut variables).map_err(|why| {
                let place = format!("bodies.{}.initial_stress", body.name);
                ModelError::new(place, format!("is missing, and the body {why}"))
            })?;
        }
        let mut total = Vec::new();
        for at in model.quadrature_positions(e) {
            total.extend(body.total_stress(at, in_plate));
            let Some(stress) = &body.initial_stress else { continue };
            let [xx, yy, xy, zz] = stress.at(at, in_plate);
            let stress = CauchyStress { xx, yy, zz, xy };
            body.material.begin(at, &stress, &mut variables).map_err(|why| {
                let place = format!("bodies.{}.initial_stress", body.name);
                ModelError::new(place, format!("at {} it {why}", vector(at)))
            })?;
        }
        model.solids[e].start_under(total.into_iter());
    }
    Ok(())
}

/// Nodal forces of the initial stress of the bodies that balance the initial tractions of contacts with `balanced`; empty if
/// there are none [F].
pub fn prestress(contacts: &[Contact], model: &Model) -> Vec<f64> {
    let balanced = |contact: &Contact| contact.initial.as_ref().is_some_and(|initial| initial.balanced);
    let mut forces = Vec::new();
    let undeformed = model.mesh.undeformed();
    for (pair, _) in model.contacts.iter().zip(contacts).filter(|(_, contact)| balanced(contact)) {
        forces.resize(model.dofs(), 0.0);
        for (node, force) in pair.initial_forces(&undeformed) {
            forces[2 * node] -= force.x;
            forces[2 * node + 1] -= force.y;
        }
    }
    forces
}
