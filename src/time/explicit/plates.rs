//! Loading platens (one equal component) and rigid platens in explicit increments.
//!
//! ```text
//! Σ m_c a = −Σ f_c                              one equal component; m_c: lumped masses
//! ```
//!
//! The mass of a platen is no smaller than that of any of its nodes, so the stability limit holds.
//!
//! # Rigid plates
//!
//! A rigid platen in explicit increments follows
//!
//! ```text
//! [m 1, m J c; (m J c)ᵀ, J_R] [a_R; θ̈] = [−F + ω² m c; −M_R]       c = x_C − x_R,   J_R = Σ m_c |x_c − x_R|²
//! ```
//!
//! R is the center of mass C, or the node A if it is supported; the equations of R are then those of the support. (7) and (8)
//! of [`crate::model::scheme`] hold for x_R and the angle, so that the platen rotates without stretching.

use nalgebra::{Matrix2, Matrix2x3, Matrix3, Rotation2, RowVector3, Vector2, Vector3};

use crate::equations::links::{give, perpendicular, relative};
use crate::mesh::configuration::vector;
use crate::model::boundary::Absorber;
use crate::model::support::Direction;
use crate::model::{Model, State, Step};

/// All platens of a model except those with two equal components.
#[derive(Clone)]
pub(super) struct Plates {
    alike: Vec<Alike>,
    rigid: Vec<Rigid>,
    /// Whether a node belongs to a platen; empty if there are none
    members: Vec<bool>,
}

/// Dampers and their forces.
#[derive(Clone, Copy)]
pub(super) struct DamperForces<'a> {
    /// Sorted by node
    pub dampers: &'a [Absorber],
    /// Force of each [F]
    pub forces: &'a [Vector2<f64>],
}

/// A platen with one equal component.
#[derive(Clone)]
struct Alike {
    /// Nodes, the first of which is the master
    nodes: Vec<usize>,
    component: usize,
    /// Σ m [M]
    mass: f64,
    /// v and a of the component
    rates: [f64; 2],
}

impl Plates {
    /// Creates the platens of a model in a step, with the lumped mass of every node.
    pub fn new(model: &Model, step: &Step, mass: &[f64]) -> Self {
        let linkage = &model.linkage;
        let alike = linkage.plates.iter().filter(|(_, [x, y])| x != y).map(|(nodes, components)| Alike {
            nodes: nodes.clone(),
            component: usize::from(components[1]),
            mass: nodes.iter().map(|&node| mass[node]).sum(),
            rates: [0.0; 2],
        });
        let rigid = linkage.rigid.iter().map(|&leaders| Rigid::new(model, step, mass, leaders));
        let mut members = vec![false; if linkage.plates.is_empty() { 0 } else { mass.len() }];
        linkage.plates.iter().flat_map(|(nodes, _)| nodes).for_each(|&node| members[node] = true);
        Self { alike: alike.collect(), rigid: rigid.collect(), members }
    }

    /// Whether a node belongs to a platen.
    pub fn has(&self, node: usize) -> bool {
        self.members.get(node).is_some_and(|member| *member)
    }

    /// (7): rotates rigid platens over `dt`, where R and all other platens have been moved already.
    pub fn turn(&self, model: &Model, dt: f64, state: &State, u: &mut [f64]) {
        self.rigid.iter().for_each(|plate| plate.turn(dt, state, u));
        model.linkage.spread(u);
    }

    /// First half of (8): stores v½.
    pub fn begin(&mut self, dt: f64, state: &State) {
        for plate in &mut self.alike {
            let [v, a] = [&state.velocity, &state.acceleration].map(|values| values[plate.leader()]);
            plate.rates = [v + 0.5 * dt * a, a];
        }
        self.rigid.iter_mut().for_each(|plate| plate.begin(dt, state));
    }

    /// Second half of (8) at the displacement `u` under the gathered forces, with prescribed accelerations of supports.
    pub fn accelerate(
        &mut self,
        model: &Model,
        dt: f64,
        u: &[f64],
        force: &[f64],
        supported: impl Fn(usize) -> f64,
        state: &mut State,
    ) {
        for plate in &mut self.alike {
            let a = -force[plate.leader()] / plate.mass;
            plate.rates = [plate.rates[0] + 0.5 * dt * a, a];
        }
        self.rigid.iter_mut().for_each(|plate| plate.accelerate(dt, u, force, &supported));
        self.set_motion(model, u, state);
    }

