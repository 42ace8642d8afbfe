//! What is hidden from whole volumes of viewpoints: multifocal buffers in their forms, beside older methods.

use super::panels::time_against_over;
use super::row::Row;
use super::{ChartError, Family, Settings};
use sightlines::cells::Scene;
use sightlines::formats::scene::read_scene;
use sightlines::formats::view_cells::read_view_cells;
use sightlines::from_region::{ViewShafts, VoxelOptions, Voxels};
use sightlines::geometry::{Aabb, Point3};
use sightlines::multifocal::mesh::{PatchOptions, SheetMethod, Sheets, patches};
use sightlines::multifocal::{
    FromRegion, Layout, Measure, Multifocal, MultifocalBackend, Occludees, OccluderSelection, RaySampler, Split,
    UnionMethod, Volume, adaptive,
};
use sightlines::multifocal_cpu::{Fast, Reference};
use sightlines::scenes::{CityOptions, TowerOptions, city, city_crossings, tower, tower_rooms};
use sightlines_benches::chart::Panel;
use sightlines_testkit::RayScene;
use std::sync::Arc;
use std::time::Instant;

const NAME: &str = "multifocal";

type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Time against over-estimation of methods for volumes of viewpoints.
#[derive(Debug, Clone, Copy)]
pub struct MultifocalFamily;

impl Family for MultifocalFamily {
    fn name(&self) -> &'static str {
        NAME
    }

    fn title(&self) -> &'static str {
        "From a volume of viewpoints: time against over-estimation"
    }

    fn about(&self) -> &'static str {
        "Which objects are hidden from all eyes in a box. Up: pairs of a box and an object that a method calls visible, over those that \
         many random rays were seen to reach; rays miss some, so 1 cannot be expected. To the right: milliseconds for one box, on one thread, without \
         what is prepared once for a scene, which is in the notes.\n\
         Multifocal buffers by measure (joined: 1, 4, 9 and 17 planes on each side), with heights carried from plane to plane, and by resolution (joined: 32 to 512 \
         texels along a side, 9 planes); in whole numbers as shipped, and by the slow reference in floats for small resolutions; on a graphics device where the program is built \
         with one and finds it; sheets alone and together with buffers, as shipped; boxes cut further where in doubt. Beside them the older methods: \
         view shafts, and voxels with blocker extension."
    }

    fn measure(&self, settings: &Settings) -> Result<Vec<Row>, ChartError> {
        let mut rows = Vec::new();
        for case in cases(settings)? {
            let failed = |e: Failure| ChartError::measure(NAME, &case.name, e);
            all_methods(settings, &case, contenders(settings, &case), &mut rows).map_err(failed)?;
        }
        Ok(rows)
    }

    fn panels(&self, rows: &[Row]) -> Vec<Panel> {
        time_against_over(rows, "time of a box of viewpoints, ms", "objects called visible / reached by rays")
    }
}

/// A scene, and boxes in which the eye is.
struct Case {
    name: String,
    scene: Scene,
    boxes: Vec<Aabb<3>>,
}

/// At most `n` of them, evenly chosen.
fn some(all: Vec<Aabb<3>>, n: usize) -> Vec<Aabb<3>> {
    let step = all.len().div_ceil(n.max(1)).max(1);
    all.into_iter().step_by(step).collect()
}

fn cases(settings: &Settings) -> Result<Vec<Case>, ChartError> {
    let failed = |name: &'static str| move |e: Failure| ChartError::measure(NAME, name, e);
    let (n, blocks) = settings.pick((2, 3), (6, 6));
    let options = CityOptions { blocks_x: blocks, blocks_z: blocks, ..CityOptions::default() };
    let made = || -> Result<Case, Failure> {
        Ok(Case { name: "city".to_owned(), scene: city(options)?, boxes: some(city_crossings(options)?, n) })
    };
    let mut cases = vec![made().map_err(failed("city"))?];
    let options = if settings.quick {
        TowerOptions { floors: 1, rooms_x: 2, rooms_y: 2, furniture: 1, ..TowerOptions::default() }
    } else {
        TowerOptions { floors: 2, ..TowerOptions::default() }
    };
    let made = || -> Result<Case, Failure> {
        let rooms = tower_rooms(options)?.into_iter().map(|room| room.bounds).collect();
        Ok(Case { name: "tower".to_owned(), scene: tower(options)?, boxes: some(rooms, n) })
    };
    cases.push(made().map_err(failed("tower"))?);
    if let Some(data) = &settings.data {
        for (name, cells) in [("sponza", "cells_walk"), ("duplex", "cells_rooms")] {
            let folder = data.join("scenes").join(name);
            let read = || -> Result<Case, Failure> {
                let scene = read_scene(folder.join(format!("{name}.glb")))?.scene;
                let cells = read_view_cells(folder.join(format!("{cells}.json")))?.cells;
                Ok(Case { name: name.to_owned(), scene, boxes: some(cells.into_iter().map(|c| c.bounds).collect(), n) })
            };
            cases.push(read().map_err(failed(name))?);
        }
    }
    Ok(cases)
}

