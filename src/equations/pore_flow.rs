//! Water that flows through the pores of bodies.
//!
//! ```text
//! Δm_a = ∫ (b (J − J_n) + (p − p_n)/Q) N_a dV + Σ_b (projection)_ab (p − p_n)_b          what comes to the pores of a corner           (1)
//! β Δm − Δm_n ω²/(1 + ω) = −Δt (∫ v·∇N dV + ∫ q N ds),   β = (1 + 2ω)/(1 + ω),   ω = Δt/Δt_n                                  BDF2     (2)
//! v = J_n F_n⁻¹ k/γ_w (F_n⁻ᵀ ∇p − γ_w g)                                                  flow in the body as it was                   (3)
//! r_a = −s_a (Δm_a − Δm_n,a ω²/(1 + 2ω) + Δt/β (∫ v·∇N_a dV + ∫ q N_a ds))                                                             (4)
//! ```
//! The geometry and the permeability of (3) are those of the accepted state: with b p J F⁻ᵀ in the stress of the bodies, and (4) divided by β, the tangent is symmetric, and
//! has as many negative eigenvalues as pressures. After a jump, at the start of a step or in an increment that is much shorter than the next, (2) begins with ω = 0: backward Euler. Where
//! only a rate jumps, at a corner of a table, the increment ends, and (2) goes on: its error there is a third of that of backward Euler. The integral of q over an outlet is taken by the same formula, so that what is stored and what has left add up to nothing.
//!
//! Source: M. A. Biot (1941), J. Appl. Phys. 12, 155; the projection: Dohrmann & Bochev (2004), Int. J. Numer. Meth. Fluids 46, 183; White & Borja
//! (2008), Comput. Methods Appl. Mech. Eng. 197, 4353.

use nalgebra::{DMatrix, Matrix2, Vector2};
use rayon::prelude::*;

use super::channels;
use super::sums::{Dependence, PressureColumns, Sums, TrialFailure};
use super::trial::Trial;
use super::water_balances::{Balances, Times};
use crate::laws::bulk::{MaterialFailure, cofactor};
use crate::model::pore_flow::{ConstantFlow, MOST_CORNERS, MOST_NODES, PoreFlow, WetElement, WetPoint};
use crate::model::state::{Outflow, Water};
use crate::model::{Activated, Model};

/// Number of elements whose contributions are stored at once before they are added.
const BATCH: usize = 256;

/// Number of elements that one thread evaluates at a time.
const MANY: usize = 64;

/// The flow goes by the state at the start of the increment, and the volume by the displacement.
pub(super) fn dependence(model: &Model) -> Dependence {
    if model.flow.is_some() { Dependence::Displacement } else { Dependence::Nothing }
}

/// Δt/β of an increment [T].
pub(super) fn span(trial: Trial) -> f64 {
    Times::of(trial).span
}

/// Adds the equations of the pressures, and what the bodies' forces change by with them to the tangent; stores the water at the end of the trial.
pub(super) fn add(
    model: &Model,
    activated: &Activated,
    trial: Trial,
    u: &[f64],
    water: &mut Water,
    sums: &mut Sums,
) -> Result<(), TrialFailure> {
    let Some(flow) = &model.flow else { return Ok(()) };
    let (times, old) = (Times::of(trial), &trial.old.water);
    let wanted = sums.tangent.is_some();
    let evaluate = |(_, wet): &(usize, &WetElement)| {
        let increment = Increment { flow, wet: activated.wet(wet), trial, u, times };
        let answer = increment.evaluate().map_err(|cause| TrialFailure::material(model, wet.element, cause))?;
        Ok((answer, wanted.then(|| increment.columns(&answer))))
    };
    let there = |(_, wet): &(usize, &WetElement)| trial.step.has(model.body_of_element[wet.element]);
    let elements: Vec<(usize, &WetElement)> = flow.elements.iter().enumerate().filter(there).collect();
    let mut balances = Balances::new(flow);
    for batch in elements.chunks(BATCH) {
        let answers: Vec<Result<_, TrialFailure>> = batch.par_iter().with_min_len(MANY).map(evaluate).collect();
        for (answer, &(number, wet)) in answers.into_iter().zip(batch) {
            let (answer, columns) = answer?;
            for (a, &k) in wet.pressures.iter().enumerate() {
                balances.take(k, answer.change[a], answer.size[a]);
                balances.let_out(k, times.span * answer.flow[a], 0.0);
            }
            if let Some(columns) = &columns {
                sums.couple_pressures(number, wet, columns);
            }
        }
    }
    for (k, before) in old.change.iter().enumerate() {
        balances.let_out(k, -times.memory * before, (times.memory * before).abs());
    }
    water.outlets.clone_from(&old.outlets);
    water.between = old.between;
    // A case that goes on from the end of another may have further ones.
    water.outlets.resize(flow.outlets.len(), Outflow::default());
    water.outlets.iter_mut().for_each(|outlet| outlet.go_on(times.memory));
    for drain in &trial.step.drains {
        let outlet = &mut water.outlets[drain.outlet];
        for &(k, at, area) in &drain.corners {
            let [q, slope] = drain.flow(flow.pressure(k, Some(u)), at, trial.time);
            if !q.is_finite() {
                let node = flow.corners[k].unwrap_or_default();
                return Err(TrialFailure::Undefined { node: model.mesh.node_tags[node], time: trial.time });
            }
            outlet.let_out(area * q, times.span);
            balances.let_out(k, times.span * area * q, times.span * area * q.abs());
            let (scale, dof) = (flow.scales[k], flow.dof(k));
            sums.stiffen(dof, dof, -scale * scale * times.span * area * slope);
        }
    }
    channels::add(model, trial, u, times, water, &mut balances, sums)?;
    water.change = balances.end(flow, u, sums);
    water.peaks.clone_from(&old.peaks);
    water.excess.clone_from(&old.excess);
    water.brought.clone_from(&old.brought);
    Ok(())
}

