//! VTU files: [`vtkio`] writes what stays the same from frame to frame, once; the values are put in between.
//!
//! A frame is a grid that hardly ever changes, and values that do. Its grid is handed to vtkio, whose data model makes the
//! XML of it; every frame is then that text, with the arrays of its values between head and grid. They are compressed in
//! blocks, as the head says:
//!
//! ```text
//! base64(number of blocks, bytes of a block, bytes of the last one if it is shorter, compressed bytes of each)  base64(blocks)
//! ```
//!
//! Source: VTK file formats, "XML file formats", inline binary data,
//! <https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html>.

use std::io::{self, BufWriter, Write};
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use miniz_oxide::deflate::compress_to_vec_zlib;
use miniz_oxide::{MZ_ADLER32_INIT, mz_adler32_oxide};
use nalgebra::Vector2;
pub use vtkio::model::CellType;
use vtkio::model::{Attributes, ByteOrder, Cells, DataSet, UnstructuredGridPiece, Version, VertexNumbers, Vtk};
use vtkio::xml::Compressor;

use super::files;
use crate::mesh::shape::ElementKind;

/// Bytes of a block before compression: many, since every block begins with tables of its own.
const BLOCK: usize = 1 << 18;

/// Level of zlib: the quickest, since frames are written while the run goes on.
const LEVEL: u8 = 1;

/// Share of the words of a block that must say nothing new for its compression to be worth the time.
const WORTHWHILE: f64 = 0.1;

/// VTK's name of an element.
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
#[derive(Debug, Default)]
pub struct Grid {
    /// Its file without values: what stands before and behind them
    around: Option<[String; 2]>,
    /// Arrays of values at points and cells
    values: [String; 2],
    /// Values of the last array
    bytes: Vec<u8>,
}

const SECTIONS: [&str; 2] = ["PointData", "CellData"];

impl Grid {
    /// Begin a frame; the grid is asked for once.
    ///
    /// # Errors
    /// Why it cannot be written.
    pub fn begin(&mut self, grid: impl FnOnce() -> (Vec<Vector2<f64>>, Vec<(CellType, Vec<usize>)>)) -> io::Result<()> {
        self.values.iter_mut().for_each(String::clear);
        if self.around.is_none() {
            let (points, cells) = grid();
            self.around = Some(without_values(&points, &cells)?);
        }
        Ok(())
    }

    /// Values at the points, of some components each.
    pub fn at_points(&mut self, name: &str, components: usize, values: impl Iterator<Item = f64>) {
        self.array(0, "Float64", name, components, values.map(f64::to_le_bytes));
    }

    /// Vectors at the points; VTK wants the third component, too.
    pub fn vectors(&mut self, name: &str, values: &[f64]) {
        self.at_points(name, 3, values.chunks_exact(2).flat_map(|v| [v[0], v[1], 0.0]));
    }

    /// Numbers of the cells.
    pub fn at_cells(&mut self, name: &str, values: impl Iterator<Item = i32>) {
        self.array(1, "Int32", name, 1, values.map(i32::to_le_bytes));
    }

    fn array<const N: usize>(
        &mut self,
        section: usize,
        kind: &str,
        name: &str,
        components: usize,
        values: impl Iterator<Item = [u8; N]>,
    ) {
        self.bytes.clear();
        values.for_each(|value| self.bytes.extend_from_slice(&value));
        let text = &mut self.values[section];
        *text += &format!(
            "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"binary\">"
        );
        encode(&self.bytes, text);
        *text += "</DataArray>\n";
    }

    /// Write the file.
    ///
    /// # Errors
    /// What the system says.
    pub fn write(&self, path: &Path) -> io::Result<()> {
        let Some([before, behind]) = &self.around else { return Err(io::Error::other("has no grid")) };
        let mut file = BufWriter::new(files::create(path)?);
        write!(file, "<?xml version=\"1.0\"?>\n{before}\n")?;
        for (name, arrays) in SECTIONS.iter().zip(&self.values) {
            writeln!(file, "<{name}>\n{arrays}</{name}>")?;
        }
        writeln!(file, "{behind}")?;
        file.flush()
    }
}

/// The file of a grid without values, cut where they belong.
fn without_values(points: &[Vector2<f64>], cells: &[(CellType, Vec<usize>)]) -> io::Result<[String; 2]> {
    let connectivity = cells.iter().flat_map(|(_, nodes)| nodes.iter().map(|&node| node as u64)).collect();
    let offsets = cells.iter().scan(0, |end, (_, nodes)| {
        *end += nodes.len() as u64;
        Some(*end)
    });
    let piece = UnstructuredGridPiece {
        points: points.iter().flat_map(|x| [x.x, x.y, 0.0]).collect::<Vec<f64>>().into(),
        cells: Cells {
            cell_verts: VertexNumbers::XML { connectivity, offsets: offsets.collect() },
            types: cells.iter().map(|(kind, _)| *kind).collect(),
        },
        data: Attributes::new(),
    };
    let vtk = Vtk {
        version: Version::new_xml(1, 0),
        title: String::new(),
        byte_order: ByteOrder::LittleEndian,
        data: DataSet::inline(piece),
        file_path: None,
    };
    let file = vtk.try_into_xml_format(Compressor::ZLib, LEVEL.into()).map_err(io::Error::other)?;
    let text = file.to_string();
    let cut = text.find("<Piece").and_then(|piece| Some(piece + text[piece..].find('>')? + 1));
    let (before, behind) = text.split_at(cut.ok_or_else(|| io::Error::other("the grid has no piece"))?);
    Ok([before.into(), behind.into()])
}

/// Append compressed bytes in base64.
fn encode(bytes: &[u8], text: &mut String) {
    let blocks: Vec<Vec<u8>> = bytes.chunks(BLOCK).map(compressed).collect();
    let sizes = blocks.iter().map(Vec::len);
    let head = [blocks.len(), BLOCK, bytes.len() % BLOCK].into_iter().chain(sizes);
    let head: Vec<u8> = head.flat_map(|size| (size as u64).to_le_bytes()).collect();
    STANDARD.encode_string(head, text);
    STANDARD.encode_string(blocks.concat(), text);
}

/// A block for its file; one of digits without a pattern is only wrapped.
fn compressed(block: &[u8]) -> Vec<u8> {
    let words = block.as_chunks::<8>().0;
    // Zeros, such as the third component of vectors, and equal neighbours.
    let known = words.iter().zip(&words[1.min(words.len())..]).filter(|(a, b)| **b == [0; 8] || a == b).count();
    if (known as f64) < WORTHWHILE * words.len() as f64 { wrapped(block) } else { compress_to_vec_zlib(block, LEVEL) }
}

/// Bytes as zlib takes them uncompressed. Source: RFC 1950, and RFC 1951 section 3.2.4.
fn wrapped(bytes: &[u8]) -> Vec<u8> {
    let mut stream = Vec::with_capacity(bytes.len() + bytes.len() / 1000 + 16);
    stream.extend([0x78, 0x01]);
    let parts = bytes.chunks(u16::MAX.into());
    let left = (0..parts.len()).rev();
    for (part, left) in parts.zip(left) {
        let length = part.len() as u16;
        stream.push(u8::from(left == 0));
        stream.extend(length.to_le_bytes());
        stream.extend((!length).to_le_bytes());
        stream.extend_from_slice(part);
    }
    stream.extend(mz_adler32_oxide(MZ_ADLER32_INIT, bytes).to_be_bytes());
    stream
}
