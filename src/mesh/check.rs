//! Check of every mesh: turns the data of a reader into a consistent [`Mesh`].
//!
//! The raw mesh is the data of a reader before the check.
//!
//! Degenerate elements with a positive area are refused as well: sides of negligible length, and nodes closer to each other
//! than the accuracy of their positions.

use std::collections::{BTreeMap, HashMap, HashSet};

use nalgebra::Vector2;

use super::outline::Line;
use super::{Between, Edge, Element, Group, Mesh, MeshError};
use crate::mesh::shape::ElementKind;

/// Returns the checked mesh: elements counter-clockwise, edges oriented, unused nodes removed.
pub(super) fn finish(raw: RawMesh) -> Result<Mesh, MeshError> {
    if raw.bodies.is_empty() && raw.points.is_empty() {
        return Err(MeshError::NoElements);
    }
    check_names(&raw)?;
    let numbers = NodeNumbers::new(&raw.nodes)?;
    let mut mesh = Mesh::default();
    (mesh.node_tags, mesh.nodes) = raw.nodes.into_iter().unzip();
    add_bodies(&mut mesh, &numbers, raw.bodies)?;
    refuse_duplicates(&mesh)?;
    add_edges(&mut mesh, &numbers, raw.edges)?;
    add_points(&mut mesh, &numbers, raw.points)?;
    drop_unused_nodes(&mut mesh);
    Ok(mesh)
}

fn check_names(raw: &RawMesh) -> Result<(), MeshError> {
    let mut seen = HashSet::new();
    for (name, cells) in raw.bodies.iter().chain(&raw.edges).chain(&raw.points) {
        if !seen.insert(name) {
            return Err(MeshError::SameName(name.clone()));
        }
        if cells.is_empty() {
            return Err(MeshError::EmptyGroup(name.clone()));
        }
    }
    Ok(())
}

fn add_bodies(mesh: &mut Mesh, numbers: &NodeNumbers, bodies: BTreeMap<String, Vec<RawCell>>) -> Result<(), MeshError> {
    let gradients = gradients_by_kind();
    for (name, cells) in bodies {
        let first = mesh.elements.len();
        for cell in cells {
            check_nodes_differ(&name, &cell)?;
            let nodes = numbers.of("element", &name, &cell)?;
            let element = counter_clockwise(Element { kind: kind(&name, &cell)?, nodes }, &mesh.nodes);
            check_area(&element, cell.tag, &name, &mesh.nodes, &gradients)?;
            refuse(&element, cell.tag, &name, &mesh.nodes, &mesh.node_tags)?;
            mesh.elements.push(element);
            mesh.element_tags.push(cell.tag);
        }
        mesh.groups.insert(name, Group::Elements((first..mesh.elements.len()).collect()));
    }
    Ok(())
}

fn kind(group: &str, cell: &RawCell) -> Result<ElementKind, MeshError> {
    KINDS.into_iter().find(|kind| kind.nodes() == cell.nodes.len()).ok_or_else(|| MeshError::NodeCount {
        cell: format!("element {}", cell.tag),
        group: group.into(),
        count: cell.nodes.len(),
        expected: "a triangle has 3 or 6, a quadrilateral 4, 8 or 9",
    })
}

const KINDS: [ElementKind; 5] = [ElementKind::T3, ElementKind::T6, ElementKind::Q4, ElementKind::Q8, ElementKind::Q9];

/// Returns the element, with reversed numbering if its corners run clockwise.
fn counter_clockwise(mut element: Element, positions: &[Vector2<f64>]) -> Element {
    let n = element.kind.corners();
    let (corners, rest) = element.nodes.split_at_mut(n);
    if signed_area(corners, positions) < 0.0 {
        // The first corner is kept, so the side from corner i to i + 1 becomes side n − 1 − i; a centre node is kept too.
        corners[1..].reverse();
        let sides = rest.len().min(n);
        rest[..sides].reverse();
    }
    element
}

/// Area of the polygon of the corners, positive if they run counter-clockwise; computed relative to the first corner to avoid
/// round-off far from the origin.
fn signed_area(corners: &[usize], positions: &[Vector2<f64>]) -> f64 {
    let arms: Vec<_> = corners.iter().map(|&c| positions[c] - positions[corners[0]]).collect();
    arms.windows(2).map(|pair| 0.5 * pair[0].perp(&pair[1])).sum()
}

