//! Elements that water flows through: what each adds to the balances of its corners, and the forces of the water on elastic bodies.
//!
//! The equations are those of `pore_flow.rs`.

use std::sync::Arc;

use nalgebra::{DMatrix, Matrix2, Vector2};
use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;

use super::sums::{PressureTangent, Sums, TrialFailure};
use super::trial::Trial;
use super::water_balances::{Balances, Times};
use crate::laws::bulk::{MaterialFailure, cofactor};
use crate::model::imposed::filling;
use crate::model::pore_flow::{Flows, MOST_CORNERS, MOST_NODES, MOST_POINTS, OfCorners, OfNodes, PoreFlow, WetElement};
use crate::model::{Activated, Model};

/// Number of elements that one thread evaluates at a time: what they answer is to stay at hand until it is added.
const MANY: usize = 32;

/// Water in an increment.
pub(super) struct Increment<'a> {
    pub model: &'a Model,
    pub flow: &'a PoreFlow,
    pub trial: Trial<'a>,
    pub times: Times,
    /// displacement at its end
    pub u: &'a [f64],
}

/// What the elements begin an increment with, which every evaluation in it needs.
pub(super) struct Beginning {
    /// elements that came into a deformed model
    activated: Arc<Activated>,
    /// displacement then; nothing is known without it [L]
    displacement: Vec<f64>,
    elements: Vec<Begun>,
}

impl Beginning {
    /// Before anything is known.
    pub fn new(activated: &Arc<Activated>) -> Self {
        Self { activated: activated.clone(), displacement: Vec::new(), elements: Vec::new() }
    }
}

/// What an element that is there begins an increment with.
#[derive(Clone, Copy, Default)]
struct Begun {
    /// by (3) [L⁵/(F T)], [L³/T]
    flows: Flows,
    /// ∫ b (J_n − 1) N dV where that is not linear [L³]
    opened: [f64; MOST_CORNERS],
    /// displacements of its nodes since it came [L]
    moved: OfNodes,
    /// pressures of its corners [F/L²]
    pressures: [f64; MOST_CORNERS],
}

/// Energies of bodies on which the pressure acts here, in an increment [F·L].
#[derive(Clone, Copy, Default)]
pub(super) struct Pressed {
    /// −∫ b p (J − 1) dV at its end
    pub stored: f64,
    /// Work of the change of the pressure
    pub work: f64,
}

/// What an element adds, by corner: Δm, ∫ v·∇N dV, the magnitudes of their parts, and what they change by with the displacements and pressures.
#[derive(Clone, Default)]
struct Answer {
    change: [f64; MOST_CORNERS],
    flow: [f64; MOST_CORNERS],
    size: [f64; MOST_CORNERS],
    by: PressureTangent,
    /// (5) [F]
    force: OfNodes,
    /// −∫ b p (J − 1) dV, and work of the change of the pressure [F·L]
    energies: Pressed,
    /// ∂f/∂u_x of (5) where it is wanted, by column: that by u_y is the transposed of another, or none [F/L]
    stiffness: [OfNodes; MOST_NODES],
    /// Half of that of f_y, to which the other is antisymmetric
    across: [[f64; MOST_NODES]; MOST_NODES],
    /// p and b (J − 1) at every point [F/L²], [-]
    pores: [[f64; 2]; MOST_POINTS],
}

impl Answer {
    /// Zeros, but for what points have, which is written, and the stiffness where it is not wanted.
    #[inline(always)]
    fn clear(&mut self, stiffens: bool) {
        let Self { change, flow, size, by, force, energies, stiffness, across, .. } = self;
        [change, flow, size].into_iter().for_each(|sums| *sums = [0.0; MOST_CORNERS]);
        (*by, *force, *energies) = (PressureTangent::default(), OfNodes::default(), Pressed::default());
        if stiffens {
            *stiffness = [OfNodes::default(); MOST_NODES];
            *across = [[0.0; MOST_NODES]; MOST_NODES];
        }
    }

