//! Scenes, or cells given for them, that do not stand along the axes of the file: finding a frame before they are baked.

use crate::gap::{Gap, LEAST_GAIN};
use crate::options::{Recipe, SceneMethod};
use crate::region::{CellsFrom, upright};
use crate::request::BakeRequest;
use sightlines_cells::Scene;
use sightlines_formats::{SceneInfo, ViewCell, ViewCells};
use sightlines_frame::{Areas, FoundAxes, MoveError, Moved, are_near, axes_near, find_axes};
use sightlines_geometry::Aabb;
use sightlines_pvs::{Frame, GeometryDigest};
use std::borrow::Cow;

/// Unit vectors of the scene.
type Axes = [[f64; 3]; 3];

/// The axes of the scene.
const PLAIN: Axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// The share of the area across the axes of the walls from which on other axes, of given cells, are as good.
const AS_GOOD: f64 = 0.8;
/// A gap that the size of stored coordinates explains is tried if it is so many times that near the origin: half of that holds the rounding of
/// coordinates that are twice as large.
const WIDER: f64 = 2.0;
/// It is taken if it brings at least this share of the area across an axis: one side of a doorway among thousands of such areas. A wall that is none
/// beside others that are leaves more open than its share of the area. A choice, not derived.
const MORE_WALLS: f64 = 1.0 / 4096.0;
/// Without a stated gap, at least this share of the area has to lie across an axis of the frame.
const LEAST_FLAT: f64 = 0.5;

/// What of a request decides the frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Asked<'a> {
    gap: Gap,
    cells: Option<&'a ViewCells>,
    /// Whether nothing but sightlines hides.
    sightlines_alone: bool,
}

impl<'a> Asked<'a> {
    fn of(request: &'a BakeRequest) -> Self {
        let cells = match &request.cells {
            Some(CellsFrom::Boxes(given)) => Some(given),
            _ => None,
        };
        let sightlines_alone = request.method == Some(SceneMethod::Sightlines) || request.is_for_proofs_alone();
        Self { gap: request.gap, cells, sightlines_alone }
    }
}

/// What a frame is along.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Along {
    /// The axes in which most of the walls lie.
    Walls,
    /// The axes of the given cells, as few walls lie along any.
    Cells,
}

/// A scene along the axes in which most of its walls lie, or along those of the cells that are given for it.
#[derive(Debug, Clone, PartialEq)]
pub struct Framed {
    /// The axes, and the premise.
    pub frame: Frame,
    /// The digests of the scene as its file has it.
    pub digest: GeometryDigest,
    /// What the axes are.
    pub along: Along,
    /// The scene along them.
    pub moved: Moved,
    /// What of the scene lay across an axis of its file, to the last bit.
    pub before: Areas,
    /// What lies across an axis of the frame.
    pub after: Areas,
}

impl Framed {
    /// Finds the frame of a scene; `None` if it stays as it is: because the gap is 0, or because nothing is gained.
    ///
    /// With [`Gap::OfFile`], something is gained if at least half of the area of what hides lies across an axis of the frame, and a
    /// twentieth did not lie across one before; or if a side of a given cell is on a wall but for the rounding of the file. With a stated width, if
    /// any corner moves, or such a side.
    ///
    /// The gap is then the one near the origin, or the one that coordinates stored far from it explain, if that brings a little more of the area
    /// across an axis.
    ///
    /// Cells that are given along axes of their own ([`ViewCells::axes`](sightlines_formats::ViewCells)) are a gain: the frame is along
    /// these where less than half of the area lies across the axes of any frame, unless sightlines alone are used, and where nearly as much lies
    /// across theirs. If the file is as precise as doubles, the gap is then what taking the scene along the frame rounds ([`Gap::of_rounding`]); a stated gap of 0 leaves the
    /// scene as it is, and boxes around the cells are taken.
    ///
    /// # Errors
    /// [`MoveError`] if a stated gap is below the rounding of the coordinates, or these become too large.
    pub fn of(scene: &Scene, file: Option<&SceneInfo>, request: &BakeRequest) -> Result<Option<Self>, MoveError> {
        Self::of_parts([scene; 2], file, request, &[])
    }

