//! Buildings at an angle whose coordinates were rounded to single precision far from the origin: as good as at it.

use crate::places::{block, scene};
use sightlines_bake::{BakeRequest, Framed, Gap, SceneMethod, bake};
use sightlines_cells::{Point3, Scene, SceneObject};
use sightlines_formats::scene::{parse_glb, write_glb, write_rounded_glb};
use sightlines_formats::{SceneFile, Simplification};
use sightlines_geometry::{Aabb, Random};
use sightlines_pvs::CellId;
use sightlines_scenes::{TowerOptions, tower};
use sightlines_testkit::siblings;
use sightlines_verify::{Truth, VerifyOptions, verify};

/// How far from the origin, in units of the scene.
const AWAY: [f64; 4] = [0.0, 100.0, 1000.0, 10_000.0];

/// A scene turned about y by an angle, with its origin at a place, in double precision.
fn moved(scene: &Scene, degrees: f64, to: Point3) -> Scene {
    let (s, c) = degrees.to_radians().sin_cos();
    let turn = |p: &Point3| [to[0] + c * p[0] + s * p[2], to[1] + p[1], to[2] + c * p[2] - s * p[0]];
    changed(scene, turn)
}

fn changed(scene: &Scene, change: impl Fn(&Point3) -> Point3) -> Scene {
    let object = |o: &SceneObject| SceneObject { vertices: o.vertices.iter().map(&change).collect(), ..o.clone() };
    Scene::new(scene.objects().iter().map(object).collect()).expect("a scene")
}

fn in_single(scene: &Scene) -> Scene {
    changed(scene, |p| p.map(|x| f64::from(x as f32)))
}

fn at(away: f64) -> Point3 {
    [away, 0.0, 0.5 * away]
}

fn request(gap: Gap) -> BakeRequest {
    let method = Some(SceneMethod::Sightlines);
    BakeRequest { gap, method, detail_below: Some(0.0), ..BakeRequest::default() }
}

fn framed(scene: &Scene, gap: Gap) -> Option<Framed> {
    Framed::of(scene, None, &request(gap)).expect("coordinates in range")
}

/// Some walls of a quarter of a unit, upright.
fn walls(random: &mut Random) -> Scene {
    let wall = |k: usize, random: &mut Random| {
        let [x, z, long] = [13, 13, 6].map(|n| random.below(n) as f64);
        let size = if k.is_multiple_of(2) { [1.0 + long, 3.0, 0.25] } else { [0.25, 3.0, 1.0 + long] };
        block(&Aabb { min: [x, 0.0, z], max: [x + size[0], size[1], z + size[2]] }, false)
    };
    scene((0..6).map(|k| wall(k, random)).collect())
}

/// A thousand small buildings. Wherever they stand, walls are walls, with a gap that their own coordinates explain; a site beside one does
/// not widen it. The impostor is the gap of the one at the origin, which leaves few walls far away.
#[test]
fn walls_are_walls_wherever_they_stand() {
    let (mut n, mut n_lost) = (0, 0);
    for seed in siblings().step_by(AWAY.len()) {
        let mut random = Random::new(seed);
        let building = walls(&mut random);
        let degrees = 1.0 + 88.0 * random.unit();
        let mut gap_here = 0.0;
        for away in AWAY {
            let there = in_single(&moved(&building, degrees, at(away)));
            let found = framed(&there, Gap::OfSingle).expect("walls at right angles");
            assert!(found.after.axial_share() > 0.98, "{seed}, {away}: {:?}", found.after);
            let gap = found.frame.gap();
            let own = there.bounds().max.iter().fold(0.0f64, |m, x| m.max(x.abs()));
            assert!(gap <= own.max(32.0) / f64::from(1 << 20) && found.moved.most < gap, "{seed}, {away}: {gap}");
            if away == 0.0 {
                gap_here = gap;
            } else {
                let near = framed(&there, Gap::Width(gap_here)).map_or(0.0, |near| near.after.axial_share());
                n_lost += usize::from(near < 0.9);
            }
            let site = vec![[-9e3, -1.0, -8e3], [1e4, -1.0, -9e3], [1e4, -1.5, 9e3], [-9e3, -1.2, 1e4]];
            let site = SceneObject { name: "site".to_owned(), vertices: site, triangles: vec![[0, 2, 1], [0, 3, 2]] };
            let beside = there.objects().iter().cloned().chain([site]).collect();
            let beside = in_single(&scene(beside));
            let request = request(Gap::OfSingle);
            // Most of the area is that of the site, so there may be no frame; what counts is the gap of one.
            let beside = Framed::of(&beside, None, &request).expect("in range").map_or(gap, |f| f.frame.gap());
            assert!(beside <= (gap * 1.1).max(own / f64::from(1 << 20)), "{seed}, {away}: {beside} {gap}");
            n += 1;
        }
    }
    eprintln!("{n} buildings, {n_lost} of which the gap at the origin would lose");
    assert!(n >= siblings().len() && 10 * n_lost > 4 * n, "{n}, {n_lost}");
}

