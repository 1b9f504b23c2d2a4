//! Whether expressions of supports and loads have a value throughout their step, looked at before anything is solved.

use nalgebra::Vector2;

use super::change::Change;
use super::error::{Checked, ModelError};
use super::groups::{Place, edges, nodes_at};
use super::load::{Action, Components};
use super::load_step::LoadStep;
use super::shares::edge_shares;
use crate::model::Model;
use crate::model::boundary::{Drive, Span};
use crate::model::scheme::Scheme;
use crate::model::told::number;

/// Times of a step, evenly spaced, at which an expression is looked at.
const TIMES: u32 = 100;

/// The most places of a group.
const PLACES: usize = 50;

/// Refuse the expressions of a step that have no value at one of many times and places, named by their keys.
pub fn check(place: &str, given: &LoadStep, (scheme, span): (Scheme, Span), model: &Model) -> Checked<()> {
    // A static step is not looked at where it starts.
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

/// All drives of a step, with their keys and where they act.
fn drives(given: &LoadStep) -> Vec<(String, &Place, &Drive)> {
    let mut drives = Vec::new();
    for (k, support) in given.supports.iter().enumerate() {
        let along = support.along.as_ref().map(|(_, change)| change);
        let motions =
            [("ux", support.ux.as_ref()), ("uy", support.uy.as_ref()), ("u", along), ("un", support.un.as_ref())];
        let motions = motions.into_iter().filter_map(|(key, change)| Some((key, change?.given()?)));
        let turned =
            support.rotation.as_ref().and_then(Change::given).map(|rotation| ("rotation.angle", &rotation.angle));
        drives.extend(motions.chain(turned).map(|(key, drive)| (format!("supports[{k}].{key}"), &support.on, drive)));
    }
    for (k, load) in given.loads.iter().enumerate() {
        drives.extend(
            actions(&load.action).into_iter().map(|(key, drive)| (format!("loads[{k}].{key}"), &load.on, drive)),
        );
    }
    drives
}

/// The drives of a load with their keys.
fn actions(action: &Action) -> Vec<(String, &Drive)> {
    fn vector<'a>(key: &str, components: Option<&'a Components>) -> Vec<(String, &'a Drive)> {
        let along = |(component, name): (usize, &str)| Some((format!("{key}.{name}"), components?.along(component)?));
        ["x", "y"].into_iter().enumerate().filter_map(along).collect()
    }
    match action {
        Action::Pressure(change) => change.given().map(|drive| ("pressure".into(), drive)).into_iter().collect(),
        Action::DeadPressure(change) => {
            change.given().map(|drive| ("dead_pressure".into(), drive)).into_iter().collect()
        }
        Action::Traction(change) => vector("traction", change.given()),
        Action::Gravity(change) => vector("gravity", change.given()),
        Action::Force(change) => vector("force", change.given()),
        Action::TotalForce(change) => vector("total_force", change.given()),
        Action::Spring(change) => vector("spring.driver", change.given().and_then(|link| link.driver.as_ref())),
        Action::Dashpot(change) => vector("dashpot.driver", change.given().and_then(|link| link.driver.as_ref())),
        Action::Moment(change) => change.given().map(|drive| ("moment".into(), drive)).into_iter().collect(),
        Action::Absorbing(_) => Vec::new(),
    }
}

/// Where a drive is evaluated: at nodes, or at the Gauss points of edges; at most some, from end to end.
fn positions(on_edges: bool, on: &Place, model: &Model) -> Vec<Vector2<f64>> {
    let gauss = |name: &str| Some(edge_shares(&model.mesh, edges(&model.mesh, name, "").ok()?));
    let all: Vec<Vector2<f64>> = match on {
        Place::Group(name) if on_edges => gauss(name).into_iter().flatten().map(|(_, _, at)| at).collect(),
        _ => nodes_at(&model.mesh, on, "").into_iter().flatten().map(|node| model.mesh.nodes[node]).collect(),
    };
    let step = all.len().div_ceil(PLACES - 1).max(1);
    all.iter().step_by(step).chain(all.last()).copied().collect()
}
