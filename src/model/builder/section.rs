//! Requirements of a section on mesh, bodies, supports and loads.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::error::{Checked, ModelError, check_positive, check_size};
use crate::laws::bulk::Material;
use crate::mesh::Mesh;
use crate::mesh::section::Section;
use crate::model::Model;
use crate::model::boundary::{Drive, Span};
use crate::model::support::{Motion, Prescribed};
use crate::model::text::number;

/// Distance from the axis, relative to the model size, within which a node is on the axis.
const ON_AXIS: f64 = 1e-12;

/// Checks that a thickness is positive and axisymmetric bodies do not cross the axis.
pub fn check(mesh: &Mesh) -> Checked<()> {
    match mesh.section {
        Section::PlaneStress { thickness } => {
            check_positive("section.plane_stress.thickness", thickness, "")?;
            check_size("section.plane_stress", "thickness", thickness)
        }
        Section::Axisymmetric => {
            let inside = -ON_AXIS * mesh.diagonal();
            let Some(node) = (0..mesh.nodes.len()).find(|&node| mesh.nodes[node].x < inside) else { return Ok(()) };
            let (tag, at) = (mesh.node_tags[node], mesh.nodes[node]);
            let message = format!(
                "is axisymmetric about x = 0, and node {tag} lies at x = {}: x is the radius, so move the mesh to x >= 0 and \
                 model one side of the axis",
                number(at.x)
            );
            Err(ModelError::new("section", message))
        }
        Section::PlaneStrain | Section::Graded { .. } => Ok(()),
    }
}

/// Returns the law of a body in a section.
pub fn material(given: Arc<dyn Material>, f_bar: bool, section: Section, place: &str) -> Checked<Arc<dyn Material>> {
    let refused = |key: &str, message: &str| Err(ModelError::new(format!("{place}.{key}"), message));
    match section {
        Section::PlaneStress { .. } if f_bar => refused(
            "element",
            "f_bar is not needed in plane stress, where the thickness is free to change and elements do not lock for \
             nu near 1/2: leave it out",
        ),
        Section::PlaneStress { .. } => match given.plane_stress() {
            Some(law) => Ok(law.into()),
            None => refused("material", "does not support plane stress: take another law, or plane strain"),
        },
        Section::Axisymmetric if given.spatial().is_none() => {
            refused("material", "does not support the hoop stretch of axisymmetric bodies: take another law")
        }
        Section::Axisymmetric | Section::PlaneStrain | Section::Graded { .. } => Ok(given),
    }
}

/// Radius up to which a node of axisymmetric bodies is on the axis; `None` in other sections.
pub fn axis(mesh: &Mesh) -> Option<f64> {
    mesh.section.is_axisymmetric().then(|| ON_AXIS * mesh.diagonal())
}

/// Nodes of axisymmetric bodies on the axis, which they cannot leave.
fn on_axis(model: &Model) -> impl Iterator<Item = usize> {
    let (mesh, axis) = (&model.mesh, axis(&model.mesh));
    (0..mesh.nodes.len()).filter(move |&node| axis.is_some_and(|near| mesh.nodes[node].x <= near))
}

/// Constrains nodes on the axis and platens, whose radii are constant, and refuses prescribed radial motion and rotation of
/// axisymmetric bodies.
pub fn hold_axis(in_force: &mut BTreeMap<usize, Prescribed>, place: &str, span: Span, model: &Model) -> Checked<()> {
    if !model.mesh.section.is_axisymmetric() {
        return Ok(());
    }
    let turns = |support: &&Prescribed| matches!(support.motion, Motion::Rotation { .. });
    if in_force.values().any(|support| turns(&support)) {
        let message = "a rotation in the plane is no motion of axisymmetric bodies: prescribe ux and uy";
        return Err(ModelError::new(format!("{place}.supports"), message));
    }
    let rigid = model.mesh.rigid_bodies.iter().map(|body| body.reference);
    for node in on_axis(model).chain(model.plates.iter().flatten().copied()).chain(rigid) {
        let dof = 2 * model.ties.original(node);
        let held = Prescribed::displacement(dof, Drive::Constant(0.0), span);
        let given = in_force.entry(dof).or_insert(held);
        let rests = |drive: &Drive| matches!(drive, Drive::Constant(0.0) | Drive::Rate(0.0));
        if !matches!(&given.motion, Motion::Displacement(drive, _) if rests(drive)) {
            if let Some(body) = model.mesh.rigid_bodies.iter().find(|body| body.reference == node) {
                let message =
                    format!("the rigid body `{}` moves along y alone in axisymmetry: leave its ux out", body.name);
                return Err(ModelError::new(format!("{place}.supports"), message));
            }
            let message = format!(
                "node {} lies on the axis or on a plate, and keeps its radius: ux is 0 there; leave it out of the group that is \
                 moved",
                model.mesh.node_tags[node]
            );
            return Err(ModelError::new(format!("{place}.supports"), message));
        }
    }
    Ok(())
}

/// Refuses radial gravity in axisymmetry.
pub fn check_gravity(radial: Option<&Drive>, place: &str, model: &Model) -> Checked<()> {
    let none = matches!(radial, None | Some(Drive::Constant(0.0)));
    if !none && model.mesh.section.is_axisymmetric() {
        let message = "x is the radius of axisymmetric bodies, and gravity has no such direction: give y alone";
        return Err(ModelError::new(format!("{place}.gravity.x"), message));
    }
    Ok(())
}

/// Refuses radial initial velocities in axisymmetry.
pub fn check_velocities<'v>(
    place: &str,
    given: impl IntoIterator<Item = (&'v String, &'v [f64; 2])>,
    model: &Model,
) -> Checked<()> {
    let radial = |(_, velocity): &(&String, &[f64; 2])| velocity[0] != 0.0;
    match given.into_iter().find(radial).filter(|_| model.mesh.section.is_axisymmetric()) {
        Some((name, _)) => {
            let message =
                "x is the radius of axisymmetric bodies, along which they cannot move as a whole: give [0, vy]";
            Err(ModelError::new(format!("{place}.{name}"), message))
        }
        None => Ok(()),
    }
}
