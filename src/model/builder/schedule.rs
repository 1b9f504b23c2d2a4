//! Schedule of a run: what each load step inherits from the previous one, and what it replaces or ends.
//!
//! Increments of a step, its stabilization, and its switch to explicit integration.
//!
//! What ends a step early, and restrictions of such a step.

use std::collections::{BTreeMap, BTreeSet};

use super::body::{check_damping, prescribed_temperatures, temperatures};
use super::error::{Checked, ModelError, check_positive, refuse_if};
use super::groups;
use super::groups::{Place, nodes_at};
use super::initial::launch;
use super::load::Change;
use super::load_step::{IncrementSettings, LoadStep, RuptureSettings, UNTIL_TOLERANCE, UntilSettings};
use super::loads::{LoadsInForce, check_defined};
use super::pore_flow::DrainsInForce;
use super::stages::Stages;
use super::supports::{SupportsInForce, freed};
use crate::contact::pair::ContactPair;
use crate::mesh::rigid::RigidBody;
use crate::model::boundary::{Amplitude, Drive, Span};
use crate::model::coupled::CoupledParts;
use crate::model::scheme::{Regime, Scheme};
use crate::model::step::{Entry, ForceComponent, Goal, SHORTEST_INCREMENT, Until};
use crate::model::support::{Motion, Prescribed};
use crate::model::{Body, Damping, Increments, Model, Rupture, Step};

/// The regime of a run of these steps.
#[doc(hidden)]
pub fn regime(steps: &[LoadStep]) -> Regime {
    let any = |is: &dyn Fn(Scheme) -> bool| steps.iter().any(|step| step.scheme.is_some_and(is));
    if any(&Scheme::is_quasi_dynamic) {
        Regime::QuasiDynamic
    } else if any(&Scheme::is_explicit) || steps.iter().any(|step| step.rupture.is_some()) {
        Regime::Explicit
    } else if any(&Scheme::is_dynamic) {
        Regime::Dynamic
    } else {
        Regime::Static
    }
}

/// Builds the steps of a run.
pub fn steps(given: &[LoadStep], model: &Model) -> Checked<Vec<Step>> {
    refuse_if(given.is_empty(), "steps", "is empty: give at least one step")?;
    let mut schedule = Schedule {
        model,
        start: 0.0,
        scheme: Scheme::Static,
        increments: None,
        supports_in_force: SupportsInForce::default(),
        may_end_early: false,
        damping: model.bodies.iter().map(|body| body.damping).collect(),
        supports: Vec::new(),
        loads: LoadsInForce::default(),
        drains: DrainsInForce::default(),
        temperatures: BTreeMap::new(),
        stages: Stages::new(given, model),
    };
    given.iter().enumerate().map(|(k, step)| schedule.next(&format!("steps[{k}]"), step)).collect()
}

/// State passed from one step to the next.
struct Schedule<'m> {
    model: &'m Model,
    start: f64,
    scheme: Scheme,
    increments: Option<IncrementSettings>,
    supports_in_force: SupportsInForce,
    /// whether the last step may end early
    may_end_early: bool,
    damping: Vec<Damping>,
    /// supports of the last step
    supports: Vec<Prescribed>,
    loads: LoadsInForce,
    drains: DrainsInForce,
    temperatures: BTreeMap<usize, Amplitude>,
    /// bodies that come and go
    stages: Stages<'m>,
}

