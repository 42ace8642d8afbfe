//! The shares that faces intercept, estimated by counting rays.

use crate::rays::Traced;
use crate::views::Views;
use rayon::prelude::*;
use sightlines_cells::Scene;
use sightlines_geometry::{Point3, Random};
use sightlines_visible_surface::Faces;

/// Rays sent by one task.
const PER_TASK: u64 = 1 << 12;

/// How often each face was hit first, by rays from all of the views.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct HitEstimate {
    hits: Vec<u64>,
    n_rays: u64,
}

/// A confidence interval of a share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// The share that was counted.
    pub share: f64,
    /// Lower and upper end.
    pub ends: [f64; 2],
}

impl HitEstimate {
    /// Sends rays. Eyes are spread over the parts of the views, in proportion to their volumes (all parts count equally
    /// if all are flat); directions are spread over the sphere: ray `i` of `n` has a random direction in strip `i` of
    /// `n` equal strips of latitude, which are taken in a scattered order. So the rays are independent, and fewer are
    /// needed than with unrestricted random directions.
    ///
    /// Deterministic, whatever the number of threads. O(log n) for each ray in practice, after O(n log n).
    pub fn new(faces: &Faces, views: &Views, n_rays: u64) -> Self {
        Self::of(&Traced::new(faces), faces.len(), views, n_rays)
    }

    /// The same for a scene, in which rays pass what is see-through to what is behind it: of that the hits are those of rays that
    /// see-through things did not stop. `faces` are those of the scene.
    pub(crate) fn through(scene: &Scene, faces: &Faces, views: &Views, n_rays: u64) -> Self {
        let all = Self::new(faces, views, n_rays);
        if scene.see_through().is_empty() {
            return all;
        }
        let is_opaque = |face: u32| scene.is_opaque(faces.object(face));
        let behind = Self::of(&Traced::of(faces, is_opaque), faces.len(), views, n_rays);
        let hits = faces.ids().map(|face| if is_opaque(face) { behind.hits(face) } else { all.hits(face) });
        Self { hits: hits.collect(), n_rays }
    }

    pub(crate) fn of(traced: &Traced<'_>, n_faces: usize, views: &Views, n_rays: u64) -> Self {
        let (places, step) = (EyeSampler::new(views), step_of(n_rays));
        let task = |task: u64| {
            let (mut random, mut rays) = (Random::new(task), traced.rays());
            (task * PER_TASK..((task + 1) * PER_TASK).min(n_rays))
                .filter_map(|ray| {
                    let eye = places.any(&mut random);
                    rays.of(eye, direction_in_strip(scattered(ray, n_rays, step), n_rays, &mut random))
                })
                .collect::<Vec<u32>>()
        };
        let found: Vec<Vec<u32>> = (0..n_rays.div_ceil(PER_TASK)).into_par_iter().map(task).collect();
        let mut hits = vec![0; n_faces];
        found.iter().flatten().for_each(|&face| hits[face as usize] += 1);
        Self { hits, n_rays }
    }

    /// Number of rays sent.
    pub const fn n_rays(&self) -> u64 {
        self.n_rays
    }

    /// How often a face was hit first.
    pub fn hits(&self, face: u32) -> u64 {
        self.hits[face as usize]
    }

    /// The share of rays that a face intercepts, averaged over all eyes of the views; it lies in the interval with a
    /// probability of at least `confidence` (for one face that is chosen without regard to its hits).
    ///
    /// # Source
    /// Hoeffding, "Probability inequalities for sums of bounded random variables", J. Am. Stat. Assoc. 58, 1963, theorem 1: the tail of
    /// the mean of independent hits or misses, alike or not, is at most `exp(-n KL(counted, p))`.
    pub fn interval(&self, face: u32, confidence: f64) -> Interval {
        interval(self.hits(face), self.n_rays, confidence)
    }

    /// The share of rays that hit a face first, as counted.
    pub fn share(&self, face: u32) -> f64 {
        self.hits(face) as f64 / self.n_rays.max(1) as f64
    }
}

/// The interval for `k` hits of `n` rays: see [`HitEstimate::interval`].
pub fn interval(k: u64, n: u64, confidence: f64) -> Interval {
    if n == 0 {
        return Interval { share: 0.0, ends: [0.0, 1.0] };
    }
    let counted = k.min(n) as f64 / n as f64;
    // Half of the error probability on each side.
    let allowed = (2.0 / (1.0 - confidence.clamp(0.0, 1.0 - 1e-15))).ln() / n as f64;
    let term = |x: f64, y: f64| if x == 0.0 { 0.0 } else { x * (x / y).ln() };
    let kl = |p: f64| term(counted, p) + term(1.0 - counted, 1.0 - p);
    // Bisects outwards from the counted share to where the divergence reaches the limit; returns the outer end.
    let end = |mut inner: f64, mut outer: f64| {
        for _ in 0..64 {
            let p = inner / 2.0 + outer / 2.0;
            if kl(p) > allowed { outer = p } else { inner = p }
        }
        outer
    };
    Interval { share: counted, ends: [end(counted, 0.0), end(counted, 1.0)] }
}

/// Maps numbers below `n` to distinct numbers below `n`, with neighbours far apart; `step` is [`step_of`] n.
fn scattered(i: u64, n: u64, step: u64) -> u64 {
    (u128::from(i) * u128::from(step) % u128::from(n)) as u64
}

/// A step near the golden section of n that is coprime to it.
fn step_of(n: u64) -> u64 {
    let near = ((n as f64 * 0.618_033_988_749_895) as u64).max(1);
    (near..).find(|&step| gcd(step, n) == 1).unwrap_or(1)
}

