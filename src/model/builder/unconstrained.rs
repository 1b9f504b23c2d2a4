//! Detection of unconstrained motions before the run: bodies with rigid-body modes in a static step, bodies and nodes
//! without mass in a dynamic one, and unsupported nodes outside all bodies.
//!
//! A shared node, a periodic copy, a follower of a platen, a support, a spring and a dashpot are equations between the rigid
//! motions of the parts of a model, one row of numbers each. A motion orthogonal to all of them meets no resistance ([`Resistance`]).

use std::collections::BTreeMap;

use nalgebra::{DVector, Vector2, Vector3};

use super::error::{Checked, ModelError};
use super::load_step::LoadStep;
use super::rigid;
use crate::bars::segment::Segment;
use crate::bars::turn::Turn;
use crate::bars::vectors::{Vectors, turned};
use crate::contact::surface::Surface;
use crate::contact::{ContactPair, Master};
use crate::mesh::joined::Joined;
use crate::mesh::rigid::RigidBody;
use crate::model::resistance::{FEW_PARTS, Frame, MOTIONS, Resistance, Term};
use crate::model::support::Direction;
use crate::model::{Model, Step};

/// Checks that every motion meets stiffness or, in a dynamic step, mass.
pub fn check(given: &[LoadStep], model: &Model) -> Checked<()> {
    for (k, step) in model.steps.iter().enumerate() {
        if step.scheme.is_dynamic() || step.rupture.is_some() {
            check_mass(k, step, model)?;
        }
        if !step.scheme.is_dynamic() {
            check_lone_nodes(k, step, model)?;
        }
    }
    check_floating(given, model)
}

/// Checks nodes without a body, which have only their supports, springs, dashpots and contact.
fn check_lone_nodes(k: usize, step: &Step, model: &Model) -> Checked<()> {
    let mut constrained = vec![false; model.dofs()];
    let nodes = model.bodies.iter().flat_map(|body| &body.nodes);
    nodes.for_each(|&node| constrained[2 * node..2 * node + 2].fill(true));
    model.flow.iter().for_each(|flow| constrained[2 * flow.first..].fill(true));
    // Whether contact constrains a node that may separate is left to the solver.
    let rigid = model.contacts.iter().filter_map(|pair| pair.master.rigid_body()).flat_map(RigidBody::nodes);
    let points = model.contacts.iter().flat_map(ContactPair::slave_nodes).chain(rigid);
    points.for_each(|node| constrained[2 * node..2 * node + 2].fill(true));
    let of_bars = model.bars.iter().enumerate().filter(|(bar, _)| step.bars.has(*bar)).flat_map(|(_, bar)| bar.nodes());
    of_bars.for_each(|node| constrained[2 * node..2 * node + 2].fill(true));
    let follow = model.linkage.followers.iter().flat_map(|follower| follower.dofs());
    follow.for_each(|(_, dof)| constrained[dof] = true);
    for (node, d) in constraints(step) {
        // An inclined direction and its perpendicular count as the dofs whose equations they replace.
        constrained[2 * node + usize::from(d.x.abs() < d.y.abs())] = true;
    }
    let free = constrained.iter().position(|constrained| !constrained);
    if let Some((RigidBody { name, .. }, key)) = free.and_then(|dof| rigid::free_motion(&model.mesh, dof)) {
        let message =
            format!("nothing touches the rigid body `{name}`, and its {key} is free: give it, 0 where it rests");
        return Err(ModelError::new(format!("steps[{k}].supports"), message));
    }
    let Some(dof) = free else { return Ok(()) };
    let (tag, axis) = (model.mesh.node_tags[dof / 2], ["x", "y"][dof % 2]);
    let message = format!(
        "node {tag} belongs to no element and is free along {axis}: constrain it by a support, a spring or contact"
    );
    Err(ModelError::new(format!("steps[{k}].supports"), message))
}

