//! Output requests: watched sets, gauges and times of results.
//!
//! The element of a gauge follows from its position.

use std::collections::BTreeSet;

use nalgebra::Vector2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::error::{Checked, ModelError, check_name, check_positive, refuse_if};
use super::groups::{Place, body, group, nodes_at};
use super::schedule::MOST_INCREMENTS;
use crate::mesh::Group;
use crate::mesh::boxes::{Box2, Tree};
use crate::model::{Model, Probe, Step, WatchedSet};

/// A gauge: a point given by `at`, or a line of points given by `from`, `to` and `number`; positions are undeformed ones.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Probe")]
#[non_exhaustive]
pub struct Gauge {
    /// Name in results; the key of the gauge in a case
    #[serde(skip)]
    pub name: String,
    /// The point [x, y]
    pub at: Option<[f64; 2]>,
    /// Start of a line [x, y]
    pub from: Option<[f64; 2]>,
    /// End of a line [x, y]
    pub to: Option<[f64; 2]>,
    /// Number of points of a line, including both ends; the k-th is called NAME.k, from 1
    pub number: Option<usize>,
    /// Body of the point, required where two bodies touch
    pub body: Option<String>,
}

/// Maximum number of points of a line.
const MOST: usize = 100_000;

impl Gauge {
    /// Creates a gauge at a point.
    pub fn at(name: impl Into<String>, place: [f64; 2]) -> Self {
        Self { name: name.into(), at: Some(place), ..Self::default() }
    }

    /// Creates points at equal distances between two positions, both included; the k-th is called `name.k`, from 1.
    pub fn line(name: impl Into<String>, from: [f64; 2], to: [f64; 2], number: usize) -> Self {
        Self { name: name.into(), from: Some(from), to: Some(to), number: Some(number), ..Self::default() }
    }

    /// Names and positions of all points.
    fn points(&self) -> Checked<Vec<(String, Vector2<f64>)>> {
        let (from, to, number) = match (self.at, self.from, self.to, self.number) {
            (Some(at), None, None, None) => return Ok(vec![(self.name.clone(), at.into())]),
            (None, Some(from), Some(to), Some(number)) => (from, to, number),
            _ => {
                let message = "give `at` for a point, or `from`, `to` and `number` for a line of points";
                return Err(ModelError::new(format!("probes.{}", self.name), message));
            }
        };
        let message = format!("is {number}: a line has 2 to {MOST} points (one alone is given by `at`)");
        refuse_if(!(2..=MOST).contains(&number), format!("probes.{}.number", self.name), message)?;
        let [from, to] = [Vector2::from(from), Vector2::from(to)];
        let message = format!("is ({}, {}), the start of the line: its points would coincide", to.x, to.y);
        refuse_if(from == to, format!("probes.{}.to", self.name), message)?;
        let share = |k: usize| k as f64 / (number - 1) as f64;
        let at = |k: usize| from * (1.0 - share(k)) + to * share(k);
        Ok((0..number).map(|k| (format!("{}.{}", self.name, k + 1), at(k))).collect())
    }
}

setters! { gauge: Gauge;
    /// Sets the body, for positions where two bodies touch.
    of(body: impl Into<String>) { gauge.body = Some(body.into()); }
}

/// Builds the gauges of a model.
///
/// # Errors
/// Returns an error for a position outside all bodies, or in two bodies without `body`.
pub fn probes(gauges: &[Gauge], model: &Model) -> Checked<Vec<Probe>> {
    if gauges.is_empty() {
        return Ok(Vec::new());
    }
    let (mut probes, mut taken) = (Vec::new(), BTreeSet::new());
    let reaches = Tree::new((0..model.solids.len()).map(|element| model.mesh.reach(element)));
    for gauge in gauges {
        let place = format!("probes.{}", gauge.name);
        check_name(&place, &gauge.name)?;
        let body = gauge.body.as_ref().map(|name| body(model, name, &format!("{place}.body"))).transpose()?;
        for (name, at) in gauge.points()? {
            let message = format!("there is a probe `{name}` already: rename one");
            refuse_if(!taken.insert(name.clone()), &place, message)?;
            let is_meant = |e: &usize| body.is_none_or(|body| model.body_of_element[*e] == body);
            let within = |e: usize| Some((e, model.mesh.coordinates(e, at)?));
            let near = reaches.meeting(&Box2 { low: at, high: at });
            let found: Vec<(usize, [f64; 2])> = near.into_iter().filter(is_meant).filter_map(within).collect();
            let bodies: BTreeSet<usize> = found.iter().map(|(e, _)| model.body_of_element[*e]).collect();
            let Some(&(element, coordinates)) = found.first() else {
                return Err(ModelError::new(place, outside(model, at, gauge.body.as_deref())));
            };
            if bodies.len() > 1 {
                let names: Vec<String> = bodies.iter().map(|&body| format!("`{}`", model.bodies[body].name)).collect();
                let message = format!("({}, {}) lies in {}: say which by \"body\"", at.x, at.y, names.join(" and in "));
                return Err(ModelError::new(place, message));
            }
            probes.push(Probe { name, element, at: coordinates });
        }
    }
    Ok(probes)
}

