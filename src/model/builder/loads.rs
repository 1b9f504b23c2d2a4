//! Loads in force: those of the previous step, unless they are replaced or ended.
//!
//! Expressions of supports and loads are evaluated throughout their step before the run.

use std::collections::BTreeMap;

use nalgebra::Vector2;

use super::error::{Checked, ModelError, check_not_negative};
use super::groups::{Place, edges, group_at, node_lists, nodes_at};
use super::load::{Action, Change, Components, DashpotLoad, Load, SpringLoad};
use super::load_step::LoadStep;
use super::plates::plate_of_moment;
use super::rigid;
use super::section::check_gravity;
use super::shares::{Share, absorbers, edge_shares, even_shares, mass_shares, pressure_shares};
use super::supports::frees_nothing;
use crate::model::Model;
use crate::model::boundary::{Amplitude, Dashpot, DeadLoad, Drive, FollowerPressure, Loads, PlateMoment, Span, Spring};
use crate::model::scheme::Scheme;
use crate::model::text::number;

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
pub struct LoadsInForce(BTreeMap<(String, Kind), Loads>);

/// Kind of a load, which replaces an earlier one of the same kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    Pressure,
    DeadPressure,
    Traction,
    Gravity,
    Force,
    TotalForce,
    Spring,
    Dashpot,
    Absorbing,
    Moment,
}

/// Returns the kind of an action, and whether it ends the load.
fn kind(action: Action) -> (Kind, bool) {
    match action {
        Action::Pressure(given) => (Kind::Pressure, given.is_none()),
        Action::DeadPressure(given) => (Kind::DeadPressure, given.is_none()),
        Action::Traction(given) => (Kind::Traction, given.is_none()),
        Action::Gravity(given) => (Kind::Gravity, given.is_none()),
        Action::Force(given) => (Kind::Force, given.is_none()),
        Action::TotalForce(given) => (Kind::TotalForce, given.is_none()),
        Action::Spring(given) => (Kind::Spring, given.is_none()),
        Action::Dashpot(given) => (Kind::Dashpot, given.is_none()),
        Action::Absorbing(absorbs) => (Kind::Absorbing, !absorbs),
        Action::Moment(given) => (Kind::Moment, given.is_none()),
    }
}

/// Returns the single action of a load.
fn action<'l>(load: &'l Load, place: &str) -> Checked<Action<'l>> {
    let message = "must give exactly one of pressure, dead_pressure, traction, gravity, force, total_force, moment, spring, dashpot, \
                   absorbing";
    load.action().ok_or_else(|| ModelError::new(place, message))
}

impl LoadsInForce {
    /// Returns the loads in a step of a model, including those of earlier steps.
    ///
    /// # Errors
    /// Returns none for a model that was built from these steps.
    pub fn of_step(number: usize, given: &[LoadStep], model: &Model) -> Checked<Self> {
        let mut in_force = Self::default();
        for (k, (given, step)) in given.iter().zip(&model.steps).enumerate().take(number + 1) {
            for (j, load) in given.loads.iter().enumerate() {
                in_force.change(load, &format!("steps[{k}].loads[{j}]"), step.span, model)?;
            }
        }
        Ok(in_force)
    }

    /// Changes or ends a load from the start of a span within a step on.
    ///
    /// # Errors
    /// Returns the same errors as for a step.
    pub fn change_within(&mut self, load: &Load, place: &str, span: Span, model: &Model) -> Checked<()> {
        let key = (
            load.on.settled(&model.mesh).unwrap_or_else(|_| load.on.clone()).to_string(),
            kind(action(load, place)?).0,
        );
        for before in self.0.get_mut(&key).into_iter().flat_map(Loads::amplitudes) {
            *before = before.settled(span.start);
            if before.chain().count() > MOST_REMEMBERED {
                let message = "was changed too often for one that varies in space: give it as an expression in t";
                return Err(ModelError::new(place, message));
            }
        }
        self.change(load, place, span, model)
    }

    /// Returns all loads.
    pub fn all(&self) -> Loads {
        let mut all = Loads::default();
        for load in self.0.values() {
            all.dead.extend(load.dead.iter().cloned());
            all.pressures.extend(load.pressures.iter().cloned());
            all.springs.extend(load.springs.iter().cloned());
            all.dashpots.extend(load.dashpots.iter().cloned());
            all.absorbers.extend(load.absorbers.iter().cloned());
            all.moments.extend(load.moments.iter().cloned());
        }
        all
    }

