//! The contract of [`FromRegion`] methods.
//!
//! Scenes of closed boxes are drawn, and a method is queried for what is hidden from a volume:
//! 1. conservative: no box is hidden that a free segment reaches from the volume;
//! 2. points: the same of [`Umbra::hides_points`](sightlines_multifocal::Umbra::hides_points) and of hulls of points;
//! 3. near: no box is hidden that meets the volume;
//! 4. tight: of the boxes behind one large wall, the share of [`FromRegions::tight`] is hidden;
//! 5. repeatable: another umbra of the same volume gives the same answers;
//! 6. done: there is an umbra.
//!
//! Segments are checked against slightly enlarged boxes, so that a free segment is certainly free. They are samples:
//! the suite finds faults, but does not prove that there are none.

mod impostor;

use super::{Clause, Random, Report, Suite, Violation};
use crate::eye_boxes::range_in_box;
pub use impostor::{FromRegionFault, wrong};
use sightlines_geometry::{Aabb, Point3};
use sightlines_multifocal::{BackendError, FromRegion, Volume};
use std::fmt::Debug;

/// The suite of from-region methods, which are prepared for scenes by a function.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FromRegions {
    /// The seed of the scenes.
    pub seed: u64,
    /// Number of scenes.
    pub rounds: u32,
    /// Segments to each target.
    pub segments: u32,
    /// The share of boxes behind one large wall that has to be hidden, 0 to 1.
    pub tight: f64,
}

impl FromRegions {
    /// For methods that find all that one occluder hides; takes about a second with quick methods.
    pub const fn quick() -> Self {
        Self { seed: 1, rounds: 60, segments: 400, tight: 1.0 }
    }
}

impl<F: FnMut(&RegionScene) -> Box<dyn FromRegion>> Suite<F> for FromRegions {
    const CONTRACT: &'static str = "from-region method";
    const NEEDED: &'static [&'static str] =
        &["visible targets", "hidden targets", "targets near the volume", "targets behind a wall"];
    const COUNTED: &'static [&'static str] = &["scenes", "hidden targets behind a wall"];

    fn check(&self, make: &mut F, report: &mut Report) -> Result<(), Violation> {
        let mut random = Random::new(self.seed);
        (0..self.rounds).try_for_each(|round| self.check_round(round, &mut random, &mut *make, report))?;
        report.check_share(self.tight, ["targets behind a wall", "hidden targets behind a wall"])
    }
}

/// How much boxes are enlarged when a segment has to miss them, in scene units.
const CLEAR: f64 = 1e-6;

/// Closed boxes as occluders, none of which meets the volume.
#[derive(Debug, Clone)]
pub struct RegionScene {
    /// The volume of the eyes.
    pub volume: Aabb<3>,
    /// The occluders.
    pub boxes: Vec<Aabb<3>>,
}

impl RegionScene {
    /// The sides of the boxes, six each: rectangles, counter-clockwise as seen from outside.
    pub fn faces(&self) -> Vec<[Point3; 4]> {
        self.boxes.iter().flat_map(faces).collect()
    }

    /// The surfaces of the boxes: twelve triangles each, counter-clockwise as seen from outside.
    pub fn triangles(&self) -> Vec<[Point3; 3]> {
        self.boxes.iter().flat_map(faces).flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect()
    }

    /// Whether nothing is between an eye and a point, with a margin.
    fn is_free(&self, eye: Point3, point: Point3) -> bool {
        let direction = [0, 1, 2].map(|k| point[k] - eye[k]);
        self.boxes.iter().all(|b| {
            let grown = Aabb { min: b.min.map(|x| x - CLEAR), max: b.max.map(|x| x + CLEAR) };
            range_in_box(&grown, eye, direction).is_none_or(|[enter, leave]| enter.max(0.0) > leave.min(1.0))
        })
    }
}

/// The six sides of a box, counter-clockwise as seen from outside.
fn faces(b: &Aabb<3>) -> [[Point3; 4]; 6] {
    let (l, h) = (b.min, b.max);
    let point = |x: usize, y: usize, z: usize| [[l[0], h[0]][x], [l[1], h[1]][y], [l[2], h[2]][z]];
    [
        [point(0, 0, 0), point(0, 0, 1), point(0, 1, 1), point(0, 1, 0)],
        [point(1, 0, 0), point(1, 1, 0), point(1, 1, 1), point(1, 0, 1)],
        [point(0, 0, 0), point(1, 0, 0), point(1, 0, 1), point(0, 0, 1)],
        [point(0, 1, 0), point(0, 1, 1), point(1, 1, 1), point(1, 1, 0)],
        [point(0, 0, 0), point(0, 1, 0), point(1, 1, 0), point(1, 0, 0)],
        [point(0, 0, 1), point(1, 0, 1), point(1, 1, 1), point(0, 1, 1)],
    ]
}

/// A volume of one unit, and walls beyond it towards +x: one large wall, or some with gaps.
fn draw(random: &mut Random, is_walled: bool) -> RegionScene {
    let volume = Aabb { min: [0.0; 3], max: [1.0; 3] };
    let wall = |random: &mut Random| {
        let x = random.eighth(2, 5);
        let (y, z) = (random.eighth(-3, 2), random.eighth(-3, 2));
        let (dy, dz) = (random.eighth(1, 4), random.eighth(1, 4));
        Aabb { min: [x, y, z], max: [x + 0.25, y + dy, z + dz] }
    };
    let boxes = if is_walled {
        let x = random.eighth(2, 4);
        vec![Aabb { min: [x, -8.0, -8.0], max: [x + 0.5, 9.0, 9.0] }]
    } else {
        (0..2 + random.below(4)).map(|_| wall(random)).collect()
    };
    RegionScene { volume, boxes }
}