    /// (8) for dampers on platens; see [`super::Explicit::damp`].
    pub fn damp(&mut self, model: &Model, dt: f64, damping: DamperForces, u: &[f64], mass: &[f64], state: &mut State) {
        let DamperForces { dampers, forces } = damping;
        if dampers.is_empty() || self.members.is_empty() {
            return;
        }
        let mut own: Vec<(f64, f64)> = self.alike.iter().map(|plate| (plate.mass, 0.0)).collect();
        for (Absorber { node, coefficients }, force) in dampers.iter().zip(forces).filter(|(at, _)| self.has(at.node)) {
            let plates = [0, 1].map(|i| self.alike.iter().position(|plate| plate.is_leader_of(*node, i)));
            // The coupling of the two components by an absorbing side is contained in its force only.
            for i in (0..2).filter(|_| plates != [None; 2]) {
                let resisting = 0.5 * dt * coefficients[(i, i)];
                match plates[i] {
                    Some(k) => own[k] = (own[k].0 + resisting, own[k].1 + force[i]),
                    None => {
                        let acceleration = force[i] / (mass[*node] + resisting);
                        state.acceleration[2 * node + i] += acceleration;
                        state.velocity[2 * node + i] += 0.5 * dt * acceleration;
                    }
                }
            }
        }
        for (plate, (inertia, force)) in self.alike.iter_mut().zip(own) {
            plate.rates = [plate.rates[0] + 0.5 * dt * force / inertia, plate.rates[1] + force / inertia];
        }
        self.rigid.iter_mut().for_each(|plate| plate.damp(dt, damping, u));
        self.set_motion(model, u, state);
    }

    /// Sets master and all other nodes of platens the computed rates.
    fn set_motion(&self, model: &Model, u: &[f64], state: &mut State) {
        for plate in &self.alike {
            (state.velocity[plate.leader()], state.acceleration[plate.leader()]) = (plate.rates[0], plate.rates[1]);
        }
        self.rigid.iter().for_each(|plate| plate.set_motion(u, state));
        self.spread(model, u, state);
    }

    /// Gives all nodes of platens the rates of their masters.
    pub fn spread(&self, model: &Model, u: &[f64], state: &mut State) {
        self.rigid.iter().for_each(|plate| plate.spread(u, state));
        model.linkage.spread(&mut state.velocity);
        model.linkage.spread(&mut state.acceleration);
    }

    /// F + M a in a direction in which a support constrains a platen.
    pub fn reaction(&self, at: Direction, force: &[f64], acceleration: &[f64]) -> Option<f64> {
        if let Some(plate) = self.rigid.iter().find(|plate| plate.leaders[0] == at.node()) {
            return Some(plate.reaction(at, force, acceleration));
        }
        // The other component is the node's own.
        let plate = self.alike.iter().find(|plate| plate.leader() == at.dof)?;
        Some(at.of(force) + plate.mass * at.of(acceleration))
    }

    /// Correction of the nodal sum ½ v₋ᵀ M v₊: the centripetal force of a rotating platen does no work [F·L].
    pub fn turning_energy(&self, state: &State, dt: f64) -> f64 {
        self.rigid.iter().map(|plate| plate.turning_energy(state, dt)).sum()
    }
}

impl Alike {
    fn leader(&self) -> usize {
        2 * self.nodes[0] + self.component
    }

    /// Whether a component of a node belongs to this platen.
    fn is_leader_of(&self, node: usize, component: usize) -> bool {
        component == self.component && self.nodes.binary_search(&node).is_ok()
    }
}

