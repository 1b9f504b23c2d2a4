//! Start of a step: prescribed initial velocities, and new accelerations where loads jump.
//!
//! ```text
//! M a₀ = −F₀ at the free dofs; a₀ of the supports at the prescribed ones, whose reaction is F₀ + M a₀               (1)
//! ```
//! Within a step no acceleration is recomputed: HHT, generalized-α and Wilson-θ carry an acceleration of another time, and lose
//! their order without it. Where loads, dampers or temperatures jump at the start of a step, (1) is solved for the affected
//! nodes and those coupled with them by the mass; all other nodes keep their acceleration.

use std::sync::Arc;

use super::accept::{heat, take_stock};
use super::increment::kinetic;
use crate::equations::supports::{constrain, tie, turn};
use crate::equations::{Trial, TrialFailure};
use crate::equations::{bars, contacts, links};
use crate::linear;
use crate::model::scheme::{Scheme, start_acceleration, start_velocity};
use crate::model::support::{Direction, Prescribed};
use crate::model::{Model, State, Step};
use crate::solve::{IncrementFailure, Workspace};

/// Starts a step: stores displacements and reactions, and computes the initial forces and accelerations of a run or of a
/// dynamic step.
///
/// # Errors
/// Returns [`IncrementFailure`] if the initial state cannot be evaluated or a body has no mass.
pub fn begin(model: &Model, step: &Step, old: &State, work: &mut Workspace) -> Result<State, IncrementFailure> {
    let mut state = old.clone();
    state.begin_step(&step.absent);
    // Explicit increments leave the forces on tied copies of nodes.
    model.ties.gather(2, &mut state.force);
    // The reaction of a released support has become a load.
    step.released.iter().for_each(|at| at.add(-at.of(&old.reaction), &mut state.force));
    if !step.changed.is_empty() || step.relaxes {
        change_bodies(model, step, &mut state, work)?;
    } else if !step.bars.changed.is_empty() {
        change_bars(model, step, &mut state);
    }
    launch(model, step, &mut state);
    if step.scheme.is_dynamic() {
        let dt = step.increments.initial;
        keep_to_supports(model, step, dt, &mut state);
        let is_new = rests(old) || old.is_of_explicit() || !step.launch.is_empty();
        let mut anew = if is_new { vec![true; model.mesh.nodes.len()] } else { jumps(step, old, &state, work)? };
        let nodes = step.changed.iter().flat_map(|&body| model.bodies[body].nodes.clone());
        let heavy = step.bars.changed.iter().filter(|bar| model.bars[**bar].mass > 0.0);
        let of_bars = heavy.flat_map(|&bar| model.bars[bar].nodes());
        nodes.chain(of_bars).for_each(|node| anew[model.ties.original(node)] = true);
        start_dynamics(model, step, anew, &mut state, work)?;
    } else {
        state.stop();
        if old.increment == 0 && model.starts_loaded() {
            start_loaded(step, &mut state, work)?;
        }
    }
    if state.increment == 0 {
        let kinetic = kinetic(step, &state, work);
        take_stock(model, kinetic, &mut state);
    } else if !step.launch.is_empty() || step.changes_anything() || old.is_of_explicit() {
        moves_anew(step, &mut state, work);
    }
    Ok(state)
}

