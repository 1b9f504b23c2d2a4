//! Meshes from arrays, from gmsh files and from what gmsh would write.

use std::collections::BTreeMap;
use std::path::PathBuf;

use fecontact::case;
use fecontact::mesh::{Group, InlineMesh, Mesh as Checked, MeshError, gmsh};
use numpy::ndarray::Array2;
use numpy::{IntoPyArray, PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::errors::{case_error, complaint};
use crate::pool::Pool;

/// Lists of nodes of a group, each in one array a kind.
type Lists<'py> = BTreeMap<String, Vec<PyReadonlyArray2<'py, i64>>>;

/// A checked mesh.
#[pyclass(frozen, module = "fecontact._native")]
pub struct Mesh {
    pub mesh: Checked,
}

#[pymethods]
impl Mesh {
    /// From nodes (n, 2) and, by name, arrays (m, nodes of each) of elements, edges and points.
    #[new]
    fn new(py: Python, nodes: PyReadonlyArray2<f64>, elements: Lists, edges: Lists, points: Lists) -> PyResult<Self> {
        let nodes = nodes.as_array().rows().into_iter().map(|row| [row[0], row[1]]).collect();
        let flat = |lists: BTreeMap<String, Vec<Vec<usize>>>| {
            lists.into_iter().map(|(name, list)| (name, list.into_iter().flatten().collect())).collect()
        };
        let inline = InlineMesh {
            nodes,
            elements: lists(py, "elements", &elements)?,
            edges: lists(py, "edges", &edges)?,
            points: flat(lists(py, "points", &points)?),
        };
        checked(py, Pool::new(Some(1))?.short(py, || inline.build())?)
    }

    /// From the content of a gmsh file.
    #[staticmethod]
    fn from_bytes(py: Python, bytes: Vec<u8>) -> PyResult<Self> {
        checked(py, Pool::new(Some(1))?.short(py, || gmsh::from_bytes(bytes))?)
    }

    /// From blocks, as a case has them.
    #[staticmethod]
    fn from_blocks(py: Python, text: &str) -> PyResult<Self> {
        let mesh = Pool::new(Some(1))?.short(py, || case::blocks_from_text(text))?;
        mesh.map(|mesh| Mesh { mesh }).map_err(|error| case_error(py, &error))
    }

    /// From a gmsh file.
    #[staticmethod]
    fn read(py: Python, path: PathBuf) -> PyResult<Self> {
        checked(py, Pool::new(Some(1))?.short(py, || gmsh::read(&path))?)
    }

    /// Several meshes as one.
    #[staticmethod]
    fn join(py: Python, meshes: Vec<PyRef<Self>>) -> PyResult<Self> {
        checked(py, Checked::join(meshes.iter().map(|mesh| mesh.mesh.clone())))
    }

    /// Positions (n, 2).
    fn nodes<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        let nodes = &self.mesh.nodes;
        Array2::from_shape_fn((nodes.len(), 2), |(node, component)| nodes[node][component]).into_pyarray(py)
    }

    /// Nodes of every element.
    fn elements(&self) -> Vec<Vec<usize>> {
        self.mesh.elements.iter().map(|element| element.nodes.clone()).collect()
    }

    /// Kind and members of every group: numbers of elements or nodes, or the nodes of edges.
    fn groups(&self) -> BTreeMap<String, (&'static str, Vec<Vec<usize>>)> {
        let described = |group: &Group| match group {
            Group::Elements(numbers) => ("elements", vec![numbers.clone()]),
            Group::Edges(edges) => ("edges", edges.iter().map(|edge| edge.nodes.clone()).collect()),
            Group::Nodes(nodes) => ("points", vec![nodes.clone()]),
            Group::Lines(_) => ("lines", Vec::new()),
        };
        self.mesh.groups.iter().map(|(name, group)| (name.clone(), described(group))).collect()
    }

    /// Positions of the nodes of every line that is side of no element, end, end and perhaps middle, by group.
    fn lines(&self) -> BTreeMap<String, Vec<Vec<[f64; 2]>>> {
        let mut described = BTreeMap::new();
        for (name, group) in &self.mesh.groups {
            let Group::Lines(lines) = group else { continue };
            let places = lines.iter().map(|line| {
                let ends = [0, line.len() - 1].into_iter().chain((line.len() == 3).then_some(1));
                ends.map(|k| [line[k].1.x, line[k].1.y]).collect()
            });
            described.insert(name.clone(), places.collect());
        }
        described
    }
}

fn checked(py: Python, mesh: Result<Checked, MeshError>) -> PyResult<Mesh> {
    mesh.map(|mesh| Mesh { mesh }).map_err(|error| complaint(py, "mesh", "", error))
}

/// Node numbers, none of which may be negative.
fn lists(py: Python, kind: &str, given: &Lists) -> PyResult<BTreeMap<String, Vec<Vec<usize>>>> {
    let mut lists = BTreeMap::new();
    for (name, arrays) in given {
        let mut list = Vec::new();
        for row in arrays
            .iter()
            .flat_map(|array| array.as_array().rows().into_iter().map(|row| row.to_vec()).collect::<Vec<_>>())
        {
            let number = |&node: &i64| {
                let message = || format!("the node {node} is negative: nodes are numbered from 0");
                usize::try_from(node).map_err(|_| complaint(py, "mesh", &format!("{kind}.{name}"), message()))
            };
            list.push(row.iter().map(number).collect::<PyResult<_>>()?);
        }
        lists.insert(name.clone(), list);
    }
    Ok(lists)
}