fn check_nodes_differ(group: &str, cell: &RawCell) -> Result<(), MeshError> {
    let repeated = cell.nodes.iter().enumerate().find(|(i, node)| cell.nodes[..*i].contains(node));
    match repeated {
        Some((_, &node)) => Err(MeshError::RepeatedNode { element: cell.tag, group: group.into(), node }),
        None => Ok(()),
    }
}

/// Shape function derivatives at every quadrature point (stiffness and mass) of each kind.
type Gradients = HashMap<ElementKind, Vec<Vec<[f64; 2]>>>;

fn gradients_by_kind() -> Gradients {
    let at_points = |kind: ElementKind| {
        let points = kind.quadrature().into_iter().chain(kind.mass_quadrature());
        (kind, points.map(|point| kind.derivatives(point.at)).collect())
    };
    KINDS.into_iter().map(at_points).collect()
}

fn check_area(
    element: &Element,
    tag: u64,
    group: &str,
    positions: &[Vector2<f64>],
    gradients: &Gradients,
) -> Result<(), MeshError> {
    let arms: Vec<_> = element.nodes.iter().map(|&n| positions[n] - positions[element.nodes[0]]).collect();
    let size = arms.iter().map(|arm| arm.norm()).fold(0.0, f64::max);
    // A sliver of round-off width still has positive area; NaN fails the test.
    let flat = 1e-12 * size * size;
    if gradients[&element.kind].iter().all(|gradient| jacobian(gradient, &arms) > flat) {
        Ok(())
    } else {
        Err(MeshError::Collapsed { element: tag, group: group.into() })
    }
}

/// Jacobian determinant det ∂x/∂(ξ, η).
fn jacobian(gradient: &[[f64; 2]], positions: &[Vector2<f64>]) -> f64 {
    let along = |axis: usize| gradient.iter().zip(positions).map(|(d, x)| x * d[axis]).sum::<Vector2<f64>>();
    along(0).perp(&along(1))
}

/// Refuses elements with the same corners, whose stiffness and mass would count twice.
fn refuse_duplicates(mesh: &Mesh) -> Result<(), MeshError> {
    let mut by_corners: Vec<_> =
        mesh.elements.iter().enumerate().map(|(e, element)| (sorted_corners(element), e)).collect();
    by_corners.sort_unstable();
    let Some(pair) = by_corners.windows(2).find(|pair| pair[0].0 == pair[1].0) else { return Ok(()) };
    let [first, second] = [pair[0].1, pair[1].1];
    Err(MeshError::Duplicate {
        first: mesh.element_tags[first],
        first_group: body(mesh, first),
        second: mesh.element_tags[second],
        second_group: body(mesh, second),
    })
}

/// Corners in ascending order; a triangle is padded with a number that no node has.
fn sorted_corners(element: &Element) -> [usize; 4] {
    let mut corners = [usize::MAX; 4];
    corners.iter_mut().zip(&element.nodes[..element.kind.corners()]).for_each(|(corner, &node)| *corner = node);
    corners.sort_unstable();
    corners
}

fn body(mesh: &Mesh, element: usize) -> String {
    mesh.body_of(element).unwrap_or_default().into()
}

fn add_edges(mesh: &mut Mesh, numbers: &NodeNumbers, curves: BTreeMap<String, Vec<RawCell>>) -> Result<(), MeshError> {
    let mut lines = Vec::new();
    for (name, cells) in &curves {
        for cell in cells {
            lines.push((name, cell.tag, line_nodes(numbers, name, cell)?));
        }
    }
    let sides = adjacent_sides(mesh, lines.iter().map(|(_, _, nodes)| ends(nodes)));
    let on_bodies: HashSet<&String> =
        lines.iter().filter(|(_, _, nodes)| !sides[&ends(nodes)].is_empty()).map(|(name, ..)| *name).collect();
    let mut groups: BTreeMap<String, Vec<Edge>> = BTreeMap::new();
    let mut outlines: BTreeMap<String, Vec<Line>> = BTreeMap::new();
    let mut between: BTreeMap<String, Vec<Between>> = BTreeMap::new();
    let mut seen = HashSet::new();
    for (name, tag, nodes) in &lines {
        if !seen.insert((name, ends(nodes))) {
            return Err(MeshError::EdgeRepeated { line: *tag, group: name.to_string() });
        }
        if on_bodies.contains(name) {
            let (edge, other) = edge(mesh, &sides[&ends(nodes)], nodes, *tag, name)?;
            let group = groups.entry(name.to_string()).or_default();
            if let Some(other) = other {
                between.entry(name.to_string()).or_default().push(Between { at: group.len(), line: *tag, other });
            }
            group.push(edge);
        } else {
            outlines.entry(name.to_string()).or_default().push(along(mesh, nodes));
        }
    }
    mesh.between = between;
    mesh.groups.extend(groups.into_iter().map(|(name, edges)| (name, Group::Edges(edges))));
    mesh.groups.extend(outlines.into_iter().map(|(name, lines)| (name, Group::Lines(lines))));
    Ok(())
}

