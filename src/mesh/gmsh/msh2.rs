//! Sections of a file in format MSH 2.2, ASCII: nodes and elements, one per line; an element has the tag of its physical group.
//!
//! ```text
//! $Nodes                                  $Elements
//! number of nodes                         number of elements
//! tag x y z                               tag type number-of-tags physical elementary … node node …
//! ```

use super::{
    Names, check_plane, entities, groups_of_dimension, named_groups, physical_names, required_section, section,
};
use crate::mesh::MeshError;
use crate::mesh::check::{RawCell, RawMesh};

/// Supported element types by gmsh number: dimension, and number of nodes.
const TYPES: [(u32, i32, usize); 8] =
    [(15, 0, 1), (1, 1, 2), (8, 1, 3), (2, 2, 3), (9, 2, 6), (3, 2, 4), (16, 2, 8), (10, 2, 9)];

/// Parses the file; only its counts are checked.
pub fn parse(bytes: &[u8]) -> Result<RawMesh, MeshError> {
    if section(bytes, "ParametricNodes")?.is_some() {
        return Err(MeshError::Parametric);
    }
    let nodes = entries(bytes, "Nodes", node)?;
    let elements = entries(bytes, "Elements", element)?;
    if nodes.is_empty() || elements.is_empty() {
        return Err(MeshError::NoElements);
    }
    check_plane(&nodes)?;
    let names = physical_names(bytes)?;
    let mut raw = named_groups(&names)?;
    raw.nodes = nodes.into_iter().map(|(tag, [x, y, _])| (tag, [x, y].into())).collect();
    let is_grouped = !names.is_empty() || elements.iter().any(|element| element.physical != 0);
    if !is_grouped && elements.iter().any(|element| element.elementary != 0) {
        for Element { dimension, elementary, cell, .. } in elements {
            if let Some(groups) = groups_of_dimension(&mut raw, dimension) {
                groups.entry(entities::name(dimension, elementary)).or_default().push(cell);
            }
        }
        return Ok(entities::usable(raw));
    }
    check_bodies(&elements)?;
    elements.into_iter().filter(|element| element.physical != 0).for_each(|element| add(&mut raw, element, &names));
    Ok(raw)
}

/// An element line; physical group 0 means no group, elementary entity 0 that none is given.
struct Element {
    dimension: i32,
    physical: u32,
    elementary: i64,
    cell: RawCell,
}

/// Returns the entries of a section, as many as its count.
fn entries<T>(bytes: &[u8], name: &'static str, read: impl Fn(&[&str]) -> Result<T, Bad>) -> Result<Vec<T>, MeshError> {
    let range = required_section(bytes, name)?;
    let before = bytes[..range.start].iter().filter(|&&b| b == b'\n').count();
    let text = String::from_utf8_lossy(&bytes[range]);
    let mut lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    let malformed = |at: String, what: &str| MeshError::Malformed { at, what: what.into() };
    let count = lines.next().and_then(|(_, line)| line.trim().parse::<u64>().ok());
    let claimed = count
        .ok_or_else(|| malformed(format!("${name}"), "the section does not begin with the number of its entries"))?;
    let entry = |(k, line): (usize, &str)| {
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        read(&words).map_err(|bad| match bad {
            Bad::Line(what) => malformed(format!("line {}", before + k + 1), what),
            Bad::Element { element, number } => {
                MeshError::UnsupportedElement { element, kind: "kind that is not read".into(), number }
            }
        })
    };
    let found: Vec<T> = lines.map(entry).collect::<Result<_, _>>()?;
    match found.len() as u64 == claimed {
        true => Ok(found),
        false => Err(MeshError::WrongCount { section: name, claimed, found: found.len() }),
    }
}

/// Defect of a line.
enum Bad {
    Line(&'static str),
    /// Unsupported element type
    Element {
        element: u64,
        number: i32,
    },
}

fn node(words: &[&str]) -> Result<(u64, [f64; 3]), Bad> {
    let read = || {
        let [tag, x, y, z] = words else { return None };
        Some((tag.parse().ok()?, [x.parse().ok()?, y.parse().ok()?, z.parse().ok()?]))
    };
    read().ok_or(Bad::Line("a node is: tag x y z"))
}

fn element(words: &[&str]) -> Result<Element, Bad> {
    let bad = Bad::Line("an element is: tag type number-of-tags tags… nodes…");
    let numbers = words.iter().map(|word| word.parse::<i64>().ok()).collect::<Option<Vec<i64>>>();
    let Some([tag, kind, count, rest @ ..]) = numbers.as_deref() else { return Err(bad) };
    let (Ok(tag), Ok(number), Ok(count)) = (u64::try_from(*tag), i32::try_from(*kind), usize::try_from(*count)) else {
        return Err(bad);
    };
    let Some((_, dimension, expected)) = TYPES.into_iter().find(|(known, ..)| i64::from(*known) == *kind) else {
        return Err(Bad::Element { element: tag, number });
    };
    let Some((tags, nodes)) = rest.split_at_checked(count) else { return Err(bad) };
    if nodes.len() != expected {
        return Err(Bad::Line("an element has another number of nodes than its type"));
    }
    // A negative tag only means that the group contains the element reversed.
    let physical = tags
        .first()
        .map_or(Ok(0), |tag| u32::try_from(tag.unsigned_abs()))
        .map_err(|_| Bad::Line("a tag is too large"))?;
    let nodes = nodes.iter().map(|&node| u64::try_from(node)).collect::<Result<_, _>>();
    let nodes = nodes.map_err(|_| Bad::Line("a node has a negative tag"))?;
    let elementary = tags.get(1).copied().unwrap_or(0);
    Ok(Element { dimension, physical, elementary, cell: RawCell { tag, nodes } })
}

/// Checks that every solid element belongs to a body; an element of two bodies occurs twice and is found by the mesh check.
fn check_bodies(elements: &[Element]) -> Result<(), MeshError> {
    let without = || elements.iter().filter(|element| element.dimension == 2 && element.physical == 0);
    match without().next() {
        None => Ok(()),
        Some(first) => Err(MeshError::NoBody { count: without().count(), first: first.cell.tag }),
    }
}

fn add(raw: &mut RawMesh, Element { dimension, physical, cell, .. }: Element, names: &Names) {
    let name = names.get(&(dimension, physical)).cloned().unwrap_or_else(|| format!("physical_{physical}"));
    if let Some(groups) = groups_of_dimension(raw, dimension) {
        groups.entry(name).or_default().push(cell);
    }
}