/// Lets bodies come or go, or laws change, without a jump: what the forces change by fades over the step. Nodes that only absent bodies have come to
/// rest. The energy that bodies bring or take counts as external work, as does that of temperatures that jump with them.
fn change_bodies(model: &Model, step: &Step, state: &mut State, work: &mut Workspace) -> Result<(), IncrementFailure> {
    model.let_water_go(step, state);
    model.bear(step, state).map_err(|(e, share)| IncrementFailure::Start(TrialFailure::narrow(model, e, share)))?;
    model.forget(step, state);
    model.let_water_come(step, state);
    model.change_bars(step, state);
    let mut now = state.clone();
    evaluate_forces(step, &mut now, work)?;
    let mut fading: Vec<f64> = now.force.iter().zip(&state.force).map(|(new, old)| new - old).collect();
    // Water comes and goes at once.
    let of_water = model.flow.as_ref().map_or(Vec::new(), |flow| flow.nodes().collect());
    let idle_nodes = [model.idle_nodes(&step.absent), model.idle_bar_nodes(&step.bars.absent), of_water];
    for node in idle_nodes.into_iter().flatten() {
        let dofs = 2 * node..2 * node + 2;
        [&mut fading, &mut state.force, &mut state.reaction, &mut state.velocity, &mut state.acceleration]
            .into_iter()
            .for_each(|values| values[dofs.clone()].fill(0.0));
    }
    state.external = now.external.iter().zip(&fading).map(|(load, fading)| load + fading).collect();
    state.external.iter_mut().zip(&state.reaction).for_each(|(external, reaction)| *external += reaction);
    state.damping = now.damping;
    let evaluated = &work.assembler.evaluation.contacts;
    for ((pair, states), found) in model.contacts.iter().zip(&mut state.contacts).zip(evaluated) {
        if step.joins(pair) && step.changes(pair) {
            let slipped: Vec<f64> = states.iter().map(|state| state.friction.plastic_increment).collect();
            states.clone_from(found);
            // They were evaluated at rest; how fast they have slipped is what the first increment goes on from.
            states.iter_mut().zip(slipped).for_each(|(state, slip)| state.friction.plastic_increment = slip);
        }
    }
    let evaluation = &work.assembler.evaluation;
    let [strain, contact] =
        [evaluation.strain_energy, contacts::stored(model, &state.contacts) + bars::bonded(&state.bars)];
    let energy = &mut state.energy;
    energy.external_work += strain - energy.strain + contact - energy.contact_elastic;
    (energy.strain, energy.contact_elastic) = (strain, contact);
    if !step.temperatures.is_empty() {
        // Temperatures that jump here have acted, under the force that fades: the first increment goes on from them.
        state.memory.clone_from(&evaluation.memory);
        energy.external_work += evaluation.plastic + evaluation.dissipated;
        energy.plastic_dissipation += evaluation.plastic;
        energy.damping_dissipation += evaluation.dissipated;
    }
    Arc::make_mut(&mut state.step_start).fading = fading;
    Ok(())
}

/// Lets bars come or go without a jump, where no body does: those that come have no force, those that go leave theirs to fade over the
/// step, and with it the energy that they have stored.
fn change_bars(model: &Model, step: &Step, state: &mut State) {
    let mut fading = vec![0.0; model.dofs()];
    let mut part = Vec::new();
    for &k in step.bars.changed.iter().filter(|k| !step.bars.has(**k)) {
        let (bar, old) = (&model.bars[k], &state.bars[k]);
        bar.respond(old, &state.displacement, None, &[], |nodes, answer, vectors| {
            vectors.forces(answer, &mut part);
            for (node, force) in nodes.iter().zip(part.chunks_exact(2)) {
                (0..2).for_each(|i| fading[2 * node + i] -= force[i]);
            }
        });
        state.energy.external_work -= old.strain + old.bonded;
        state.energy.strain -= old.strain;
        state.energy.contact_elastic -= old.bonded;
    }
    model.ties.gather(2, &mut fading);
    model.linkage.gather(&mut fading);
    model.change_bars(step, state);
    for node in model.idle_bar_nodes(&step.bars.absent) {
        let dofs = 2 * node..2 * node + 2;
        [&mut fading, &mut state.force, &mut state.reaction, &mut state.velocity, &mut state.acceleration]
            .into_iter()
            .for_each(|values| values[dofs.clone()].fill(0.0));
    }
    state.external.iter_mut().zip(&fading).for_each(|(external, fading)| *external += fading);
    Arc::make_mut(&mut state.step_start).fading = fading;
}

/// Books changes of the kinetic energy by prescribed velocities, or by the end of mass lumping, as external work.
fn moves_anew(step: &Step, state: &mut State, work: &mut Workspace) {
    let kinetic = kinetic(step, state, work);
    state.energy.external_work += kinetic - state.energy.kinetic;
    state.energy.kinetic = kinetic;
}

/// Recomputes accelerations within a step if the caller has changed its loads or dampers or released a support, and only
/// then.
///
/// # Errors
/// The same as for [`begin`].
pub fn after_change(
    model: &Model,
    step: &Step,
    old: &State,
    work: &mut Workspace,
) -> Result<Option<State>, IncrementFailure> {
    if !step.scheme.is_dynamic() {
        return Ok(None);
    }
    let anew = jumps(step, old, old, work)?;
    if !anew.contains(&true) {
        return Ok(None);
    }
    let mut state = old.clone();
    start_dynamics(model, step, anew, &mut state, work)?;
    Ok(Some(state))
}