/// What is asked about one scene.
struct Cases<'a> {
    scene: &'a RegionScene,
    targets: Vec<Aabb<3>>,
    /// Boxes that meet the volume.
    near: Vec<Aabb<3>>,
    /// Tetrahedra in the targets: other hulls than the boxes around them.
    hulls: Vec<[Point3; 4]>,
}

impl<'a> Cases<'a> {
    fn draw(random: &mut Random, scene: &'a RegionScene, is_walled: bool) -> Self {
        let targets: Vec<Aabb<3>> = (0..12).map(|_| target(random, is_walled)).collect();
        let near = (0..4).map(|_| beside(random)).collect();
        let hulls = targets.iter().map(|b| tetrahedron(random, b)).collect();
        Self { scene, targets, near, hulls }
    }

    /// What is hidden of targets, hulls and near boxes.
    fn answers(&self, method: &mut dyn FromRegion) -> Result<[Vec<bool>; 3], BackendError> {
        let mut umbra = method.umbra(&Volume::new(self.scene.volume).expect("a box of one unit"))?;
        let targets = self.targets.iter().map(|target| umbra.hides(target)).collect();
        let hulls = self.hulls.iter().map(|hull| umbra.hides_points(hull)).collect();
        Ok([targets, hulls, self.near.iter().map(|target| umbra.hides(target)).collect()])
    }

    /// Whether one of so many segments from the volume to such points is free.
    fn reaches(&self, random: &mut Random, segments: u32, point: impl Fn(&mut Random) -> Point3) -> bool {
        (0..segments).any(|_| {
            let eye = random.point(&self.scene.volume);
            self.scene.is_free(eye, point(random))
        })
    }
}

impl FromRegions {
    fn check_round(
        &self,
        round: u32,
        random: &mut Random,
        method: impl FnOnce(&RegionScene) -> Box<dyn FromRegion>,
        report: &mut Report,
    ) -> Result<(), Violation> {
        let is_walled = round % 3 == 2;
        let scene = draw(random, is_walled);
        let (cases, mut method) = (Cases::draw(random, &scene, is_walled), method(&scene));
        report.count("scenes", 1);
        let at = |what: &dyn Debug| format!("scene {round} of seed {}, {what:?}", self.seed);
        let volume = at(&scene.volume);
        let mut ask =
            || cases.answers(&mut *method).map_err(|error| report.broken(Clause::Done, &volume, "an umbra", error));
        let (first, again) = (ask()?, ask()?);
        report.check(first == again, Clause::Repeatable, &volume, "the same from two umbrae", "two answers")?;
        let [targets, hulls, near] = first;
        for (target, hidden) in cases.near.iter().zip(near) {
            report.check(!hidden, Clause::Near, at(target), "that what meets the volume is seen", "hidden")?;
            report.count("targets near the volume", 1);
        }
        for (k, (target, hull)) in cases.targets.iter().zip(&cases.hulls).enumerate() {
            let expected = "that what a free segment reaches is seen";
            let is_visible = cases.reaches(random, self.segments, |random| random.point(target));
            report.check(!(targets[k] && is_visible), Clause::Conservative, at(target), expected, "hidden")?;
            let is_wrong = hulls[k] && cases.reaches(random, self.segments, |random| mixed(random, hull));
            report.check(!is_wrong, Clause::Points, at(hull), expected, "hidden")?;
            report.count("visible targets", usize::from(is_visible));
            report.count("hidden targets", usize::from(targets[k]));
            report.count("targets behind a wall", usize::from(is_walled));
            report.count("hidden targets behind a wall", usize::from(is_walled && targets[k]));
        }
        Ok(())
    }
}

/// A box behind the walls; close to the middle axis if one of them has to hide it.
fn target(random: &mut Random, is_walled: bool) -> Aabb<3> {
    let reach = if is_walled { 1 } else { 4 };
    let min = [random.eighth(6, 8), random.eighth(-reach, reach), random.eighth(-reach, reach)];
    let size = [0, 1, 2].map(|_| 0.125 + random.eighth(0, 1));
    Aabb { min, max: [0, 1, 2].map(|k| min[k] + size[k]) }
}

/// A box that meets the unit box, at least in its border.
fn beside(random: &mut Random) -> Aabb<3> {
    let min = [0, 1, 2].map(|_| random.eighth(-1, 1));
    Aabb { min, max: min.map(|x| x.max(-0.5) + 1.0) }
}

/// Four corners of a box, no two of them neighbours, with one of them moved to the middle now and then.
fn tetrahedron(random: &mut Random, b: &Aabb<3>) -> [Point3; 4] {
    let corner = |bits: [usize; 3]| [0, 1, 2].map(|k| [b.min[k], b.max[k]][bits[k]]);
    let mut hull = [corner([0, 0, 0]), corner([1, 1, 0]), corner([1, 0, 1]), corner([0, 1, 1])];
    if random.coin() {
        hull[0] = random.point(b);
    }
    hull
}

/// A point of the hull of four.
fn mixed(random: &mut Random, hull: &[Point3; 4]) -> Point3 {
    let weights = [0; 4].map(|_| random.between(0.0, 1.0));
    let sum: f64 = weights.iter().sum::<f64>().max(f64::MIN_POSITIVE);
    [0, 1, 2].map(|k| hull.iter().zip(weights).map(|(p, w)| p[k] * w / sum).sum())
}
