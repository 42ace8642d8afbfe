//! What one eye sees of its cell's visible set: the five methods, and frustum culling in a tree of boxes.

use super::older::BoxTreeN;
use super::panels::time_against_over;
use super::row::Row;
use super::{ChartError, Family, Settings};
use sightlines::bake::quake::bake_map;
use sightlines::bake::{PlanBakeOptions, PrtOptions, SceneBakeOptions, bake_plan, bake_scene};
use sightlines::cells::Scene;
use sightlines::eye_to_cell::{Doors, Method, Scratch, TableCells, View, VisibleSet, VisibleSubgraph};
use sightlines::formats::quake::{read_bsp, read_prt};
use sightlines::geometry::Aabb;
use sightlines::pvs::{CellId, ObjectId, Table};
use sightlines::scenes::{OfficeOptions, office};
use sightlines::visible_surface::{Camera, FaceMask, Faces, RayCaster, RenderInput, VisibleSurface};
use sightlines::walkthrough::{CameraPose, wander};
use sightlines_benches::chart::Panel;
use sightlines_benches::measure::median;
use sightlines_benches::spec::SceneSpec;
use std::convert::Infallible;
use std::hint::black_box;
use std::time::Instant;

const NAME: &str = "eye_to_cell";
/// Height of the picture, in degrees, and its width by its height.
const ANGLE: f64 = 60.0;
const ASPECT: f64 = 4.0 / 3.0;
/// Of so many frames one is drawn.
const DRAWN: usize = 8;

type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Time against over-estimation of eye-to-cell visibility.
#[derive(Debug, Clone, Copy)]
pub struct EyeToCellFamily;

impl Family for EyeToCellFamily {
    fn name(&self) -> &'static str {
        NAME
    }

    fn title(&self) -> &'static str {
        "Eye to cell: time against over-estimation"
    }

    fn about(&self) -> &'static str {
        "What one eye sees in its current view, on a walk from cell to cell. To the right: microseconds of one query, in \
         the median, its cell known and all in memory. Up, of panels about cells: cells that are left, over those that the exact method leaves. Of \
         panels about polygons: polygons of the objects that are left, over those of objects that a picture shows (192 x 144 pixels by ray casting), \
         which misses what is smaller than a pixel.\n\
         The five methods begin with what the table says that the viewer's cell may see, each leaves no more than the one before. Beside them stands culling by \
         the view volume alone, in a quadtree or octree of the boxes of all cells, or of all objects: it knows of no walls."
    }

    fn measure(&self, settings: &Settings) -> Result<Vec<Row>, ChartError> {
        let mut rows = Vec::new();
        for place in places(settings)? {
            let failed = |e: Failure| ChartError::measure(NAME, &place.name, e);
            one_place(settings, &place, &mut rows).map_err(failed)?;
        }
        Ok(rows)
    }

    fn panels(&self, rows: &[Row]) -> Vec<Panel> {
        let mut panels = time_against_over(rows, "time of a query, microseconds", "left / needed");
        // Queries take microseconds, not milliseconds.
        for point in panels.iter_mut().flat_map(|p| &mut p.series).flat_map(|s| &mut s.points) {
            point.at[0] *= 1e3;
        }
        panels
    }
}

/// A table that is walked through.
struct Place {
    name: String,
    table: Table,
    /// What is drawn, if objects are counted too.
    scene: Option<Scene>,
    up: [f64; 3],
}

fn places(settings: &Settings) -> Result<Vec<Place>, ChartError> {
    let failed = |name: &str| {
        let name = name.to_owned();
        move |e: Failure| ChartError::measure(NAME, &name, e)
    };
    let mut places = Vec::new();
    let rooms = settings.pick(3, 8);
    let name = format!("office {rooms} x {rooms}");
    let plan = office(OfficeOptions { rooms_x: rooms, rooms_y: rooms, ..OfficeOptions::default() });
    let plan = plan.map_err(|e| failed(&name)(e.into()))?;
    let baked = bake_plan(&plan, &PlanBakeOptions::default()).map_err(|e| failed(&name)(e.into()))?;
    places.push(Place { name, table: baked.table, scene: None, up: [0.0; 3] });
    let name = settings.pick("tower:1:3:2:2", "tower:4:6:4:2");
    let scene = name.parse::<SceneSpec>().and_then(|s| s.load()).map_err(|e| failed(name)(e.into()))?;
    let baked = bake_scene(&scene, &SceneBakeOptions::default()).map_err(|e| failed(name)(e.into()))?;
    places.push(Place { name: name.to_owned(), table: baked.table, scene: Some(scene), up: [0.0, 1.0, 0.0] });
    if let Some(data) = &settings.data {
        let path = data.join("quake/e1m1.bsp");
        let table = || -> Result<Table, Failure> {
            Ok(bake_map(&read_bsp(&path)?, &read_prt(path.with_extension("prt"))?, PrtOptions::default())?.table)
        };
        let table = table().map_err(failed("e1m1"))?;
        places.push(Place { name: "e1m1".to_owned(), table, scene: None, up: [0.0, 0.0, 1.0] });
    }
    Ok(places)
}

