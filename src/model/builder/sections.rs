//! Sections through a body, at which its normal force, shear force and bending moment are recorded.
//!
//! A station is a place of the axis, and divides the elements of the body by the sides of it on which their middles lie. Its cut is the
//! line of nodes between both parts: where the mesh has lines across the axis, these are the best stations.

use std::collections::BTreeSet;

use nalgebra::Vector2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::error::{Checked, ModelError, check_name, refuse_if};
use super::groups;
use super::requests::outside;
use crate::model::{Axis, Model, Station};

/// Sections across a body along an axis, such as the depth of a wall: its normal force N, shear force Q and bending moment M at stations
/// from one end of the axis to the other
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Sections")]
#[non_exhaustive]
pub struct SectionsInput {
    /// Name in results; their key in a case
    #[serde(skip)]
    pub name: String,
    /// The body that is cut
    pub body: String,
    /// Start of the axis [x, y], in the body of the mesh or on its outline [L]
    pub from: [f64; 2],
    /// End of the axis [x, y] [L]
    pub to: [f64; 2],
    /// Number of stations, including both ends; the k-th is called NAME.k, from 1. By default there is one at every line of the mesh across
    /// the axis, or 51 where there are more than 200
    pub number: Option<usize>,
}

impl SectionsInput {
    /// Creates sections of a body along an axis.
    pub fn new(name: impl Into<String>, body: impl Into<String>, from: [f64; 2], to: [f64; 2]) -> Self {
        Self { name: name.into(), body: body.into(), from, to, number: None }
    }
}

setters! { sections: SectionsInput;
    /// Sets the number of stations, including both ends.
    number(number: usize) { sections.number = Some(number); }
}

/// Most stations by default, at lines of the mesh.
const LINES: usize = 200;

/// Stations where there are more lines.
const OTHERWISE: usize = 51;

/// Most stations that may be asked for.
const MOST: usize = 10_000;

/// Difference of places along the axis that is none, as a part of its length.
const SAME: f64 = 1e-6;

/// Builds the sections of a model.
///
/// # Errors
/// Returns an error for an axis without length or outside of the body.
pub fn sections(given: &[SectionsInput], model: &Model) -> Checked<Vec<Axis>> {
    let mut found: Vec<Axis> = Vec::new();
    for input in given {
        let place = format!("sections.{}", input.name);
        check_name(&place, &input.name)?;
        let body = groups::body(model, &input.body, &format!("{place}.body"))?;
        let [from, to] = [input.from, input.to].map(Vector2::from);
        let length = (to - from).norm();
        let message = format!("is ({}, {}), the start of the axis, or no place: give its other end", to.x, to.y);
        refuse_if(!(length > 0.0 && length.is_finite()), format!("{place}.to"), message)?;
        let line = Line { from, along: (to - from) / length, length };
        let shares = match input.number {
            Some(number) => {
                let message = format!("is {number}: there are 2 to {MOST} stations");
                refuse_if(!(2..=MOST).contains(&number), format!("{place}.number"), message)?;
                equal(number)
            }
            None => line.lines(model, body),
        };
        let station = |share: &f64| line.station(*share, input, body, model);
        let stations = shares.iter().map(station).collect::<Checked<Vec<_>>>()?;
        found.push(Axis { name: input.name.clone(), body, stations });
    }
    Ok(found)
}

fn equal(number: usize) -> Vec<f64> {
    (0..number).map(|k| k as f64 / (number - 1) as f64).collect()
}

/// The axis in the mesh.
struct Line {
    from: Vector2<f64>,
    along: Vector2<f64>,
    length: f64,
}

impl Line {
    /// Place along the axis, as a part of its length.
    fn share(&self, at: Vector2<f64>) -> f64 {
        (at - self.from).dot(&self.along) / self.length
    }

    /// Places of the lines of the mesh across the axis: those of the corners of elements.
    fn lines(&self, model: &Model, body: usize) -> Vec<f64> {
        let elements = model.bodies[body].elements.iter().map(|&e| &model.mesh.elements[e]);
        let corners: BTreeSet<usize> =
            elements.flat_map(|element| element.nodes[..element.kind.corners()].iter().copied()).collect();
        let mut all: Vec<f64> = corners.into_iter().map(|node| self.share(model.mesh.nodes[node])).collect();
        all.extend([0.0, 1.0]);
        all.retain(|share| (-SAME..=1.0 + SAME).contains(share));
        all.sort_by(f64::total_cmp);
        all.dedup_by(|a, b| (*a - *b).abs() <= SAME);
        all.iter_mut().for_each(|share| *share = share.clamp(0.0, 1.0));
        if all.len() > LINES { equal(OTHERWISE) } else { all }
    }

    fn station(&self, share: f64, input: &SectionsInput, body: usize, model: &Model) -> Checked<Station> {
        let mesh = &model.mesh;
        let place = self.from + self.along * (share * self.length);
        let elements = &model.bodies[body].elements;
        let near = |e: &&usize| {
            let reach = mesh.reach(**e);
            (0..2).all(|i| reach.low[i] <= place[i] && place[i] <= reach.high[i])
        };
        let within = elements.iter().filter(near).find_map(|&e| Some((e, mesh.coordinates(e, place)?)));
        let Some((element, at)) = within else {
            return Err(ModelError::new(format!("sections.{}", input.name), outside(model, place, Some(&input.body))));
        };
        let middle = |e: usize| {
            let corners = &mesh.elements[e].nodes[..mesh.elements[e].kind.corners()];
            corners.iter().map(|&node| self.share(mesh.nodes[node])).sum::<f64>() / corners.len() as f64
        };
        let [mut before, mut beyond] = [const { Vec::new() }; 2];
        elements.iter().for_each(|&e| if middle(e) > share { beyond.push(e) } else { before.push(e) });
        let nodes = |part: &[usize]| -> BTreeSet<usize> {
            part.iter().flat_map(|&e| mesh.elements[e].nodes.iter().copied()).collect()
        };
        let cut: Vec<usize> = match before.is_empty() || beyond.is_empty() {
            // At an end of the body what acts there is what the section bears.
            true => {
                let all = nodes(&before).into_iter().chain(nodes(&beyond));
                all.filter(|node| (self.share(mesh.nodes[*node]) - share).abs() <= SAME).collect()
            }
            false => nodes(&before).intersection(&nodes(&beyond)).copied().collect(),
        };
        for part in [&mut before, &mut beyond] {
            part.retain(|&e| mesh.elements[e].nodes.iter().any(|node| cut.binary_search(node).is_ok()));
        }
        Ok(Station { place, element, at, cut, parts: [before, beyond] })
    }
}
