//! Content of frames: bodies, interfaces, integration points.

use nalgebra::Vector2;

use super::gradients::MotionBy;
use super::quantities::WATER_FLUX;
use super::recovery::{NodalRecovery, shown_names};
use super::vtu::{CellType, Grid, cell_type};
use crate::bars::fields::{AT_POINTS, OF_SEGMENTS};
use crate::contact::pair;
use crate::contact::{ContactPair, ContactState};
use crate::laws::bulk::{CauchyStress, principal_values};
use crate::mesh::{Configuration, Element};
use crate::model::{Model, State};

/// Content of a frame: a state and the quantities computed from it before the frame is written. The search for contacts uses
/// all threads, which may be waiting for the writer of frames.
#[derive(Debug)]
pub struct Shown {
    /// the state
    pub state: State,
    /// contact forces on every node [F]
    contact_forces: Vec<f64>,
    /// derivatives of the displacements by values of the case
    motions: Vec<MotionBy>,
}

impl Shown {
    /// Content of the frame of a state, and the derivatives of its displacements that it shows.
    pub fn new(model: &Model, state: &State, motions: Vec<MotionBy>) -> Self {
        Self { state: state.clone(), contact_forces: contact_forces(model, state), motions }
    }
}

/// Fills the grid of the bodies. Rigid bodies have no cells and no fields.
pub fn solid_frame(
    model: &Model,
    Shown { state, contact_forces, motions }: &Shown,
    recovery: &NodalRecovery,
    derived: bool,
    grid: &mut Grid,
) {
    let fields = recovery.fields(model, state);
    let nodes = model.mesh.own_nodes();
    // Each body has exactly one material, so the two ids agree.
    let body = || model.body_of_element.iter().map(|&body| body as i32);
    grid.begin(|| {
        let cell = |element: &Element| (cell_type(element.kind), element.nodes.clone());
        (model.mesh.nodes[..nodes].to_vec(), model.mesh.elements.iter().map(cell).collect())
    });
    grid.vectors("displacement", &state.displacement[..2 * nodes]);
    grid.vectors("velocity", &state.velocity[..2 * nodes]);
    grid.vectors("acceleration", &state.acceleration[..2 * nodes]);
    grid.vectors("reaction", &state.reaction[..2 * nodes]);
    grid.vectors("contact_force", &contact_forces[..2 * nodes]);
    add_fields(grid, &fields.tensors[..nodes], derived);
    let flowing = model.flow.as_ref().map(|flow| flow.at_nodes(&model.mesh, &state.displacement));
    for (name, values) in fields.shown {
        // Water that flows has pressures at nodes, which need no recovery.
        let own = flowing.as_ref().filter(|_| name == PORE_PRESSURE);
        let at =
            |(node, value): (usize, f64)| own.map_or(value, |own| if own[node].is_nan() { value } else { own[node] });
        grid.at_points(name, 1, values.into_iter().take(nodes).enumerate().map(at));
    }
    if flowing.is_some() {
        grid.vectors(WATER_FLUX.name, &fluxes(model, state)[..2 * nodes]);
    }
    for (place, motion) in motions {
        grid.vectors(&format!("d(displacement)/d({place})"), &motion[..2 * nodes]);
    }
    grid.owners("body", model.bodies.iter().map(|body| &*body.name));
    grid.at_cells("body", body());
    grid.at_cells("material", body());
    hide_absent(model, state, &model.body_of_element, grid);
}

/// Name of the pressure in pores among what laws show.
const PORE_PRESSURE: &str = "pore_pressure";

/// Seepage of water that flows at every node, the mean of the elements around it by volume; 0 elsewhere [L/T].
fn fluxes(model: &Model, state: &State) -> Vec<f64> {
    let mut sums = vec![0.0; model.dofs()];
    let mut volumes = vec![0.0; model.mesh.nodes.len()];
    let wet = model.flow.iter().flat_map(|flow| &flow.elements);
    for wet in wet.filter(|wet| state.has(model.body_of_element[wet.element])) {
        let flux = model.seepage(wet, state);
        let volume: f64 = wet.volumes.iter().sum();
        for &node in &model.mesh.elements[wet.element].nodes {
            volumes[node] += volume;
            (0..2).for_each(|i| sums[2 * node + i] += volume * flux[i]);
        }
    }
    sums.iter_mut()
        .enumerate()
        .for_each(|(dof, sum)| *sum /= if volumes[dof / 2] > 0.0 { volumes[dof / 2] } else { 1.0 });
    sums
}

