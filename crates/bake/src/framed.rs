//! Scenes that do not stand along the axes of their file: finding their frame before they are baked.

use crate::gap::Gap;
use crate::input::BakeInput;
use crate::options::BakeOptions;
use crate::region::CellsFrom;
use sightlines_cells::Scene;
use sightlines_formats::SceneInfo;
use sightlines_frame::{Areas, MoveError, Moved, find_axes};
use sightlines_geometry::Aabb;
use sightlines_pvs::Frame;

/// The axes of the scene.
const PLAIN: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// Without a stated gap, a frame has to bring at least this share of the area across an axis that was not.
const LEAST_GAIN: f64 = 0.05;
/// Without a stated gap, at least this share of the area has to lie across an axis of the frame.
const LEAST_FLAT: f64 = 0.5;

/// A scene along the axes in which most of its walls lie.
#[derive(Debug, Clone, PartialEq)]
pub struct Framed {
    /// The axes, and the premise.
    pub frame: Frame,
    /// The scene along them.
    pub moved: Moved,
    /// What of the scene lay across an axis of its file, to the last bit.
    pub before: Areas,
    /// What lies across an axis of the frame.
    pub after: Areas,
}

impl Framed {
    /// Finds the frame of a scene; `None` if it stays as it is: because the gap is 0, because [`BakeOptions::frame`] names a frame
    /// that it is in already, or because nothing is gained.
    ///
    /// With [`Gap::OfFile`], something is gained if at least half of the area of what hides lies across an axis of the frame, and a
    /// twentieth did not lie across one before. With a stated width, if any corner moves.
    ///
    /// # Errors
    /// [`MoveError`] if a stated gap is below the rounding of the coordinates, or these become too large.
    pub fn of(scene: &Scene, file: Option<&SceneInfo>, options: &BakeOptions<'_>) -> Result<Option<Self>, MoveError> {
        let (gap, is_stated) = match options.gap {
            Gap::OfFile => (file.map_or(0.0, |file| Gap::of_file(scene, file)), false),
            Gap::Width(width) => (width, true),
        };
        if options.frame.is_some() || gap <= 0.0 || !gap.is_finite() {
            return Ok(None);
        }
        let before = Areas::of(scene);
        if !is_stated && before.axial_share() > 1.0 - LEAST_GAIN {
            return Ok(None);
        }
        let Some(found) = find_axes(scene, gap) else { return Ok(None) };
        let gained = found.flat - before.axial;
        if !is_stated && (gained < LEAST_GAIN * before.all || found.flat < LEAST_FLAT * before.all) {
            return Ok(None);
        }
        let axes = if gained > 0.0 { found.axes } else { PLAIN };
        let Ok(frame) = Frame::new(axes, gap) else { return Ok(None) };
        let moved = match Moved::new(scene, &frame) {
            Ok(moved) => moved,
            Err(error) if is_stated => return Err(error),
            Err(_) => return Ok(None),
        };
        // All walls in one plane leave no room for cells along the frame; along the file's axes they may.
        let is_flat = |scene: &Scene| {
            let b = scene.bounds();
            (0..3).any(|k| b.min[k] >= b.max[k])
        };
        if axes == PLAIN && moved.n_snapped == 0 || is_flat(&moved.scene) && !is_flat(scene) {
            return Ok(None);
        }
        let after = Areas::of(&moved.scene);
        Ok(Some(Self { frame, moved, before, after }))
    }

    /// The scene along the frame as an input.
    pub fn input<'a>(&'a self, file: Option<&'a SceneInfo>) -> BakeInput<'a> {
        BakeInput::Scene(&self.moved.scene, file)
    }

    /// The options for the scene along the frame: given cells and the view region as boxes along it, around what they were.
    pub fn options<'o>(&self, options: &BakeOptions<'o>) -> BakeOptions<'o> {
        let mut framed = options.clone();
        framed.frame = Some(self.frame);
        let around = |b: &Aabb<3>, axes| self.moved.box_around(&self.frame, b, axes);
        framed.cut.view_region = framed.cut.view_region.map(|region| around(&region, &PLAIN));
        if let CellsFrom::Boxes(cells) = &mut framed.cells {
            let axes = cells.axes.take().unwrap_or(PLAIN);
            cells.cells.iter_mut().for_each(|cell| cell.bounds = around(&cell.bounds, &axes));
        }
        framed
    }
}
