//! Reader of gmsh meshes in the formats MSH 4.1, ASCII or binary, and MSH 2.2, ASCII (`msh2.rs`).
//!
//! The `mshio` crate parses the sections of 4.1. This file checks what `mshio` does not (the format line, the
//! presence of the sections, the counts in their headers) and reads the names of the physical groups, which it skips.
//!
//! The bytes of a file are checked before they are parsed.
//!
//! The entities of the parsed file become named groups.

mod entities;
mod msh2;

use std::collections::{BTreeMap, HashMap};
use std::fs;
use std::ops::Range;
use std::path::Path;

use memchr::memmem;
use mshio::mshfile::{self, ElementType, Entities, MshFile, NodeBlock, Nodes};
use nalgebra::Vector2;

use crate::mesh::check::{RawCell, RawMesh};
use crate::mesh::{Mesh, MeshError, check};

/// Reads the mesh of a gmsh file: bodies are its physical surfaces, edge groups its physical curves, node groups its physical
/// points. A physical group without a name is called `physical_<tag>`. In a file without physical groups every entity is a group:
/// `surface_1`, `curve_5`, `point_3`.
///
/// # Errors
/// Returns [`MeshError::InFile`] with the file, the defect and its remedy if the file is not a valid mesh.
pub fn read(path: &Path) -> Result<Mesh, MeshError> {
    load(path).and_then(from_bytes).map_err(|cause| MeshError::InFile { file: path.into(), cause: Box::new(cause) })
}

/// Reads the mesh from the content of a gmsh file, as [`read`].
///
/// # Errors
/// Returns [`MeshError`] if the content is not a valid mesh.
pub fn from_bytes(bytes: Vec<u8>) -> Result<Mesh, MeshError> {
    parse(bytes).and_then(check::finish)
}

fn load(path: &Path) -> Result<Vec<u8>, MeshError> {
    let kind = fs::metadata(path).map_err(refusal)?;
    if kind.is_dir() {
        return Err(MeshError::NotAFile("folder"));
    }
    if !kind.is_file() {
        return Err(MeshError::NotAFile("device"));
    }
    fs::read(path).map_err(refusal)
}

fn refusal(error: std::io::Error) -> MeshError {
    match error.kind() {
        std::io::ErrorKind::NotFound => MeshError::NoFile,
        _ => MeshError::Unreadable(error),
    }
}

fn parse(mut bytes: Vec<u8>) -> Result<RawMesh, MeshError> {
    let encoding = match format(&bytes)? {
        Format::Msh2 => return msh2::parse(&bytes),
        Format::Msh4(encoding) => encoding,
    };
    checked_count(&bytes, encoding, "Entities")?;
    let node_count = checked_count(&bytes, encoding, "Nodes")?;
    let element_count = checked_count(&bytes, encoding, "Elements")?;
    if node_count == 0 || element_count == 0 {
        return Err(MeshError::NoElements);
    }
    let names = physical_names(&bytes)?;
    keep_node_tags(&mut bytes, encoding)?;
    let file = mshio::parse_msh_bytes(&bytes).map_err(|error| explain(&bytes, encoding, &error))?;
    assemble(file, &names, node_count, element_count)
}

/// Supported formats.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Format {
    /// 2.2, ASCII
    Msh2,
    /// 4.1
    Msh4(Encoding),
}

