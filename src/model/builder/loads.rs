//! Loads in force: those of the previous step, unless they are replaced or ended.
//!
//! Expressions of supports and loads are evaluated throughout their step before the run.

use std::collections::BTreeMap;

use nalgebra::Vector2;

use super::error::{Checked, ModelError, check_not_negative, refuse_if};
use super::groups::{
    PLACES, Place, TIMES, absorbers, edge_weights, edges, group_at, mass_weights, node_lists, nodes_at,
    pressure_weights, some_of, uniform_weights,
};
use super::load::{Change, Components, DashpotLoad, Kind, Load, SpringLoad, Value};
use super::load_step::LoadStep;
use super::rigid::{of_moment, plate_of_moment};
use super::supports::nothing_to_end;
use crate::bars::Bar;
use crate::model::Model;
use crate::model::boundary::{
    Amplitude, Dashpot, DeadLoad, Drive, FollowerPressure, Loads, NodalWeight, PlateMoment, Span, Spring,
};
use crate::model::scheme::Scheme;
use crate::model::step::Entry;
use crate::model::text::{number, vector};

/// Maximum number of successive changes of a load that varies in space within its steps, each depending on the previous one.
const MOST_REMEMBERED: usize = 1000;

/// Loads by place and kind, with the amplitudes from which the next step continues. A caller can change a load with it between
/// two increments of a run:
///
/// ```
/// use fecontact::laws::bulk::{ElasticConstants, Linear};
/// use fecontact::mesh::InlineMesh;
/// use fecontact::model::Model;
/// use fecontact::model::boundary::Span;
/// use fecontact::model::builder::{Load, LoadStep, LoadsInForce};
/// use fecontact::run::Simulation;
///
/// let mesh = InlineMesh::default().rectangle("block", [2, 2], [0.0, 0.0], [1.0, 1.0]).build()?;
/// let steps = [LoadStep::new("press", 1.0).dt(0.25).fix("block_bottom").load(Load::dead_pressure("block_top", 1.0))];
/// let steel = Linear::new(&ElasticConstants::new(1000.0, 0.3))?;
/// let mut run = Simulation::new(Model::builder(mesh).body("block", steel).step(steps[0].clone()).build()?);
/// run.next_increment()?;
/// // From now on the pressure increases to twice its value at the end of the step.
/// let mut loads = LoadsInForce::of_step(run.step_number(), &steps, run.model())?;
/// let rest = Span { start: run.state().time, end: 1.0 };
/// loads.change_within(&Load::dead_pressure("block_top", 2.0), "load", rest, run.model())?;
/// run.change(|step| step.loads = loads.all());
/// while run.next_increment()?.is_some() {}
/// assert!((run.reaction("block_bottom")?.y - 2.0).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Default)]
pub struct LoadsInForce {
    all: BTreeMap<(String, Kind), InForce>,
    /// Whether each body is absent in the present step; empty if all are there
    absent: Vec<bool>,
    /// Whether each bar is
    bars_absent: Vec<bool>,
}

/// A load in force, or one that was ended.
#[derive(Clone)]
struct InForce {
    loads: Loads,
    entry: Entry,
    /// Bodies of each edge or node that it acts on
    on: Vec<Vec<usize>>,
    /// The bar whose weight it is
    bar: Option<usize>,
}

impl InForce {
    /// A body that it acts on and that is not there.
    fn missing(&self, absent: &[bool]) -> Option<usize> {
        let mut on = self.on.iter().filter(|bodies| !absent.is_empty() && bodies.iter().all(|&body| absent[body]));
        on.find_map(|bodies| bodies.first().copied())
    }
}

impl LoadsInForce {
    /// Returns the loads in a step of a model, including those of earlier steps.
    ///
    /// # Errors
    /// Returns none for a model that was built from these steps.
    pub fn of_step(number: usize, given: &[LoadStep], model: &Model) -> Checked<Self> {
        let mut in_force = Self::default();
        for (k, (given, step)) in given.iter().zip(&model.steps).enumerate().take(number + 1) {
            in_force.step(&given.loads, &format!("steps[{k}]"), step.span, [&step.absent, &step.bars.absent], model)?;
        }
        Ok(in_force)
    }

