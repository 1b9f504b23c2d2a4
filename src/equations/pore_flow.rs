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
use super::sums::{Dependence, Sums, TrialFailure};
use super::trial::Trial;
use super::water_balances::{Balances, Times};
use crate::laws::bulk::{MaterialFailure, cofactor};
use crate::model::pore_flow::{ConstantFlow, MOST_NODES, PoreFlow, WetElement, WetPoint};
use crate::model::state::{Outflow, Water};
use crate::model::{Activated, Model};

/// Number of elements whose contributions are stored at once before they are added.
const BATCH: usize = 1024;

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
    let of = |wet: &&WetElement| {
        Increment { flow, wet: activated.wet(wet), trial, u, times }
            .evaluate(wanted)
            .map_err(|cause| TrialFailure::material(model, wet.element, cause))
    };
    let wet = flow.elements.iter().filter(|wet| trial.step.has(model.body_of_element[wet.element]));
    let elements: Vec<&WetElement> = wet.collect();
    let mut balances = Balances::new(flow);
    for batch in elements.chunks(BATCH) {
        let answers: Vec<Result<Answer, TrialFailure>> = batch.par_iter().with_min_len(MANY).map(of).collect();
        for (answer, wet) in answers.into_iter().zip(batch) {
            let answer = answer?;
            for (a, &k) in wet.pressures.iter().enumerate() {
                balances.take(k, answer.change[a], answer.size[a]);
                balances.let_out(k, times.span * answer.flow[a], 0.0);
            }
            if wanted {
                sums.couple(&wet.nodes, &answer.tangent);
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

/// What an element adds: Δm, ∫ v·∇N dV, the magnitudes of their parts, and the tangent of all its nodes, column by column.
#[derive(Default)]
struct Answer {
    change: [f64; 4],
    flow: [f64; 4],
    size: [f64; 4],
    tangent: Vec<f64>,
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
    let (corners, nodes) = (wet.pressures.len(), wet.points.first().map_or(0, |point| point.gradients.len()));
    let mut opens = DMatrix::zeros(corners, 2 * nodes);
    for point in &wet.points {
        let deformed = wet.deformed(point, &wet.moved(u));
        jacobian(wet, &deformed)?;
        let by = opens_by(wet, point, &deformed);
        for (a, value) in point.values.iter().enumerate() {
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

/// Pressures of the corners of an element, and scales of their dofs.
struct Corners {
    now: [f64; 4],
    before: [f64; 4],
    scales: [f64; 4],
}

impl Increment<'_> {
    fn evaluate(&self, wanted: bool) -> Result<Answer, MaterialFailure> {
        let Self { flow, wet, trial, u, .. } = self;
        let (old, corners) = (&trial.old.displacement, wet.pressures.len());
        let of = |value: &dyn Fn(usize) -> f64| {
            let mut all = [0.0; 4];
            all.iter_mut().zip(&wet.pressures).for_each(|(own, &k)| *own = value(k));
            all
        };
        let at = Corners {
            now: of(&|k| flow.pressure(k, Some(u))),
            before: of(&|k| flow.pressure(k, Some(old))),
            scales: of(&|k| flow.scales[k]),
        };
        let mut answer = Answer::default();
        let dofs = 2 * wet.nodes.len();
        if wanted {
            answer.tangent.resize(dofs * dofs, 0.0);
        }
        for (a, b) in (0..corners).flat_map(|a| (0..corners).map(move |b| (a, b))) {
            let takes = wet.storage[(a, b)] + wet.projection[(a, b)];
            let part = takes * (at.now[b] - at.before[b]);
            answer.change[a] += part;
            answer.size[a] += part.abs();
            if wanted {
                answer.tangent[wet.places[b] * dofs + wet.places[a]] -= at.scales[a] * at.scales[b] * takes;
            }
        }
        let moved = [wet.moved(u), wet.moved(old)];
        match &wet.constant {
            Some(constant) => self.add_constant(constant, moved, &at, wanted, &mut answer),
            None => wet.points.iter().try_for_each(|point| self.add_point(point, &moved, &at, wanted, &mut answer))?,
        }
        Ok(answer)
    }

    /// Adds what opens and flows in an element in which nothing changes.
    fn add_constant(
        &self,
        ConstantFlow { opens, conducts, falls }: &ConstantFlow,
        [now, before]: [[Vector2<f64>; MOST_NODES]; 2],
        at: &Corners,
        wanted: bool,
        answer: &mut Answer,
    ) {
        let Self { wet, times, .. } = self;
        let (corners, nodes, dofs) = (wet.pressures.len(), opens.ncols() / 2, 2 * wet.nodes.len());
        for node in 0..nodes {
            let way = now[node] - before[node];
            for (dof, way) in [(2 * node, way.x), (2 * node + 1, way.y)] {
                for (a, opens) in opens.column(dof).iter().enumerate() {
                    answer.change[a] += opens * way;
                    answer.size[a] += (opens * way).abs();
                    if wanted {
                        let (place, share) = (wet.places[a], at.scales[a] * opens);
                        answer.tangent[place * dofs + dof] -= share;
                        answer.tangent[dof * dofs + place] -= share;
                    }
                }
            }
        }
        for (a, falls) in falls.iter().enumerate() {
            answer.flow[a] += falls;
            answer.size[a] += times.span * falls.abs();
            for b in 0..corners {
                let flows = conducts[(a, b)];
                answer.flow[a] += flows * at.now[b];
                answer.size[a] += times.span * (flows * at.now[b]).abs();
                if wanted {
                    answer.tangent[wet.places[b] * dofs + wet.places[a]] -=
                        at.scales[a] * at.scales[b] * times.span * flows;
                }
            }
        }
    }

    /// Adds what opens and flows at a point.
    fn add_point(
        &self,
        point: &WetPoint,
        moved: &[[Vector2<f64>; MOST_NODES]; 2],
        at: &Corners,
        wanted: bool,
        answer: &mut Answer,
    ) -> Result<(), MaterialFailure> {
        let Self { wet, times, .. } = self;
        let (corners, [now, before]) = (wet.pressures.len(), moved);
        let [is, was] = moved.each_ref().map(|moved| wet.deformed(point, moved));
        let [jacobian_is, jacobian_was] = [jacobian(wet, &is)?, jacobian(wet, &was)?];
        let by = opens_by(wet, point, &is);
        let share = wet.biot * point.volume;
        let nodes = now.iter().zip(before).zip(&by).take(point.gradients.len());
        let gross: f64 = nodes.map(|((now, before), by)| by.dot(&(now - before)).abs()).sum();
        let pressure: f64 = point.values.iter().zip(&at.before).map(|(n, p)| n * p).sum();
        let share_of_k = wet.permeability(jacobian_was, pressure);
        let [conducts, falls] = conducts(wet, &was).map(|part| part * share_of_k);
        let falls = falls * Vector2::new(0.0, wet.weight);
        let slope: Vector2<f64> = point.slopes.iter().zip(&at.now).map(|(slope, p)| slope * *p).sum();
        let v = conducts * slope + falls;
        for a in 0..corners {
            let opens = point.values[a] * share;
            answer.change[a] += opens * (jacobian_is - jacobian_was);
            answer.size[a] += opens.abs() * gross;
            answer.flow[a] += point.volume * v.dot(&point.slopes[a]);
            let along = conducts.transpose() * point.slopes[a];
            let size: f64 = (0..corners).map(|b| (along.dot(&point.slopes[b]) * at.now[b]).abs()).sum();
            answer.size[a] += times.span * point.volume * (point.slopes[a].dot(&falls).abs() + size);
            if wanted {
                self.couple(point, [a, wet.places[a]], &by, &along, &at.scales, &mut answer.tangent);
            }
        }
        Ok(())
    }

    /// Adds what couples displacements and the pressure of a corner, with its place, and the flow `along` its slope, to the tangent.
    fn couple(
        &self,
        point: &WetPoint,
        [a, place]: [usize; 2],
        by: &[Vector2<f64>],
        along: &Vector2<f64>,
        scales: &[f64; 4],
        tangent: &mut [f64],
    ) {
        let (wet, dofs) = (self.wet, 2 * self.wet.nodes.len());
        let share = scales[a] * wet.biot * point.volume * point.values[a];
        for (node, by) in by[..point.gradients.len()].iter().enumerate() {
            for (i, by) in by.iter().enumerate() {
                let dof = 2 * node + i;
                tangent[place * dofs + dof] -= share * by;
                tangent[dof * dofs + place] -= share * by;
            }
        }
        for (b, other) in wet.places.iter().copied().enumerate() {
            let flows = along.dot(&point.slopes[b]);
            tangent[other * dofs + place] -= scales[a] * scales[b] * self.times.span * point.volume * flows;
        }
    }
}
