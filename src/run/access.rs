//! What a caller may ask a run for, and lead, between its increments: groups, contacts and fields by their names.

use nalgebra::Vector2;
use thiserror::Error;

use super::simulation::Simulation;
use crate::contact::fields;
use crate::mesh::UnknownGroup;
use crate::model::boundary::{Drive, Motion};

/// A name that a run does not know.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Unknown {
    /// No group of the mesh.
    #[error(transparent)]
    Group(#[from] UnknownGroup),
    /// No contact.
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
    /// Nothing is prescribed there.
    #[error("`{group}` has no support along {axis} in step `{step}` that could be led")]
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
    /// Sum of what the supports of a group put on its nodes [F].
    ///
    /// # Errors
    /// [`Unknown::Group`].
    pub fn reaction(&self, group: &str) -> Result<Vector2<f64>, Unknown> {
        Ok(self.nodes(group)?.iter().map(|&node| vector(&self.state().reaction, node)).sum())
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

    /// A field of a contact by its name, see [`fields::value`], one value a slave point in their order.
    ///
    /// # Errors
    /// [`Unknown::Contact`], [`Unknown::Field`].
    pub fn contact_field(&self, contact: &str, field: &str) -> Result<Vec<f64>, Unknown> {
        let contacts = &self.model().contacts;
        let Some(k) = contacts.iter().position(|pair| pair.name == contact) else {
            let known = contacts.iter().map(|pair| pair.name.as_str()).collect::<Vec<_>>().join(", ");
            return Err(Unknown::Contact { name: contact.into(), known });
        };
        let names = fields::names(contacts);
        if !names.contains(&field) {
            return Err(Unknown::Field { name: field.into(), known: names.join(", ") });
        }
        let (pair, state) = (&contacts[k], self.state());
        let points = pair.points.iter().zip(&state.contacts[k]);
        Ok(points.map(|(slave, point)| fields::value(pair, slave, point, state.dt, field)).collect())
    }

    /// Lead the supports of a group from where they are to a displacement at a time, evenly, and hold them there: what the
    /// piston of a testing machine is told between two increments.
    ///
    /// # Errors
    /// [`Unknown::Group`], and [`Unknown::Support`] where a node is not supported in this direction.
    pub fn lead(&mut self, group: &str, axis: Axis, to: f64, by: f64) -> Result<(), Unknown> {
        let dofs: Vec<usize> = self.nodes(group)?.iter().map(|&node| 2 * node + axis as usize).collect();
        let held = |dof: &usize| self.step().supports.iter().any(|support| support.dof == *dof);
        if !dofs.iter().all(held) {
            let axis = if axis == Axis::X { 'x' } else { 'y' };
            return Err(Unknown::Support { group: group.into(), axis, step: self.step().name.clone() });
        }
        let now = self.state().time;
        let from: Vec<f64> = dofs.iter().map(|&dof| self.state().displacement[dof]).collect();
        self.change(|step| {
            let span = step.span;
            for support in &mut step.supports {
                if let Some(k) = dofs.iter().position(|dof| *dof == support.dof) {
                    support.motion = Motion::Displacement(Drive::Table(vec![[now, from[k]], [by, to]]), span);
                }
            }
        });
        Ok(())
    }

    fn nodes(&self, group: &str) -> Result<Vec<usize>, Unknown> {
        let mesh = &self.model().mesh;
        Ok(mesh.nodes_of(mesh.group(group)?))
    }
}

fn vector(values: &[f64], node: usize) -> Vector2<f64> {
    Vector2::new(values[2 * node], values[2 * node + 1])
}
