//! Warning about contacts of curved surfaces that are closed on a few edges, whose resultants may be right and tractions are not, and about ridges
//! that press on long ones.

use std::collections::BTreeMap;

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use crate::contact::stretch::Stretch;
use crate::contact::{ContactPair, ContactState, Master};
use crate::mesh::configuration::Configuration;
use crate::model::scheme::{Scheme, time_text};
use crate::model::text::{self, count};
use crate::model::{Model, State, Step};
use crate::run::observer::Attempt;

/// Number of tractions along a contact below which a warning is given: on four linear edges the largest pressure of Hertz's problem is right to a
/// tenth, on three, two and one by mortar up to 40, 57 and 60 % off [-]
const FEW: f64 = 3.5;

/// Number of tractions along a contact on edges as advised [-]
const ENOUGH: f64 = 6.0;

/// Force of a contact over that of the most loaded one, below which a warning is not given [-]
const LIGHT: f64 = 1e-3;

/// Cosine of the angle up to which a support is along a surface.
const ALONG: f64 = 0.99;

/// The largest force of each contact so far, and what is to be said of it then.
#[derive(Clone, Default, Serialize, Deserialize)]
pub struct FewEdges {
    most: BTreeMap<usize, (f64, Option<String>)>,
}

impl FewEdges {
    /// Looks at an accepted increment with a larger force than any before. (Explicit ones are too many, and their waves let go of points.)
    pub fn record(&mut self, model: &Model, attempt: &Attempt, state: &State, x: &Configuration) {
        let step = attempt.step;
        if matches!(step.scheme, Scheme::Explicit { .. }) {
            return;
        }
        let contacts = model.contacts.iter().zip(&state.contacts).enumerate();
        for (k, (pair, states)) in contacts.filter(|(_, (pair, _))| step.joins(pair)) {
            let force: f64 = states.iter().map(|state| state.contact_pressure() * state.length).sum();
            if force > self.most.get(&k).map_or(0.0, |(most, _)| *most) {
                self.most.insert(k, (force, warning(pair, step, states, state.time, x)));
            }
        }
    }

    /// The warnings, each of which is reported once.
    pub fn warnings(&mut self) -> impl Iterator<Item = String> {
        let most = std::mem::take(&mut self.most);
        let largest = most.values().map(|(force, _)| *force).fold(0.0, f64::max);
        most.into_values().filter(move |(force, _)| *force > LIGHT * largest).filter_map(|(_, message)| message)
    }
}

fn warning(pair: &ContactPair, step: &Step, states: &[ContactState], time: f64, x: &Configuration) -> Option<String> {
    let is_constrained = |node: usize, along: Vector2<f64>| {
        step.supports
            .iter()
            .any(|support| support.at.node() == node && support.at.vector().dot(&along).abs() > ALONG * along.norm())
    };
    let Stretch { at, closed, is_ridge, length, edge, per_edge } = pair
        .stretch(states, x, is_constrained)
        .filter(|stretch| stretch.length * stretch.per_edge < FEW * stretch.edge)?;
    let both = if matches!(pair.master, Master::Mesh(_)) { " on both sides" } else { "" };
    let wrong = match is_ridge {
        true => "a corner presses, with a force that goes by the edges, and to and fro as it slides over them",
        false => "its resultant may be right, but its pressure and shear are not",
    };
    Some(format!(
        "contact `{}` at {}, t = {}: closed over {} with edges of {edge:.2e}, where the contact is about {length:.2e} \
         long: {wrong}; take edges of {:.1e} there{both}",
        pair.name,
        text::vector(at),
        time_text(time),
        count(closed, "point"),
        length * per_edge / ENOUGH
    ))
}