    /// Adds what the pores have opened by at a point, b (J − 1), and what that changes by.
    #[inline(always)]
    fn open(&mut self, wet: &WetElement, k: usize, opened: f64, by: &OfNodes) {
        for (a, value) in wet.shape[k].values[..wet.pressures.len()].iter().enumerate() {
            let share = wet.points[k].volume * value;
            self.change[a] += share * opened;
            let opens = self.by.opens[a].as_flattened_mut().iter_mut();
            opens.zip(by.as_flattened()).for_each(|(opens, by)| *opens += share * wet.biot * by);
        }
    }

    /// Adds the forces, and what the element takes up and lets flow, by the pressures of its corners and the displacements of its nodes.
    #[inline(always)]
    fn balance(&mut self, wet: &WetElement, begun: &Begun, span: f64, now: &[f64; MOST_CORNERS], moved: &OfNodes) {
        let Flows { conducts, falls } = &begun.flows;
        let mut way = *moved;
        let before = begun.moved.as_flattened();
        way.as_flattened_mut().iter_mut().zip(before).for_each(|(way, before)| *way -= before);
        for (a, opens) in self.by.opens.iter().enumerate() {
            let [opened, size] = sum_of_products(opens, &way);
            self.size[a] += size;
            self.change[a] += if wet.constant.is_some() { opened } else { 0.0 };
            let forces = self.force.as_flattened_mut().iter_mut().zip(opens.as_flattened());
            forces.for_each(|(force, opens)| *force -= now[a] * opens);
        }
        for a in 0..wet.pressures.len() {
            self.change[a] -= begun.opened[a];
            self.flow[a] += falls[a];
            self.size[a] += span * falls[a].abs();
            for (b, (now, before)) in now.iter().zip(&begun.pressures).enumerate() {
                let stores = wet.takes[a][b];
                let (taken, out) = (stores * (now - before), conducts[a][b] * now);
                self.change[a] += taken;
                self.flow[a] += out;
                self.size[a] += taken.abs() + span * out.abs();
                self.by.takes[a][b] = stores + span * conducts[a][b];
            }
        }
    }
}

/// Σ a b over all nodes, and Σ |a b|, in sums that do not wait for each other.
#[inline(always)]
fn sum_of_products(a: &OfNodes, b: &OfNodes) -> [f64; 2] {
    let mut sums = [[0.0; 4]; 2];
    let ((a, a_rest), (b, b_rest)) = (a.as_flattened().as_chunks::<4>(), b.as_flattened().as_chunks::<4>());
    let mut add = |a: &[f64], b: &[f64]| {
        for (i, (a, b)) in a.iter().zip(b).enumerate() {
            let part = a * b;
            (sums[0][i], sums[1][i]) = (sums[0][i] + part, sums[1][i] + part.abs());
        }
    };
    a.iter().zip(b).for_each(|(a, b)| add(a, b));
    add(a_rest, b_rest);
    let [products, sizes] = sums;
    [products[0] + products[1] + products[2] + products[3], sizes[0] + sizes[1] + sizes[2] + sizes[3]]
}

/// J of a deformed element at a point.
fn jacobian(wet: &WetElement, (f, hoop): &(Matrix2<f64>, f64)) -> Result<f64, MaterialFailure> {
    if wet.is_linear {
        return Ok(f.trace() - 1.0 + (hoop - 1.0));
    }
    let plane = f.determinant();
    if !(plane > 0.0 && *hoop > 0.0) {
        return Err(MaterialFailure::Inverted { jacobian: plane * hoop });
    }
    Ok(plane * hoop)
}

/// ∂J/∂u of every node of a deformed element at a point.
#[inline(always)]
fn opens_by(wet: &WetElement, k: usize, (f, stretch): &(Matrix2<f64>, f64)) -> OfNodes {
    let linear = (Matrix2::identity(), 1.0);
    let (area, plane) = if wet.is_linear { linear } else { (cofactor(f) * *stretch, f.determinant()) };
    let mut by = wet.gradients_by(k, &area);
    if let Some(hoop) = wet.hoop.get(k) {
        by[0].iter_mut().zip(hoop).for_each(|(by, around)| *by += plane * around);
    }
    by
}

