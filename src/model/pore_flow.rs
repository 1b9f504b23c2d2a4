//! Water that flows through the pores of bodies: its pressures, the elements that it fills, and where it leaves them.
//!
//! Every corner of an element has a pressure, linear or bilinear between corners. It stands in the place of the first displacement of a node of
//! its own, which belongs to no element; the second displacement stands for nothing, so that matrices keep blocks of two by two:
//!
//! ```text
//! p = p₀ + s û        s = M/h: stiffness of the skeleton over the size of an element, so that û is a length and its equation a force
//! ```

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::sync::Arc;

use nalgebra::{Matrix2, Vector2};

use super::Body;
use super::boundary::Profile;
use super::element::SolidElement;
use super::imposed::PoreFluid;
use crate::laws::bulk::{GIVEN_PRESSURE, MaterialDescription, Slot};
use crate::mesh::configuration::vector;
use crate::mesh::{ElementKind, Mesh};

/// The water of all bodies in which it flows.
#[derive(Clone, Debug, PartialEq)]
#[doc(hidden)]
pub struct PoreFlow {
    /// First of the nodes that stand for pressures
    pub first: usize,
    /// Node of the bodies, or of a slave along which water flows, whose pressure each is
    pub corners: Vec<usize>,
    /// Number of the pressure of each node
    pub of_node: Vec<Option<usize>>,
    /// p₀: pressure at the start [F/L²]
    pub initial: Vec<f64>,
    /// s [F/L³]
    pub scales: Vec<f64>,
    /// elements
    pub elements: Vec<WetElement>,
    /// Place of each element of the mesh among these
    pub of_element: Vec<Option<usize>>,
    /// Bodies
    pub bodies: Vec<usize>,
    /// of all elements in the mesh [L³]
    pub volume: f64,
    /// Number of the pressure of each node of the slaves along which water flows, by contact
    pub channels: BTreeMap<String, BTreeMap<usize, usize>>,
    /// Names of the outlets, over all steps
    pub outlets: Vec<String>,
    /// of the stiffest body [F/L]
    stiffness: f64,
}

/// An element that water flows through.
#[derive(Clone, Debug, PartialEq)]
#[doc(hidden)]
pub struct WetElement {
    /// its number in the mesh
    pub element: usize,
    /// its nodes, then those that stand for its pressures
    pub nodes: Vec<usize>,
    /// number of its nodes in the mesh
    pub in_mesh: usize,
    /// number of the pressure of each corner
    pub pressures: Vec<usize>,
    /// displacement of its nodes when it came into a deformed model, from which its strain counts; else empty [L]
    pub activation: Vec<Vector2<f64>>,
    /// quadrature points
    pub points: Vec<WetPoint>,
    /// shape functions there, the same for all elements of a kind
    pub shape: Arc<[ShapePoint]>,
    /// N/R of all nodes at every point of a ring [1/L]
    pub hoop: Vec<[f64; MOST_NODES]>,
    /// what opens and flows, where that does not change
    pub constant: Option<Box<ConstantFlow>>,
    /// place of the given pressure, and of what the pores have opened by, among the internal variables of the material, and their number
    pub variables: Option<(Slot<2>, usize)>,
    /// 1/Q: what the pores take up by the pressure [L²/F]
    pub capacity: f64,
    /// ∫ N_a N_b dV/Q, and ∫ (N_a − ΠN_a)(N_b − ΠN_b) dV/(2G) of linear elements, Π being the mean: without it pressures of neighbours alternate [L⁵/F]
    pub takes: [[f64; MOST_CORNERS]; MOST_CORNERS],
    /// ∫ N_a dV [L³]
    pub volumes: Vec<f64>,
    /// k/γ_w along x and y [L⁴/(F T)]
    pub mobility: [f64; 2],
    /// γ_w if its weight drives it, else 0 [F/L³]
    pub weight: f64,
    /// γ_w h of capillary water [F/L²]
    pub suction: Option<f64>,
    /// e₀, if the permeability follows the void ratio [-]
    pub void_ratio: Option<f64>,
    /// b [-]
    pub biot: f64,
    /// whether the body is linear: its water flows through the undeformed body
    pub is_linear: bool,
    /// whether the pressure acts with the balances of the water, not in the law of the body
    pub presses: bool,
    /// c = k M/γ_w, and the size [L²/T], [L]
    pub diffusivity: f64,
    /// square root of the area [L]
    pub size: f64,
}