    /// Goes on to the next step, with its loads.
    pub(super) fn step(
        &mut self,
        given: &[Load],
        place: &str,
        span: Span,
        [absent, bars_absent]: [&[bool]; 2],
        model: &Model,
    ) -> Checked<()> {
        self.all.values_mut().for_each(|load| load.entry.kept = true);
        (self.absent, self.bars_absent) = (absent.to_vec(), bars_absent.to_vec());
        let mut given = given.iter().enumerate();
        given.try_for_each(|(k, load)| self.change(load, &format!("{place}.loads[{k}]"), span, model))?;
        self.check_bodies(place, model)
    }

    /// Refuses loads on bodies that are not there, except for gravity, which comes and goes with them.
    fn check_bodies(&self, place: &str, model: &Model) -> Checked<()> {
        let mut lasting =
            self.all.iter().filter(|((_, kind), load)| *kind != Kind::Gravity && load.entry.value.is_some());
        let hanging = lasting.find_map(|(_, load)| Some((&load.entry, load.missing(&self.absent)?)));
        let Some((Entry { on, kind, .. }, body)) = hanging else { return Ok(()) };
        let name = &model.bodies[body].name;
        let message = format!(
            "the {kind} on {on} acts on `{name}`, which is not there in this step: end it with null, or give it later"
        );
        Err(ModelError::new(format!("{place}.loads"), message))
    }

    /// Changes or ends a load from the start of a span within a step on.
    ///
    /// # Errors
    /// Returns the same errors as for a step.
    pub fn change_within(&mut self, load: &Load, place: &str, span: Span, model: &Model) -> Checked<()> {
        let on = load.on.in_words(&model.mesh);
        let before = self.all.get_mut(&(on, action(load, place)?.0));
        for amplitude in before.into_iter().flat_map(|before| before.loads.amplitudes_mut()) {
            *amplitude = amplitude.settled(span.start);
            if amplitude.chain().count() > MOST_REMEMBERED {
                let message = "was changed too often for one that varies in space: give it as an expression in t";
                return Err(ModelError::new(place, message));
            }
        }
        self.change(load, place, span, model)
    }

    /// Returns all loads on bodies and bars that are there.
    pub fn all(&self) -> Loads {
        let mut all = Loads::default();
        let is_there = |load: &&InForce| {
            let has_bar = load.bar.is_none_or(|bar| self.bars_absent.get(bar) != Some(&true));
            has_bar && load.missing(&self.absent).is_none()
        };
        for InForce { loads, .. } in self.all.values().filter(is_there) {
            all.dead.extend(loads.dead.iter().cloned());
            all.pressures.extend(loads.pressures.iter().cloned());
            all.springs.extend(loads.springs.iter().cloned());
            all.dashpots.extend(loads.dashpots.iter().cloned());
            all.absorbers.extend(loads.absorbers.iter().cloned());
            all.moments.extend(loads.moments.iter().cloned());
        }
        all
    }

    /// The loads of the present step as the input gave them.
    pub(super) fn entries(&self) -> impl Iterator<Item = &Entry> {
        self.all.values().map(|load| &load.entry)
    }

    /// Changes or ends a load.
    fn change(&mut self, load: &Load, place: &str, span: Span, model: &Model) -> Checked<()> {
        let (kind, value) = action(load, place)?;
        let on = load.on.settled(&model.mesh, &format!("{place}.on"))?;
        let key = (on.to_string(), kind);
        // A load that decreases to zero stays until something replaces it.
        let before = self.all.get(&key).filter(|load| kind.fades() || load.entry.value.is_some());
        if value.is_none() && before.is_none() {
            return Err(nothing_to_end(place, &load.on));
        }
        let before = before.map(|before| before.loads.clone()).unwrap_or_default();
        let loads = Changing { load, place, span, model, before }.made(kind, value)?;
        let name = if kind == Kind::Absorbing { "absorbing side".into() } else { kind.key().replace('_', " ") };
        let value = value.map(|value| value.to_string());
        let entry = Entry { is_load: true, on: key.0.clone(), kind: name, value, kept: false, fades: kind.fades() };
        let is_bar = |bar: &Bar| kind == Kind::Gravity && load.on == Place::Group(bar.name.clone());
        let bar = model.bars.iter().position(is_bar);
        let on = if bar.is_some() { Vec::new() } else { bodies_at(&load.on, place, model)? };
        self.all.insert(key, InForce { loads, entry, on, bar });
        Ok(())
    }
}