/// Checks that free nodes have mass, from which accelerations follow.
fn check_mass(k: usize, step: &Step, model: &Model) -> Checked<()> {
    let mut has_mass = vec![false; model.mesh.nodes.len()];
    let dense =
        model.bodies.iter().filter(|body| body.material.description().density > 0.0).flat_map(|body| &body.nodes);
    let points = model.point_masses.iter().flat_map(|point| &point.nodes);
    dense.chain(points).for_each(|&node| has_mass[node] = true);
    model.mesh.rigid_bodies.iter().for_each(|body| has_mass[body.turning] = body.inertia > 0.0);
    let prescribed = |dof: usize| step.supports.binary_search_by_key(&dof, |support| support.at.dof).is_ok();
    let constrained = |node: usize| prescribed(2 * node) && prescribed(2 * node + 1);
    let heavy = model.bars_in(step).filter(|(_, bar)| bar.mass > 0.0).flat_map(|(_, bar)| &bar.vertices);
    heavy.flat_map(|vertex| &vertex.nodes).for_each(|&node| has_mass[node] = true);
    // Pressures have no inertia.
    model.flow.iter().for_each(|flow| has_mass[flow.first..].fill(true));
    let massless = |node: &usize| !(has_mass[*node] || constrained(*node));
    let why = format!("the dynamic step `{}` (steps[{k}]) needs a mass", step.name);
    if let Some(body) = model.bodies.iter().find(|body| body.nodes.iter().any(massless)) {
        let message = format!("is 0, but {why}: give a density");
        return Err(ModelError::new(format!("bodies.{}.material.density", body.name), message));
    }
    if let Some(bar) = model.bars.iter().find(|bar| bar.own.iter().any(massless)) {
        let message = format!("is 0, but {why}: give the mass per length");
        return Err(ModelError::new(format!("bars.{}.mass", bar.name), message));
    }
    let free = (0..model.mesh.nodes.len()).find(massless);
    let rigid = free.and_then(|node| model.mesh.rigid_bodies.iter().find(|body| body.nodes().contains(&node)));
    if let Some(RigidBody { name, turning, .. }) = rigid {
        let (place, motion) = match free == Some(*turning) {
            true => (format!("rigid_bodies.{name}.inertia"), "or give its angle by a support"),
            false => (format!("point_masses.{name}"), "or give its ux and uy by supports"),
        };
        return Err(ModelError::new(place, format!("is missing, but {why}: give one, {motion}")));
    }
    let Some(node) = free else { return Ok(()) };
    let tag = model.mesh.node_tags[node];
    let message = format!("node {tag} belongs to no element, and {why}: give one to its group");
    Err(ModelError::new("point_masses", message))
}

/// Fraction of the largest motion below which motions are not reported.
const NAMED: f64 = 0.1;

/// Checks that bodies are constrained in x, y and rotation by supports, springs or dashpots in every static step, directly or
/// through their coupling with others: contact, shared nodes, periodic sides and platens. Contact counts as constraint in every
/// direction, and a single shared node as a hinge. A group that touches a rigid body is left to the solver.
fn check_floating(given: &[LoadStep], model: &Model) -> Checked<()> {
    let still: Vec<(usize, &Step)> =
        model.steps.iter().enumerate().filter(|(_, step)| !step.scheme.is_dynamic()).collect();
    still
        .chunk_by(|(_, a), (_, b)| a.absent == b.absent && a.bars.absent == b.bars.absent)
        .try_for_each(|alike| check_floating_in(alike, given, model))
}

