//! Content of a results folder as plain numbers, for viewers.
//!
//! Frames of bodies and interfaces: the list of a `.pvd` file, and its VTU files.
//!
//! ```no_run
//! use std::path::Path;
//!
//! use fecontact::output::results::{Grid, frames};
//!
//! let folder = Path::new("out/block_on_ground");
//! for frame in frames(folder, "contact")?.unwrap_or_default() {
//!     let grid = Grid::read(&folder.join(&frame.file))?;
//!     let pressure = grid.at_points.iter().find(|array| array.name == "pressure");
//!     println!("t = {}: {:?}", frame.time, pressure.map(|array| &array.values));
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use std::path::{Path, PathBuf};

use super::vtu;
pub use super::vtu::{Array, Unreadable};

/// A listed frame.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Frame {
    /// [T]
    pub time: f64,
    /// file, relative to the results folder
    pub file: String,
}

/// Points and cells with their values.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Grid {
    /// undeformed positions [L]
    pub points: Vec<[f64; 2]>,
    /// points of the cells, one cell after the other
    pub connectivity: Vec<u32>,
    /// end of each cell in `connectivity`
    pub ends: Vec<u32>,
    /// VTK cell types
    pub kinds: Vec<u8>,
    /// values at the points
    pub at_points: Vec<Array>,
    /// values at the cells
    pub at_cells: Vec<Array>,
}

/// Returns the frames listed by `NAME.pvd`, in order of time; `None` if there is no such file.
///
/// # Errors
/// Returns [`Unreadable`] if the file cannot be read.
pub fn frames(folder: &Path, name: &str) -> Result<Option<Vec<Frame>>, Unreadable> {
    let file = format!("{name}.pvd");
    let path = folder.join(&file);
    if !path.is_file() {
        return Ok(None);
    }
    let text = std::fs::read_to_string(&path).map_err(|cause| Unreadable(format!("{file} cannot be read: {cause}")))?;
    let listed = text.split("<DataSet ").skip(1).map(|entry| {
        let of = |key: &str| entry.split_once(&format!("{key}=\""))?.1.split('"').next();
        let (time, file) = (of("timestep")?.parse().ok()?, of("file")?);
        Some(Frame { time, file: file.into() }).filter(|frame| frame.time.is_finite() && below(&frame.file))
    });
    let mut frames: Vec<Frame> = listed
        .collect::<Option<_>>()
        .ok_or_else(|| Unreadable(format!("{file} lists a frame without a time or a file")))?;
    frames.sort_by(|a, b| a.time.total_cmp(&b.time));
    Ok(Some(frames))
}

/// Whether a path is inside the results folder.
fn below(file: &str) -> bool {
    PathBuf::from(file).components().all(|part| matches!(part, std::path::Component::Normal(_)))
}

impl Grid {
    /// Reads a VTU file.
    ///
    /// # Errors
    /// Returns [`Unreadable`] if the file cannot be read.
    pub fn read(path: &Path) -> Result<Self, Unreadable> {
        let unreadable = |why: &str| Unreadable(why.into());
        if !path.is_file() {
            return Err(unreadable("is missing"));
        }
        let file = std::fs::read_to_string(path).map_err(|cause| Unreadable(format!("cannot be read: {cause}")))?;
        let arrays = |section: &str| vtu::arrays(&file, section);
        let (places, mut cells) = (arrays("Points")?, arrays("Cells")?);
        let mut numbers = |name: &str| {
            let array = cells.iter_mut().find(|array| array.name == name);
            array
                .map(|array| std::mem::take(&mut array.values))
                .ok_or_else(|| Unreadable(format!("has no array `{name}`")))
        };
        let whole = |numbers: Vec<f64>| numbers.into_iter().map(|number| number as u32).collect();
        let places = places.into_iter().next().ok_or_else(|| unreadable("has no points"))?.values;
        let grid = Self {
            points: places.chunks_exact(3).map(|x| [x[0], x[1]]).collect(),
            connectivity: whole(numbers("connectivity")?),
            ends: whole(numbers("offsets")?),
            kinds: numbers("types")?.into_iter().map(|kind| kind as u8).collect(),
            at_points: arrays("PointData")?,
            at_cells: arrays("CellData")?,
        };
        grid.is_whole().then_some(grid).ok_or_else(|| unreadable("has arrays that do not fit its points and cells"))
    }

    /// Whether all arrays have the required length.
    fn is_whole(&self) -> bool {
        let cells = self.ends.len();
        let long = |arrays: &[Array], count: usize| arrays.iter().all(|of| of.values.len() == count * of.components);
        self.kinds.len() == cells
            && self.ends.is_sorted()
            && self.ends.last().copied().unwrap_or(0) as usize == self.connectivity.len()
            && self.connectivity.iter().all(|&point| (point as usize) < self.points.len())
            && long(&self.at_points, self.points.len())
            && long(&self.at_cells, cells)
    }

    /// Whether another grid has the same cells.
    pub fn is_like(&self, other: &Self) -> bool {
        self.points.len() == other.points.len() && self.connectivity == other.connectivity && self.ends == other.ends
    }
}
