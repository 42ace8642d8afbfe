//! The demo in space: a small furnished tower.

use super::{DemoArgs, Made, bake};
use crate::command::{Done, Verbosity};
use crate::commands::build::space;
use crate::error::{ErrorAbout, Result};
use crate::glb::save_glb;
use crate::output::{self, JsonSchema, Serialize, bytes, percent};
use crate::picture::{self, PictureKind, save_picture};
use sightlines::bake::Report;
use sightlines::formats::scene::read_scene;
use sightlines::pvs::Table;
use sightlines::report::{IsometricOptions, PictureSubject, SliceOptions, isometric_svg, secluded_cell, slice_svg};
use sightlines::scenes::{TowerOptions, tower};
use sightlines::viewer::Figure;
use std::fmt;
use std::path::Path;
use std::time::Instant;

pub(super) fn run(args: &DemoArgs, Verbosity { show_progress, .. }: Verbosity) -> Result<Done> {
    let start = Instant::now();
    let options = TowerOptions { seed: args.seed, floors: 2, rooms_x: 3, rooms_y: 1, ..TowerOptions::default() };
    let [scene_path, table_path] = ["tower.glb", "tower.pvs"].map(|name| args.out.join(name));
    save_glb(&scene_path, &tower(options)?)?;
    // The scene is read back from the file, as `build` would do.
    let file = read_scene(&scene_path)?;
    let read = (&file, &Figure::of_scene(&file.scene));
    let (baked, mut files) = bake(args, ["A small tower", "tower.glb", "tower.pvs"], read, show_progress)?;
    for (name, svg) in pictures(&table_path, &baked.table)? {
        for kind in PictureKind::ENDINGS {
            let picture = format!("tower-{name}.{kind}");
            save_picture(&svg, &args.out.join(&picture))?;
            files.push(picture);
        }
    }
    let Report::Scene(report) = &baked.report else { unreachable!("a scene was baked by sightlines") };
    let demo = Demo {
        n_floors: options.floors,
        built: space::Outcome::new(&table_path, &file, &baked.table, report),
        done: Made::new(args, start, files),
    };
    Ok(Done::new(args.json, demo))
}

/// The cells, and what the largest of those that see less than half of the cells sees: a floor plan at its
/// height, and the boxes.
fn pictures(path: &Path, table: &Table) -> Result<Vec<(&'static str, String)>> {
    let up = picture::up_of(table);
    let viewer = secluded_cell(table);
    let view = viewer.map_or(PictureSubject::Plan, PictureSubject::Cell);
    let below = |view| IsometricOptions { view, up, ..IsometricOptions::default() };
    let mut drawn = vec![
        ("cells", isometric_svg(table, &below(PictureSubject::Plan))),
        ("seen", isometric_svg(table, &below(view))),
    ];
    if let Some(cell) = viewer {
        let height = picture::middle(table, cell, up);
        drawn.push(("floor", slice_svg(table, &SliceOptions { view, up, height, ..SliceOptions::default() })));
    }
    let named = |(name, svg): (&'static str, Result<String, _>)| Ok((name, svg.in_file(path)?));
    drawn.into_iter().map(named).collect()
}

/// What the demo did.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct Demo {
    /// Floors.
    n_floors: u32,
    /// The table.
    built: space::Outcome,
    #[serde(flatten)]
    done: Made,
}

impl fmt::Display for Demo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { n_floors, built, done } = self;
        writeln!(f, "a furnished tower of {} (seed {})", output::count(*n_floors, "floor"), done.seed)?;
        built.write_facts(f)?;
        writeln!(f, "table          {}", bytes(built.table.n_bytes as u64))?;
        done.memory(f)?;
        writeln!(f)?;
        writeln!(f, "A viewer has to draw {} of the polygons; the rest is hidden.", percent(built.viewer.polygons))?;
        done.list_files(f)
    }
}
