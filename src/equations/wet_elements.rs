//! Elements that water flows through: what each adds to the balances of its corners, and the forces of the water on elastic bodies.
//!
//! The equations are those of `pore_flow.rs`.

use nalgebra::{DMatrix, Matrix2, Vector2};
use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;

use super::sums::{PressureTangent, Sums, TrialFailure};
use super::trial::Trial;
use super::water_balances::{Balances, Times};
use crate::laws::bulk::{MaterialFailure, cofactor};
use crate::model::imposed::filling;
use crate::model::pore_flow::{ConstantFlow, MOST_CORNERS, MOST_NODES, MOST_POINTS, PoreFlow, WetElement, WetPoint};
use crate::model::{Activated, Model};

/// Number of elements whose contributions are stored at once before they are added.
const BATCH: usize = 256;

/// Number of elements that one thread evaluates at a time.
const MANY: usize = 64;

/// Water in an increment.
pub(super) struct Increment<'a> {
    pub model: &'a Model,
    /// elements that came into a deformed model
    pub activated: &'a Activated,
    pub flow: &'a PoreFlow,
    pub trial: Trial<'a>,
    pub times: Times,
    /// displacement at its end
    pub u: &'a [f64],
}

/// Energies of bodies on which the pressure acts here, in an increment [F·L].
#[derive(Default)]
pub(super) struct Pressed {
    /// −∫ b p (J − 1) dV at its end
    pub stored: f64,
    /// Work of the change of the pressure
    pub work: f64,
}

/// What an element adds, by corner: Δm, ∫ v·∇N dV, the magnitudes of their parts, and what they change by with the displacements and pressures.
#[derive(Clone)]
struct Answer {
    change: [f64; MOST_CORNERS],
    flow: [f64; MOST_CORNERS],
    size: [f64; MOST_CORNERS],
    by: PressureTangent,
    /// (5) [F]
    force: [[f64; 2]; MOST_NODES],
    /// ∂f/∂u of (5) where it is wanted, column by column [F/L]
    stiffness: [f64; 4 * MOST_NODES * MOST_NODES],
    /// p and b (J − 1) at every point [F/L²], [-]
    pores: [[f64; 2]; MOST_POINTS],
}

impl Default for Answer {
    fn default() -> Self {
        Self {
            change: [0.0; MOST_CORNERS],
            flow: [0.0; MOST_CORNERS],
            size: [0.0; MOST_CORNERS],
            by: PressureTangent::default(),
            force: Default::default(),
            stiffness: [0.0; 4 * MOST_NODES * MOST_NODES],
            pores: Default::default(),
        }
    }
}