/// Where nodes in double precision move a building, its coordinates are stored near the origin, and the gap is that of there; where they are stored far
/// away, it is not.
#[test]
fn nodes_leave_the_gap_as_it_is() {
    let building = walls(&mut Random::new(1));
    let gap = |SceneFile { scene, info }: &SceneFile| {
        let framed = Framed::of(scene, Some(info), &request(Gap::OfFile)).expect("in range").expect("a frame");
        assert!(framed.after.axial_share() > 0.999);
        framed.frame.gap()
    };
    let here = gap(&parse_glb(&write_glb(&in_single(&moved(&building, 33.0, [0.0; 3]))).unwrap(), None).unwrap());
    for away in &AWAY[1..] {
        let there = moved(&building, 33.0, at(*away));
        let by_nodes = write_rounded_glb(&there, &there.bounds(), Simplification { occluder: false }).unwrap().0;
        let by_nodes = parse_glb(&by_nodes, None).unwrap();
        assert!(by_nodes.info.stored_sizes.iter().all(|size| *size < 32.0), "{away}");
        let baked = parse_glb(&write_glb(&in_single(&there)).unwrap(), None).unwrap();
        assert!(baked.info.stored_sizes.iter().all(|size| *size > 0.9 * away), "{away}");
        assert!(gap(&by_nodes) <= 2.0 * here && gap(&baked) > 2.0 * here, "{away}");
    }
}

/// What stands along the axes of its file, and what is in doubles, gets no gap, wherever it is.
#[test]
fn no_gap_is_taken_without_need() {
    for away in AWAY {
        let upright = in_single(&moved(&walls(&mut Random::new(2)), 0.0, at(away)));
        assert_eq!(framed(&upright, Gap::OfSingle), None, "{away}");
        let turned = in_single(&moved(&walls(&mut Random::new(2)), 33.0, at(away)));
        assert_eq!(framed(&turned, Gap::OfFile), None, "{away}");
    }
}

/// What viewers in all of the volume of the cells may see on average, of objects and of other volume, as shares.
fn shares(scene: &Scene, gap: Gap) -> [f64; 2] {
    let table = bake(scene, &request(gap)).expect("a table").table;
    let volume = |cell: u32| {
        let cell = &table.cells()[cell as usize];
        (0..3).map(|k| cell.max[k] - cell.min[k]).product::<f64>()
    };
    let cells = 0..table.n_cells() as u32;
    let whole: f64 = cells.clone().map(volume).sum();
    let [mut objects, mut space] = [0.0; 2];
    for cell in cells {
        let share = volume(cell) / whole;
        objects += share * table.visible_objects(CellId(cell)).len() as f64 / scene.objects().len() as f64;
        space += share * table.visible(CellId(cell)).map(|other| volume(other.0)).sum::<f64>() / whole;
    }
    [objects, space]
}

/// A thousand small houses of four rooms with closed walls and openings between them, at an angle and away from the origin: viewers there see as much
/// as at the origin, to 1 % in all, and to 5 % in nearly every one. Of two cuts that are as good rounding may choose, as it does at the origin. The
/// twin is what is hidden at the origin; the impostor is the gap of there.
#[test]
fn houses_are_as_tight_wherever_they_stand() {
    let [mut n, mut n_hidden, mut n_apart] = [0; 3];
    let mut sums = [[0.0; 2]; 5];
    for seed in siblings().step_by(AWAY.len()) {
        let mut random = Random::new(seed);
        let house = house(&mut random);
        let degrees = 1.0 + 88.0 * random.unit();
        let of = |away: f64| in_single(&moved(&house, degrees, at(away)));
        let gap = framed(&of(0.0), Gap::OfSingle).expect("a frame").frame.gap();
        let found = AWAY.map(|away| shares(&of(away), Gap::OfSingle));
        let [here, there @ ..] = found;
        for there in there {
            let is_near = (0..2).all(|k| (there[k] / here[k] - 1.0).abs() < 0.05);
            n_apart += usize::from(!is_near);
        }
        n_hidden += usize::from(here[1] < 0.9);
        let of_impostor = shares(&of(AWAY[3]), Gap::Width(gap));
        for (sum, shares) in sums.iter_mut().zip(found.iter().chain([&of_impostor])) {
            (0..2).for_each(|k| sum[k] += shares[k]);
        }
        n += AWAY.len();
    }
    let [here, there @ .., impostor] = sums;
    eprintln!(
        "{n} houses, {n_hidden} of a quarter of them hide much, {n_apart} differ by more than 5 %; sums {sums:?}"
    );
    assert!(n >= siblings().len() && 8 * n_hidden > n && 50 * n_apart < n, "{n_hidden} {n_apart} of {n}");
    assert!(there.iter().all(|sum| (0..2).all(|k| (sum[k] / here[k] - 1.0).abs() < 0.01)), "{sums:?}");
    assert!((0..2).all(|k| impostor[k] > 1.05 * here[k]), "{sums:?}");
}