/// Makes a method for a scene.
type Make<'a> = Box<dyn Fn() -> Result<Box<dyn FromRegion>, Failure> + 'a>;

/// A method's name, how it is made, and how often boxes are cut.
struct Contender<'a> {
    name: String,
    make: Make<'a>,
    depth: u32,
}

fn triangles(case: &Case) -> Vec<[Point3; 3]> {
    case.scene.objects().iter().flat_map(|o| o.corners()).collect()
}

fn buffers<B: MultifocalBackend + 'static>(
    case: &Case,
    backend: B,
    chosen: Arc<OccluderSelection>,
    layout: Layout,
) -> Multifocal<B> {
    let ends = case.boxes.iter().flat_map(|b| [b.min, b.max]);
    let around = Aabb::around(ends.chain([case.scene.bounds().min, case.scene.bounds().max]));
    Multifocal::new(backend, chosen, around, layout)
}

fn chosen(case: &Case) -> Arc<OccluderSelection> {
    Arc::new(OccluderSelection::new(patches(&triangles(case), &PatchOptions::default()), 500))
}

fn contenders<'a>(settings: &Settings, case: &'a Case) -> Vec<Contender<'a>> {
    let mut contenders: Vec<Contender<'a>> = Vec::new();
    let mut add = |name: String, depth: u32, make: Make<'a>| contenders.push(Contender { name, make, depth });
    let fast = |layout: Layout| -> Make<'a> {
        Box::new(move || Ok(Box::new(buffers(case, Fast::new(), chosen(case), layout))))
    };
    let planes: &[u32] = settings.pick(&[1, 4], &[1, 4, 9, 17]);
    for measure in [Measure::Euclid, Measure::VertexHeight, Measure::SectionHeight] {
        for &planes in planes {
            let layout = Layout { planes, measure, carry: false, ..Layout::default() };
            add(format!("{}: {planes} planes", measure.name()), 0, fast(layout));
        }
    }
    for &planes in planes.iter().filter(|n| **n > 1) {
        let layout = Layout { planes, measure: Measure::SectionHeight, carry: true, ..Layout::default() };
        add(format!("height (carried): {planes} planes"), 0, fast(layout));
    }
    let texels: &[u32] = settings.pick(&[32, 64], &[32, 64, 128, 256, 512]);
    for &texels in texels {
        add(format!("height (by resolution): {texels} texels"), 0, fast(Layout { texels, ..Layout::default() }));
    }
    let slow: &[u32] = settings.pick(&[16], &[16, 32]);
    for &texels in slow {
        let layout = Layout { texels, ..Layout::default() };
        add(
            format!("height (float reference): {texels} texels"),
            0,
            Box::new(move || Ok(Box::new(buffers(case, Reference, chosen(case), layout)))),
        );
    }
    add("sheets".to_owned(), 0, Box::new(|| Ok(Box::new(SheetMethod::new(&triangles(case))))));
    let shipped = || -> Result<Box<dyn FromRegion>, Failure> {
        let sheets = SheetMethod::shared(Arc::new(Sheets::new(&triangles(case))));
        let buffers = buffers(case, Fast::new(), chosen(case), Layout::default());
        Ok(Box::new(UnionMethod::new(vec![Box::new(buffers), Box::new(sheets)])))
    };
    add("buffers and sheets (shipped)".to_owned(), 0, Box::new(shipped));
    if !settings.quick {
        add("the same with boxes cut twice".to_owned(), 2, Box::new(shipped));
    }
    let shafts = || -> Result<Box<dyn FromRegion>, Failure> {
        Ok(Box::new(ViewShafts::new(patches(&triangles(case), &PatchOptions::default()))))
    };
    add("view shafts".to_owned(), 0, Box::new(shafts));
    let voxels =
        || -> Result<Box<dyn FromRegion>, Failure> { Ok(Box::new(Voxels::new(&case.scene, VoxelOptions::default())?)) };
    add("voxels".to_owned(), 0, Box::new(voxels));
    add("graphics device".to_owned(), 0, Box::new(|| on_device(case)));
    contenders
}

