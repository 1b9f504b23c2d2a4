//! Projection of the points of a pair on the master, and its uses: initial state of a contact, slip rates, penetration of
//! master nodes.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Matrix2, Vector2};

use super::kinematics::{Kinematics, Meeting, kinematics};
use super::master::Master;
use super::mortar::{Overlaps, Room};
use super::nodal_forces::nodal_forces;
use super::pair::{BothSurfaces, ContactPair, InitialTraction};
use super::point::{Came, ContactState};
use super::pores::effective;
use super::search::Index;
use super::small_sliding::{SmallPoint, SmallSliding};
use super::surface::{SlavePoint, Weights, nodal_points};
use crate::laws::friction::FrictionState;
use crate::mesh::configuration::Configuration;

/// Gap within which surfaces that bear nothing at the start count as touching, over the length of the slave's edge there: what the
/// positions of a file with a few digits leave open, and far less than what a curve recedes over the closed edges of a contact. As
/// larger gaps are counted from there, too, no step is left in the surface, and no kink where an overlap ends.
const TOUCHING: f64 = 1e-6;

/// Projection of a point on the master and its kinematics; `None` without a projection.
pub(super) type Met = Option<(Meeting, Kinematics)>;

impl ContactPair {
    /// Starts the contact closed: the gap of every point is measured so that its given pressure acts in the configuration `x`.
    ///
    /// ```text
    /// p = p_init + α_n (g_x − g)        g_x: gap between the surfaces in the configuration x
    /// ```
    /// In the augmented Lagrangian method p_init is the first multiplier instead. Points that bear nothing keep the shape of the
    /// surfaces, without their overlap D:
    ///
    /// ```text
    /// g = max(g_x + D − 10⁻⁶ ℓ, 0) at the start     D = −min(g_x, 0) over these points,   ℓ: the slave's edge
    /// ```
    ///
    /// # Errors
    /// Returns the number of the first point that bears something and has no projection on the master.
    pub fn start_closed(&mut self, initial: Vec<InitialTraction>, x: &Configuration) -> Result<(), usize> {
        let met = self.meetings(x, false);
        let bears = |k: usize| initial[k].pressure > 0.0 || initial[k].traction != 0.0;
        let free = met.iter().enumerate().filter(|(k, _)| !bears(*k)).filter_map(|(_, met)| Some(met.as_ref()?.0.gap));
        let overlap = -free.fold(0.0, f64::min);
        for (k, (slave, met)) in self.points.iter_mut().zip(met).enumerate() {
            let (pressure, bears) = (initial[k].pressure, bears(k));
            let give = if self.penetration.is_some() { 0.0 } else { pressure / self.alpha_n };
            let touching = TOUCHING * slave.edge_length(x).unwrap_or(slave.area);
            slave.touch = match met {
                Some((Meeting { gap, .. }, _)) if bears => gap + give,
                Some((Meeting { gap, .. }, _)) => gap.min(touching - overlap),
                None if bears => return Err(k),
                None => 0.0,
            };
        }
        self.initial = Some(initial);
        Ok(())
    }

    /// Tractions of a stress field σ of the slave's body at every point in the configuration `x`, minus the initial fluid
    /// pressure; `None` for a point without a projection.
    ///
    /// ```text
    /// σ (−n) = p_total n − q s   →   p = −n·σ n − p_w,   q = s·σ n
    /// ```
    pub fn tractions_under(
        &self,
        stress: impl Fn(Vector2<f64>) -> Matrix2<f64>,
        x: &Configuration,
    ) -> Vec<Option<InitialTraction>> {
        let of = |(slave, met): (&SlavePoint, Met)| {
            let kinematics = met?.1;
            let Kinematics { normal, tangent, .. } = kinematics;
            let stress_vector = stress(slave.at(x)) * normal;
            let pressure = -normal.dot(&stress_vector) - self.pressure_at(slave, &kinematics, x, 0.0);
            Some(InitialTraction { pressure, traction: tangent.dot(&stress_vector) })
        };
        self.points.iter().zip(self.meetings(x, false)).map(of).collect()
    }

