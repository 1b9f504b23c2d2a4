//! Supports in force: those of the previous step, unless they are replaced or released.
//!
//! # Supports at nodes
//!
//! Supports at a node act along the coordinates or along inclined directions.
//!
//! One inclined direction is a support of its own. Two directions at a node constrain both of its components:
//!
//! ```text
//! d₁·u = ū₁,  d₂·u = ū₂    ⇒    u = D⁻¹ ū,  D = [d₁ d₂]ᵀ
//! ```
//!
//! Nearly parallel directions are refused: their difference would constrain the node unintentionally.
//!
//! # Normals
//!
//! Normals of a side at its nodes, in the undeformed body:
//!
//! ```text
//! n_a = ∫ N_a n dS / |∫ N_a n dS|
//! ```
//!
//! so that u·n_a = 0 at all nodes conserves the volume. A node on the axis of rings has no area (a corner of a quadratic edge exactly
//! none); its normal is that of the plane section. Where edges meet at a corner, a node has the normals of both.
//!
//! Source: Engelman, Sani & Gresho (1982), Int. J. Numer. Meth. Fluids 2, 225.

use std::collections::BTreeMap;

use nalgebra::{Matrix2, Vector2};
use thiserror::Error;

use super::agreement::{self, Clash, clash, rests};
use super::error::{Checked, ModelError, refuse_if};
use super::groups::{Place, dofs_of, edges, nodes_at, pressure_weights};
use super::load::Change;
use super::load_step::{Rotation, Support};
use super::rigid;
use crate::mesh::{Edge, Mesh};
use crate::model::Model;
use crate::model::boundary::{Amplitude, Drive, NodalWeight, Span};
use crate::model::step::Entry;
use crate::model::support::{Direction, Inclined, Motion, Prescribed};
use crate::model::text::{number, vector};

/// Supports in force.
#[derive(Clone, Default)]
pub struct SupportsInForce {
    /// supports of dofs
    dofs: BTreeMap<usize, Prescribed>,
    /// supports along inclined directions, by node
    inclined: BTreeMap<usize, Vec<InclinedSupport>>,
    /// as the input gave them, by place and key
    entries: BTreeMap<(String, &'static str), Entry>,
}

/// A node supported along an inclined direction.
#[derive(Clone)]
struct InclinedSupport {
    support: Inclined,
    is_normal: bool,
    /// place in the present step, if given there
    given: Option<String>,
}

impl SupportsInForce {
    /// Goes on to the next step, whose supports replace or end those in force; `fades`: whether reactions decrease to zero then.
    pub fn step(&mut self, given: &[Support], place: &str, span: Span, fades: bool, model: &Model) -> Checked<()> {
        let before = self.dofs.clone();
        self.begin(span);
        for (k, support) in given.iter().enumerate() {
            let place = format!("{place}.supports[{k}]");
            let nodes = nodes_at(&model.mesh, &support.on, &format!("{place}.on"))?;
            let nodes: Vec<usize> = nodes.into_iter().map(|node| model.ties.original(node)).collect();
            check_directions(support, &place)?;
            rigid::check_support(support, &place, &model.mesh)?;
            check_on_plates(support, &nodes, model, &place)?;
            for (key, component, change) in [("ux", 0, &support.ux), ("uy", 1, &support.uy)] {
                let Some(change) = change else { continue };
                let motion = displacement(change, &format!("{place}.{key}"), span)?;
                let dofs = || nodes.iter().map(|node| model.linkage.leading(2 * node + component));
                if motion.is_none() && !dofs().any(|dof| before.contains_key(&dof)) {
                    return Err(nothing_to_end(&format!("{place}.{key}"), &support.on));
                }
                dofs().for_each(|dof| self.set(dof, motion.as_ref()));
            }
            for along in inclined(support, &nodes, &place, model)? {
                along.change(self, span, model)?;
            }
            if let Some((dof, motion)) = rigid::angle(support, &place, span, model)? {
                if motion.is_none() && !before.contains_key(&dof) {
                    return Err(nothing_to_end(&format!("{place}.angle"), &support.on));
                }
                self.set(dof, motion.as_ref());
            }
            if let Some(change) = &support.rotation {
                if change.given().is_none() && !nodes.iter().any(|node| before.contains_key(&(2 * node))) {
                    return Err(nothing_to_end(&format!("{place}.rotation"), &support.on));
                }
                let first = nodes.first().and_then(|node| before.get(&(2 * node)));
                let motion = rotation(change, first, &format!("{place}.rotation"), span)?;
                dofs_of(&nodes).for_each(|dof| self.set(dof, motion.as_ref()));
            }
            self.enter(support, fades, model);
        }
        for dof in rigid::still(model) {
            let constrained = || Prescribed::displacement(dof, Drive::Constant(0.0), span);
            self.dofs.entry(dof).or_insert_with(constrained);
        }
        self.constrain_axis(place, span, model)
    }