/// Stiffness that water which is trapped in an element at the displacement `u` adds to it, Bᵀ (S + P)⁻¹ B with B = ∫ b N ∂J/∂u dV: two dofs for every
/// node of the element in the mesh [F/L].
///
/// # Errors
/// Returns [`MaterialFailure`] if the element is inverted.
pub fn trapped(wet: &WetElement, u: &[f64]) -> Result<DMatrix<f64>, MaterialFailure> {
    let (corners, nodes) = (wet.pressures.len(), wet.in_mesh);
    let mut opens = DMatrix::zeros(corners, 2 * nodes);
    for (k, point) in wet.points.iter().enumerate() {
        let deformed = wet.deformed(k, &wet.moved(u));
        jacobian(wet, &deformed)?;
        let by = opens_by(wet, k, &deformed);
        for (a, value) in wet.shape[k].values[..corners].iter().enumerate() {
            for (node, i) in (0..nodes).flat_map(|node| [(node, 0), (node, 1)]) {
                opens[(a, 2 * node + i)] += wet.biot * point.volume * value * by[i][node];
            }
        }
    }
    let takes = DMatrix::from_fn(corners, corners, |a, b| wet.takes[a][b]).cholesky();
    Ok(takes.map_or_else(|| DMatrix::zeros(2 * nodes, 2 * nodes), |takes| opens.transpose() * takes.solve(&opens)))
}

/// J_n F_n⁻¹ k/γ_w F_n⁻ᵀ, and J_n F_n⁻¹ k/γ_w, of an element deformed at the start of the increment.
fn conducts(wet: &WetElement, (f, hoop): &(Matrix2<f64>, f64)) -> [Matrix2<f64>; 2] {
    let mobility = Matrix2::new(wet.mobility[0], 0.0, 0.0, wet.mobility[1]);
    if wet.is_linear {
        return [mobility; 2];
    }
    // J F⁻¹ = cofᵀ
    let area = cofactor(f).transpose() * *hoop;
    let inverse = cofactor(f) / f.determinant();
    [area * mobility * inverse, area * mobility]
}