/// Bodies of each edge or node of a place; of a body itself, and of point masses with its name, that one.
fn bodies_at(on: &Place, place: &str, model: &Model) -> Checked<Vec<Vec<usize>>> {
    if let Place::Group(name) = on
        && let Some(body) = model.bodies.iter().position(|body| body.name == *name)
    {
        return Ok(vec![vec![body]]);
    }
    if let Place::Group(name) = on
        && let Ok(edges) = edges(&model.mesh, name, place)
    {
        return Ok(edges.iter().map(|edge| vec![model.body_of_element[edge.element]]).collect());
    }
    let own = |node: usize| {
        let bodies = model.bodies.iter().enumerate();
        bodies.filter(|(_, body)| body.nodes.binary_search(&node).is_ok()).map(|(number, _)| number).collect()
    };
    let nodes = nodes_at(&model.mesh, on, &format!("{place}.on"))?;
    Ok(nodes.into_iter().map(own).filter(|bodies: &Vec<usize>| !bodies.is_empty()).collect())
}

/// Returns kind and value of a load, which gives exactly one.
fn action<'l>(load: &'l Load, place: &str) -> Checked<(Kind, Option<Value<'l>>)> {
    let message = "must give exactly one of pressure, dead_pressure, traction, gravity, force, total_force, moment, spring, dashpot, \
                   absorbing";
    load.action().ok_or_else(|| ModelError::new(place, message))
}

/// A load that changes in a step.
struct Changing<'m> {
    load: &'m Load,
    place: &'m str,
    span: Span,
    model: &'m Model,
    before: Loads,
}