    /// Lets every point that faces the master in the configuration `x` begin with this gap, whatever its surfaces have there [L].
    pub fn start_at_gap(&mut self, gap: f64, x: &Configuration) {
        let met = self.meetings(x, false);
        for (slave, met) in self.points.iter_mut().zip(met) {
            slave.touch = met.map_or(0.0, |(met, _)| met.gap - gap);
        }
    }

    /// Whether gaps are counted from elsewhere than where the surfaces touch.
    pub fn is_offset(&self) -> bool {
        let offset = |slave: &SlavePoint| slave.touch != 0.0 || slave.overlap != 0.0;
        self.comes_stressed || self.points.iter().any(offset)
    }

    /// Starts a shrink fit: the overlap of the surfaces in the configuration `x` is applied gradually.
    ///
    /// ```text
    /// g(t) = g_surfaces + overlap × (1 − elapsed fraction of the first step)
    /// ```
    pub fn start_fitting(&mut self, x: &Configuration) {
        let met = self.meetings(x, false);
        for (slave, met) in self.points.iter_mut().zip(met) {
            slave.overlap = met.map_or(0.0, |(met, _)| (slave.touch - met.gap).max(0.0));
        }
    }

    /// States at the start of a run: each point projected in the configuration `x`, friction in its stationary state or, in a
    /// contact that starts closed, under its initial tractions.
    pub fn initial_states(&self, x: &Configuration) -> Vec<ContactState> {
        let state = |(k, (slave, met)): (usize, (&SlavePoint, Met))| {
            let given = self.initial.as_ref().map(|initial| initial[k]);
            let InitialTraction { pressure: total, traction } = given.unwrap_or_default();
            let pressure = if self.pores.is_some() { effective(total, self.pore_pressure(k, x))[0] } else { total };
            let law = self.law(slave);
            let of_bond = law.share_of_bond(pressure, traction);
            let friction = match self.tied && met.is_none() {
                true => FrictionState::default(),
                false => law.law.initial_state(pressure, traction - of_bond),
            };
            let length = met.as_ref().map_or_else(|| slave.current_length(x), |(_, kinematics)| kinematics.length);
            let fluid = met.as_ref().map_or(0.0, |(_, kinematics)| self.pressure_at(slave, kinematics, x, 0.0));
            let (gap, master_point) = met.map(|(met, _)| (slave.gap(met.gap, 1.0), met.master_point)).unzip();
            let multiplier = if self.penetration.is_some() { total } else { 0.0 };
            let touches = total > 0.0 || gap.is_some_and(|gap| gap <= self.touch);
            let separated = (!touches).then(|| gap.unwrap_or(f64::INFINITY));
            ContactState {
                bond: self.bond_at_start(slave, separated, of_bond),
                elastic_slip: 0.0,
                friction,
                master_point,
                length,
                gap: gap.unwrap_or(0.0),
                slip: 0.0,
                radiation: 0.0,
                radiated: 0.0,
                multiplier,
                fluid,
                pores: total - pressure,
                water: None,
                came: Came::default(),
                closures: 0,
            }
        };
        let mut states: Vec<ContactState> =
            self.points.iter().zip(self.meetings(x, false)).enumerate().map(state).collect();
        if let Some(conduit) = &self.conduit {
            let water = conduit.points(&conduit.initial, &conduit.walls(&states));
            states.iter_mut().zip(water).for_each(|(state, water)| state.water = Some(water));
        }
        states
    }

