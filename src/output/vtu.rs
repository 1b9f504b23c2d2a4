//! VTU files, compressed in blocks as described in their header:
//!
//! ```text
//! base64(number of blocks, bytes of a block, bytes of the last one if it is shorter, compressed bytes of each)  base64(blocks)
//! ```
//!
//! A frame is a grid that hardly ever changes, and values that do: the text of the grid is made once and kept. Places have 64
//! bits; values at points have 32, unless they are asked for as they are.
//!
//! They are written here, and read with `vtkio` in tests: its writer (0.7.0-rc2) has no names of components, no units, no arrays of the
//! whole grid and no `.pvd`; it lets nobody add to what it has encoded, nor keep the text of a grid; and it passes its numbers to
//! zlib one by one, so that a frame of 90 000 nodes takes it 2.5 s instead of 0.13 s.
//!
//! The arrays of such a file, of which nothing else is understood.
//!
//! Source: VTK file formats, "XML file formats", inline binary data,
//! <https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html>.

use std::collections::BTreeMap;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use miniz_oxide::deflate::compress_to_vec_zlib;
use miniz_oxide::inflate::decompress_to_vec_zlib_with_limit;
use nalgebra::Vector2;
use thiserror::Error;

use super::files;
use crate::mesh::shape::ElementKind;

/// Block size before compression; large, since every block starts with tables of its own.
const BLOCK: usize = 1 << 18;

/// zlib level: the fastest, since frames are written while the run continues.
const LEVEL: u8 = 1;

/// VTK's numbers of the cells that frames have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellType {
    /// a point
    Vertex = 1,
    /// a straight line between two points
    Line = 3,
    /// a line through some points
    PolyLine = 4,
    /// T3
    Triangle = 5,
    /// Q4
    Quad = 9,
    /// T6
    QuadraticTriangle = 22,
    /// Q8
    QuadraticQuad = 23,
    /// Q9
    BiquadraticQuad = 28,
}

/// VTK cell type of an element.
pub fn cell_type(kind: ElementKind) -> CellType {
    match kind {
        ElementKind::T3 => CellType::Triangle,
        ElementKind::T6 => CellType::QuadraticTriangle,
        ElementKind::Q4 => CellType::Quad,
        ElementKind::Q8 => CellType::QuadraticQuad,
        ElementKind::Q9 => CellType::BiquadraticQuad,
    }
}

/// An unstructured grid, and values at its points and cells.
#[derive(Debug)]
pub struct Grid {
    /// Whether values at points are written in double precision
    exact: bool,
    mesh: Option<Mesh>,
    /// Arrays of values at points and cells
    values: [String; 2],
    /// Labels of units by the names of arrays
    units: BTreeMap<String, String>,
    /// Numbers of bodies, contacts and bars by their names, as arrays of the whole grid
    numbers: String,
}

/// Part that is the same in all frames.
#[derive(Debug)]
struct Mesh {
    points: usize,
    cells: usize,
    /// Arrays of positions and cells
    text: String,
}

/// Name of VTK's array of cells that are not drawn, and its value for these (vtkDataSetAttributes::HIDDENCELL).
pub const GHOSTS: &str = "vtkGhostType";
const HIDDEN_CELL: u8 = 32;

const SECTIONS: [&str; 2] = ["PointData", "CellData"];

impl Grid {
    /// Creates an empty grid; `exact`: values at points are written in double instead of single precision. `units` has labels
    /// by the names of arrays, from which those of derivatives are left out.
    pub fn new(exact: bool, units: BTreeMap<String, String>) -> Self {
        Self { exact, units, mesh: None, values: Default::default(), numbers: String::new() }
    }

