//! Warnings about results: deep penetration, pressure above the uniqueness bound of the law, time errors above the tolerance,
//! fronts not resolved by the mesh, contacts that never close, linear bodies far from their range, and energy errors.
//!
//! Those about single points of a contact are in `concerns.rs`.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use nalgebra::{Matrix2, Vector2};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::audit::Audit;
use super::coarse;
use super::concerns::{Kind, concerns, left};
use super::csv;
use super::depths;
use super::few_edges::FewEdges;
use super::instability::Instability;
use super::opened::by_water;
use super::rattling::rattles;
use super::scattered::Scattered;
use super::slid_bars;
use super::unpressed::Unpressed;
use super::worst::Worst;
use crate::contact::master::{Master, Shape};
use crate::contact::small_sliding::SmallSliding;
use crate::contact::{ContactPair, ContactState};
use crate::mesh::configuration::{Configuration, vector};
use crate::model::scheme::{Scheme, time_text};
use crate::model::step::{SHORTEST_INCREMENT, Until};
use crate::model::text::{self, distinct, readable};
use crate::model::{Model, State, Step};
use crate::run::{Attempt, Error, Observer};
use crate::time::step_size::LocalError;
use crate::time::touching::UNCERTAINTY;

/// Smallest reported penetration of a master by a node that the contact does not check or press on, as a fraction of the
/// slave's longest edge.
const UNSEEN: f64 = 0.05;

/// Collects warnings, each kind once per contact or step, at its first occurrence.
#[derive(Clone, Default, Serialize, Deserialize)]
pub struct Warnings {
    /// the warnings so far
    pub list: Vec<String>,
    /// Kinds by the number of their contact or body
    given: BTreeSet<(usize, Kind)>,
    /// Names of the steps with a warning about their time error
    inexact: BTreeSet<String>,
    /// Names of the steps with a warning about friction after closure
    uncertain: BTreeSet<String>,
    /// Steps with a warning about their linear systems
    perturbed: BTreeSet<String>,
    /// How far each linear body had been strained in this step when it was looked at, as [`most_strained`] estimates it
    strained: BTreeMap<usize, f64>,
    /// Linear bodies beyond their range in this step, with the largest norm of a displacement gradient
    far: Worst,
    /// Contacts that have not closed yet, with name and smallest gap
    open: BTreeMap<usize, (String, Option<f64>)>,
    /// Contacts that have closed once
    closed: BTreeSet<usize>,
    /// Whether increments were explicit, of which only rows of the history are seen
    explicit: bool,
    /// Unstable equilibria that were accepted
    unstable: Instability,
    /// Friction in increments that are too long for it
    coarse: Worst,
    /// Contacts whose tractions alternate from point to point
    scattered: Scattered,
    /// Contacts that are closed on few edges
    few_edges: FewEdges,
    /// Shear that open points carry
    unpressed: Unpressed,
    /// Bars that have slipped far
    slid_bars: Worst,
    /// Energy balance so far
    pub audit: Audit,
    /// How far each linear body may be strained by now, once looked at, by the ways that its nodes have gone since
    #[serde(skip)]
    possibly: BTreeMap<usize, f64>,
    /// The most by which a unit of way strains an element, once asked for [1/L]
    #[serde(skip)]
    sharpest: Option<f64>,
    /// Callback for new warnings, and the number already passed to it
    #[serde(skip)]
    warn: Option<Warn>,
    #[serde(skip)]
    reported: usize,
}

/// Callback that receives a warning.
pub type Warn = Arc<dyn Fn(&str) + Send + Sync>;

