//! Questions about the sides of boxes: together they are the question about the box.

use proptest::prelude::*;
use sightlines_geometry::{Aabb, Point3, Random};
use sightlines_line_space::{FaceEffort, FaceExit, FaceSearch, FaceTarget, LineSpace, Surface};
use sightlines_multifocal::{BackendError, FromRegion, Guarantee, Umbra, Volume};
use sightlines_testkit::conformance::from_regions::wrong;
use sightlines_testkit::conformance::{FromRegions, RegionScene, Suite};
use sightlines_testkit::draw;
use sightlines_testkit::fronts::{Mixed, corner, lattice, mixed};
use sightlines_testkit::meshes::{boxes, quad, soup};
use std::sync::Arc;

/// The sides of a box, each in parts.
fn exits(volume: &Aabb<3>, n: usize) -> Vec<FaceExit> {
    let mut exits = Vec::new();
    for (axis, upward) in (0..3).flat_map(|axis| [(axis, false), (axis, true)]) {
        let at = if upward { volume.max[axis] } else { volume.min[axis] };
        let along = (axis + 1) % 3;
        let line = |i: usize| {
            let (low, high) = (volume.min[along], volume.max[along]);
            if i == n { high } else { low + (high - low) * i as f64 / n as f64 }
        };
        for i in 0..n {
            let mut part = *volume;
            (part.min[axis], part.max[axis]) = (at, at);
            (part.min[along], part.max[along]) = (line(i), line(i + 1));
            exits.push(FaceExit { volume: *volume, axis, upward, part });
        }
    }
    exits
}

/// Whether all lines from a box to a target are blocked, side by side.
fn is_hidden(search: &mut FaceSearch, volume: &Aabb<3>, target: &FaceTarget, n: usize, most: usize) -> bool {
    let meet = (0..3).all(|k| volume.min[k] <= target.bounds().max[k] && target.bounds().min[k] <= volume.max[k]);
    let effort = FaceEffort { cells: 400, ..FaceEffort::default() };
    let facing = exits(volume, n).into_iter().filter(|exit| exit.faces(target.bounds()));
    !meet && facing.take(most).all(|exit| search.is_blocked(&exit, target, None, &|_| false, &effort).is_ok())
}

/// The questions as a from-region method.
#[derive(Debug)]
struct BySides {
    search: FaceSearch,
    most: usize,
}

impl BySides {
    fn new(triangles: &[[Point3; 3]], most: usize) -> Self {
        Self { search: FaceSearch::new(Arc::new(Surface::new(triangles)), 300), most }
    }
}

impl FromRegion for BySides {
    fn name(&self) -> String {
        "sides".to_owned()
    }

    fn guarantee(&self) -> Guarantee {
        Guarantee::Conservative
    }

    fn umbra(&mut self, volume: &Volume) -> Result<Box<dyn Umbra + '_>, BackendError> {
        Ok(Box::new(FromSides { volume: *volume.bounds(), method: self }))
    }
}

struct FromSides<'a> {
    volume: Aabb<3>,
    method: &'a mut BySides,
}

impl Umbra for FromSides<'_> {
    fn hides(&mut self, target: &Aabb<3>) -> bool {
        let target = FaceTarget::of_box(target);
        target.is_some_and(|target| is_hidden(&mut self.method.search, &self.volume, &target, 1, self.method.most))
    }

    fn hides_points(&mut self, points: &[Point3]) -> bool {
        let &[a, b, c] = points else { return self.hides(&Aabb::around(points.iter().copied())) };
        let target = FaceTarget::new(&[[a, b, c]]);
        target.is_some_and(|target| is_hidden(&mut self.method.search, &self.volume, &target, 1, self.method.most))
    }
}

fn all_sides(scene: &RegionScene) -> Box<dyn FromRegion> {
    Box::new(BySides::new(&scene.triangles(), usize::MAX))
}

#[test]
fn questions_about_all_sides_conform() {
    let report = FromRegions::quick().run(&mut all_sides).expect("they conform");
    let [walled, found] = ["targets behind a wall", "hidden targets behind a wall"].map(|what| report[what]);
    assert!(walled == 240 && found >= 200, "{found} of {walled}");
    FromRegions::quick().refuse_all(|fault| wrong(all_sides, fault));
}

/// The impostor: lines also leave by the other sides.
#[test]
fn impostor_one_side_alone_is_caught() {
    let mut one = |scene: &RegionScene| Box::new(BySides::new(&scene.triangles(), 1)) as Box<dyn FromRegion>;
    assert!(FromRegions::quick().run(&mut one).is_err());
}

