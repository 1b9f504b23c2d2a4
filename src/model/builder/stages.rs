//! Bodies that come or go with the steps.

use std::cmp::Ordering;
use std::collections::BTreeSet;

use super::error::{Checked, ModelError, refuse_if};
use super::groups;
use super::load_step::{LoadStep, Support};
use crate::contact::pair::ContactPair;
use crate::mesh::{Mesh, MeshError};
use crate::model::boundary::{Drive, Span};
use crate::model::scheme::Scheme;
use crate::model::support::Prescribed;
use crate::model::{BarsInStep, Model};

/// Which bodies are there, step by step.
pub struct Stages<'m> {
    model: &'m Model,
    /// Whether each body is absent
    absent: Vec<bool>,
    /// Whether each bar is absent
    bars_absent: Vec<bool>,
    /// Bars that the step adds or removes
    bars_changed: Vec<usize>,
    /// Whether a step has begun
    has_begun: bool,
}

impl<'m> Stages<'m> {
    /// Before the first step, bodies are absent which a step adds before any removes them.
    pub fn new(given: &[LoadStep], model: &'m Model) -> Self {
        let absent = model.bodies.iter().map(|body| comes(given, &body.name)).collect();
        let bars_absent = model.bars.iter().map(|bar| comes(given, &bar.name)).collect();
        Self { model, absent, bars_absent, bars_changed: Vec::new(), has_begun: false }
    }

    /// Goes on to the next step; returns the bodies that it adds or removes.
    pub fn step(&mut self, given: &LoadStep, scheme: Scheme, place: &str) -> Checked<Vec<usize>> {
        let mut changed = Vec::new();
        self.bars_changed.clear();
        for (key, names, comes) in [("remove", &given.remove, false), ("add", &given.add, true)] {
            for (k, name) in names.iter().enumerate() {
                let place = format!("{place}.{key}[{k}]");
                if let Some(bar) = self.model.bars.iter().position(|bar| bar.name == *name) {
                    self.change_bar(bar, comes, &place)?;
                    continue;
                }
                let body = groups::body(self.model, name, &place)?;
                let message = "comes or goes twice in this step: name it once";
                refuse_if(changed.contains(&body), &place, format!("`{name}` {message}"))?;
                let message = if comes { "is there already" } else { "is not there in this step" };
                refuse_if(self.absent[body] != comes, &place, format!("`{name}` {message}: check the steps before"))?;
                let message = "bodies cannot be added or removed in the first step: let it find the equilibrium under \
                               initial stress and loads, and change bodies in the next";
                refuse_if(!self.has_begun, &place, message)?;
                let message = "has a pore_pressure, which would act on it as if it had always been there: let the body \
                    be present from the start";
                let pressed = comes && self.model.bodies[body].pore_pressure.is_some();
                refuse_if(pressed, &place, format!("`{name}` {message}"))?;
                self.check_platens(body, &place)?;
                self.check_balanced(body, &place)?;
                self.absent[body] = !comes;
                changed.push(body);
            }
        }
        self.has_begun = true;
        let by_masses = scheme.is_integrated_explicitly() || scheme.is_quasi_dynamic() || given.rupture.is_some();
        if let Some(name) = self.fleeting(&changed).filter(|_| by_masses) {
            let message = format!(
                "`{name}` is added or removed, which explicit and quasi-dynamic steps, and `rupture`, cannot follow: \
                make it static or implicit"
            );
            return Err(ModelError::new(place, message));
        }
        self.check_contacts(&changed, place)?;
        changed.sort_unstable();
        Ok(changed)
    }

    /// Name of a body or bar that is absent, or comes or goes.
    fn fleeting(&self, changed: &[usize]) -> Option<&str> {
        let first =
            |absent: &[bool], changed: &[usize]| absent.iter().position(|absent| *absent).or(changed.first().copied());
        let body = first(&self.absent, changed).map(|body| self.model.bodies[body].name.as_str());
        body.or_else(|| Some(self.model.bars[first(&self.bars_absent, &self.bars_changed)?].name.as_str()))
    }

    /// Lets a bar come or go.
    fn change_bar(&mut self, bar: usize, comes: bool, place: &str) -> Checked<()> {
        let name = &self.model.bars[bar].name;
        let message = "comes or goes twice in this step: name it once";
        refuse_if(self.bars_changed.contains(&bar), place, format!("`{name}` {message}"))?;
        let message = if comes { "is there already" } else { "is not there in this step" };
        refuse_if(self.bars_absent[bar] != comes, place, format!("`{name}` {message}: check the steps before"))?;
        let message = "bars cannot be added or removed in the first step: change the bar in the next";
        refuse_if(!self.has_begun, place, message)?;
        self.bars_absent[bar] = !comes;
        self.bars_changed.push(bar);
        Ok(())
    }

