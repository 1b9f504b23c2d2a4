//! Queries and prescribed motions between the increments of a run: groups, contacts and fields by their names.

use nalgebra::Vector2;
use thiserror::Error;

use super::simulation::Simulation;
use crate::bars::fields::{AT_POINTS, OF_SEGMENTS};
use crate::bars::{Bar, BarState};
use crate::contact::pair;
use crate::contact::{ContactPair, ContactState};
use crate::mesh::UnknownGroup;
use crate::mesh::configuration::vector;
use crate::model::Step;
use crate::model::boundary::{Drive, Span};
use crate::model::builder::ModelError;
use crate::model::builder::schedule::check_bounds;
use crate::model::support::{Direction, Motion, Prescribed};

/// A name that a run does not know.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum Unknown {
    /// The mesh has no such group.
    #[error(transparent)]
    Group(#[from] UnknownGroup),
    /// The model has no such contact.
    #[error("there is no contact `{name}`; there are {known}")]
    Contact {
        /// requested name
        name: String,
        /// contacts of the model
        known: String,
    },
    /// The model has no such bar.
    #[error("there is no bar `{name}`; there are {known}")]
    Bar {
        /// requested name
        name: String,
        /// bars of the model
        known: String,
    },
    /// Bars have no such field.
    #[error("bars have no field `{name}`; they have {known}")]
    BarField {
        /// requested name
        name: String,
        /// fields of bars
        known: String,
    },
    /// Contacts have no such field.
    #[error("contacts have no field `{name}`; they have {known}")]
    Field {
        /// requested name
        name: String,
        /// fields of contacts
        known: String,
    },
    /// The group has no such support.
    #[error("`{group}` has no support along {axis} in step `{step}` that could be driven")]
    Support {
        /// the group
        group: String,
        /// x or y
        axis: char,
        /// current step
        step: String,
    },
}

/// Component of a displacement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// x
    X,
    /// y
    Y,
}

impl Simulation {
    /// Returns the number of the step of the next increment.
    pub fn step_number(&self) -> usize {
        self.control.step
    }

    /// Whether a step has ended early at its target reaction, so that later steps begin before their planned times.
    pub fn has_ended_early(&self) -> bool {
        !self.control.ended.is_empty()
    }

    /// Returns the sum of the support reactions on the nodes of a group [F].
    ///
    /// # Errors
    /// Returns [`Unknown::Group`] if the mesh has no such group.
    pub fn reaction(&self, group: &str) -> Result<Vector2<f64>, Unknown> {
        let nodes = self.nodes(group)?;
        let sum = |i: usize| {
            self.model().constrained(&nodes, i).into_iter().map(|node| self.state().reaction[2 * node + i]).sum()
        };
        Ok(Vector2::new(sum(0), sum(1)))
    }

    /// Returns the mean displacement of the nodes of a group [L].
    ///
    /// # Errors
    /// Returns [`Unknown::Group`] if the mesh has no such group.
    pub fn displacement(&self, group: &str) -> Result<Vector2<f64>, Unknown> {
        let nodes = self.nodes(group)?;
        let sum: Vector2<f64> = nodes.iter().map(|&node| vector(&self.state().displacement, node)).sum();
        Ok(sum / nodes.len() as f64)
    }

    /// Returns a field of a contact by its name (see [`pair::field_values`]), one value per slave point in their order.
    ///
    /// # Errors
    /// Returns [`Unknown::Contact`] or [`Unknown::Field`] if there is no such contact or field.
    pub fn contact_field(&self, contact: &str, field: &str) -> Result<Vec<f64>, Unknown> {
        let (pair, states) = self.contact(contact)?;
        let names = pair::field_names(&self.model().contacts);
        if !names.contains(&field) {
            return Err(Unknown::Field { name: field.into(), known: names.join(", ") });
        }
        Ok(pair::field_values(pair, states, self.state().time, self.state().dt, field))
    }

    /// Returns a quantity of a bar: of its points `moment`, `slip`, `bond_shear` and `bond_normal`, or of its segments `axial_force`,
    /// `shear_force` and `yielding`.
    ///
    /// # Errors
    /// Returns [`Unknown`] if the model has no such bar or bars have no such quantity.
    pub fn bar_field(&self, bar: &str, field: &str) -> Result<Vec<f64>, Unknown> {
        let (own, state) = self.bar(bar)?;
        let known = || AT_POINTS.into_iter().chain(OF_SEGMENTS).collect::<Vec<_>>().join(", ");
        own.field(state, field).ok_or_else(|| Unknown::BarField { name: field.into(), known: known() })
    }

    /// Returns the positions of the points of a bar, in their order [L].
    ///
    /// # Errors
    /// Returns [`Unknown::Bar`] if the model has no such bar.
    pub fn bar_positions(&self, bar: &str) -> Result<Vec<Vector2<f64>>, Unknown> {
        let (own, _) = self.bar(bar)?;
        let u = &self.state().displacement;
        Ok(own.vertices.iter().map(|vertex| vertex.at + vertex.displacement(u)).collect())
    }