/// Most nodes of an element.
pub const MOST_NODES: usize = 9;
/// Most corners of an element.
pub const MOST_CORNERS: usize = 4;
/// Most quadrature points of an element.
pub const MOST_POINTS: usize = 9;

/// Vectors of the nodes of an element: x of all of them, then y, as loops over nodes are vectors of the processor.
pub type OfNodes = [[f64; MOST_NODES]; 2];
/// Vectors of its corners, in the same order.
pub type OfCorners = [[f64; MOST_CORNERS]; 2];

/// What opens and flows in an element of a linear body, whose permeability does not change.
#[derive(Clone, Debug, PartialEq)]
#[doc(hidden)]
pub struct ConstantFlow {
    /// ∫ b N_a ∂J/∂u dV of every node, by corner [L²]
    pub opens: [OfNodes; MOST_CORNERS],
    /// flow through it
    pub flows: Flows,
}

/// Flow through an element.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[doc(hidden)]
pub struct Flows {
    /// ∫ ∇N_a·∂v/∂∇p ∇N_b dV [L⁵/(F T)]
    pub conducts: [[f64; MOST_CORNERS]; MOST_CORNERS],
    /// ∫ ∇N_a·v dV of water at rest that weighs [L³/T]
    pub falls: [f64; MOST_CORNERS],
}

/// A quadrature point of an element that water flows through: what every evaluation reads, and no more. What there is for corners and nodes that the element does not have is zero.
#[derive(Clone, Copy, Debug, PartialEq)]
#[doc(hidden)]
pub struct WetPoint {
    /// ∂ξ/∂X, by which ∂N/∂X = this ∂N/∂ξ [1/L]
    pub map: Matrix2<f64>,
    /// reference volume [L³]
    pub volume: f64,
}

/// Shape functions at a quadrature point.
#[derive(Clone, Copy, Debug, PartialEq)]
#[doc(hidden)]
pub struct ShapePoint {
    /// N of the corners, linear between them
    pub values: [f64; MOST_CORNERS],
    /// ∂N/∂ξ of these
    pub of_corners: OfCorners,
    /// ∂N/∂ξ of all nodes
    pub of_nodes: OfNodes,
}

/// Flow through what holds a pressure, in multiples of that through an element beside it under the same difference: the pressure is held to the
/// inverse of this [-]
pub const PRESCRIBED: f64 = 1e6;

/// An outlet in a step: where water may leave the bodies, or enter them.
#[derive(Clone, Debug)]
#[doc(hidden)]
pub struct Drain {
    /// number among the outlets of the model
    pub outlet: usize,
    /// number of the pressure, reference position and area of each of its corners
    pub corners: Vec<(usize, Vector2<f64>, f64)>,
    /// what it does
    pub kind: DrainKind,
    /// p̄, or q of a flux
    pub value: Profile,
    /// γ_w where the value is a head: p̄ = γ_w (value − y) [F/L³]
    pub head: Option<f64>,
}

/// What an outlet does.
#[derive(Clone, Copy, Debug, PartialEq)]
#[doc(hidden)]
pub enum DrainKind {
    /// q = κ (p − p̄), κ [L³/(F T)]
    Conducts(f64),
    /// The same, but only outwards
    Seeps(f64),
    /// q is given
    Flux,
}

impl DrainKind {
    /// κ; 0 of a flux [L³/(F T)].
    pub fn conductance(self) -> f64 {
        match self {
            Self::Conducts(conductance) | Self::Seeps(conductance) => conductance,
            Self::Flux => 0.0,
        }
    }
}

impl Drain {
    /// Flow q out of the body at a place, and ∂q/∂p [L/T], [L³/(F T)].
    pub fn flow(&self, pressure: f64, at: Vector2<f64>, time: f64) -> [f64; 2] {
        let value = self.value.value_at(at, time);
        let prescribed = self.head.map_or(value, |weight| weight * (value - at.y));
        match self.kind {
            DrainKind::Flux => [value, 0.0],
            DrainKind::Seeps(_) if pressure <= prescribed => [0.0; 2],
            DrainKind::Conducts(conductance) | DrainKind::Seeps(conductance) => {
                [conductance * (pressure - prescribed), conductance]
            }
        }
    }
}

