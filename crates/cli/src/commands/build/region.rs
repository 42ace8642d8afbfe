//! From a scene in space to its table by what is hidden from whole cells.

use super::BakeArgs;
use super::Error;
use super::space::informed;
use super::view_cells::ViewCellsArgs;
use crate::buffers::{BufferArgs, MethodFailed};
use crate::facts::{Facts, Stated};
use crate::output::{bytes, count, percent, seconds};
use crate::progress::Bar;
use serde::Serialize;
use sightlines::bake::auto::SceneChoice;
use sightlines::bake::methods::{OcclusionMethod, OcclusionMethodFactory};
use sightlines::bake::region::grid;
use sightlines::bake::{BakedRegions, CellsFrom, RegionBakeOptions, bake_regions};
use sightlines::formats::SceneFile;
use sightlines::multifocal::Split;
use sightlines::report::{Summary, ViewerShare};
use std::fmt;
use std::path::Path;

/// The method that computes visibility, for scenes in space.
#[derive(Debug, Clone, clap::Args)]
pub(crate) struct RegionArgs {
    /// Scenes in space: sightlines (through portals; axis-aligned walls occlude), multifocal (from whole cells; any
    /// surfaces occlude), both (hides what either hides), or shafts and voxels (older methods, for comparison). auto,
    /// for any input, measures it, chooses the methods and prints the reasons [default: sightlines]
    #[arg(long, value_name = "HOW")]
    method: Option<Method>,
    #[command(flatten)]
    cells: ViewCellsArgs,
    /// Scenes in space: use a grid of boxes as cells, in the view region or the box of the scene
    #[arg(long, value_name = "NX,NY,NZ", value_parser = counts, conflicts_with = "cells")]
    grid: Option<[u32; 3]>,
    #[command(flatten)]
    buffers: BufferArgs,
    /// Multifocal: how often a cell may be halved where much is in doubt
    #[arg(long, value_name = "N", default_value_t = Split::default().depth, value_parser = clap::value_parser!(u32).range(0..=12))]
    split: u32,
}

/// Who says what is hidden.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Method {
    Auto,
    Sightlines,
    Multifocal,
    Both,
    /// View shafts: one flat occluder cuts all lines between a cell and an object
    Shafts,
    /// Voxels inside closed surfaces, extended to blockers
    Voxels,
}

fn counts(text: &str) -> Result<[u32; 3], String> {
    let parts: Vec<u32> = text.split(',').map(|n| n.trim().parse().unwrap_or(0)).collect();
    match <[u32; 3]>::try_from(parts) {
        Ok(n) if n.iter().all(|&n| n > 0) => Ok(n),
        _ => Err("not three numbers from 1 on, with commas between".to_owned()),
    }
}

impl RegionArgs {
    /// Whether the method is to be chosen.
    pub(super) fn is_auto(&self) -> bool {
        self.method == Some(Method::Auto)
    }

    /// What a choice stands for. What is not asked keeps its arguments, which mean nothing then.
    pub(super) fn chosen(&self, choice: &SceneChoice) -> Self {
        let mut chosen = self.clone();
        chosen.method = Some(if choice.asks_a_method() { Method::Both } else { Method::Sightlines });
        (chosen.buffers.planes, chosen.buffers.texels) = (choice.planes, choice.texels);
        if !choice.sheets {
            chosen.buffers.sheets = 0;
        }
        chosen
    }

    /// Whether anything but sight lines through a k-d tree was requested.
    pub(super) fn is_given(&self) -> bool {
        self.method.is_some_and(|m| m != Method::Sightlines) || self.has_boxes()
    }

    /// Whether cells are boxes from elsewhere.
    pub(super) fn has_boxes(&self) -> bool {
        self.cells.is_given() || self.grid.is_some()
    }

