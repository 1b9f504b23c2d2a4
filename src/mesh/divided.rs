//! Division of every element into four of its kind.
//!
//! ```text
//! quadrilateral   corners at ξ, η = −1, 0, 1       its quarters
//! triangle        corners at ξ, η = 0, ½, 1        three like it at its corners, and the middle one, turned
//! ```
//! New nodes lie where the element's own shape functions place them, so that neighbours agree, straight sides stay straight and quadratic
//! ones keep their parabolas: a boundary is the one that the mesh has, not the circle that it may stand for.

use std::collections::BTreeMap;

use nalgebra::Vector2;

use super::{Edge, Element, ElementKind, Group, InlineMesh, Mesh, MeshError};

/// Position in an element in quarters of its sides: (ξ, η) = (i, j)/4 in a triangle, (i, j)/2 − 1 in a quadrilateral.
type Quarter = [usize; 2];

/// Corners of the parts of an element; the nodes between two of them lie halfway.
const OF_QUADRILATERAL: [&[Quarter]; 4] = [
    &[[0, 0], [2, 0], [2, 2], [0, 2]],
    &[[2, 0], [4, 0], [4, 2], [2, 2]],
    &[[2, 2], [4, 2], [4, 4], [2, 4]],
    &[[0, 2], [2, 2], [2, 4], [0, 4]],
];
const OF_TRIANGLE: [&[Quarter]; 4] =
    [&[[0, 0], [2, 0], [0, 2]], &[[2, 0], [4, 0], [2, 2]], &[[0, 2], [2, 2], [0, 4]], &[[2, 2], [0, 2], [2, 0]]];

/// A node of the finer mesh.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Place {
    /// On the side between two nodes, the lower first, so many quarters from that
    Side([usize; 2], usize),
    /// Inside of an element
    Inside(usize, Quarter),
}

/// The nodes of the finer mesh: those of the coarse one, then the new ones.
struct Nodes {
    at: Vec<[f64; 2]>,
    new: BTreeMap<Place, usize>,
}

impl Nodes {
    /// The node at a place, made by `at` if it is new.
    fn node(&mut self, place: Place, at: impl FnOnce() -> Vector2<f64>) -> usize {
        *self.new.entry(place).or_insert_with(|| {
            self.at.push(at().into());
            self.at.len() - 1
        })
    }

    /// The node so many quarters along a side from its first end; `middle` is that of a quadratic element.
    fn on_side(&mut self, ends: [usize; 2], middle: Option<usize>, quarter: usize) -> usize {
        match (quarter, middle) {
            (0, _) => return ends[0],
            (4, _) => return ends[1],
            (2, Some(middle)) => return middle,
            _ => {}
        }
        let ([low, high], quarter) =
            if ends[0] < ends[1] { (ends, quarter) } else { ([ends[1], ends[0]], 4 - quarter) };
        let [a, b] = [low, high].map(|node| Vector2::from(self.at[node]));
        let s = quarter as f64 / 4.0;
        let straight = a.lerp(&b, s);
        let bulge = middle.map_or(Vector2::zeros(), |middle| Vector2::from(self.at[middle]) - 0.5 * (a + b));
        self.node(Place::Side([low, high], quarter), || straight + bulge * (4.0 * s * (1.0 - s)))
    }

    /// The node of an element at a place in it.
    fn in_element(&mut self, number: usize, Element { kind, nodes }: &Element, at: Quarter) -> usize {
        if let Some((side, quarter)) = side_at(*kind, at) {
            let ([start, end], middle) = kind.edge(side);
            return self.on_side([nodes[start], nodes[end]], middle.map(|middle| nodes[middle]), quarter);
        }
        if *kind == ElementKind::Q9 && at == [2, 2] {
            return nodes[8];
        }
        let reference = at.map(|quarter| match kind.corners() {
            3 => quarter as f64 / 4.0,
            _ => quarter as f64 / 2.0 - 1.0,
        });
        let places: Vec<Vector2<f64>> = nodes.iter().map(|&node| Vector2::from(self.at[node])).collect();
        let position = || kind.values(reference).iter().zip(&places).map(|(value, place)| place * *value).sum();
        self.node(Place::Inside(number, at), position)
    }
}

/// The side of an element on which a place lies, and how far along it.
fn side_at(kind: ElementKind, [i, j]: Quarter) -> Option<(usize, usize)> {
    match kind.corners() {
        3 if j == 0 => Some((0, i)),
        3 if i + j == 4 => Some((1, j)),
        3 if i == 0 => Some((2, 4 - j)),
        4 if j == 0 => Some((0, i)),
        4 if i == 4 => Some((1, j)),
        4 if j == 4 => Some((2, 4 - i)),
        4 if i == 0 => Some((3, 4 - j)),
        _ => None,
    }
}