    /// The same for a scene with surroundings: the rest decides, and all of the scene is taken along.
    ///
    /// * `whole`, `scene`: with the surroundings and without
    pub(crate) fn of_parts(
        [whole, scene]: [&Scene; 2],
        file: Option<&SceneInfo>,
        request: &BakeRequest,
        surroundings: &[u32],
    ) -> Result<Option<Self>, MoveError> {
        let asked = Asked::of(request);
        let (gap, is_stated) = match asked.gap {
            Gap::OfFile => (file.map_or(0.0, |file| Gap::of_file(scene, file)), false),
            Gap::OfSingle => (Gap::of_single(scene), false),
            Gap::Width(width) => (width, true),
        };
        let before = Areas::of(scene);
        let near = Self::with_gap([whole, scene], (gap, is_stated), before, asked, surroundings)?;
        let wide =
            if gap > 0.0 && !is_stated { Gap::of_stored(scene, file.map_or(&[], |f| &f.stored_sizes)) } else { 0.0 };
        if wide < WIDER * gap || wide == 0.0 {
            return Ok(near);
        }
        let walls = near.as_ref().map_or(before.axial, |near| near.after.axial);
        let far = if walls < before.all {
            Self::with_gap([whole, scene], (wide, false), before, asked, surroundings)?
        } else {
            None
        };
        Ok(far.filter(|far| far.after.axial - walls >= MORE_WALLS * before.all).or(near))
    }

    /// The frame with a gap.
    fn with_gap(
        [whole, scene]: [&Scene; 2],
        (gap, is_stated): (f64, bool),
        before: Areas,
        asked: Asked<'_>,
        surroundings: &[u32],
    ) -> Result<Option<Self>, MoveError> {
        if !gap.is_finite() || gap <= 0.0 && is_stated {
            return Ok(None);
        }
        let Some((axes, gap, along)) = axes(scene, gap, is_stated, before, asked) else { return Ok(None) };
        let Ok(frame) = Frame::new(axes, gap) else { return Ok(None) };
        let moved = match Moved::new(whole, &frame) {
            Ok(moved) => moved,
            Err(error) if is_stated => return Err(error),
            Err(_) => return Ok(None),
        };
        // All walls in one plane leave no room for cells along the frame; along the file's axes they may.
        let is_flat = |scene: &Scene| {
            let b = scene.bounds();
            (0..3).any(|k| b.min[k] >= b.max[k])
        };
        let is_upright = axes == PLAIN;
        let rest = match surroundings {
            [] => Cow::Borrowed(&moved.scene),
            around => Cow::Owned(moved.scene.without(around)),
        };
        let (after, becomes_flat) = (Areas::of(&rest), is_flat(&rest) && !is_flat(scene));
        let framed = Self { frame, digest: whole.digest(), along, moved, before, after };
        // Of a scene with walls along the axes of its file, by default the cells alone are a reason.
        let has_walls = !is_stated && before.axial_share() > 1.0 - LEAST_GAIN;
        let stays = is_upright && (has_walls || framed.moved.n_snapped == 0) && !framed.moves_cells(asked.cells);
        Ok(if stays || becomes_flat { None } else { Some(framed) })
    }

    /// Puts the frame into a recipe: given cells and the view region become boxes along it, around what they were.
    pub(crate) fn put_into(&self, recipe: &mut Recipe) {
        (recipe.frame, recipe.digest) = (Some(self.frame), Some(self.digest));
        let region = |region: Aabb<3>| self.moved.box_around(&self.frame, &region, &PLAIN);
        recipe.cut.view_region = recipe.cut.view_region.map(region);
        if let CellsFrom::Boxes(given) = &mut recipe.cells {
            *given = ViewCells { cells: self.cells(given), axes: None };
        }
    }

    /// Whether the frame, which is along the axes of the file, puts sides of given cells on walls that they are near: sides of cells are
    /// decimals, and corners of single precision are not.
    fn moves_cells(&self, cells: Option<&ViewCells>) -> bool {
        let Some(given) = cells else { return false };
        cell_axes(cells).is_none() && self.cells(given) != upright(given)
    }