fn search(mixed: &Mixed) -> FaceSearch {
    FaceSearch::new(Arc::new(Surface::with_fronts(&mixed.both_sides, &mixed.fronts)), 300)
}

fn has_volume(b: &Aabb<3>) -> bool {
    (0..3).all(|k| b.min[k] < b.max[k])
}

proptest! {
    /// Invariant: no segment is free from an eye in one box to a point of another if the lines through all sides are reported blocked; with fronts, and
    /// sides in parts.
    #[test]
    fn nothing_that_is_seen_is_hidden_side_by_side(
        mixed in mixed(), pairs in prop::collection::vec(boxes(), 8), n in 1usize..3, seed in any::<u64>(),
    ) {
        let mut search = search(&mixed);
        for [v, e] in pairs.iter().filter(|[v, _]| has_volume(v)) {
            let Some(target) = FaceTarget::of_box(e) else { continue };
            if is_hidden(&mut search, v, &target, n, usize::MAX) {
                let free = mixed.free_segment(v, e, seed, 200);
                prop_assert!(free.is_none(), "{:?} to {:?}: {:?}", v, e, free);
            }
        }
    }

    #[test]
    fn nothing_that_is_seen_is_hidden_side_by_side_in_a_lattice(
        mixed in lattice(), pairs in prop::collection::vec((corner(), corner()), 8), seed in any::<u64>(),
    ) {
        let mut search = search(&mixed);
        let unit = |p: Point3| Aabb { min: p, max: p.map(|x| x + 0.8) };
        for (v, e) in pairs.iter().map(|&(p, q)| (unit(p), unit(q))) {
            let target = FaceTarget::of_box(&e).expect("a box");
            if is_hidden(&mut search, &v, &target, 1, usize::MAX) {
                let free = mixed.free_segment(&v, &e, seed, 500);
                prop_assert!(free.is_none(), "{:?} to {:?}: {:?}", v, e, free);
            }
        }
    }
}

/// The tightness twin: side by side, most is found that the search for whole boxes finds.
#[test]
fn sides_find_what_whole_boxes_do() {
    let [mut whole, mut both, mut sides] = [0; 3];
    for (soup, pairs) in draw(&(soup(), prop::collection::vec(boxes(), 12)), 100) {
        let mut lines = LineSpace::new(&soup);
        let mut search = FaceSearch::new(Arc::new(Surface::new(&soup)), 300);
        for [v, e] in pairs.iter().filter(|[v, _]| has_volume(v)) {
            let Some(target) = FaceTarget::of_box(e) else { continue };
            let by_whole = lines.see_box(v, e, 400) == sightlines_line_space::Outcome::Hidden;
            let by_sides = is_hidden(&mut search, v, &target, 1, usize::MAX);
            for (n, yes) in
                [&mut whole, &mut both, &mut sides].into_iter().zip([by_whole, by_whole && by_sides, by_sides])
            {
                *n += usize::from(yes);
            }
        }
    }
    eprintln!("whole {whole}, both {both}, sides {sides}");
    assert!(whole > 100 && both * 10 > whole * 8, "whole {whole}, both {both}, sides {sides}");
}

/// Points of a triangle.
fn points_of([a, b, c]: [Point3; 3], random: &mut Random) -> Point3 {
    let [x, y] = [random.unit(), random.unit()];
    let [x, y] = if x + y > 1.0 { [1.0 - x, 1.0 - y] } else { [x, y] };
    std::array::from_fn(|k| a[k] + x * (b[k] - a[k]) + y * (c[k] - a[k]))
}

/// Large walls at any angle, of both kinds, that cross what is looked at, where it is looked from, and each other.
fn crossing_walls() -> impl Strategy<Value = (Mixed, Aabb<3>, [Point3; 3])> {
    let corner = || [-4i32..5, -4i32..5, -4i32..5].prop_map(|p| p.map(|x| f64::from(x) * 0.61));
    let wall = (corner(), corner(), corner(), 0u8..4);
    (prop::collection::vec(wall, 3..12), corner(), [corner(), corner(), corner()]).prop_map(|(walls, eye, target)| {
        let mut mixed = Mixed { both_sides: Vec::new(), fronts: Vec::new() };
        for (p, u, v, kind) in walls {
            let at = |s: f64, t: f64| std::array::from_fn(|k| p[k] + s * u[k] * 2.0 + t * v[k] * 2.0);
            let wall = quad([at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)], kind == 0);
            if kind < 2 { mixed.fronts.extend(wall) } else { mixed.both_sides.extend(wall) }
        }
        let low = [eye[0] - 6.0, eye[1], eye[2]];
        (mixed, Aabb { min: low, max: low.map(|x| x + 1.3) }, target.map(|p| [p[0] + 4.0, p[1], p[2]]))
    })
}

