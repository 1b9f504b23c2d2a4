//! Detection of unconstrained motions before the run: bodies with rigid-body modes in a static step, bodies and nodes
//! without mass in a dynamic one, and unsupported nodes outside all bodies.
//!
//! # Unconstrained bodies
//!
//! A shared node, a periodic copy, a follower of a platen, a support, a spring and a dashpot are equations between the rigid
//! motions of the parts of a model, one row of numbers each. A motion orthogonal to all of them meets no resistance.
//!
//! # Parts
//!
//! The parts of a model move as rigid bodies:
//!
//! ```text
//! u(X) = (U, V) + Θ J (X − X_c)/R          R: to the farthest node, so that all three numbers are lengths
//! ```
//!
//! # Resistance
//!
//! The resisted motions form a vector space.

use std::collections::BTreeMap;

use nalgebra::{DVector, Vector2, Vector3};

use super::error::{Checked, ModelError};
use super::load_step::LoadStep;
use super::rigid;
use crate::bars::segment::Segment;
use crate::bars::turn::Turn;
use crate::bars::vectors::{Vectors, turned};
use crate::contact::master::Master;
use crate::contact::pair::ContactPair;
use crate::contact::surface::Surface;
use crate::mesh::joined::Joined;
use crate::mesh::rigid::RigidBody;
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
    model.flow.iter().for_each(|flow| constrained[2 * flow.first..flow.dof(flow.count())].fill(true));
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
    let mut carried = vec![false; model.mesh.nodes.len()];
    let dense =
        model.bodies.iter().filter(|body| body.material.description().density > 0.0).flat_map(|body| &body.nodes);
    let points = model.point_masses.iter().flat_map(|point| &point.nodes);
    dense.chain(points).for_each(|&node| carried[node] = true);
    model.mesh.rigid_bodies.iter().for_each(|body| carried[body.turning] = body.inertia > 0.0);
    let prescribed = |dof: usize| step.supports.binary_search_by_key(&dof, |support| support.at.dof).is_ok();
    let constrained = |node: usize| prescribed(2 * node) && prescribed(2 * node + 1);
    let heavy = model.bars.iter().filter(|bar| bar.mass > 0.0).flat_map(|bar| &bar.own);
    heavy.for_each(|&node| carried[node] = true);
    let massless = |node: &usize| !(carried[*node] || constrained(*node));
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

/// Number of parts of a group up to which motions are checked here; larger groups are left to the solver, which reports free
/// modes.
const FEW_PARTS: usize = 32;

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
    let groups = Groups::of(&parts);
    for &(k, step) in steps {
        let Some(free) = groups.free_motion(step) else { continue };
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

/// Groups of parts that are coupled, directly or through others.
struct Groups<'m> {
    parts: &'m Parts<'m>,
    members: Vec<Vec<usize>>,
    /// group of each part and its index there; `None` for parts left to the solver
    place: Vec<Option<(usize, usize)>>,
    /// motions resisted by couplings in each group
    resisted: Vec<Resisted>,
}

impl<'m> Groups<'m> {
    fn of(parts: &'m Parts<'m>) -> Self {
        let couplings = parts.couplings();
        let mut joined = Joined::new(parts.parts.len());
        for row in &couplings {
            row.windows(2).for_each(|two| joined.join(two[0].0, two[1].0));
        }
        let is_checked = |group: &Vec<usize>| {
            let has_bodies = group.iter().any(|&part| !parts.parts[part].bodies.is_empty());
            let is_there = group.iter().any(|&part| !parts.parts[part].nodes.is_empty());
            is_there && has_bodies && group.len() <= FEW_PARTS && !group.iter().any(|&part| parts.parts[part].on_rigid)
        };
        let members: Vec<Vec<usize>> = joined.groups().into_iter().filter(is_checked).collect();
        let mut place = vec![None; parts.parts.len()];
        for (g, group) in members.iter().enumerate() {
            group.iter().enumerate().for_each(|(slot, &part)| place[part] = Some((g, slot)));
        }
        let resisted = members.iter().map(|group| Resisted::nothing(3 * group.len())).collect();
        let mut groups = Self { parts, members, place, resisted };
        let mut resisted = std::mem::take(&mut groups.resisted);
        couplings.iter().for_each(|row| groups.add(row, &mut resisted));
        Self { resisted, ..groups }
    }

    /// Adds a row to the resisted motions.
    fn add(&self, row: &Row, resisted: &mut [Resisted]) {
        let Some((group, _)) = row.first().and_then(|(part, _)| self.place[*part]) else { return };
        let mut sum = DVector::zeros(3 * self.members[group].len());
        for (part, share) in row {
            let Some((_, slot)) = self.place[*part] else { return };
            (0..3).for_each(|i| sum[3 * slot + i] += share[i]);
        }
        // Cancelling terms leave round-off relative to their size.
        let size = row.iter().map(|(_, share)| share.norm_squared()).sum::<f64>().sqrt();
        resisted[group].add(sum, size);
    }

    /// Describes the unconstrained motion in a step, if there is one.
    fn free_motion(&self, step: &Step) -> Option<String> {
        let mut resisted = self.resisted.clone();
        constraints(step).for_each(|at| self.add(&self.parts.row(&[at]), &mut resisted));
        let mut motions = resisted.iter().zip(&self.members);
        motions.find_map(|(resisted, group)| Some(self.message(group, &resisted.free()?)))
    }

