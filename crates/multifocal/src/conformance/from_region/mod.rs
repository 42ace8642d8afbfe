//! The contract of [`FromRegion`] methods, as code that anyone can run against their own.
//!
//! [`run`] draws scenes of closed boxes, queries a method for what is hidden from a volume, and checks:
//! 1. conservative: no box is hidden that a free segment reaches from the volume;
//! 2. points: the same of [`Umbra::hides_points`](crate::Umbra::hides_points) and of hulls of points;
//! 3. near: no box is hidden that meets the volume;
//! 4. tight: of the boxes behind one large wall, the share of [`Effort::tight`] is hidden;
//! 5. repeatable: another umbra of the same volume gives the same answers.
//!
//! Segments are checked against slightly enlarged boxes, so that a free segment is certainly free. They are samples:
//! the suite finds faults, but does not prove that there are none. [`impostors`] are methods with one fault each, which
//! the suite must refuse.

pub mod impostors;

use super::random::Random;
use crate::{BackendError, FromRegion, Volume};
use sightlines_geometry::{Aabb, Point3};

/// How much boxes are enlarged when a segment has to miss them, in scene units.
const CLEAR: f64 = 1e-6;

/// Closed boxes as occluders, none of which meets the volume.
#[derive(Debug, Clone)]
pub struct RegionScene {
    /// The volume of the eyes.
    pub volume: Aabb<3>,
    /// The occluders.
    pub boxes: Vec<Aabb<3>>,
    /// The box around everything that may be queried.
    pub bounds: Aabb<3>,
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
    pub(super) fn is_free(&self, eye: Point3, point: Point3) -> bool {
        self.boxes.iter().all(|b| {
            let (mut enter, mut leave) = (0.0f64, 1.0f64);
            for k in 0..3 {
                let (low, high) = (b.min[k] - CLEAR - eye[k], b.max[k] + CLEAR - eye[k]);
                let d = point[k] - eye[k];
                if d == 0.0 {
                    if low > 0.0 || high < 0.0 {
                        return true;
                    }
                } else {
                    let (s, t) = (low / d, high / d);
                    (enter, leave) = (enter.max(s.min(t)), leave.min(s.max(t)));
                }
            }
            enter > leave
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

/// The effort of the suite, and the required tightness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// The seed of the scenes.
    pub seed: u64,
    /// Number of scenes.
    pub rounds: u32,
    /// Segments to each target.
    pub segments: u32,
    /// The share of boxes behind one large wall that has to be hidden, 0 to 1.
    pub tight: f64,
}

impl Effort {
    /// For methods that find all that one occluder hides; takes about a second with quick methods.
    pub const fn quick() -> Self {
        Self { seed: 1, rounds: 60, segments: 400, tight: 1.0 }
    }
}

/// Counts of a run without a violation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Report {
    /// Scenes.
    pub scenes: u32,
    /// Targets that a free segment reaches.
    pub visible: u32,
    /// Targets that the method hides.
    pub hidden: u32,
    /// Boxes that meet the volume.
    pub near: u32,
    /// Boxes behind one large wall.
    pub walled: u32,
    /// Those of them that the method hides.
    pub found: u32,
}

/// The clauses of the contract.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Clause {
    /// 1.
    Conservative,
    /// 2.
    Points,
    /// 3.
    Near,
    /// 4.
    Tight,
    /// 5.
    Repeatable,
    /// An umbra was refused.
    Done,
    /// Not a fault of the method: the suite compared nothing.
    Counted,
}

/// A broken clause.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Violation {
    /// An answer about a target breaks a clause.
    #[error("scene {round}: {target:?}: {what}")]
    Target {
        /// Which clause.
        clause: Clause,
        /// The scene.
        round: u32,
        /// The box, or the one around the points.
        target: Aabb<3>,
        /// The fault.
        what: &'static str,
    },
    /// Too little is hidden.
    #[error("not tight: {found} of {walled} boxes behind one large wall are hidden")]
    Loose {
        /// Hidden by the method.
        found: u32,
        /// Hidden in truth.
        walled: u32,
    },
    /// An umbra was refused.
    #[error("scene {round}: {error}")]
    Failed {
        /// The scene.
        round: u32,
        /// The error of the method.
        error: BackendError,
    },
    /// There was nothing to compare.
    #[error("the suite proves nothing: no {what}")]
    NothingRan {
        /// The missing kind of case.
        what: &'static str,
    },
}

impl Violation {
    /// Which clause is broken.
    pub const fn clause(&self) -> Clause {
        match self {
            Self::Target { clause, .. } => *clause,
            Self::Loose { .. } => Clause::Tight,
            Self::Failed { .. } => Clause::Done,
            Self::NothingRan { .. } => Clause::Counted,
        }
    }
}

