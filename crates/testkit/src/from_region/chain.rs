//! The search for a clear segment between two boxes.

use super::{ClearSegment, is_clear};
use crate::ray_witness::Random;
use crate::rays::{Hit, RayScene, length, sub};
use sightlines_cells::{Point3, Scene};
use sightlines_geometry::Aabb;

/// A stopped ray is turned so often before another one is begun.
const TURNS: u32 = 8;

/// Rays from one volume to one target.
pub(super) struct Chain<'a> {
    rays: &'a RayScene,
    scene: &'a Scene,
    /// Around each object.
    objects: &'a [Aabb<3>],
    /// Where rays begin and end.
    ends: [Aabb<3>; 2],
    random: Random,
    /// A low-discrepancy sequence: where it is.
    place: [f64; 6],
    n_rays: u64,
}

/// Powers of the positive root of x^7 = x + 1: steps of an additive sequence that fills six dimensions evenly.
///
/// Source: Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018.
const STEPS: [f64; 6] = [
    0.898_653_712_628_699_4,
    0.807_578_495_221_345_1,
    0.725_733_412_969_760_1,
    0.652_183_025_943_972,
    0.586_086_697_577_969_8,
    0.526_688_986_700_736_4,
];

impl<'a> Chain<'a> {
    /// * `ends`: volume and target, not empty
    /// * `batch`: another number gives other rays
    pub(super) fn new(
        rays: &'a RayScene,
        scene: &'a Scene,
        objects: &'a [Aabb<3>],
        ends: [Aabb<3>; 2],
        seed: u64,
        batch: u64,
    ) -> Self {
        let mut random = Random::new(seed, batch);
        let place = [0; 6].map(|_| random.unit());
        Self { rays, scene, objects, ends, random, place, n_rays: 0 }
    }

    /// Rays that were cast.
    pub(super) fn n_rays(&self) -> u64 {
        self.n_rays
    }

    /// A clear segment, sought with about `n` rays.
    pub(super) fn segment(&mut self, n: u64) -> Option<ClearSegment> {
        while self.n_rays < n {
            let mut segment = self.begin();
            for _ in 0..TURNS {
                let [eye, point] = segment;
                self.n_rays += 1;
                match self.first_hit(segment) {
                    None if is_clear(self.rays, eye, point) && self.is_clear_within(segment) => {
                        return Some(ClearSegment { eye, point });
                    }
                    // It grazes something that it passes.
                    None => segment = self.ends_at_random(segment),
                    Some(hit) => segment = self.turned(segment, &hit),
                }
            }
        }
        None
    }

    /// Whether the segment is still clear with its ends moved into their boxes. An eye on a wall at the border of the volume may look away
    /// from it on the one side while all eyes beside it, in the volume, are behind the wall.
    fn is_clear_within(&self, segment: [Point3; 2]) -> bool {
        let inwards = |i: usize| {
            let (b, p) = (&self.ends[i], segment[i]);
            [0, 1, 2].map(|k| {
                let by = self.rays.shift().min((b.max[k] - b.min[k]) / 2.0);
                p[k].clamp(b.min[k] + by, (b.max[k] - by).max(b.min[k] + by))
            })
        };
        !self.rays.is_blocked(inwards(0), inwards(1))
    }

    fn first_hit(&self, [eye, point]: [Point3; 2]) -> Option<Hit> {
        self.rays.first_hit(eye, sub(point, eye)).filter(|hit| hit.t <= 1.0)
    }

    /// A segment to begin with: one time out of two its ends are anywhere, else on faces, edges and corners.
    fn begin(&mut self) -> [Point3; 2] {
        for (x, step) in self.place.iter_mut().zip(STEPS) {
            *x = (*x + step).fract();
        }
        let snap = self.random.below(2) == 0;
        let place = self.place;
        let mut end = |i: usize| {
            let b = self.ends[i];
            [0, 1, 2].map(|k| {
                let x = match (snap, self.random.below(3)) {
                    (true, 0) => 0.0,
                    (true, 1) => 1.0,
                    _ => place[3 * i + k],
                };
                b.min[k] + (b.max[k] - b.min[k]) * x
            })
        };
        [end(0), end(1)]
    }