impl Observer for Warnings {
    fn name(&self) -> &'static str {
        "warnings"
    }

    fn save(&mut self) -> Result<Vec<u8>, Error> {
        csv::remembered(self)
    }

    fn restore(&mut self, memory: &[u8]) -> Result<(), Error> {
        *self = Self { warn: self.warn.take(), ..csv::recalled::<Warnings>(memory)? };
        // These were reported when they arose.
        self.reported = self.list.len();
        Ok(())
    }

    fn record(&mut self, model: &Model, attempt: &Attempt) -> Result<(), Error> {
        let Some(state) = attempt.accepted else { return Ok(()) };
        self.error_in_time(attempt);
        self.error_of_touch(attempt);
        self.lost_pivots(attempt);
        self.unstable.record(attempt, state.time);
        self.passed(attempt, state);
        let way = self.audit.record(model, attempt.step, attempt.old, state);
        self.linear_bodies(model, state, way, attempt.ends_step(state));
        let x = model.configuration(&state.displacement);
        coarse::record(&mut self.coarse, model, attempt, state, &x);
        self.scattered.record(model, attempt, state);
        self.few_edges.record(model, attempt, state, &x);
        self.unpressed.record(model, state);
        slid_bars::record(&mut self.slid_bars, model, state);
        self.cavitating(model, state);
        let pairs = model.contacts.iter().zip(&state.contacts).enumerate();
        for (number, (pair, states)) in pairs.filter(|(_, (pair, _))| attempt.step.joins(pair)) {
            self.once(number, Kind::DeepPenetration, pair, state.time, || depths::penetrates(pair, states, &x));
            let both = [&attempt.old.contacts[number][..], states];
            self.once(number, Kind::OpenedByWater, pair, state.time, || by_water(pair, both, &x));
            self.once(number, Kind::Rattles, pair, state.time, || rattles(pair, states, &x));
            let points = pair.points.iter().zip(attempt.old.contacts[number].iter().zip(states));
            for (point, (old, contact)) in points.filter(|(_, (_, new))| new.is_closed()) {
                for (kind, message) in concerns(pair, point, state.time, old, contact, &x) {
                    if self.given.insert((number, kind)) {
                        self.list.push(format!("{}: {message}", place(pair, point.at(&x), state.time)));
                    }
                }
            }
            if let Some(small) = pair.small.as_ref().filter(|_| !pair.tied) {
                self.no_small_sliding(number, pair, small, state.time, model, &x);
            }
            let fading = model.steps[0].span.share(state.time) < 1.0 && pair.points.iter().any(|p| p.overlap > 0.0);
            let explicit = matches!(attempt.step.scheme, Scheme::Explicit { .. });
            self.explicit |= explicit;
            self.never_closed(number, pair, states);
            if !explicit || attempt.ends_step(state) {
                self.once(number, Kind::DeepUnseen, pair, state.time, || deep_unseen(pair, &x));
                self.once(number, Kind::RigidInside, pair, state.time, || depths::rigid_inside(pair, &x));
            }
            let elsewhere = pair.comes_stressed || pair.initial.is_some() || pair.points.iter().any(|p| p.touch != 0.0);
            if !(fading || explicit || elsewhere) {
                // Gaps differ from those of the surfaces under initial tractions and while a shrink fit is applied; explicit increments are
                // too many.
                self.once(number, Kind::DeepMasterNode, pair, state.time, || deep_master_node(pair, states, &x));
                self.once(number, Kind::DeepSlaveNode, pair, state.time, || deep_slave_node(pair, states, &x));
            }
        }
        self.report();
        Ok(())
    }

    fn finish(&mut self) -> Result<(), Error> {
        self.tell_far();
        for (name, gap) in self.open.values() {
            let near = gap.map_or("no slave point had a projection on the master".into(), |gap| {
                format!("its smallest gap was {gap:.3e}")
            });
            let where_seen = if self.explicit { " at any row of the history (output.interval)" } else { "" };
            self.list.push(format!("contact `{name}` has never closed{where_seen}: {near}"));
        }
        self.list.extend(self.unstable.message());
        for worst in [&mut self.coarse, &mut self.scattered.worst, &mut self.slid_bars] {
            self.list.extend(worst.take().map(|(_, message)| message));
        }
        self.list.extend(self.few_edges.warnings());
        self.list.extend(self.unpressed.warnings());
        self.list.extend(self.audit.concerns());
        self.report();
        self.audit.check()
    }
}

impl Warnings {
    /// Continues the warnings of a model, which have been reported already; all others are passed to `warn` when they arise.
    pub fn reporting(list: Vec<String>, warn: Warn) -> Self {
        Self { reported: list.len(), list, warn: Some(warn), ..Self::default() }
    }

