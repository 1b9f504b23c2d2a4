//! A case on a finer mesh and with shorter increments, as convergence studies need it ([`super::convergence`]).
//!
//! ```text
//! n → 2 n                            elements along both sides of a block; of other meshes every element becomes four ([`Mesh::divided`])
//! g → g^((2n − 1)/(2n − 2))          their grading, last size over first: neighbours differ by the root of what they did
//! n → 2 n                            segments of bars that are divided
//! dt → dt/2,  error → error/4        increments, and the error allowed in one, which is of second order in them
//! ```
//! What the case leaves open has the default of the finer mesh; `alpha_n` then grows with 1/h.

use std::collections::BTreeMap;

use serde_json::Value;

use super::file::{Amount, BlockInput, BlocksInput, Case, GradingInput, MeshSource, MiddleInput, evaluated};
use super::resolved::keep_opening;
use super::{CaseError, Written, build, build_on, mesh, with_groups};
use crate::mesh::{Block, Blocks, Grading, Group, MOST_ELEMENTS, Mesh};
use crate::model::builder::{Checked, Load, LoadStep, ModelError, Place, nodes_at, refuse_if};
use crate::model::step::SHORTEST_INCREMENT;
use crate::model::text::vector;
use crate::model::{Increments, Model, Scheme, Step};

/// Most halvings of a mesh: 65 536 elements for one along a side are more than any mesh may have.
const MOST: u32 = 16;

/// How many times elements and increments are halved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Halvings {
    /// of the sizes of elements
    pub mesh: u32,
    /// of the increments
    pub increments: u32,
}

impl Halvings {
    /// As many of elements and increments.
    pub const fn of_both(times: u32) -> Self {
        Self { mesh: times, increments: times }
    }
}

/// Returns a case whose elements and increments are halved so many times. It writes no fields and no page.
///
/// # Errors
/// Returns [`CaseError`] if the case is invalid or begins with another one, if nodes of its mesh stand for a side, or if it names nodes by
/// their tags or by a place where it has none, or loads every node of a body or a side, which another mesh makes another problem.
pub fn refined(written: &Written, halvings: Halvings) -> Result<Written, CaseError> {
    let Written { path, case, .. } = written;
    let refined_mesh = || {
        check(case, halvings.mesh)?;
        match &case.mesh {
            MeshSource::Blocks(input) => of_blocks(input, halvings.mesh),
            given => divided(given, with_groups(case, mesh(case, path)?)?, halvings.mesh),
        }
    };
    let finer = refined_mesh().map_err(|complaint| complaint.in_file(path))?;
    with(written, finer, &build(case, path)?, halvings)
}

/// Returns a case on a mesh in memory as [`refined`]; its own mesh is the finer one, unless elements are not halved.
///
/// # Errors
/// The same as for [`refined`].
pub fn refined_on(written: &Written, mesh: &Mesh, halvings: Halvings) -> Result<Written, CaseError> {
    let Written { path, case, .. } = written;
    let refined_mesh = || {
        check(case, halvings.mesh)?;
        divided(&case.mesh, with_groups(case, mesh.clone())?, halvings.mesh)
    };
    let finer = refined_mesh().map_err(|complaint| complaint.in_file(path))?;
    with(written, finer, &build_on(case, mesh.clone(), path)?, halvings)
}

/// Refuses what cannot be refined.
fn check(case: &Case, times: u32) -> Checked<()> {
    let message =
        "the mesh is that of the preceding run, which must be refined as well: give the steps of both in one case";
    refuse_if(case.begin_with.is_some(), "begin_with", message)?;
    refuse_if(times > MOST, "mesh", format_args!("cannot be halved {times} times: at most {MOST} times are allowed"))
}

