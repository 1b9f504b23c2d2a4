//! The parsed gmsh file: from entities to named groups.

use std::collections::{BTreeMap, HashMap};

use mshio::mshfile::{self, ElementType, Entities, MshFile, Node, NodeBlock, Nodes};
use nalgebra::Vector2;

use super::bytes::Names;
use crate::mesh::MeshError;
use crate::mesh::raw::{RawCell, RawMesh};

type ElementBlock = mshfile::ElementBlock<u64, i32>;

pub(super) fn assemble(
    file: MshFile<u64, i32, f64>,
    names: &Names,
    node_count: u64,
    element_count: u64,
) -> Result<RawMesh, MeshError> {
    let entities = file.data.entities.ok_or(MeshError::NoSection("Entities"))?;
    let nodes = file.data.nodes.ok_or(MeshError::NoSection("Nodes"))?;
    let blocks = file.data.elements.ok_or(MeshError::NoSection("Elements"))?.element_blocks;
    check_total("Nodes", node_count, nodes.node_blocks.iter().map(|block| block.nodes.len()).sum())?;
    check_total("Elements", element_count, blocks.iter().map(|block| block.elements.len()).sum())?;
    blocks.iter().try_for_each(check_element_type)?;

    let groups = groups_of_entities(&entities, names);
    check_bodies(&blocks, &groups)?;
    let mut raw = RawMesh { nodes: plane_nodes(nodes)?, ..named_groups(names)? };
    blocks.iter().for_each(|block| add_block(&mut raw, block, &groups));
    Ok(raw)
}

fn check_total(section: &'static str, claimed: u64, found: usize) -> Result<(), MeshError> {
    if claimed == found as u64 { Ok(()) } else { Err(MeshError::WrongCount { section, claimed, found }) }
}

fn check_element_type(block: &ElementBlock) -> Result<(), MeshError> {
    let Some(element) = block.elements.first().map(|element| element.element_tag) else { return Ok(()) };
    match dimension(block.element_type) {
        Some(dimension) if dimension == block.entity_dim => Ok(()),
        Some(dimension) => Err(MeshError::Malformed {
            at: format!("element {element}"),
            what: format!("its dimension is {dimension}, that of its entity {}", block.entity_dim),
        }),
        None => Err(MeshError::UnsupportedElement {
            element,
            kind: format!("{:?}", block.element_type),
            number: block.element_type as i32,
        }),
    }
}

/// Dimension of the element types that are read.
fn dimension(kind: ElementType) -> Option<i32> {
    match kind {
        ElementType::Pnt => Some(0),
        ElementType::Lin2 | ElementType::Lin3 => Some(1),
        ElementType::Tri3 | ElementType::Tri6 | ElementType::Qua4 | ElementType::Qua8 | ElementType::Qua9 => Some(2),
        _ => None,
    }
}

/// The names of the physical groups that an entity (dimension, tag) belongs to.
type EntityGroups = HashMap<(i32, i32), Vec<String>>;

fn groups_of_entities(entities: &Entities<i32, f64>, names: &Names) -> EntityGroups {
    // A negative physical tag only says that the group takes the entity reversed.
    let name =
        |dimension: i32, tag: u32| names.get(&(dimension, tag)).cloned().unwrap_or_else(|| format!("physical_{tag}"));
    let points = entities.points.iter().map(|point| (0, point.tag, &point.physical_tags));
    let curves = entities.curves.iter().map(|curve| (1, curve.tag, &curve.physical_tags));
    let surfaces = entities.surfaces.iter().map(|surface| (2, surface.tag, &surface.physical_tags));
    points
        .chain(curves)
        .chain(surfaces)
        .map(|(dim, tag, physical)| ((dim, tag), physical.iter().map(|tag| name(dim, tag.unsigned_abs())).collect()))
        .collect()
}

fn groups_of<'a>(block: &ElementBlock, groups: &'a EntityGroups) -> &'a [String] {
    groups.get(&(block.entity_dim, block.entity_tag)).map_or(&[], Vec::as_slice)
}

