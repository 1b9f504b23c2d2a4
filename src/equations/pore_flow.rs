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
use crate::mesh::configuration::vector;
use crate::model::pore_flow::{PoreFlow, WetElement, WetPoint};
use crate::model::state::{Outflow, State, Water};
use crate::model::{Activated, Model};

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
    let answers: Vec<Result<Answer, TrialFailure>> = elements.par_iter().map(of).collect();
    let mut balances = Balances::new(flow);
    for (answer, wet) in answers.into_iter().zip(elements) {
        let answer = answer?;
        for (a, &k) in wet.pressures.iter().enumerate() {
            balances.take(k, answer.change[a], answer.size[a]);
            balances.let_out(k, times.span * answer.flow[a], 0.0);
        }
        if wanted {
            sums.couple(&wet.nodes, &answer.tangent);
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

/// A body at a point: J, and ∂J/∂u of every node.
struct Opened {
    jacobian: f64,
    by: Vec<Vector2<f64>>,
}

fn opened(wet: &WetElement, point: &WetPoint, u: &[f64]) -> Result<Opened, MaterialFailure> {
    let (f, hoop) = wet.deformed(point, u);
    let around = |a: usize| point.hoop.get(a).copied().unwrap_or(0.0);
    if wet.is_linear {
        let by = point.gradients.iter().enumerate().map(|(a, g)| g + Vector2::new(around(a), 0.0));
        return Ok(Opened { jacobian: f.trace() - 1.0 + (hoop - 1.0), by: by.collect() });
    }
    let (area, plane) = (cofactor(&f), f.determinant());
    if !(plane > 0.0 && hoop > 0.0) {
        return Err(MaterialFailure::Inverted { jacobian: plane * hoop });
    }
    let by = point.gradients.iter().enumerate().map(|(a, g)| area * g * hoop + Vector2::new(plane * around(a), 0.0));
    Ok(Opened { jacobian: plane * hoop, by: by.collect() })
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
        let is = opened(wet, point, u)?;
        for (a, value) in point.values.iter().enumerate() {
            for (node, by) in is.by.iter().enumerate() {
                (0..2).for_each(|i| opens[(a, 2 * node + i)] += wet.biot * point.volume * value * by[i]);
            }
        }
    }
    let takes = (&wet.storage + &wet.projection).cholesky();
    Ok(takes.map_or_else(|| DMatrix::zeros(2 * nodes, 2 * nodes), |takes| opens.transpose() * takes.solve(&opens)))
}

/// J_n F_n⁻¹ k/γ_w F_n⁻ᵀ, and J_n F_n⁻¹ k/γ_w.
fn conducts(wet: &WetElement, point: &WetPoint, old: &State) -> [Matrix2<f64>; 2] {
    let mobility = Matrix2::new(wet.mobility[0], 0.0, 0.0, wet.mobility[1]);
    if wet.is_linear {
        return [mobility; 2];
    }
    let (f, hoop) = wet.deformed(point, &old.displacement);
    // J F⁻¹ = cofᵀ
    let area = cofactor(&f).transpose() * hoop;
    let inverse = cofactor(&f) / f.determinant();
    [area * mobility * inverse, area * mobility]
}

impl Increment<'_> {
    fn evaluate(&self, wanted: bool) -> Result<Answer, MaterialFailure> {
        let Self { flow, wet, trial, u, times } = self;
        let (old, corners) = (&trial.old.displacement, wet.pressures.len());
        let now: Vec<f64> = wet.pressures.iter().map(|&k| flow.pressure(k, Some(u))).collect();
        let before: Vec<f64> = wet.pressures.iter().map(|&k| flow.pressure(k, Some(old))).collect();
        let scales: Vec<f64> = wet.pressures.iter().map(|&k| flow.scales[k]).collect();
        let mut answer = Answer::default();
        let dofs = 2 * wet.nodes.len();
        if wanted {
            answer.tangent.resize(dofs * dofs, 0.0);
        }
        for (a, b) in (0..corners).flat_map(|a| (0..corners).map(move |b| (a, b))) {
            let takes = wet.storage[(a, b)] + wet.projection[(a, b)];
            let part = takes * (now[b] - before[b]);
            answer.change[a] += part;
            answer.size[a] += part.abs();
            if wanted {
                answer.tangent[wet.places[b] * dofs + wet.places[a]] -= scales[a] * scales[b] * takes;
            }
        }
        for point in &wet.points {
            let is = opened(wet, point, u)?;
            let was = opened(wet, point, old)?;
            let share = wet.biot * point.volume;
            let gross: f64 =
                (is.by.iter().zip(&wet.nodes)).map(|(by, &n)| by.dot(&(vector(u, n) - vector(old, n))).abs()).sum();
            let pressure: f64 = point.values.iter().zip(&before).map(|(n, p)| n * p).sum();
            let share_of_k = wet.permeability(was.jacobian, pressure);
            let [conducts, falls] = conducts(wet, point, trial.old).map(|part| part * share_of_k);
            let slope: Vector2<f64> = point.slopes.iter().zip(&now).map(|(slope, p)| slope * *p).sum();
            let v = conducts * slope + falls * Vector2::new(0.0, wet.weight);
            for a in 0..corners {
                answer.change[a] += point.values[a] * share * (is.jacobian - was.jacobian);
                answer.size[a] += point.values[a].abs() * share * gross;
                answer.flow[a] += point.volume * v.dot(&point.slopes[a]);
                let driven = point.slopes[a].dot(&(falls * Vector2::new(0.0, wet.weight))).abs();
                let size = (0..corners).map(|b| (point.slopes[a].dot(&(conducts * point.slopes[b])) * now[b]).abs());
                answer.size[a] += times.span * point.volume * (driven + size.sum::<f64>());
            }
            if wanted {
                self.couple(point, &is, &conducts, &scales, &mut answer.tangent);
            }
        }
        Ok(answer)
    }

    /// Adds what couples displacements and pressures, and the flow, to the tangent.
    fn couple(&self, point: &WetPoint, is: &Opened, conducts: &Matrix2<f64>, scales: &[f64], tangent: &mut [f64]) {
        let (wet, dofs) = (self.wet, 2 * self.wet.nodes.len());
        for (a, place) in wet.places.iter().copied().enumerate() {
            let share = scales[a] * wet.biot * point.volume * point.values[a];
            for (node, by) in is.by.iter().enumerate() {
                for (i, by) in by.iter().enumerate() {
                    let dof = 2 * node + i;
                    tangent[place * dofs + dof] -= share * by;
                    tangent[dof * dofs + place] -= share * by;
                }
            }
            for (b, other) in wet.places.iter().copied().enumerate() {
                let flows = point.slopes[a].dot(&(conducts * point.slopes[b]));
                tangent[other * dofs + place] -= scales[a] * scales[b] * self.times.span * point.volume * flows;
            }
        }
    }
}