/// Refuses what another mesh makes another problem: nodes by their tags, and what acts at every node of a body or a side.
fn check_nodes(Written { case, document, .. }: &Written, mesh: &Mesh) -> Checked<()> {
    let instead = "a refined mesh has other nodes: name a single node by its position, {\"near\": [x, y]}";
    if let Some(place) = tagged(document, "") {
        return Err(ModelError::new(place, format!("is a node by its tag, and {instead}")));
    }
    let grows = |group: &String| !matches!(mesh.groups.get(group), Some(Group::Nodes(_)) | None);
    for (k, step) in case.steps.iter().enumerate() {
        for (i, Load { on, force, spring, dashpot, .. }) in step.loads.iter().enumerate() {
            let kinds = [("force", force.is_some()), ("spring", spring.is_some()), ("dashpot", dashpot.is_some())];
            let Some((kind, _)) = kinds.into_iter().find(|(_, given)| *given) else { continue };
            let Place::Group(group) = on else { continue };
            let message =
                format_args!("acts at every node of `{group}`, and {instead}, or give a total_force or a traction");
            refuse_if(grows(group), format!("steps[{k}].loads[{i}].{kind}"), message)?;
        }
    }
    for group in case.point_masses.keys() {
        let message = format_args!("is at every node of the group, and {instead}, or give a density");
        refuse_if(grows(group), format!("point_masses.{group}"), message)?;
    }
    Ok(())
}

/// Where a value of a case names a node by its tag.
fn tagged(value: &Value, place: &str) -> Option<String> {
    match value {
        Value::Object(keys) if keys.len() == 1 && keys.get("node").is_some_and(Value::is_u64) => Some(place.into()),
        Value::Object(keys) => keys.iter().find_map(|(key, value)| {
            tagged(value, &if place.is_empty() { key.clone() } else { format!("{place}.{key}") })
        }),
        Value::Array(list) => list.iter().enumerate().find_map(|(k, value)| tagged(value, &format!("{place}[{k}]"))),
        _ => None,
    }
}

/// Difference of two places that is round-off, as a fraction of the elements there [-].
const SAME: f64 = 1e-6;

/// Refuses places to which another node is the nearest on the finer mesh: its nodes have those of the mesh among them.
fn check_near(Written { path, document, .. }: &Written, own: &Mesh, finer: &Case) -> Checked<()> {
    let places = near(document, "");
    if places.is_empty() {
        return Ok(());
    }
    let finer = mesh(finer, path)?;
    for (place, [x, y]) in places {
        let node = nodes_at(own, &Place::Near([x, y]), &place)?[0];
        let adjacent = own.elements.iter().filter(|element| element.nodes.contains(&node));
        let size = adjacent.map(|element| own.size_of(element.nodes.iter().copied())).fold(0.0, f64::max);
        let of_finer = nodes_at(&finer, &Place::Near([x, y]), &place).ok().map(|found| finer.nodes[found[0]]);
        let stays = of_finer.is_some_and(|at| (at - own.nodes[node]).norm() <= SAME * size);
        let message = format!(
            "is nearest to the node at {}, but with halved elements to another node: give the position of that node, \
             or measure at ({x}, {y}) with a probe (`probes`)",
            vector(own.nodes[node])
        );
        refuse_if(!stays, place, message)?;
    }
    Ok(())
}

/// Nodes that a value of a case names by places, with where they stand.
fn near(value: &Value, place: &str) -> Vec<(String, [f64; 2])> {
    let inside = |key: &String| if place.is_empty() { key.clone() } else { format!("{place}.{key}") };
    match value {
        Value::Object(keys) if keys.len() == 1 && keys.contains_key("near") => {
            let point = serde_json::from_value(keys["near"].clone()).ok();
            point.map(|point| (place.to_owned(), point)).into_iter().collect()
        }
        Value::Object(keys) => {
            let keys = keys.iter().filter(|(key, _)| !(place.is_empty() && *key == "mesh"));
            keys.flat_map(|(key, value)| near(value, &inside(key))).collect()
        }
        Value::Array(list) => {
            list.iter().enumerate().flat_map(|(k, value)| near(value, &format!("{place}[{k}]"))).collect()
        }
        _ => Vec::new(),
    }
}

