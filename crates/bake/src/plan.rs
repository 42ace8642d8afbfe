//! Baking a plan: subdivide, see, tabulate.

use crate::baked::{Baked, BakedPlan};
use crate::error::BakeError;
use crate::mirrors;
use crate::reports::PlanReport;
use crate::stated::GAP;
use crate::stopwatch::Stopwatch;
use crate::subdivide::Subdivide;
use crate::table::{TableOptions, planar_parts};
use sightlines_cells::{CellGraph, Plan, Planar};
use sightlines_progress::Observer;
use sightlines_pvs::{Table, TableKind};
use sightlines_stabtree::{SearchOptions, Zones, planar_visibility};
use std::fmt;

/// How to bake a plan.
#[derive(Clone, Copy)]
pub struct PlanBakeOptions<'a> {
    /// How to cut.
    pub subdivide: Subdivide,
    /// For the k-d tree: the least share of a cell's cross-section that walls on a plane must cover for
    /// the plane to split the cell, 0 to 1. With 0 every wall blocks; above, walls that are left over
    /// do not.
    pub tau: f64,
    /// Number of threads; 0 for one for each core. Changes nothing but the time.
    pub threads: usize,
    /// Chords shot through each exit before the search. Changes nothing but the time.
    pub chords: u32,
    /// Receives reports, and may cancel.
    pub progress: Option<&'a dyn Observer>,
}

impl Default for PlanBakeOptions<'_> {
    fn default() -> Self {
        let search = SearchOptions::default();
        let (threads, chords) = (search.threads, search.chords);
        Self { subdivide: Subdivide::Auto, tau: 0.0, threads, chords, progress: None }
    }
}

impl fmt::Debug for PlanBakeOptions<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("PlanBakeOptions")
            .field("subdivide", &self.subdivide)
            .field("tau", &self.tau)
            .field("threads", &self.threads)
            .field("chords", &self.chords)
            .finish_non_exhaustive()
    }
}

/// Cuts a plan, decides which cells see which, and makes the table.
///
/// A plan that was [joined](crate::Gap::join) is taken with its joints, and the table states its gap; others are taken as they are.
///
/// Exact for plans without rounded crossings (see the triangulation's notes on noding); errs towards
/// visible elsewhere.
///
/// # Errors
/// [`BakeError`] for plans without lines or without a region, and for a `tau` outside 0 to 1.
pub fn bake_plan(plan: &Plan, options: &PlanBakeOptions<'_>) -> Result<BakedPlan, BakeError> {
    let start = Stopwatch::start();
    let (graph, mut report) = cut(plan, options)?;
    report.cut_time = start.elapsed();
    let search = SearchOptions {
        threads: options.threads,
        chords: options.chords,
        progress: options.progress,
        ..SearchOptions::default()
    };
    let start = Stopwatch::start();
    let (rows, found) = planar_visibility(&graph, &Zones::cells(&graph), &search)?;
    report.see_time = start.elapsed();
    report.n_cells = graph.n_cells();
    report.n_portals = graph.portals().len();
    report.n_visible_pairs = (rows.count_ones() - graph.n_cells() as u64) / 2;
    (report.n_pushes, report.n_visits) = (found.n_pushes, found.n_visits);
    let kind = match report.subdivide {
        Subdivide::KdTree => TableKind::PlanKdTree,
        Subdivide::Triangulation => TableKind::PlanTriangulation,
        Subdivide::Auto => unreachable!("a plan was cut by one of the two"),
    };
    // Sources of integers state that nothing was rounded.
    report.n_near_misses = plan.near_misses().len();
    report.n_joints = plan.joints().len();
    let mut info = Vec::new();
    if plan.gap() > 0.0 {
        info.push((GAP.to_owned(), format!("{:?}", plan.gap())));
    }
    info.push(("subdivide".to_owned(), report.subdivide.to_string()));
    if report.subdivide == Subdivide::KdTree {
        info.push(("tau".to_owned(), options.tau.to_string()));
    }
    let mut parts = planar_parts(&graph, rows, TableOptions { objects: plan.objects(), kind, info });
    parts.digest = Some(plan.digest());
    if !plan.mirrors().is_empty() {
        let mirrors = mirrors::of_plan(&graph, plan);
        (report.n_mirror_parts, report.n_lost_mirrors) = (mirrors.parts.len(), mirrors.n_lost);
        parts.mirrors = mirrors.parts;
    }
    Ok(Baked { table: Table::new(parts)?, graph, report })
}

fn cut(plan: &Plan, options: &PlanBakeOptions<'_>) -> Result<(CellGraph<Planar>, PlanReport), BakeError> {
    if !(0.0..=1.0).contains(&options.tau) {
        return Err(sightlines_kdtree::KdError::Tau(options.tau).into());
    }
    let follows_axes = plan.is_axial() && plan.n_groups() == 0;
    let by_tree = match options.subdivide {
        Subdivide::Auto => follows_axes,
        Subdivide::KdTree => true,
        Subdivide::Triangulation => false,
    };
    if by_tree {
        let cut = sightlines_kdtree::subdivide_plan(
            plan,
            &sightlines_kdtree::KdOptions { tau: options.tau, ..Default::default() },
        )?;
        let n_ignored_walls = cut.left_over.len();
        Ok((cut.graph, PlanReport { subdivide: Subdivide::KdTree, n_ignored_walls, ..PlanReport::default() }))
    } else {
        let (graph, did) = sightlines_triangulation::subdivide(plan)?;
        let report = PlanReport {
            subdivide: Subdivide::Triangulation,
            n_rounded_crossings: did.n_rounded_crossings,
            n_dropped_pieces: did.n_dropped_pieces,
            n_disputed_cells: did.n_disputed_cells,
            ..PlanReport::default()
        };
        Ok((graph, report))
    }
}