    /// Starts a step with the supports in force.
    fn begin(&mut self, span: Span) {
        for support in self.dofs.values_mut() {
            if let Motion::Displacement(_, own) = &mut support.motion {
                *own = span;
            }
        }
        for constrained in self.inclined.values_mut().flatten() {
            (constrained.support.span, constrained.given) = (span, None);
        }
        self.entries.values_mut().for_each(|entry| entry.kept = true);
    }

    /// Enters a support as the input gives it.
    fn enter(&mut self, support: &Support, fades: bool, model: &Model) {
        let place = support.on.in_words(&model.mesh);
        let motions = support.motions().map(|(key, change)| (key, change.given().map(Drive::to_string)));
        let turned = |change: &Change<Rotation>| ("rotation", change.given().map(Rotation::to_string));
        for (key, value) in motions.chain(support.rotation.as_ref().map(turned)) {
            let on = match support.along.filter(|_| key == "u") {
                Some(direction) => format!("{place} along {}", vector(direction)),
                None => place.clone(),
            };
            let entry = Entry { is_load: false, on: on.clone(), kind: key.into(), value, kept: false, fades };
            self.entries.insert((on, key), entry);
        }
    }

    /// The supports of the present step as the input gave them.
    pub fn entries(&self) -> impl Iterator<Item = &Entry> {
        self.entries.values()
    }

    /// Keeps supports at their final position after a step that may have ended early.
    pub fn keep_positions(&mut self) {
        let keeps = |drive: &mut Drive| {
            if let Drive::Constant(_) | Drive::ByPlace(..) = drive {
                *drive = Drive::Rate(0.0);
            }
        };
        for support in self.dofs.values_mut() {
            if let Motion::Displacement(drive, _) = &mut support.motion {
                keeps(drive);
            }
        }
        self.inclined.values_mut().flatten().for_each(|constrained| keeps(&mut constrained.support.drive));
    }

    /// Prescribes or releases a dof.
    fn set(&mut self, dof: usize, motion: Option<&Motion>) {
        match motion {
            Some(motion) => self.dofs.insert(dof, Prescribed { at: dof.into(), motion: motion.clone() }),
            None => self.dofs.remove(&dof),
        };
    }

    /// All supports of a step, `place`, ascending by dof.
    pub fn all(&self, place: &str, model: &Model) -> Checked<Vec<Prescribed>> {
        let mut all = self.dofs.clone();
        for (&node, constrained) in &self.inclined {
            let given: Vec<Prescribed> = dofs_of(&[node]).filter_map(|dof| all.remove(&dof)).collect();
            let tag = model.mesh.node_tags[node];
            let resolved = resolved(node, model.mesh.nodes[node], given, constrained)
                .map_err(|why| ModelError::new(format!("{place}.supports"), format!("node {tag} {why}")))?;
            all.extend(resolved.into_iter().map(|support| (support.at.dof, support)));
        }
        Ok(all.into_values().collect())
    }

