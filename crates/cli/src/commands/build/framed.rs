//! The frame in which a scene is baked, and what it brought.

use super::Error;
use crate::facts::FrameFacts;
use crate::output::percent;
use serde::Serialize;
use sightlines::bake::{BakeError, BakeOptions, Bakeable, Framed};
use std::fmt;
use std::path::Path;

/// Takes a scene into its frame, with the cells and the view region of `options`, if it has one.
pub(super) fn take(path: &Path, content: &mut Bakeable, options: &mut BakeOptions<'_>) -> Result<Option<Taken>, Error> {
    let Bakeable::Scene(file) = content else { return Ok(None) };
    let failed = |error| Error::Bake { path: path.to_owned(), map: None, source: Box::new(BakeError::Move(error)) };
    let Some(framed) = Framed::of(&file.scene, Some(&file.info), options).map_err(failed)? else { return Ok(None) };
    *options = framed.options(options);
    let taken = Taken::new(&framed);
    file.scene = framed.moved.scene;
    Ok(Some(taken))
}

/// The frame of a scene, and what it brought.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct Taken {
    #[serde(flatten)]
    frame: FrameFacts,
    /// The largest distance of a coordinate from that of the file, along the axes of the frame, in scene units.
    largest_move: f64,
    n_corners: usize,
    /// Corners that were moved, beyond rounding, to where others are.
    n_snapped_corners: usize,
    /// The share of the area of what hides that was across an axis of the file.
    axial_before: f64,
    /// The share that is across an axis of the frame.
    axial_after: f64,
}

impl Taken {
    fn new(framed: &Framed) -> Self {
        let Framed { frame, moved, before, after } = framed;
        Self {
            frame: frame.into(),
            largest_move: moved.most,
            n_corners: moved.n_corners,
            n_snapped_corners: moved.n_snapped,
            axial_before: before.axial_share(),
            axial_after: after.axial_share(),
        }
    }
}

impl fmt::Display for Taken {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.frame)?;
        let [before, after] = [self.axial_before, self.axial_after].map(percent);
        writeln!(f, "               {before} of the wall area was across an axis, {after} is")?;
        let (snapped, n) = (self.n_snapped_corners, self.n_corners);
        writeln!(f, "               {snapped} of {n} corners moved, by at most {:.2e} units", self.largest_move)
    }
}
