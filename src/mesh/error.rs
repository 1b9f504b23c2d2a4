//! Errors of meshes, with their remedies.

use std::io;
use std::path::PathBuf;

use thiserror::Error;

use super::names::in_line;

/// Reason why a mesh was refused.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum MeshError {
    /// Another error, with its file.
    #[error("{}: {cause}", in_line(&file.to_string_lossy()))]
    InFile {
        /// the mesh file
        file: PathBuf,
        /// the error
        cause: Box<MeshError>,
    },

    /// There is no file at this path.
    #[error("there is no such mesh file; check the path")]
    NoFile,
    /// The path refers to a folder or a device.
    #[error("this is not a file but a {0}; name the .msh file itself")]
    NotAFile(&'static str),
    /// The system does not allow reading.
    #[error("the mesh file cannot be read: {0}")]
    Unreadable(io::Error),

    /// The file is not a gmsh mesh.
    #[error("this is not a gmsh mesh: it does not begin with $MeshFormat; {EXPORT}")]
    NotGmsh,
    /// The gmsh mesh has an unsupported version.
    #[error("the mesh is in MSH format {0}, and only 4.1 and 2.2 are read; {EXPORT}")]
    Version(String),
    /// The line below `$MeshFormat` is invalid.
    #[error("the format line of the mesh is `{0}`, where `4.1 0 8`, `4.1 1 8` or `2.2 0 8` was expected; {EXPORT}")]
    Format(String),
    /// A section is missing.
    #[error("the mesh has no ${0} section: the file is incomplete or was cut short; {EXPORT}")]
    NoSection(&'static str),
    /// A section has no end.
    #[error("the ${0} section has no $End{0}: the file was cut short; {EXPORT}")]
    Truncated(&'static str),
    /// A count exceeds what the file can hold.
    #[error("the ${section} section claims {claimed} entries, more than a file of {bytes} bytes can hold; {EXPORT}")]
    ImpossibleCount {
        /// section without the dollar
        section: &'static str,
        /// count in its header
        claimed: u64,
        /// size of the file
        bytes: usize,
    },
    /// The header of a section and its blocks disagree.
    #[error("the ${section} section claims {claimed} entries but holds {found}; {EXPORT}")]
    WrongCount {
        /// section without the dollar
        section: &'static str,
        /// count in its header
        claimed: u64,
        /// sum over its blocks
        found: usize,
    },
    /// The parser failed.
    #[error("the mesh cannot be understood at {at}: {what}; {EXPORT}")]
    Malformed {
        /// line or byte
        at: String,
        /// what the parser was reading, and its message
        what: String,
    },
    /// Nodes are given by parametric coordinates on their curve or surface.
    #[error("the nodes carry parametric coordinates; export with Mesh.SaveParametric = 0")]
    Parametric,
    /// The mesh is not plane.
    #[error(
        "node {node} has z = {z} where node {first} has z = {first_z}: not a plane mesh; \
         all nodes must share one z, the model lies in x and y"
    )]
    NotPlane {
        /// tag of the first node
        first: u64,
        /// its z
        first_z: f64,
        /// tag of the node that differs
        node: u64,
        /// its z
        z: f64,
    },
    /// The solver does not have this element type.
    #[error(
        "element {element} is a {kind} (gmsh type {number}); only triangles with 3 or 6 nodes, quadrilaterals with \
         4, 8 or 9, lines with 2 or 3 and points are read: mesh in 2D with Mesh.ElementOrder = 1 or 2"
    )]
    UnsupportedElement {
        /// tag of the element
        element: u64,
        /// gmsh's name of the type
        kind: String,
        /// gmsh's number of the type
        number: i32,
    },
    /// Elements belong to no body.
    #[error(
        "{count} elements (the first is {first}) belong to no physical surface; put each surface into a \
         Physical Surface(\"name\"), or export without Mesh.SaveAll"
    )]
    NoBody {
        /// number of such elements
        count: usize,
        /// tag of the first
        first: u64,
    },
    /// An element belongs to two bodies.
    #[error(
        "element {element} belongs to the physical surfaces `{first}` and `{second}`; an element has one body: \
         take its surface out of one of them"
    )]
    TwoBodies {
        /// tag of the element
        element: u64,
        /// a body
        first: String,
        /// another one
        second: String,
    },

    /// The mesh has no elements.
    #[error("the mesh has no triangles or quadrilaterals, and no named points; mesh it in 2D (gmsh -2)")]
    NoElements,
    /// Two groups have the same name.
    #[error("two groups of the mesh are named `{0}`; give each its own name")]
    SameName(String),
    /// Groups of two joined meshes have the same name.
    #[error(
        "the group `{group}` is in mesh {} and in mesh {} of those that are joined; give each its own name",
        meshes[0] + 1, meshes[1] + 1
    )]
    InTwoMeshes {
        /// name of the group
        group: String,
        /// the two meshes, counted from 0
        meshes: [usize; 2],
    },
    /// A group of nodes holds both ends of a side of an element, and the mesh is to be refined.
    #[error(
        "the group `{group}` holds the nodes {} and {}, the ends of a side: it is unclear whether nodes between them \
         belong to it; name the side, not its nodes", nodes[0], nodes[1]
    )]
    SideOfNodes {
        /// name of the group
        group: String,
        /// tags of the two nodes
        nodes: [u64; 2],
    },
    /// A group has no members.
    #[error("the group `{0}` is empty; mesh what it names, or remove it")]
    EmptyGroup(String),
    /// Two nodes have the same tag.
    #[error("two nodes have the tag {0}; renumber the mesh")]
    SameNodeTag(u64),
    /// A coordinate is not finite, or too large to be squared.
    #[error("node {0} has the coordinate {1:e}: it must lie between -1e100 and 1e100; choose other units")]
    TooFar(u64, f64),
    /// A node does not exist.
    #[error("{cell} of `{group}` uses node {node}, which the mesh does not have")]
    UnknownNode {
        /// kind and tag of the cell that refers to it
        cell: String,
        /// its group
        group: String,
        /// tag of the node
        node: u64,
    },
    /// A cell has an unsupported number of nodes.
    #[error("{cell} of `{group}` has {count} nodes; {expected}")]
    NodeCount {
        /// kind and tag of the cell
        cell: String,
        /// its group
        group: String,
        /// its number of nodes
        count: usize,
        /// allowed numbers of nodes
        expected: &'static str,
    },
    /// An element contains a node twice.
    #[error("element {element} of `{group}` is collapsed: it uses node {node} twice; remesh there")]
    RepeatedNode {
        /// tag of the element
        element: u64,
        /// its body
        group: String,
        /// tag of the node
        node: u64,
    },
    /// An element has no area or is folded.
    #[error(
        "element {element} of `{group}` has zero or negative area at a quadrature point: it is collapsed, folded or \
         badly curved; remesh there"
    )]
    Collapsed {
        /// tag of the element
        element: u64,
        /// its body
        group: String,
    },
    /// A side of an element has negligible length.
    #[error(
        "element {element} of `{group}` is degenerate: its side from node {} to node {} is {length:.3e} long, and the element \
         {size:.3e}; merge the two nodes, or remesh there", ends[0], ends[1]
    )]
    ShortSide {
        /// tag of the element
        element: u64,
        /// its body
        group: String,
        /// tags of the nodes
        ends: [u64; 2],
        /// length of the side [L]
        length: f64,
        /// length of the longest side [L]
        size: f64,
    },
    /// Positions are too inaccurate because of round-off.
    #[error(
        "element {element} of `{group}` lies so far from the origin that the positions of its nodes are known to {known:.1e} \
         only, and its shortest side is {side:.3e} long; move the mesh to the origin"
    )]
    Vague {
        /// tag of the element
        element: u64,
        /// its body
        group: String,
        /// round-off of the positions [L]
        known: f64,
        /// length of the side [L]
        side: f64,
    },
    /// Two elements have the same corners.
    #[error(
        "element {first} of `{first_group}` and element {second} of `{second_group}` have the same corners; \
         remove one of them"
    )]
    Duplicate {
        /// tag of an element
        first: u64,
        /// its body
        first_group: String,
        /// tag of the other element
        second: u64,
        /// its body
        second_group: String,
    },
    /// A line is not an element edge, and others of its group are.
    #[error(
        "line {line} of `{group}` is not an edge of any element, and others of the group are; the group must lie on the \
         boundary of a meshed physical surface, or away from all (the outline of a rigid master)"
    )]
    EdgeOutside {
        /// tag of the line
        line: u64,
        /// its group
        group: String,
    },
    /// A line lies inside a body.
    #[error(
        "line {line} of `{group}` lies inside `{body}`, between two of its elements; an edge group must lie on the \
         boundary of one body"
    )]
    EdgeInside {
        /// tag of the line
        line: u64,
        /// its group
        group: String,
        /// the body around it
        body: String,
    },
    /// A line lies between two bodies that share its nodes.
    #[error(
        "line {line} of `{group}` lies between `{first}` and `{second}`, which share its nodes and so cannot slide or \
         separate; contact needs separate nodes on the two sides: draw the curve once for each body (in gmsh without \
         Coherence or fragments). It is a side of the one body only if a step removes the other"
    )]
    EdgeShared {
        /// tag of the line
        line: u64,
        /// its group
        group: String,
        /// body on one side
        first: String,
        /// body on the other side
        second: String,
    },
    /// A line differs in order from its element.
    #[error(
        "line {line} of `{group}` does not have the same middle node as the edge of its element; \
         mesh curves and surfaces at the same order"
    )]
    EdgeOrder {
        /// tag of the line
        line: u64,
        /// its group
        group: String,
    },
    /// A line occurs twice in one group.
    #[error("line {line} of `{group}` is in the group twice; remove the curve that repeats it")]
    EdgeRepeated {
        /// tag of the line
        line: u64,
        /// its group
        group: String,
    },
}

const EXPORT: &str =
    "export it again with `gmsh -2 -format msh41 file.geo`, or Mesh.MshFileVersion = 4.1 in the .geo file";