impl Changing<'_> {
    fn made(self, kind: Kind, value: Option<Value>) -> Checked<Loads> {
        let Self { load: Load { on, .. }, place, model, .. } = self;
        let (at, components) = (format!("{place}.on"), value.and_then(Value::components));
        let edges = || edges(&model.mesh, group_at(on, place)?, &at);
        let weights = match kind {
            Kind::Pressure | Kind::DeadPressure | Kind::Moment => return self.scalar(kind, value),
            Kind::Spring | Kind::Dashpot => return self.links(value),
            Kind::Absorbing => {
                let absorbers = if value.is_some() { absorbers(model, edges()?) } else { Vec::new() };
                return Ok(Loads { absorbers, ..Loads::default() });
            }
            Kind::Traction => edge_weights(&model.mesh, edges()?),
            Kind::Gravity => {
                check_gravity(components.and_then(|given| given.along(0)), place, model)?;
                mass_weights(model, group_at(on, place)?, &at)?
            }
            Kind::Force => {
                let position = |node: usize| model.mesh.nodes[node];
                let nodes = nodes_at(&model.mesh, on, &at)?.into_iter();
                nodes.map(|node| NodalWeight { node, weight: 1.0, position: position(node) }).collect()
            }
            Kind::TotalForce => {
                let edges = edges()?;
                check_uniform(components, place)?;
                uniform_weights(&model.mesh, edges)
            }
        };
        let pulled =
            model.bodies.iter().position(|body| kind == Kind::Gravity && *on == Place::Group(body.name.clone()));
        let mut dead = Vec::new();
        for (component, name) in ["x", "y"].into_iter().enumerate() {
            let given = components.and_then(|given| given.along(component));
            let before = self.before.dead.iter().find(|load| load.component == component);
            let before = before.map(|load| load.amplitude.clone());
            let amplitude = amplitude(given, before, &format!("{place}.{}.{name}", kind.key()), self.span)?;
            let load = |amplitude| DeadLoad { component, amplitude, weights: weights.clone(), body: pulled };
            dead.extend(amplitude.map(load));
        }
        Ok(Loads { dead, ..Loads::default() })
    }

    /// A load with a single amplitude.
    fn scalar(self, kind: Kind, value: Option<Value>) -> Checked<Loads> {
        let Self { load: Load { on, .. }, place, span, model, .. } = self;
        let before = self.before.amplitudes().next().cloned();
        let given = value.and_then(|value| value.drives().into_iter().next());
        let amplitude = || amplitude(given.map(|(_, drive)| drive), before, &format!("{place}.{}", kind.key()), span);
        let edges = || edges(&model.mesh, group_at(on, place)?, &format!("{place}.on"));
        let mut loads = Loads::default();
        match (kind, of_moment(on, model)) {
            (Kind::Pressure, _) => {
                let edges = node_lists(edges()?);
                loads.pressures.extend(amplitude()?.map(|amplitude| FollowerPressure { amplitude, edges }));
            }
            (Kind::DeadPressure, _) => {
                let weights = pressure_weights(&model.mesh, edges()?).into_iter().enumerate();
                let Some(amplitude) = amplitude()? else { return Ok(loads) };
                let along =
                    |(component, weights)| DeadLoad { component, amplitude: amplitude.clone(), weights, body: None };
                loads.dead.extend(weights.map(along));
            }
            (_, Some(body)) => {
                let (node, weight) = (body.turning, 1.0 / body.radius);
                let weights = vec![NodalWeight { node, weight, position: model.mesh.nodes[node] }];
                loads.dead.extend(amplitude()?.map(|amplitude| DeadLoad {
                    component: 0,
                    amplitude,
                    weights,
                    body: None,
                }));
            }
            (_, None) => {
                let plate = plate_of_moment(model, on, place)?;
                loads.moments.extend(amplitude()?.map(|amplitude| PlateMoment { plate, amplitude }));
            }
        }
        Ok(loads)
    }

    /// Springs or dashpots with a nonzero coefficient at every node.
    fn links(self, value: Option<Value>) -> Checked<Loads> {
        let Self { load: Load { on, .. }, place, span, model, before } = self;
        let nodes = nodes_at(&model.mesh, on, &format!("{place}.on"))?;
        let (key, coefficients) = match value {
            Some(Value::Spring(SpringLoad { kx, ky, .. })) => ("spring", [("kx", *kx), ("ky", *ky)]),
            Some(Value::Dashpot(DashpotLoad { cx, cy, .. })) => ("dashpot", [("cx", *cx), ("cy", *cy)]),
            _ => return Ok(Loads::default()),
        };
        let springs = before.springs.iter().map(|spring| (spring.dof, &spring.driver));
        let dashpots = before.dashpots.iter().map(|dashpot| (dashpot.dof, &dashpot.driver));
        let before: Vec<_> = springs.chain(dashpots).collect();
        let mut loads = Loads::default();
        for (component, (name, coefficient)) in coefficients.into_iter().enumerate() {
            check_not_negative(&format!("{place}.{key}.{name}"), coefficient)?;
            if coefficient == 0.0 {
                continue;
            }
            let drive = value.and_then(Value::components).and_then(|driver| driver.along(component));
            let before = before.iter().find(|(dof, _)| dof % 2 == component).and_then(|(_, driver)| (*driver).clone());
            let driver = amplitude(drive, before, &format!("{place}.{key}.driver"), span)?;
            for dof in nodes.iter().map(|node| 2 * node + component) {
                match key {
                    "spring" => loads.springs.push(Spring { dof, stiffness: coefficient, driver: driver.clone() }),
                    _ => loads.dashpots.push(Dashpot { dof, coefficient, driver: driver.clone() }),
                }
            }
        }
        Ok(loads)
    }
}

/// Checks that a total force on edges does not vary in space.
fn check_uniform(given: Option<&Components>, place: &str) -> Checked<()> {
    for (component, name) in ["x", "y"].into_iter().enumerate() {
        let message = "is the force on the whole group, which does not vary in space: give it in t, or a traction";
        refuse_if(
            given.and_then(|given| given.along(component)).is_some_and(Drive::depends_on_position),
            format!("{place}.total_force.{name}"),
            message,
        )?;
    }
    Ok(())
}

