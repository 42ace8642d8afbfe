//! Cells at the height of eyes: for scenes without walls along axes.
//!
//! What a cell sees depends on its height more than on its width. A cell that is as high as people are sees little more than a point in it, even if
//! it is some metres wide; from a cube of a house's height most of a village is seen. So here floors are found, and above them cells of the
//! height of eyes.
//!
//! Floors are found by rounded numbers and by rays, which decide only where cells are. Whoever is in no cell sees everything.

mod floors;
mod grid;
mod surfaces;
mod units;

use crate::places::PlaceOptions;
use floors::Lengths;
use grid::Grid;
use sightlines_cells::Scene;
use sightlines_geometry::{Aabb, CoordinateError, check_coordinate};
use sightlines_kdtree::KdError;
use sightlines_progress::{Cancelled, Observer, Progress, Work};
use sightlines_pvs::Axis;
use surfaces::Surfaces;

/// How cells at the height of eyes are cut. Lengths are in scene units.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct EyeLevelOptions {
    /// Width of cells, at most. None for 1, 2 or 4 m, or wider ones, as many cells as take some minutes to bake.
    pub cell_size: Option<f64>,
    /// From how far to how far above a floor eyes are. None for 0 to 2.5 m.
    pub eye_height: Option<[f64; 2]>,
    /// The axis that points upwards, for [`BakeRequest::cells`](crate::BakeRequest::cells). None for what the file of the scene states, or else z.
    pub up: Option<Axis>,
    /// Scene units in a metre. None for what the scene shows ([`UnitsFrom`]).
    pub units_per_metre: Option<f64>,
}

impl EyeLevelOptions {
    /// Places of that width, where there are no floors, or where they lean.
    pub(crate) fn places(&self) -> PlaceOptions {
        PlaceOptions { n_cells: None, cell_size: self.cell_size }
    }
}

/// Why there are no cells at the height of eyes.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EyeLevelError {
    /// The region or the scene has no room.
    #[error(transparent)]
    Region(#[from] KdError),
    /// A width or a number of units is no number above 0.
    #[error("{what} is {value}: this is not a number above 0")]
    NotPositive {
        /// What was given.
        what: &'static str,
        /// As which number.
        value: f64,
    },
    /// Eyes are nowhere.
    #[error("eyes from {} to {} units above floors: the second number has to be larger, and both finite", .0[0], .0[1])]
    EyeHeight([f64; 2]),
    /// The cells would reach to where coordinates cannot be used.
    #[error("the tops of cells: {0}")]
    Bounds(#[source] CoordinateError),
    /// Nobody can stand anywhere in the region.
    #[error("no floor to stand on was found in the region")]
    NoFloor,
    /// There are more cells than the limit.
    #[error(
        "cells {cell_size} units wide are more than {limit}, which is the limit: raise the limit, or take wider cells"
    )]
    TooMany {
        /// Their width.
        cell_size: f64,
        /// The limit.
        limit: u32,
    },
    /// The observer cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// How the number of scene units in a metre was found.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum UnitsFrom {
    /// It was given.
    Options,
    /// A unit is a metre, as glTF states; what was measured does not contradict that.
    Metres,
    /// Ceilings are mostly so far above floors or farther, in scene units: too little or too much for metres.
    Clearances(f64),
    /// There are few ceilings, and half of the objects are this long or longer, in scene units: too little or too much for metres.
    Objects(f64),
}

/// What was left out: so many parts of floors in columns, by reason.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct LeftOut {
    /// Something is too closely above them.
    pub no_room: usize,
    /// Who stands there would see backs only, as inside of what is solid, or mostly those of single-sided faces, as below the ground.
    pub behind: usize,
    /// They are too small to stand on.
    pub slivers: usize,
}

/// What was cut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EyeLevelSummary {
    /// Cells.
    pub n_cells: usize,
    /// The most cells above each other.
    pub n_layers: usize,
    /// Columns with a cell.
    pub n_columns: usize,
    /// Scene units in a metre.
    pub units_per_metre: f64,
    /// How that number was found.
    pub units_from: UnitsFrom,
    /// Width of cells, at most, in scene units.
    pub cell_size: f64,
    /// From how far to how far above floors eyes are, in scene units.
    pub eye_height: [f64; 2],
    /// What was left out.
    pub left_out: LeftOut,
}

/// Cells above floors: closed boxes with disjoint insides. Those that share a part of a face have equal coordinates there, bit by bit.
#[derive(Debug, Clone, PartialEq)]
pub struct EyeLevelCells {
    /// The cells, in an order in which those near to each other are near as a rule.
    pub cells: Vec<Aabb<3>>,
    /// What was cut.
    pub summary: EyeLevelSummary,
}