    /// What the step does with bars.
    pub fn bars(&self, given: &LoadStep, scheme: Scheme, place: &str) -> Checked<BarsInStep> {
        let Self { model, bars_absent, .. } = self;
        let idle = model.idle_nodes(&self.absent);
        for (bar, _) in model.bars.iter().zip(bars_absent).filter(|(_, absent)| !**absent) {
            let is_away = |name: &&String| {
                model.bodies.iter().zip(&self.absent).any(|(body, absent)| body.name == **name && *absent)
            };
            let has_idle = bar.nodes().into_iter().any(|node| idle.binary_search(&model.ties.original(node)).is_ok());
            let away = bar.bodies.iter().find(is_away).map_or("a body", |name| name.as_str());
            let message = format!(
                "the bar `{}` is joined to {away}, which is not there in this step: add the bar later, or remove it as \
                well",
                bar.name
            );
            refuse_if(has_idle || bar.bodies.iter().any(|name| is_away(&name)), place, message)?;
        }
        let viscous = model.bars.iter().find(|bar| bar.retardation > 0.0).filter(|_| scheme.is_explicit());
        if let Some(bar) = viscous {
            let message = "is not for explicit increments, which know the damping of bars by mass alone: leave it out, or take another scheme";
            return Err(ModelError::new(format!("bars.{}.damping.stiffness", bar.name), message));
        }
        let mut jacks = Vec::new();
        for (name, &force) in &given.prestress {
            let place = format!("{place}.prestress.{name}");
            let bar = model.bars.iter().position(|bar| bar.name == *name).ok_or_else(|| {
                let known: Vec<&str> = model.bars.iter().map(|bar| bar.name.as_str()).collect();
                ModelError::new(&place, format!("there is no bar `{name}`; the bars are {}", known.join(", ")))
            })?;
            let of = &model.bars[bar];
            refuse_if(!force.is_finite(), &place, format!("is {force}: must be a finite number"))?;
            refuse_if(bars_absent[bar], &place, "is not there in this step: add it first")?;
            let message = format!("is {force}, beyond the `limit` {} of the bar", of.limit);
            refuse_if(force.abs() > of.limit, &place, message)?;
            let message = "has bond, and no one force along it: stress its free length, a bar of its own that is joined to its end";
            refuse_if(!of.grips.is_empty(), &place, message)?;
            let message = "is not for wilson, whose equilibrium lies beyond the end of increments: take another scheme";
            refuse_if(scheme.theta() > 1.0, &place, message)?;
            let message = "and `until` cannot be combined: the step would end before the force is reached";
            refuse_if(given.until.is_some(), &place, message)?;
            jacks.push((bar, force));
        }
        let absent = if bars_absent.contains(&true) { bars_absent.clone() } else { Vec::new() };
        let mut changed = self.bars_changed.clone();
        changed.sort_unstable();
        Ok(BarsInStep { absent, changed, jacks })
    }

    /// Nodes that only absent bodies and bars have.
    fn idle(&self) -> Vec<usize> {
        let mut idle = self.model.idle_nodes(&self.absent);
        idle.extend(self.model.idle_bar_nodes(&self.bars_absent));
        idle.sort_unstable();
        idle
    }

    /// Whether each body is absent; empty if all are there.
    pub fn absent(&self) -> Vec<bool> {
        if self.absent.contains(&true) { self.absent.clone() } else { Vec::new() }
    }

    /// The supports of a step, with the nodes constrained that only absent bodies have.
    pub fn constrained(&self, supports: Vec<Prescribed>, span: Span) -> Vec<Prescribed> {
        let idle = self.idle();
        let mut all: Vec<Prescribed> =
            supports.into_iter().filter(|support| idle.binary_search(&support.at.node()).is_err()).collect();
        let dofs = groups::dofs_of(&idle);
        all.extend(dofs.map(|dof| Prescribed::displacement(dof, Drive::Rate(0.0), span)));
        all.sort_by_key(|support| support.at.dof);
        all
    }

    /// Refuses a support that a step gives to absent bodies alone.
    pub fn check_supports(&self, given: &[Support], place: &str) -> Checked<()> {
        let idle = self.idle();
        for (k, support) in given.iter().enumerate() {
            let place = format!("{place}.supports[{k}].on");
            let nodes = groups::nodes_at(&self.model.mesh, &support.on, &place)?;
            let are_idle = nodes.iter().all(|&node| idle.binary_search(&self.model.ties.original(node)).is_ok());
            let message =
                format!("{} belongs to bodies that are not there in this step: leave the support out", support.on);
            refuse_if(are_idle, place, message)?;
        }
        Ok(())
    }

    /// Refuses a platen on a body that comes or goes.
    fn check_platens(&self, body: usize, place: &str) -> Checked<()> {
        let model = self.model;
        let mut platens = model.plates.iter().chain(model.linkage.plates.iter().map(|(nodes, _)| nodes)).flatten();
        let body = &model.bodies[body];
        let message = format!(
            "`{}` has nodes of a loading platen, which would be left without a body: remove the platen first",
            body.name
        );
        refuse_if(platens.any(|node| body.nodes.binary_search(node).is_ok()), place, message)
    }