/// The same for steps with the same bodies.
fn check_floating_in(steps: &[(usize, &Step)], given: &[LoadStep], model: &Model) -> Checked<()> {
    let Some((_, first)) = steps.first() else { return Ok(()) };
    let parts = Parts::of(model, first);
    let mut coupled = Resistance::nothing(parts.parts.len());
    parts.couplings().iter().for_each(|row| coupled.equate(row));
    // Larger groups are left to the solver, which reports free motions.
    let groups = coupled.groups().into_iter().filter(|group| group.len() <= FEW_PARTS && parts.are_checked(group));
    let groups: Vec<_> = groups.collect();
    for &(k, step) in steps {
        let mut resistance = coupled.clone();
        constraints(step).for_each(|at| resistance.equate(&parts.row(&[at])));
        let free = groups.iter().find_map(|group| Some(parts.described(group, &resistance.free_motion(group)?)));
        let Some(free) = free else { continue };
        let constrained = if given[k].supports.is_empty() && step.supports.is_empty() {
            "there is no support at all"
        } else {
            "the supports do not constrain it"
        };
        let message =
            format!("{free}: {constrained}; a static step needs supports or springs against every rigid-body motion");
        return Err(ModelError::new(format!("steps[{k}].supports"), message));
    }
    Ok(())
}

/// Nodes and directions constrained by supports, springs and dashpots.
fn constraints(step: &Step) -> impl Iterator<Item = (usize, Vector2<f64>)> {
    let springs = step.loads.springs.iter().map(|spring| spring.dof);
    let absorbers = step.loads.absorbers.iter().flat_map(|absorber| [2 * absorber.node, 2 * absorber.node + 1]);
    let dofs = springs.chain(step.loads.dashpots.iter().map(|dashpot| dashpot.dof)).chain(absorbers);
    let supports = step.supports.iter().map(|support| support.at);
    supports.chain(dofs.map(Direction::from)).map(|at| (at.node(), at.vector()))
}

/// A part: bodies in contact or with two shared nodes, or a node outside all bodies.
struct Part {
    /// bodies
    bodies: Vec<usize>,
    /// whether it touches a rigid body
    on_rigid: bool,
    nodes: Vec<usize>,
    frame: Frame,
}

/// All parts of a model.
struct Parts<'m> {
    /// list of parts
    parts: Vec<Part>,
    model: &'m Model,
    /// whether each bar is absent; empty if all are there
    bars_absent: Vec<bool>,
    /// parts of each node: more than one for a hinge
    of_node: Vec<Vec<usize>>,
}

impl<'m> Parts<'m> {
    /// Finds the parts of a model in a step.
    fn of(model: &'m Model, step: &Step) -> Self {
        let owners = owners(model, step);
        let groups = joined(model, step, &owners);
        let mut part_of = vec![0; groups.iter().map(Vec::len).sum()];
        groups.iter().enumerate().for_each(|(part, group)| group.iter().for_each(|&owner| part_of[owner] = part));
        let mut of_node = owners;
        for parts in &mut of_node {
            parts.iter_mut().for_each(|owner| *owner = part_of[*owner]);
            parts.sort_unstable();
            parts.dedup();
        }
        let mut nodes = vec![Vec::new(); groups.len()];
        of_node.iter().enumerate().for_each(|(node, parts)| parts.iter().for_each(|&part| nodes[part].push(node)));
        let mut parts: Vec<Part> =
            groups.iter().zip(nodes).map(|(group, nodes)| Part::of(group, nodes, model)).collect();
        for pair in model.contacts.iter().filter(|pair| step.joins(pair) && matches!(pair.master, Master::Rigid(_))) {
            pair.slave_nodes().flat_map(|node| &of_node[node]).for_each(|&part| parts[part].on_rigid = true);
        }
        Self { parts, model, bars_absent: step.bars.absent.clone(), of_node }
    }

    /// Names of the bodies of a part, or of its node.
    fn names(&self, part: usize) -> Vec<String> {
        let Part { bodies, nodes, .. } = &self.parts[part];
        match bodies.is_empty() {
            true => nodes.iter().map(|&node| self.model.lone_name(node)).collect(),
            false => bodies.iter().map(|&body| format!("`{}`", self.model.bodies[body].name)).collect(),
        }
    }

