//! What the sweeps found: scenes in which a naive buffer blocks a texel that is seen, kept as they were found.

use super::*;
use crate::stability::predicates::sharp;
use sightlines::geometry::{Aabb, Point3};
use sightlines::multifocal::{BufferPlane, Volume};

/// A scene with one rectangle: lower and upper corner of the volume; axis of the plane, whether viewers look along it, where it is, origin and
/// step of its texels; the outline.
struct Kept {
    volume: [Point3; 2],
    plane: (usize, bool, f64, [f64; 2], [f64; 2]),
    outline: [Point3; 4],
}

impl Kept {
    fn scene(&self) -> Scene {
        let volume = Volume::new(Aabb::around(self.volume)).expect("it is a box");
        let (axis, positive, at, origin, step) = self.plane;
        let end = [0, 1].map(|k| origin[k] + 16.0 * step[k]);
        let plane = BufferPlane::new(axis, positive, at, origin, end, [16, 16]).expect("it is a plane");
        assert_eq!((plane.origin(), plane.step()), (origin, step), "the same texels as were found");
        let [p, q, r, s] = self.outline;
        let occluder = Occluder::patch(self.outline.to_vec(), &[[p, q, r], [p, r, s]]).expect("it has an area");
        Scene { volume, plane, occluders: vec![occluder] }
    }
}

const SLOPED: Kept = Kept {
    volume: [[49.0, -36.3, 36.9], [51.0, -34.7, 38.1]],
    plane: (2, false, 21.5, [42.0, -43.5], [1.0, 1.0]),
    outline: [
        [48.9999, -39.57060398430462, 27.658906511642932],
        [51.6290815354432, -39.57060398430462, 27.66917675201576],
        [51.6290815354432, -31.42919601569538, 27.66917675201576],
        [48.9999, -31.42919601569538, 27.658906511642932],
    ],
};

const LEVEL: Kept = Kept {
    volume: [[-1.0, -0.8, -16.6], [1.0, 0.8, -15.4]],
    plane: (2, true, 0.0, [-8.0, -8.0], [1.0, 1.0]),
    outline: [
        [-3.4750413638332844, -3.869027291153272, -8.383194672073499],
        [3.474841363833284, -3.869027291153272, -8.383194672073499],
        [3.474841363833284, 0.8990976545533313, -8.383194672073499],
        [-3.4750413638332844, 0.8990976545533313, -8.383194672073499],
    ],
};

const NARROW: Kept = Kept {
    volume: [[2.2, -18.73, 1.04], [3.8, -17.53, 1.54]],
    plane: (1, true, -2.13, [-0.7100000083446503, -5.0], [0.2500000298023224, 1.0]),
    outline: [
        [0.155795060780268, -10.650523335464868, 0.91832121754029],
        [0.155795060780268, -10.650523335464868, 2.1483945261607733],
        [5.357489477500751, -10.650523335464868, 2.1483945261607733],
        [5.357489477500751, -10.650523335464868, 0.91832121754029],
    ],
};

/// Checks that a method stores too much at a texel of a scene, and that no shipped one does anywhere.
fn check(kept: &Kept, (method, fill): (SweepMethod, Fill), [x, y]: [u32; 2]) {
    let scene = kept.scene();
    let job = scene.job(Measure::VertexHeight);
    let (hidden, exact) = (truth::hidden(&scene), reference(&job));
    let at = |i: usize| if hidden[i] { exact.values()[i] } else { 0 };
    let i = (y * 16 + x) as usize;
    assert!(fill(&job).values()[i] > at(i), "{} is no longer wrong", method.name);
    for (method, fill) in ALL.into_iter().filter(|m| m.0.kind != Kind::Naive) {
        let filled = fill(&job);
        assert!((0..256).all(|i| filled.values()[i] <= at(i)), "{} stores too much", method.name);
        assert!(filled.n_blocked() > 0, "{} blocks nothing", method.name);
    }
}

#[test]
fn findings_of_buffers_stay_found() {
    check(&SLOPED, NO_MARGIN, [8, 2]);
    check(&SLOPED, CENTRES, [7, 2]);
    check(&SLOPED, ONE_EYE, [7, 2]);
    check(&LEVEL, NEAREST, [2, 1]);
    check(&NARROW, DOUBLES, [8, 3]);
    check(&NARROW, EPSILONS, [6, 3]);
}

/// Two rectangles 2^24 units in the last place apart, four billionths: who puts corners onto a grid closes the gap.
#[test]
fn a_gap_of_some_billionths_is_not_closed() {
    let (h, low, high) = (7.330039556352072, -2.705353252262027, 8.643419241571124);
    let quad = |from: f64, to: f64| [[low, h, from], [low, h, to], [high, h, to], [high, h, from]];
    let quads = |left: f64, right: f64| [quad(-4.2754092050779775, left), quad(right, 7.015157134862556)];
    let volume = Volume::new(Aabb { min: [2.2, 13.27, 0.29], max: [3.8, 14.47, 2.29] }).expect("it is a box");
    let plane = BufferPlane::new(1, false, -2.13, [-6.71, -5.0], [9.3, 11.0], [16, 16]).expect("it is a plane");
    let n_seen = |quads: [[Point3; 4]; 2], snap: bool| {
        let triangles: Vec<[Point3; 3]> = quads.iter().flat_map(|&[p, q, r, s]| [[p, q, r], [p, r, s]]).collect();
        let triangles = if snap { naive::snapped(&triangles, EPSILON) } else { triangles };
        let scene = Scene { volume, plane, occluders: Vec::new() };
        256 - of_patches(&scene, &triangles).n_blocked()
    };
    let (left, right) = (1.7418298469091151, 1.7418298506344054);
    let (open, closed) = (n_seen(quads(left, right), false), n_seen(quads(left, left), false));
    assert!(open > closed, "with a gap more is seen: {open} texels, not {closed}");
    assert_eq!(n_seen(quads(left, right), true), closed, "on a grid the gap is gone");
    // One unit in the last place is a gap as well.
    assert_eq!(n_seen(quads(left, left.next_up()), false), open);
}

/// One unit in the last place between the halves of a wall is enough to look through; with corners on a grid it is closed.
#[test]
fn a_wall_with_a_crack_is_no_sheet() {
    let quad = |from: f64, to: f64| [[3.05, from, -9.1], [3.05, to, -9.1], [3.05, to, 9.3], [3.05, from, 9.3]];
    let wall = |left: f64, right: f64| sheets::Wall {
        triangles: [quad(-8.7, left), quad(right, 9.9)]
            .iter()
            .flat_map(|&[p, q, r, s]| [[p, q, r], [p, r, s]])
            .collect(),
        eyes: Aabb { min: [-2.0, 2.2, -0.8], max: [-1.0, 3.8, 0.7] },
        target: Aabb { min: [7.0, 2.2, -0.8], max: [8.0, 3.8, 0.7] },
    };
    let [shipped, snapped] = sheets::methods().try_into().expect("there are two");
    let asked = |wall: &sheets::Wall| [shipped.1(wall), snapped.1(wall)];
    assert_eq!(asked(&wall(2.9, 2.9)), [Answer::Hidden, Answer::Hidden]);
    assert_eq!(asked(&wall(2.9, 2.9f64.next_up())), [Answer::Seen, Answer::Hidden]);
}

#[test]
fn sweeps_of_buffers_are_sharp() {
    let n = sharp::check(sweeps(true), 3);
    assert!(n > 10_000, "{n}");
}
