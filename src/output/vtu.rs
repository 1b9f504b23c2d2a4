//! VTU files: arrays in base64 between the marks of XML.
//!
//! Source: VTK file formats, "XML file formats", inline binary data,
//! <https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html>.

use std::io::{self, BufWriter, Write};
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use nalgebra::Vector2;

use super::files;
use crate::mesh::shape::ElementKind;

/// Number of a cell's kind in VTK.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CellType(u8);

impl CellType {
    /// A point.
    pub const VERTEX: Self = Self(1);
    /// Segments in a row.
    pub const POLY_LINE: Self = Self(4);
}

impl From<ElementKind> for CellType {
    fn from(kind: ElementKind) -> Self {
        Self(match kind {
            ElementKind::T3 => 5,
            ElementKind::T6 => 22,
            ElementKind::Q4 => 9,
            ElementKind::Q8 => 23,
            ElementKind::Q9 => 28,
        })
    }
}

/// An unstructured grid, and values at its points and cells.
#[derive(Debug, Default)]
pub struct Grid {
    points: usize,
    cells: usize,
    /// Arrays of points, cells, values at points and values at cells
    sections: [String; 4],
    /// Values of the last array, with the number of their bytes before them
    values: Vec<u8>,
}

const SECTIONS: [&str; 4] = ["Points", "Cells", "PointData", "CellData"];

impl Grid {
    /// Start again with other points and cells; the storage is used again.
    pub fn restart<'a>(
        &mut self,
        points: &[Vector2<f64>],
        cells: impl Iterator<Item = (CellType, &'a [usize])> + Clone,
    ) {
        self.sections.iter_mut().for_each(String::clear);
        self.points = points.len();
        self.cells = cells.clone().count();
        self.array(0, "Float64", "points", 3, points.iter().flat_map(|x| [x.x, x.y, 0.0]).map(f64::to_le_bytes));
        let nodes = cells.clone().flat_map(|(_, nodes)| nodes);
        self.array(1, "UInt64", "connectivity", 1, nodes.map(|&node| (node as u64).to_le_bytes()));
        let ends = cells.clone().scan(0, |end, (_, nodes)| {
            *end += nodes.len() as u64;
            Some(*end)
        });
        self.array(1, "UInt64", "offsets", 1, ends.map(u64::to_le_bytes));
        self.array(1, "UInt8", "types", 1, cells.map(|(kind, _)| [kind.0]));
    }

    /// Values at the points, of some components each.
    pub fn at_points(&mut self, name: &str, components: usize, values: impl Iterator<Item = f64>) {
        self.array(2, "Float64", name, components, values.map(f64::to_le_bytes));
    }

    /// Vectors at the points; VTK wants the third component, too.
    pub fn vectors(&mut self, name: &str, values: &[f64]) {
        self.at_points(name, 3, values.chunks_exact(2).flat_map(|v| [v[0], v[1], 0.0]));
    }

    /// Numbers of the cells.
    pub fn at_cells(&mut self, name: &str, values: impl Iterator<Item = i32>) {
        self.array(3, "Int32", name, 1, values.map(i32::to_le_bytes));
    }

    fn array<const N: usize>(
        &mut self,
        section: usize,
        kind: &str,
        name: &str,
        components: usize,
        values: impl Iterator<Item = [u8; N]>,
    ) {
        self.values.clear();
        self.values.extend([0; 8]);
        values.for_each(|value| self.values.extend_from_slice(&value));
        let bytes = (self.values.len() - 8) as u64;
        self.values[..8].copy_from_slice(&bytes.to_le_bytes());
        let text = &mut self.sections[section];
        *text += &format!(
            "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"binary\">"
        );
        STANDARD.encode_string(&self.values, text);
        *text += "</DataArray>\n";
    }

    /// Write the file.
    ///
    /// # Errors
    /// What the system says.
    pub fn write(&self, path: &Path) -> io::Result<()> {
        let mut file = BufWriter::new(files::create(path)?);
        writeln!(
            file,
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" \
             header_type=\"UInt64\">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">",
            self.points, self.cells
        )?;
        for (name, arrays) in SECTIONS.iter().zip(&self.sections) {
            writeln!(file, "<{name}>\n{arrays}</{name}>")?;
        }
        writeln!(file, "</Piece>\n</UnstructuredGrid>\n</VTKFile>")?;
        file.flush()
    }
}