    /// Names what cells are numbered by: the k-th name is number k of the owners, such as `body`.
    pub fn owners<'a>(&mut self, owner: &str, names: impl Iterator<Item = &'a str>) {
        self.numbers.clear();
        for (number, name) in names.enumerate() {
            let name = format!("{owner} {name}");
            let head = Head { kind: "Int32", name: &name, components: 1, unit: None, tuples: Some(1) };
            array(&mut self.numbers, head, [(number as i32).to_le_bytes()].into_iter());
        }
    }

    /// Starts a frame; `grid` is called once only.
    pub fn begin(&mut self, grid: impl FnOnce() -> (Vec<Vector2<f64>>, Vec<(CellType, Vec<usize>)>)) {
        self.values.iter_mut().for_each(String::clear);
        self.mesh.get_or_insert_with(|| {
            let (points, cells) = grid();
            Mesh::new(&points, &cells)
        });
    }

    /// Adds values at the points, with several components each.
    pub fn at_points(&mut self, name: &str, components: usize, values: impl Iterator<Item = f64>) {
        let (text, unit) = (&mut self.values[0], self.units.get(name).map(String::as_str));
        let head = |kind| Head { unit, ..Head::of(kind, name, components) };
        match self.exact {
            true => array(text, head("Float64"), values.map(f64::to_le_bytes)),
            false => array(text, head("Float32"), values.map(|value| (value as f32).to_le_bytes())),
        }
    }

    /// Adds symmetric tensors of the plane at the points, xx, yy, zz, xy, as the six components that VTK knows by these names.
    pub fn tensors(&mut self, name: &str, values: impl Iterator<Item = [f64; 4]>) {
        self.at_points(name, TENSOR.len(), values.flat_map(|[xx, yy, zz, xy]| [xx, yy, zz, xy, 0.0, 0.0]));
    }

    /// Adds vectors at the points; VTK requires a third component.
    pub fn vectors(&mut self, name: &str, values: &[f64]) {
        self.at_points(name, 3, values.chunks_exact(2).flat_map(|v| [v[0], v[1], 0.0]));
    }

    /// Adds integers at the cells.
    pub fn at_cells(&mut self, name: &str, values: impl Iterator<Item = i32>) {
        array(&mut self.values[1], Head::of("Int32", name, 1), values.map(i32::to_le_bytes));
    }

    /// Adds numbers at the cells.
    pub fn numbers_at_cells(&mut self, name: &str, values: impl Iterator<Item = f64>) {
        let values = values.map(|value| (value as f32).to_le_bytes());
        let unit = self.units.get(name).map(String::as_str);
        array(&mut self.values[1], Head { unit, ..Head::of("Float32", name, 1) }, values);
    }

    /// Hides cells, in the array by which VTK leaves them out of pictures and filters.
    pub fn hide(&mut self, cells: impl Iterator<Item = bool>) {
        array(
            &mut self.values[1],
            Head::of("UInt8", GHOSTS, 1),
            cells.map(|is_hidden| [if is_hidden { HIDDEN_CELL } else { 0 }]),
        );
    }

    /// Writes the file.
    ///
    /// # Errors
    /// Returns the error of the system.
    pub fn write(&self, path: &Path) -> io::Result<()> {
        let Some(Mesh { points, cells, text }) = &self.mesh else { return Err(io::Error::other("has no grid")) };
        let mut file = BufWriter::new(files::create(path)?);
        writeln!(
            file,
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" \
             header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n<UnstructuredGrid>"
        )?;
        if !self.numbers.is_empty() {
            writeln!(file, "<FieldData>\n{}</FieldData>", self.numbers)?;
        }
        writeln!(file, "<Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\">")?;
        for (name, arrays) in SECTIONS.iter().zip(&self.values) {
            writeln!(file, "<{name}>\n{arrays}</{name}>")?;
        }
        writeln!(file, "{text}</Piece>\n</UnstructuredGrid>\n</VTKFile>")?;
        file.flush()
    }
}

