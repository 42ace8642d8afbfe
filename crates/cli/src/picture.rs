//! Pictures of tables: of which kind, and how they are written.

use crate::error::{ErrorAbout, Result, bail};
use crate::output;
use sightlines::pvs::{Axis, CellId, Table};
#[cfg(feature = "png")]
use sightlines::report::svg_to_png;
use sightlines::report::{DrawOptions, Up, plan_svg};
use std::path::Path;

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
    pub(crate) fn of(path: &Path) -> Result<Self> {
        match path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase).as_deref() {
            Some("svg") => Ok(Self::Svg),
            #[cfg(feature = "png")]
            Some("png") => Ok(Self::Png),
            #[cfg(not(feature = "png"))]
            Some("png") => bail!(
                "{}: PNG is not part of this build of the program, which draws tables as SVG; from the project's folder, \
                 `cargo install --path crates/cli --features png` installs one that does both",
                path.display()
            ),
            _ => bail!("{}: the name of a picture ends in .svg or .png", path.display()),
        }
    }
}

pub(crate) fn draw_plan(source: &Path, table: &Table, options: &DrawOptions<'_>) -> Result<String> {
    plan_svg(table, options).in_file(source)
}

pub(crate) fn save_picture(svg: &str, out: &Path) -> Result<()> {
    match PictureKind::of(out)? {
        PictureKind::Svg => output::save(out, svg.as_bytes()),
        #[cfg(feature = "png")]
        PictureKind::Png => output::save(out, &svg_to_png(svg).in_file(out)?),
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

pub(crate) fn middle(table: &Table, id: CellId, up: Up) -> f64 {
    let cell = &table.cells()[id.idx()];
    0.5 * cell.min[up.axis()] + 0.5 * cell.max[up.axis()]
}