/// Flow out of where a pressure is prescribed, were that 0, as a force at its dof: so large are the parts of its balance, which cancel [F].
pub(super) fn prescribed(model: &Model, trial: Trial, u: &[f64]) -> Vec<(usize, f64)> {
    let (Some(flow), span) = (&model.flow, span(trial)) else { return Vec::new() };
    let outlets = trial.step.drains.iter().flat_map(|drain| {
        let conductance = drain.kind.conductance();
        drain.corners.iter().map(move |&(k, _, area)| (k, area * conductance))
    });
    let all = outlets.chain(channels::prescribed(model, trial, u));
    all.map(|(k, passes)| (flow.dof(k), flow.scales[k] * span * passes * flow.pressure(k, Some(u)).abs())).collect()
}

/// An element in an increment.
struct Increment<'a> {
    flow: &'a PoreFlow,
    wet: &'a WetElement,
    trial: Trial<'a>,
    u: &'a [f64],
    times: Times,
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

impl Increment<'_> {
    fn evaluate(&self) -> Result<Answer, MaterialFailure> {
        let Self { flow, wet, trial, u, times } = self;
        let (old, corners) = (&trial.old.displacement, wet.pressures.len());
        let mut at = Corners::default();
        for (a, &k) in wet.pressures.iter().enumerate() {
            (at.now[a], at.before[a]) = (flow.pressure(k, Some(u)), flow.pressure(k, Some(old)));
        }
        let (mut answer, mut flows) = (Answer::default(), Flows::default());
        let moved = [wet.moved(u), wet.moved(old)];
        match &wet.constant {
            Some(constant) => flows.add_constant(constant, &mut answer),
            None => wet.points.iter().try_for_each(|point| self.add_point(point, &moved, &at, &mut answer, &mut flows))?,
        }
        let [now, before] = moved;
        for a in 0..corners {
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
        point: &WetPoint,
        moved: &[[Vector2<f64>; MOST_NODES]; 2],
        at: &Corners,
        answer: &mut Answer,
        flows: &mut Flows,
    ) -> Result<(), MaterialFailure> {
        let wet = self.wet;
        let [is, was] = moved.each_ref().map(|moved| wet.deformed(point, moved));
        let [jacobian_is, jacobian_was] = [jacobian(wet, &is)?, jacobian(wet, &was)?];
        let by = opens_by(wet, point, &is);
        let pressure: f64 = point.values.iter().zip(&at.before).map(|(n, p)| n * p).sum();
        let share_of_k = point.volume * wet.permeability(jacobian_was, pressure);
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

    /// Columns of the tangent of the pressures' dofs: the rows are dofs of all its nodes, two for each.
    fn columns(&self, answer: &Answer) -> PressureColumns {
        let Self { flow, wet, .. } = self;
        let (mut columns, first) = ([[0.0; 2 * (MOST_NODES + MOST_CORNERS)]; 2 * MOST_CORNERS], 2 * wet.in_mesh);
        let scales = |a: usize| flow.scales[wet.pressures[a]];
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
