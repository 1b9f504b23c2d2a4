//! Short cases to begin with.

use std::fs::OpenOptions;
use std::io::{ErrorKind, Write};
use std::path::PathBuf;

use clap::ValueEnum;

use super::failure::Failure;
use super::say::say;

/// Kind of case.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum Template {
    /// a rubber block is dragged, rested and dragged again (mm, N, s)
    Tribology,
    /// cycles of earthquakes on a fault with rate-and-state friction (m, MN, s)
    Fault,
    /// an excavation beside a wall in clay (m, kN, s)
    Wall,
}

impl Template {
    fn name(self) -> &'static str {
        match self {
            Self::Tribology => "tribology",
            Self::Fault => "fault",
            Self::Wall => "wall",
        }
    }

    fn text(self) -> &'static str {
        match self {
            Self::Tribology => include_str!("../../cases/templates/tribology.json"),
            Self::Fault => include_str!("../../cases/templates/fault.json"),
            Self::Wall => include_str!("../../cases/templates/wall.json"),
        }
    }
}

/// Implements `fecontact init`: writes a case, but not over a file.
///
/// # Errors
/// Returns [`Failure::BadInput`] if the file exists or cannot be written.
pub fn init(kind: Template, file: Option<PathBuf>) -> Result<(), Failure> {
    let file = file.unwrap_or_else(|| format!("{}.json", kind.name()).into());
    let written = OpenOptions::new().write(true).create_new(true).open(&file);
    written.and_then(|mut open| open.write_all(kind.text().as_bytes())).map_err(|cause| {
        let why = match cause.kind() {
            ErrorKind::AlreadyExists => "exists already: give another name, `fecontact init KIND FILE`".into(),
            _ => format!("cannot be written: {cause}"),
        };
        Failure::BadInput(format!("{}: {why}", file.display()))
    })?;
    say(format_args!("{0} is written; run it: fecontact run {0}", file.display()));
    Ok(())
}