#[doc(hidden)]
impl PoreFlow {
    /// The water of the bodies in which it flows, if there is any; adds its nodes to the mesh.
    pub fn new(
        bodies: &[Body],
        solids: &[SolidElement],
        channels: &BTreeMap<String, Vec<(usize, f64)>>,
        mesh: &mut Mesh,
    ) -> Option<Self> {
        let wet: Vec<usize> = (0..bodies.len()).filter(|&body| bodies[body].flowing().is_some()).collect();
        if wet.is_empty() {
            return None;
        }
        let own = |&e: &usize| &mesh.elements[e].nodes[..mesh.elements[e].kind.corners()];
        let of_bodies: BTreeSet<usize> =
            wet.iter().flat_map(|&body| bodies[body].elements.iter().flat_map(own)).copied().collect();
        let (first, count) = (mesh.nodes.len(), of_bodies.len());
        let mut of_node = vec![None; first];
        of_bodies.iter().enumerate().for_each(|(k, &node)| of_node[node] = Some(k));
        let of_channels = channels.values().flatten().map(|(node, _)| *node);
        let corners: Vec<usize> = of_bodies.into_iter().chain(of_channels).collect();
        let tag = mesh.node_tags.iter().max().map_or(0, |tag| tag.saturating_add(1));
        for (k, &corner) in corners.iter().enumerate() {
            mesh.nodes.push(mesh.nodes[corner]);
            mesh.node_tags.push(tag.saturating_add(k as u64));
        }
        mesh.water_nodes = corners.len();
        let mut flow = Self {
            first,
            initial: vec![0.0; corners.len()],
            scales: vec![0.0; corners.len()],
            of_element: vec![None; mesh.elements.len()],
            corners,
            of_node,
            elements: Vec::new(),
            bodies: wet.clone(),
            volume: 0.0,
            channels: BTreeMap::new(),
            outlets: Vec::new(),
            stiffness: 0.0,
        };
        let mut known: Vec<Arc<[ShapePoint]>> = Vec::new();
        for &body in &wet {
            for &e in &bodies[body].elements {
                flow.of_element[e] = Some(flow.elements.len());
                let shape = shape(mesh.elements[e].kind, &solids[e]);
                let shape = known.iter().find(|one| one[..] == shape[..]).cloned().unwrap_or_else(|| {
                    known.push(shape.into());
                    known[known.len() - 1].clone()
                });
                let element = WetElement::new(e, shape, &bodies[body], &solids[e], mesh, &flow)?;
                let modulus = bodies[body].material.description().p_wave_modulus;
                let depth = solids[e].mean_weight();
                flow.stiffness = flow.stiffness.max(modulus * depth);
                flow.volume += element.volumes.iter().sum::<f64>();
                for &k in &element.pressures {
                    flow.scales[k] = flow.scales[k].max(modulus / element.size);
                    let at = mesh.nodes[flow.corners[k]];
                    flow.initial[k] = bodies[body].flowing()?.pressure.value(at);
                }
                flow.elements.push(element);
            }
        }
        let largest = flow.scales.iter().copied().fold(0.0, f64::max);
        let mut numbers = count..;
        for (contact, nodes) in channels {
            let own: BTreeMap<usize, usize> = nodes.iter().map(|(node, _)| *node).zip(&mut numbers).collect();
            for &(node, initial) in nodes {
                flow.scales[own[&node]] = flow.of_node[node].map_or(largest, |k| flow.scales[k]);
                flow.initial[own[&node]] = initial;
            }
            flow.channels.insert(contact.clone(), own);
        }
        flow.scales.iter_mut().filter(|scale| **scale == 0.0).for_each(|scale| *scale = 1.0);
        Some(flow)
    }

    /// Node that stands for a pressure.
    pub fn node(&self, number: usize) -> usize {
        self.first + number
    }

    /// The first dof of that node: the second stands for nothing, and stays 0.
    pub fn dof(&self, number: usize) -> usize {
        2 * self.node(number)
    }

    /// Nodes that stand for pressures.
    pub fn nodes(&self) -> Range<usize> {
        self.first..self.first + self.count()
    }

    /// Number of pressures.
    pub fn count(&self) -> usize {
        self.corners.len()
    }

    /// A pressure at a displacement, or at the start [F/L²].
    pub fn pressure(&self, number: usize, u: Option<&[f64]>) -> f64 {
        self.initial[number] + u.map_or(0.0, |u| self.scales[number] * u[self.dof(number)])
    }

    /// The element of a number in the mesh, if water flows through it.
    pub fn wet(&self, element: usize) -> Option<&WetElement> {
        self.of_element.get(element).copied().flatten().map(|k| &self.elements[k])
    }