impl Mesh {
    fn new(points: &[Vector2<f64>], cells: &[(CellType, Vec<usize>)]) -> Self {
        let number = |number: usize| (number as u64).to_le_bytes();
        let places = points.iter().flat_map(|x| [x.x, x.y, 0.0]).map(f64::to_le_bytes);
        let connectivity = cells.iter().flat_map(|(_, nodes)| nodes.iter().copied()).map(number);
        let ends = cells.iter().scan(0, |end, (_, nodes)| {
            *end += nodes.len();
            Some(*end)
        });
        let kinds = cells.iter().map(|(kind, _)| [*kind as u8]);
        let of_one = |kind, name| Head::of(kind, name, 1);
        let mut text = String::from("<Points>\n");
        array(&mut text, Head::of("Float64", "Points", 3), places);
        text += "</Points>\n<Cells>\n";
        array(&mut text, of_one("UInt64", "connectivity"), connectivity);
        array(&mut text, of_one("UInt64", "offsets"), ends.map(number));
        array(&mut text, of_one("UInt8", "types"), kinds);
        text += "</Cells>\n";
        Self { points: points.len(), cells: cells.len(), text }
    }
}

/// Description of an array: its VTK type, its name and the number of components; its unit, and for arrays of the whole grid
/// the number of their values.
struct Head<'a> {
    kind: &'a str,
    name: &'a str,
    components: usize,
    unit: Option<&'a str>,
    tuples: Option<usize>,
}

impl<'a> Head<'a> {
    /// An array without a unit, of points or cells.
    fn of(kind: &'a str, name: &'a str, components: usize) -> Self {
        Self { kind, name, components, unit: None, tuples: None }
    }
}

/// Components of a symmetric tensor in VTK's order.
const TENSOR: [&str; 6] = ["XX", "YY", "ZZ", "XY", "YZ", "XZ"];

/// Appends an array.
fn array<const N: usize>(text: &mut String, is: Head, values: impl Iterator<Item = [u8; N]>) {
    let Head { kind, name, components, unit, tuples } = is;
    let safe = |text: &str| SIGNS.iter().fold(text.to_owned(), |text, (sign, written)| text.replace(sign, written));
    let name = safe(name);
    let bytes: Vec<u8> = values.flatten().collect();
    *text += &format!("<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\"");
    if components == TENSOR.len() {
        let named = TENSOR.iter().enumerate().map(|(k, of)| format!(" ComponentName{k}=\"{of}\""));
        text.extend(named);
    }
    text.extend(tuples.map(|count| format!(" NumberOfTuples=\"{count}\"")));
    *text += " format=\"binary\">";
    encode(&bytes, text);
    let key = |unit| format!("<InformationKey name=\"UNITS_LABEL\" location=\"vtkDataArray\">{unit}</InformationKey>");
    text.extend(unit.map(safe).map(key));
    *text += "</DataArray>\n";
}

/// Signs that XML reads as its own, and what stands for them in names: `&` first, which begins the others.
const SIGNS: [(&str, &str); 3] = [("&", "&amp;"), ("<", "&lt;"), (">", "&gt;")];

/// Appends packed bytes in base64.
fn encode(bytes: &[u8], text: &mut String) {
    let blocks: Vec<Vec<u8>> = bytes.chunks(BLOCK).map(|block| compress_to_vec_zlib(block, LEVEL)).collect();
    let sizes = blocks.iter().map(Vec::len);
    let head = [blocks.len(), BLOCK, bytes.len() % BLOCK].into_iter().chain(sizes);
    let head: Vec<u8> = head.flat_map(|size| (size as u64).to_le_bytes()).collect();
    STANDARD.encode_string(head, text);
    STANDARD.encode_string(blocks.concat(), text);
}

/// Values at the points or cells of a grid, as they are read back.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Array {
    /// what they are
    pub name: String,
    /// values a point or cell
    pub components: usize,
    /// all of them
    pub values: Vec<f64>,
}

/// A file of results that cannot be read: the reason.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{0}")]
pub struct Unreadable(pub(super) String);

