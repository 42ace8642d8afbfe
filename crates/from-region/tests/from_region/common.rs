//! Scenes of boxes, and the search for an open line.

use sightlines_cells::{Scene, SceneObject};
use sightlines_geometry::{Aabb, Point3};
use sightlines_multifocal::{Umbra, Volume};
use sightlines_testkit::{Random, RayScene};

pub(crate) fn block(min: [f64; 3], max: [f64; 3]) -> Aabb<3> {
    Aabb { min, max }
}

pub(crate) fn volume(min: [f64; 3], max: [f64; 3]) -> Volume {
    Volume::new(block(min, max)).unwrap()
}

/// A closed box, facing outwards, without the sides in `left_out`: low and high along each axis in turn.
pub(crate) fn cuboid(b: &Aabb<3>, left_out: &[usize]) -> SceneObject {
    let corner = |i: usize| [0, 1, 2].map(|k| if i >> k & 1 == 1 { b.max[k] } else { b.min[k] });
    let sides = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let kept = (0..6).filter(|i| !left_out.contains(i)).map(|i| sides[i]);
    let triangles = kept.flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    SceneObject { name: String::new(), vertices: (0..8).map(corner).collect(), triangles }
}

pub(crate) fn boxes(boxes: &[Aabb<3>]) -> Scene {
    Scene::new(boxes.iter().map(|b| cuboid(b, &[])).collect()).unwrap()
}

/// A point of a box; every other one within a thousandth of a corner, where silhouettes decide.
fn point(random: &mut Random, b: &Aabb<3>) -> Point3 {
    let near = random.below(2) == 0;
    std::array::from_fn(|k| {
        let part = if near { random.unit() / 1000.0 } else { random.unit() };
        let part = if near && random.below(2) == 0 { 1.0 - part } else { part };
        b.min[k] + (b.max[k] - b.min[k]) * part
    })
}

/// A segment from the volume to the target that meets nothing before it ends, if one of `n` random ones is like that.
pub(crate) fn open_line(rays: &RayScene, v: &Volume, target: &Aabb<3>, seed: u64, n: u64) -> Option<[Point3; 2]> {
    (0..n).find_map(|i| {
        let mut random = Random::new(seed, i);
        let (from, to) = (point(&mut random, v.bounds()), point(&mut random, target));
        let hit = rays.first_hit(from, std::array::from_fn(|k| to[k] - from[k]));
        // A target that begins right behind a wall is met with it, as far as the tracer can tell; and it may round a segment along an
        // edge to pass it.
        (hit.is_none_or(|h| h.t > 1.0 + 1e-9) && rays.is_clear(from, to)).then_some([from, to])
    })
}

/// Of the targets, how many are called hidden, and the first that rays reach all the same.
pub(crate) fn judge(
    umbra: &mut dyn Umbra,
    rays: &RayScene,
    v: &Volume,
    targets: &[Aabb<3>],
    n_rays: u64,
) -> (usize, Option<String>) {
    let mut n_hidden = 0;
    let mut wrong = None;
    for (seed, target) in (0..).zip(targets) {
        if umbra.hides(target) {
            n_hidden += 1;
            let line = open_line(rays, v, target, seed, n_rays);
            wrong = wrong.or(line.map(|line| format!("{target:?} is not hidden from {v:?}: {line:?}")));
        }
    }
    (n_hidden, wrong)
}
