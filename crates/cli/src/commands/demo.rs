//! `demo`: the whole road on a generated office floor.

use crate::Answer;
use crate::commands::build::{BakeArgs, Outcome, bake};
use crate::commands::draw::picture;
use crate::error::CliError;
use crate::input::{self, Scene};
use crate::memory;
use crate::output::{self, bytes, percent};
use serde::Serialize;
use sightlines::formats::geojson;
use sightlines::pvs::{CellId, Table};
use sightlines::report::{DrawOptions, View};
use sightlines::scenes::{OfficeOptions, office};
use std::fmt;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Arguments of `demo`.
#[derive(Debug, clap::Args)]
pub(crate) struct DemoArgs {
    /// The folder for the plan, the table and the pictures; files of the same names are replaced
    #[arg(long, value_name = "FOLDER", default_value = "sightlines-demo")]
    out: PathBuf,
    /// Another seed gives another office
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &DemoArgs, show_progress: bool) -> Result<Answer, CliError> {
    let start = Instant::now();
    let folder = &args.out;
    std::fs::create_dir_all(folder).map_err(|source| CliError::Folder { path: folder.clone(), source })?;
    let plan = office(OfficeOptions { seed: args.seed, ..OfficeOptions::default() })
        .expect("the default options make an office");
    let (plan_path, table_path) = (folder.join("plan.geojson"), folder.join("plan.pvs"));
    output::save(&plan_path, geojson::write_plan(&plan).as_bytes())?;
    // The plan is read back from the file, as `build` would do.
    let scene: Scene = input::scene(&plan_path, None)?;
    let baked = bake(&plan_path, &scene, &BakeArgs::standard(), show_progress)?;
    output::save(&table_path, &baked.table.to_bytes())?;
    let mut files = vec!["plan.geojson".to_owned(), "plan.pvs".to_owned()];
    for (name, view) in views(&baked.table) {
        let options = DrawOptions { view, ..DrawOptions::default() };
        for kind in ["svg", "png"] {
            let file = format!("{name}.{kind}");
            picture(&table_path, &baked.table, &options, &folder.join(&file))?;
            files.push(file);
        }
    }
    let demo = Demo {
        folder: folder.display().to_string(),
        seed: args.seed,
        n_walls: plan.lines().len(),
        built: Outcome::new(&table_path, None, &baked),
        seconds: start.elapsed().as_secs_f64(),
        peak_bytes: memory::peak_bytes(),
        files,
    };
    output::print(args.json, &demo)?;
    Ok(Answer::Yes)
}

/// The pictures: the plan, and what is seen from a cell that sees much, a typical one, and a secluded one.
fn views(table: &Table) -> Vec<(&'static str, View)> {
    let mut views = vec![("plan", View::Plan)];
    let ranked = by_seen_floor(table);
    if let Some(last) = ranked.len().checked_sub(1) {
        let at = |share: usize| View::Cell(ranked[last * share / 100]);
        views.extend([("seen-much", at(100)), ("seen-typical", at(50)), ("seen-little", at(5))]);
    }
    views
}

/// The larger half of the cells, by the floor that they see.
fn by_seen_floor(table: &Table) -> Vec<CellId> {
    let area = |cell: &CellId| {
        let record = &table.cells()[cell.idx()];
        (record.max[0] - record.min[0]) * (record.max[1] - record.min[1])
    };
    let mut cells: Vec<CellId> = (0u32..).take(table.n_cells()).map(CellId).collect();
    cells.sort_by(|a, b| area(b).total_cmp(&area(a)).then(a.cmp(b)));
    cells.truncate(cells.len().div_ceil(2));
    let mut ranked: Vec<(f64, CellId)> =
        cells.into_iter().map(|cell| (table.visible(cell).map(|seen| area(&seen)).sum(), cell)).collect();
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    ranked.into_iter().map(|(_, cell)| cell).collect()
}

/// What the demo did.
#[derive(Debug, Serialize)]
struct Demo {
    folder: String,
    seed: u64,
    n_walls: usize,
    built: Outcome,
    seconds: f64,
    /// Null where the system does not tell.
    peak_bytes: Option<u64>,
    /// In the folder.
    files: Vec<String>,
}

impl fmt::Display for Demo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let table = &self.built.table;
        writeln!(f, "an office floor of {} walls (seed {}), cut by {}", self.n_walls, self.seed, self.built.method())?;
        write!(f, "{}", self.built.facts())?;
        writeln!(f, "table          {}", bytes(table.n_bytes as u64))?;
        writeln!(f, "time           {}", self.built.times())?;
        if let Some(peak) = self.peak_bytes {
            writeln!(f, "memory         {} at most", bytes(peak))?;
        }
        writeln!(f)?;
        writeln!(f, "A viewer has to draw {} of the floor; the rest is hidden.", percent(table.mean_floor_share))?;
        writeln!(f, "Pictures and table are in {}:", self.folder)?;
        self.files.iter().try_for_each(|file| writeln!(f, "  {}", Path::new(&self.folder).join(file).display()))
    }
}