/// Every solid element belongs to exactly one body.
fn check_bodies(blocks: &[ElementBlock], groups: &EntityGroups) -> Result<(), MeshError> {
    let (mut count, mut first_without) = (0, None);
    for block in blocks.iter().filter(|block| block.entity_dim == 2) {
        let Some(element) = block.elements.first().map(|element| element.element_tag) else { continue };
        match groups_of(block, groups) {
            [_] => {}
            [] => {
                count += block.elements.len();
                first_without.get_or_insert(element);
            }
            [first, second, ..] => {
                return Err(MeshError::TwoBodies { element, first: first.clone(), second: second.clone() });
            }
        }
    }
    first_without.map_or(Ok(()), |first| Err(MeshError::NoBody { count, first }))
}

/// A mesh with the groups that have a name, all still empty, so that one without elements is noticed.
fn named_groups(names: &Names) -> Result<RawMesh, MeshError> {
    let mut raw = RawMesh::default();
    for ((dimension, _), name) in names {
        let Some(groups) = groups_of_dimension(&mut raw, *dimension) else { continue };
        if groups.insert(name.clone(), Vec::new()).is_some() {
            return Err(MeshError::SameName(name.clone()));
        }
    }
    Ok(raw)
}

fn groups_of_dimension(raw: &mut RawMesh, dimension: i32) -> Option<&mut BTreeMap<String, Vec<RawCell>>> {
    match dimension {
        0 => Some(&mut raw.points),
        1 => Some(&mut raw.edges),
        2 => Some(&mut raw.bodies),
        _ => None,
    }
}

/// Adds the elements of one block to the groups of its entity; curves and points outside all groups are of no use.
fn add_block(raw: &mut RawMesh, block: &ElementBlock, groups: &EntityGroups) {
    let Some(named) = groups_of_dimension(raw, block.entity_dim) else { return };
    for name in groups_of(block, groups) {
        let cells =
            block.elements.iter().map(|element| RawCell { tag: element.element_tag, nodes: element.nodes.clone() });
        named.entry(name.clone()).or_default().extend(cells);
    }
}

/// The nodes with their tags, if they all have the same z.
fn plane_nodes(nodes: Nodes<u64, i32, f64>) -> Result<Vec<(u64, Vector2<f64>)>, MeshError> {
    let mut tagged = Vec::new();
    for block in &nodes.node_blocks {
        tagged.extend(node_tags(block, nodes.min_node_tag)?.into_iter().zip(&block.nodes));
    }
    check_plane(&tagged)?;
    Ok(tagged.into_iter().map(|(tag, node)| (tag, Vector2::new(node.x, node.y))).collect())
}

/// The tags of a block's nodes in their order; `mshio` gives none if all of the mesh is one node.
fn node_tags(block: &NodeBlock<u64, i32, f64>, only_tag: u64) -> Result<Vec<u64>, MeshError> {
    let count = block.nodes.len();
    let mut tags: Vec<(usize, u64)> = match &block.node_tags {
        Some(tags) => tags.iter().map(|(&tag, &place)| (place, tag)).collect(),
        None => vec![(0, only_tag); count.min(1)],
    };
    if tags.len() != count {
        return Err(MeshError::Malformed {
            at: format!("the nodes of entity {} of dimension {}", block.entity_tag, block.entity_dim),
            what: "node tags are repeated, or outside the range in the header".into(),
        });
    }
    tags.sort_unstable();
    Ok(tags.into_iter().map(|(_, tag)| tag).collect())
}

fn check_plane(nodes: &[(u64, &Node<f64>)]) -> Result<(), MeshError> {
    let Some(&(first, origin)) = nodes.first() else { return Ok(()) };
    let extent = nodes.iter().map(|(_, node)| (node.x - origin.x).hypot(node.y - origin.y)).fold(0.0, f64::max);
    let in_plane = |z: f64| (z - origin.z).abs() <= 1e-9 * extent;
    match nodes.iter().skip(1).find(|(_, node)| !in_plane(node.z)) {
        Some(&(node, &Node { z, .. })) => Err(MeshError::NotPlane { first, first_z: origin.z, node, z }),
        None => Ok(()),
    }
}