/// Cuts a region of a scene, or all of it, into cells above floors.
///
/// The region is divided into columns of equal width. In each of them cells begin at the floors, and end as far above them as eyes are.
/// Floors are upward-facing triangles of all that hides, of at most some 50 degrees; faces that are seen from both sides may face either way. A floor on
/// which nobody can stand is left out ([`LeftOut`]). Where floors above each other are closer than eyes are high, as on slopes and stairs, their
/// cells are joined, and cut into layers of about one and a half times the height of eyes at most: cuts
/// move to floors by up to a quarter of a layer.
///
/// The same scene and options give the same boxes, with any number of threads.
///
/// * `up`: the axis that points upwards
/// * `region`: cells are only there; None for everywhere
/// * `max_cells`: the limit of cells
///
/// Cost: a ray or some for each triangle of a floor in each column.
///
/// # Errors
/// [`EyeLevelError`]; a width that was given and makes too many cells is refused.
pub fn eye_level_cells(
    scene: &Scene,
    up: Axis,
    region: Option<&Aabb<3>>,
    options: &EyeLevelOptions,
    max_cells: u32,
    progress: Option<&dyn Observer>,
) -> Result<EyeLevelCells, EyeLevelError> {
    check(options)?;
    let up = up.idx();
    let all = scene.bounds();
    let region = checked_region(&all, region, up)?;
    let now = Progress::new("surfaces", 0, 1).of(Work::Cutting);
    if progress.is_some_and(|observer| observer.report(now).is_break()) {
        return Err(Cancelled.into());
    }
    let surfaces = Surfaces::of(scene, up, &region);
    let (metre, units_from) = match options.units_per_metre {
        Some(units) => (units, UnitsFrom::Options),
        None => units::find(scene, &surfaces),
    };
    let eye_height = options.eye_height.unwrap_or([0.0, 2.5 * metre]);
    let lengths = Lengths { metre, eye_height };
    let n_objects = scene.objects().len();
    let cut = |cell_size: f64| {
        let (mut limit, mut most_pieces) = (max_cells, MOST_PIECES);
        if options.cell_size.is_none() {
            let pairs = if cell_size < WIDTH * metre { PAIRS_WORTH_IT } else { AFFORDABLE_PAIRS };
            limit = limit.min(n_cells_of(pairs, n_objects));
            // A floor in far more columns than there may be cells has too many of them.
            most_pieces = most_pieces.min(4 * scene.n_triangles() + 64 * limit as usize);
        }
        match Grid::new(&region, up, cell_size) {
            Some(grid) if surfaces.n_pieces(&grid) <= most_pieces => {
                let found = floors::find(&surfaces, &grid, &lengths, limit as usize, progress)?;
                Ok::<_, Cancelled>(found.map(|found| (grid, found)))
            }
            _ => Ok(None),
        }
    };
    let mut cell_size = options.cell_size.unwrap_or(NARROWEST * metre);
    let (grid, found) = loop {
        match cut(cell_size)? {
            Some(found) => break found,
            // A width beyond all that is there is one column.
            None if options.cell_size.is_some() || grid::is_one_column(&region, up, cell_size) => {
                return Err(EyeLevelError::TooMany { cell_size, limit: max_cells });
            }
            None => cell_size *= 2.0,
        }
    };
    let heights = found.heights().ok_or(EyeLevelError::NoFloor)?;
    heights.into_iter().try_for_each(|x| check_coordinate(x).map(|_| ())).map_err(EyeLevelError::Bounds)?;
    let cells = grid.cells(&found.columns);
    let summary = EyeLevelSummary {
        n_cells: cells.len(),
        n_layers: found.columns.iter().map(Vec::len).max().unwrap_or(0),
        n_columns: found.columns.iter().filter(|column| !column.is_empty()).count(),
        units_per_metre: metre,
        units_from,
        cell_size,
        eye_height,
        left_out: found.left_out,
    };
    Ok(EyeLevelCells { cells, summary })
}

/// The width of cells where nothing else is said, in metres. Twice that as often as there are too many cells; less if there are few of them.
const WIDTH: f64 = 4.0;
const NARROWEST: f64 = 1.0;

/// How many pairs of a cell and a target are decided in two or three minutes, and in some fifteen. Targets are objects and groups of cells. Measured in Sponza
/// and a castle, with two threads.
const PAIRS_WORTH_IT: f64 = 1.5e6;
const AFFORDABLE_PAIRS: f64 = 12.5e6;

/// What sees which cells is asked about by so many groups of them, if there are so many cells.
pub(crate) const GROUPS: usize = 128;

/// So many cells are always worth it; more take much memory, a bit for each two of them.
const FEW: f64 = 1000.0;
const MANY: f64 = 10_000.0;

/// With how many cells there are so many pairs.
fn n_cells_of(pairs: f64, n_objects: usize) -> u32 {
    (pairs / (n_objects + GROUPS) as f64).clamp(FEW, MANY) as u32
}

/// More parts of triangles in columns than this take too long: the columns are too narrow for the scene.
const MOST_PIECES: usize = 1 << 24;

fn check(options: &EyeLevelOptions) -> Result<(), EyeLevelError> {
    let positive =
        [("the width of cells", options.cell_size), ("the number of units in a metre", options.units_per_metre)];
    for (what, value) in positive {
        if let Some(value) = value.filter(|x| !(x.is_finite() && *x > 0.0)) {
            return Err(EyeLevelError::NotPositive { what, value });
        }
    }
    match options.eye_height {
        Some([low, high]) if !(low.is_finite() && high.is_finite() && low < high) => {
            Err(EyeLevelError::EyeHeight([low, high]))
        }
        _ => Ok(()),
    }
}

/// Where cells are: the given region, or the box of all, which may be flat.
fn checked_region(all: &Aabb<3>, given: Option<&Aabb<3>>, up: usize) -> Result<Aabb<3>, KdError> {
    let mut region = match given {
        Some(region) if region.is_empty() => return Err(KdError::ViewRegion),
        Some(region) => *region,
        None => *all,
    };
    if region.is_empty() || all.is_empty() {
        return Err(KdError::Empty);
    }
    for x in region.min.iter_mut().chain(&mut region.max) {
        *x = check_coordinate(*x).map_err(KdError::Bounds)?;
    }
    let is_flat = |axis: &usize| region.min[*axis] >= region.max[*axis] && (*axis != up || given.is_some());
    if let Some(axis) = (0..3).find(is_flat) {
        return Err(KdError::Flat { axis });
    }
    if given.is_none() {
        // Eyes above the highest floor are above all that is there.
        (region.min[up], region.max[up]) = (f64::NEG_INFINITY, f64::INFINITY);
    }
    Ok(region)
}