/// Hides the cells of absent bodies, given the body of each cell.
fn hide_absent(model: &Model, state: &State, bodies: &[usize], grid: &mut Grid) {
    if model.changes_bodies() {
        grid.hide(bodies.iter().map(|&body| !state.has(body)));
    }
}

/// Fills the grid of the bars: a line to a segment.
pub fn bars_frame(model: &Model, Shown { state, .. }: &Shown, grid: &mut Grid) {
    let bars = || model.bars.iter().zip(&state.bars);
    grid.begin(|| {
        let (mut points, mut lines) = (Vec::new(), Vec::new());
        for bar in &model.bars {
            let first = points.len();
            points.extend(bar.vertices.iter().map(|vertex| vertex.at));
            lines.extend((0..bar.segments.len()).map(|k| (CellType::Line, vec![first + k, first + k + 1])));
        }
        (points, lines)
    });
    let moved = bars().flat_map(|(bar, _)| bar.vertices.iter().map(|vertex| vertex.displacement(&state.displacement)));
    grid.vectors("displacement", &moved.flat_map(|u| [u.x, u.y]).collect::<Vec<_>>());
    let values = |name: &str| bars().flat_map(|(bar, state)| bar.field(state, name).unwrap_or_default()).collect();
    for name in AT_POINTS {
        let all: Vec<f64> = values(name);
        grid.at_points(name, 1, all.into_iter());
    }
    for name in OF_SEGMENTS {
        let all: Vec<f64> = values(name);
        grid.numbers_at_cells(name, all.into_iter());
    }
    grid.owners("bar", model.bars.iter().map(|bar| &*bar.name));
    grid.at_cells("bar", model.bars.iter().enumerate().flat_map(|(k, bar)| bar.segments.iter().map(move |_| k as i32)));
    if bars().any(|(_, state)| !state.is_there) || model.steps.iter().any(|step| !step.bars.absent.is_empty()) {
        grid.hide(bars().flat_map(|(bar, state)| bar.segments.iter().map(|_| !state.is_there)));
    }
}

/// Nodal contact forces [F].
fn contact_forces(model: &Model, state: &State) -> Vec<f64> {
    let (mut forces, x) = (vec![0.0; model.dofs()], model.configuration(&state.displacement));
    for (pair, states) in model.contacts.iter().zip(&state.contacts) {
        for (node, force) in pair.forces_on_nodes(states, &x) {
            forces[2 * node] += force.x;
            forces[2 * node + 1] += force.y;
        }
    }
    forces
}

/// Fills the grid of the integration points of the bodies, with stresses and internal variables.
pub fn points_frame(model: &Model, Shown { state, .. }: &Shown, derived: bool, grid: &mut Grid) {
    let elements = &model.mesh.elements;
    let mut names: Vec<&str> = Vec::new();
    for name in model.bodies.iter().flat_map(|body| body.material.description().variables) {
        if !names.contains(name) {
            names.push(name);
        }
    }
    let (mut places, mut moved, mut body) = (Vec::new(), Vec::new(), Vec::new());
    let (mut fields, mut variables) = (Vec::new(), vec![Vec::new(); names.len()]);
    // Some of what a law shows it remembers.
    let shown: Vec<&str> = shown_names(model).into_iter().filter(|name| !names.contains(name)).collect();
    let mut further = vec![Vec::new(); shown.len()];
    for (e, element) in elements.iter().enumerate() {
        let (u, number) = (model.mesh.vectors(e, &state.displacement), model.body_of_element[e]);
        let (material, memory) = (&*model.bodies[number].material, model.memories.of(e, &state.memory));
        // Accepted states contain no element whose material law fails.
        let solid = model.solid(state, e);
        let count = solid.quadrature_points();
        let stresses = solid.stresses(material, memory, &u);
        let stresses = stresses.unwrap_or_else(|_| (0..count).map(|_| CauchyStress::default()).collect());
        let strains = solid.log_strains(material, memory, &u);
        let strains = strains.unwrap_or_else(|_| (0..count).map(|_| [0.0; 4]).collect());
        let seen = solid.shown(material, memory, &u).unwrap_or_default();
        for (k, (point, both)) in solid.quadrature().iter().zip(stresses.into_iter().zip(strains)).enumerate() {
            let values = element.kind.values(point.at);
            places.push(element.nodes.iter().zip(&values).map(|(&node, n)| model.mesh.nodes[node] * *n).sum());
            let at: Vector2<f64> = u.iter().zip(&values).map(|(u, n)| u * *n).sum();
            moved.extend([at.x, at.y]);
            body.push(number);
            fields.push(both);
            let own = material.description().variables;
            for (name, list) in names.iter().zip(&mut variables) {
                let place = own.iter().position(|other| other == name);
                list.push(place.map_or(f64::NAN, |place| memory[k * own.len() + place]));
            }
            for (name, list) in shown.iter().zip(&mut further) {
                let place = material.description().shown.iter().position(|other| other == name);
                let value = place.and_then(|place| seen.get(k * material.description().shown.len() + place));
                list.push(value.copied().unwrap_or(f64::NAN));
            }
        }
    }
    grid.begin(|| {
        let cells = (0..places.len()).map(|k| (CellType::Vertex, vec![k])).collect();
        (places, cells)
    });
    grid.vectors("displacement", &moved);
    add_fields(grid, &fields, derived);
    names
        .iter()
        .chain(&shown)
        .zip(variables.into_iter().chain(further))
        .for_each(|(name, values)| grid.at_points(name, 1, values.into_iter()));
    grid.owners("body", model.bodies.iter().map(|body| &*body.name));
    grid.at_cells("body", body.iter().map(|&body| body as i32));
    hide_absent(model, state, &body, grid);
}

