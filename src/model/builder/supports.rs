//! Supports in force: those of the step before, unless they are given anew or freed.

use nalgebra::Vector2;

use super::change::Change;
use super::error::{Checked, ModelError};
use super::groups::{Place, nodes_at};
use super::inclined::{Along, InForce};
use super::linkage::check_support;
use super::load_step::{Rotation, Support};
use super::normals::normals;
use crate::model::Model;
use crate::model::boundary::{Amplitude, Drive, Span};
use crate::model::support::{Motion, Prescribed};

/// Take over the supports of the step before, and replace those given again.
pub fn supports(in_force: &mut InForce, given: &[Support], place: &str, span: Span, model: &Model) -> Checked<()> {
    let before = in_force.clone();
    in_force.begin(span);
    for (k, support) in given.iter().enumerate() {
        let place = format!("{place}.supports[{k}]");
        let nodes = nodes_at(&model.mesh, &support.on, &format!("{place}.on"))?;
        let nodes: Vec<usize> = nodes.into_iter().map(|node| model.ties.original(node)).collect();
        check_directions(support, &place)?;
        check_on_plates(support, &nodes, model, &place)?;
        check_support(support, &nodes, model, &place)?;
        for (key, component, change) in [("ux", 0, &support.ux), ("uy", 1, &support.uy)] {
            let Some(change) = change else { continue };
            let motion = displacement(change, &format!("{place}.{key}"), span)?;
            let dofs = || nodes.iter().map(|node| model.linkage.leading(2 * node + component));
            if motion.is_none() && !dofs().any(|dof| before.dofs.contains_key(&dof)) {
                return Err(frees_nothing(&format!("{place}.{key}"), &support.on));
            }
            dofs().for_each(|dof| in_force.set(dof, motion.as_ref()));
        }
        for along in inclined(support, &nodes, &place, model)? {
            along.change(in_force, span, model)?;
        }
        let Some(change) = &support.rotation else { continue };
        let held = nodes.iter().any(|node| before.dofs.contains_key(&(2 * node)));
        if change.given().is_none() && !held {
            return Err(frees_nothing(&format!("{place}.rotation"), &support.on));
        }
        let first = nodes.first().and_then(|node| before.dofs.get(&(2 * node)));
        let motion = rotation(change, first, &format!("{place}.rotation"), span)?;
        nodes.iter().flat_map(|node| [2 * node, 2 * node + 1]).for_each(|dof| in_force.set(dof, motion.as_ref()));
    }
    Ok(())
}

/// What a support says along inclined directions and normals, node by node.
fn inclined<'s>(support: &'s Support, nodes: &[usize], place: &str, model: &Model) -> Checked<Vec<Along<'s>>> {
    let mut all = Vec::new();
    if let Some((direction, change)) = &support.along {
        let key = format!("{place}.u");
        displacement(change, &key, Span::default())?;
        let d = Vector2::from(*direction);
        let size = d.amax();
        if !(size > 0.0 && size.is_finite()) {
            let message = format!("is [{}, {}]: give a direction [x, y] that is not zero", d.x, d.y);
            return Err(ModelError::new(format!("{place}.along"), message));
        }
        let d = (d / size).normalize();
        all.extend(nodes.iter().map(|&node| Along { node, d, change, is_normal: false, key: key.clone() }));
    }
    if let Some(change) = &support.un {
        let key = format!("{place}.un");
        displacement(change, &key, Span::default())?;
        let normals = normals(model, &support.on, &key)?;
        all.extend(normals.map(|(node, d)| Along { node, d, change, is_normal: true, key: key.clone() }));
    }
    Ok(all)
}

/// A support must prescribe something, and no direction twice.
fn check_directions(support: &Support, place: &str) -> Checked<()> {
    let Support { ux, uy, along, un, rotation, .. } = support;
    let given = [("ux", ux.is_some()), ("uy", uy.is_some()), ("along", along.is_some()), ("un", un.is_some())];
    let Some((key, _)) = given.into_iter().find(|(_, given)| *given) else {
        return match rotation {
            Some(_) => Ok(()),
            None => Err(ModelError::new(place, "prescribes nothing: give ux, uy, along with u, un or rotation")),
        };
    };
    match rotation {
        Some(Change::To(_)) => {
            Err(ModelError::new(place, format!("gives rotation and {key}: a rotation prescribes both directions")))
        }
        _ => Ok(()),
    }
}

/// A plate moves as a whole: what differs from node to node is none of its motions.
fn check_on_plates(support: &Support, nodes: &[usize], model: &Model, place: &str) -> Checked<()> {
    let on_plate =
        |node: &usize| model.plates.iter().any(|plate| plate.iter().any(|own| model.ties.original(*own) == *node));
    let linked = |node: &usize| model.linkage.plates.iter().any(|(plate, _)| plate.binary_search(node).is_ok());
    let on_plate = |node: &usize| on_plate(node) || linked(node);
    let Some(node) = nodes.iter().find(|node| on_plate(node)) else { return Ok(()) };
    let told = |key: &str, message: &str| {
        let tag = model.mesh.node_tags[*node];
        Err(ModelError::new(format!("{place}.{key}"), format!("node {tag} is one of a plate, {message}")))
    };
    if let Some(Change::To(_)) = support.rotation {
        return told("rotation", "which does not turn: give ux and uy");
    }
    let along = support.along.as_ref().map(|(_, change)| change);
    let given = [("ux", support.ux.as_ref()), ("uy", support.uy.as_ref()), ("u", along), ("un", support.un.as_ref())];
    for (key, change) in given {
        if change.and_then(Change::given).is_some_and(Drive::depends_on_position) {
            return told(key, "which moves as a whole: give it in t alone");
        }
    }
    Ok(())
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
        Motion::Displacement(..) | Motion::Inclined(_) => None,
    };
    let angle = Amplitude { drive: angle.clone(), span, before: before.and_then(turning) };
    Ok(Some(Motion::Rotation { about: Vector2::from(*about), angle }))
}

/// Nothing was in force that could end.
pub fn frees_nothing(place: &str, on: &Place) -> ModelError {
    ModelError::new(place, format!("null ends what an earlier step gave, but none gave this on {on}: check the name"))
}
