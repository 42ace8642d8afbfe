//! Places: cells for any scene, cut where the views of two halves differ.
//!
//! A k-d tree along walls needs walls that are perpendicular to an axis, follows each of them, and leaves the open whole.
//! Places are boxes for scenes without such walls: a castle, a street, a cave. The box of the scene is cut in two, again and
//! again, first until no box is longer than a bound, then where it pays most: where rays show that one half sees what the other
//! does not. What lies wholly in solid matter is left out, and so is what rays show to lie behind the backs of single-sided faces: nobody
//! sees those. Rays and rounded numbers choose among cuts, each of which is right; a viewer who is in no cell sees everything.

mod cut;
mod views;

use cut::{Cutter, Goal, Stop};
use sightlines_cells::Scene;
use sightlines_geometry::{Aabb, check_coordinate};
use sightlines_kdtree::{KdError, SceneOptions};
use sightlines_progress::{Cancelled, Observer};

/// How many places to cut.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PlaceOptions {
    /// How many cells to make, exactly, unless the bound on their size needs more. None for [`PlaceOptions::N_CELLS`] or the limit of cells, if
    /// that is lower; there are fewer where cutting pays nowhere.
    pub n_cells: Option<u32>,
    /// Longest side of a cell, in scene units. None for no bound; then longer boxes are cut first until about half of the cells are made.
    pub cell_size: Option<f64>,
}

impl PlaceOptions {
    /// How many cells are made by default.
    pub const N_CELLS: u32 = 256;

    /// How many cells to make.
    pub fn n_cells(&self) -> u32 {
        self.n_cells.unwrap_or(Self::N_CELLS)
    }
}

/// Why cells cannot be cut so.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlacesError {
    /// The region has no room.
    #[error(transparent)]
    KdTree(#[from] KdError),
    /// More cells were asked for than the limit.
    #[error("{n_cells} cells were asked for, and {limit} are the limit: raise the limit, or ask for fewer")]
    TooMany {
        /// Cells that were asked for.
        n_cells: u32,
        /// The limit.
        limit: u32,
    },
    /// Cutting to the bound on the sides of cells was given up, as there were more cells than the limit. Further cuts might have found some of
    /// them to be solid.
    #[error(
        "cutting cells of at most {cell_size} units was stopped at more than {limit}, which is the limit: raise the limit, or take larger cells"
    )]
    TooSmall {
        /// The bound.
        cell_size: f64,
        /// The limit.
        limit: u32,
    },
    /// The region is so many cells of the longest sides that are allowed that nothing was cut. If nearly all of it is solid, fewer would do.
    #[error(
        "the region takes {} cells of at most {cell_size} units, fewer where it is solid; the limit is {limit}. Nothing was cut: raise the limit, or \
         take larger cells",
        if *n_cells < 1e9 { format!("{n_cells}") } else { format!("{n_cells:.1e}") }
    )]
    FarTooSmall {
        /// The bound.
        cell_size: f64,
        /// The fewest boxes within the bound that fill the region.
        n_cells: f64,
        /// The limit.
        limit: u32,
    },
    /// The bound on the sides of cells is no positive number.
    #[error("cells of at most {0} units: this is not a number above 0")]
    CellSize(f64),
    /// No cells.
    #[error("0 cells were asked for; there has to be one")]
    NoCells,
    /// The observer cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// What was cut.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PlaceSummary {
    /// Cells.
    pub n_cells: usize,
    /// The longest side of a cell, in scene units.
    pub cell_size: f64,
    /// Cuts along walls, where views differ.
    pub n_along_walls: usize,
    /// Other cuts where views differ.
    pub n_by_views: usize,
    /// Cuts of long boxes of which rays do not show that views differ.
    pub n_by_size: usize,
    /// Boxes that were left out because they are inside of solid matter.
    pub n_solid: usize,
    /// Boxes that were left out because viewers in them would see mostly the backs of single-sided faces.
    pub n_behind: usize,
}

/// Places of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Places {
    /// The cells, in the order of the tree: those near to each other have near indices, as a rule. They have insides, which do not overlap.
    pub cells: Vec<Aabb<3>>,
    /// What was cut.
    pub summary: PlaceSummary,
}

/// Cuts the view region of a scene, or else its box, into places.
///
/// Of `cut` the view region, the limit of cells and whether solid matter stays matter. The same scene and options give the
/// same places. If solid matter stays, the cells tile the region. Else what is in it and outside of all cells is certainly in
/// [solid matter](sightlines_kdtree::Matter), or, in scenes with [single-sided](Scene::is_single_sided) faces, behind their backs as far as rays show.
///
/// Cost: some thousand rays for each cell.
///
/// # Errors
/// [`PlacesError`]; what is likely to be many more cells than the limit is refused before any work ([`PlacesError::FarTooSmall`]).
pub fn places(scene: &Scene, cut: &SceneOptions, options: &PlaceOptions) -> Result<Places, PlacesError> {
    observed_places(scene, cut, options, None)
}