/// Stress and logarithmic strain, and on request what follows from them.
fn add_fields(grid: &mut Grid, fields: &[(CauchyStress, [f64; 4])], derived: bool) {
    let (stresses, strains) = (|| fields.iter().map(|(stress, _)| stress), || fields.iter().map(|(_, strain)| *strain));
    grid.tensors("stress", stresses().map(CauchyStress::components));
    grid.at_points("von_mises", 1, stresses().map(CauchyStress::von_mises));
    grid.at_points("mean_pressure", 1, stresses().map(CauchyStress::pressure));
    grid.tensors("log_strain", strains());
    if derived {
        grid.at_points("principal_stress", 3, stresses().flat_map(|stress| principal_values(stress.components())));
        grid.at_points("principal_strain", 3, strains().flat_map(principal_values));
        grid.at_points("stretch_zz", 1, strains().map(|[_, _, zz, _]| zz.exp()));
    }
}

/// Fills the grid of the interfaces: a polyline through the contact points along each slave surface.
pub fn contact_frame(model: &Model, Shown { state, .. }: &Shown, grid: &mut Grid) {
    let points_of = |pair: &ContactPair, x: &Configuration| pair.points.iter().map(|p| p.at(x)).collect::<Vec<_>>();
    let undeformed = model.mesh.undeformed();
    let reference: Vec<Vector2<f64>> = model.contacts.iter().flat_map(|pair| points_of(pair, &undeformed)).collect();
    let x = model.configuration(&state.displacement);
    let current: Vec<Vector2<f64>> = model.contacts.iter().flat_map(|pair| points_of(pair, &x)).collect();
    let displacement: Vec<f64> = reference.iter().zip(&current).flat_map(|(a, b)| [b.x - a.x, b.y - a.y]).collect();

    let mut lines: Vec<(CellType, Vec<usize>)> = Vec::new();
    let mut contact_id: Vec<i32> = Vec::new();
    let mut first = 0;
    for (number, pair) in model.contacts.iter().enumerate() {
        for line in pair.lines() {
            let kind = if line.len() == 1 { CellType::Vertex } else { CellType::PolyLine };
            lines.push((kind, line.map(|k| first + k).collect()));
            contact_id.push(number as i32);
        }
        first += pair.points.len();
    }
    grid.begin(|| (reference, lines));
    grid.vectors("displacement", &displacement);
    for name in pair::field_names(&model.contacts) {
        let of = |(pair, states): (&ContactPair, &Vec<ContactState>)| {
            pair::field_values(pair, states, state.time, state.dt, name)
        };
        grid.at_points(name, 1, model.contacts.iter().zip(&state.contacts).flat_map(of));
    }
    grid.owners("contact", model.contacts.iter().map(|pair| &*pair.name));
    grid.at_cells("contact", contact_id.into_iter());
}
