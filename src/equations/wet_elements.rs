//! Elements that water flows through: what each adds to the balances of its corners, and the forces of the water on elastic bodies.
//!
//! The equations are those of `pore_flow.rs`.

use nalgebra::{DMatrix, Matrix2, Vector2};
use rayon::prelude::*;

use super::sums::{PressureColumns, Sums, TrialFailure};
use super::trial::Trial;
use super::water_balances::{Balances, Times};
use crate::laws::bulk::{MaterialFailure, cofactor};
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
#[derive(Clone, Copy, Default)]
struct Answer {
    change: [f64; MOST_CORNERS],
    flow: [f64; MOST_CORNERS],
    size: [f64; MOST_CORNERS],
    /// ∫ b N ∂J/∂u dV of all nodes [L²]
    opens: [[Vector2<f64>; MOST_NODES]; MOST_CORNERS],
    /// ∂Δm/∂p + Δt/β ∫ ∇N·∂v/∂∇p ∇N dV [L⁵/F]
    takes: [[f64; MOST_CORNERS]; MOST_CORNERS],
    /// (5) [F]
    force: [[f64; 2]; MOST_NODES],
    /// p and b (J − 1) at every point [F/L²], [-]
    pores: [[f64; 2]; MOST_POINTS],
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

/// What an element adds to the tangent.
struct Tangent {
    pressures: PressureColumns,
    /// ∂f/∂u of (5), column by column, if it is not zero
    displacements: Option<Vec<f64>>,
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
        let evaluate = |(_, given): &(usize, &WetElement)| {
            let wet = activated.wet(given);
            let answer = self.evaluate(wet).map_err(|cause| TrialFailure::material(model, wet.element, cause))?;
            Ok((answer, wanted.then(|| self.tangent(wet, &answer))))
        };
        let there = |(_, wet): &(usize, &WetElement)| trial.step.has(model.body_of_element[wet.element]);
        let elements: Vec<(usize, &WetElement)> = flow.elements.iter().enumerate().filter(there).collect();
        let mut pressed = Pressed::default();
        for batch in elements.chunks(BATCH) {
            let answers: Vec<Result<_, TrialFailure>> = batch.par_iter().with_min_len(MANY).map(evaluate).collect();
            for (answer, &(number, wet)) in answers.into_iter().zip(batch) {
                let (answer, tangent) = answer?;
                for (a, &k) in wet.pressures.iter().enumerate() {
                    balances.take(k, answer.change[a], answer.size[a]);
                    balances.let_out(k, times.span * answer.flow[a], 0.0);
                }
                if let Some(tangent) = &tangent {
                    sums.couple_pressures(number, wet, &tangent.pressures);
                }
                if wet.presses {
                    self.press(wet, &answer, memory, &mut pressed);
                    sums.push(&wet.nodes[..wet.in_mesh], answer.force.as_flattened());
                    if let Some(stiffness) = tangent.and_then(|tangent| tangent.displacements) {
                        sums.couple_element(wet.element, wet.in_mesh, &stiffness);
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
        pressed.work += model.filling(solid, e, [old, new]);
    }

    fn evaluate(&self, wet: &WetElement) -> Result<Answer, MaterialFailure> {
        let Self { flow, trial, u, times, .. } = self;
        let (old, corners) = (&trial.old.displacement, wet.pressures.len());
        let mut at = Corners::default();
        for (a, &k) in wet.pressures.iter().enumerate() {
            (at.now[a], at.before[a]) = (flow.pressure(k, Some(u)), flow.pressure(k, Some(old)));
        }
        let (mut answer, mut flows) = (Answer::default(), Flows::default());
        let moved = [wet.moved(u), wet.moved(old)];
        match &wet.constant {
            Some(constant) => {
                flows.add_constant(constant, &mut answer);
                for (k, point) in wet.points.iter().enumerate() {
                    let opened = jacobian(wet, &wet.deformed(point, &moved[0]))? - 1.0;
                    answer.pores[k] = [point.pressure(&at.now), wet.biot * opened];
                }
            }
            None => {
                (0..wet.points.len()).try_for_each(|k| self.add_point(wet, k, &moved, &at, &mut answer, &mut flows))?;
            }
        }
        let [now, before] = moved;
        for a in 0..corners {
            for (force, opens) in answer.force.iter_mut().zip(&answer.opens[a]) {
                force[0] -= at.now[a] * opens.x;
                force[1] -= at.now[a] * opens.y;
            }
            for ((now, before), opens) in now.iter().zip(&before).zip(&answer.opens[a]).take(wet.in_mesh) {
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
                answer.takes[a][b] = stores + times.span * flows.conducts[a][b];
            }
        }
        Ok(answer)
    }

    /// Adds what opens and flows at a point.
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
            answer.opens[a].iter_mut().zip(&by).for_each(|(opens, by)| *opens += share * by);
            flows.falls[a] += point.slopes[a].dot(&falls);
            let along = conducts.tr_mul(&point.slopes[a]);
            flows.conducts[a].iter_mut().zip(&point.slopes).for_each(|(flows, slope)| *flows += along.dot(slope));
        }
        Ok(())
    }

    fn tangent(&self, wet: &WetElement, answer: &Answer) -> Tangent {
        Tangent { pressures: self.columns(wet, answer), displacements: self.stiffness(wet, answer) }
    }

    /// ∂f/∂u of (5), column by column; `None` where it is zero or not added here.
    fn stiffness(&self, wet: &WetElement, answer: &Answer) -> Option<Vec<f64>> {
        if !wet.presses || wet.is_linear {
            return None;
        }
        let (dofs, moved) = (2 * wet.in_mesh, wet.moved(self.u));
        let mut stiffness = vec![0.0; dofs * dofs];
        for (point, [pressure, _]) in wet.points.iter().zip(&answer.pores) {
            let (f, hoop) = wet.deformed(point, &moved);
            let (share, area) = (wet.biot * pressure * point.volume, cofactor(&f));
            // J = det F h: ∂²J = h ∂² det F + ∂ det F ∂h + ∂h ∂ det F, and h changes by u_x alone
            for (b, of_b) in point.gradients[..wet.in_mesh].iter().enumerate() {
                let plane_b = area * of_b;
                for (a, of_a) in point.gradients[..wet.in_mesh].iter().enumerate() {
                    let (plane_a, turns) = (area * of_a, share * hoop * of_a.perp(of_b));
                    stiffness[(2 * b + 1) * dofs + 2 * a] -= turns;
                    stiffness[2 * b * dofs + 2 * a + 1] += turns;
                    stiffness[2 * b * dofs + 2 * a] -= share * (plane_a.x * point.hoop[b] + point.hoop[a] * plane_b.x);
                    stiffness[(2 * b + 1) * dofs + 2 * a] -= share * point.hoop[a] * plane_b.y;
                    stiffness[2 * b * dofs + 2 * a + 1] -= share * plane_a.y * point.hoop[b];
                }
            }
        }
        Some(stiffness)
    }

    /// Columns of the tangent of the pressures' dofs: the rows are dofs of all its nodes, two for each.
    fn columns(&self, wet: &WetElement, answer: &Answer) -> PressureColumns {
        let (mut columns, first) = ([[0.0; 2 * (MOST_NODES + MOST_CORNERS)]; 2 * MOST_CORNERS], 2 * wet.in_mesh);
        let scales = |a: usize| self.flow.scales[wet.pressures[a]];
        for (b, &place) in wet.places.iter().enumerate() {
            let column = &mut columns[place - first];
            for (rows, opens) in column.chunks_exact_mut(2).zip(&answer.opens[b][..wet.in_mesh]) {
                rows[0] -= scales(b) * opens.x;
                rows[1] -= scales(b) * opens.y;
            }
            for (a, &place) in wet.places.iter().enumerate() {
                column[place] -= scales(a) * scales(b) * answer.takes[a][b];
            }
        }
        columns
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
            let nodes = answer.opens[a].iter_mut().enumerate().take(opens.ncols() / 2);
            nodes.for_each(|(node, own)| *own = Vector2::new(opens[(a, 2 * node)], opens[(a, 2 * node + 1)]));
        }
    }
}