    /// Stiffness of the equation of a dof that stands for nothing, or for a pressure that only absent bodies have [F/L].
    pub fn spare(&self) -> f64 {
        self.stiffness
    }

    /// Pressures at all nodes of the mesh, in the middle of an edge or element the mean of its ends or corners; NaN where no water flows [F/L²].
    pub fn at_nodes(&self, mesh: &Mesh, u: &[f64]) -> Vec<f64> {
        let mut all: Vec<f64> =
            self.of_node.iter().map(|k| k.map_or(f64::NAN, |k| self.pressure(k, Some(u)))).collect();
        for wet in &self.elements {
            let element = &mesh.elements[wet.element];
            let corners = element.kind.corners();
            let own: Vec<f64> = wet.pressures.iter().map(|&k| self.pressure(k, Some(u))).collect();
            for (local, &node) in element.nodes.iter().enumerate().skip(corners) {
                all[node] = match local - corners {
                    edge if edge < corners => 0.5 * (own[edge] + own[(edge + 1) % corners]),
                    _ => own.iter().sum::<f64>() / corners as f64,
                };
            }
        }
        all
    }
}

impl WetElement {
    fn new(
        e: usize,
        shape: Arc<[ShapePoint]>,
        body: &Body,
        solid: &SolidElement,
        mesh: &Mesh,
        flow: &PoreFlow,
    ) -> Option<Self> {
        let element = &mesh.elements[e];
        let corners = element.kind.corners();
        let pressures: Vec<usize> = element.nodes[..corners].iter().filter_map(|&node| flow.of_node[node]).collect();
        let nodes = element.nodes.iter().copied().chain(pressures.iter().map(|&k| flow.node(k))).collect();
        Self::shaped([nodes, pressures], shape, e, Vec::new(), body, solid, mesh)
    }

    /// The element as it comes at displacements of its nodes.
    pub fn activated(
        &self,
        activation: Vec<Vector2<f64>>,
        body: &Body,
        solid: &SolidElement,
        mesh: &Mesh,
    ) -> Option<Self> {
        let numbers = [&self.nodes, &self.pressures].map(Clone::clone);
        Self::shaped(numbers, self.shape.clone(), self.element, activation, body, solid, mesh)
    }

    fn shaped(
        [nodes, pressures]: [Vec<usize>; 2],
        shape: Arc<[ShapePoint]>,
        e: usize,
        activation: Vec<Vector2<f64>>,
        body: &Body,
        solid: &SolidElement,
        mesh: &Mesh,
    ) -> Option<Self> {
        let (kind, fluid) = (mesh.elements[e].kind, body.flowing()?);
        let (corners, law) = (kind.corners(), body.material.description());
        let linear = linear(kind);
        let mut positions = mesh.places(e);
        positions.iter_mut().zip(&activation).for_each(|(x, u)| *x += u);
        // ∂X/∂ξ with the geometry of all nodes
        let map = |at: [f64; 2]| -> Matrix2<f64> {
            let nodes = positions.iter().zip(kind.derivatives(at));
            nodes.map(|(x, d)| (x - positions[0]) * Vector2::from(d).transpose()).sum()
        };
        let quadrature = solid.quadrature();
        let rounds = if mesh.section.is_axisymmetric() { quadrature.len() } else { 0 };
        let hoop = solid.geometry().take(rounds).map(|(_, hoop, _)| filled(hoop.iter().copied())).collect();
        let points = quadrature.iter().zip(solid.geometry()).map(|(point, (_, _, volume))| WetPoint {
            map: map(point.at).transpose().try_inverse().unwrap_or_default(),
            volume,
        });
        let mut mass = [[0.0; MOST_CORNERS]; MOST_CORNERS];
        for point in kind.mass_quadrature() {
            let values: [f64; MOST_CORNERS] = filled(linear.values(point.at));
            let place = positions.iter().zip(kind.values(point.at)).map(|(x, n)| x * n).sum();
            let share = point.weight * map(point.at).determinant() * mesh.section.weight(place);
            for (row, own) in mass.iter_mut().zip(&values) {
                row.iter_mut().zip(&values).for_each(|(mass, value)| *mass += share * value * own);
            }
        }
        let volumes = mass.map(|row| row.iter().sum::<f64>());
        let volume: f64 = volumes.iter().sum();
        let is_equal = kind.nodes() == corners;
        let biot = fluid.coefficient();
        let capacity = capacity(fluid, &law);
        let projected = if is_equal { 0.5 / law.shear_modulus } else { 0.0 };
        let takes = std::array::from_fn(|a| {
            std::array::from_fn(|b| capacity * mass[a][b] + projected * (mass[a][b] - volumes[a] * volumes[b] / volume))
        });
        let (along_x, weight) = (fluid.permeability?, fluid.unit_weight?);
        let mobility = [along_x, fluid.permeability_y.unwrap_or(along_x)].map(|k| k / weight);
        let wet = Self {
            element: e,
            in_mesh: positions.len(),
            nodes,
            pressures,
            activation,
            points: points.collect(),
            shape,
            hoop,
            constant: None,
            variables: law.slot(&GIVEN_PRESSURE).map(|slot| (slot, law.variables.len())),
            capacity,
            takes,
            volumes: volumes[..corners].to_vec(),
            mobility,
            weight: if fluid.weighs { weight } else { 0.0 },
            suction: fluid.capillary.map(|height| weight * height),
            void_ratio: fluid.kozeny_carman.then(|| fluid.porosity / (1.0 - fluid.porosity)),
            biot,
            is_linear: law.is_linear,
            presses: body.skeleton.is_some(),
            diffusivity: mobility[0].max(mobility[1]) * law.p_wave_modulus,
            size: solid.area().sqrt(),
        };
        let is_constant = wet.is_linear && wet.void_ratio.is_none() && wet.suction.is_none();
        Some(Self { constant: is_constant.then(|| Box::new(wet.constant())), ..wet })
    }

