//! Supports in force: those of the step before, unless they are given anew or freed.

use std::collections::BTreeMap;

use nalgebra::Vector2;

use super::change::Change;
use super::error::{Checked, ModelError};
use super::groups::{Place, nodes_at};
use super::load_step::{Rotation, Support};
use crate::model::Model;
use crate::model::boundary::{Amplitude, Drive, Motion, Prescribed, Span};

/// Prescribed dofs.
type InForce = BTreeMap<usize, Prescribed>;

/// Take over the supports of the step before, replace those given again, and list the dofs that are freed.
pub fn supports(
    in_force: &mut InForce,
    given: &[Support],
    place: &str,
    span: Span,
    model: &Model,
) -> Checked<Vec<usize>> {
    let before = in_force.clone();
    for support in in_force.values_mut() {
        if let Motion::Displacement(_, own) = &mut support.motion {
            *own = span;
        }
    }
    for (k, support) in given.iter().enumerate() {
        let place = format!("{place}.supports[{k}]");
        let nodes = nodes_at(&model.mesh, &support.on, &format!("{place}.on"))?;
        let nodes: Vec<usize> = nodes.into_iter().map(|node| model.ties.original(node)).collect();
        check_directions(support, &place)?;
        for (key, component, change) in [("ux", 0, &support.ux), ("uy", 1, &support.uy)] {
            let Some(change) = change else { continue };
            let motion = displacement(change, &format!("{place}.{key}"), span)?;
            if motion.is_none() && !nodes.iter().any(|node| before.contains_key(&(2 * node + component))) {
                return Err(frees_nothing(&format!("{place}.{key}"), &support.on));
            }
            nodes.iter().for_each(|node| set(in_force, 2 * node + component, motion.as_ref()));
        }
        let Some(change) = &support.rotation else { continue };
        let held = nodes.iter().any(|node| before.contains_key(&(2 * node)));
        if change.given().is_none() && !held {
            return Err(frees_nothing(&format!("{place}.rotation"), &support.on));
        }
        let first = nodes.first().and_then(|node| before.get(&(2 * node)));
        let motion = rotation(change, first, &format!("{place}.rotation"), span)?;
        nodes.iter().flat_map(|node| [2 * node, 2 * node + 1]).for_each(|dof| set(in_force, dof, motion.as_ref()));
    }
    Ok(before.into_keys().filter(|dof| !in_force.contains_key(dof)).collect())
}

/// A support must prescribe something, and no direction twice.
fn check_directions(support: &Support, place: &str) -> Checked<()> {
    let Support { ux, uy, rotation, .. } = support;
    let key = match (ux, uy) {
        (Some(_), _) => "ux",
        (None, Some(_)) => "uy",
        (None, None) if rotation.is_none() => {
            return Err(ModelError::new(place, "prescribes nothing: give ux, uy or rotation"));
        }
        (None, None) => return Ok(()),
    };
    match rotation {
        Some(Change::To(_)) => {
            Err(ModelError::new(place, format!("gives rotation and {key}: a rotation prescribes both directions")))
        }
        _ => Ok(()),
    }
}

fn displacement(change: &Change<Drive>, place: &str, span: Span) -> Checked<Option<Motion>> {
    let Some(drive) = change.given() else { return Ok(None) };
    drive.check().map_err(|message| ModelError::new(place, message))?;
    Ok(Some(Motion::Displacement(drive.clone(), span)))
}

/// A rotation, which goes on from that which was in force.
fn rotation(
    change: &Change<Rotation>,
    before: Option<&Prescribed>,
    place: &str,
    span: Span,
) -> Checked<Option<Motion>> {
    let Some(Rotation { about, angle }) = change.given() else { return Ok(None) };
    angle.check().map_err(|message| ModelError::new(format!("{place}.angle"), message))?;
    let turning = |support: &Prescribed| match &support.motion {
        Motion::Rotation { angle, .. } => Some(Box::new(angle.clone())),
        Motion::Displacement(..) => None,
    };
    let angle = Amplitude { drive: angle.clone(), span, before: before.and_then(turning) };
    Ok(Some(Motion::Rotation { about: Vector2::from(*about), angle }))
}

fn set(in_force: &mut InForce, dof: usize, motion: Option<&Motion>) {
    match motion {
        Some(motion) => in_force.insert(dof, Prescribed { dof, motion: motion.clone() }),
        None => in_force.remove(&dof),
    };
}

/// Nothing was in force that could end.
pub fn frees_nothing(place: &str, on: &Place) -> ModelError {
    ModelError::new(place, format!("null ends what an earlier step gave, but none gave this on {on}: check the name"))
}
