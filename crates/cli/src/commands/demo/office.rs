//! The demo in the plane: an office floor.

use super::{DemoArgs, Made, bake};
use crate::command::{Done, Verbosity};
use crate::commands::build::plan;
use crate::error::Result;
use crate::output::{self, JsonSchema, Serialize, bytes, percent};
use crate::picture::{PictureKind, draw_plan, save_picture};
use sightlines::bake::Report;
use sightlines::formats::geojson;
use sightlines::pvs::Table;
use sightlines::report::{DrawOptions, PictureSubject, cells_by_seen_floor};
use sightlines::scenes::{OfficeOptions, office};
use sightlines::viewer::Figure;
use std::fmt;
use std::time::Instant;

pub(super) fn run(args: &DemoArgs, Verbosity { show_progress, .. }: Verbosity) -> Result<Done> {
    let start = Instant::now();
    let folder = &args.out;
    let office = office(OfficeOptions { seed: args.seed, ..OfficeOptions::default() })
        .expect("the default options make an office");
    let (plan_path, table_path) = (folder.join("plan.geojson"), folder.join("plan.pvs"));
    output::save(&plan_path, geojson::write_plan(&office).as_bytes())?;
    // The plan is read back from the file, as `build` would do.
    let floor = geojson::read_plan(&plan_path)?;
    let read = (&floor, &Figure::of_plan(&floor));
    let (baked, mut files) = bake(args, ["An office floor", "plan.geojson", "plan.pvs"], read, show_progress)?;
    for (name, view) in views(&baked.table) {
        let options = DrawOptions { view, ..DrawOptions::default() };
        for kind in PictureKind::ENDINGS {
            let file = format!("{name}.{kind}");
            let svg = draw_plan(&table_path, &baked.table, &options)?;
            save_picture(&svg, &folder.join(&file))?;
            files.push(file);
        }
    }
    let Report::Plan(report) = &baked.report else { unreachable!("a plan was baked") };
    let demo = Demo {
        n_walls: office.lines().len(),
        built: plan::Outcome::new(&table_path, None, &baked.table, report),
        done: Made::new(args, start, files),
    };
    Ok(Done::new(args.json, demo))
}

/// The pictures: the plan, and what is seen from a cell that sees much, a typical one, and a secluded one.
fn views(table: &Table) -> Vec<(&'static str, PictureSubject)> {
    let mut views = vec![("plan", PictureSubject::Plan)];
    let ranked = cells_by_seen_floor(table);
    if let Some(last) = ranked.len().checked_sub(1) {
        let at = |share: usize| PictureSubject::Cell(ranked[last * share / 100]);
        views.extend([("seen-much", at(100)), ("seen-typical", at(50)), ("seen-little", at(5))]);
    }
    views
}

/// What the demo did.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct Demo {
    /// Walls of the plan.
    n_walls: usize,
    /// The table.
    built: plan::Outcome,
    #[serde(flatten)]
    done: Made,
}

impl fmt::Display for Demo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { n_walls, built, done } = self;
        writeln!(f, "an office floor of {n_walls} walls (seed {}), cut by {}", done.seed, built.subdivision())?;
        write!(f, "{}", built.table)?;
        writeln!(f, "table          {}", bytes(built.table.n_bytes as u64))?;
        writeln!(f, "time           {}", built.times())?;
        done.memory(f)?;
        writeln!(f)?;
        let share = percent(built.table.mean_floor_share);
        writeln!(f, "A viewer has to draw {share} of the floor; the rest is hidden.")?;
        done.list_files(f)
    }
}