    /// Constrains nodes on the axis and platens, whose radii are constant, and refuses prescribed radial motion and rotation of
    /// axisymmetric bodies.
    fn constrain_axis(&mut self, place: &str, span: Span, model: &Model) -> Checked<()> {
        if !model.mesh.section.is_axisymmetric() {
            return Ok(());
        }
        let turns = |support: &&Prescribed| matches!(support.motion, Motion::Rotation { .. });
        let message = "axisymmetric bodies cannot rotate in the plane: prescribe ux and uy";
        refuse_if(self.dofs.values().any(|support| turns(&support)), format!("{place}.supports"), message)?;
        let rigid = model.mesh.rigid_bodies.iter().map(|body| body.reference);
        let axis = axis(&model.mesh);
        let on_axis = (0..axis.len()).filter(|&node| on_axis(&model.mesh, &axis, node));
        for node in on_axis.chain(model.plates.iter().flatten().copied()).chain(rigid) {
            let dof = 2 * model.ties.original(node);
            let constrained = Prescribed::displacement(dof, Drive::Constant(0.0), span);
            let given = self.dofs.entry(dof).or_insert(constrained);
            let rests = |drive: &Drive, own: Span| rests(drive, model.mesh.nodes[node], own, axis[node]);
            if matches!(&given.motion, Motion::Displacement(drive, own) if rests(drive, *own)) {
                continue;
            }
            let message = match model.mesh.rigid_bodies.iter().find(|body| body.reference == node) {
                Some(body) => {
                    format!("the rigid body `{}` moves along y alone in axisymmetry: leave its ux out", body.name)
                }
                None => format!(
                    "node {} lies on the axis or on a plate, and keeps its radius: ux is 0 there; leave it out of the group that is \
                     moved",
                    model.mesh.node_tags[node]
                ),
            };
            return Err(ModelError::new(format!("{place}.supports"), message));
        }
        Ok(())
    }
}

/// Prescribed inclined directions and normals of a support, node by node.
fn inclined<'s>(support: &'s Support, nodes: &[usize], place: &str, model: &Model) -> Checked<Vec<Along<'s>>> {
    let mut all = Vec::new();
    if let (Some(direction), Some(change)) = (&support.along, &support.u) {
        let key = format!("{place}.u");
        displacement(change, &key, Span::default())?;
        let d = Vector2::from(*direction);
        let size = d.amax();
        let message = format!("is [{}, {}]: give a direction [x, y] that is not zero", d.x, d.y);
        refuse_if(!(size > 0.0 && size.is_finite()), format!("{place}.along"), message)?;
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

/// Checks that a support prescribes something, and no direction twice.
fn check_directions(support: &Support, place: &str) -> Checked<()> {
    let Support { ux, uy, along, u, un, rotation, angle, .. } = support;
    match (along, u) {
        (Some(_), None) => return Err(ModelError::new(place, "gives a direction `along` and no displacement: give u")),
        (None, Some(_)) => return Err(ModelError::new(place, "gives u and no direction: give `along`, [x, y]")),
        _ => {}
    }
    let given = [("ux", ux.is_some()), ("uy", uy.is_some()), ("along", along.is_some()), ("un", un.is_some())];
    let Some((key, _)) = given.into_iter().find(|(_, given)| *given) else {
        return match (rotation, angle) {
            (Some(_), _) | (_, Some(_)) => Ok(()),
            (None, None) => {
                Err(ModelError::new(place, "prescribes nothing: give ux, uy, along with u, un or rotation"))
            }
        };
    };
    match rotation {
        Some(Change::To(_)) => {
            Err(ModelError::new(place, format!("gives rotation and {key}: a rotation prescribes both directions")))
        }
        _ => Ok(()),
    }
}

/// Checks that a support on a platen moves it as a whole.
fn check_on_plates(support: &Support, nodes: &[usize], model: &Model, place: &str) -> Checked<()> {
    let as_one = |node: &usize| model.plates.iter().flatten().any(|own| model.ties.original(*own) == *node);
    let linked = |node: &usize, to: &dyn Fn([bool; 2]) -> bool| {
        let own = |(plate, components): &(Vec<usize>, _)| to(*components) && plate.binary_search(node).is_ok();
        model.linkage.plates.iter().any(own)
    };
    let tag = |node: &usize| model.mesh.node_tags[*node];
    if let Some(node) = nodes.iter().find(|node| as_one(node) || linked(node, &|_| true)) {
        let refused = |key: &str, why: &str| {
            Err(ModelError::new(format!("{place}.{key}"), format!("node {} is one of a plate, {why}", tag(node))))
        };
        if let Some(Change::To(_)) = support.rotation {
            return refused("rotation", "which does not rotate: give ux and uy");
        }
        let varies = |(_, change): &(_, &Change<Drive>)| change.given().is_some_and(Drive::depends_on_position);
        if let Some((key, _)) = support.motions().find(varies) {
            return refused(key, "which moves as a whole: give it in t alone");
        }
    }
    let is_inclined = support.along.is_some() || support.un.is_some();
    let cannot = |components: [bool; 2]| support.rotation.is_some() || is_inclined && components != [true; 2];
    match nodes.iter().find(|node| linked(node, &cannot)) {
        Some(node) => {
            let message = format!("node {} belongs to a plate with tied displacements: give ux and uy", tag(node));
            Err(ModelError::new(place, message))
        }
        None => Ok(()),
    }
}

fn displacement(change: &Change<Drive>, place: &str, span: Span) -> Checked<Option<Motion>> {
    let Some(drive) = change.given() else { return Ok(None) };
    drive.check().map_err(|message| ModelError::new(place, message))?;
    Ok(Some(Motion::Displacement(drive.clone(), span)))
}

/// Adds a rotation, continued from the one in force.
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

/// Error for a release without a support in force.
pub fn nothing_to_end(place: &str, on: &Place) -> ModelError {
    ModelError::new(place, format!("null ends what an earlier step gave, but none gave this on {on}: check the name"))
}

/// Sine of the angle between two directions below which they are parallel within round-off.
const PARALLEL: f64 = 1e-9;

/// Smallest angle between an inclined direction and another at its node [°].
const LEAST_ANGLE: f64 = 15.0;

/// Angle between two sides below which they share a normal at their common node [°].
pub const CORNER: f64 = 45.0;

/// A support along d at a node.
pub struct Along<'s> {
    /// node
    pub node: usize,
    /// d
    pub d: Vector2<f64>,
    /// displacement, or its end
    pub change: &'s Change<Drive>,
    /// whether d is the normal of a side
    pub is_normal: bool,
    /// place in the input
    pub key: String,
}

