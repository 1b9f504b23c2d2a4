//! VTU files, compressed in blocks as described in their header:
//!
//! ```text
//! base64(number of blocks, bytes of a block, bytes of the last one if it is shorter, compressed bytes of each)  base64(blocks)
//! ```
//!
//! A frame is a grid that rarely changes, and values that do: the text of the grid is made once and kept. For this reason
//! frames are written here and not by [`vtkio`], which only reads them. Positions have 64 bits; values at points have 32, or 64
//! if requested.
//!
//! Source: VTK file formats, "XML file formats", inline binary data,
//! <https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html>.

use std::io::{self, BufWriter, Write};
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use miniz_oxide::deflate::compress_to_vec_zlib;
use nalgebra::Vector2;
pub use vtkio::model::CellType;

use super::files;
use crate::mesh::shape::ElementKind;

/// Block size before compression; large, since every block starts with tables of its own.
const BLOCK: usize = 1 << 18;

/// zlib level: the fastest, since frames are written while the run continues.
const LEVEL: u8 = 1;

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
}

/// Part that is the same in all frames.
#[derive(Debug)]
struct Mesh {
    points: usize,
    cells: usize,
    /// Arrays of positions and cells
    text: String,
}

const SECTIONS: [&str; 2] = ["PointData", "CellData"];

impl Grid {
    /// Creates an empty grid; `exact`: values at points are written in double instead of single precision.
    pub fn new(exact: bool) -> Self {
        Self { exact, mesh: None, values: Default::default() }
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
        let text = &mut self.values[0];
        match self.exact {
            true => array(text, Array { kind: "Float64", name, components }, values.map(f64::to_le_bytes)),
            false => {
                let singles = values.map(|value| (value as f32).to_le_bytes());
                array(text, Array { kind: "Float32", name, components }, singles);
            }
        }
    }

    /// Adds vectors at the points; VTK requires a third component.
    pub fn vectors(&mut self, name: &str, values: &[f64]) {
        self.at_points(name, 3, values.chunks_exact(2).flat_map(|v| [v[0], v[1], 0.0]));
    }

    /// Adds integers at the cells.
    pub fn at_cells(&mut self, name: &str, values: impl Iterator<Item = i32>) {
        array(&mut self.values[1], Array { kind: "Int32", name, components: 1 }, values.map(i32::to_le_bytes));
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
             header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n<UnstructuredGrid>\n\
             <Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\">"
        )?;
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
        let of_one = |kind, name| Array { kind, name, components: 1 };
        let mut text = String::from("<Points>\n");
        array(&mut text, Array { kind: "Float64", name: "Points", components: 3 }, places);
        text += "</Points>\n<Cells>\n";
        array(&mut text, of_one("UInt64", "connectivity"), connectivity);
        array(&mut text, of_one("UInt64", "offsets"), ends.map(number));
        array(&mut text, of_one("UInt8", "types"), kinds);
        text += "</Cells>\n";
        Self { points: points.len(), cells: cells.len(), text }
    }
}

/// Description of an array: its VTK type, its name and the number of components.
struct Array<'a> {
    kind: &'a str,
    name: &'a str,
    components: usize,
}

/// Appends an array.
fn array<const N: usize>(text: &mut String, is: Array, values: impl Iterator<Item = [u8; N]>) {
    let Array { kind, name, components } = is;
    let bytes: Vec<u8> = values.flatten().collect();
    *text +=
        &format!("<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"binary\">");
    encode(&bytes, text);
    *text += "</DataArray>\n";
}

/// Appends packed bytes in base64.
fn encode(bytes: &[u8], text: &mut String) {
    let blocks: Vec<Vec<u8>> = bytes.chunks(BLOCK).map(|block| compress_to_vec_zlib(block, LEVEL)).collect();
    let sizes = blocks.iter().map(Vec::len);
    let head = [blocks.len(), BLOCK, bytes.len() % BLOCK].into_iter().chain(sizes);
    let head: Vec<u8> = head.flat_map(|size| (size as u64).to_le_bytes()).collect();
    STANDARD.encode_string(head, text);
    STANDARD.encode_string(blocks.concat(), text);
}