    fn report(&mut self) {
        self.list[self.reported..].iter_mut().for_each(|warning| *warning = readable(warning));
        self.warn.iter().for_each(|warn| self.list[self.reported..].iter().for_each(|warning| warn(warning)));
        self.reported = self.list.len();
    }

    /// A warning of a kind about a contact at a place, where there was none before.
    fn once(
        &mut self,
        number: usize,
        kind: Kind,
        pair: &ContactPair,
        time: f64,
        found: impl FnOnce() -> Option<(Vector2<f64>, String)>,
    ) {
        if !self.given.contains(&(number, kind))
            && let Some((at, message)) = found()
        {
            self.given.insert((number, kind));
            self.list.push(format!("{}: {message}", place(pair, at, time)));
        }
    }

    /// Points that have left the range of small sliding, closed or not: an open one may miss a contact.
    fn no_small_sliding(
        &mut self,
        number: usize,
        pair: &ContactPair,
        small: &SmallSliding,
        time: f64,
        model: &Model,
        x: &Configuration,
    ) {
        let quasi_dynamic = model.steps.iter().any(|step| matches!(step.scheme, Scheme::QuasiDynamic { .. }));
        let remedy = if quasi_dynamic {
            "quasi_dynamic steps have no other sliding, so judge by the distance over which tractions hardly vary \
            along the surface"
        } else {
            "take finite sliding"
        };
        for (slave, point) in pair.points.iter().zip(&small.points) {
            let Some(point) = point else { continue };
            for (kind, message) in left(point.departure(slave, &pair.master, x)) {
                if self.given.insert((number, kind)) {
                    self.list.push(format!("{}: {message}; {remedy}", place(pair, slave.at(x), time)));
                }
            }
        }
    }

    /// Tracks contacts that have never closed. (Self-contact need not close.)
    fn never_closed(&mut self, number: usize, pair: &ContactPair, states: &[ContactState]) {
        if self.closed.contains(&number) || pair.is_own() {
            return;
        }
        if states.iter().any(ContactState::acts) {
            self.closed.insert(number);
            self.open.remove(&number);
            return;
        }
        let gaps = states.iter().filter(|state| state.master_point.is_some()).map(ContactState::clearance);
        let (_, least) = self.open.entry(number).or_insert_with(|| (pair.name.clone(), None));
        *least = gaps.chain(*least).min_by(f64::total_cmp);
    }

    /// Linear bodies that have turned or stretched too far for one: told at the end of the step, with what was the farthest, to 2 %
    /// of it. No component of a displacement has changed by more than `way` since the last row.
    fn linear_bodies(&mut self, model: &Model, state: &State, way: f64, ends_step: bool) {
        let pending = |body: &usize| {
            model.bodies[*body].material.description().is_linear && !self.given.contains(&(*body, Kind::FarFromLinear))
        };
        let pending: Vec<usize> = (0..model.bodies.len()).filter(pending).collect();
        let sharpest = *self.sharpest.get_or_insert_with(|| sharpest(model, &pending));
        for body in pending {
            if !state.has(body) {
                // Nodes that it shares go on with the others; it is looked at when it comes again.
                self.possibly.remove(&body);
                continue;
            }
            let so_far = self.strained.get(&body).copied().unwrap_or(0.0);
            let enough = (FURTHER * so_far).max(LEAST_STRAINED);
            let possibly = self.possibly.entry(body).or_insert(f64::INFINITY);
            *possibly += sharpest * way;
            if *possibly <= enough && !ends_step {
                continue;
            }
            let now = most_strained(model, body, state);
            *possibly = now;
            if ends_step || now > enough {
                self.strained.insert(body, now.max(so_far));
                self.far_from_linear(body, model, state);
            }
        }
        if ends_step {
            self.strained.clear();
            self.tell_far();
        }
    }