impl Increment<'_> {
    /// Adds what the elements that are there take up and let flow, and the forces (5); stores what elastic bodies remember of their water in `memory`.
    pub fn add_elements(
        &self,
        beginning: &mut Beginning,
        memory: &mut [f64],
        balances: &mut Balances,
        sums: &mut Sums,
    ) -> Result<Pressed, TrialFailure> {
        self.begin(beginning)?;
        let Self { model, flow, trial, u, .. } = self;
        let there = |(_, wet): &(usize, &WetElement)| trial.step.has(model.body_of_element[wet.element]);
        let elements: Vec<(usize, &WetElement)> = flow.elements.iter().enumerate().filter(there).collect();
        let pressures: Vec<f64> = (0..flow.count()).map(|k| flow.pressure(k, Some(u))).collect();
        // Threads are called once for all batches.
        rayon::scope(|_| self.add_batches(beginning, &elements, &pressures, memory, balances, sums))
    }

    /// The same for some elements, by their numbers, and the pressures at the displacement.
    fn add_batches(
        &self,
        beginning: &Beginning,
        elements: &[(usize, &WetElement)],
        pressures: &[f64],
        memory: &mut [f64],
        balances: &mut Balances,
        sums: &mut Sums,
    ) -> Result<Pressed, TrialFailure> {
        let Self { model, flow, times, .. } = self;
        let (wanted, many) = (sums.tangent.is_some(), MANY * rayon::current_num_threads());
        let mut pressed = Pressed::default();
        let mut answers = vec![Answer::default(); many.min(elements.len())];
        for batch in elements.chunks(many) {
            let evaluate = |(answer, (number, given)): (&mut Answer, &(usize, &WetElement))| {
                let (wet, begun) = (beginning.activated.wet(given), &beginning.elements[*number]);
                let found = Arch::new().dispatch(Evaluation { increment: self, wet, begun, pressures, wanted, answer });
                found.err().map(|cause| TrialFailure::material(model, wet.element, cause))
            };
            let failed = answers.par_iter_mut().zip(batch).with_min_len(MANY).find_map_first(evaluate);
            failed.map_or(Ok(()), Err)?;
            for (answer, &(number, wet)) in answers.iter().zip(batch) {
                for (a, &k) in wet.pressures.iter().enumerate() {
                    balances.take(k, answer.change[a], answer.size[a]);
                    balances.let_out(k, times.span * answer.flow[a], 0.0);
                }
                if wanted {
                    let scales = std::array::from_fn(|a| wet.pressures.get(a).map_or(0.0, |&k| flow.scales[k]));
                    sums.couple_pressures(number, wet, &scales, &answer.by);
                }
                if let Some((slot, count)) = wet.variables.filter(|_| wet.presses) {
                    let points = model.memories.of_mut(wet.element, memory).chunks_exact_mut(count);
                    points.zip(&answer.pores).for_each(|(own, pores)| *slot.of_mut(own) = *pores);
                    pressed.stored += answer.energies.stored;
                    pressed.work += answer.energies.work;
                    for (k, node) in wet.nodes[..wet.in_mesh].iter().enumerate() {
                        (0..2).for_each(|i| sums.add(2 * node + i, answer.force[i][k]));
                    }
                    if !wet.is_linear {
                        sums.stiffen_pressed(wet, &answer.stiffness);
                    }
                }
            }
        }
        Ok(pressed)
    }

    /// Finds what the elements that are there begin with, unless that is known.
    fn begin(&self, beginning: &mut Beginning) -> Result<(), TrialFailure> {
        let Self { model, flow, trial, .. } = self;
        let Beginning { activated, displacement, elements } = beginning;
        let old = &trial.old.displacement;
        if displacement == old {
            return Ok(());
        }
        displacement.clear();
        elements.clear();
        elements.resize(flow.elements.len(), Begun::default());
        let begin = |(begun, given): (&mut Begun, &WetElement)| {
            let there = trial.step.has(model.body_of_element[given.element]);
            let wet = activated.wet(given);
            let found = if there { Arch::new().dispatch(|| self.begun(wet, begun)) } else { Ok(()) };
            found.err().map(|cause| TrialFailure::material(model, given.element, cause))
        };
        let all = elements.par_iter_mut().zip(&flow.elements);
        all.with_min_len(MANY).find_map_first(begin).map_or(Ok(()), Err)?;
        displacement.clone_from(old);
        Ok(())
    }

    /// Finds what an element begins with.
    #[inline(always)]
    fn begun(&self, wet: &WetElement, begun: &mut Begun) -> Result<(), MaterialFailure> {
        let old = &self.trial.old.displacement;
        let corner = |a: usize| wet.pressures.get(a).map_or(0.0, |&k| self.flow.pressure(k, Some(old)));
        let (pressures, moved) = (std::array::from_fn(corner), wet.moved(old));
        (begun.pressures, begun.moved) = (pressures, moved);
        if let Some(constant) = &wet.constant {
            begun.flows = constant.flows;
            return Ok(());
        }
        for (k, point) in wet.points.iter().enumerate() {
            let was = wet.deformed(k, &moved);
            let jacobian = jacobian(wet, &was)?;
            let share_of_k = point.volume * wet.permeability(jacobian, wet.pressure(k, &pressures));
            let [conducts, falls] = conducts(wet, &was).map(|part| part * share_of_k);
            let (falls, [x, y]) = (falls * Vector2::new(0.0, wet.weight), wet.slopes(k));
            let along: OfCorners =
                [0, 1].map(|i| std::array::from_fn(|a| conducts[(0, i)] * x[a] + conducts[(1, i)] * y[a]));
            for a in 0..MOST_CORNERS {
                begun.opened[a] += wet.biot * point.volume * wet.shape[k].values[a] * (jacobian - 1.0);
                begun.flows.falls[a] += x[a] * falls.x + y[a] * falls.y;
                for b in 0..MOST_CORNERS {
                    begun.flows.conducts[a][b] += along[0][a] * x[b] + along[1][a] * y[b];
                }
            }
        }
        Ok(())
    }

    /// Computes what an element adds, and the stiffness by (5) if it is wanted.
    #[inline(always)]
    fn evaluate(
        &self,
        wet: &WetElement,
        begun: &Begun,
        now: &[f64; MOST_CORNERS],
        wanted: bool,
        answer: &mut Answer,
    ) -> Result<(), MaterialFailure> {
        let (moved, stiffens) = (wet.moved(self.u), wanted && wet.presses && !wet.is_linear);
        answer.clear(stiffens);
        for k in 0..wet.points.len() {
            let deformed = wet.deformed(k, &moved);
            let opened = wet.biot * (jacobian(wet, &deformed)? - 1.0);
            answer.pores[k] = [wet.pressure(k, now), opened];
            if wet.constant.is_none() {
                answer.open(wet, k, opened, &opens_by(wet, k, &deformed));
            }
            if stiffens {
                stiffen(wet, k, &deformed, answer.pores[k][0], answer);
            }
        }
        if stiffens {
            let Answer { stiffness, across, .. } = answer;
            for (b, [_, of_y]) in stiffness.iter_mut().enumerate() {
                of_y.iter_mut().enumerate().for_each(|(a, of_y)| *of_y += across[b][a] - across[a][b]);
            }
        }
        answer.energies = self.energies(wet, &answer.pores);
        if let Some(constant) = &wet.constant {
            answer.by.opens = constant.opens;
        }
        answer.balance(wet, begun, self.times.span, now, &moved);
        Ok(())
    }

    /// Energies of the water in an element of which it presses on the body, by p and b (J − 1) at its points.
    #[inline(always)]
    fn energies(&self, wet: &WetElement, pores: &[[f64; 2]; MOST_POINTS]) -> Pressed {
        let mut energies = Pressed::default();
        let Some((slot, count)) = wet.variables.filter(|_| wet.presses) else { return energies };
        let old = self.model.memories.of(wet.element, &self.trial.old.memory).chunks_exact(count);
        for ((point, [pressure, opens]), old) in wet.points.iter().zip(pores).zip(old) {
            let [before, opened] = slot.of(old);
            energies.stored -= point.volume * pressure * opens;
            energies.work += filling(point.volume, [*before, *pressure], [*opened, *opens]);
        }
        energies
    }
}