    /// Whether a group is checked: it has bodies that are there, and touches no rigid body.
    fn are_checked(&self, group: &[usize]) -> bool {
        let any = |has: fn(&Part) -> bool| group.iter().any(|&part| has(&self.parts[part]));
        any(|part| !part.bodies.is_empty()) && any(|part| !part.nodes.is_empty()) && !any(|part| part.on_rigid)
    }

    /// Describes a motion of a group.
    fn described(&self, group: &[usize], motion: &DVector<f64>) -> String {
        let moves = |k: usize| motion[k].abs() > NAMED * motion.amax();
        let moving = (0..group.len()).filter(|slot| (0..3).any(|i| moves(3 * slot + i)));
        let mut names: Vec<String> = moving.flat_map(|slot| self.names(group[slot])).collect();
        names.dedup();
        let free = (0..3).filter(|i| (0..group.len()).any(|slot| moves(3 * slot + i))).map(|i| MOTIONS[i]);
        format!("{} can move freely {}", names.join(" with "), free.collect::<Vec<_>>().join(" with "))
    }

    /// Σ d·u of nodes and vectors d.
    fn row(&self, terms: &[(usize, Vector2<f64>)]) -> Vec<Term> {
        terms.iter().map(|&(node, d)| self.term(self.of_node[node][0], node, d)).collect()
    }

    /// d·u of a node as part of a rigid motion.
    fn term(&self, part: usize, node: usize, d: Vector2<f64>) -> Term {
        Term { part, share: self.parts[part].frame.motion(self.model.mesh.nodes[node]).tr_mul(&d) }
    }

    /// All expressions that are zero in every step.
    fn couplings(&self) -> Vec<Vec<Term>> {
        let mut rows = self.of_shape();
        for (node, parts) in self.of_node.iter().enumerate() {
            let hinge = |d: Vector2<f64>, other: usize| vec![self.term(parts[0], node, d), self.term(other, node, -d)];
            rows.extend(parts[1..].iter().flat_map(|&other| AXES.map(|d| hinge(d, other))));
        }
        let ties = self.model.ties.pairs().iter();
        rows.extend(ties.flat_map(|&(copy, original)| AXES.map(|d| self.row(&[(copy, d), (original, -d)]))));
        for follower in &self.model.linkage.followers {
            let leaders = |i: usize| follower.leaders.iter().map(move |(node, g)| (*node, -g.row(i).transpose()));
            let row = |(i, _): (usize, usize)| {
                self.row(&[(follower.node, AXES[i])].into_iter().chain(leaders(i)).collect::<Vec<_>>())
            };
            rows.extend(follower.dofs().map(row));
        }
        rows.extend(self.of_bars());
        // The leaders of a rotating platen keep their distance.
        let direction = |&[a, b]: &[usize; 2]| (self.model.mesh.nodes[b] - self.model.mesh.nodes[a]).normalize();
        rows.extend(
            self.model
                .linkage
                .rigid
                .iter()
                .map(|plate| self.row(&[(plate[1], direction(plate)), (plate[0], -direction(plate))])),
        );
        rows
    }

    /// Equations of bars: their segments keep their length and their angles, and bond keeps their place.
    fn of_bars(&self) -> Vec<Vec<Term>> {
        let row = |vectors: &Vectors, d: [Vector2<f64>; 2]| {
            let terms = vectors.terms().map(|(node, share)| (node, d[0] * share[0] + d[1] * share[1]));
            self.row(&terms.collect::<Vec<_>>())
        };
        let none = Vector2::zeros();
        let there =
            self.model.bars.iter().enumerate().filter(|(bar, _)| !self.bars_absent.get(*bar).copied().unwrap_or(false));
        there
            .flat_map(|(_, bar)| {
                let along = |segment: &Segment| row(&segment.vectors, [segment.vectors.at[0].normalize(), none]);
                let turn = |turn: &Turn| {
                    let slope = |e: Vector2<f64>| turned(e) * (turn.length / e.norm_squared());
                    row(&turn.vectors, [-slope(turn.vectors.at[0]), slope(turn.vectors.at[1])])
                };
                let grips = bar.grips.iter().flat_map(|grip| AXES.map(|d| row(&grip.vectors, [d, none])));
                let segments = bar.segments.iter().map(along);
                segments.chain(bar.turns.iter().map(turn)).chain(grips).collect::<Vec<_>>()
            })
            .collect()
    }