impl Schedule<'_> {
    fn next(&mut self, place: &str, given: &LoadStep) -> Checked<Step> {
        check_positive(&format!("{place}.duration"), given.duration, "")?;
        self.scheme = given.scheme.unwrap_or(self.scheme);
        let scheme = self.scheme;
        scheme.check().map_err(|error| ModelError::new(format!("{place}.scheme"), error))?;
        let span = Span { start: self.start, end: self.start + given.duration };
        self.start = span.end;
        self.increments = given.dt.or(self.increments);
        let first_order = critical_slip(self.model, span);
        let increments = increments(&format!("{place}.dt"), self.increments, span, scheme, first_order)?;
        if std::mem::replace(&mut self.may_end_early, given.until.is_some()) {
            self.supports_in_force.keep_positions();
        }
        let changed = self.stages.step(given, scheme, place)?;
        // In dynamics a released reaction vanishes at once.
        let fades = !scheme.is_dynamic();
        self.supports_in_force.step(&given.supports, place, span, fades, self.model)?;
        self.stages.check_supports(&given.supports, place)?;
        let supports = self.stages.constrained(self.supports_in_force.all(place, self.model)?, span);
        let before = std::mem::replace(&mut self.supports, supports);
        let released = if fades { freed(&before, &self.supports) } else { Vec::new() };
        let bars = self.stages.bars(given, scheme, place)?;
        self.loads.step(&given.loads, place, span, [&self.stages.absent(), &bars.absent], self.model)?;
        let outlets = self.model.flow.as_ref().map_or(&[][..], |flow| &flow.outlets);
        let drains = self.drains.step(&given.drainage, place, outlets, &self.stages.absent(), self.model)?;
        self.damp(&given.damping, place)?;
        temperatures(&mut self.temperatures, given, place, span, self.model)?;
        check_defined(place, given, scheme, span, self.model)?;
        let stabilization = stabilization(&format!("{place}.stabilize"), given, scheme, self.model)?;
        let increments = if stabilization.is_empty() { increments } else { increments.at_most(0.5 * given.duration) };
        let mut step = Step {
            name: given.name.clone(),
            span,
            scheme,
            increments,
            rupture: None,
            launch: launch(given, scheme, place, self.model)?,
            supports: self.supports.clone(),
            released,
            loads: self.loads.all(),
            drains,
            entries: Entry::of_step(self.supports_in_force.entries().chain(self.loads.entries())),
            damping: self.damping.clone(),
            absent: self.stages.absent(),
            changed,
            relaxes: false,
            bars,
            until: None,
            temperatures: prescribed_temperatures(&self.temperatures),
            stabilization,
        };
        step.until = until(place, given, &step, self.model)?;
        step.rupture = rupture(&format!("{place}.rupture"), given.rupture, &step, self.model)?.map(Box::new);
        Ok(step)
    }

    /// Sets the damping of bodies.
    fn damp(&mut self, given: &BTreeMap<String, Damping>, place: &str) -> Checked<()> {
        for (name, damping) in given {
            let place = format!("{place}.damping.{name}");
            let body = groups::body(self.model, name, &place)?;
            check_damping(*damping, &*self.model.bodies[body].material, &place)?;
            self.damping[body] = *damping;
        }
        Ok(())
    }
}

/// Number of increments or result rows above which a run is refused as a typing error: it would take days for a single point.
pub const MOST_INCREMENTS: f64 = 1e8;

/// The smallest D_c of friction that is integrated to first order in time ([`Description::critical_slip`]) in a step; `None`
/// without such friction [L].
///
/// [`Description::critical_slip`]: crate::laws::friction::Description::critical_slip
pub fn critical_slip(model: &Model, span: Span) -> Option<f64> {
    let mut smallest: Option<f64> = None;
    for pair in model.contacts.iter().filter(|pair| !pair.tied) {
        for (point, time) in pair.points.iter().flat_map(|point| [(point, span.start), (point, span.end)]) {
            let own = pair.ask_law(point, [time, time], |law| law.description.critical_slip);
            // Where parameters are invalid then, the increment that meets them stops.
            smallest = own.ok().flatten().into_iter().chain(smallest).reduce(f64::min);
        }
    }
    smallest
}