    fn far_from_linear(&mut self, number: usize, model: &Model, state: &State) {
        let largest = |element: usize| {
            let (solid, u) = (&*model.solid(state, element), model.mesh.vectors(element, &state.displacement));
            let hoops = solid.hoops(&u).unwrap_or_default().into_iter().map(|hoop| (hoop - 1.0).abs());
            let planes =
                solid.deformations(&u).into_iter().map(|deformation| (deformation - Matrix2::identity()).norm());
            planes.chain(hoops).fold(0.0, f64::max)
        };
        let own = (0..model.solids.len()).filter(|&element| model.body_of_element[element] == number);
        let farthest = own.map(|e| (e, largest(e))).max_by(|a, b| a.1.total_cmp(&b.1));
        let so_far = self.far.bound(number, FAR_FROM_LINEAR);
        let Some((element, gradient)) = farthest.filter(|(_, gradient)| *gradient > so_far) else { return };
        let nodes = &model.mesh.elements[element].nodes;
        let at = nodes.iter().map(|&node| model.mesh.nodes[node]).sum::<Vector2<f64>>() / nodes.len() as f64;
        let quasi_dynamic = model.steps.iter().any(|step| matches!(step.scheme, Scheme::QuasiDynamic { .. }));
        let remedy = if quasi_dynamic { "quasi_dynamic steps have no other bodies" } else { "take neo_hookean" };
        let message = format!(
            "body `{}` at {}, t = {}: strains and rotations of {:.1} %, whose squares a linear body neglects: {remedy}",
            model.bodies[number].name,
            text::vector(at),
            time_text(state.time),
            100.0 * gradient
        );
        self.far.enter(number, gradient, message);
    }

    fn tell_far(&mut self) {
        for (number, message) in self.far.take() {
            self.given.insert((number, Kind::FarFromLinear));
            self.list.push(message);
        }
    }

    /// Bodies whose water flows and is pulled further than it holds together.
    fn cavitating(&mut self, model: &Model, state: &State) {
        for (flow, &body) in model.flow.iter().flat_map(|flow| flow.bodies.iter().map(move |body| (flow, body))) {
            let limit = model.bodies[body].flowing().and_then(|fluid| fluid.cavitation);
            let Some(limit) = limit.filter(|_| state.has(body) && !self.given.contains(&(body, Kind::Cavitates)))
            else {
                continue;
            };
            let own = model.bodies[body].elements.iter().filter_map(|&e| flow.wet(e)).flat_map(|wet| &wet.pressures);
            let all = own.map(|&k| (k, flow.pressure(k, Some(&state.displacement))));
            let Some((k, least)) = all.min_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, least)| *least < limit) else {
                continue;
            };
            self.given.insert((body, Kind::Cavitates));
            self.list.push(format!(
                "body `{}` at {}, t = {}: p_w is {}, below its `cavitation`, {}, to which water that flows is not limited: suction, and the strength that \
                 follows from it, are overestimated",
                model.bodies[body].name,
                text::vector(model.mesh.nodes[flow.corners[k]]),
                time_text(state.time),
                text::number(least),
                text::number(limit)
            ));
        }
    }

    /// A reaction that jumped past the target value of its step.
    fn passed(&mut self, attempt: &Attempt, state: &State) {
        let Step { name, until: Some(until), .. } = attempt.step else { return };
        if state.time < attempt.step.span.end && attempt.ends_step(state) && !until.is_met(state) {
            let [before, after] = distinct([attempt.old, state].map(|state| until.value_in(state)));
            let Until { on, value, .. } = until;
            self.list.push(format!(
                "step `{name}`, t = {}: {} of `{on}` jumps from {before} to {after}, past {value}, where the step ends: \
                 where a load or support jumps let it grow, where bodies snap through take a value beyond, or a step with inertia",
                time_text(state.time),
                until.name()
            ));
        }
    }

    /// Singular or nearly singular matrices that were solved nevertheless.
    fn lost_pivots(&mut self, attempt: &Attempt) {
        let solves = || attempt.iterations.iter().map(|iteration| iteration.newton);
        let pivots = solves().map(|solve| solve.perturbed_pivots).max().unwrap_or(0);
        let fallback = solves().any(|solve| solve.fallback);
        if (pivots > 0 || fallback) && self.perturbed.insert(attempt.step.name.clone()) {
            let start = format!("step `{}`, t = {}", attempt.step.name, time_text(attempt.old.time + attempt.dt));
            let found = match (pivots, fallback) {
                (0, _) => {
                    "the factorization of the tangent was not accurate enough, and a slower solver was used".into()
                }
                (pivots, false) => format!("{pivots} pivots of the tangent were nearly zero and were replaced"),
                (pivots, true) => format!("{pivots} pivots of the tangent were nearly zero; a slower solver was used"),
            };
            self.list.push(format!("{start}: {found}; the equations are solved, but a body may be barely constrained: support it, or hold it by a spring"));
        }
    }

    /// Time errors of increments of the shortest length, which are accepted in any case.
    fn error_in_time(&mut self, attempt: &Attempt) {
        let step = attempt.step;
        let Some(error) = attempt.local_error.filter(LocalError::is_excessive) else { return };
        if self.inexact.insert(step.name.clone()) {
            let [estimate, allowed] = distinct([error.estimate, error.allowed]);
            let found = format!("its error {estimate} exceeds {allowed}");
            self.list.push(shortest(attempt, &found));
        }
    }

    /// Uncertain friction after closure in increments of the shortest length, which are accepted in any case.
    fn error_of_touch(&mut self, attempt: &Attempt) {
        let Some(uncertainty) = attempt.uncertainty.filter(|uncertainty| *uncertainty > UNCERTAINTY) else { return };
        if self.uncertain.insert(attempt.step.name.clone()) {
            let percent = 100.0 * uncertainty;
            let found =
                format!("contact closed within it: friction force uncertain by {percent:.1} % of the contact force");
            self.list.push(shortest(attempt, &found));
        }
    }
}