/// The nodes of a part of an element, in the order of its kind, by their places.
fn places(kind: ElementKind, corners: &[Quarter]) -> Vec<Quarter> {
    let n = corners.len();
    let halfway = |a: Quarter, b: Quarter| [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
    let middles = (0..n).map(|k| halfway(corners[k], corners[(k + 1) % n]));
    let all = corners.iter().copied().chain(middles).chain([halfway(corners[0], corners[2])]);
    all.take(kind.nodes()).collect()
}

impl Mesh {
    /// Returns the mesh with every element divided into four of its kind. Named sides are divided with them; named nodes and outlines of
    /// rigid bodies stay as they are.
    ///
    /// # Errors
    /// Returns [`MeshError::SideOfNodes`] if a group of nodes holds both ends of a boundary edge: whether nodes between them belong to it
    /// cannot be told.
    pub fn divided(&self) -> Result<InlineMesh, MeshError> {
        let mut finer = Nodes { at: self.nodes.iter().map(|node| [node.x, node.y]).collect(), new: BTreeMap::new() };
        let mut mesh = InlineMesh::default();
        for (name, group) in &self.groups {
            match group {
                Group::Elements(list) => {
                    let parts = list.iter().flat_map(|&e| self.parts_of(e, &mut finer)).collect();
                    mesh.elements.insert(name.clone(), parts);
                }
                Group::Edges(edges) => {
                    let halves = edges.iter().flat_map(|edge| halves(edge, &mut finer)).collect();
                    mesh.edges.insert(name.clone(), halves);
                }
                Group::Nodes(nodes) => {
                    self.check_single(name, nodes)?;
                    mesh.points.insert(name.clone(), nodes.clone());
                }
                Group::Lines(lines) => {
                    mesh.edges.insert(name.clone(), outline(lines, &mut finer.at));
                }
            }
        }
        mesh.nodes = finer.at;
        Ok(mesh)
    }

    fn parts_of(&self, number: usize, finer: &mut Nodes) -> Vec<Vec<usize>> {
        let element = &self.elements[number];
        let parts = if element.kind.corners() == 3 { OF_TRIANGLE } else { OF_QUADRILATERAL };
        let part = |corners: &[Quarter], finer: &mut Nodes| {
            places(element.kind, corners).into_iter().map(|at| finer.in_element(number, element, at)).collect()
        };
        parts.iter().map(|corners| part(corners, finer)).collect()
    }

    /// Refuses a group of nodes that stands for a side.
    fn check_single(&self, name: &str, group: &[usize]) -> Result<(), MeshError> {
        let constrained = |node: usize| group.binary_search(&node).is_ok();
        let sides = self.elements.iter().flat_map(|Element { kind, nodes }| {
            (0..kind.corners()).map(|side| kind.edge(side).0.map(|local| nodes[local]))
        });
        match sides.into_iter().find(|ends| ends.iter().all(|&end| constrained(end))) {
            None => Ok(()),
            Some(ends) => {
                Err(MeshError::SideOfNodes { group: name.into(), nodes: ends.map(|end| self.node_tags[end]) })
            }
        }
    }
}

/// The halves of a boundary edge.
fn halves(Edge { nodes, .. }: &Edge, finer: &mut Nodes) -> [Vec<usize>; 2] {
    let (ends, middle) = ([nodes[0], nodes[1]], nodes.get(2).copied());
    let mut at = |quarter| finer.on_side(ends, middle, quarter);
    match middle {
        None => [vec![ends[0], at(2)], vec![at(2), ends[1]]],
        Some(middle) => [vec![ends[0], middle, at(1)], vec![middle, ends[1], at(3)]],
    }
}

/// The lines of an outline, whose nodes are those of no element.
fn outline(lines: &[super::outline::Line], at: &mut Vec<[f64; 2]>) -> Vec<Vec<usize>> {
    let mut known = BTreeMap::new();
    let mut node = |&(tag, position): &(u64, Vector2<f64>)| {
        *known.entry(tag).or_insert_with(|| {
            at.push(position.into());
            at.len() - 1
        })
    };
    // A line is [end, end, middle] in the case, and in the order of its nodes here.
    let in_order = |line: Vec<usize>| match line[..] {
        [start, middle, end] => vec![start, end, middle],
        _ => line,
    };
    lines.iter().map(|line| in_order(line.iter().map(&mut node).collect())).collect()
}