/// Directions that were supported and are free from now on.
pub fn freed(before: &[Prescribed], now: &[Prescribed]) -> Vec<Direction> {
    let find = |all: &[Prescribed], dof: usize| {
        all.binary_search_by_key(&dof, |support| support.at.dof).ok().map(|k| all[k].at)
    };
    let mut freed = Vec::new();
    for first in before.iter().map(|support| support.at.dof & !1).collect::<std::collections::BTreeSet<_>>() {
        let [was, is] = [before, now].map(|all| [find(all, first), find(all, first + 1)]);
        let inclined =
            |constrained: [Option<Direction>; 2]| constrained.into_iter().flatten().find(|at| at.inclined.is_some());
        match (inclined(was), inclined(is)) {
            (was, Some(is)) if was == Some(is) => {}
            (_, Some(is)) => freed.extend(is.across()),
            (Some(_), None) => freed.extend((0..2).filter(|&i| is[i].is_none()).map(|i| Direction::from(first + i))),
            (None, None) => freed.extend((0..2).filter(|&i| is[i].is_none()).filter_map(|i| was[i])),
        }
    }
    freed
}

impl Along<'_> {
    /// Puts it into force, or ends it. Along a coordinate it is a support of that dof.
    pub fn change(&self, in_force: &mut SupportsInForce, span: Span, model: &Model) -> Checked<()> {
        let drive = self.change.given();
        if let Some(i) = (0..2).find(|&i| self.d[1 - i].abs() <= PARALLEL) {
            let motion = drive.map(|drive| {
                let drive = if self.d[i] < 0.0 { drive.reversed() } else { drive.clone() };
                Motion::Displacement(drive, span)
            });
            let dof = 2 * self.node + i;
            if motion.is_none() && !in_force.dofs.contains_key(&dof) {
                return Err(self.nothing_to_end(model));
            }
            in_force.set(dof, motion.as_ref());
            return Ok(());
        }
        let all = in_force.inclined.entry(self.node).or_default();
        let same = all.iter().position(|constrained| constrained.support.direction.perp(&self.d).abs() <= PARALLEL);
        let Some(drive) = drive else {
            let Some(same) = same else { return Err(self.nothing_to_end(model)) };
            all.remove(same);
            in_force.inclined.retain(|_, all| !all.is_empty());
            return Ok(());
        };
        let toward = |other: &Vector2<f64>| if other.dot(&self.d) < 0.0 { drive.reversed() } else { drive.clone() };
        let constrained = |direction, drive| InclinedSupport {
            support: Inclined { share: 1.0, direction, drive, span },
            is_normal: self.is_normal,
            given: Some(self.key.clone()),
        };
        match same {
            Some(k) => {
                let new = constrained(all[k].support.direction, toward(&all[k].support.direction));
                let other = all[k].given.as_ref().is_some_and(|given| *given != self.key);
                let at = model.mesh.nodes[self.node];
                if other && !agreement::is_same(at, [&all[k].support, &new.support]) {
                    let tag = model.mesh.node_tags[self.node];
                    let message = format!(
                        "contradicts what this step gives node {tag} along the same direction: give one of the two"
                    );
                    return Err(ModelError::new(&self.key, message));
                }
                all[k] = new;
            }
            None => all.push(constrained(self.d, drive.clone())),
        }
        Ok(())
    }

    fn nothing_to_end(&self, model: &Model) -> ModelError {
        let tag = model.mesh.node_tags[self.node];
        ModelError::new(
            &self.key,
            format!(
                "null ends what an earlier step gave, but none gave node {tag} a support along {}: check place and direction",
                vector(self.d)
            ),
        )
    }
}