    /// What opens and flows in the undeformed element.
    fn constant(&self) -> ConstantFlow {
        let (mut flows, [kx, ky]) = (Flows::default(), self.mobility);
        let mut opens = [OfNodes::default(); MOST_CORNERS];
        for (k, a) in (0..self.points.len()).flat_map(|k| (0..self.pressures.len()).map(move |a| (k, a))) {
            let (point, [x, y], gradients) =
                (&self.points[k], self.slopes(k), self.gradients_by(k, &Matrix2::identity()));
            let share = self.biot * point.volume * self.shape[k].values[a];
            for node in 0..MOST_NODES {
                let around = self.hoop.get(k).map_or(0.0, |hoop| hoop[node]);
                opens[a][0][node] += share * (gradients[0][node] + around);
                opens[a][1][node] += share * gradients[1][node];
            }
            for (b, conducts) in flows.conducts[a].iter_mut().enumerate() {
                *conducts += point.volume * (kx * x[a] * x[b] + ky * y[a] * y[b]);
            }
            flows.falls[a] += point.volume * ky * y[a] * self.weight;
        }
        ConstantFlow { opens, flows }
    }
}

/// The element of the corners.
fn linear(kind: ElementKind) -> ElementKind {
    if kind.corners() == 3 { ElementKind::T3 } else { ElementKind::Q4 }
}

/// Shape functions of an element at its quadrature points.
fn shape(kind: ElementKind, solid: &SolidElement) -> Vec<ShapePoint> {
    let at = |at: [f64; 2]| ShapePoint {
        values: filled(linear(kind).values(at)),
        of_corners: [0, 1].map(|i| filled(linear(kind).derivatives(at).into_iter().map(|d| d[i]))),
        of_nodes: [0, 1].map(|i| filled(kind.derivatives(at).into_iter().map(|d| d[i]))),
    };
    solid.quadrature().iter().map(|point| at(point.at)).collect()
}

/// As many of some values as there are places, and zeros in the others.
fn filled<T: Copy + Default, const N: usize>(values: impl IntoIterator<Item = T>) -> [T; N] {
    let mut all = [T::default(); N];
    all.iter_mut().zip(values).for_each(|(own, value)| *own = value);
    all
}

/// 1/Q = n/K_w + (b − n)/K_s,  K_s = K/(1 − b) [L²/F].
fn capacity(fluid: &PoreFluid, law: &MaterialDescription) -> f64 {
    let bulk = law.p_wave_modulus - 4.0 / 3.0 * law.shear_modulus;
    1.0 / fluid.modulus() + (fluid.coefficient() - fluid.porosity) * (1.0 - fluid.coefficient()) / bulk
}