    /// Intrinsic constraints of a part: in axisymmetry all motions except the axial one, and the rotation of a node.
    fn of_shape(&self) -> Vec<Vec<Term>> {
        let axisymmetric = self.model.mesh.section.is_axisymmetric();
        let of = |(part, Part { bodies, nodes, .. }): (usize, &Part)| {
            let hoops = axisymmetric && !bodies.is_empty();
            let [u, turn] = [hoops, hoops || nodes.len() == 1];
            [(u, 0), (turn, 2)]
                .into_iter()
                .filter(|(resisted, _)| *resisted)
                .map(move |(_, i)| vec![Term { part, share: Vector3::ith(i, 1.0) }])
        };
        self.parts.iter().enumerate().flat_map(of).collect()
    }
}

const AXES: [Vector2<f64>; 2] = [Vector2::new(1.0, 0.0), Vector2::new(0.0, 1.0)];

impl Part {
    fn of(owners: &[usize], nodes: Vec<usize>, model: &Model) -> Self {
        let frame = Frame::of(nodes.iter().map(|&node| model.mesh.nodes[node]));
        let bodies = owners.iter().copied().filter(|owner| *owner < model.bodies.len()).collect();
        Self { bodies, on_rigid: false, nodes, frame }
    }
}

/// Bodies of each node that are there in a step; a node outside them has a number of its own after theirs.
fn owners(model: &Model, step: &Step) -> Vec<Vec<usize>> {
    let mut owners = vec![Vec::new(); model.mesh.nodes.len()];
    for (body, of) in model.bodies.iter().enumerate().filter(|(body, _)| step.has(*body)) {
        of.nodes.iter().for_each(|&node| owners[node].push(body));
    }
    let lone = owners.iter_mut().filter(|bodies| bodies.is_empty());
    lone.zip(model.bodies.len()..).for_each(|(own, number)| own.push(number));
    owners
}

/// Groups of bodies and nodes that move as one.
fn joined(model: &Model, step: &Step, owners: &[Vec<usize>]) -> Vec<Vec<usize>> {
    let mut joined = Joined::new(1 + owners.iter().flatten().max().copied().unwrap_or(0));
    bonded(model, owners).into_iter().for_each(|(a, b)| joined.join(a, b));
    for pair in model.contacts.iter().filter(|pair| step.joins(pair)) {
        let Master::Mesh(Surface { segments, .. }) = &pair.master else { continue };
        // An edge group may belong to several bodies.
        let nodes = pair.slave_nodes().chain(segments.iter().flat_map(|segment| segment.ends));
        let met: Vec<usize> = nodes.flat_map(|node| owners[node].iter().copied()).collect();
        met.windows(2).for_each(|two| joined.join(two[0], two[1]));
    }
    joined.groups()
}

/// Bodies that share two nodes.
fn bonded(model: &Model, owners: &[Vec<usize>]) -> Vec<(usize, usize)> {
    let mut first: BTreeMap<(usize, usize), usize> = BTreeMap::new();
    let mut bonded = Vec::new();
    for (node, bodies) in owners.iter().enumerate() {
        for (k, &a) in bodies.iter().enumerate() {
            for &b in &bodies[k + 1..] {
                let hinge = *first.entry((a, b)).or_insert(node);
                if model.mesh.nodes[hinge] != model.mesh.nodes[node] {
                    bonded.push((a, b));
                }
            }
        }
    }
    bonded
}