impl Answer {
    /// Clears everything but the stiffness, which is written whole.
    fn clear(&mut self) {
        [&mut self.change, &mut self.flow, &mut self.size].into_iter().for_each(|values| values.fill(0.0));
        (self.by, self.force) = Default::default();
    }
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
fn opens_by(wet: &WetElement, point: &WetPoint, (f, hoop): &(Matrix2<f64>, f64)) -> [Vector2<f64>; MOST_NODES] {
    let mut by = [Vector2::zeros(); MOST_NODES];
    let (area, plane) = if wet.is_linear { (Matrix2::identity(), 1.0) } else { (cofactor(f) * *hoop, f.determinant()) };
    by.iter_mut().zip(&point.gradients).for_each(|(by, gradient)| *by = area * gradient);
    by.iter_mut().zip(&point.hoop).for_each(|(by, around)| by.x += plane * around);
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
    for point in &wet.points {
        let deformed = wet.deformed(point, &wet.moved(u));
        jacobian(wet, &deformed)?;
        let by = opens_by(wet, point, &deformed);
        for (a, value) in point.values[..corners].iter().enumerate() {
            for (node, by) in by[..nodes].iter().enumerate() {
                (0..2).for_each(|i| opens[(a, 2 * node + i)] += wet.biot * point.volume * value * by[i]);
            }
        }
    }
    let takes = (&wet.storage + &wet.projection).cholesky();
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

/// Pressures of the corners of an element.
#[derive(Default)]
struct Corners {
    now: [f64; MOST_CORNERS],
    before: [f64; MOST_CORNERS],
}

impl Increment<'_> {
    /// Adds what the elements that are there take up and let flow, and the forces (5); stores what elastic bodies remember of their water in `memory`.
    pub fn add_elements(
        &self,
        memory: &mut [f64],
        balances: &mut Balances,
        sums: &mut Sums,
    ) -> Result<Pressed, TrialFailure> {
        let Self { model, activated, flow, trial, times, .. } = self;
        let wanted = sums.tangent.is_some();
        let there = |(_, wet): &(usize, &WetElement)| trial.step.has(model.body_of_element[wet.element]);
        let elements: Vec<(usize, &WetElement)> = flow.elements.iter().enumerate().filter(there).collect();
        let mut pressed = Pressed::default();
        let mut answers = vec![Answer::default(); BATCH.min(elements.len())];
        for batch in elements.chunks(BATCH) {
            let evaluate = |(answer, (_, given)): (&mut Answer, &(usize, &WetElement))| {
                let wet = activated.wet(given);
                let found = Arch::new().dispatch(Evaluation { increment: self, wet, wanted, answer });
                found.map_err(|cause| TrialFailure::material(model, wet.element, cause))
            };
            let found = answers.par_iter_mut().zip(batch).with_min_len(MANY).map(evaluate);
            // The first failure by number, whatever the threads do
            found.collect::<Vec<_>>().into_iter().collect::<Result<(), _>>()?;
            for (answer, &(number, wet)) in answers.iter().zip(batch) {
                for (a, &k) in wet.pressures.iter().enumerate() {
                    balances.take(k, answer.change[a], answer.size[a]);
                    balances.let_out(k, times.span * answer.flow[a], 0.0);
                }
                let scales = std::array::from_fn(|a| wet.pressures.get(a).map_or(0.0, |&k| flow.scales[k]));
                sums.couple_pressures(number, wet, &scales, &answer.by);
                if wet.presses {
                    self.press(wet, answer, memory, &mut pressed);
                    sums.push(&wet.nodes[..wet.in_mesh], answer.force.as_flattened());
                    if wanted && !wet.is_linear {
                        let dofs = 2 * wet.in_mesh;
                        sums.couple_element(wet.element, wet.in_mesh, &answer.stiffness[..dofs * dofs]);
                    }
                }
            }
        }
        Ok(pressed)
    }

    /// Writes the pressure and what the pores have opened by to the variables of an element's material, and counts their energies.
    fn press(&self, wet: &WetElement, answer: &Answer, memory: &mut [f64], pressed: &mut Pressed) {
        let Self { model, activated, trial, .. } = self;
        let (e, Some((slot, count))) = (wet.element, wet.variables) else { return };
        let (old, new) = (model.memories.of(e, &trial.old.memory), model.memories.of_mut(e, memory));
        let solid = model.as_activated(activated, e);
        let points = new.chunks_exact_mut(count).zip(&answer.pores).zip(solid.point_volumes());
        for ((own, pores), volume) in points {
            *slot.of_mut(own) = *pores;
            pressed.stored -= volume * pores[0] * pores[1];
        }
        pressed.work += filling(slot, count, solid.point_volumes(), [old, new]);
    }

    /// Computes what an element adds, and the stiffness by (5) if it is wanted.
    #[inline(always)]
    fn evaluate(&self, wet: &WetElement, wanted: bool, answer: &mut Answer) -> Result<(), MaterialFailure> {
        let Self { flow, trial, u, times, .. } = self;
        let (old, corners) = (&trial.old.displacement, wet.pressures.len());
        let mut at = Corners::default();
        for (a, &k) in wet.pressures.iter().enumerate() {
            (at.now[a], at.before[a]) = (flow.pressure(k, Some(u)), flow.pressure(k, Some(old)));
        }
        answer.clear();
        let mut flows = Flows::default();
        let moved = [wet.moved(u), wet.moved(old)];
        match &wet.constant {
            Some(constant) => {
                flows.add_constant(constant, answer);
                for (k, point) in wet.points.iter().enumerate() {
                    let opened = jacobian(wet, &wet.deformed(point, &moved[0]))? - 1.0;
                    answer.pores[k] = [point.pressure(&at.now), wet.biot * opened];
                }
            }
            None => {
                (0..wet.points.len()).try_for_each(|k| self.add_point(wet, k, &moved, &at, answer, &mut flows))?;
            }
        }
        let [now, before] = moved;
        for a in 0..corners {
            for (force, opens) in answer.force.iter_mut().zip(&answer.by.opens[a]) {
                force[0] -= at.now[a] * opens.x;
                force[1] -= at.now[a] * opens.y;
            }
            for ((now, before), opens) in now.iter().zip(&before).zip(&answer.by.opens[a]).take(wet.in_mesh) {
                let part = opens.component_mul(&(now - before));
                answer.size[a] += part.x.abs() + part.y.abs();
                if wet.constant.is_some() {
                    answer.change[a] += part.x + part.y;
                }
            }
            answer.flow[a] += flows.falls[a];
            answer.size[a] += times.span * flows.falls[a].abs();
            for b in 0..corners {
                let stores = wet.storage[(a, b)] + wet.projection[(a, b)];
                let (taken, out) = (stores * (at.now[b] - at.before[b]), flows.conducts[a][b] * at.now[b]);
                answer.change[a] += taken;
                answer.flow[a] += out;
                answer.size[a] += taken.abs() + times.span * out.abs();
                answer.by.takes[a][b] = stores + times.span * flows.conducts[a][b];
            }
        }
        if wanted && wet.presses && !wet.is_linear {
            stiffen(wet, &now, &answer.pores, &mut answer.stiffness);
        }
        Ok(())
    }

    /// Adds what opens and flows at a point.
    #[inline(always)]
    fn add_point(
        &self,
        wet: &WetElement,
        k: usize,
        moved: &[[Vector2<f64>; MOST_NODES]; 2],
        at: &Corners,
        answer: &mut Answer,
        flows: &mut Flows,
    ) -> Result<(), MaterialFailure> {
        let point = &wet.points[k];
        let [is, was] = moved.each_ref().map(|moved| wet.deformed(point, moved));
        let [jacobian_is, jacobian_was] = [jacobian(wet, &is)?, jacobian(wet, &was)?];
        let by = opens_by(wet, point, &is);
        answer.pores[k] = [point.pressure(&at.now), wet.biot * (jacobian_is - 1.0)];
        let share_of_k = point.volume * wet.permeability(jacobian_was, point.pressure(&at.before));
        let [conducts, falls] = conducts(wet, &was).map(|part| part * share_of_k);
        let falls = falls * Vector2::new(0.0, wet.weight);
        for a in 0..wet.pressures.len() {
            let share = wet.biot * point.volume * point.values[a];
            answer.change[a] += share * (jacobian_is - jacobian_was);
            answer.by.opens[a].iter_mut().zip(&by).for_each(|(opens, by)| *opens += share * by);
            flows.falls[a] += point.slopes[a].dot(&falls);
            let along = conducts.tr_mul(&point.slopes[a]);
            flows.conducts[a].iter_mut().zip(&point.slopes).for_each(|(flows, slope)| *flows += along.dot(slope));
        }
        Ok(())
    }
}

/// Writes ∂f/∂u of (5), column by column.
///
/// ```text
/// J = h det F:  ∂²J = h ∂² det F + ∂ det F ∂h + ∂h ∂ det F,   ∂² det F/∂u_ax ∂u_by = N_a,x N_b,y − N_a,y N_b,x,   h by u_x alone
/// ```
#[inline(always)]
fn stiffen(
    wet: &WetElement,
    moved: &[Vector2<f64>; MOST_NODES],
    pores: &[[f64; 2]; MOST_POINTS],
    stiffness: &mut [f64],
) {
    let (nodes, dofs) = (wet.in_mesh, 2 * wet.in_mesh);
    stiffness[..dofs * dofs].fill(0.0);
    let mut turns = [[0.0; MOST_NODES]; MOST_NODES];
    for (point, [pressure, _]) in wet.points.iter().zip(pores) {
        let (f, hoop) = wet.deformed(point, moved);
        let share = wet.biot * pressure * point.volume;
        for (b, of_b) in point.gradients[..nodes].iter().enumerate() {
            turns[b]
                .iter_mut()
                .zip(&point.gradients)
                .for_each(|(turns, of_a)| *turns += share * hoop * of_a.perp(of_b));
        }
        if wet.is_ring {
            let area = cofactor(&f);
            let plane = point.gradients.map(|gradient| area * gradient);
            for (b, a) in (0..nodes).flat_map(|b| (0..nodes).map(move |a| (b, a))) {
                let (around_a, around_b) = (point.hoop[a], point.hoop[b]);
                stiffness[2 * b * dofs + 2 * a] -= share * (plane[a].x * around_b + around_a * plane[b].x);
                stiffness[(2 * b + 1) * dofs + 2 * a] -= share * around_a * plane[b].y;
                stiffness[2 * b * dofs + 2 * a + 1] -= share * plane[a].y * around_b;
            }
        }
    }
    for (b, turns) in turns[..nodes].iter().enumerate() {
        for (a, turns) in turns[..nodes].iter().enumerate() {
            stiffness[(2 * b + 1) * dofs + 2 * a] -= turns;
            stiffness[2 * b * dofs + 2 * a + 1] += turns;
        }
    }
}

/// An element in an increment, compiled for vectors as long as the processor has them.
struct Evaluation<'a> {
    increment: &'a Increment<'a>,
    wet: &'a WetElement,
    wanted: bool,
    answer: &'a mut Answer,
}