/// Encoding of the numbers in the file.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// Determines the format from the first two lines, `$MeshFormat` and `2.2 0 8` or `4.1 (0 ASCII | 1 binary) 8`; in a binary
/// file an integer 1 follows.
fn format(bytes: &[u8]) -> Result<Format, MeshError> {
    let mut lines = bytes.splitn(3, |&b| b == b'\n');
    if lines.next().map(<[u8]>::trim_ascii) != Some(b"$MeshFormat") {
        return Err(MeshError::NotGmsh);
    }
    let line = String::from_utf8_lossy(lines.next().unwrap_or_default().trim_ascii()).into_owned();
    let one = lines.next().and_then(|rest| rest.first_chunk::<4>()).copied().unwrap_or_default();
    let words: Vec<&str> = line.split_whitespace().collect();
    match words[..] {
        ["2.2", "0", "8"] => Ok(Format::Msh2),
        ["4.1", "0", "8"] => Ok(Format::Msh4(Encoding::Ascii)),
        ["4.1", "1", "8"] if i32::from_le_bytes(one) == 1 => Ok(Format::Msh4(Encoding::LittleEndian)),
        ["4.1", "1", "8"] if i32::from_be_bytes(one) == 1 => Ok(Format::Msh4(Encoding::BigEndian)),
        [version, _, _] if !["2.2", "4.1"].contains(&version) && version.parse::<f64>().is_ok() => {
            Err(MeshError::Version(version.into()))
        }
        _ => Err(MeshError::Format(line.chars().take(40).collect())),
    }
}

/// Byte range of the content of a section, if the file has it.
fn section(bytes: &[u8], name: &'static str) -> Result<Option<Range<usize>>, MeshError> {
    let after_line = |from: usize, wanted: &str| {
        let mut end = from;
        bytes[from..].split_inclusive(|&b| b == b'\n').find_map(|line| {
            end += line.len();
            (line.trim_ascii() == wanted.as_bytes()).then_some(end - line.len()..end)
        })
    };
    let Some(begin) = after_line(0, &format!("${name}")) else { return Ok(None) };
    let end = after_line(begin.end, &format!("$End{name}")).ok_or(MeshError::Truncated(name))?;
    Ok(Some(begin.end..end.start))
}

/// Returns a section that must occur exactly once; otherwise the section that is checked could differ from the one that is
/// read.
fn required_section(bytes: &[u8], name: &'static str) -> Result<Range<usize>, MeshError> {
    let range = section(bytes, name)?.ok_or(MeshError::NoSection(name))?;
    let title = format!("${name}");
    let ends = memmem::find_iter(bytes, &title).map(|start| bytes.get(start + title.len()));
    if ends.filter(|next| next.is_none_or(u8::is_ascii_whitespace)).count() > 1 {
        return Err(MeshError::Malformed { at: title, what: "the file has this section more than once".into() });
    }
    Ok(range)
}

/// Number of nodes or elements in the header of a section (of curves, for the entities).
///
/// Refuses counts that the file is too small for. Only the counts are checked: the tags that follow them in the header of the
/// nodes and elements may have any value.
fn checked_count(bytes: &[u8], encoding: Encoding, name: &'static str) -> Result<u64, MeshError> {
    let content = &bytes[required_section(bytes, name)?];
    let counts = leading_numbers(content, encoding, if name == "Entities" { 4 } else { 2 });
    // The shortest entry, an element in ASCII, is four bytes long.
    if let Some(&claimed) = counts.iter().find(|&&count| count > bytes.len() as u64 / 4) {
        return Err(MeshError::ImpossibleCount { section: name, claimed, bytes: bytes.len() });
    }
    counts.get(1).copied().ok_or_else(|| MeshError::Malformed {
        at: format!("${name}"),
        what: "the section does not begin with its counts".into(),
    })
}

/// Returns up to `count` unsigned numbers at the start of a section; fewer if other content follows.
fn leading_numbers(content: &[u8], encoding: Encoding, count: usize) -> Vec<u64> {
    let binary = |convert: fn([u8; 8]) -> u64| content.as_chunks().0.iter().take(count).map(|&b| convert(b)).collect();
    match encoding {
        Encoding::LittleEndian => binary(u64::from_le_bytes),
        Encoding::BigEndian => binary(u64::from_be_bytes),
        Encoding::Ascii => content
            .split(u8::is_ascii_whitespace)
            .filter(|word| !word.is_empty())
            .take(count)
            .map_while(|word| std::str::from_utf8(word).ok()?.parse().ok())
            .collect(),
    }
}

