//! Fewer triangles for a volume of viewpoints: what rays find changed, against what is left and against time.

use super::panels::{Layout as PanelLayout, by_scene};
use super::row::Row;
use super::{ChartError, Family, Settings};
use sightlines::cells::Scene;
use sightlines::geometry::{Aabb, Point3};
use sightlines::multifocal::mesh::{PatchOptions, SheetMethod, Sheets, patches};
use sightlines::multifocal::{FromRegion, Layout, Multifocal, OccluderSelection, UnionMethod, Volume};
use sightlines::multifocal_cpu::Fast;
use sightlines::scenes::{CityOptions, TowerOptions, city, city_crossings, tower, tower_rooms};
use sightlines::simplify::{
    HiddenBy, MeasureOptions, PreparedScene, Simplified, SimplifyOptions, Views, geometric, measure,
};
use sightlines_benches::chart::Panel;
use std::sync::Arc;
use std::time::Instant;

const NAME: &str = "speed_simplify";

type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Changed pixels against triangles left.
#[derive(Debug, Clone, Copy)]
pub struct SimplifyFamily;

impl Family for SimplifyFamily {
    fn name(&self) -> &'static str {
        NAME
    }

    fn title(&self) -> &'static str {
        "Simplification: what is changed against what is left"
    }

    fn about(&self) -> &'static str {
        "A scene simplified for all eyes in one box, at several budgets. Up: the share of directions from the worst of some fresh eyes in which the first hit is another one; 0 \
         has a place of its own. To the right: the share of triangles that is left, or in the panels about time, seconds to simplify, without finding \
         what is hidden, which is done once for all budgets and is in the notes. Ours bounds what each face can intercept of the view, promises the \
         budget, and may merge what lies in one plane; the ordinary metric of shape, quadrics, knows of no eyes and is given the same count. meshoptimizer is measured by the \
         bench `simplify`, built with it; see simplify.md beside this page."
    }

    fn measure(&self, settings: &Settings) -> Result<Vec<Row>, ChartError> {
        let mut rows = Vec::new();
        for case in cases(settings)? {
            all_budgets(settings, &case, &mut rows).map_err(|e| ChartError::measure(NAME, &case.name, e))?;
        }
        Ok(rows)
    }

    fn panels(&self, rows: &[Row]) -> Vec<Panel> {
        let left = |r: &Row| Some([r.reported? as f64 / r.size as f64, r.error?]);
        let time = |r: &Row| Some([r.seconds?, r.error?]);
        let panels = |x: &str, at: &dyn Fn(&Row) -> Option<[f64; 2]>| {
            by_scene(rows, &PanelLayout { names: [x, "share of directions changed, worst eye"], at, has_front: true })
        };
        let pairs = panels("share of triangles left", &left).into_iter().zip(panels("seconds to simplify", &time));
        pairs.flat_map(|(a, b)| [a, b]).collect()
    }
}

/// A scene and a box of viewpoints.
struct Case {
    name: String,
    scene: Arc<Scene>,
    view: Aabb<3>,
}

fn cases(settings: &Settings) -> Result<Vec<Case>, ChartError> {
    let middle = |mut boxes: Vec<Aabb<3>>| {
        let place = boxes.len() / 2;
        boxes.swap_remove(place)
    };
    let made = || -> Result<Vec<Case>, Failure> {
        let blocks = settings.pick(2, 6);
        let of_city = CityOptions { blocks_x: blocks, blocks_z: blocks, ..CityOptions::default() };
        let of_tower = if settings.quick {
            TowerOptions { floors: 1, rooms_x: 2, rooms_y: 1, furniture: 1, ..TowerOptions::default() }
        } else {
            TowerOptions { floors: 2, ..TowerOptions::default() }
        };
        let rooms = tower_rooms(of_tower)?.into_iter().map(|r| r.bounds).collect();
        Ok(vec![
            Case { name: "city".to_owned(), scene: Arc::new(city(of_city)?), view: middle(city_crossings(of_city)?) },
            Case { name: "tower".to_owned(), scene: Arc::new(tower(of_tower)?), view: middle(rooms) },
        ])
    };
    made().map_err(|e| ChartError::measure(NAME, "generated scenes", e))
}

