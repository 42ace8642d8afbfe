//! Parts of objects: what of a large object a cell sees.
//!
//! Of a large object a cell often sees only a corner. So the list of triangles of such an object is cut into runs with small bounding boxes, and for each
//! run it is decided which of the cells that may see the object may see the run: by shadows that are propagated from cell to cell, for cells of every
//! kind. Occluders are never cut.

use crate::error::BakeError;
use crate::methods::{BufferOptions, OcclusionMethod, OcclusionMethodFactory};
use crate::propagation::{Propagation, Solved};
use crate::region::{RegionBakeOptions, phase, rays_of, stops_rays};
use crate::threads;
use sightlines_cells::{Scene, places_of_triangles};
use sightlines_formats::SceneInfo;
use sightlines_geometry::{Aabb, Point3};
use sightlines_line_space::{FaceTarget, Surface};
use sightlines_pvs::runs::runs_of;
use sightlines_pvs::{BitMatrix, ObjectId, ObjectPart, ObjectParts, Table, TableKind};
use std::ops::Range;
use std::sync::Arc;

/// The phase of units of work: one for each part.
const PHASE: &str = "parts";

/// The key under which a table states how many triangles a part has at most.
pub(crate) const PARTS: &str = "parts";

/// A part, by the triangles of the scene.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Part {
    object: u32,
    triangles: Range<usize>,
}

/// Cuts the objects that have more than so many triangles. Those that move, that are doors or that have no triangles stay whole.
fn cut(scene: &Scene, most: usize) -> Vec<Part> {
    let moves = |object: u32| {
        scene.moving().binary_search_by_key(&object, |moving| moving.object).is_ok()
            || scene.doors().binary_search(&object).is_ok()
    };
    let large = (0u32..).zip(scene.objects()).filter(|(object, o)| o.triangles.len() > most && !moves(*object));
    let parts = large.flat_map(|(object, o)| {
        let mut runs = Vec::new();
        cut_run(&o.corners().map(Aabb::around).collect::<Vec<_>>(), 0, most.max(1), &mut runs);
        runs.into_iter().map(move |triangles| Part { object, triangles })
    });
    parts.collect()
}

/// Cuts a run where the surfaces of the halves, weighted by their numbers, are least, as trees of boxes are cut. The smaller half has at least a quarter of
/// what a part may have, and a sixteenth of the run, so the depth is logarithmic. O(n log n).
fn cut_run(boxes: &[Aabb<3>], first: usize, most: usize, runs: &mut Vec<Range<usize>>) {
    let n = boxes.len();
    if n <= most {
        runs.push(first..first + n);
        return;
    }
    let with = |all: &mut Aabb<3>, b: &Aabb<3>| {
        *all = all.with(b.min).with(b.max);
        Some(all.half_surface())
    };
    let before: Vec<f64> = boxes.iter().scan(Aabb::EMPTY, with).collect();
    let mut behind: Vec<f64> = boxes.iter().rev().scan(Aabb::EMPTY, with).collect();
    behind.reverse();
    let least = (most / 4).max(n / 16).clamp(1, n / 2);
    let cost = |k: usize| before[k - 1] * k as f64 + behind[k] * (n - k) as f64;
    let by_cost = |&a: &usize, &b: &usize| cost(a).total_cmp(&cost(b)).then(a.abs_diff(n / 2).cmp(&b.abs_diff(n / 2)));
    let at = (least..=n - least).min_by(by_cost).unwrap_or(n / 2);
    cut_run(&boxes[..at], first, most, runs);
    cut_run(&boxes[at..], first + at, most, runs);
}

/// The most bits of cells by parts: a gigabyte for each of the matrices of them that there are at once.
const MOST_BITS: u64 = 1 << 33;

/// The table with the parts of objects that have more than `most` triangles, and how many pairs of a cell and a part count as visible because the
/// budget was spent.
///
/// If a from-region method took part, an object of which every part is hidden from a cell is hidden from it as well, unless its box touches the cell.
pub(crate) fn with_parts(
    table: Table,
    scene: &Scene,
    most: u32,
    options: &RegionBakeOptions<'_>,
) -> Result<(Table, u64), BakeError> {
    let cut = cut(scene, most as usize);
    if cut.is_empty() {
        return Ok((table, 0));
    }
    let n = table.n_cells();
    let n_things = cut.len() + scene.objects().len();
    if (n as u64).saturating_mul(n_things as u64) > MOST_BITS {
        return Err(BakeError::TooManyParts { n_parts: cut.len(), n_cells: n });
    }
    let mut parts = table.into_parts();
    let mut objects = parts.objects_seen.take().expect("tables of scenes have rows of objects");
    let cells: Vec<Aabb<3>> = parts.cells.iter().map(|cell| Aabb { min: cell.min, max: cell.max }).collect();
    let solved = threads::on(options.threads, || solve(&cells, scene, &cut, &objects, options))?;
    let (mut seen, mut n_undecided) = (BitMatrix::new(n, cut.len()), 0);
    for (column, (part, solved)) in cut.iter().zip(&solved).enumerate() {
        let sees = |cell: &usize| objects.get(*cell, part.object as usize);
        (0..n).filter(sees).for_each(|cell| seen.set(cell, column, true));
        match solved {
            Some(of) => of.hidden.iter().cloned().flatten().for_each(|cell| seen.set(cell as usize, column, false)),
            None => n_undecided += (0..n).filter(sees).count() as u64,
        }
    }
    let (TableKind::SceneKdTree { hidden_by } | TableKind::SceneGivenCells { hidden_by }) = parts.kind else {
        unreachable!("the table is one of a scene")
    };
    if hidden_by.from_region {
        hide_objects(&parts.cell_objects, &cut, &seen, &mut objects);
    }
    parts.objects_seen = Some(objects);
    parts.object_parts = Some(ObjectParts { parts: records(scene, options.file, &cut), seen });
    parts.info.push((PARTS.to_owned(), most.to_string()));
    parts.info.sort();
    Ok((Table::new(parts)?, n_undecided))
}