fn line_nodes(numbers: &NodeNumbers, group: &str, cell: &RawCell) -> Result<Vec<usize>, MeshError> {
    if !matches!(cell.nodes.len(), 2 | 3) {
        return Err(MeshError::NodeCount {
            cell: format!("line {}", cell.tag),
            group: group.into(),
            count: cell.nodes.len(),
            expected: "an edge has 2 or 3: end, end, middle",
        });
    }
    numbers.of("line", group, cell)
}

/// Returns a line by tags and positions, its middle node between the ends: nodes without elements are dropped.
fn along(mesh: &Mesh, nodes: &[usize]) -> Line {
    let in_order = nodes[..1].iter().chain(&nodes[2..]).chain(&nodes[1..2]);
    in_order.map(|&node| (mesh.node_tags[node], mesh.nodes[node])).collect()
}

/// The two end nodes in ascending order: the key of an edge, independent of its direction.
fn ends(nodes: &[usize]) -> [usize; 2] {
    [nodes[0].min(nodes[1]), nodes[0].max(nodes[1])]
}

/// Returns all element sides that coincide with one of the `wanted` edges: the element, and the nodes of the side in the order
/// with the element on the left.
fn adjacent_sides(mesh: &Mesh, wanted: impl Iterator<Item = [usize; 2]>) -> HashMap<[usize; 2], Vec<Edge>> {
    let mut sides: HashMap<_, Vec<Edge>> = wanted.map(|ends| (ends, Vec::new())).collect();
    for (number, element) in mesh.elements.iter().enumerate() {
        for side in 0..element.kind.corners() {
            let (corners, middle) = element.kind.edge(side);
            if let Some(found) = sides.get_mut(&ends(&corners.map(|corner| element.nodes[corner]))) {
                let nodes = corners.into_iter().chain(middle).map(|local| element.nodes[local]).collect();
                found.push(Edge { nodes, element: number });
            }
        }
    }
    sides
}

/// Returns the one side with which a line coincides, or both between two bodies.
fn edge(mesh: &Mesh, sides: &[Edge], line: &[usize], tag: u64, group: &str) -> Result<(Edge, Option<Edge>), MeshError> {
    let group = group.to_string();
    match sides {
        [] => Err(MeshError::EdgeOutside { line: tag, group }),
        [side, ..] if side.nodes.get(2) != line.get(2) => Err(MeshError::EdgeOrder { line: tag, group }),
        [side] => Ok((side.clone(), None)),
        [one, other, ..] => {
            let (first, second) = (body(mesh, one.element), body(mesh, other.element));
            if first == second {
                Err(MeshError::EdgeInside { line: tag, group, body: first })
            } else {
                Ok((one.clone(), Some(other.clone())))
            }
        }
    }
}

fn add_points(mesh: &mut Mesh, numbers: &NodeNumbers, sets: BTreeMap<String, Vec<RawCell>>) -> Result<(), MeshError> {
    for (name, cells) in sets {
        let mut nodes = Vec::with_capacity(cells.len());
        for cell in &cells {
            nodes.extend(numbers.of("point", &name, cell)?);
        }
        nodes.sort_unstable();
        nodes.dedup();
        mesh.groups.insert(name, Group::Nodes(nodes));
    }
    Ok(())
}

/// Removes nodes without an element, which would be equations without stiffness; only named points may be isolated.
fn drop_unused_nodes(mesh: &mut Mesh) {
    let mut number = vec![0; mesh.nodes.len()];
    let mut kept = 0;
    for (old, _) in used_nodes(mesh).into_iter().enumerate().filter(|&(_, used)| used) {
        number[old] = kept;
        mesh.nodes[kept] = mesh.nodes[old];
        mesh.node_tags[kept] = mesh.node_tags[old];
        kept += 1;
    }
    mesh.nodes.truncate(kept);
    mesh.node_tags.truncate(kept);
    renumber_nodes(mesh, &number);
}

fn used_nodes(mesh: &Mesh) -> Vec<bool> {
    let mut used = vec![false; mesh.nodes.len()];
    let points = mesh.groups.values().filter_map(|group| match group {
        Group::Nodes(nodes) => Some(nodes),
        _ => None,
    });
    mesh.elements.iter().map(|element| &element.nodes).chain(points).flatten().for_each(|&node| used[node] = true);
    used
}