    fn ends_at_random(&mut self, mut segment: [Point3; 2]) -> [Point3; 2] {
        let i = self.random.below(2);
        segment[i] = self.random.point(&self.ends[i]);
        segment
    }

    /// A segment like this one that passes what it hit: through a point beside an edge of it, with one end where
    /// it was.
    fn turned(&mut self, segment: [Point3; 2], hit: &Hit) -> [Point3; 2] {
        let [eye, point] = segment;
        let at = [0, 1, 2].map(|k| eye[k] + hit.t * (point[k] - eye[k]));
        let through = if self.random.below(2) == 0 { self.beside_triangle(at, hit) } else { self.beside_box(at, hit) };
        let moving = self.random.below(2);
        let mut turned = segment;
        turned[moving] = self.reach(segment[1 - moving], through, moving);
        turned
    }

    /// A point beside an edge of the triangle that was hit.
    fn beside_triangle(&mut self, at: Point3, hit: &Hit) -> Point3 {
        let object = &self.scene.objects()[hit.object as usize];
        let corners = object.triangles[hit.triangle as usize].map(|i| object.vertices[i as usize]);
        let k = self.random.below(3);
        let (a, b) = (corners[k], corners[(k + 1) % 3]);
        let along = sub(b, a);
        let squared: f64 = along.iter().map(|x| x * x).sum();
        let from_a = sub(at, a);
        let foot: f64 = (0..3).map(|k| from_a[k] * along[k]).sum::<f64>() / squared;
        let slide = if self.random.below(2) == 0 { self.random.unit() - 0.5 } else { 0.0 };
        let foot = (foot + slide).clamp(0.0, 1.0);
        let on = [0, 1, 2].map(|k| a[k] + foot * along[k]);
        let away = sub(on, at);
        self.pushed(on, away, squared.sqrt())
    }

    /// A point beside an edge of the box around the object that was hit: past all of its triangles at once.
    fn beside_box(&mut self, at: Point3, hit: &Hit) -> Point3 {
        let b = &self.objects[hit.object as usize];
        let k = self.random.below(3);
        let side = if self.random.below(2) == 0 { b.min[k] } else { b.max[k] };
        let mut on = at;
        on[k] = side;
        let mut away = [0.0; 3];
        away[k] = if side == b.min[k] { -1.0 } else { 1.0 };
        self.pushed(on, away, b.max[k] - b.min[k])
    }

    /// A point moved in a direction: by twice what makes a ray robust, up to about the size of what is passed.
    fn pushed(&mut self, on: Point3, away: Point3, size: f64) -> Point3 {
        let far = length(away);
        if far == 0.0 || !far.is_finite() {
            return on;
        }
        let least = 2.0 * self.rays.shift();
        // Evenly over the powers of two between, by halving at random.
        let mut by = size.max(least);
        while by > least && self.random.below(4) != 0 {
            by *= 0.5;
        }
        let by = by.max(least);
        [0, 1, 2].map(|k| on[k] + by * away[k] / far)
    }

    /// The point of box `end` that the line from `from` through `through` leads to: a random one on the line if it
    /// meets the box, else one near it.
    fn reach(&mut self, from: Point3, through: Point3, end: usize) -> Point3 {
        let (b, direction) = (self.ends[end], sub(through, from));
        let mut range = [0.0, f64::INFINITY];
        for k in 0..3 {
            if direction[k] != 0.0 {
                let (s, t) = ((b.min[k] - from[k]) / direction[k], (b.max[k] - from[k]) / direction[k]);
                range = [range[0].max(s.min(t)), range[1].min(s.max(t))];
            }
        }
        let at = match range {
            [low, high] if high.is_finite() && low <= high => low + (high - low) * self.random.unit(),
            // Beside the box: as far as it is.
            [low, _] if low.is_finite() => low,
            _ => 1.0,
        };
        [0, 1, 2].map(|k| (from[k] + at * direction[k]).clamp(b.min[k], b.max[k]))
    }
}