    /// States of a contact that comes under stress: each point projected in the configuration `x`, under the tractions of the stress that
    /// the nodes of one side have there, as far as it presses and friction holds it. Gaps count from there, so that the pressure acts at
    /// once; points that bear nothing begin with the gap that they have in the mesh.
    ///
    /// ```text
    /// p = −n·σ n − p_w,   q = s·σ n,   σ = Σ w_a σ_a           w_a: weights of the nodes of that side at the point, or at its projection
    /// ```
    pub fn states_under(
        &self,
        stress: &BTreeMap<usize, Matrix2<f64>>,
        [mesh, x]: [&Configuration; 2],
        time: f64,
    ) -> Vec<ContactState> {
        let given = self.meetings(mesh, false);
        let state = |(((slave, met), given), separated): (((&SlavePoint, Met), Met), ContactState)| {
            let Some((Meeting { gap, master_point }, kinematics)) = met else { return separated };
            let fluid = self.pressure_at(slave, &kinematics, x, time);
            let ends = self.master.segments().get(master_point.segment).map(|segment| segment.ends);
            let [near, far] = ends.unwrap_or_default();
            let on_master = [(near, 1.0 - master_point.xi), (far, master_point.xi)];
            let sum = |weights: &[(usize, f64)]| -> Option<Matrix2<f64>> {
                weights.iter().map(|(node, w)| Some(stress.get(node)? * *w)).sum()
            };
            let own = sum(&slave.position).or_else(|| sum(&on_master)).unwrap_or_default();
            let stress_vector = own * kinematics.normal;
            let pressure = (-kinematics.normal.dot(&stress_vector) - fluid).max(0.0);
            let law = self.law(slave);
            let released = law.description.released_above.map_or(f64::INFINITY, |[c, mu]| c + mu * pressure);
            let limit = law.starting_limit(pressure).min(released);
            let traction =
                if pressure > 0.0 { kinematics.tangent.dot(&stress_vector).clamp(-limit, limit) } else { 0.0 };
            let of_bond = law.share_of_bond(pressure, traction);
            let give = if self.penetration.is_some() { 0.0 } else { pressure / self.alpha_n };
            let of_mesh = given.map_or(0.0, |(met, _)| slave.gap(met.gap, 1.0).max(0.0));
            let own = if pressure > 0.0 { -give } else { of_mesh };
            ContactState {
                bond: self.bond_at_start(slave, (own > self.touch).then_some(own), of_bond),
                friction: law.law.initial_state(pressure, traction - of_bond),
                master_point: Some(master_point),
                length: kinematics.length,
                gap: own,
                multiplier: if self.penetration.is_some() { pressure } else { 0.0 },
                fluid,
                came: Came { gap: slave.gap(gap, 0.0) - own, pressure, traction },
                ..separated
            }
        };
        let points = self.points.iter().zip(self.meetings(x, false)).zip(given).zip(self.separated_states());
        points.map(state).collect()
    }

    /// The states of all points while one of the sides is not there.
    pub fn separated_states(&self) -> Vec<ContactState> {
        let state = |slave: &SlavePoint| ContactState {
            bond: self.bond_at_start(slave, Some(f64::INFINITY), 0.0),
            elastic_slip: 0.0,
            friction: self.law(slave).law.initial_state(0.0, 0.0),
            master_point: None,
            length: 0.0,
            gap: 0.0,
            slip: 0.0,
            radiation: 0.0,
            radiated: 0.0,
            multiplier: 0.0,
            fluid: 0.0,
            pores: 0.0,
            water: None,
            came: Came::default(),
            closures: 0,
        };
        self.points.iter().map(state).collect()
    }

    /// Nodal forces of the initial tractions, and of an initial fluid pressure, in the configuration `x` [F].
    pub fn initial_forces(&self, x: &Configuration) -> Vec<(usize, Vector2<f64>)> {
        let points = self.points.iter().zip(self.initial.iter().flatten());
        let met = self.meetings(x, false).into_iter().zip(points);
        let forces = |(met, (slave, initial)): (Met, (&SlavePoint, &InitialTraction))| {
            met.map_or_else(Vec::new, |(_, kinematics)| {
                let pressure = initial.pressure + self.pressure_at(slave, &kinematics, x, 0.0);
                nodal_forces(&kinematics, pressure, initial.traction)
            })
        };
        met.flat_map(forces).collect()
    }