impl NullaryFnOnce for Evaluation<'_> {
    type Output = Result<(), MaterialFailure>;

    #[inline(always)]
    fn call(self) -> Self::Output {
        self.increment.evaluate(self.wet, self.wanted, self.answer)
    }
}

/// Flow through an element: ∫ ∇N·∂v/∂∇p ∇N dV and ∫ ∇N·v dV of water at rest that weighs [L⁵/(F T)], [L³/T].
#[derive(Default)]
struct Flows {
    conducts: [[f64; MOST_CORNERS]; MOST_CORNERS],
    falls: [f64; MOST_CORNERS],
}

impl Flows {
    /// Adds what flows in an element in which nothing changes; what opens there goes to the answer.
    fn add_constant(&mut self, ConstantFlow { opens, conducts, falls }: &ConstantFlow, answer: &mut Answer) {
        for (a, falls) in falls.iter().enumerate() {
            self.falls[a] = *falls;
            self.conducts[a].iter_mut().zip(conducts.row(a).iter()).for_each(|(own, conducts)| *own = *conducts);
            let nodes = answer.by.opens[a].iter_mut().enumerate().take(opens.ncols() / 2);
            nodes.for_each(|(node, own)| *own = Vector2::new(opens[(a, 2 * node)], opens[(a, 2 * node + 1)]));
        }
    }
}