fn renumber_nodes(mesh: &mut Mesh, number: &[usize]) {
    let renumber = |nodes: &mut Vec<usize>| nodes.iter_mut().for_each(|node| *node = number[*node]);
    mesh.elements.iter_mut().for_each(|element| renumber(&mut element.nodes));
    mesh.between.values_mut().flatten().for_each(|side| renumber(&mut side.other.nodes));
    for group in mesh.groups.values_mut() {
        match group {
            Group::Elements(_) | Group::Lines(_) => {}
            Group::Edges(edges) => edges.iter_mut().for_each(|edge| renumber(&mut edge.nodes)),
            Group::Nodes(nodes) => renumber(nodes),
        }
    }
}

/// A mesh as read. Cells refer to their nodes by tag; nothing is checked.
#[derive(Debug, Default)]
pub(super) struct RawMesh {
    /// tag and position of each node
    pub nodes: Vec<(u64, Vector2<f64>)>,
    /// elements by body
    pub bodies: BTreeMap<String, Vec<RawCell>>,
    /// lines by name of the curve
    pub edges: BTreeMap<String, Vec<RawCell>>,
    /// points as cells of one node, by name of the set
    pub points: BTreeMap<String, Vec<RawCell>>,
}

/// A solid element, a line or a point: its own tag and those of its nodes.
#[derive(Clone, Debug)]
pub(super) struct RawCell {
    pub tag: u64,
    pub nodes: Vec<u64>,
}

/// Largest coordinate of a node; squares of lengths up to it are finite [L].
const FARTHEST: f64 = 1e100;

/// Map from node tags to node numbers.
struct NodeNumbers(HashMap<u64, usize>);

impl NodeNumbers {
    /// Numbers nodes by tag, in the given order.
    pub(super) fn new(nodes: &[(u64, Vector2<f64>)]) -> Result<Self, MeshError> {
        let mut numbers = HashMap::with_capacity(nodes.len());
        for (number, (tag, at)) in nodes.iter().enumerate() {
            if !at.iter().all(|x| x.abs() <= FARTHEST) {
                return Err(MeshError::TooFar(*tag, at[at.iamax()]));
            }
            if numbers.insert(*tag, number).is_some() {
                return Err(MeshError::SameNodeTag(*tag));
            }
        }
        Ok(Self(numbers))
    }

    /// Returns the numbers of the nodes of a cell; `what` ("element", "line", "point") and `group` are for the message.
    pub(super) fn of(&self, what: &str, group: &str, cell: &RawCell) -> Result<Vec<usize>, MeshError> {
        let number = |&node: &u64| {
            self.0.get(&node).copied().ok_or_else(|| MeshError::UnknownNode {
                cell: format!("{what} {}", cell.tag),
                group: group.into(),
                node,
            })
        };
        cell.nodes.iter().map(number).collect()
    }
}

/// Smallest side of an element, as a fraction of its size; the strain along a shorter one would be dominated by round-off.
const SHORT: f64 = 1e-8;

/// Largest round-off of the positions, as a fraction of a side, for which the shape of an element is defined.
const VAGUE: f64 = 1e-3;

/// Refuses an element of a group, with the tags of its nodes.
fn refuse(
    element: &Element,
    tag: u64,
    group: &str,
    positions: &[Vector2<f64>],
    node_tags: &[u64],
) -> Result<(), MeshError> {
    let corners = &element.nodes[..element.kind.corners()];
    let ends = || corners.iter().zip(corners.iter().cycle().skip(1));
    let length = |(a, b): &(&usize, &usize)| (positions[**b] - positions[**a]).norm();
    let size = ends().map(|side| length(&side)).fold(0.0, f64::max);
    let Some((a, b)) = ends().min_by(|one, other| length(one).total_cmp(&length(other))) else { return Ok(()) };
    let (shortest, group, ends) = (length(&(a, b)), group.to_string(), [*a, *b].map(|node| node_tags[node]));
    if shortest <= SHORT * size {
        return Err(MeshError::ShortSide { element: tag, group, ends, length: shortest, size });
    }
    let known = f64::EPSILON * corners.iter().fold(0.0, |most: f64, &node| most.max(positions[node].amax()));
    match known <= VAGUE * shortest {
        true => Ok(()),
        false => Err(MeshError::Vague { element: tag, group, known, side: shortest }),
    }
}