/// A rigid plate.
#[derive(Clone)]
struct Rigid {
    /// Nodes A and B
    pub leaders: [usize; 2],
    /// e in the reference configuration [L]
    arm: Vector2<f64>,
    /// Nodes and their G − G_R
    nodes: Vec<(usize, Matrix2<f64>)>,
    /// G_R
    reference: Matrix2<f64>,
    /// Supports of A, with their numbers
    constrained: Vec<(usize, Direction)>,
    /// m [M]
    mass: f64,
    /// c = shift e
    shift: Matrix2<f64>,
    /// J_R [M L²]
    inertia: f64,
    /// v_R and ω, a_R and θ̈
    rates: [Vector3<f64>; 2],
}

impl Rigid {
    /// Creates the platen of a model in a step, with the lumped mass of every node.
    pub fn new(model: &Model, step: &Step, mass: &[f64], [a, b]: [usize; 2]) -> Self {
        let own = model.linkage.turning().filter(|follower| follower.leaders[0].0 == a);
        let followers = own.map(|follower| (follower.node, follower.leaders[1].1));
        let mut nodes: Vec<(usize, Matrix2<f64>)> =
            followers.chain([(a, Matrix2::zeros()), (b, Matrix2::identity())]).collect();
        let supports = step.supports.iter().map(|support| support.at).enumerate();
        let constrained: Vec<(usize, Direction)> = supports.filter(|(_, at)| at.node() == a).collect();
        let total: f64 = nodes.iter().map(|(node, _)| mass[*node]).sum();
        let center = nodes.iter().fold(Matrix2::zeros(), |sum, (node, share)| sum + share * mass[*node]) / total;
        let reference = if constrained.is_empty() { center } else { Matrix2::zeros() };
        let arm = model.mesh.nodes[b] - model.mesh.nodes[a];
        nodes.iter_mut().for_each(|(_, share)| *share -= reference);
        let inertia = nodes.iter().map(|(node, share)| mass[*node] * (share * arm).norm_squared()).sum();
        let (shift, rates) = (center - reference, [Vector3::zeros(); 2]);
        Self { leaders: [a, b], arm, nodes, reference, constrained, mass: total, shift, inertia, rates }
    }

    /// (7): rotates the platen over `dt`; R has been moved already.
    pub fn turn(&self, dt: f64, state: &State, u: &mut [f64]) {
        let e = self.arm + relative(self.leaders, &state.displacement);
        let [spin, angular] = self.turning(e, state);
        let turned = Rotation2::new(dt * (spin + 0.5 * dt * angular)) * e;
        let turned = turned * (self.arm.norm() / turned.norm());
        give(self.leaders, self.reference, turned - self.arm, u);
    }

    /// The first half of (8).
    pub fn begin(&mut self, dt: f64, state: &State) {
        let e = self.arm + relative(self.leaders, &state.displacement);
        let [v, a] = self.known(e, state);
        self.rates = [v + a * (0.5 * dt), a];
    }

    /// Gives A the computed rates.
    pub fn set_motion(&self, u: &[f64], state: &mut State) {
        let values = [&mut state.velocity, &mut state.acceleration];
        for ((rates, along), values) in self.rates.iter().zip(self.relative(u)).zip(values) {
            let first = rates.xy() - self.reference * along;
            (0..2).for_each(|i| values[2 * self.leaders[0] + i] = first[i]);
        }
    }

    /// Gives B the computed rates, given those of A.
    pub fn spread(&self, u: &[f64], state: &mut State) {
        let [a, b] = self.leaders;
        for (values, along) in [&mut state.velocity, &mut state.acceleration].into_iter().zip(self.relative(u)) {
            (0..2).for_each(|i| values[2 * b + i] = values[2 * a + i] + along[i]);
        }
    }

    /// F + m a_C along a direction.
    pub fn reaction(&self, at: Direction, force: &[f64], acceleration: &[f64]) -> f64 {
        let [a, b] = self.leaders;
        let center = vector(acceleration, a) + (self.shift + self.reference) * relative([a, b], acceleration);
        at.vector().dot(&(vector(force, a) + vector(force, b) + center * self.mass))
    }

    /// Correction of the nodal sum ½ v₋ᵀ M v₊ [F·L].
    pub fn turning_energy(&self, state: &State, dt: f64) -> f64 {
        let e = self.arm + relative(self.leaders, &state.displacement);
        0.125 * dt * dt * self.inertia * self.turning(e, state)[0].powi(4)
    }