/// Returns the increments of a step, with defaults derived from the first one and from D_c of friction that is integrated to first
/// order in time, if there is any.
pub fn increments(
    place: &str,
    given: Option<IncrementSettings>,
    span: Span,
    scheme: Scheme,
    critical_slip: Option<f64>,
) -> Checked<Increments> {
    let duration = span.end - span.start;
    let given = given.unwrap_or(IncrementSettings::from(0.1 * duration));
    let least = SHORTEST_INCREMENT * span.end;
    let has_estimate = scheme == Scheme::Static || scheme.error_constant().is_some();
    let error = given.error.as_ref().and_then(Change::given).copied();
    let is_open = given.error.is_none() || scheme != Scheme::Static && error.is_some();
    let pore_pressure = given.pore_pressure;
    check_positive(&format!("{place}.pore_pressure"), pore_pressure.unwrap_or(1.0), "")?;
    let slip = critical_slip.filter(|_| is_open && !scheme.is_integrated_explicitly()).map(|_| given.slip);
    let default_min = match (error.is_some() || slip.is_some() || pore_pressure.is_some(), critical_slip) {
        (false, _) if scheme.is_quasi_dynamic() => least,
        (true, Some(_)) => least,
        (true, None) => (1e-6 * given.initial).max(least),
        (false, _) => 1e-3 * given.initial,
    };
    // A control that was not asked for shortens increments, and does not lengthen them.
    let lengthens = scheme.is_quasi_dynamic() || error.is_some() || pore_pressure.is_some();
    let default_max = if lengthens { given.initial.max(0.1 * duration) } else { given.initial };
    let (min, max) = (given.min.unwrap_or(default_min), given.max.unwrap_or(default_max));
    let increments = Increments { initial: given.initial, min, max, error, slip, pore_pressure };
    check_positive(&format!("{place}.initial"), given.initial, "")?;
    check_positive(&format!("{place}.error"), error.unwrap_or(1.0), "")?;
    check_bounds(place, [min, max], span, scheme)?;
    let message = format!("initial = {} must lie between min = {min} and max = {max}", given.initial);
    refuse_if(given.initial > max || given.initial < min, place, message)?;
    let message = match scheme {
        Scheme::Explicit { .. } => "explicit takes the longest stable increments: leave error out",
        Scheme::QuasiDynamic { .. } => "quasi_dynamic has a tolerance of its own: leave error out",
        Scheme::Wilson { .. } => "wilson has no error estimate: take newmark, hht or generalized_alpha",
        _ => "newmark with beta near 1/6 has no error estimate: take another beta",
    };
    refuse_if(error.is_some() && !has_estimate, format!("{place}.error"), message)?;
    Ok(increments)
}

/// Checks that bounds of increments are consistent, exceed the round-off of the time, and do not require too many increments
/// for the rest of a step.
pub fn check_bounds(place: &str, [min, max]: [f64; 2], left: Span, scheme: Scheme) -> Checked<()> {
    check_positive(&format!("{place}.min"), min, "")?;
    check_positive(&format!("{place}.max"), max, "")?;
    let message = format!("min = {min} is above max = {max}: increments must have room between them");
    refuse_if(min > max, place, message)?;
    let (end, least, duration) = (left.end, SHORTEST_INCREMENT * left.end, left.end - left.start);
    // If the two are equal, max was given.
    let name = if min < max { "min" } else { "max" };
    let message = format!("is {min:e}: at the time {end:e} increments below {least:.1e} are lost in round-off");
    refuse_if(min < least, format!("{place}.{name}"), message)?;
    let count = duration / max;
    let message = format!(
        "increments of at most {max:e} make {count:.1e} of them in a step of {duration:e}, and at most \
         {MOST_INCREMENTS:e} are allowed: make them longer"
    );
    refuse_if(count > MOST_INCREMENTS && !scheme.is_explicit(), place, message)?;
    Ok(())
}

/// c₀ of every dof: the nodes of a body share `stabilize` × (λ + 2G) × duration.
pub fn stabilization(place: &str, given: &LoadStep, scheme: Scheme, model: &Model) -> Checked<Vec<f64>> {
    let Some(share) = given.stabilize else { return Ok(Vec::new()) };
    let message =
        format!("is {share}: must be a fraction of the stiffness, above 0 and at most 1 (1e-3 is a good start)");
    refuse_if(!(share > 0.0 && share <= 1.0), place, message)?;
    refuse_if(scheme != Scheme::Static, place, "is for static steps: in a dynamic one inertia constrains the bodies")?;
    let mut coefficients = vec![0.0; model.dofs()];
    for body in &model.bodies {
        let coefficient = share * body.material.description().p_wave_modulus * given.duration / body.nodes.len() as f64;
        let dofs = body.nodes.iter().flat_map(|&node| [2 * node, 2 * node + 1]);
        // A node of two bodies has the sum of both.
        dofs.for_each(|dof| coefficients[dof] += coefficient * model.mesh.section.weight(model.mesh.nodes[dof / 2]));
    }
    for rigid in &model.mesh.rigid_bodies {
        let dofs = rigid.nodes().into_iter().flat_map(|node| [2 * node, 2 * node + 1]);
        dofs.for_each(|dof| coefficients[dof] = share * softest(model, rigid) * given.duration);
    }
    Ok(coefficients)
}

