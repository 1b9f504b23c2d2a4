//! What a caller may ask a run for, and lead, between its increments: groups, contacts and fields by their names.

use nalgebra::Vector2;
use thiserror::Error;

use super::simulation::Simulation;
use crate::contact::force::ContactState;
use crate::contact::pair;
use crate::contact::pair::ContactPair;
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
    /// No group of the mesh.
    #[error(transparent)]
    Group(#[from] UnknownGroup),
    /// There is no such contact.
    #[error("there is no contact `{name}`; there are {known}")]
    Contact {
        /// what was asked for
        name: String,
        /// what there is
        known: String,
    },
    /// No field of a contact.
    #[error("contacts have no field `{name}`; they have {known}")]
    Field {
        /// what was asked for
        name: String,
        /// what there is
        known: String,
    },
    /// There is no support of that kind.
    #[error("`{group}` has no support along {axis} in step `{step}` that could be driven")]
    Support {
        /// the group
        group: String,
        /// x or y
        axis: char,
        /// the step under way
        step: String,
    },
}

/// A direction of a displacement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// x
    X,
    /// y
    Y,
}

impl Simulation {
    /// Number of the step of the next increment.
    pub fn step_number(&self) -> usize {
        self.control.step
    }

    /// Whether a reaction has ended a step before its time, so that those after it begin earlier than the model says.
    pub fn has_ended_early(&self) -> bool {
        !self.control.ended.is_empty()
    }

    /// Sum of what the supports of a group put on its nodes [F].
    ///
    /// # Errors
    /// [`Unknown::Group`].
    pub fn reaction(&self, group: &str) -> Result<Vector2<f64>, Unknown> {
        let nodes = self.nodes(group)?;
        let sum =
            |i: usize| self.model().held(&nodes, i).into_iter().map(|node| self.state().reaction[2 * node + i]).sum();
        Ok(Vector2::new(sum(0), sum(1)))
    }

    /// Mean displacement of the nodes of a group [L].
    ///
    /// # Errors
    /// [`Unknown::Group`].
    pub fn displacement(&self, group: &str) -> Result<Vector2<f64>, Unknown> {
        let nodes = self.nodes(group)?;
        let sum: Vector2<f64> = nodes.iter().map(|&node| vector(&self.state().displacement, node)).sum();
        Ok(sum / nodes.len() as f64)
    }

    /// A field of a contact by its name, see [`pair::field_values`], one value a slave point in their order.
    ///
    /// # Errors
    /// [`Unknown::Contact`], [`Unknown::Field`].
    pub fn contact_field(&self, contact: &str, field: &str) -> Result<Vec<f64>, Unknown> {
        let (pair, states) = self.contact(contact)?;
        let names = pair::field_names(&self.model().contacts);
        if !names.contains(&field) {
            return Err(Unknown::Field { name: field.into(), known: names.join(", ") });
        }
        Ok(pair::field_values(pair, states, self.state().time, self.state().dt, field))
    }

    /// Positions of the slave points of a contact, in their order [L].
    ///
    /// # Errors
    /// [`Unknown::Contact`].
    pub fn contact_positions(&self, contact: &str) -> Result<Vec<Vector2<f64>>, Unknown> {
        let (pair, _) = self.contact(contact)?;
        let x = self.model().configuration(&self.state().displacement);
        Ok(pair.points.iter().map(|point| point.at(&x)).collect())
    }

    /// Force of a contact on its slave, as `force_x` and `force_y` of the history: pressure, friction and radiation
    /// damping, without fluid pressure [F].
    ///
    /// # Errors
    /// [`Unknown::Contact`].
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

    /// Drive the supports of a group linearly from their present position to a displacement at a time, and hold them
    /// there, as the piston of a testing machine is controlled between two increments.
    ///
    /// # Errors
    /// [`Unknown::Group`], and [`Unknown::Support`] where a node is not supported in this direction.
    pub fn lead(&mut self, group: &str, axis: Axis, to: f64, by: f64) -> Result<(), Unknown> {
        let model = self.model();
        let dofs: Vec<usize> = self
            .nodes(group)?
            .iter()
            .map(|&node| model.linkage.leading(2 * model.ties.original(node) + axis as usize))
            .collect();
        let held = |dof: &usize| {
            let of_node = |support: &&Prescribed| support.at.node() == dof / 2;
            let mut all = self.step().supports.iter().filter(of_node);
            let straight = all.clone().any(|support| support.at == Direction::from(*dof));
            // What inclined supports say of a node does not follow one of its components.
            straight && !all.any(|support| matches!(support.motion, Motion::Inclined(_)))
        };
        if !dofs.iter().all(held) {
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

    /// Bound the increments of the step under way, from the next one to its end: as `max` and `min` of its `dt`, of which the one
    /// that is not given stays, but for a `min` above the new `max`, which comes down to it.
    ///
    /// # Errors
    /// [`ModelError`] as of the `dt` of a step; the bounds are then as they were.
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