/// Gives supported dofs the velocity of their support if the run starts with initial velocities of bodies.
pub fn keep_to_supports(model: &Model, step: &Step, dt: f64, state: &mut State) {
    if state.increment > 0 {
        return;
    }
    let first = Trial::new(state, step, state.time + dt, dt);
    let own = |support: &Prescribed| {
        let (given, own) = (support.at.of(&state.velocity), start_velocity(first.thirds(support, model), dt));
        (given != 0.0 && (own - given).abs() > ROUNDED * given.abs()).then_some((support.at, own))
    };
    let constrained: Vec<(Direction, f64)> = step.supports.iter().filter_map(own).collect();
    if !constrained.is_empty() {
        constrained.into_iter().for_each(|(at, velocity)| at.set(velocity, &mut state.velocity));
        model.ties.spread(2, &mut state.velocity);
        links::stiffen_velocities(model, &state.displacement, &mut state.velocity);
    }
}

/// Sets the prescribed initial velocities of nodes at the start of a step, except where a support prescribes the motion.
pub fn launch(model: &Model, step: &Step, state: &mut State) {
    let inclined = step.supports.iter().map(|support| support.at).filter(|at| at.inclined.is_some());
    let constrained: Vec<(Direction, f64)> = inclined.map(|at| (at, at.of(&state.velocity))).collect();
    for (dof, velocity) in step.launch.iter().flat_map(|&(node, [x, y])| [(2 * node, x), (2 * node + 1, y)]) {
        if step.support_at(dof).is_none_or(|support| support.at.inclined.is_some()) {
            state.velocity[dof] = velocity;
        }
    }
    constrained.into_iter().for_each(|(at, velocity)| at.set(velocity, &mut state.velocity));
    if !step.launch.is_empty() {
        model.ties.spread(2, &mut state.velocity);
        links::stiffen_velocities(model, &state.displacement, &mut state.velocity);
    }
}

/// Whether all accelerations are zero.
fn rests(state: &State) -> bool {
    state.acceleration.iter().all(|a| *a == 0.0)
}

/// Relative round-off in a value: in a reaction across its direction, or in a load that does not jump.
const ROUNDED: f64 = 1e-12;

/// Round-off in any force, relative to the largest force.
const ROUND_OFF: f64 = 16.0 * f64::EPSILON;

/// Nodes at which loads, dampers, temperatures or reactions at the start of the step differ from those at the end of the last
/// increment, of whatever kind. Without new accelerations the old ones would persist for half an increment. Splitting a step
/// in two creates no jump.
fn jumps(step: &Step, old: &State, state: &State, work: &mut Workspace) -> Result<Vec<bool>, IncrementFailure> {
    let mut now = state.clone();
    evaluate_forces(step, &mut now, work)?;
    let model = work.assembler.model();
    let memory = &work.assembler.evaluation.memory;
    // Reactions count as loads in a state.
    let given: Vec<f64> =
        state.external.iter().zip(&state.reaction).map(|(external, reaction)| external - reaction).collect();
    let forces = [&state.force, &state.external, &state.damping, &now.external].map(|forces| largest(forces));
    let force = forces.into_iter().fold(0.0, f64::max);
    let mut anew: Vec<bool> = (0..model.mesh.nodes.len())
        .map(|node| {
            [2 * node, 2 * node + 1].into_iter().any(|dof| {
                differ([given[dof], now.external[dof]], state.reaction[dof], force)
                    || differ([state.damping[dof], now.damping[dof]], 0.0, force)
            })
        })
        .collect();
    let elements = 0..model.mesh.elements.len();
    let hottest =
        elements.flat_map(|e| model.temperatures(e, memory)).fold(0.0, |most: f64, rise| most.max(rise.abs()));
    for (e, element) in model.mesh.elements.iter().enumerate() {
        let [old, new] = [&state.memory, memory].map(|memory| model.temperatures(e, memory));
        if old.zip(new).any(|(old, new)| differ([old, new], 0.0, hottest)) {
            element.nodes.iter().for_each(|&node| anew[node] = true);
        }
    }
    freed(step, old).for_each(|node| anew[node] = true);
    Ok(anew)
}

/// Whether a value jumps by more than its round-off, that of the value `adjacent` it and that of the largest of its kind.
fn differ([before, after]: [f64; 2], adjacent: f64, largest: f64) -> bool {
    let size = before.abs().max(after.abs()).max(adjacent.abs());
    (after - before).abs() > ROUNDED * size + ROUND_OFF * largest
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()))
}

/// Nodes whose reaction is released; without it, accelerations jump.
fn freed(step: &Step, old: &State) -> impl Iterator<Item = usize> {
    let reaction = |at: Direction| at.of(&old.reaction).abs();
    let constrained = move |dof: usize| {
        let at = step.support_at(dof)?.at;
        // Along an inclined direction the components are rounded.
        Some(at.across().is_none_or(|across| reaction(across) <= ROUNDED * reaction(at)))
    };
    let free = move |dof: &usize| old.reaction[*dof] != 0.0 && !constrained(*dof).unwrap_or(false);
    (0..old.reaction.len()).filter(free).map(|dof| dof / 2)
}