    /// Switches to small sliding: every point keeps its projection in the configuration `x`.
    pub fn slide_little(&mut self, x: &Configuration) {
        self.keep_master_points(false, x);
    }

    /// Tie the surfaces as they lie in the configuration `x`: every point keeps its place on the master and its gap, in axes that
    /// turn with the slave unless rotations are small.
    pub fn tie(&mut self, small: bool, x: &Configuration) {
        self.keep_master_points(!small, x);
        let met = self.meetings(x, false);
        self.points
            .iter_mut()
            .zip(&met)
            .for_each(|(slave, met)| slave.touch = met.as_ref().map_or(0.0, |met| met.0.gap));
        self.initial = Some(vec![InitialTraction::default(); met.len()]);
    }

    /// Ties surfaces that carry the stress σ of the slave's body from the start, as nodes do that bodies share.
    ///
    /// ```text
    /// σ N = p n − q s   →   p = n·σ N,   q = −s·σ N        N: outward normal of the slave
    /// ```
    pub fn carry(&mut self, stress: impl Fn(&SlavePoint) -> Matrix2<f64>, x: &Configuration) {
        let (met, seam) = (self.meetings(x, false), &self.seam);
        let mut initial = vec![InitialTraction::default(); met.len()];
        for ((slave, met), initial) in self.points.iter_mut().zip(met).zip(&mut initial) {
            let (Some((_, kinematics)), Some(outward)) = (met, slave.outward(x)) else { continue };
            let stress_vector = stress(slave) * outward;
            let pressure = kinematics.normal.dot(&stress_vector)
                - seam.as_ref().map_or(0.0, |seam| seam.pressure(slave, &kinematics, x));
            *initial = InitialTraction { pressure, traction: -kinematics.tangent.dot(&stress_vector) };
            slave.touch += initial.pressure / self.alpha_n;
        }
        self.initial = Some(initial);
    }

    fn keep_master_points(&mut self, turning: bool, x: &Configuration) {
        let met = self.meetings(x, false).into_iter().zip(&self.points);
        let point = |((met, k), slave): ((Meeting, Kinematics), &SlavePoint)| {
            let point = SmallPoint::new(met, &k, slave, &self.master, x);
            if turning { point.turning_with(slave) } else { point }
        };
        let points = met.map(|(met, slave)| Some(point((met?, slave))));
        self.small = Some(SmallSliding { points: points.collect() });
    }

    /// Projection of every point on the master, if there is one, with the gap of the surfaces; kinematics with
    /// variations if `varied`.
    pub(super) fn meetings(&self, x: &Configuration, varied: bool) -> Vec<Met> {
        let index = Index::new(&self.master, x);
        let cut = match (&self.mortar, &self.master) {
            (Some(mortar), Master::Mesh(surface)) if self.small.is_none() => {
                let mut overlaps = Overlaps::default();
                mortar.cut(surface, &index, [x, x], &mut overlaps);
                let ridges = mortar.ridges(surface, &overlaps, x);
                Some((overlaps, ridges))
            }
            _ => None,
        };
        let (mut room, mut weights) = (Room::default(), Weights::new());
        let meet = |(point, slave): (usize, &SlavePoint)| {
            let mut found = Kinematics::new(varied);
            let k = &mut found;
            let met = match (&self.small, &self.mortar, &self.master) {
                (Some(small), ..) => Some(small.points[point].as_ref()?.meet(x, x, k)),
                (_, Some(mortar), Master::Rigid(body)) => mortar.meet_rigid(point, body, [x, x], k, &mut room),
                (_, Some(mortar), Master::Mesh(surface)) => {
                    let (overlaps, ridges) = cut.as_ref()?;
                    let facing = mortar.facing(surface, overlaps, ridges);
                    facing.weigh(point, x, &mut room, &mut weights);
                    let weights = Some(&weights).filter(|weights| varied && !weights.is_empty());
                    facing.meet(point, weights, x, k, &mut room)
                }
                _ => {
                    let projection = index.project(slave, None, x)?;
                    kinematics(slave, &self.master, &projection, None, x, k);
                    Some(Meeting { gap: projection.gap, master_point: projection.master_point })
                }
            };
            Some((met?, found))
        };
        self.points.iter().enumerate().map(meet).collect()
    }