/// The deepest master node in the slave between its points, where contact is not checked, with a warning.
fn deep_master_node(pair: &ContactPair, states: &[ContactState], x: &Configuration) -> Option<(Vector2<f64>, String)> {
    let (at, depth, share) = pair.deepest_master_node(states, x).filter(|(.., share)| *share > DEEP_BETWEEN)?;
    // A stiffer penalty helps only where the points of the contact give way by as much.
    let gives = states.iter().filter(|contact| contact.is_closed());
    let gives = gives.map(|contact| -contact.clearance()).fold(0.0, f64::max);
    let remedy = if gives > OF_DEPTH * depth {
        "refine both sides there, make the finer one the slave, or raise alpha_n"
    } else {
        "the edges there are too long for the shapes of both surfaces: refine both sides, or make the finer one the slave"
    };
    let percent = 100.0 * share;
    Some((at, format!("a master node penetrates the slave by {depth:.3e}, {percent:.1} % of its edge; {remedy}")))
}

/// The deepest slave node in a mesh master that the averages around it do not press on, with a warning.
fn deep_slave_node(pair: &ContactPair, states: &[ContactState], x: &Configuration) -> Option<(Vector2<f64>, String)> {
    let (at, depth, share) = pair.deepest_slave_node(states, x).filter(|(.., share)| *share > UNSEEN)?;
    let message = format!(
        "a slave node is inside the master by {depth:.3e}, {:.1} % of its edge, and the means around it are open: refine the slave \
         there, or take \"method\": \"node_to_segment\"",
        100.0 * share
    );
    Some((at, message))
}

/// The deepest node outside the slave in a rigid master, which acts only on slave points, with a warning.
fn deep_unseen(pair: &ContactPair, x: &Configuration) -> Option<(Vector2<f64>, String)> {
    let Master::Rigid(rigid) = &pair.master else { return None };
    let longest = pair.points.iter().filter_map(|point| point.edge_length(x)).fold(0.0, f64::max);
    // What is deeper behind a line than an edge is beyond the other side of its tool.
    let most = if matches!(rigid.shape, Shape::Polyline(_)) { longest } else { f64::INFINITY };
    let depths = pair.unseen.iter().filter_map(|node| Some((node, -rigid.project(node, x)?.gap)));
    let within = depths.filter(|(_, depth)| *depth < most);
    let (node, depth) = within.max_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, depth)| *depth > UNSEEN * longest)?;
    let message = format!(
        "a node outside the slave group penetrates the rigid master by {depth:.3e}; the master acts only on slave \
         nodes: add the touching sides to the slave group"
    );
    Some((node.at(x), message))
}