    /// ω and θ̈ of a state.
    fn turning(&self, e: Vector2<f64>, state: &State) -> [f64; 2] {
        [&state.velocity, &state.acceleration].map(|values| e.perp(&relative(self.leaders, values)) / e.norm_squared())
    }

    /// v_R and ω, a_R and θ̈ of a state.
    fn known(&self, e: Vector2<f64>, state: &State) -> [Vector3<f64>; 2] {
        let turning = self.turning(e, state);
        let a = self.leaders[0];
        let of = |values: &[f64], turning: f64| {
            let middle = vector(values, a) + self.reference * relative(self.leaders, values);
            Vector3::new(middle.x, middle.y, turning)
        };
        [of(&state.velocity, turning[0]), of(&state.acceleration, turning[1])]
    }

    /// Velocity and acceleration of B relative to A.
    fn relative(&self, u: &[f64]) -> [Vector2<f64>; 2] {
        let e = self.arm + relative(self.leaders, u);
        let [spin, angular] = [self.rates[0].z, self.rates[1].z];
        [perpendicular(e) * spin, perpendicular(e) * angular - e * (spin * spin)]
    }

    /// Second half of (8) at the displacement `u` under the gathered forces, with prescribed accelerations of supports.
    pub fn accelerate(&mut self, dt: f64, u: &[f64], force: &[f64], supported: &impl Fn(usize) -> f64) {
        let [a, b] = self.leaders;
        let e = self.arm + relative(self.leaders, u);
        let [of_a, of_b] = [a, b].map(|node| vector(force, node));
        let total = of_a + of_b;
        let moment = e.perp(&of_b) - (self.reference * e).perp(&total);
        let spin = self.rates[0].z + 0.5 * dt * self.rates[1].z;
        let force = self.shift * e * (spin * spin * self.mass) - total;
        let found = self.solve(e, Matrix3::zeros(), Vector3::new(force.x, force.y, -moment), supported);
        self.rates = [self.rates[0] + found * (0.5 * dt), found];
    }

    /// (8) for dampers on the platen.
    pub fn damp(&mut self, dt: f64, damping: DamperForces, u: &[f64]) {
        let DamperForces { dampers, forces } = damping;
        let e = self.arm + relative(self.leaders, u);
        let (mut resisting, mut force) = (Matrix3::zeros(), Vector3::zeros());
        for (node, share) in &self.nodes {
            let Ok(k) = dampers.binary_search_by_key(node, |damper| damper.node) else { continue };
            let turned = perpendicular(share * e);
            let motion = Matrix2x3::new(1.0, 0.0, turned.x, 0.0, 1.0, turned.y);
            resisting += motion.transpose() * dampers[k].coefficients * motion;
            force += motion.transpose() * forces[k];
        }
        let found = self.solve(e, resisting * (0.5 * dt), force, &|_| 0.0);
        self.rates = [self.rates[0] + found * (0.5 * dt), self.rates[1] + found];
    }

    /// a_R and θ̈ from forces and moment, with damping added to the masses; prescribed where A is supported.
    fn solve(
        &self,
        e: Vector2<f64>,
        resisting: Matrix3<f64>,
        mut right: Vector3<f64>,
        supported: &impl Fn(usize) -> f64,
    ) -> Vector3<f64> {
        let turned = perpendicular(self.shift * e) * self.mass;
        let m = self.mass;
        let mut matrix = Matrix3::new(m, 0.0, turned.x, 0.0, m, turned.y, turned.x, turned.y, self.inertia) + resisting;
        for &(k, at) in &self.constrained {
            let (row, d) = (at.dof % 2, at.vector());
            if at.inclined.is_some() {
                let across = Vector2::new(-d.y, d.x);
                let kept = matrix.row(0) * across.x + matrix.row(1) * across.y;
                matrix.set_row(1 - row, &kept);
                right[1 - row] = across.dot(&right.xy());
            }
            matrix.set_row(row, &RowVector3::new(d.x, d.y, 0.0));
            right[row] = supported(k);
        }
        // Masses are positive definite, and damping adds to them.
        matrix.lu().solve(&right).unwrap_or_default()
    }
}