/// Why the supports of a node contradict each other.
#[derive(Clone, Copy, Debug, Error)]
enum Contradiction {
    #[error("is prescribed by a rotation and constrained along another direction: leave it out of one of the two")]
    Rotation,
    #[error("is constrained twice along one direction")]
    Twice,
    #[error(
        "is constrained along two directions that differ by {} degrees, and cannot move at all: put sides that continue smoothly \
         into one group, leave the node out of one of the two, or give it ux and uy",
        number(*.0)
    )]
    Close(f64),
    #[error(
        "is constrained along three directions with contradictory values: at t = {} two of them move it by {} along the third, which \
         gives {}; leave it out of one",
        number(.0.time),
        number(.0.moved),
        number(.0.said)
    )]
    Three(Clash),
}

/// Supports of a node with the coordinate supports `given` and some inclined directions, or an error.
fn resolved(
    node: usize,
    position: Vector2<f64>,
    given: Vec<Prescribed>,
    constrained: &[InclinedSupport],
) -> Result<Vec<Prescribed>, Contradiction> {
    let mut all: Vec<Inclined> = Vec::new();
    for support in &given {
        let Motion::Displacement(drive, span) = &support.motion else {
            return Err(Contradiction::Rotation);
        };
        let direction = support.at.vector();
        all.push(Inclined { share: 1.0, direction, drive: drive.clone(), span: *span });
    }
    let straight = all.len();
    all.extend(constrained.iter().map(|constrained| constrained.support.clone()));
    if let [only] = &all[..] {
        let at = Direction::along(node, only.direction);
        return Ok(vec![Prescribed { at, motion: Motion::Inclined(vec![only.clone()]) }]);
    }
    if straight < 2 {
        check_angles(straight, constrained, &all)?;
    }
    let d = [&all[0], &all[1]].map(|of| of.direction.transpose());
    let inverse = Matrix2::from_rows(&d).try_inverse().ok_or(Contradiction::Twice)?;
    for third in &all[2..] {
        clash(position, [&all[0], &all[1]], inverse, third).map_err(Contradiction::Three)?;
    }
    let component = |i: usize| {
        let part = |k: usize| Inclined { share: inverse[(i, k)], ..all[k].clone() };
        let parts = (0..2).filter(|&k| inverse[(i, k)] != 0.0).map(part).collect();
        Prescribed { at: (2 * node + i).into(), motion: Motion::Inclined(parts) }
    };
    let own = |i: usize| given.iter().find(|support| support.at.dof == 2 * node + i).cloned();
    Ok((0..2).map(|i| own(i).unwrap_or_else(|| component(i))).collect())
}