/// The arrays in a section of a file; none where there is no such section.
///
/// # Errors
/// Returns [`Unreadable`] with what is wrong with them.
pub fn arrays(file: &str, section: &str) -> Result<Vec<Array>, Unreadable> {
    let Some((_, rest)) = file.split_once(&format!("<{section}>")) else { return Ok(Vec::new()) };
    let (inside, _) =
        rest.split_once(&format!("</{section}>")).ok_or_else(|| Unreadable(format!("ends within <{section}>")))?;
    inside.split("<DataArray ").skip(1).map(read).collect()
}

/// The array that follows the beginning of its tag.
fn read(text: &str) -> Result<Array, Unreadable> {
    let parts = || {
        let (tag, rest) = text.split_once('>')?;
        let of = |key: &str| tag.split_once(&format!("{key}=\""))?.1.split('"').next();
        let (kind, name, components) = (of("type")?, of("Name")?, of("NumberOfComponents")?.parse().ok()?);
        // The unit follows the values.
        Some((kind, name, components, rest.split_once("</DataArray>")?.0.split('<').next()?.trim()))
    };
    let (kind, name, components, packed) =
        parts().ok_or_else(|| Unreadable("has an array without an end, or a name".into()))?;
    let bytes = decode(packed).ok_or_else(|| Unreadable(format!("has an array `{name}` that is damaged")))?;
    let values =
        numbers(kind, &bytes).ok_or_else(|| Unreadable(format!("has an array `{name}` of an unknown type")))?;
    let name = SIGNS.iter().rfold(name.to_owned(), |name, (sign, text)| name.replace(text, sign));
    match components == TENSOR.len() && text.contains("ComponentName0=\"XX\"") {
        // Of a tensor of the plane the first four components are not zero.
        true => {
            let values = values.chunks(TENSOR.len()).flat_map(|tensor| tensor.iter().take(4).copied()).collect();
            Ok(Array { name, components: 4, values })
        }
        false => Ok(Array { name, components, values }),
    }
}

/// The bytes that [`encode`] has packed, if they are undamaged.
fn decode(text: &str) -> Option<Vec<u8>> {
    let number = |bytes: &[u8]| usize::try_from(u64::from_le_bytes(bytes.try_into().ok()?)).ok();
    // Three bytes are four letters: twelve of these have the number of blocks.
    let count = number(STANDARD.decode(text.get(..12)?).ok()?.get(..8)?)?;
    let letters = count.checked_add(3)?.checked_mul(8)?.div_ceil(3).checked_mul(4)?;
    let head = STANDARD.decode(text.get(..letters)?).ok()?;
    let head: Vec<usize> = head.chunks_exact(8).map(number).collect::<Option<_>>()?;
    let (block, last) = (*head.get(1)?, *head.get(2)?);
    let packed = STANDARD.decode(text.get(letters..)?).ok()?;
    let (mut bytes, mut rest) = (Vec::new(), &packed[..]);
    for (number, &size) in head.get(3..)?.iter().enumerate() {
        let whole = if number + 1 == count && last > 0 { last } else { block };
        let unpacked = decompress_to_vec_zlib_with_limit(rest.get(..size)?, whole).ok()?;
        if unpacked.len() != whole {
            return None;
        }
        bytes.extend(unpacked);
        rest = &rest[size..];
    }
    rest.is_empty().then_some(bytes)
}

/// Numbers of a type that frames have.
fn numbers(kind: &str, bytes: &[u8]) -> Option<Vec<f64>> {
    fn all<const N: usize>(bytes: &[u8], number: impl Fn([u8; N]) -> f64) -> Option<Vec<f64>> {
        let (numbers, rest) = bytes.as_chunks::<N>();
        rest.is_empty().then(|| numbers.iter().map(|bytes| number(*bytes)).collect())
    }
    match kind {
        "Float64" => all(bytes, f64::from_le_bytes),
        "Float32" => all(bytes, |bytes| f32::from_le_bytes(bytes).into()),
        "Int32" => all(bytes, |bytes| i32::from_le_bytes(bytes).into()),
        "UInt64" => all(bytes, |bytes| u64::from_le_bytes(bytes) as f64),
        "UInt8" => all(bytes, |[byte]| byte.into()),
        _ => None,
    }
}
