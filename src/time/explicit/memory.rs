//! What explicit increments remember that follows neither from the model nor from the state: when each element was looked at,
//! and what was found then. A run that goes on from a file takes the same increments with it.

use std::sync::Arc;

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use super::Explicit;
use super::element::Element;
use super::stability::{Stability, filled, heated};
use crate::model::{Model, Step};

/// What explicit increments remember.
#[derive(Serialize, Deserialize)]
pub struct ExplicitMemory {
    care: f64,
    stable: f64,
    elements: Vec<Element>,
    seen: Vec<[f64; 2]>,
    softness: Vec<f64>,
    segments: Vec<Option<usize>>,
    since: usize,
    relooked: bool,
    margin: f64,
}

impl ExplicitMemory {
    /// Whether it is one of this model.
    pub fn fits(&self, model: &Model) -> bool {
        let elements = model.mesh.elements.len();
        let points: usize = model.contacts.iter().map(|pair| pair.points.len()).sum();
        self.elements.len() == elements
            && self.seen.len() == elements * stride(model)
            && self.softness.len() == model.mesh.nodes.len()
            && self.segments.len() == points
    }
}

impl Explicit {
    /// What it remembers.
    pub fn memory(&self) -> ExplicitMemory {
        let Stability { elements, seen, softness, segments, since, relooked, margin, .. } = self.stability.clone();
        let seen = seen.into_iter().map(Into::into).collect();
        let (care, stable) = (self.care, self.stable);
        ExplicitMemory { care, stable, elements, seen, softness, segments, since, relooked, margin }
    }

    /// Go on from what was remembered.
    pub fn again(model: &Arc<Model>, step: &Arc<Step>, memory: ExplicitMemory) -> Self {
        let ExplicitMemory { care, stable, elements, seen, softness, segments, since, relooked, margin } = memory;
        let stride = stride(model);
        let stability = Stability {
            model: model.clone(),
            retardation: model.retardations(step),
            elements,
            nodes: model.mesh.elements.iter().flat_map(|element| filled(&element.nodes, stride)).collect(),
            seen: seen.into_iter().map(Vector2::from).collect(),
            stride,
            softness,
            segments,
            since,
            relooked,
            margin,
            heated: heated(model),
        };
        Self { stable, ..Self::of(model, step, stability, care) }
    }
}

/// Most nodes of an element.
fn stride(model: &Model) -> usize {
    model.mesh.elements.iter().map(|element| element.nodes.len()).max().unwrap_or(0)
}