/// Makes `mshio` keep every node tag.
///
/// It drops the tags when the header declares them contiguous, assuming that they are then in ascending order, which the
/// format does not guarantee. The header is therefore changed to announce one node; the true number is checked afterwards.
fn keep_node_tags(bytes: &mut [u8], encoding: Encoding) -> Result<(), MeshError> {
    let range = required_section(bytes, "Nodes")?;
    let content = &mut bytes[range];
    match encoding {
        Encoding::Ascii => {
            let mut words = content.split_mut(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
            if let Some([first, rest @ ..]) = words.nth(1) {
                *first = b'1';
                rest.fill(b' ');
            }
        }
        Encoding::LittleEndian => overwrite_second(content, 1u64.to_le_bytes()),
        Encoding::BigEndian => overwrite_second(content, 1u64.to_be_bytes()),
    }
    Ok(())
}

fn overwrite_second(content: &mut [u8], number: [u8; 8]) {
    if let Some(second) = content.as_chunks_mut().0.get_mut(1) {
        *second = number;
    }
}

/// Names of the physical groups by (dimension, tag).
type Names = HashMap<(i32, u32), String>;

/// Reads the section of names, which is text even in binary files.
fn physical_names(bytes: &[u8]) -> Result<Names, MeshError> {
    let Some(range) = section(bytes, "PhysicalNames")? else { return Ok(Names::new()) };
    let text = String::from_utf8_lossy(&bytes[range]);
    let lines = text.lines().map(str::trim).filter(|line| !line.is_empty()).skip(1);
    lines.map(|line| physical_name(line).ok_or_else(|| bad_name(line))).collect()
}

/// `dimension tag "name"`
fn physical_name(line: &str) -> Option<((i32, u32), String)> {
    let (dimension, rest) = line.split_once(char::is_whitespace)?;
    let (tag, name) = rest.trim_start().split_once(char::is_whitespace)?;
    let name = name.trim().strip_prefix('"')?.strip_suffix('"')?;
    Some(((dimension.parse().ok()?, tag.parse().ok()?), name.into()))
}

fn bad_name(line: &str) -> MeshError {
    MeshError::Malformed {
        at: "$PhysicalNames".into(),
        what: format!("`{}` is not of the form: dimension tag \"name\"", line.chars().take(80).collect::<String>()),
    }
}

/// Text at the position where the parser failed without a message.
fn unexpected(bytes: &[u8], offset: usize, encoding: Encoding) -> String {
    if encoding != Encoding::Ascii {
        return "the numbers there do not match the format".into();
    }
    let begin = bytes[..offset.min(bytes.len())].iter().rposition(|&b| b == b'\n').map_or(0, |end| end + 1);
    let line = bytes[begin..].split(|&b| b == b'\n').next().unwrap_or_default();
    let line: String = String::from_utf8_lossy(line).trim().chars().take(80).collect();
    match line.is_empty() {
        true => "the line is empty, where the format has numbers".into(),
        false => format!("`{line}` has more, fewer or other entries than the format has there"),
    }
}

/// Formats the parser's trace of errors (innermost first) in one line, with the position in the file.
fn explain(bytes: &[u8], encoding: Encoding, error: &mshio::MshParserError<&[u8]>) -> MeshError {
    let trace: Vec<String> = error.filter_msh_errors().map(|(_, kind)| kind.to_string()).collect();
    if trace.iter().any(|message| message.contains("parametric nodes")) {
        return MeshError::Parametric;
    }
    let rest = error.backtrace.first().map_or(0, |(rest, _)| rest.len());
    let offset = bytes.len().saturating_sub(rest);
    let at = match encoding {
        Encoding::Ascii => format!("line {}", 1 + bytes.iter().take(offset).filter(|&&b| b == b'\n').count()),
        _ => format!("byte {offset}"),
    };
    let messages = trace.into_iter().rev().filter(|message| !message.trim().is_empty()).collect::<Vec<_>>().join(", ");
    let what = if messages.is_empty() { unexpected(bytes, offset, encoding) } else { messages };
    MeshError::Malformed { at, what }
}

type ElementBlock = mshfile::ElementBlock<u64, i32>;

fn assemble(
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
    Ok(if has_physical(&entities) { raw } else { entities::usable(raw) })
}

/// Whether any entity belongs to a physical group.
fn has_physical(entities: &Entities<i32, f64>) -> bool {
    entities.points.iter().any(|point| !point.physical_tags.is_empty())
        || entities.curves.iter().any(|curve| !curve.physical_tags.is_empty())
        || entities.surfaces.iter().any(|surface| !surface.physical_tags.is_empty())
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

/// Dimension of the supported element types.
fn dimension(kind: ElementType) -> Option<i32> {
    match kind {
        ElementType::Pnt => Some(0),
        ElementType::Lin2 | ElementType::Lin3 => Some(1),
        ElementType::Tri3 | ElementType::Tri6 | ElementType::Qua4 | ElementType::Qua8 | ElementType::Qua9 => Some(2),
        _ => None,
    }
}

/// Names of the physical groups that an entity (dimension, tag) belongs to.
type EntityGroups = HashMap<(i32, i32), Vec<String>>;

fn groups_of_entities(entities: &Entities<i32, f64>, names: &Names) -> EntityGroups {
    if !has_physical(entities) {
        let of = |dimension: i32, tag: i32| ((dimension, tag), vec![entities::name(dimension, tag.into())]);
        let points = entities.points.iter().map(|point| of(0, point.tag));
        let curves = entities.curves.iter().map(|curve| of(1, curve.tag));
        return points.chain(curves).chain(entities.surfaces.iter().map(|surface| of(2, surface.tag))).collect();
    }
    // A negative physical tag only means that the group contains the entity reversed.
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

/// Checks that every solid element belongs to exactly one body.
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

/// Creates a mesh with all named groups, still empty, so that groups without elements are detected.
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

/// Adds the elements of one block to the groups of its entity; curves and points outside all groups are skipped.
fn add_block(raw: &mut RawMesh, block: &ElementBlock, groups: &EntityGroups) {
    let Some(named) = groups_of_dimension(raw, block.entity_dim) else { return };
    for name in groups_of(block, groups) {
        let cells =
            block.elements.iter().map(|element| RawCell { tag: element.element_tag, nodes: element.nodes.clone() });
        named.entry(name.clone()).or_default().extend(cells);
    }
}

/// Returns the nodes with their tags, if they all have the same z.
fn plane_nodes(nodes: Nodes<u64, i32, f64>) -> Result<Vec<(u64, Vector2<f64>)>, MeshError> {
    let mut tagged = Vec::new();
    for block in &nodes.node_blocks {
        tagged.extend(node_tags(block, nodes.min_node_tag)?.into_iter().zip(&block.nodes));
    }
    let tagged: Vec<(u64, [f64; 3])> = tagged.into_iter().map(|(tag, node)| (tag, [node.x, node.y, node.z])).collect();
    check_plane(&tagged)?;
    Ok(tagged.into_iter().map(|(tag, [x, y, _])| (tag, Vector2::new(x, y))).collect())
}

/// Tags of the nodes of a block, in order; `mshio` returns none if the mesh has a single node.
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

fn check_plane(nodes: &[(u64, [f64; 3])]) -> Result<(), MeshError> {
    let Some(&(first, [x0, y0, z0])) = nodes.first() else { return Ok(()) };
    let extent = nodes.iter().map(|(_, [x, y, _])| (x - x0).hypot(y - y0)).fold(0.0, f64::max);
    match nodes.iter().skip(1).find(|(_, [.., z])| (z - z0).abs() > 1e-9 * extent) {
        Some(&(node, [.., z])) => Err(MeshError::NotPlane { first, first_z: z0, node, z }),
        None => Ok(()),
    }
}