/// Width of the view in radians.
fn fov() -> f64 {
    2.0 * ((ANGLE.to_radians() / 2.0).tan() * ASPECT).atan()
}

fn view(place: &Place, stand: &CameraPose) -> Result<View, Failure> {
    let ([x, y, _], [dx, dy, _]) = (stand.eye, stand.dir);
    Ok(match place.table.dimension() {
        2 => View::planar([x, y], [dx, dy], fov())?,
        _ => View::perspective_horizontal(stand.eye, stand.dir, place.up, fov(), ASPECT)?,
    })
}

/// What one method leaves, over all frames.
#[derive(Default)]
struct Found {
    /// Seconds of each frame, the least of three tries.
    times: Vec<f64>,
    cells: u64,
    /// Of frames that are drawn: polygons of the objects left, and objects that are shown and not left.
    polygons: u64,
    missed: u64,
    missed_cells: u64,
}

fn one_place(settings: &Settings, place: &Place, rows: &mut Vec<Row>) -> Result<(), Failure> {
    let table = &place.table;
    let cells = TableCells::new(table);
    let subgraphs: Vec<VisibleSubgraph> = (0..table.n_cells() as u32)
        .map(|cell| VisibleSubgraph::prepare(&cells, CellId(cell)))
        .collect::<Result<_, Infallible>>()?;
    let bounds = |min: [f64; 3], max: [f64; 3]| Aabb { min, max };
    let boxes: Vec<Aabb<3>> = table.cells().iter().map(|c| bounds(c.min, c.max)).collect();
    let around = Aabb::around(boxes.iter().flat_map(|b| [b.min, b.max]));
    let diagonal = (0..3).map(|k| (around.max[k] - around.min[k]).powi(2)).sum::<f64>().sqrt();
    let stands = wander(&cells, settings.pick(200, 4000), diagonal / 400.0, 1)?;
    let shown = shown(place, &stands)?;
    let polygons = |o: &u32| u64::from(table.polygons_of(ObjectId(*o)));
    let needed: u64 = shown.iter().flatten().flatten().map(polygons).sum();
    let (mut scratch, mut seen) = (Scratch::new(), VisibleSet::new());
    let mut exact_cells: Vec<Vec<u32>> = Vec::new();
    let mut all: Vec<(String, Found)> = Vec::new();
    // The exact method comes first here, as the others are held against it.
    for method in Method::ALL.into_iter().rev() {
        let mut found = Found::default();
        for (k, stand) in stands.iter().enumerate() {
            let view = view(place, stand)?;
            let at = table.place_at(stand.eye).cells().to_vec();
            let time = (0..3).map(|_| {
                let start = Instant::now();
                seen.clear(table.n_cells(), table.objects().len());
                for cell in &at {
                    method.look(&subgraphs[cell.idx()], &view, &Doors::all_open(), &mut scratch, &mut seen);
                }
                start.elapsed().as_secs_f64()
            });
            found.times.push(time.fold(f64::INFINITY, f64::min));
            found.cells += seen.cells().len() as u64;
            if method == Method::Exact {
                exact_cells.push(seen.cells().iter().map(|c| c.0).collect());
            }
            found.missed_cells += exact_cells[k].iter().filter(|&&c| !seen.has_cell(CellId(c))).count() as u64;
            if let Some(Some(shown)) = shown.get(k) {
                found.polygons += seen.objects().iter().map(|o| &o.0).map(polygons).sum::<u64>();
                found.missed += shown.iter().filter(|o| !seen.has_object(ObjectId(**o))).count() as u64;
            }
        }
        all.push((method.name().to_owned(), found));
    }
    let needed_cells: u64 = exact_cells.iter().map(|c| c.len() as u64).sum();
    all.reverse();
    let objects: Vec<Aabb<3>> = table.objects().iter().map(|o| bounds(o.min, o.max)).collect();
    let mut culled = [Found::default(), Found::default()];
    let (cell_tree, object_tree) = (Tree::new(table.dimension(), boxes), Tree::new(table.dimension(), objects));
    let mut left = Vec::new();
    for (k, stand) in stands.iter().enumerate() {
        let view = view(place, stand)?;
        for (tree, found) in [&cell_tree, &object_tree].into_iter().zip(&mut culled) {
            let time = (0..3).map(|_| {
                let start = Instant::now();
                left.clear();
                tree.cull(&view, &mut left);
                black_box(&left);
                start.elapsed().as_secs_f64()
            });
            found.times.push(time.fold(f64::INFINITY, f64::min));
            left.sort_unstable();
            found.cells += left.len() as u64;
            found.missed_cells += exact_cells[k].iter().filter(|c| left.binary_search(c).is_err()).count() as u64;
            if let Some(Some(shown)) = shown.get(k) {
                found.polygons += left.iter().map(|o| u64::from(table.polygons_of(ObjectId(*o)))).sum::<u64>();
                found.missed += shown.iter().filter(|o| left.binary_search(o).is_err()).count() as u64;
            }
        }
    }
    let tree = if table.dimension() == 2 { "view volume (quadtree)" } else { "view volume (octree)" };
    let [of_cells, of_objects] = culled;
    for (of, by, extra, needed) in
        [("cells", "exact method", of_cells, needed_cells), ("polygons", "picture", of_objects, needed)]
    {
        if needed == 0 {
            continue;
        }
        let mut add = |method: &str, found: &mut Found| {
            let is_cells = of == "cells";
            rows.push(Row {
                size: if is_cells { table.n_cells() as u64 } else { table.objects().len() as u64 },
                size_of: if is_cells { "cells" } else { "objects" }.to_owned(),
                repeats: 3,
                seconds: Some(median(found.times.clone())),
                reported: Some(if is_cells { found.cells } else { found.polygons }),
                truth: Some(needed),
                truth_by: by.to_owned(),
                missed: Some(if is_cells { found.missed_cells } else { found.missed }),
                note: format!("{} frames", stands.len()),
                ..settings.row(NAME, method, &format!("{}: {of}", place.name))
            });
        };
        all.iter_mut().for_each(|(method, found)| add(method, found));
        let mut extra = extra;
        add(tree, &mut extra);
    }
    Ok(())
}