    /// Options that mean something for scenes in space only.
    pub(super) fn of_space(&self) -> [(&'static str, bool); 3] {
        [
            ("--method", self.method.is_some() && !self.is_auto()),
            ("--cells", self.cells.is_given()),
            ("--grid", self.grid.is_some()),
        ]
    }
}

/// Builds the table of a scene that came from `path`.
pub(super) fn bake(
    path: &Path,
    file: &SceneFile,
    args: &BakeArgs,
    region: &RegionArgs,
    show_progress: bool,
) -> Result<BakedRegions, Error> {
    args.check_for_space(path)?;
    let failed = |source| Error::BakeRegion { path: path.to_owned(), source };
    let cut = args.cut();
    let cells = match (region.cells.read()?, region.grid) {
        (Some(cells), _) => CellsFrom::Boxes(cells),
        (None, Some(n)) => {
            let around = cut.view_region.unwrap_or_else(|| file.scene.bounds());
            let cells = grid(&around, n).map_err(|source| Error::Grid { path: path.to_owned(), source })?;
            CellsFrom::Boxes(cells)
        }
        (None, None) => CellsFrom::KdTree,
    };
    let method = region.method.unwrap_or(Method::Sightlines);
    let method_of_cells = match method {
        Method::Auto | Method::Sightlines => None,
        Method::Multifocal | Method::Both => Some(OcclusionMethod::Multifocal),
        Method::Shafts => Some(OcclusionMethod::Shafts),
        Method::Voxels => Some(OcclusionMethod::Voxels),
    };
    let options = region.buffers.options();
    let unfit = |source| MethodFailed { path: path.to_owned(), source };
    options.check().map_err(|source| unfit(source.into()))?;
    let prepare = |method| OcclusionMethodFactory::new(method, &file.scene, &options).map_err(unfit);
    let factory = method_of_cells.map(prepare).transpose()?;
    let make = || factory.as_ref().expect("only called if there is one").instance();
    let bar = Bar::new("visibility", show_progress);
    let options = RegionBakeOptions {
        cells: &cells,
        method: factory.is_some().then_some(&make),
        sightlines: matches!(method, Method::Auto | Method::Sightlines | Method::Both),
        split: Split { depth: region.split, ..Split::default() },
        cut,
        portals: args.portal_mode(),
        threads: args.threads,
        progress: Some(&bar),
    };
    let baked = bake_regions(&file.scene, &options);
    drop(bar);
    let baked = baked.map_err(failed)?;
    let table = informed(baked.table, &file.info).map_err(|error| failed(error.into()))?;
    Ok(BakedRegions { table, ..baked })
}

/// What was built.
#[derive(Debug, Serialize)]
pub(super) struct Outcome {
    out: String,
    #[serde(flatten)]
    stated: Stated,
    /// `kd` or `boxes`.
    subdivide: &'static str,
    /// The method that computed the visibility.
    method: String,
    n_triangles: usize,
    #[serde(flatten)]
    pub(super) table: Summary,
    /// What a viewer sees on average, each place of the same weight.
    viewer: ViewerShare,
    /// Pairs of a cell and an object that it may see.
    n_objects_seen: u64,
    /// Volumes that the method was run for: cells, and parts of cells.
    n_volumes: u64,
    /// Questions whether a box, or a triangle, is hidden.
    n_asked: u64,
    seconds: f64,
}

impl Outcome {
    pub(super) fn new(out: &Path, file: &SceneFile, region: &RegionArgs, baked: &BakedRegions) -> Self {
        let triangles: Vec<u64> = file.scene.objects().iter().map(|o| o.triangles.len() as u64).collect();
        let asked = &baked.effort.asked;
        Self {
            out: out.display().to_string(),
            stated: Stated::new(&file.info),
            subdivide: if region.has_boxes() { "boxes" } else { "kd" },
            method: baked.table.info_value("method").unwrap_or_default().to_owned(),
            n_triangles: file.info.n_triangles,
            table: Summary::of(&baked.table),
            viewer: ViewerShare::of(&baked.table, &triangles),
            n_objects_seen: baked.n_objects_seen,
            n_volumes: baked.effort.n_volumes,
            n_asked: asked.groups + asked.boxes + asked.triangles,
            seconds: baked.time.as_secs_f64(),
        }
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "wrote {}, {}", self.out, bytes(self.table.n_bytes as u64))?;
        writeln!(f, "scene          {}", self.stated)?;
        let cells = if self.subdivide == "kd" { "the cells of a k-d tree" } else { "boxes as cells" };
        writeln!(f, "method         {}, {cells}", self.method)?;
        writeln!(f, "triangles      {}", self.n_triangles)?;
        write!(f, "{}", Facts(&self.table))?;
        let [polygons, objects, cells] = [self.viewer.polygons, self.viewer.objects, self.viewer.cells].map(percent);
        writeln!(
            f,
            "a viewer has   {polygons} of the polygons on average, {objects} of the objects, {cells} of the cells"
        )?;
        writeln!(f, "objects        {} of cells and objects may be seen", count(self.n_objects_seen, "pair"))?;
        if self.n_volumes > 0 {
            writeln!(f, "effort         {}, {} questions", count(self.n_volumes, "volume"), self.n_asked)?;
        }
        writeln!(f, "time           {}", seconds(std::time::Duration::from_secs_f64(self.seconds)))
    }
}