/// The same places; tells an observer of each cut, in the phase `cuts`. The total is those that are made and the fewest that are then still needed:
/// it grows where boxes turn out to be solid, or cuts leave more boxes than the bound on their sides needs, and is right in the end. The
/// share never falls.
///
/// # Errors
/// As [`places`]; [`PlacesError::Cancelled`] if the observer cancels.
pub fn observed_places(
    scene: &Scene,
    cut: &SceneOptions,
    options: &PlaceOptions,
    progress: Option<&dyn Observer>,
) -> Result<Places, PlacesError> {
    if let Some(size) = options.cell_size.filter(|s| s.is_nan() || *s <= 0.0) {
        return Err(PlacesError::CellSize(size));
    }
    let limit = cut.max_cells;
    match options.n_cells {
        Some(0) => return Err(PlacesError::NoCells),
        Some(n_cells) if n_cells > limit => return Err(PlacesError::TooMany { n_cells, limit }),
        _ => {}
    }
    let region = region(scene, cut.view_region)?;
    if let Some(cell_size) = options.cell_size {
        let n_cells = n_boxes(&region, cell_size);
        if n_cells > MOST_TIMES * f64::from(limit) {
            return Err(PlacesError::FarTooSmall { cell_size, n_cells, limit });
        }
    }
    let n_cells = options.n_cells.unwrap_or(PlaceOptions::N_CELLS.min(limit));
    let cell_size = options.cell_size.unwrap_or_else(|| default_size(&region, n_cells));
    let (is_bound, all) = (options.cell_size.is_some(), options.n_cells.is_some());
    let goal = Goal { n_cells: n_cells as usize, all, cell_size, is_bound, max_cells: limit };
    Cutter::new(scene, cut, goal, progress)?.run(region).map_err(|stop| match stop {
        Stop::TooMany => PlacesError::TooSmall { cell_size, limit },
        Stop::Cancelled(cancelled) => cancelled.into(),
    })
}

/// A bound on sides that divides the region into more than so many times the limit of cells is refused before any work.
///
/// Large regions hold no more cells than the limit then only if some 7/8 of them are solid or behind backs; how much is solid is not known before the
/// work, so the number is chosen, not derived. If it is too small, rock
/// with a few caves in it is refused, though there were cells enough; whoever cuts it raises the limit. If it is too large, the refusal comes
/// after as many cells were cut as the limit allows, some thousand rays each. No answer depends on it.
const MOST_TIMES: f64 = 8.0;

/// So many boxes without a longer side fill a region, and no fewer do: as many points in it are farther than that apart.
fn n_boxes(region: &Aabb<3>, size: f64) -> f64 {
    (0..3).map(|k| ((region.max[k] - region.min[k]) / size).ceil()).product()
}

/// Where viewers can be: the view region, or the box around all objects, wherever they move.
fn region(scene: &Scene, given: Option<Aabb<3>>) -> Result<Aabb<3>, KdError> {
    let region = match given {
        Some(region) if region.is_empty() => return Err(KdError::ViewRegion),
        Some(region) => region,
        None => {
            let still = scene.bounds();
            let moving = scene.moving().iter().filter_map(|moving| moving.within).filter(|b| !b.is_empty());
            moving.fold(still, |all, b| all.with(b.min).with(b.max))
        }
    };
    if region.is_empty() {
        return Err(KdError::Empty);
    }
    for x in region.min.into_iter().chain(region.max) {
        check_coordinate(x).map_err(KdError::Bounds)?;
    }
    (0..3).find(|&axis| region.min[axis] >= region.max[axis]).map_or(Ok(region), |axis| Err(KdError::Flat { axis }))
}

/// Most parts of the longest side of the region that the default bound makes.
const PARTS: u32 = 16;

/// The smallest whole part of the longest side such that half of the cells, as cubes of that size, fill the region.
fn default_size(region: &Aabb<3>, n_cells: u32) -> f64 {
    let longest = (0..3).map(|k| region.max[k] - region.min[k]).fold(0.0, f64::max);
    let size = |parts: u32| longest / f64::from(parts);
    let fits = |parts: &u32| n_boxes(region, size(*parts)) <= f64::from(n_cells) / 2.0;
    size((2..=PARTS).rev().find(fits).unwrap_or(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_bound_leaves_half_of_the_cells() {
        let size = |sides: [f64; 3], n| default_size(&Aabb { min: [0.0; 3], max: sides }, n);
        assert_eq!(size([8.0; 3], 256), 8.0 / 5.0);
        assert_eq!(size([8.0; 3], 1), 8.0);
        assert_eq!(size([8.0, 8.0, 0.25], 512), 0.5);
        assert_eq!(size([160.0, 1.0, 1.0], 4096), 10.0);
    }
}