/// A quadtree in the plane, an octree in space.
enum Tree {
    Quad(BoxTreeN<2>),
    Oct(BoxTreeN<3>),
}

impl Tree {
    fn new(dim: u8, boxes: Vec<Aabb<3>>) -> Self {
        if dim == 2 { Self::Quad(BoxTreeN::build(boxes)) } else { Self::Oct(BoxTreeN::build(boxes)) }
    }

    fn cull(&self, view: &View, left: &mut Vec<u32>) {
        match self {
            Self::Quad(tree) => tree.cull(|b| view.may_meet(b), left),
            Self::Oct(tree) => tree.cull(|b| view.may_meet(b), left),
        }
    }
}

/// For frames that are drawn, the objects that a picture shows, ascending. Who looks straight up or down has no picture.
fn shown(place: &Place, stands: &[CameraPose]) -> Result<Vec<Option<Vec<u32>>>, Failure> {
    let Some(scene) = &place.scene else { return Ok(Vec::new()) };
    let faces = Faces::of_scene(scene)?;
    let caster = RayCaster::build(&faces);
    let chosen = FaceMask::all(&faces);
    let one = |stand: &CameraPose| -> Option<Vec<u32>> {
        let at = [0, 1, 2].map(|k| stand.eye[k] + stand.dir[k]);
        let camera = Camera::look_at(stand.eye, at, place.up, ANGLE, [192, 144]).ok()?;
        let image = caster.picture(&RenderInput { faces: &faces, camera: &camera, mask: &chosen }).0;
        let mut objects: Vec<u32> =
            image.faces().iter().filter(|f| faces.ids().contains(f)).map(|&f| faces.object(f)).collect();
        objects.sort_unstable();
        objects.dedup();
        Some(objects)
    };
    Ok(stands.iter().enumerate().map(|(k, s)| if k.is_multiple_of(DRAWN) { one(s) } else { None }).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn methods_are_in_order_and_hide_nothing() {
        let settings = Settings { quick: true, data: None, machine: "test".into(), commit: "test".into() };
        let rows = EyeToCellFamily.measure(&settings).unwrap();
        let mut scenes: Vec<&str> = rows.iter().map(|r| r.scene.as_str()).collect();
        scenes.dedup();
        assert_eq!(scenes.len(), 3, "{scenes:?}");
        for scene in scenes {
            let own: Vec<&Row> = rows.iter().filter(|r| r.scene == scene).collect();
            let left: Vec<u64> = own.iter().map(|r| r.reported.unwrap()).collect();
            let (methods, tree) = left.split_at(Method::ALL.len());
            assert!(methods.is_sorted_by(|a, b| a >= b) && methods[0] > methods[4], "{scene}: {left:?}");
            assert!(tree.len() == 1 && tree[0] > methods[4], "{scene}: {left:?}");
            assert!(own.iter().all(|r| r.missed == Some(0) && r.seconds > Some(0.0)), "{scene}: {own:?}");
        }
    }
}
