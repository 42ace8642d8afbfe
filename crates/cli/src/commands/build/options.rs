//! How to bake, as arguments. Options that mean nothing for what is baked are refused, not ignored.

use crate::numbers::{share, size};
use crate::region::Region;
use sightlines::bake::{BakeRequest, Gap, Subdivide};

/// How to bake.
#[derive(Debug, Clone, Default, clap::Args)]
pub(crate) struct BakeArgs {
    /// Plans: how to cut into cells: kd (axis-parallel walls only), triangulation, or auto [default: auto]
    #[arg(long, help_heading = "Cells", value_name = "HOW")]
    pub(super) subdivide: Option<Subdivide>,
    /// K-d trees: split only along walls that cover at least this share of a cell, from 0 to 1; 0 uses every wall
    /// [default: 0]
    #[arg(long, help_heading = "Cells", value_name = "X", value_parser = share, allow_hyphen_values = true)]
    tau: Option<f64>,
    /// Scenes in space: the box where eyes can be, in scene units [default: the box of the scene]
    #[arg(long, help_heading = "Cells", value_name = "X0,Y0,Z0,X1,Y1,Z1", allow_hyphen_values = true)]
    view_region: Option<Region>,
    /// Scenes in space: objects smaller than this in every direction, in scene units, are not used as occluders
    /// [default: chosen from the scene]
    #[arg(long, help_heading = "Cells", value_name = "SIZE", value_parser = size, allow_hyphen_values = true)]
    detail_below: Option<f64>,
    /// Plans and scenes in space: how precise coordinates are, in scene units. Plans: ends of walls that miss others by no more than WIDTH
    /// are joined to them. Scenes: walls within WIDTH/2 of a plane across an axis of the building, which may be turned in its file, are taken to lie in
    /// it. Errs towards hidden by no more than that: openings narrower than WIDTH may count as closed, and what is thinner as hidden. 0 takes every
    /// coordinate as it is, and does not err so [default: for plans what the digits of the file explain; for glTF what single
    /// precision explains, about a millionth of the building's size, where that puts many walls into planes; else 0]
    #[arg(long, help_heading = "Method", value_name = "WIDTH", value_parser = size, allow_hyphen_values = true)]
    gap: Option<f64>,
    /// Scenes in space: fail if there are more cells than this [default: 65536]
    #[arg(long, help_heading = "Cells", value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    max_cells: Option<u32>,
    /// Scenes in space: keep the insides of walls and other solids as cells, for eyes that can get into them
    #[arg(long, help_heading = "Cells")]
    keep_solid: bool,
    /// Quake maps and portal files: compute only a coarse bound; fast, and reports much that is hidden as visible
    #[arg(long, help_heading = "Method")]
    pub(crate) fast: bool,
    /// Number of threads; 0 uses every core
    #[arg(long, help_heading = "Method", value_name = "N", default_value_t = 0, value_parser = crate::numbers::threads)]
    pub(crate) threads: usize,
}

impl BakeArgs {
    pub(super) fn request(&self) -> BakeRequest {
        let Self { subdivide, tau, view_region, detail_below, gap, max_cells, keep_solid, fast, threads: _ } = *self;
        BakeRequest {
            subdivide,
            tau,
            view_region: view_region.map(|region| region.0),
            detail_below,
            gap: gap.map_or(Gap::OfFile, Gap::Width),
            max_cells,
            keep_solid,
            fast,
            ..BakeRequest::default()
        }
    }
}