/// (λ + 2G) × depth of the softest body that may touch a rigid body: others have no say in how it moves [F/L].
fn softest(model: &Model, rigid: &RigidBody) -> f64 {
    let own = |pair: &&ContactPair| pair.master.rigid_body().is_some_and(|body| body.name == rigid.name);
    let touched: BTreeSet<usize> = model.contacts.iter().filter(own).flat_map(ContactPair::slave_nodes).collect();
    let mut softest = f64::INFINITY;
    for body in model.bodies.iter().filter(|body| body.nodes.iter().any(|node| touched.contains(node))) {
        let depths = body.elements.iter().map(|&e| model.solids[e].mean_weight());
        softest = softest.min(body.material.description().p_wave_modulus * depths.fold(f64::INFINITY, f64::min));
    }
    if softest.is_finite() { softest } else { 0.0 }
}

/// Longest time in which a shear wave crosses bodies that act on each other by a contact, at the speed of the slowest [T].
fn crossing(model: &Model) -> f64 {
    let CoupledParts { parts, of_node } = CoupledParts::of(model);
    let speed = |body: &Body| (body.material.description().shear_modulus / body.material.description().density).sqrt();
    let touching: BTreeSet<usize> =
        model.contacts.iter().flat_map(|pair| pair.nodes().map(|node| of_node[node])).collect();
    let crossing = |part: usize| {
        let own = model.bodies.iter().filter(|body| body.nodes.iter().any(|&node| of_node[node] == part));
        parts[part].size / own.map(speed).fold(f64::INFINITY, f64::min)
    };
    touching.into_iter().map(crossing).fold(0.0, f64::max)
}

/// Returns the criteria of the switch to explicit integration.
pub fn rupture(place: &str, given: Option<RuptureSettings>, step: &Step, model: &Model) -> Checked<Option<Rupture>> {
    let Some(RuptureSettings { slip_rate, safety }) = given else { return Ok(None) };
    check_positive(&format!("{place}.slip_rate"), slip_rate, "")?;
    refuse_if(step.scheme.is_explicit(), place, "is for static and implicit steps: this one is explicit throughout")?;
    let message = "is for static and implicit steps: this one follows slip at any rate by itself";
    refuse_if(step.scheme.is_quasi_dynamic(), place, message)?;
    refuse_if(model.contacts.is_empty(), place, "needs a contact that may slip: leave it out")?;
    let cause = "needs a body: fast slip ends when it stays slow for the time in which a shear wave crosses the \
                 bodies; use a dynamic scheme under error control (`dt.error`)";
    refuse_if(model.bodies.is_empty(), place, cause)?;
    let scheme = Scheme::Explicit { safety };
    scheme.check().map_err(|error| ModelError::new(place, error))?;
    let calm = crossing(model).max(step.increments.min);
    let increments = Increments { error: None, slip: None, ..step.increments };
    let explicit = Step { scheme, increments, stabilization: Vec::new(), ..step.clone() };
    Ok(Some(Rupture { slip_rate, calm, explicit }))
}

/// Largest tolerance; a larger one would not define a value.
const LOOSEST: f64 = 0.1;

/// Returns what ends a step, if anything does.
pub fn until(place: &str, given: &LoadStep, step: &Step, model: &Model) -> Checked<Option<Until>> {
    let Some(given_until) = &given.until else { return Ok(None) };
    let UntilSettings { on, tolerance, .. } = given_until;
    let (place, tolerance) = (format!("{place}.until"), *tolerance);
    let message = "must give exactly one of fx, fy, force and consolidation";
    let (part, value) = given_until.part().ok_or_else(|| ModelError::new(&place, message))?;
    let goal = match part {
        Some(part) => reaction(&place, on, part, value, step, model)?,
        None => consolidation(&place, on, value, step, model)?,
    };
    let message = format!("is {tolerance}: must be above 0 and at most {LOOSEST}; {UNTIL_TOLERANCE:e} is the default");
    refuse_if(!(tolerance > 0.0 && tolerance <= LOOSEST), format!("{place}.tolerance"), message)?;
    check_step(&place, given, step, model)?;
    Ok(Some(Until { on: on.to_string(), goal, value, tolerance }))
}