/// Describes place and time.
fn place(pair: &ContactPair, at: Vector2<f64>, time: f64) -> String {
    format!("contact `{}` at {}, t = {}", pair.name, text::vector(at), time_text(time))
}

/// Describes an increment that could not be shortened.
fn shortest(Attempt { step, dt, old, .. }: &Attempt, found: &str) -> String {
    let start =
        format!("step `{}`, t = {}: the increment {dt:.3e} is the shortest allowed", step.name, time_text(old.time));
    let least = SHORTEST_INCREMENT * step.span.end;
    let remedy = match (step.increments.min > least, step.scheme.is_dynamic()) {
        (true, _) => "lower dt.min",
        (false, true) => "round-off of the time allows none shorter",
        // Without inertia or radiation the rate of unstable slip has no bound.
        (false, false) => {
            "round-off of the time allows none shorter: give the contact radiation_damping, or take a scheme with inertia"
        }
    };
    format!("{start}, and {found}; {remedy}")
}

/// Estimates how far a body is strained and turned, at less cost than its deformation at the integration points: of all elements the largest
/// displacement of a node against the first one, by [`sharpness`]; in axisymmetry at least u_r/r.
fn most_strained(model: &Model, body: usize, state: &State) -> f64 {
    let u = &state.displacement;
    let strained = |&element: &usize| {
        let nodes = &model.mesh.elements[element].nodes;
        let (first, own) = (nodes[0], vector(u, nodes[0]));
        let farthest = nodes.iter().map(|&node| (vector(u, node) - own).norm_squared()).fold(0.0, f64::max);
        let hoop = if model.mesh.section.is_axisymmetric() { u[2 * first] / model.mesh.nodes[first].x } else { 0.0 };
        (farthest.sqrt() * sharpness(model, element)).max(if hoop.is_finite() { hoop.abs() } else { 0.0 })
    };
    model.bodies[body].elements.par_iter().with_min_len(MANY_ELEMENTS).map(strained).reduce(|| 0.0, f64::max)
}

/// Largest distance of the corners of an element over their area [1/L].
fn sharpness(model: &Model, element: usize) -> f64 {
    let element = &model.mesh.elements[element];
    let (corners, place) = (element.kind.corners(), |a: usize| model.mesh.nodes[element.nodes[a]]);
    let twice = |a: usize| (place(a) - place(0)).perp(&(place((a + 1) % corners) - place(0)));
    let area = 0.5 * (1..corners).map(twice).sum::<f64>().abs();
    let longest = (1..corners).map(|a| (place(a) - place(a - 1)).norm_squared()).fold(0.0, f64::max);
    longest.sqrt() / area
}

/// The most that the estimate of a body changes by if no component of a displacement changes by more than 1: two nodes by √2 either, or the
/// radius of a ring [1/L].
fn sharpest(model: &Model, bodies: &[usize]) -> f64 {
    let ring = |element: usize| {
        let radius = model.mesh.nodes[model.mesh.elements[element].nodes[0]].x;
        if model.mesh.section.is_axisymmetric() && radius != 0.0 { 1.0 / radius.abs() } else { 0.0 }
    };
    let elements = bodies.iter().flat_map(|&body| &model.bodies[body].elements);
    elements.map(|&element| (8f64.sqrt() * sharpness(model, element)).max(ring(element))).fold(0.0, f64::max)
}

/// Number of elements that one thread looks at in a go.
const MANY_ELEMENTS: usize = 4096;

/// Estimate below which no linear body is strained as far as a tenth.
const LEAST_STRAINED: f64 = 0.01;

/// Growth of the estimate after which linear bodies are looked at again.
const FURTHER: f64 = 1.02;

/// Norm of the displacement gradient of a linear body that causes a warning: its strains are wrong by about half of that.
const FAR_FROM_LINEAR: f64 = 0.1;

/// Penetration of a master node that causes a warning, as a fraction of the slave's edge. Between the points of a contact straight edges
/// that turn by θ lie up to θ/8 of their length in each other: this is 9°.
const DEEP_BETWEEN: f64 = 0.02;

/// Part of the depth of a master node that the points of the contact must give way by for a stiffer penalty to be advised.
const OF_DEPTH: f64 = 0.2;