    fn message(&self, group: &[usize], motion: &DVector<f64>) -> String {
        let moves = |k: usize| motion[k].abs() > NAMED * motion.amax();
        let moving = (0..group.len()).filter(|slot| (0..3).any(|i| moves(3 * slot + i)));
        let mut names: Vec<String> = moving.flat_map(|slot| self.parts.names(group[slot])).collect();
        names.dedup();
        let words = ["along x", "along y", "in rotation"];
        let free: Vec<&str> =
            (0..3).filter(|i| (0..group.len()).any(|slot| moves(3 * slot + i))).map(|i| words[i]).collect();
        format!("{} can move freely {}", names.join(" with "), free.join(" with "))
    }
}

/// An equation between the motions of parts: coefficients of U, V and Θ of each.
type Row = Vec<(usize, Vector3<f64>)>;

/// A part: bodies in contact or with two shared nodes, or a node outside all bodies.
struct Part {
    /// bodies
    bodies: Vec<usize>,
    /// whether it touches a rigid body
    on_rigid: bool,
    nodes: Vec<usize>,
    centre: Vector2<f64>,
    radius: f64,
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

    /// Σ d·u of nodes and vectors d.
    fn row(&self, terms: &[(usize, Vector2<f64>)]) -> Row {
        terms.iter().map(|&(node, d)| self.term(self.of_node[node][0], node, d)).collect()
    }

    /// d·u of a node as part of a rigid motion.
    fn term(&self, part: usize, node: usize, d: Vector2<f64>) -> (usize, Vector3<f64>) {
        let Part { centre, radius, .. } = self.parts[part];
        let arm = (self.model.mesh.nodes[node] - centre) / radius;
        (part, Vector3::new(d.x, d.y, d.y * arm.x - d.x * arm.y))
    }

    /// All expressions that are zero in every step.
    fn couplings(&self) -> Vec<Row> {
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
        let apart = |&[a, b]: &[usize; 2]| (self.model.mesh.nodes[b] - self.model.mesh.nodes[a]).normalize();
        rows.extend(
            self.model
                .linkage
                .rigid
                .iter()
                .map(|plate| self.row(&[(plate[1], apart(plate)), (plate[0], -apart(plate))])),
        );
        rows
    }

    /// Equations of bars: their segments keep their length and their angles, and bond keeps their place.
    fn of_bars(&self) -> Vec<Row> {
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
    fn of_shape(&self) -> Vec<Row> {
        let axisymmetric = self.model.mesh.section.is_axisymmetric();
        let of = |(part, Part { bodies, nodes, .. }): (usize, &Part)| {
            let hoops = axisymmetric && !bodies.is_empty();
            let [u, turn] = [hoops, hoops || nodes.len() == 1];
            [(u, 0), (turn, 2)]
                .into_iter()
                .filter(|(resisted, _)| *resisted)
                .map(move |(_, i)| vec![(part, Vector3::ith(i, 1.0))])
        };
        self.parts.iter().enumerate().flat_map(of).collect()
    }
}

const AXES: [Vector2<f64>; 2] = [Vector2::new(1.0, 0.0), Vector2::new(0.0, 1.0)];

impl Part {
    fn of(owners: &[usize], nodes: Vec<usize>, model: &Model) -> Self {
        let place = |node: &usize| model.mesh.nodes[*node];
        let centre = nodes.iter().map(place).sum::<Vector2<f64>>() / nodes.len() as f64;
        let radius = nodes.iter().fold(f64::MIN_POSITIVE, |r, node| r.max((place(node) - centre).norm()));
        let bodies = owners.iter().copied().filter(|owner| *owner < model.bodies.len()).collect();
        Self { bodies, on_rigid: false, nodes, centre, radius }
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

/// Relative remainder below which an equation is linearly dependent on the others.
const NOTHING_NEW: f64 = 1e-5;

/// Motions resisted by equations: an orthonormal basis.
#[derive(Clone)]
struct Resisted {
    size: usize,
    basis: Vec<DVector<f64>>,
}

impl Resisted {
    /// Creates an empty basis for motions with `size` components.
    fn nothing(size: usize) -> Self {
        Self { size, basis: Vec::new() }
    }

    /// Component of a vector orthogonal to the basis.
    fn rest(&self, mut of: DVector<f64>) -> DVector<f64> {
        // The second pass removes the round-off of the first.
        for known in self.basis.iter().chain(&self.basis) {
            let along = known.dot(&of);
            of.axpy(-along, known, 1.0);
        }
        of
    }

    /// Adds one more equation, with terms of the given size.
    fn add(&mut self, row: DVector<f64>, size: f64) {
        if self.basis.len() == self.size {
            return;
        }
        let rest = self.rest(row);
        let norm = rest.norm();
        if norm > NOTHING_NEW * size {
            self.basis.push(rest / norm);
        }
    }

    /// A unit motion without resistance.
    fn free(&self) -> Option<DVector<f64>> {
        if self.basis.len() == self.size {
            return None;
        }
        let rest = |k: usize| {
            let mut unit = DVector::zeros(self.size);
            unit[k] = 1.0;
            self.rest(unit)
        };
        let longer = |a: DVector<f64>, b: DVector<f64>| if b.norm() > a.norm() { b } else { a };
        (0..self.size).map(rest).reduce(longer)
    }
}