/// Checks that inclined directions differ sufficiently from each other and from the supported coordinates.
fn check_angles(straight: usize, constrained: &[InclinedSupport], all: &[Inclined]) -> Result<(), Contradiction> {
    for a in 0..all.len() {
        for b in (a + 1).max(straight)..all.len() {
            let angle = all[a].direction.perp(&all[b].direction).abs().min(1.0).asin().to_degrees();
            let normals = [a, b].iter().all(|k| k.checked_sub(straight).is_some_and(|k| constrained[k].is_normal));
            let least = if normals { CORNER } else { LEAST_ANGLE };
            if angle < least {
                return Err(Contradiction::Close(angle));
            }
        }
    }
    Ok(())
}

/// Distance from the axis, relative to the size of an adjacent element, within which a node is on the axis.
const ON_AXIS: f64 = 1e-9;

/// Radius up to which each node of axisymmetric bodies is on the axis; none in other sections [L].
pub fn axis(mesh: &Mesh) -> Vec<f64> {
    if !mesh.section.is_axisymmetric() {
        return Vec::new();
    }
    // Nodes that stand for pressures of water have no displacement that the axis holds.
    let mut near = vec![0.0f64; mesh.nodes.len() - mesh.water_nodes];
    for element in &mesh.elements {
        let size = mesh.size_of(element.nodes.iter().copied());
        element.nodes.iter().for_each(|&node| near[node] = near[node].max(ON_AXIS * size));
    }
    near
}

/// Whether a node is on the axis, given the radii of [`axis`].
fn on_axis(mesh: &Mesh, axis: &[f64], node: usize) -> bool {
    axis.get(node).is_some_and(|near| mesh.nodes[node].x <= *near)
}

/// Outward unit normals of the body, node by node; the sides of a periodic model share those of their nodes.
pub fn normals(model: &Model, on: &Place, place: &str) -> Checked<impl Iterator<Item = (usize, Vector2<f64>)>> {
    let Place::Group(name) = on else {
        return Err(ModelError::new(
            place,
            format!("{on} has no side and no normal: name a group of edges, or give along and u"),
        ));
    };
    let edges = edges(&model.mesh, name, place)?;
    let axis = axis(&model.mesh);
    let mut at_node: BTreeMap<(usize, usize), Vec<Vector2<f64>>> = BTreeMap::new();
    for edge in edges {
        for (node, area) in areas(model, edge, &axis) {
            // Nodes of a platen have separate normals.
            let on_plate = model.plates.iter().any(|plate| plate.binary_search(&node).is_ok());
            let original = model.ties.original(node);
            at_node.entry((original, if on_plate { node } else { original })).or_default().push(area);
        }
    }
    let of_node = |((node, _), areas): (_, Vec<Vector2<f64>>)| merged(&areas).into_iter().map(move |n| (node, n));
    Ok(at_node.into_iter().flat_map(of_node))
}

/// ∫ N_a n dS of an edge, node by node; at nodes on the axis in the plane section.
fn areas(model: &Model, edge: &Edge, axis: &[f64]) -> Vec<(usize, Vector2<f64>)> {
    let [x, y] = pressure_weights(&model.mesh, std::slice::from_ref(edge));
    edge.nodes
        .iter()
        .map(|&node| {
            let on_axis = on_axis(&model.mesh, axis, node);
            let weight = |at: Vector2<f64>| if on_axis { model.mesh.section.weight(at) } else { 1.0 };
            let sum = |shares: &[NodalWeight]| -> f64 {
                let own = shares.iter().filter(|share| share.node == node);
                own.map(|share| -share.weight / weight(share.position)).sum()
            };
            (node, Vector2::new(sum(&x), sum(&y)))
        })
        .collect()
}

/// Normals of a node from the areas of its edges: one, unless they meet at a corner.
fn merged(areas: &[Vector2<f64>]) -> Vec<Vector2<f64>> {
    let mut sums: Vec<Vector2<f64>> = Vec::new();
    for area in areas.iter().filter(|area| area.norm() > 0.0) {
        let bent = |sum: &Vector2<f64>| sum.angle(area).to_degrees() < CORNER;
        match sums.iter_mut().find(|sum| bent(sum)) {
            Some(sum) => *sum += area,
            None => sums.push(*area),
        }
    }
    sums.into_iter().map(|sum| sum.normalize()).collect()
}