/// Hides objects from the cells that see no part of them, and that they do not touch.
fn hide_objects(cell_objects: &[Vec<ObjectId>], cut: &[Part], seen: &BitMatrix, objects: &mut BitMatrix) {
    let mut first = 0;
    for of in cut.chunk_by(|a, b| a.object == b.object) {
        let (object, columns) = (of[0].object, first..first + of.len());
        first = columns.end;
        for (cell, touching) in cell_objects.iter().enumerate() {
            let touches = touching.binary_search(&ObjectId(object)).is_ok();
            if !touches && !columns.clone().any(|column| seen.get(cell, column)) {
                objects.set(cell, object as usize, false);
            }
        }
    }
}

/// The parts by the triangles of the file.
fn records(scene: &Scene, file: Option<&SceneInfo>, cut: &[Part]) -> Vec<ObjectPart> {
    let mut records = Vec::with_capacity(cut.len());
    for of in cut.chunk_by(|a, b| a.object == b.object) {
        let object = of[0].object;
        let n = scene.objects()[object as usize].triangles.len();
        let places = places_of_triangles(file.map_or(&[], |file| &file.left_out_triangles), object, n);
        let mut start = 0;
        records.extend(of.iter().map(|part| {
            let part = ObjectPart { object: ObjectId(object), start, end: places[part.triangles.end] };
            start = part.end;
            part
        }));
    }
    records
}

/// From which of the cells that may see its object each part is hidden; none for those that were not begun within the budget.
fn solve(
    cells: &[Aabb<3>],
    scene: &Scene,
    cut: &[Part],
    objects: &BitMatrix,
    options: &RegionBakeOptions<'_>,
) -> Result<Vec<Option<Solved>>, BakeError> {
    if options.budget.is_over() {
        return Ok(vec![None; cut.len()]);
    }
    let surface = match options.surface {
        Some(surface) => Arc::clone(surface),
        None => surface_of_scene(scene)?,
    };
    let triangles = |part: &Part| -> Vec<[Point3; 3]> {
        scene.objects()[part.object as usize].corners_of(part.triangles.clone()).collect()
    };
    // Rays know the parts, and behind them the other objects.
    let is_cut = |object: &u32| cut.binary_search_by_key(object, |part| part.object).is_ok();
    let others: Vec<u32> = (0..scene.objects().len() as u32).filter(|object| !is_cut(object)).collect();
    let of =
        |thing: u32| cut.get(thing as usize).map_or_else(|| others[thing as usize - cut.len()], |part| part.object);
    let all = cut.iter().map(triangles).chain(others.iter().map(|&object| scene.covering_triangles(object)));
    let all: Vec<Vec<[Point3; 3]>> = all.collect();
    let stops = |thing: usize| stops_rays(scene, of(thing as u32));
    let rays = rays_of(scene, &all, of);
    let propagation = Propagation::new(cells.to_vec(), &rays, surface, all.len(), options.progress)?;
    let costs: Vec<f64> = cut.iter().map(|part| 100.0 + part.triangles.len() as f64).collect();
    let from_bytes = |bytes: &[u8]| Solved::from_bytes(bytes, cells.len() as u32);
    let found = phase::decide(PHASE, &costs, options, (Solved::to_bytes, from_bytes), |unit| {
        let part = &cut[unit];
        let object = part.object as usize;
        let Some(target) = FaceTarget::new(&triangles(part)) else { return Ok(Solved::default()) };
        let known = runs_of((0..cells.len() as u32).filter(|&cell| !objects.get(cell as usize, object)));
        let thing = stops(unit).then_some(unit as u32);
        Ok(propagation.solve(thing, &target, scene.is_single_sided(part.object), &known))
    })?;
    let mut solved: Vec<Option<Solved>> = vec![None; cut.len()];
    found.into_iter().for_each(|(unit, of)| solved[unit] = of);
    Ok(solved)
}

/// The surfaces that hide, where no method has prepared them.
fn surface_of_scene(scene: &Scene) -> Result<Arc<Surface>, BakeError> {
    let method = OcclusionMethodFactory::new(OcclusionMethod::LineSpace, scene, &BufferOptions::default())?;
    Ok(method.surface().expect("line space has a surface"))
}