/// A reaction that ends a step.
fn reaction(place: &str, on: &Place, part: ForceComponent, value: f64, step: &Step, model: &Model) -> Checked<Goal> {
    let is_size = part == ForceComponent::Magnitude;
    let kind = if is_size { "zero or positive, the size of a force" } else { "a finite number" };
    let fails = !value.is_finite() || is_size && value < 0.0;
    refuse_if(fails, format!("{place}.{}", part.name()), format_args!("is {value}: must be {kind}"))?;
    let nodes = nodes_at(&model.mesh, on, &format!("{place}.on"))?;
    let constrained = [0, 1].map(|i| model.ties.originals(model.constrained(&nodes, i)));
    let along = |i: usize| {
        let of = |node: &usize| constrained[i].binary_search(node).is_ok();
        step.supports.iter().any(|support| of(&support.at.node()) && support.at.vector()[i] != 0.0)
    };
    let (has, axis) = match part {
        ForceComponent::X => (along(0), " along x"),
        ForceComponent::Y => (along(1), " along y"),
        ForceComponent::Magnitude => (along(0) || along(1), ""),
    };
    let message =
        format!("{on} has no support{axis} in this step, and no reaction: name the side that is moved or supported");
    refuse_if(!has, format!("{place}.on"), message)?;
    Ok(Goal::Reaction(constrained, part))
}

/// A degree of consolidation that ends a step.
fn consolidation(place: &str, on: &Place, value: f64, step: &Step, model: &Model) -> Checked<Goal> {
    let message = format!("is {value}: must be above 0 and below 1");
    refuse_if(!(value > 0.0 && value < 1.0), format!("{place}.consolidation"), message)?;
    let place = format!("{place}.on");
    let body = groups::body(model, &on.to_string(), &place)?;
    let flowing = model.flow.iter().flat_map(|flow| &flow.bodies);
    let number = flowing.copied().position(|other| other == body).filter(|_| step.has(body));
    let message = format!("`{on}` is not a body whose water flows in this step: give pore_fluid.permeability of it");
    number.map(Goal::Consolidation).ok_or_else(|| ModelError::new(place, message))
}

/// Checks settings that refer to the whole step.
fn check_step(place: &str, given: &LoadStep, step: &Step, model: &Model) -> Checked<()> {
    let message = "ends static and implicit steps only: leave it out, and give the step its time";
    refuse_if(step.scheme.is_integrated_explicitly(), place, message)?;
    let message = "and rupture cannot be combined: fast slip is integrated explicitly, without increments that could be cut \
                   back";
    refuse_if(given.rupture.is_some(), place, message)?;
    let message = "may end the step early, and what fades over the step (stabilize, the reaction of supports released by null, or the forces of \
                   bodies that come or go) would be left: let it fade in an earlier step";
    let fades = given.stabilize.is_some() || !step.released.is_empty();
    refuse_if(fades || !step.changed.is_empty() || !step.bars.changed.is_empty(), place, message)?;
    check_ramps(place, step, model)
}

/// Refuses quantities that reach a value at the end of the step, since they would continue to change in the next one.
fn check_ramps(place: &str, step: &Step, model: &Model) -> Checked<()> {
    let refused = |what: &str, instead: &str| {
        let message = format!("may end the step early, before {what} is fully applied: {instead}");
        Err(ModelError::new(place, message))
    };
    let is_new = |of: &Amplitude| of.span == step.span && matches!(of.drive, Drive::Constant(_) | Drive::ByPlace(..));
    let mut turns = step.supports.iter().filter_map(|support| match &support.motion {
        Motion::Rotation { angle, .. } => Some(angle),
        _ => None,
    });
    if step.loads.amplitudes().any(is_new) || turns.any(is_new) {
        return refused(
            "a load, driver or rotation given as a number (or ended by null)",
            "give it in the step before, or as a rate, table or expression",
        );
    }
    if let Some(heated) = step.temperatures.iter().find(|temperature| is_new(&temperature.amplitude)) {
        return refused(
            &format!("the temperature of `{}`, given as a number or by place,", model.bodies[heated.body].name),
            "give it in the step before, or as a rate, table in time or expression",
        );
    }
    let fits = |pair: &&ContactPair| pair.points.iter().any(|point| point.overlap > 0.0);
    match model.contacts.iter().find(fits).filter(|_| step.span.start == 0.0) {
        Some(pair) => refused(
            &format!("the overlap of `{}`, brought in over the first step (shrink_fit),", pair.name),
            "bring it in over a step without until before this one",
        ),
        None => Ok(()),
    }
}
