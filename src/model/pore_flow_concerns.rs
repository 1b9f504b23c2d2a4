//! Warnings about water that flows, before the run starts.

use super::boundary::Profile;
use super::coupled::CoupledParts;
use super::pore_flow::{Drain, DrainKind, PoreFlow, WetElement};
use super::scheme::Scheme;
use super::text::{self, number};
use super::{Model, Step};
use crate::mesh::ElementKind;

/// What flows at the start into a corner that is no outlet, over all that passes it, above which water that weighs counts as not at rest [-]
const AT_REST: f64 = 1e-4;

/// Share of the least increment without overshoot, r h²/(6 c), below which pressures beside an outlet overshoot by a few hundredths [-]
const OVERSHOOTS: f64 = 0.5;

/// Least and most unit weight of water over that of a body, between which the two count as of the same units: a third to nearly all of ground is usual, a
/// density in its place is a tenth as much, and a submerged body of peat weighs as little as a tenth of water [-]
const OF_WEIGHT: [f64; 2] = [0.1, 10.0];

/// Warnings about the water.
pub(super) fn concerns(model: &Model) -> Vec<String> {
    let Some(flow) = &model.flow else { return Vec::new() };
    let of_steps = overshoots(model, flow).into_iter().chain(unprescribed(model, flow));
    moves(model, flow).into_iter().chain(of_other_units(model, flow)).chain(of_steps).collect()
}

/// Water whose unit weight is out of proportion to that of the body.
fn of_other_units(model: &Model, flow: &PoreFlow) -> Option<String> {
    let bodies = || flow.bodies.iter().map(|&number| (number, &model.bodies[number]));
    model.steps.iter().flat_map(|step| bodies().map(move |body| (step, body))).find_map(|(step, (number, body))| {
        let (weight, at) = (body.flowing()?.unit_weight?, model.mesh.nodes[*body.nodes.first()?]);
        let own = step.loads.dead.iter().filter(|load| load.body == Some(number));
        let gravity = own.map(|load| load.amplitude.value(at, step.span.end)).fold(0.0, f64::hypot);
        let of_body = body.material.description().density * gravity;
        let [least, most] = OF_WEIGHT.map(|share| share * of_body);
        (of_body > 0.0 && !(least..=most).contains(&weight)).then(|| {
            format!(
                "the water of body `{}` weighs {} per volume (unit_weight), and the body {} (density times gravity): ground weighs one to three times as much \
                 as water, so give both in the same units, and the permeability, of which k/unit_weight counts",
                body.name,
                text::number(weight),
                text::number(of_body)
            )
        })
    })
}

/// Water that is driven by its weight, and does not start at rest.
fn moves(model: &Model, flow: &PoreFlow) -> Option<String> {
    let mut sums = vec![[0.0; 2]; flow.count()];
    let mut free = vec![true; flow.count()];
    let drains = model.steps.first().map_or(&[][..], |step| &step.drains);
    drains.iter().flat_map(|drain| &drain.corners).for_each(|(k, ..)| free[*k] = false);
    let first = |wet: &&WetElement| model.steps.first().is_none_or(|step| step.has(model.body_of_element[wet.element]));
    let across = model.contacts.iter().filter_map(|pair| pair.seam.as_ref()).flat_map(|seam| seam.nodes.keys());
    across.filter_map(|node| flow.of_node[*node]).for_each(|k| free[k] = false);
    for wet in flow.elements.iter().filter(first) {
        if wet.weight == 0.0 {
            wet.pressures.iter().for_each(|&k| free[k] = false);
            continue;
        }
        let pressures: Vec<f64> = wet.pressures.iter().map(|&k| flow.pressure(k, None)).collect();
        for (number, point) in wet.points.iter().enumerate() {
            let ([x, y], [kx, ky]) = (wet.slopes(number), wet.mobility);
            for (a, &k) in wet.pressures.iter().enumerate() {
                let weighs = point.volume * ky * wet.weight * y[a];
                sums[k][0] += weighs;
                sums[k][1] += weighs.abs();
                for (b, pressure) in pressures.iter().enumerate() {
                    let part = point.volume * pressure * (kx * x[a] * x[b] + ky * y[a] * y[b]);
                    sums[k][0] += part;
                    sums[k][1] += part.abs();
                }
            }
        }
    }
    let worst =
        (0..flow.count()).filter(|&k| free[k] && sums[k][1] > 0.0).map(|k| (k, (sums[k][0] / sums[k][1]).abs()));
    let (k, share) = worst.max_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, share)| *share > AT_REST)?;
    let at = model.mesh.nodes[flow.corners[k]];
    Some(format!(
        "water flows at the start where nothing drains it, as at ({}, {}), where {} % of it comes to rest: it weighs, so give its `pressure` at the \
         start as unit_weight (level - y), or what a state of flow has",
        number(at.x),
        number(at.y),
        number((100.0 * share).round())
    ))
}

