//! Content of frames: bodies, interfaces, integration points.

use nalgebra::Vector2;

use super::vtu::{CellType, Grid, cell_type};
use crate::contact::force::ContactState;
use crate::contact::pair;
use crate::contact::pair::ContactPair;
use crate::laws::bulk::CauchyStress;
use crate::mesh::Element;
use crate::mesh::configuration::Configuration;
use crate::model::Model;
use crate::model::state::State;

/// Content of a frame: a state and the quantities computed from it before the frame is written. The search for contacts uses
/// all threads, which may be waiting for the writer of frames.
#[derive(Debug)]
pub struct Shown {
    /// the state
    pub state: State,
    /// contact forces on every node [F]
    contact_forces: Vec<f64>,
}

impl Shown {
    /// Content of the frame of a state.
    pub fn new(model: &Model, state: &State) -> Self {
        Self { state: state.clone(), contact_forces: contact_forces(model, state) }
    }
}

/// Fills the grid of the bodies. Rigid bodies have no cells and no fields.
pub fn solid_frame(model: &Model, Shown { state, contact_forces }: &Shown, grid: &mut Grid) {
    let stresses = nodal_stresses(model, state);
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
    add_stresses(grid, &stresses[..nodes]);
    grid.at_cells("body", body());
    grid.at_cells("material", body());
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
pub fn points_frame(model: &Model, Shown { state, .. }: &Shown, grid: &mut Grid) {
    let elements = &model.mesh.elements;
    let mut names: Vec<&str> = Vec::new();
    for name in model.bodies.iter().flat_map(|body| body.material.variables()) {
        if !names.contains(name) {
            names.push(name);
        }
    }
    let (mut places, mut moved, mut body) = (Vec::new(), Vec::new(), Vec::new());
    let (mut stresses, mut variables) = (Vec::new(), vec![Vec::new(); names.len()]);
    for (e, element) in elements.iter().enumerate() {
        let (u, number) = (model.mesh.vectors(e, &state.displacement), model.body_of_element[e]);
        let (material, memory) = (&*model.bodies[number].material, model.memories.of(e, &state.memory));
        // Accepted states contain no element whose material law fails.
        let none = || (0..model.solids[e].quadrature_points()).map(|_| CauchyStress::default()).collect();
        let found = model.solids[e].stresses(material, memory, &u).unwrap_or_else(|_| none());
        for (k, (point, stress)) in element.kind.quadrature().iter().zip(found).enumerate() {
            let values = element.kind.values(point.at);
            places.push(element.nodes.iter().zip(&values).map(|(&node, n)| model.mesh.nodes[node] * *n).sum());
            let at: Vector2<f64> = u.iter().zip(&values).map(|(u, n)| u * *n).sum();
            moved.extend([at.x, at.y]);
            body.push(number as i32);
            stresses.push(stress);
            let own = material.variables();
            for (name, list) in names.iter().zip(&mut variables) {
                let place = own.iter().position(|other| other == name);
                list.push(place.map_or(f64::NAN, |place| memory[k * own.len() + place]));
            }
        }
    }
    grid.begin(|| {
        let cells = (0..places.len()).map(|k| (CellType::Vertex, vec![k])).collect();
        (places, cells)
    });
    grid.vectors("displacement", &moved);
    add_stresses(grid, &stresses);
    names.iter().zip(variables).for_each(|(name, values)| grid.at_points(name, 1, values.into_iter()));
    grid.at_cells("body", body.into_iter());
}

fn add_stresses(grid: &mut Grid, stresses: &[CauchyStress]) {
    grid.at_points("stress", 4, stresses.iter().flat_map(|s| [s.xx, s.yy, s.zz, s.xy]));
    grid.at_points("von_mises", 1, stresses.iter().map(CauchyStress::von_mises));
    grid.at_points("pressure", 1, stresses.iter().map(CauchyStress::pressure));
}

/// Cauchy stress at the nodes, averaged over the adjacent elements. An element whose material law fails is skipped; it never
/// occurs in an accepted state.
fn nodal_stresses(model: &Model, state: &State) -> Vec<CauchyStress> {
    let elements = &model.mesh.elements;
    let stresses_of = |e: usize| {
        let u = model.mesh.vectors(e, &state.displacement);
        let material = &*model.bodies[model.body_of_element[e]].material;
        model.solids[e].nodal_stresses(material, model.memories.of(e, &state.memory), &u)
    };
    let mut sums = vec![([0.0; 4], 0.0); model.mesh.nodes.len()];
    for (element, stresses) in elements.iter().zip((0..elements.len()).map(stresses_of)) {
        for (stress, &node) in stresses.into_iter().flatten().zip(&element.nodes) {
            let (sum, count) = &mut sums[node];
            for (sum, part) in sum.iter_mut().zip([stress.xx, stress.yy, stress.zz, stress.xy]) {
                *sum += part;
            }
            *count += 1.0;
        }
    }
    let mean = |(sum, count): ([f64; 4], f64)| {
        let [xx, yy, zz, xy] = sum.map(|s| if count > 0.0 { s / count } else { 0.0 });
        CauchyStress { xx, yy, zz, xy }
    };
    sums.into_iter().map(mean).collect()
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
    grid.at_cells("contact", contact_id.into_iter());
}