/// Amplitude of this step, following the one in force before; `None` if there is neither.
fn amplitude(given: Option<&Drive>, before: Option<Amplitude>, place: &str, span: Span) -> Checked<Option<Amplitude>> {
    let drive = match (given, &before) {
        (Some(given), _) => {
            given.check().map_err(|message| ModelError::new(place, message))?;
            given.clone()
        }
        // Ended: reduced to zero over the step.
        (None, Some(_)) => Drive::Constant(0.0),
        (None, None) => return Ok(None),
    };
    Ok(Some(Amplitude { drive, span, before: before.map(Box::new) }))
}

/// Refuses radial gravity in axisymmetry.
pub fn check_gravity(radial: Option<&Drive>, place: &str, model: &Model) -> Checked<()> {
    let none = matches!(radial, None | Some(Drive::Constant(0.0)));
    let message = "x is the radius of axisymmetric bodies, and gravity has no such direction: give y alone";
    refuse_if(!none && model.mesh.section.is_axisymmetric(), format!("{place}.gravity.x"), message)?;
    Ok(())
}

/// Checks that the expressions of a step are finite at many times and places; errors name their keys.
pub fn check_defined(place: &str, given: &LoadStep, scheme: Scheme, span: Span, model: &Model) -> Checked<()> {
    // A static step is not evaluated at its start.
    let first = usize::from(!scheme.is_dynamic());
    let times = || span.times(TIMES).skip(first);
    let check = |key: &str, drive: &Drive, places: &[Vector2<f64>]| {
        let undefined =
            |at: &Vector2<f64>| times().find(|time| !drive.value(*at, *time, span, 0.0).is_finite()).map(|t| (t, *at));
        match places.iter().find_map(undefined) {
            None => Ok(()),
            Some((time, at)) => {
                let (time, at) = (number(time), vector(at));
                let message = format!("has no finite value at t = {time}, (x, y) = {at}: check the expression");
                Err(ModelError::new(format!("{place}.{key}"), message))
            }
        }
    };
    for (key, on_edges, on, drive) in drives(given) {
        if let Drive::Expression(expression) = drive {
            let mut places = positions(on_edges, on, model);
            places.truncate(if expression.depends_on_position() { PLACES } else { 1 });
            check(&key, drive, &places)?;
        }
    }
    Ok(())
}

/// All drives of a step, with their keys and places, and whether they are evaluated on edges.
fn drives(given: &LoadStep) -> Vec<(String, bool, &Place, &Drive)> {
    let mut drives = Vec::new();
    for (k, support) in given.supports.iter().enumerate() {
        let motions = support.motions().filter_map(|(key, change)| Some((key, change.given()?)));
        let turned =
            support.rotation.as_ref().and_then(Change::given).map(|rotation| ("rotation.angle", &rotation.angle));
        let key = |key| format!("supports[{k}].{key}");
        drives.extend(motions.chain(turned).map(|(own, drive)| (key(own), false, &support.on, drive)));
    }
    for (k, load) in given.loads.iter().enumerate() {
        drives.extend(
            load.drives().map(|(key, on_edges, drive)| (format!("loads[{k}].{key}"), on_edges, &load.on, drive)),
        );
    }
    drives
}

/// Places where a drive is evaluated: nodes, or Gauss points of edges; a limited number from end to end.
fn positions(on_edges: bool, on: &Place, model: &Model) -> Vec<Vector2<f64>> {
    let gauss = |name: &str| Some(edge_weights(&model.mesh, edges(&model.mesh, name, "").ok()?));
    let all: Vec<Vector2<f64>> = match on {
        Place::Group(name) if on_edges => gauss(name).into_iter().flatten().map(|share| share.position).collect(),
        _ => nodes_at(&model.mesh, on, "").into_iter().flatten().map(|node| model.mesh.nodes[node]).collect(),
    };
    some_of(all)
}