/// r of an element: how long an increment after a jump is to be for pressures without overshoot, over h²/(6 c).
fn least(kind: ElementKind) -> f64 {
    match kind {
        ElementKind::Q4 | ElementKind::T3 => 0.83,
        ElementKind::Q8 | ElementKind::Q9 => 1.0,
        ElementKind::T6 => 2.6,
    }
}

/// Static steps whose first increment is too short for the elements at an outlet; those of a motion have to be.
fn overshoots(model: &Model, flow: &PoreFlow) -> Option<String> {
    let holds = |drain: &&Drain| drain.kind != DrainKind::Flux;
    model.steps.iter().filter(|step| step.scheme == Scheme::Static).find_map(|step| {
        let mut drained = vec![false; flow.count()];
        let corners = step.drains.iter().filter(holds).flat_map(|drain| &drain.corners);
        corners.for_each(|(k, ..)| drained[*k] = true);
        let adjacent = |wet: &&WetElement| {
            step.has(model.body_of_element[wet.element]) && wet.pressures.iter().any(|&k| drained[k])
        };
        let of = |wet: &WetElement| {
            least(model.mesh.elements[wet.element].kind) * wet.size * wet.size / (6.0 * wet.diffusivity)
        };
        // The elements that follow the jump first.
        let shortest = flow.elements.iter().filter(adjacent).map(of).fold(f64::INFINITY, f64::min);
        let dt = step.increments.initial;
        (shortest.is_finite() && dt < OVERSHOOTS * shortest).then(|| {
            format!(
                "the first increment of step `{}`, {}, is shorter than water takes through half an element beside an outlet, {}: where something \
                 jumps, pressures there overshoot; give a longer `dt`, or finer elements",
                step.name,
                number(dt),
                number(shortest)
            )
        })
    })
}

/// A step in which water flows by a given flux into or out of bodies, and nothing holds their pressure.
fn unprescribed(model: &Model, flow: &PoreFlow) -> Option<String> {
    let is_given = |drain: &Drain| drain.kind == DrainKind::Flux && !matches!(drain.value, Profile::Constant(0.0));
    let given = |step: &Step| step.drains.iter().any(is_given);
    if !model.steps.iter().any(given) {
        return None;
    }
    let part_of = CoupledParts::of(model).of_node;
    let parts = |drain: &Drain| drain.corners.iter().map(|(k, ..)| part_of[flow.node(*k)]).collect::<Vec<_>>();
    model.steps.iter().find_map(|step| {
        let prescribed: Vec<usize> = step.drains.iter().filter(|drain| drain.kind != DrainKind::Flux).flat_map(parts).collect();
        let drain = step.drains.iter().find(|drain| is_given(drain) && parts(drain).iter().all(|part| !prescribed.contains(part)))?;
        Some(format!(
            "step `{}`: water flows through `{}` by a given flux, and no pressure is prescribed: the flow changes the volume of the body, limited only by its \
             stiffness; prescribe a `pressure`, `head` or `seepage` on another side, unless this is intended",
            step.name, flow.outlets[drain.outlet]
        ))
    })
}