/// Resumes a step after explicit increments within it.
///
/// # Errors
/// Returns [`IncrementFailure`] if the state cannot be evaluated or a body has no mass.
pub fn go_on(model: &Model, step: &Step, old: &State, work: &mut Workspace) -> Result<State, IncrementFailure> {
    let mut state = State { last_increment: None, ..old.clone() };
    if step.scheme.is_dynamic() {
        start_dynamics(model, step, vec![true; model.mesh.nodes.len()], &mut state, work)?;
        moves_anew(step, &mut state, work);
        return Ok(state);
    }
    model.ties.gather(2, &mut state.force);
    state.stop();
    Ok(state)
}

/// Computes accelerations by (1), and the corresponding forces, for the nodes `anew` and all nodes coupled with them by the
/// mass; loads may start with a jump.
fn start_dynamics(
    model: &Model,
    step: &Step,
    mut anew: Vec<bool>,
    state: &mut State,
    work: &mut Workspace,
) -> Result<(), IncrementFailure> {
    if !anew.contains(&true) {
        return Ok(());
    }
    let mut now = state.clone();
    evaluate_forces(step, &mut now, work)?;
    let mut right: Vec<f64> = now.force.iter().map(|f| -f).collect();
    let mut mass = work.assembler.mass().clone();
    links::gather_rows(model, &mut mass);
    links::gather_residual(model, &mut right);
    let scale = mass.diagonal().into_iter().fold(0.0, f64::max);
    let dt = step.increments.initial;
    let first = Trial::new(state, step, state.time + dt, dt);
    // Nodes without mass are in equilibrium from the first increment on.
    let without = |dof: &usize| model.massless[dof / 2] && mass.diagonal()[*dof] == 0.0;
    for dof in (0..model.dofs()).filter(without).collect::<Vec<_>>() {
        mass.constrain(dof, scale);
        right[dof] = 0.0;
    }
    for support in &step.supports {
        constrain(support.at, scale, &mut mass);
        turn(support.at, scale * start_acceleration(first.thirds(support, model), dt), &mut right);
    }
    tie(model, &mut mass, scale);
    links::begin(model, scale, state, &mut mass, &mut right);
    now.acceleration = linear::solve(&mut *work.solver, &mass, &right).map_err(IncrementFailure::Mass)?.x;
    let [mut inertia] = work.assembler.mass().multiply_symmetric([&now.acceleration]);
    model.linkage.gather(&mut inertia);
    let [force, inertia] = [&now.force, &inertia].map(|forces| links::relieved(model, &state.displacement, forces));
    for support in &step.supports {
        support.at.add(support.at.of(&force) + support.at.of(&inertia), &mut now.external);
    }
    mass.reach(&mut anew);
    take_over(model, &anew, now, state);
    heat(step, &work.assembler.evaluation, state);
    Ok(())
}

/// Copies the values of `now` at the affected nodes; all others stay bitwise the same.
fn take_over(model: &Model, anew: &[bool], now: State, state: &mut State) {
    for dof in (0..model.dofs()).filter(|dof| anew[dof / 2]) {
        state.force[dof] = now.force[dof];
        state.external[dof] = now.external[dof];
        state.damping[dof] = now.damping[dof];
        state.acceleration[dof] = now.acceleration[dof];
    }
}

/// Computes the forces at the start of a static run with initial stress or closed contacts, balanced by loads and
/// reactions.
fn start_loaded(step: &Step, state: &mut State, work: &mut Workspace) -> Result<(), IncrementFailure> {
    // Static steps apply temperatures with the first increment.
    evaluate_forces(&Step { temperatures: Vec::new(), ..step.clone() }, state, work)?;
    let force = links::relieved(work.assembler.model(), &state.displacement, &state.force);
    step.supports.iter().for_each(|support| support.at.add(support.at.of(&force), &mut state.external));
    Ok(())
}

/// Evaluates the forces of the unchanged state under the loads of the step at this time.
fn evaluate_forces(step: &Step, state: &mut State, work: &mut Workspace) -> Result<(), IncrementFailure> {
    let quasi_static = Step { scheme: Scheme::Static, ..step.clone() };
    let trial = Trial::new(state, &quasi_static, state.time, 0.0);
    work.assembler.residual(trial, &state.displacement, &mut work.system).map_err(IncrementFailure::Start)?;
    let evaluation = &work.assembler.evaluation;
    state.force.clone_from(&evaluation.force);
    state.external.clone_from(&evaluation.loads);
    state.damping.clone_from(&evaluation.damping);
    Ok(())
}