    /// Changes or ends a load.
    pub(super) fn change(&mut self, load: &Load, place: &str, span: Span, model: &Model) -> Checked<()> {
        let action = action(load, place)?;
        let (kind, ends) = kind(action);
        let on = load.on.settled(&model.mesh).map_err(|message| ModelError::new(format!("{place}.on"), message))?;
        let key = (on.to_string(), kind);
        if ends && !self.0.contains_key(&key) {
            return Err(frees_nothing(place, &load.on));
        }
        let before = self.0.remove(&key).unwrap_or_default();
        let made = Changing { load, place, span, model, before }.made(action)?;
        // A load that decreases to zero stays until something replaces it.
        if !(ends && matches!(kind, Kind::Spring | Kind::Dashpot | Kind::Absorbing)) {
            self.0.insert(key, made);
        }
        Ok(())
    }
}

/// A spring or dashpot.
struct Link<'l> {
    key: &'static str,
    /// coefficients along x and y with their keys
    values: [(&'static str, f64); 2],
    driver: &'l Option<Components>,
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
    fn made(self, action: Action) -> Checked<Loads> {
        let Self { load: Load { on, .. }, place, model, .. } = self;
        let at = format!("{place}.on");
        match action {
            Action::Pressure(given) => self.pressure(given),
            Action::DeadPressure(given) => {
                let edges = edges(&model.mesh, group_at(on, place)?, &at)?;
                self.dead_pressure(given, pressure_shares(&model.mesh, edges))
            }
            Action::Traction(given) => {
                let edges = edges(&model.mesh, group_at(on, place)?, &at)?;
                let shares = edge_shares(&model.mesh, edges);
                self.dead("traction", given, [shares.clone(), shares])
            }
            Action::Gravity(given) => {
                check_gravity(given.and_then(|given| given.along(0)), place, model)?;
                let shares = mass_shares(model, group_at(on, place)?, &at)?;
                self.dead("gravity", given, [shares.clone(), shares])
            }
            Action::Force(given) => {
                let nodes = nodes_at(&model.mesh, on, &at)?;
                let shares: Vec<Share> = nodes.into_iter().map(|node| (node, 1.0, model.mesh.nodes[node])).collect();
                self.dead("force", given, [shares.clone(), shares])
            }
            Action::TotalForce(given) => {
                let edges = edges(&model.mesh, group_at(on, place)?, &at)?;
                check_even(given, place)?;
                let shares = even_shares(&model.mesh, edges);
                self.dead("total_force", given, [shares.clone(), shares])
            }
            Action::Moment(given) => self.moment(given),
            Action::Spring(given) => self.springs(given),
            Action::Dashpot(given) => self.dashpots(given),
            Action::Absorbing(absorbs) => {
                let edges = edges(&model.mesh, group_at(on, place)?, &at)?;
                let absorbers = if absorbs { absorbers(model, edges) } else { Vec::new() };
                Ok(Loads { absorbers, ..Loads::default() })
            }
        }
    }

    fn pressure(self, given: Option<&Drive>) -> Checked<Loads> {
        let Self { load, place, span, model, before } = self;
        let edges = node_lists(edges(&model.mesh, group_at(&load.on, place)?, &format!("{place}.on"))?);
        let before = before.pressures.into_iter().next().map(|load| load.amplitude);
        let amplitude = amplitude(given, before, &format!("{place}.pressure"), span)?;
        let pressures = amplitude.map(|amplitude| FollowerPressure { amplitude, edges }).into_iter().collect();
        Ok(Loads { pressures, ..Loads::default() })
    }

    fn dead_pressure(self, given: Option<&Drive>, shares: [Vec<Share>; 2]) -> Checked<Loads> {
        let Self { place, span, before, .. } = self;
        let before = before.dead.into_iter().next().map(|load| load.amplitude);
        let Some(amplitude) = amplitude(given, before, &format!("{place}.dead_pressure"), span)? else {
            return Ok(Loads::default());
        };
        let along = |(component, shares)| DeadLoad { component, amplitude: amplitude.clone(), shares };
        Ok(Loads { dead: shares.into_iter().enumerate().map(along).collect(), ..Loads::default() })
    }

    fn dead(self, key: &str, given: Option<&Components>, shares: [Vec<Share>; 2]) -> Checked<Loads> {
        let Self { place, span, before, .. } = self;
        let mut dead = Vec::new();
        for (component, (name, shares)) in ["x", "y"].into_iter().zip(shares).enumerate() {
            let given = given.and_then(|given| given.along(component));
            let before = before.dead.iter().find(|load| load.component == component).map(|load| load.amplitude.clone());
            let amplitude = amplitude(given, before, &format!("{place}.{key}.{name}"), span)?;
            dead.extend(amplitude.map(|amplitude| DeadLoad { component, amplitude, shares }));
        }
        Ok(Loads { dead, ..Loads::default() })
    }

    fn moment(self, given: Option<&Drive>) -> Checked<Loads> {
        let Self { load, place, span, model, before } = self;
        if let Some(body) = rigid::of_moment(&load.on, model) {
            let before = before.dead.into_iter().next().map(|load| load.amplitude);
            let amplitude = amplitude(given, before, &format!("{place}.moment"), span)?;
            let shares = vec![(body.turning, 1.0 / body.radius, model.mesh.nodes[body.turning])];
            let dead = amplitude.map(|amplitude| DeadLoad { component: 0, amplitude, shares });
            return Ok(Loads { dead: dead.into_iter().collect(), ..Loads::default() });
        }
        let plate = plate_of_moment(model, &load.on, place)?;
        let before = before.moments.into_iter().next().map(|moment| moment.amplitude);
        let amplitude = amplitude(given, before, &format!("{place}.moment"), span)?;
        let moments = amplitude.map(|amplitude| PlateMoment { plate, amplitude }).into_iter().collect();
        Ok(Loads { moments, ..Loads::default() })
    }

    fn springs(self, given: Option<&SpringLoad>) -> Checked<Loads> {
        let link = given.map(|given| Link {
            key: "spring",
            values: [("kx", given.kx), ("ky", given.ky)],
            driver: &given.driver,
        });
        let before = |component: usize| self.before.springs.iter().find(|spring| spring.dof % 2 == component);
        let links = self.links(link, |component| before(component)?.driver.clone())?;
        let springs = links.into_iter().map(|(dof, stiffness, driver)| Spring { dof, stiffness, driver }).collect();
        Ok(Loads { springs, ..Loads::default() })
    }

    fn dashpots(self, given: Option<&DashpotLoad>) -> Checked<Loads> {
        let link = given.map(|given| Link {
            key: "dashpot",
            values: [("cx", given.cx), ("cy", given.cy)],
            driver: &given.driver,
        });
        let before = |component: usize| self.before.dashpots.iter().find(|dashpot| dashpot.dof % 2 == component);
        let links = self.links(link, |component| before(component)?.driver.clone())?;
        let dashpots =
            links.into_iter().map(|(dof, coefficient, driver)| Dashpot { dof, coefficient, driver }).collect();
        Ok(Loads { dashpots, ..Loads::default() })
    }

    /// Dof, coefficient and driver of every spring or dashpot with a nonzero coefficient.
    fn links(
        &self,
        given: Option<Link>,
        before: impl Fn(usize) -> Option<Amplitude>,
    ) -> Checked<Vec<(usize, f64, Option<Amplitude>)>> {
        let nodes = nodes_at(&self.model.mesh, &self.load.on, &format!("{}.on", self.place))?;
        let Some(Link { key, values, driver }) = given else { return Ok(Vec::new()) };
        let mut links = Vec::new();
        for (component, (name, coefficient)) in values.into_iter().enumerate() {
            check_not_negative(&format!("{}.{key}.{name}", self.place), coefficient)?;
            if coefficient == 0.0 {
                continue;
            }
            let drive = driver.as_ref().and_then(|driver| driver.along(component));
            let place = format!("{}.{key}.driver", self.place);
            let driver = amplitude(drive, before(component), &place, self.span)?;
            links.extend(nodes.iter().map(|node| (2 * node + component, coefficient, driver.clone())));
        }
        Ok(links)
    }
}

/// Checks that a total force on edges does not vary in space.
fn check_even(given: Option<&Components>, place: &str) -> Checked<()> {
    for (component, name) in ["x", "y"].into_iter().enumerate() {
        if given.and_then(|given| given.along(component)).is_some_and(Drive::depends_on_position) {
            let message = "is the force on the whole group, which does not vary in space: give it in t, or a traction";
            return Err(ModelError::new(format!("{place}.total_force.{name}"), message));
        }
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

/// Number of evenly spaced times of a step at which an expression is checked.
const TIMES: u32 = 100;

/// Maximum number of places of a group at which it is checked.
const PLACES: usize = 50;

/// Checks that the expressions of a step are finite at many times and places; errors name their keys.
pub fn check_defined(place: &str, given: &LoadStep, scheme: Scheme, span: Span, model: &Model) -> Checked<()> {
    // A static step is not evaluated at its start.
    let first = u32::from(!scheme.is_dynamic());
    let times = || (first..=TIMES).map(|k| span.start + f64::from(k) / f64::from(TIMES) * (span.end - span.start));
    let check = |key: &str, drive: &Drive, places: &[Vector2<f64>]| {
        let undefined =
            |at: &Vector2<f64>| times().find(|time| !drive.value(*at, *time, span, 0.0).is_finite()).map(|t| (t, *at));
        match places.iter().find_map(undefined) {
            None => Ok(()),
            Some((time, at)) => {
                let [time, x, y] = [time, at.x, at.y].map(number);
                let message = format!("has no finite value at t = {time}, (x, y) = ({x}, {y}): check the expression");
                Err(ModelError::new(format!("{place}.{key}"), message))
            }
        }
    };
    for (key, on, drive) in drives(given) {
        if let Drive::Expression(expression) = drive {
            let mut places = positions(key.ends_with("pressure") || key.contains(".traction."), on, model);
            places.truncate(if expression.depends_on_position() { PLACES } else { 1 });
            check(&key, drive, &places)?;
        }
    }
    Ok(())
}

/// All drives of a step, with their keys and places.
fn drives(given: &LoadStep) -> Vec<(String, &Place, &Drive)> {
    let mut drives = Vec::new();
    for (k, support) in given.supports.iter().enumerate() {
        let motions = support.displacements().filter_map(|(key, change)| Some((key, change.given()?)));
        let turned =
            support.rotation.as_ref().and_then(Change::given).map(|rotation| ("rotation.angle", &rotation.angle));
        drives.extend(motions.chain(turned).map(|(key, drive)| (format!("supports[{k}].{key}"), &support.on, drive)));
    }
    for (k, load) in given.loads.iter().enumerate() {
        let actions = load.action().map(actions).into_iter().flatten();
        drives.extend(actions.map(|(key, drive)| (format!("loads[{k}].{key}"), &load.on, drive)));
    }
    drives
}

/// Drives of a load with their keys.
fn actions(action: Action<'_>) -> Vec<(String, &Drive)> {
    let alone = |key: &str, drive| Option::into_iter(drive).map(|drive| (key.to_string(), drive)).collect();
    match action {
        Action::Pressure(drive) => alone("pressure", drive),
        Action::DeadPressure(drive) => alone("dead_pressure", drive),
        Action::Moment(drive) => alone("moment", drive),
        Action::Traction(given) => vector("traction", given),
        Action::Gravity(given) => vector("gravity", given),
        Action::Force(given) => vector("force", given),
        Action::TotalForce(given) => vector("total_force", given),
        Action::Spring(given) => vector("spring.driver", given.and_then(|spring| spring.driver.as_ref())),
        Action::Dashpot(given) => vector("dashpot.driver", given.and_then(|dashpot| dashpot.driver.as_ref())),
        Action::Absorbing(_) => Vec::new(),
    }
}

fn vector<'a>(key: &str, components: Option<&'a Components>) -> Vec<(String, &'a Drive)> {
    let along = |(component, name): (usize, &str)| Some((format!("{key}.{name}"), components?.along(component)?));
    ["x", "y"].into_iter().enumerate().filter_map(along).collect()
}

/// Places where a drive is evaluated: nodes, or Gauss points of edges; a limited number from end to end.
fn positions(on_edges: bool, on: &Place, model: &Model) -> Vec<Vector2<f64>> {
    let gauss = |name: &str| Some(edge_shares(&model.mesh, edges(&model.mesh, name, "").ok()?));
    let all: Vec<Vector2<f64>> = match on {
        Place::Group(name) if on_edges => gauss(name).into_iter().flatten().map(|(_, _, at)| at).collect(),
        _ => nodes_at(&model.mesh, on, "").into_iter().flatten().map(|node| model.mesh.nodes[node]).collect(),
    };
    let step = all.len().div_ceil(PLACES - 1).max(1);
    all.iter().step_by(step).chain(all.last()).copied().collect()
}