/// How many questions are about something hidden, and a free line where the answer is wrong.
fn asked(mixed: &Mixed, volume: &Aabb<3>, triangle: [Point3; 3], seed: u64) -> (u32, Option<[Point3; 2]>) {
    let (mut search, mut n) = (search(mixed), 0);
    let Some(target) = FaceTarget::new(&[triangle]) else { return (0, None) };
    for exit in exits(volume, 1).into_iter().filter(|exit| exit.faces(target.bounds())) {
        let effort = FaceEffort { cells: 400, triangle_cells: 400, ..FaceEffort::default() };
        if search.is_blocked(&exit, &target, None, &|_| false, &effort).is_err() {
            continue;
        }
        n += 1;
        let mut random = Random::new(seed);
        for _ in 0..300 {
            let [p, q] = [random.point(&exit.part), points_of(triangle, &mut random)];
            let beyond = if exit.upward { q[exit.axis] > p[exit.axis] } else { q[exit.axis] < p[exit.axis] };
            let [p, q] = [Aabb { min: p, max: p }, Aabb { min: q, max: q }];
            if let Some(free) = mixed.free_segment(&p, &q, 0, 1).filter(|_| beyond) {
                return (n, Some(free));
            }
        }
    }
    (n, None)
}

proptest! {
    /// Invariant: no segment from a part of a side to a point of a triangle beyond it is free if lines are reported blocked, where walls cross both.
    #[test]
    fn nothing_that_is_seen_is_hidden_where_walls_cross_both_ends(
        (mixed, volume, triangle) in crossing_walls(), seed in any::<u64>(),
    ) {
        let (_, free) = asked(&mixed, &volume, triangle, seed);
        prop_assert!(free.is_none(), "{:?}", free);
    }
}

/// The tightness twin: in many of those scenes something is hidden.
#[test]
fn much_is_hidden_where_walls_cross_both_ends() {
    let scenes = draw(&crossing_walls(), 400);
    let n: u32 = scenes.iter().map(|(mixed, volume, triangle)| asked(mixed, volume, *triangle, 1).0).sum();
    assert!(n > 60, "{n} of {} scenes", scenes.len());
}

/// A wall at an angle from within where it is looked from, or what is looked at, and another that begins where it ends: no line passes both.
fn slanted(with_second: bool) -> Vec<[Point3; 3]> {
    let upright = |[x, y]: [f64; 2], [x1, y1]: [f64; 2]| {
        quad([[x, y, -50.0], [x1, y1, -50.0], [x1, y1, 50.0], [x, y, 50.0]], false)
    };
    let mut walls = upright([0.3, -0.2], [3.1, 2.6]).to_vec();
    walls.extend(upright([3.1, 2.6], [3.3, -50.0]).into_iter().filter(|_| with_second));
    walls
}

/// The tightness twin where it counts: of an end that a wall crosses at an angle both parts are hidden, by different walls.
#[test]
fn both_sides_of_a_wall_that_crosses_an_end_are_asked_about() {
    let near = Aabb { min: [0.0; 3], max: [1.0; 3] };
    let far = Aabb { min: [10.0, -1.0, 0.0], max: [11.0, 2.0, 1.0] };
    let side = |b: &Aabb<3>, at: f64| [[at, b.min[1], 0.1], [at, b.max[1], 0.1], [at, b.min[1], 0.9]];
    let part = |b: &Aabb<3>, at: f64| Aabb { min: [at, b.min[1], 0.0], max: [at, b.max[1], 1.0] };
    let away = FaceExit { volume: near, axis: 0, upward: true, part: part(&near, 1.0) };
    let back = FaceExit { volume: far, axis: 0, upward: false, part: part(&far, 10.0) };
    for (exit, triangle) in [(away, side(&far, 10.0)), (back, side(&near, 1.0))] {
        let target = FaceTarget::new(&[triangle]).expect("a triangle");
        let is_blocked = |walls: &[[Point3; 3]]| {
            let mut search = FaceSearch::new(Arc::new(Surface::new(walls)), 300);
            search.is_blocked(&exit, &target, None, &|_| false, &FaceEffort::default()).is_ok()
        };
        assert!(is_blocked(&slanted(true)) && !is_blocked(&slanted(false)), "{exit:?}");
    }
}