fn all_budgets(settings: &Settings, case: &Case, rows: &mut Vec<Row>) -> Result<(), Failure> {
    let triangles: Vec<[Point3; 3]> = case.scene.objects().iter().flat_map(|o| o.corners()).collect();
    let sheets = Arc::new(Sheets::new(&triangles));
    let chosen = Arc::new(OccluderSelection::new(patches(&triangles, &PatchOptions::default()), 500));
    let bounds = case.scene.bounds();
    let around = Aabb::around([case.view.min, case.view.max, bounds.min, bounds.max]);
    let make = || -> Box<dyn FromRegion + Send> {
        let buffers = Multifocal::new(Fast::new(), Arc::clone(&chosen), around, Layout::default());
        Box::new(UnionMethod::new(vec![Box::new(buffers), Box::new(SheetMethod::shared(Arc::clone(&sheets)))]))
    };
    let views = Views::new([Volume::new(case.view)?])?;
    let by = HiddenBy { method: Some(&make), table: None };
    let start = Instant::now();
    let prepared = PreparedScene::new(&case.scene, &views, &by, &SimplifyOptions::default())?;
    let hiding = start.elapsed().as_secs_f64();
    let (n_eyes, n_rays) = settings.pick((4, 2000), (12, 30_000));
    let mut add = |method: String, of: &Simplified, seconds: f64, repeats: u32, note: String| -> Result<(), Failure> {
        let found = measure(&case.scene, of, &views, &MeasureOptions { n_eyes, n_rays, ..MeasureOptions::default() })?;
        rows.push(Row {
            size: of.counts.before as u64,
            size_of: "triangles".to_owned(),
            repeats,
            seconds: Some(seconds),
            reported: Some(of.counts.left as u64),
            truth_by: format!("{n_rays} rays of each of {n_eyes} eyes"),
            error: Some(found.worst),
            note,
            ..settings.row(NAME, &method, &case.name)
        });
        Ok(())
    };
    let budgets: &[f64] = settings.pick(&[0.0, 1e-2], &[0.0, 1e-4, 1e-3, 1e-2, 1e-1]);
    for &budget in budgets {
        for (name, flat) in [("ours", false), ("ours (planes merged)", true)] {
            let options = SimplifyOptions { budget, flat, ..SimplifyOptions::default() };
            let (ours, seconds, repeats) = settings.best_of(|| prepared.simplify(&options));
            let ours = ours?;
            let note = format!("hidden faces found in {hiding:.3e} s; promised {:.3e}", ours.bound);
            add(format!("{name}: budget {budget}"), &ours, seconds, repeats, note)?;
            if !flat {
                let (shape, seconds, repeats) = settings.best_of(|| geometric(&case.scene, ours.counts.left));
                add(format!("shape alone: at the count of budget {budget}"), &shape?, seconds, repeats, String::new())?;
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_changed_without_a_budget() {
        let settings = Settings { quick: true, data: None, machine: "test".into(), commit: "test".into() };
        let case = cases(&settings).unwrap().pop().unwrap();
        let mut rows = Vec::new();
        all_budgets(&settings, &case, &mut rows).unwrap();
        assert_eq!(rows.len(), 6, "two budgets, three ways");
        let ours: Vec<&Row> = rows.iter().filter(|r| r.method.starts_with("ours")).collect();
        assert!(ours.iter().all(|r| r.reported < Some(r.size) && r.error.unwrap() <= 0.02), "{ours:?}");
        let free = ours.iter().filter(|r| r.method.ends_with("budget 0"));
        assert_eq!(free.filter(|r| r.error == Some(0.0)).count(), 2);
        let shape = rows.iter().filter(|r| r.method.starts_with("shape")).map(|r| r.error.unwrap());
        assert!(shape.fold(0.0, f64::max) > 0.02, "a metric without eyes changes more");
        assert_eq!(SimplifyFamily.panels(&rows).len(), 2);
    }
}
