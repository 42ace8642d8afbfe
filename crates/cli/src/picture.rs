//! Pictures of tables: of which kind, and how they are written.

use crate::error::OutputError;
use crate::output;
use sightlines::pvs::{Axis, CellId, Table};
use sightlines::report::DrawError;
use sightlines::report::PngError;
#[cfg(feature = "png")]
use sightlines::report::svg_to_png;
use sightlines::report::{DrawOptions, Up, plan_svg};
use std::path::{Path, PathBuf};

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
pub(crate) enum PictureError {
    /// A result that cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A picture whose name has no extension of a picture.
    #[error("{}: the name of a picture ends in .svg or .png", .0.display())]
    PictureKind(PathBuf),
    /// A picture of a kind that this build of the program cannot write.
    #[cfg(not(feature = "png"))]
    #[error(
        "{}: PNG is not part of this build of the program, which draws tables as SVG; from the project's folder, \
         `cargo install --path crates/cli --features png` installs one that does both", .0.display()
    )]
    NoPng(PathBuf),
    /// A picture that is always PNG, whose name ends otherwise.
    #[error("{}: the picture is written as PNG; give a name that ends in .png", .0.display())]
    NotPng(PathBuf),
    /// A picture cannot be drawn.
    #[error("{}: {source}", path.display())]
    Draw { path: PathBuf, source: DrawError },
    /// A picture cannot be rendered.
    #[error("{}: {source}", path.display())]
    Png { path: PathBuf, source: PngError },
}

/// The kinds of pictures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum PictureKind {
    Svg,
    #[cfg(feature = "png")]
    Png,
}

impl PictureKind {
    /// The endings of the kinds that this build of the program writes.
    pub(crate) const ENDINGS: &[&str] = if cfg!(feature = "png") { &["svg", "png"] } else { &["svg"] };

    /// The kind of a picture, by the extension of its name.
    ///
    /// # Errors
    /// For any other extension, and for a kind that this build of the program cannot write.
    pub(crate) fn of(path: &Path) -> Result<Self, PictureError> {
        match path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase).as_deref() {
            Some("svg") => Ok(Self::Svg),
            #[cfg(feature = "png")]
            Some("png") => Ok(Self::Png),
            #[cfg(not(feature = "png"))]
            Some("png") => Err(PictureError::NoPng(path.to_owned())),
            _ => Err(PictureError::PictureKind(path.to_owned())),
        }
    }
}

/// The picture of a plan's table that came from `source`.
pub(crate) fn draw_plan(source: &Path, table: &Table, options: &DrawOptions<'_>) -> Result<String, PictureError> {
    plan_svg(table, options).map_err(|error| PictureError::Draw { path: source.to_owned(), source: error })
}

/// Writes a picture, of the kind that the file's name ends in.
pub(crate) fn save_picture(svg: &str, out: &Path) -> Result<(), PictureError> {
    match PictureKind::of(out)? {
        PictureKind::Svg => Ok(output::save(out, svg.as_bytes())?),
        #[cfg(feature = "png")]
        PictureKind::Png => {
            let png = svg_to_png(svg).map_err(|error| PictureError::Png { path: out.to_owned(), source: error })?;
            Ok(output::save(out, &png)?)
        }
    }
}

/// The up axis of a table; y if it stores none.
pub(crate) fn up_of(table: &Table) -> Up {
    match table.up() {
        Some(Axis::X) => Up::X,
        Some(Axis::Z) => Up::Z,
        Some(Axis::Y) | None => Up::Y,
    }
}

/// The height of the middle of a cell.
pub(crate) fn middle(table: &Table, id: CellId, up: Up) -> f64 {
    let cell = &table.cells()[id.idx()];
    0.5 * cell.min[up.axis()] + 0.5 * cell.max[up.axis()]
}

/// Refuses a name that does not end in `.png`.
pub(crate) fn check_png_name(path: &Path) -> Result<(), PictureError> {
    if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("png")) {
        Ok(())
    } else {
        Err(PictureError::NotPng(path.to_owned()))
    }
}