/// Checks the methods that `make` prepares for scenes. The same effort draws the same scenes on every machine.
///
/// # Errors
/// The first [`Violation`] that was found; one of them is that there was nothing to compare.
pub fn run(make: &mut dyn FnMut(&RegionScene) -> Box<dyn FromRegion>, effort: &Effort) -> Result<Report, Violation> {
    let mut random = Random::new(effort.seed);
    let mut report = Report::default();
    for round in 0..effort.rounds {
        let is_walled = round % 3 == 2;
        let scene = draw(&mut random, is_walled);
        report.scenes += 1;
        check(&mut random, &scene, is_walled, round, &mut *make(&scene), effort, &mut report)?;
    }
    let counts = [
        ("visible targets", report.visible),
        ("hidden targets", report.hidden),
        ("targets near the volume", report.near),
        ("targets behind a wall", report.walled),
    ];
    if let Some((what, _)) = counts.into_iter().find(|&(_, n)| n == 0) {
        return Err(Violation::NothingRan { what });
    }
    if f64::from(report.found) < effort.tight * f64::from(report.walled) {
        return Err(Violation::Loose { found: report.found, walled: report.walled });
    }
    Ok(report)
}

/// A volume of one unit, and walls beyond it towards +x: one large wall, or some with gaps.
fn draw(random: &mut Random, is_walled: bool) -> RegionScene {
    let volume = Aabb { min: [0.0; 3], max: [1.0; 3] };
    let bounds = Aabb { min: [-1.0, -12.0, -12.0], max: [12.0, 13.0, 13.0] };
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
    RegionScene { volume, boxes, bounds }
}

fn check(
    random: &mut Random,
    scene: &RegionScene,
    is_walled: bool,
    round: u32,
    method: &mut dyn FromRegion,
    effort: &Effort,
    report: &mut Report,
) -> Result<(), Violation> {
    let volume = Volume::new(scene.volume).expect("a box of one unit");
    let targets: Vec<Aabb<3>> = (0..12).map(|_| target(random, is_walled)).collect();
    let near: Vec<Aabb<3>> = (0..4).map(|_| beside(random)).collect();
    let wrong = |clause, target, what| Violation::Target { clause, round, target, what };
    let failed = |error| Violation::Failed { round, error };
    // Tetrahedra: other hulls than the boxes around them.
    let hulls: Vec<[Point3; 4]> = targets.iter().map(|b| tetrahedron(random, b)).collect();
    let answers = |method: &mut dyn FromRegion| -> Result<_, BackendError> {
        let mut umbra = method.umbra(&volume)?;
        let boxes: Vec<bool> = targets.iter().map(|target| umbra.hides(target)).collect();
        let points: Vec<bool> = hulls.iter().map(|hull| umbra.hides_points(hull)).collect();
        let near: Vec<bool> = near.iter().map(|target| umbra.hides(target)).collect();
        Ok([boxes, points, near])
    };
    let first = answers(method).map_err(failed)?;
    if answers(method).map_err(failed)? != first {
        return Err(wrong(Clause::Repeatable, scene.bounds, "another umbra of the same volume gives another answer"));
    }
    let [boxes, points, near_hidden] = first;
    if let Some((target, _)) = near.iter().zip(near_hidden).find(|(_, hidden)| *hidden) {
        return Err(wrong(Clause::Near, *target, "it meets the volume and is hidden"));
    }
    report.near += near.len() as u32;
    for (k, target) in targets.iter().enumerate() {
        let mut reaches = |point: &mut dyn FnMut(&mut Random) -> Point3| {
            (0..effort.segments).any(|_| {
                let eye = inside(random, &scene.volume);
                let point = point(random);
                scene.is_free(eye, point)
            })
        };
        let is_visible = reaches(&mut |random| inside(random, target));
        if boxes[k] && is_visible {
            return Err(wrong(Clause::Conservative, *target, "a free segment reaches it, and it is hidden"));
        }
        if points[k] && reaches(&mut |random| mixed(random, &hulls[k])) {
            return Err(wrong(Clause::Points, *target, "a free segment reaches the hull of points, and it is hidden"));
        }
        report.visible += u32::from(is_visible);
        report.hidden += u32::from(boxes[k]);
        if is_walled {
            report.walled += 1;
            report.found += u32::from(boxes[k]);
        }
    }
    Ok(())
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

fn inside(random: &mut Random, b: &Aabb<3>) -> Point3 {
    [0, 1, 2].map(|k| random.between(b.min[k], b.max[k]))
}

/// Four corners of a box, no two of them neighbours, with one of them moved to the middle now and then.
fn tetrahedron(random: &mut Random, b: &Aabb<3>) -> [Point3; 4] {
    let corner = |bits: [usize; 3]| [0, 1, 2].map(|k| [b.min[k], b.max[k]][bits[k]]);
    let mut hull = [corner([0, 0, 0]), corner([1, 1, 0]), corner([1, 0, 1]), corner([0, 1, 1])];
    if random.coin() {
        hull[0] = inside(random, b);
    }
    hull
}

/// A point of the hull of four.
fn mixed(random: &mut Random, hull: &[Point3; 4]) -> Point3 {
    let weights = [0; 4].map(|_| random.between(0.0, 1.0));
    let sum: f64 = weights.iter().sum::<f64>().max(f64::MIN_POSITIVE);
    [0, 1, 2].map(|k| hull.iter().zip(weights).map(|(p, w)| p[k] * w / sum).sum())
}