/// The case on another mesh, with increments that are halved so many times.
fn with(written: &Written, mesh: MeshSource, model: &Model, halvings: Halvings) -> Result<Written, CaseError> {
    let Written { path, case, .. } = written;
    if halvings.mesh > 0 {
        check_nodes(written, &model.mesh).map_err(|complaint| complaint.in_file(path))?;
    }
    // A mesh whose elements are divided has the groups by place as they are divided.
    let is_divided = halvings.mesh > 0 && matches!(mesh, MeshSource::Inline(_));
    let groups = if is_divided { BTreeMap::new() } else { case.groups.clone() };
    let mut case = Case { mesh, groups, ..case.clone() };
    if halvings.mesh > 0 {
        check_near(written, &model.mesh, &case).map_err(|complaint| complaint.in_file(path))?;
    }
    for (given, step) in case.steps.iter_mut().zip(&model.steps) {
        refine_increments(given, step, 2.0_f64.powi(halvings.increments as i32));
    }
    // A length of the interface, not of its mesh
    for pair in &model.contacts {
        case.contacts.get_mut(&pair.name).into_iter().for_each(|contact| keep_opening(contact, pair, model));
    }
    for bar in &model.bars {
        let divided = case.bars.get_mut(&bar.name).filter(|input| input.segments.is_some() || input.is_free_beam());
        divided.into_iter().for_each(|input| input.segments = Some(bar.segments.len() << halvings.mesh));
    }
    (case.output.fields, case.output.report) = (false, false);
    // Values read from JSON can be written as JSON.
    let document = serde_json::to_value(&case).unwrap_or_default();
    Ok(Written { path: path.clone(), document, case })
}

fn of_blocks(input: &BlocksInput, times: u32) -> Checked<MeshSource> {
    let Blocks { blocks, separated, joined } = evaluated(input, "mesh")?;
    let blocks = blocks.iter().map(|block| halved(block, times)).collect();
    Ok(MeshSource::Blocks(BlocksInput { parameters: [].into(), blocks, separated, joined }))
}

/// A mesh that is not made of blocks, with elements that are halved so many times.
fn divided(given: &MeshSource, mut mesh: Mesh, times: u32) -> Checked<MeshSource> {
    let refused = |error| ModelError::new("mesh", error);
    let total = mesh.elements.len() as f64 * 4.0_f64.powi(times as i32);
    let message = format_args!("would have {total:.0} elements, more than {MOST_ELEMENTS:.0}: take fewer levels");
    refuse_if(total > MOST_ELEMENTS, "mesh", message)?;
    let mut finer = None;
    for _ in 0..times {
        let mesh_of_halves = mesh.divided().map_err(refused)?;
        mesh = mesh_of_halves.build().map_err(refused)?;
        finer = Some(mesh_of_halves);
    }
    Ok(finer.map_or_else(|| given.clone(), MeshSource::Inline))
}

/// The block with elements that are halved so many times.
fn halved(block: &Block, times: u32) -> BlockInput {
    let numbers = |point: [f64; 2]| point.map(Amount::Number);
    let (mut elements, mut grading) = (block.elements, block.grading);
    for _ in 0..times {
        for k in 0..2 {
            grading[k] = of_halves(grading[k], elements[k]);
            elements[k] *= 2;
        }
    }
    BlockInput {
        body: block.body.clone(),
        corners: block.corners.map(numbers),
        arcs: block.arcs.map(|centre| centre.map(numbers)),
        elements: elements.map(|count| Amount::Number(count as f64)),
        grading: grading.map(|grading| match grading {
            Grading::Ratio(ratio) => GradingInput::Ratio(ratio),
            Grading::Middle(ratio) => GradingInput::Middle(MiddleInput { middle: Amount::Number(ratio) }),
        }),
        kind: block.kind,
        sides: block.sides.clone(),
        points: block.points.iter().map(|(name, at)| (name.clone(), numbers(*at))).collect(),
    }
}

/// The grading of twice as many elements. A single element, or two of one size, have none.
fn of_halves(grading: Grading, count: usize) -> Grading {
    let power = |halves: usize, last: usize| halves as f64 / (2 * last.max(1)) as f64;
    match grading {
        Grading::Ratio(ratio) => Grading::Ratio(ratio.powf(power(2 * count - 1, count - 1))),
        Grading::Middle(ratio) => Grading::Middle(ratio.powf(power(count - 1, (count - 1) / 2))),
    }
}

/// Shortens the increments of a step by a factor. Explicit ones follow from the mesh unless they are given.
fn refine_increments(given: &mut LoadStep, step: &Step, factor: f64) {
    if matches!(step.scheme, Scheme::Explicit { .. }) && given.dt.is_none() {
        return;
    }
    let Increments { initial, min, max, error, slip, pore_pressure } = step.increments;
    let finer = |error: f64| error / (factor * factor);
    let increments = Increments {
        initial: initial / factor,
        min: (min / factor).max(min.min(SHORTEST_INCREMENT * step.span.end)),
        max: max / factor,
        error: error.map(finer),
        slip: slip.map(finer),
        pore_pressure: pore_pressure.map(finer),
    };
    given.dt = Some(increments.into());
}
