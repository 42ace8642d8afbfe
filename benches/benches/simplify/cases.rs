//! Scenes and from where they are looked at.

use sightlines::bake::{SceneBakeOptions, bake_scene};
use sightlines::cells::{CellId, Scene};
use sightlines::formats::scene::BackFaces;
use sightlines::geometry::Aabb;
use sightlines::multifocal::mesh::{PatchOptions, SheetMethod, Sheets, patches_of};
use sightlines::multifocal::{FromRegion, Layout, Multifocal, OccluderSelection, UnionMethod, Volume};
use sightlines::multifocal_cpu::Fast;
use sightlines::pvs::Table;
use sightlines::scenes::{CityOptions, TowerOptions, city, city_crossings, tower, tower_rooms};
use sightlines::simplify::Views;
use sightlines_benches::viewed::{ViewedScene, welded};
use std::error::Error;
use std::sync::Arc;

/// A scene and a place in it.
pub(crate) struct Case {
    pub(crate) name: String,
    pub(crate) view: usize,
    pub(crate) scene: Arc<Scene>,
    pub(crate) views: Views,
    pub(crate) table: Option<Arc<Table>>,
    sheets: Arc<Sheets>,
    chosen: Arc<OccluderSelection>,
}

impl Case {
    /// The multifocal z-buffer with sheets, as the program has it.
    pub(crate) fn method(&self) -> Box<dyn FromRegion + Send> {
        let ends = self.views.parts().iter().flat_map(|v| [v.volume.bounds().min, v.volume.bounds().max]);
        let around = Aabb::around(ends.chain([self.scene.bounds().min, self.scene.bounds().max]));
        let buffers = Multifocal::new(Fast::new(), Arc::clone(&self.chosen), around, Layout::default());
        let sheets = SheetMethod::shared(Arc::clone(&self.sheets));
        Box::new(UnionMethod::new(vec![Box::new(buffers), Box::new(sheets)]))
    }
}

/// The cases of a scene: at most so many views.
pub(crate) fn named(name: &str, n: usize) -> Result<Vec<Case>, Box<dyn Error>> {
    match name {
        "small" => {
            let options = CityOptions { blocks_x: 3, blocks_z: 3, ..CityOptions::default() };
            of_boxes(name, city(options)?, city_crossings(options)?, n)
        }
        "city" => of_boxes(name, city(CityOptions::default())?, city_crossings(CityOptions::default())?, n),
        "tower" => {
            let options = TowerOptions { floors: 4, ..TowerOptions::default() };
            let scene = tower(options)?;
            let baked = bake_scene(&scene, &SceneBakeOptions::default())?;
            let table = Arc::new(baked.table);
            let rooms = some(tower_rooms(options)?.into_iter().map(|r| r.bounds).collect(), n);
            let mut cases = of_boxes(name, scene, rooms, n)?;
            for case in &mut cases {
                // The cells that the room is made of.
                let room = *case.views.parts()[0].volume.bounds();
                let inside = |c: &CellId| {
                    let cell = &table.cells()[c.idx()];
                    room.contains(cell.min) && room.contains(cell.max)
                };
                let cells: Vec<CellId> = (0..table.n_cells() as u32).map(CellId).filter(inside).collect();
                case.views = Views::of_cells(&table, &cells)?;
                case.table = Some(Arc::clone(&table));
            }
            Ok(cases)
        }
        real => {
            let Some(viewed) = ViewedScene::real(real, BackFaces::default())? else { return Ok(Vec::new()) };
            let boxes = viewed.boxes();
            of_boxes(&viewed.name, viewed.scene, boxes, n)
        }
    }
}

/// At most `n` of them, evenly chosen, none at the beginning.
fn some(all: Vec<Aabb<3>>, n: usize) -> Vec<Aabb<3>> {
    let step = all.len().div_ceil(n.max(1)).max(1);
    all.into_iter().skip(step / 2).step_by(step).collect()
}

fn of_boxes(name: &str, scene: Scene, boxes: Vec<Aabb<3>>, n: usize) -> Result<Vec<Case>, Box<dyn Error>> {
    let mesh = welded(&scene);
    let chosen = Arc::new(OccluderSelection::new(patches_of(&mesh, &PatchOptions::default()), 500));
    let sheets = Arc::new(Sheets::of(mesh));
    let scene = Arc::new(scene);
    let case = |(view, b): (usize, Aabb<3>)| {
        Ok(Case {
            name: name.to_owned(),
            view,
            scene: Arc::clone(&scene),
            views: Views::new([Volume::new(b)?])?,
            table: None,
            sheets: Arc::clone(&sheets),
            chosen: Arc::clone(&chosen),
        })
    };
    some(boxes, n).into_iter().enumerate().map(case).collect()
}