/// Adds ∂f/∂u_x of (5) at a point of a deformed element: the first term below to `across`, without what is antisymmetric to it.
///
/// ```text
/// J = h det F:  ∂²J = h ∂² det F + ∂ det F ∂h + ∂h ∂ det F,   h by u_x alone
/// ∂² det F/∂u_ax ∂u_by = N_a,x N_b,y − N_a,y N_b,x = det ∂ξ/∂X (N_a,ξ N_b,η − N_a,η N_b,ξ)
/// ```
#[inline(always)]
fn stiffen(
    wet: &WetElement,
    k: usize,
    (f, stretch): &(Matrix2<f64>, f64),
    pressure: f64,
    Answer { stiffness, across, .. }: &mut Answer,
) {
    let (point, [first, second]) = (&wet.points[k], &wet.shape[k].of_nodes);
    let share = wet.biot * pressure * point.volume;
    let of_area = share * stretch * point.map.determinant();
    for (across, second) in across.iter_mut().zip(second) {
        let own = of_area * second;
        across.iter_mut().zip(first).for_each(|(across, first)| *across += own * first);
    }
    if let Some(hoop) = wet.hoop.get(k) {
        let plane = wet.gradients_by(k, &cofactor(f));
        for (b, [of_x, of_y]) in stiffness.iter_mut().enumerate() {
            for a in 0..MOST_NODES {
                let (around_a, around_b) = (hoop[a], hoop[b]);
                of_x[a] -= share * (plane[0][a] * around_b + around_a * plane[0][b]);
                of_y[a] -= share * plane[1][a] * around_b;
            }
        }
    }
}

/// An element in an increment, compiled for vectors as long as the processor has them.
struct Evaluation<'a> {
    increment: &'a Increment<'a>,
    wet: &'a WetElement,
    begun: &'a Begun,
    /// of all corners in the model
    pressures: &'a [f64],
    wanted: bool,
    answer: &'a mut Answer,
}

impl NullaryFnOnce for Evaluation<'_> {
    type Output = Result<(), MaterialFailure>;

    #[inline(always)]
    fn call(self) -> Self::Output {
        let Self { increment, wet, begun, pressures, wanted, answer } = self;
        let now = std::array::from_fn(|a| wet.pressures.get(a).map_or(0.0, |&k| pressures[k]));
        increment.evaluate(wet, begun, &now, wanted, answer)
    }
}