#[doc(hidden)]
impl Body {
    /// Stiffness against a wave of compression, in which water that flows has no time to: λ + 2G + b² Q [F/L²].
    pub fn wave_modulus(&self) -> f64 {
        let law = self.material.description();
        law.p_wave_modulus + self.flowing().map_or(0.0, |fluid| fluid.coefficient().powi(2) / capacity(fluid, &law))
    }
}

/// Least permeability of ground above a free surface, and of pores that close, over that at the start [-]
const LEAST: f64 = 1e-4;

#[doc(hidden)]
impl WetElement {
    /// Displacements of its nodes since it came [L].
    pub fn moved(&self, u: &[f64]) -> OfNodes {
        let mut moved = OfNodes::default();
        for (k, &node) in self.nodes[..self.in_mesh].iter().enumerate() {
            let since = vector(u, node) - self.activation.get(k).copied().unwrap_or_default();
            (moved[0][k], moved[1][k]) = (since.x, since.y);
        }
        moved
    }

    /// F in the plane, and the stretch out of it, at a point of some number.
    #[inline(always)]
    pub fn deformed(&self, k: usize, [x, y]: &OfNodes) -> (Matrix2<f64>, f64) {
        // ∂u/∂ξ by columns, in one vector of the processor; two sums that do not wait for each other.
        let (mut sums, mut stretch) = ([[0.0; 4]; 2], 1.0);
        let [first, second] = &self.shape[k].of_nodes;
        for node in 0..MOST_NODES {
            let (moved, slopes) =
                ([x[node], y[node], x[node], y[node]], [first[node], first[node], second[node], second[node]]);
            (0..4).for_each(|i| sums[node % 2][i] += moved[i] * slopes[i]);
        }
        if let Some(hoop) = self.hoop.get(k) {
            x.iter().zip(hoop).for_each(|(x, share)| stretch += share * x);
        }
        let by: [f64; 4] = std::array::from_fn(|i| sums[0][i] + sums[1][i]);
        (Matrix2::identity() + Matrix2::from_column_slice(&by) * self.points[k].map.transpose(), stretch)
    }

    /// p at a point of some number, of the pressures of the corners [F/L²].
    #[inline(always)]
    pub fn pressure(&self, k: usize, corners: &[f64; MOST_CORNERS]) -> f64 {
        self.shape[k].values.iter().zip(corners).map(|(n, p)| n * p).sum()
    }

    /// ∂N/∂X of the corners at a point of some number [1/L].
    pub fn slopes(&self, k: usize) -> OfCorners {
        let ([first, second], by) = (&self.shape[k].of_corners, &self.points[k].map);
        [0, 1].map(|i| std::array::from_fn(|a| by[(i, 0)] * first[a] + by[(i, 1)] * second[a]))
    }

    /// A ∂N/∂X of all nodes at a point of some number.
    #[inline(always)]
    pub fn gradients_by(&self, k: usize, matrix: &Matrix2<f64>) -> OfNodes {
        let ([first, second], by) = (&self.shape[k].of_nodes, matrix * self.points[k].map);
        // Loops that the compiler keeps in place, as vectors of the processor.
        let mut all = OfNodes::default();
        for (i, own) in all.iter_mut().enumerate() {
            let [by_first, by_second] = [by[(i, 0)], by[(i, 1)]];
            let slopes = first.iter().zip(second);
            own.iter_mut().zip(slopes).for_each(|(own, (a, b))| *own = by_first * a + by_second * b);
        }
        all
    }

    /// Writes the pressure at every point to the variables of the material there.
    pub fn write(&self, flow: &PoreFlow, u: Option<&[f64]>, variables: &mut [f64]) {
        let Some((slot, count)) = self.variables else { return };
        let mut pressures = [0.0; MOST_CORNERS];
        pressures.iter_mut().zip(&self.pressures).for_each(|(p, &k)| *p = flow.pressure(k, u));
        for (k, own) in variables.chunks_exact_mut(count).enumerate() {
            slot.of_mut(own)[0] = self.pressure(k, &pressures);
        }
    }

    /// Permeability over that at the start, at a volume and a pressure.
    pub fn permeability(&self, jacobian: f64, pressure: f64) -> f64 {
        let of_pores = self.void_ratio.map_or(1.0, |start| {
            let now = ((1.0 + start) * jacobian - 1.0).max(0.0);
            ((now / start).powi(3) * (1.0 + start) / (1.0 + now)).max(LEAST)
        });
        let of_water = self.suction.map_or(1.0, |suction| (pressure.min(0.0) / suction).exp().max(LEAST));
        of_pores * of_water
    }
}