    fn bar(&self, name: &str) -> Result<(&Bar, &BarState), Unknown> {
        let mut bars = self.model().bars.iter().zip(&self.state().bars);
        bars.find(|(bar, _)| bar.name == name).ok_or_else(|| Unknown::Bar {
            name: name.into(),
            known: self.model().bars.iter().map(|bar| bar.name.as_str()).collect::<Vec<_>>().join(", "),
        })
    }

    /// Returns the pressure of water that flows through bodies at every node of the mesh, NaN at others [F/L²].
    pub fn pore_pressures(&self) -> Vec<f64> {
        let nodes = self.model().mesh.own_nodes();
        let found =
            self.model().flow.as_ref().map(|flow| flow.at_nodes(&self.model().mesh, &self.state().displacement));
        found.map_or_else(
            || vec![f64::NAN; nodes],
            |mut all| {
                all.truncate(nodes);
                all
            },
        )
    }

    /// Returns the positions of the slave points of a contact, in their order [L].
    ///
    /// # Errors
    /// Returns [`Unknown::Contact`] if the model has no such contact.
    pub fn contact_positions(&self, contact: &str) -> Result<Vec<Vector2<f64>>, Unknown> {
        let (pair, _) = self.contact(contact)?;
        let x = self.model().configuration(&self.state().displacement);
        Ok(pair.points.iter().map(|point| point.at(&x)).collect())
    }

    /// Returns the force of a contact on its slave, as `force_x` and `force_y` of the history: pressure, friction and radiation
    /// damping, without fluid pressure [F].
    ///
    /// # Errors
    /// Returns [`Unknown::Contact`] if the model has no such contact.
    pub fn contact_force(&self, contact: &str) -> Result<Vector2<f64>, Unknown> {
        let (pair, states) = self.contact(contact)?;
        let x = self.model().configuration(&self.state().displacement);
        Ok(pair.resultant(states, &x, Vector2::zeros()).force)
    }

    fn contact(&self, name: &str) -> Result<(&ContactPair, &[ContactState]), Unknown> {
        let contacts = &self.model().contacts;
        let Some(k) = contacts.iter().position(|pair| pair.name == name) else {
            let known = contacts.iter().map(|pair| pair.name.as_str()).collect::<Vec<_>>().join(", ");
            return Err(Unknown::Contact { name: name.into(), known });
        };
        Ok((&contacts[k], &self.state().contacts[k]))
    }

    /// Drives the supports of a group linearly from their current position to the displacement `to` at the time `by`, and holds
    /// them there, as the piston of a testing machine is controlled between two increments.
    ///
    /// # Errors
    /// Returns [`Unknown::Group`] if the mesh has no such group, [`Unknown::Support`] if a node is not supported in this
    /// direction.
    pub fn prescribe(&mut self, group: &str, axis: Axis, to: f64, by: f64) -> Result<(), Unknown> {
        let model = self.model();
        let dofs: Vec<usize> = self
            .nodes(group)?
            .iter()
            .map(|&node| model.linkage.leading(2 * model.ties.original(node) + axis as usize))
            .collect();
        let constrained = |dof: &usize| {
            let of_node = |support: &&Prescribed| support.at.node() == dof / 2;
            let mut all = self.step().supports.iter().filter(of_node);
            let straight = all.clone().any(|support| support.at == Direction::from(*dof));
            // The condition of an inclined support couples both components and cannot follow one of them.
            straight && !all.any(|support| matches!(support.motion, Motion::Inclined(_)))
        };
        if !dofs.iter().all(constrained) {
            let axis = if axis == Axis::X { 'x' } else { 'y' };
            return Err(Unknown::Support { group: group.into(), axis, step: self.step().name.clone() });
        }
        let now = self.state().time;
        let from: Vec<f64> = dofs.iter().map(|&dof| self.state().displacement[dof]).collect();
        self.change(|step| {
            let span = step.span;
            for support in &mut step.supports {
                if let Some(k) = dofs.iter().position(|dof| *dof == support.at.dof) {
                    support.motion = Motion::Displacement(Drive::Table(vec![[now, from[k]], [by, to]]), span);
                }
            }
        });
        Ok(())
    }

    /// Bounds the increments of the current step from the next one to its end, as `max` and `min` of its `dt`. A bound that is
    /// not given is kept, except that a `min` above the new `max` is lowered to it.
    ///
    /// # Errors
    /// Returns the [`ModelError`] that `dt` of a step would give; the bounds are then unchanged.
    pub fn bound_increments(&mut self, max: Option<f64>, min: Option<f64>) -> Result<(), ModelError> {
        let Step { increments, span, scheme, .. } = self.step();
        let max = max.unwrap_or(increments.max);
        let min = min.unwrap_or(increments.min.min(max));
        let left = Span { start: self.state().time, end: span.end };
        check_bounds("increments", [min, max], left, *scheme)?;
        self.change(|step| (step.increments.min, step.increments.max) = (min, max));
        Ok(())
    }

    fn nodes(&self, group: &str) -> Result<Vec<usize>, Unknown> {
        let mesh = &self.model().mesh;
        Ok(mesh.nodes_of(mesh.group(group)?))
    }
}