    /// Boxes along the frame around given cells.
    fn cells(&self, given: &ViewCells) -> Vec<ViewCell> {
        let axes = given.axes.unwrap_or(PLAIN);
        let around = |bounds: &Aabb<3>| self.moved.box_around(&self.frame, bounds, &axes);
        given.cells.iter().map(|cell| ViewCell { id: cell.id.clone(), bounds: around(&cell.bounds) }).collect()
    }
}

/// How many times the surface of given cells the boxes have that are taken in their place: those along the frame, or without one along the axes
/// of the scene. 1, but for rounding and the gap, where the cells stand along these, and exactly 1 where none are given.
pub fn growth_of_cells(cells: Option<&CellsFrom>, framed: Option<&Framed>) -> f64 {
    let Some(CellsFrom::Boxes(given)) = cells else { return 1.0 };
    let around = match framed {
        Some(framed) => framed.cells(given),
        None => upright(given),
    };
    let surface = |cells: &[ViewCell]| {
        let of = |b: &Aabb<3>| {
            let [x, y, z]: [f64; 3] = std::array::from_fn(|k| b.max[k] - b.min[k]);
            x * y + y * z + z * x
        };
        cells.iter().map(|cell| of(&cell.bounds)).sum::<f64>()
    };
    let before = surface(&given.cells);
    if before > 0.0 { surface(&around) / before } else { 1.0 }
}

/// The axes of the frame, its gap, and what it is along.
fn axes(scene: &Scene, gap: f64, is_stated: bool, before: Areas, asked: Asked<'_>) -> Option<(Axes, f64, Along)> {
    let given = asked.cells.is_some();
    if gap == 0.0 {
        // Nothing is known of cracks, but the cells are turned.
        let (cells, gap) = (cell_axes(asked.cells)?, Gap::of_rounding(scene));
        let cells = axes_near(scene, gap, cells);
        let follows = suits(&cells, None, before.axial, asked) && is_turned(&cells, before);
        return follows.then_some((cells.axes, gap, Along::Cells));
    }
    if !is_stated && before.axial_share() > 1.0 - LEAST_GAIN {
        return given.then_some((PLAIN, gap, Along::Walls));
    }
    let found = find_axes(scene, gap);
    let (mut axes, mut flat) = found.map_or((PLAIN, 0.0), |found| (found.axes, found.flat));
    if given {
        let cells = axes_near(scene, gap, cell_axes(asked.cells).unwrap_or(PLAIN));
        if suits(&cells, found.map(|found| found.axes), flat.max(before.axial), asked) {
            if is_turned(&cells, before) && cell_axes(asked.cells).is_some() {
                return Some((cells.axes, gap, Along::Cells));
            }
            (axes, flat) = (if are_near(cells.axes, PLAIN) { PLAIN } else { axes }, cells.flat);
        }
    }
    let gained = flat - before.axial;
    if !is_stated && (gained < LEAST_GAIN * before.all || flat < LEAST_FLAT * before.all) {
        return None;
    }
    Some((if gained > 0.0 { axes } else { PLAIN }, gap, Along::Walls))
}

/// Whether the axes of given cells suit a scene, across the axes of whose walls lies an area of `flat`: if the cells are along other axes, across which
/// nearly as much lies, as in one of several buildings; or if there are no such walls, unless they are all that is used.
fn suits(cells: &FoundAxes, walls: Option<Axes>, flat: f64, asked: Asked<'_>) -> bool {
    let others = walls.is_none_or(|walls| !are_near(cells.axes, walls));
    let no_walls = flat < LEAST_FLAT * cells.all && !asked.sightlines_alone;
    others && cells.flat >= AS_GOOD * flat || no_walls
}

/// Whether axes are turned: by more than next to nothing, unless that brings walls.
fn is_turned(axes: &FoundAxes, before: Areas) -> bool {
    !are_near(axes.axes, PLAIN) || axes.flat - before.axial >= LEAST_GAIN * before.all
}

/// The axes of given cells that do not stand along those of the scene.
fn cell_axes(cells: Option<&ViewCells>) -> Option<Axes> {
    // Along the axes of the scene in another order or with other signs is along them.
    let is_along = |axis: &[f64; 3]| axis.iter().filter(|x| **x != 0.0).count() == 1;
    cells?.axes.filter(|axes| !axes.iter().all(is_along))
}