/// Two by two rooms of 3 to 6 units each, behind one shell, with a block in each; a wall between two of them is whole or has an opening.
fn house(random: &mut Random) -> Scene {
    const THICK: f64 = 0.25;
    let [x, z] = [(); 2].map(|()| [0.0, 3.0 + random.below(4) as f64, 9.0 + random.below(4) as f64]);
    let piece = |min: Point3, max: Point3| block(&Aabb { min, max }, false);
    let high = 2.5;
    let [wide, deep] = [x[2] + THICK, z[2] + THICK];
    let mut objects = vec![
        piece([0.0, -THICK, 0.0], [wide, 0.0, deep]),
        piece([0.0, high, 0.0], [wide, high + THICK, deep]),
        piece([0.0, 0.0, 0.0], [THICK, high, deep]),
        piece([x[2], 0.0, 0.0], [wide, high, deep]),
        piece([THICK, 0.0, 0.0], [x[2], high, THICK]),
        piece([THICK, 0.0, z[2]], [x[2], high, deep]),
    ];
    for k in 0..2 {
        // The wall across x between z[k] and z[k + 1], and the one across z.
        for (across, along, at) in [(x, z, 0), (z, x, 2)] {
            let mut wall = |from: f64, to: f64| {
                let (mut min, mut max) = ([0.0; 3], [0.0, high, 0.0]);
                (min[at], max[at]) = (across[1], across[1] + THICK);
                (min[2 - at], max[2 - at]) = (from, to);
                objects.push(piece(min, max));
            };
            let [from, to] = [along[k] + if k == 0 || at == 0 { THICK } else { 0.0 }, along[k + 1]];
            if random.below(2) == 0 {
                wall(from, to);
            } else {
                let door = from + (to - from - 1.0) * random.below(5) as f64 / 4.0;
                for [a, b] in [[from, door], [door + 1.0, to]] {
                    if a < b {
                        wall(a, b);
                    }
                }
            }
        }
    }
    for (x, z) in [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(i, j)| (x[i] + 1.0, z[j] + 1.0)) {
        objects.push(piece([x, 0.0, z], [x + 0.5, 0.5, z + 0.5]));
    }
    scene(objects)
}

/// The table of a tower at an angle has as many pairs far away as at the origin, to 5 %, and `verify` finds nothing against it. The impostor is the
/// gap at the origin.
#[test]
fn tables_are_as_tight_far_from_the_origin() {
    let options =
        TowerOptions { seed: 1, floors: 1, rooms_x: 2, rooms_y: 1, furniture: 1, windows: true, wall_thickness: 0.25 };
    let tower = tower(options).expect("a tower");
    let share = |scene: &Scene, gap: Gap| {
        let baked = bake(scene, &request(gap)).expect("a table");
        let options =
            VerifyOptions { rays: 2000, pairs: 200, tries: 64, seed: 7, threads: 1, ..VerifyOptions::default() };
        let found = verify(&baked.table, &Truth::Scene(scene), &options).expect("verified");
        assert!(found.is_true(), "{:?}", found.by_kind);
        let n_cells = baked.table.n_cells();
        let n_seen = (0..n_cells as u32).map(|c| baked.table.visible_objects(CellId(c)).len());
        n_seen.sum::<usize>() as f64 / (n_cells * scene.objects().len()) as f64
    };
    let of = |away: f64| in_single(&moved(&tower, 33.0, at(away)));
    let here = share(&of(0.0), Gap::OfSingle);
    for away in &AWAY[1..] {
        let there = share(&of(*away), Gap::OfSingle);
        assert!((there / here - 1.0).abs() < 0.05, "{away}: {there} {here}");
    }
    let gap = framed(&of(0.0), Gap::OfSingle).expect("a frame").frame.gap();
    assert!(share(&of(10_000.0), Gap::Width(gap)) > 1.05 * here);
}