    /// Checks that contacts come and go as a whole, and that those that come do not depend on mesh positions.
    fn check_contacts(&self, changed: &[usize], place: &str) -> Checked<()> {
        let is_new = |pair: &ContactPair| {
            let mut bodies = pair.bodies.iter().flatten();
            bodies.clone().any(|body| changed.contains(body)) && bodies.all(|&body| !self.absent[body])
        };
        for pair in &self.model.contacts {
            let name = &pair.name;
            let parted = |side: &Vec<usize>| side.iter().any(|body| self.absent[*body] != self.absent[side[0]]);
            let message = "has a side on several bodies, some of which are absent in this step: divide the side, body \
                by body";
            refuse_if(pair.bodies.iter().any(parted), place, format!("the contact `{name}` {message}"))?;
            let message = "has a side on an edge that two present bodies share: surfaces that share nodes cannot \
                           slide. Let the contact begin with the step that removes the other body";
            refuse_if(self.joins(pair) && self.is_shared(pair), place, format!("the contact `{name}` {message}"))?;
            let message = "is not for a contact that begins in a later step, where the pressure in the pores follows \
                           the motion: give it as a number or an expression, or a `pore_pressure` of the body";
            let fluid = format!("contacts.{name}.fluid_pressure");
            refuse_if(is_new(pair) && pair.pores.is_some(), fluid, message)?;
            let offset = !pair.comes_stressed && pair.is_offset();
            let at_places = pair.tied || pair.initial.is_some() || offset;
            let why = format!(
                "adds or removes bodies of the contact `{name}`, along which water flows: let them be present from the \
                start to the end"
            );
            let changes = pair.bodies.iter().flatten().any(|body| changed.contains(body));
            refuse_if(changes && pair.conduit.is_some(), place, why)?;
            let message = "begins in this step, and is tied, starts closed or overlaps in the mesh, whose positions \
                           are not those at that time: let the bodies share nodes, or begin under the stress that acts \
                           by then, \"initial\": {\"of_bodies\": true}, with a body that is absent before";
            refuse_if(is_new(pair) && at_places, place, format!("the contact `{name}` {message}"))?;
        }
        Ok(())
    }

    /// Whether the bodies of both sides are there.
    fn joins(&self, pair: &ContactPair) -> bool {
        pair.bodies.iter().flatten().all(|&body| !self.absent[body])
    }

    /// Whether a side lies on an edge that another body shares, which is there.
    fn is_shared(&self, pair: &ContactPair) -> bool {
        let mesh = &self.model.mesh;
        let nodes: BTreeSet<usize> = pair.nodes().collect();
        let others = mesh.between.values().flatten().map(|side| &side.other);
        let mut shared = others.filter(|other| other.nodes.iter().all(|node| nodes.contains(node)));
        shared.any(|edge| {
            let other = self.model.body_of_element[edge.element];
            !self.absent[other] && !pair.bodies.iter().flatten().any(|body| *body == other)
        })
    }

    /// Refuses a body that comes or goes with forces that stand for its initial stress.
    fn check_balanced(&self, body: usize, place: &str) -> Checked<()> {
        let forces = &self.model.prestress;
        let body = &self.model.bodies[body];
        let has_force = |dof: usize| forces.get(dof).is_some_and(|force| *force != 0.0);
        let message = format!(
            "`{}` is in contact with `balanced` initial tractions, without a stress that could be removed with it: \
             give it an initial_stress, and the contact `of_bodies`",
            body.name
        );
        refuse_if(groups::dofs_of(&body.nodes).any(has_force), place, message)
    }
}

/// Whether a body or bar is absent before the first step: one that is added before it is ever removed.
fn comes(given: &[LoadStep], name: &String) -> bool {
    let first = given.iter().find(|step| step.add.contains(name) || step.remove.contains(name));
    first.is_some_and(|step| step.add.contains(name))
}

/// Bodies that are absent at the start of a run.
pub fn absent_at_start(given: &[LoadStep], model: &Model) -> BTreeSet<usize> {
    let bodies = model.bodies.iter().enumerate();
    bodies.filter(|(_, body)| comes(given, &body.name)).map(|(number, _)| number).collect()
}

/// Gives the named sides between two bodies that share their nodes to the one that is there without the other at the end, or goes later.
pub fn give_sides_owners(mesh: &mut Mesh, given: &[LoadStep]) -> Checked<()> {
    // The step in which a body goes for good, none of one that stays.
    let goes = |name: &String| {
        let last = given.iter().rposition(|step| step.add.contains(name) || step.remove.contains(name));
        last.filter(|k| given[*k].remove.contains(name)).unwrap_or(given.len())
    };
    let mut between = std::mem::take(&mut mesh.between);
    for (group, sides) in &mut between {
        for side in sides {
            let [first, second] = side.bodies(mesh, group);
            match goes(&first).cmp(&goes(&second)) {
                Ordering::Greater => {}
                Ordering::Less => side.swap(mesh, group),
                Ordering::Equal => {
                    let (line, group) = (side.line, group.clone());
                    return Err(ModelError::new("mesh", MeshError::EdgeShared { line, group, first, second }));
                }
            }
        }
    }
    mesh.between = between;
    Ok(())
}