/// Buffers by the first graphics device that is found, as compute.
#[cfg(feature = "gpu")]
fn on_device(case: &Case) -> Result<Box<dyn FromRegion>, Failure> {
    use sightlines::multifocal_gpu::{GpuBackend, GpuPath};
    let backend = GpuBackend::open(GpuPath::Compute).map_err(|e| NoDevice(format!("no device: {e}")))?;
    Ok(Box::new(buffers(case, backend, chosen(case), Layout::default())))
}

/// The program is built without.
#[cfg(not(feature = "gpu"))]
fn on_device(_: &Case) -> Result<Box<dyn FromRegion>, Failure> {
    Err(Box::new(NoDevice("no device".to_owned())))
}

/// There is nothing to measure; the text says why.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
struct NoDevice(String);

fn all_methods(
    settings: &Settings,
    case: &Case,
    contenders: Vec<Contender<'_>>,
    rows: &mut Vec<Row>,
) -> Result<(), Failure> {
    let n_rays = settings.pick(20_000, 300_000);
    let rays = RayScene::new(&case.scene);
    let seen_from = |b: &Aabb<3>| {
        let mut seen = vec![false; case.scene.objects().len()];
        rays.witness_objects(*b, 9, n_rays).into_iter().for_each(|o| seen[o as usize] = true);
        seen
    };
    let seen: Vec<Vec<bool>> = case.boxes.iter().map(seen_from).collect();
    let n_seen = seen.iter().flatten().filter(|s| **s).count() as u64;
    let objects: Vec<Vec<[Point3; 3]>> = case.scene.objects().iter().map(|o| o.corners().collect()).collect();
    let witness = RaySampler::new(objects.iter().map(|o| &o[..]));
    let occludees = Occludees::new(objects.clone());
    for contender in contenders {
        let row = Row {
            size: case.scene.n_triangles() as u64,
            size_of: "triangles".to_owned(),
            ..settings.row(NAME, &contender.name, &case.name)
        };
        let start = Instant::now();
        let mut method = match (contender.make)() {
            Ok(method) => method,
            Err(error) if error.is::<NoDevice>() => {
                rows.push(Row { note: super::row::clean(&error.to_string()), ..row });
                continue;
            }
            Err(error) => return Err(error),
        };
        let prepare = start.elapsed().as_secs_f64();
        let split = Split { depth: contender.depth, ..Split::default() };
        let mut ask = || -> Result<[u64; 2], Failure> {
            let mut found = [0; 2];
            for (b, seen) in case.boxes.iter().zip(&seen) {
                let volume = Volume::new(*b)?;
                let mut visible = vec![true; occludees.len()];
                adaptive::see(&mut *method, &occludees, &witness, &volume, &split, &mut visible, &mut |_| ())?;
                found[0] += visible.iter().filter(|v| **v).count() as u64;
                found[1] += visible.iter().zip(seen).filter(|(visible, seen)| **seen && !**visible).count() as u64;
            }
            Ok(found)
        };
        let (found, seconds, repeats) = settings.best_of(&mut ask);
        let [reported, missed] = found?;
        rows.push(Row {
            repeats,
            seconds: Some(seconds / case.boxes.len() as f64),
            reported: Some(reported),
            truth: Some(n_seen),
            truth_by: format!("{n_rays} rays a box"),
            missed: Some(missed),
            note: format!("prepared in {prepare:.3e} s; {} boxes", case.boxes.len()),
            ..row
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn methods_hide_nothing_that_rays_reach() {
        let settings = Settings { quick: true, data: None, machine: "test".into(), commit: "test".into() };
        let options = CityOptions { blocks_x: 2, blocks_z: 2, ..CityOptions::default() };
        let boxes = some(city_crossings(options).unwrap(), 1);
        let case = Case { name: "city".into(), scene: city(options).unwrap(), boxes };
        let mut contenders = contenders(&settings, &case);
        // The reference is slow on purpose.
        contenders.retain(|contender| !contender.name.contains("reference") && !contender.name.contains("resolution"));
        let mut rows = Vec::new();
        all_methods(&settings, &case, contenders, &mut rows).unwrap();
        let measured: Vec<&Row> = rows.iter().filter(|r| r.seconds.is_some()).collect();
        assert!(measured.len() >= 9 && measured.iter().all(|r| r.missed == Some(0)), "{rows:?}");
        let of = |name: &str| measured.iter().find(|r| r.method.starts_with(name)).unwrap().reported.unwrap();
        let n_objects = case.scene.objects().len() as u64;
        assert!(of("buffers and sheets") <= of("sheets") && of("buffers and sheets") < n_objects, "{n_objects}");
    }
}