fn gcd(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// A direction in one of `n` strips of equal area.
fn direction_in_strip(i: u64, n: u64, random: &mut Random) -> Point3 {
    let z = 2.0 * ((i as f64 + random.unit()) / n as f64) - 1.0;
    let radius = (1.0 - z * z).max(0.0).sqrt();
    // A point of the circle, by rejecting what is outside the disc.
    loop {
        let (x, y) = (2.0 * random.unit() - 1.0, 2.0 * random.unit() - 1.0);
        let square = x * x + y * y;
        if square > 0.0 && square < 1.0 {
            let root = square.sqrt();
            return [radius * x / root, radius * y / root, z];
        }
    }
}

/// Random eyes in views.
pub(crate) struct EyeSampler<'a> {
    views: &'a Views,
    /// Cumulative volumes.
    sums: Vec<f64>,
}

impl<'a> EyeSampler<'a> {
    pub(crate) fn new(views: &'a Views) -> Self {
        let volume = |v: &crate::ViewBox| {
            let b = v.volume.bounds();
            (0..3).map(|k| b.max[k] - b.min[k]).product::<f64>()
        };
        let volumes: Vec<f64> = views.parts().iter().map(volume).collect();
        let flat = volumes.iter().sum::<f64>() <= 0.0;
        let mut sum = 0.0;
        let add = |v: &f64| {
            sum += if flat { 1.0 } else { *v };
            sum
        };
        let sums = volumes.iter().map(add).collect();
        Self { views, sums }
    }

    pub(crate) fn any(&self, random: &mut Random) -> Point3 {
        let at = random.unit() * self.sums.last().copied().unwrap_or(0.0);
        let part = self.sums.partition_point(|&s| s <= at).min(self.sums.len() - 1);
        random.point(self.views.parts()[part].volume.bounds())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sightlines_geometry::Aabb;
    use sightlines_multifocal::Volume;

    /// A cube around the origin, two triangles a side, with a shelf in it.
    fn cube() -> Faces {
        let mut faces = Vec::new();
        for axis in 0..3 {
            for at in [-1.0, 1.0] {
                let p = |s: f64, t: f64| {
                    let mut p = [0.0; 3];
                    (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = (at, s, t);
                    p
                };
                faces.push([p(-1.0, -1.0), p(1.0, -1.0), p(1.0, 1.0)]);
                faces.push([p(-1.0, -1.0), p(1.0, 1.0), p(-1.0, 1.0)]);
            }
        }
        Faces::new(faces).unwrap()
    }

    #[test]
    fn shares_of_a_cube() {
        let faces = cube();
        let eye = Volume::new(Aabb { min: [0.0; 3], max: [0.0; 3] }).unwrap();
        let n = 48_000;
        let estimate = HitEstimate::new(&faces, &Views::new([eye]).unwrap(), n);
        assert_eq!(faces.ids().map(|f| estimate.hits(f)).sum::<u64>(), n);
        for face in faces.ids() {
            let interval = estimate.interval(face, 0.999_9);
            assert!(interval.ends[0] < 1.0 / 12.0 && 1.0 / 12.0 < interval.ends[1], "{face} {interval:?}");
            assert!(interval.ends[1] - interval.ends[0] < 0.015);
        }
    }

    #[test]
    fn intervals_hold_as_often_as_they_say() {
        let mut random = Random::new(3);
        for p in [0.0, 1e-3, 0.02, 0.5, 1.0] {
            let missed = (0..400)
                .filter(|_| {
                    let k = (0..1000).filter(|_| random.unit() < p).count() as u64;
                    let ends = interval(k, 1000, 0.9).ends;
                    !(ends[0] <= p && p <= ends[1])
                })
                .count();
            // At most a tenth, except by chance: 40 and four standard deviations.
            assert!(missed <= 64, "{p} {missed}");
        }
        // An interval that is too narrow misses more.
        let narrow = |k: u64| [k as f64 / 1000.0 - 0.005, k as f64 / 1000.0 + 0.005];
        let missed = (0..400).filter(|_| {
            let k = (0..1000).filter(|_| random.unit() < 0.5).count() as u64;
            !(narrow(k)[0] <= 0.5 && 0.5 <= narrow(k)[1])
        });
        assert!(missed.count() > 64);
        assert_eq!(interval(0, 0, 0.9).ends, [0.0, 1.0]);
        assert!(interval(0, 1000, 0.9).ends[1] < 0.004);
    }

    #[test]
    fn scattering_takes_each_once() {
        for n in [1, 2, 7, 100, 4096, 10_007] {
            let mut all: Vec<u64> = (0..n).map(|i| scattered(i, n, step_of(n))).collect();
            all.sort_unstable();
            assert!(all.iter().copied().eq(0..n), "{n}");
        }
    }

    #[test]
    fn eyes_are_where_there_is_room() {
        let volume = |min: [f64; 3], max: [f64; 3]| Volume::new(Aabb { min, max }).unwrap();
        let views = Views::new([volume([0.0; 3], [1.0; 3]), volume([2.0; 3], [4.0, 3.0, 3.5])]).unwrap();
        let (places, mut random) = (EyeSampler::new(&views), Random::new(4));
        let n = (0..4000).filter(|_| places.any(&mut random)[0] < 2.0).count();
        assert!((800..1200).contains(&n), "{n}");
        let flat = Views::new([volume([0.0; 3], [0.0; 3]), volume([2.0; 3], [2.0, 3.0, 3.5])]).unwrap();
        let places = EyeSampler::new(&flat);
        let n = (0..4000).filter(|_| places.any(&mut random)[0] < 1.0).count();
        assert!((1800..2200).contains(&n), "{n}");
    }
}