    /// Master node with the deepest penetration of slave edges with closed points: position, depth [L], and depth divided by
    /// the length of that edge [-].
    pub fn deepest_master_node(&self, states: &[ContactState], x: &Configuration) -> Option<(Vector2<f64>, f64, f64)> {
        let Some(BothSurfaces { nodes, slave: Master::Mesh(slave), .. }) = &self.both else { return None };
        let closed = self.points.iter().zip(states).filter(|(_, state)| state.is_closed());
        let closed =
            closed.flat_map(|(point, _)| &point.length).flat_map(|share| share.tangent.iter().map(|(node, _)| *node));
        let closed: BTreeSet<usize> = closed.collect();
        if closed.is_empty() || nodes.is_empty() {
            return None;
        }
        let index = Index::new(&self.both.as_ref()?.slave, x);
        let depth = |point: &SlavePoint| {
            let met = index.project(point, None, x).filter(|met| met.gap < 0.0)?;
            let [a, b] = slave.segments[met.master_point.segment].ends;
            let share = -met.gap / x.between(a, b).norm();
            // A node deeper than the length of the edge belongs to another part of the body.
            (share < 1.0 && closed.contains(&a) && closed.contains(&b)).then(|| (point.at(x), -met.gap, share))
        };
        nodes.iter().filter_map(depth).max_by(|a, b| a.2.total_cmp(&b.2))
    }

    /// Slave node that lies deepest in a mesh master while all averages around it are open, as an edge of the slave that enters first:
    /// position, depth [L], and depth over the length of its longest edge [-].
    pub fn deepest_slave_node(&self, states: &[ContactState], x: &Configuration) -> Option<(Vector2<f64>, f64, f64)> {
        let (Some(mortar), Master::Mesh(_), None) = (&self.mortar, &self.master, &self.small) else { return None };
        let pressed = self.points.iter().zip(states).filter(|(_, state)| state.is_closed());
        let shares = pressed.flat_map(|(point, _)| &point.length).flat_map(|share| &share.tangent);
        let pressed: BTreeSet<usize> = shares.map(|&(node, _)| node).collect();
        let index = Index::new(&self.master, x);
        let depth = |point: SlavePoint| {
            let free = point.position.iter().all(|(node, _)| !pressed.contains(node));
            let met = free.then(|| index.project(&point, None, x)).flatten().filter(|met| met.gap < 0.0)?;
            let share = -met.gap / point.edge_length(x)?;
            (share < 1.0).then(|| (point.at(x), -met.gap, share))
        };
        nodal_points(&mortar.edges).into_iter().filter_map(depth).max_by(|a, b| a.2.total_cmp(&b.2))
    }

    /// Slip rate of each point along +s under nodal velocities, by the variation of Δu_t; 0 without a projection [L/T].
    pub fn slip_rates(&self, states: &[ContactState], x: &Configuration, velocity: &[f64]) -> Vec<f64> {
        let rate = |k: &Kinematics| {
            let dofs = k.nodes.iter().flat_map(|&node| [2 * node, 2 * node + 1]);
            dofs.zip(&k.dslip).map(|(dof, dslip)| velocity[dof] * dslip).sum()
        };
        if self.small.is_some() || self.mortar.is_some() {
            return self.meetings(x, true).iter().map(|met| met.as_ref().map_or(0.0, |(_, k)| rate(k))).collect();
        }
        let index = Index::new(&self.master, x);
        let mut k = Kinematics::new(true);
        let mut slips = |(slave, state): (&SlavePoint, &ContactState)| {
            let Some(projection) = index.project(slave, state.master_point, x) else { return 0.0 };
            kinematics(slave, &self.master, &projection, state.master_point, x, &mut k);
            rate(&k)
        };
        self.points.iter().zip(states).map(&mut slips).collect()
    }
}