pub(super) fn outside(model: &Model, at: Vector2<f64>, body: Option<&str>) -> String {
    let bodies = model.bodies.iter().filter(|other| body.is_none_or(|body| other.name == body));
    let nodes = bodies.flat_map(|body| body.nodes.iter().map(move |&node| (model.mesh.nodes[node], &body.name)));
    let nearest = nodes.min_by(|(a, _), (b, _)| (a - at).norm().total_cmp(&(b - at).norm()));
    let of = body.map_or("in no body".into(), |body| format!("outside of `{body}`"));
    match nearest {
        Some((x, name)) => {
            format!("({}, {}) lies {of}; the nearest node is at ({}, {}), in `{name}`", at.x, at.y, x.x, x.y)
        }
        None => format!("({}, {}) lies {of}: there is none", at.x, at.y),
    }
}

/// Returns the watched groups and nodes, each once, and all rigid bodies.
pub fn watched(places: &[Place], model: &Model) -> Checked<Vec<WatchedSet>> {
    let mut seen = BTreeSet::new();
    let mut sets = Vec::with_capacity(places.len());
    for (k, on) in places.iter().enumerate() {
        let (place, name) = (format!("watch[{k}]"), on.column());
        check_name(&place, &name)?;
        refuse_if(!seen.insert(name.clone()), &place, format_args!("`{name}` is watched already: name it once"))?;
        sets.push(watched_set(model, on, &place)?);
    }
    for body in model.mesh.rigid_bodies.iter().filter(|body| !seen.contains(&body.name)) {
        sets.push(watched_set(model, &Place::Group(body.name.clone()), "rigid_bodies")?);
    }
    Ok(sets)
}

/// Returns a watched set. Reactions of copies belong to their originals; the displacement of a platen counts with every node.
fn watched_set(model: &Model, on: &Place, place: &str) -> Checked<WatchedSet> {
    let nodes = nodes_at(&model.mesh, on, place)?;
    let edges = match on {
        Place::Group(name) => match group(&model.mesh, name, place)? {
            Group::Edges(edges) => edges.clone(),
            _ => Vec::new(),
        },
        _ => Vec::new(),
    };
    let constrained = [0, 1].map(|i| model.ties.originals(model.constrained(&nodes, i)));
    let nodes = if model.plates.is_empty() { model.ties.originals(nodes) } else { nodes };
    Ok(WatchedSet { name: on.column(), nodes, edges, constrained })
}

/// Checks the interval of the results of explicit steps.
pub fn checked_interval(interval: Option<f64>) -> Checked<Option<f64>> {
    let otherwise = " (leave it out for a hundredth of each explicit step)";
    check_positive("output.interval", interval.unwrap_or(1.0), otherwise).map(|()| interval)
}

/// Checks the number of result rows of explicit steps, one per interval.
pub fn check_rows(model: &Model) -> Checked<()> {
    let Some(interval) = model.requests.interval else { return Ok(()) };
    let time: f64 =
        model.steps.iter().filter(|step| step.may_be_explicit()).map(|step| step.span.end - step.span.start).sum();
    let rows = time / interval;
    match rows <= MOST_INCREMENTS {
        true => Ok(()),
        false => {
            let message = format!(
                "is {interval:e}: this makes {rows:.1e} rows of results, at most {MOST_INCREMENTS:e} are allowed"
            );
            Err(ModelError::new("output.interval", message))
        }
    }
}

/// Checks the output times of fields: within the steps, ascending.
pub fn checked_times(times: Vec<f64>, steps: &[Step]) -> Checked<Vec<f64>> {
    let (start, end) =
        steps.first().zip(steps.last()).map_or((0.0, 0.0), |(first, last)| (first.span.start, last.span.end));
    for (k, time) in times.iter().enumerate() {
        let refused = |message: String| Err(ModelError::new(format!("output.times[{k}]"), message));
        if !(*time > start && *time <= end) {
            return refused(format!("is {time}: must be after {start} and not after {end}, the end of the last step"));
        }
        if k > 0 && *time <= times[k - 1] {
            return refused(format!("is {time}, but {} comes before it: times must increase", times[k - 1]));
        }
    }
    Ok(times)
}
