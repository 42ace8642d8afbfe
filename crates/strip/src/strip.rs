//! The decision, part by part: rays first, then what encloses, then lines.

use crate::eyes::{Eyes, around};
use crate::fate::{Fate, FateCounts, HiddenReason, ObjectFate};
use crate::lines::{LineEffort, Lines};
use crate::space::Space;
use crate::witness::{Aim, Walls};
use rayon::prelude::*;
use sightlines_cells::{ANYWHERE, Scene, SceneError, SceneObject};
use sightlines_from_region::{BallReach, ClosedSurfaces, EyeSides, GapError};
use sightlines_geometry::{Aabb, Point3, Random};
use sightlines_line_space::FaceSearch;
use sightlines_progress::{Cancelled, Counter, Observer};
use std::collections::BTreeSet;

/// How often free segments are looked around.
const SPREAD_ROUNDS: u64 = 4;

/// Rays near each of them.
const SPREAD_RAYS: usize = 24;

/// Most free segments that are looked around.
const MOST_SPREAD: usize = 1 << 15;

/// What counts as one part.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Grain {
    /// Whole objects: one goes if nothing of it is seen.
    #[default]
    Objects,
    /// Triangles, one by one; objects that move go as wholes.
    Triangles,
}

/// Options for [`strip`].
#[derive(Debug, Clone, PartialEq)]
pub struct StripOptions {
    /// What counts as one part.
    pub grain: Grain,
    /// Openings through which no ball of this diameter fits count as closed; 0 if none do.
    pub gap: f64,
    /// Rays towards a part before anything else is tried.
    pub first_rays: u32,
    /// More rays towards a part that nothing hid; of triangles that count one by one, a sixteenth of it.
    pub more_rays: u32,
    /// How much line space is searched.
    pub effort: LineEffort,
    /// Objects that stay, whether they are seen or not.
    pub keep: Vec<u32>,
    /// Whether mirrors are ignored. They show what is hidden.
    pub ignore_mirrors: bool,
    /// Other seeds give other rays.
    pub seed: u64,
    /// Number of threads; 0 for one per core. The answer does not depend on it.
    pub threads: usize,
}

impl Default for StripOptions {
    fn default() -> Self {
        Self {
            grain: Grain::Objects,
            gap: 0.0,
            first_rays: 32,
            more_rays: 1024,
            effort: LineEffort::default(),
            keep: Vec::new(),
            ignore_mirrors: false,
            seed: 1,
            threads: 0,
        }
    }
}

/// Why a scene is not decided.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StripError {
    /// Mirrors show what is hidden.
    #[error("the scene has {n} mirrors, which show what is hidden; ignore them if nothing is removed that they show")]
    Mirrors {
        /// How many.
        n: usize,
    },
    /// A gap that cannot be used.
    #[error(transparent)]
    Gap(#[from] GapError),
    /// The observer cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// What becomes of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Stripped {
    /// For each object of the scene.
    pub objects: Vec<ObjectFate>,
    /// How many closed surfaces were found.
    pub n_closed_surfaces: usize,
}

impl Stripped {
    /// How many objects have which fate.
    pub fn count_objects(&self) -> FateCounts {
        let mut counts = FateCounts::default();
        self.objects.iter().for_each(|of| counts.add(&of.fate, 1));
        counts
    }

    /// How many triangles have which fate; all of an object have its, where they do not count one by one.
    ///
    /// # Panics
    /// If the scene is another one, with fewer objects.
    pub fn count_triangles(&self, scene: &Scene) -> FateCounts {
        let mut counts = FateCounts::default();
        for (of, object) in self.objects.iter().zip(scene.objects()) {
            match &of.triangles[..] {
                [] => counts.add(&of.fate, object.triangles.len()),
                each => each.iter().for_each(|fate| counts.add(fate, 1)),
            }
        }
        counts
    }

    /// The scene without what is hidden. Objects keep their places; those that are gone have no triangles.
    ///
    /// # Errors
    /// [`SceneError`] if the scene is another one, that these are no objects of.
    pub fn rest_of(&self, scene: &Scene) -> Result<Scene, SceneError> {
        let objects = (0u32..).zip(scene.objects().iter().zip(&self.objects)).map(|(k, (object, of))| {
            let mut rest = object.clone();
            let mut at = 0;
            rest.triangles.retain(|_| {
                at += 1;
                !of.hides(at - 1)
            });
            (k, rest)
        });
        scene.replaced(objects)
    }
}

/// Decides for each part of a scene whether any of the eyes can see it.
///
/// What is [hidden](Fate::Hidden) can be removed without a change of any picture from these eyes, but for pictures that are taken through openings
/// within the gap; see the page of this crate. What is not decided stays.
///
/// Costs O(n log² n) to prepare, a few traced rays for each part that is seen, and for each other one a search of line space as long as
/// the effort allows. The same scene and options give the same answer, with any number of threads.
///
/// # Errors
/// [`StripError`]
pub fn strip(
    scene: &Scene,
    eyes: &Eyes,
    options: &StripOptions,
    observer: Option<&dyn Observer>,
) -> Result<Stripped, StripError> {
    let n = scene.mirrors().len();
    if n > 0 && !options.ignore_mirrors {
        return Err(StripError::Mirrors { n });
    }
    let run = || Stripper::new(scene, eyes, options)?.run(observer);
    match rayon::ThreadPoolBuilder::new().num_threads(options.threads).build() {
        Ok(pool) => pool.install(run),
        // No threads could be created: the existing ones are used.
        Err(_) => run(),
    }
}

/// All that is prepared.
struct Stripper<'a> {
    scene: &'a Scene,
    eyes: Eyes,
    options: &'a StripOptions,
    walls: Walls<'a>,
    closed: ClosedSurfaces,
    sides: Vec<EyeSides>,
    ball: Option<BallReach>,
    space: Option<Space>,
    lines: Lines,
}

/// A scene of these triangles alone, if there are any.
fn barring(walls: &[[Point3; 3]]) -> Option<Scene> {
    let triangles = (0..walls.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let vertices = walls.as_flattened().to_vec();
    Scene::new(vec![SceneObject { name: String::new(), vertices, triangles }]).ok()
}

impl<'a> Stripper<'a> {
    fn new(scene: &'a Scene, eyes: &'a Eyes, options: &'a StripOptions) -> Result<Self, StripError> {
        let bounds = scene.bounds();
        let both_sides: Vec<[Point3; 3]> = scene.occluding_triangles().collect();
        let fronts: Vec<[Point3; 3]> = scene.front_occluding_triangles().collect();
        let boxes: Option<Vec<Aabb<3>>> =
            eyes.boxes().map(|boxes| boxes.iter().map(|volume| *volume.bounds()).collect());
        let closed = ClosedSurfaces::new(scene);
        let mut sides = match &boxes {
            None => vec![EyeSides::OUTSIDE],
            Some(boxes) if eyes.are_joined() => boxes.iter().map(|b| closed.sides_of_joined(b)).collect(),
            Some(boxes) => boxes.iter().map(|b| closed.sides_of(b)).collect(),
        };
        sides.sort_unstable();
        sides.dedup();
        let ball = if options.gap == 0.0 {
            None
        } else {
            let all = boxes.as_deref().unwrap_or_default();
            // Who walks may come behind what hides from its front only.
            let fronts = closed.walls(all).filter(|_| !eyes.are_joined());
            let walls = both_sides.iter().chain(fronts).copied();
            Some(BallReach::new(walls, &bounds, options.gap, boxes.as_deref())?)
        };
        let space = match boxes.as_deref() {
            None => Space::joined_to(scene, &[], around(&bounds)),
            Some(boxes) if eyes.are_joined() => {
                // Two walls back to back that hide from their fronts let nobody outside in, but they bar no way.
                barring(&both_sides).and_then(|walls| Space::joined_to(&walls, boxes, around(&bounds)))
            }
            Some(_) => None,
        };
        let exits = eyes.exits(&bounds);
        let lines = Lines::new(&both_sides, &fronts, exits, options.effort.sides);
        let walls = Walls::new(scene);
        let eyes = eyes.with_stations(|boxes| walls.stations(boxes, &mut Random::new(options.seed)));
        Ok(Self { scene, eyes, options, walls, closed, sides, ball, space, lines })
    }

    fn run(&self, observer: Option<&dyn Observer>) -> Result<Stripped, StripError> {
        let n = self.scene.objects().len();
        let effort = self.options.effort;
        let counter = Counter::new(observer, "parts", n);
        let decide = |object: u32| -> Result<ObjectFate, StripError> {
            let fate = self.cheaply(object);
            counter.step()?;
            Ok(fate)
        };
        let mut objects = (0..n as u32).into_par_iter().map(decide).collect::<Result<Vec<_>, _>>()?;
        // What is seen costs line space most, which never finds it hidden: so it is looked for first.
        self.spread(&mut objects);
        self.each_open(&mut objects, observer, |search, object, fate| {
            self.by_lines(object, fate, effort.first_cells, search);
        })?;
        self.spread(&mut objects);
        let n_open: usize = objects.iter().map(ObjectFate::n_undecided).sum();
        let each = effort.shared_cells / (n_open.max(1) as u64);
        let cells = u32::try_from(each).unwrap_or(u32::MAX).min(effort.most_cells);
        self.each_open(&mut objects, observer, |search, object, fate| {
            if cells > effort.first_cells {
                self.by_lines(object, fate, cells, search);
            }
            self.by_more_rays(object, fate);
        })?;
        self.spread(&mut objects);
        Ok(Stripped { objects, n_closed_surfaces: self.closed.len() })
    }

    /// Does something for each object of which a part is undecided.
    fn each_open(
        &self,
        objects: &mut [ObjectFate],
        observer: Option<&dyn Observer>,
        work: impl Fn(&mut FaceSearch, u32, &mut ObjectFate) + Sync,
    ) -> Result<(), StripError> {
        let is_open = |(_, fate): &(usize, &mut ObjectFate)| fate.n_undecided() > 0;
        let open: Vec<(usize, &mut ObjectFate)> = objects.iter_mut().enumerate().filter(is_open).collect();
        let counter = Counter::new(observer, "open parts", open.len());
        let one = |search: &mut FaceSearch, (object, fate): (usize, &mut ObjectFate)| -> Result<(), StripError> {
            work(search, object as u32, fate);
            Ok(counter.step()?)
        };
        open.into_par_iter().map_init(|| self.lines.search(), one).collect()
    }

    /// Whether triangles of an object count one by one.
    fn counts_triangles(&self, object: u32) -> bool {
        self.options.grain == Grain::Triangles && !self.moves(object)
    }

    fn moves(&self, object: u32) -> bool {
        self.scene.moving().binary_search_by_key(&object, |moving| moving.object).is_ok()
    }

    fn random(&self, object: u32, stage: u64) -> Random {
        Random::new(self.options.seed ^ (u64::from(object) << 32) ^ (stage << 24))
    }

    /// The fate of an object by rays, and by what encloses it.
    fn cheaply(&self, object: u32) -> ObjectFate {
        let extent = self.scene.extent(object);
        if extent.is_empty() || self.options.keep.contains(&object) {
            return ObjectFate::whole(Fate::Kept);
        }
        if extent == ANYWHERE {
            // It may be before the eye.
            return ObjectFate::whole(Fate::Kept);
        }
        let triangles = self.scene.covering_triangles(object);
        let aim = Aim { object, only: None, triangles: &triangles };
        let mut random = self.random(object, 0);
        let (n, n_rays) = (triangles.len(), self.options.first_rays);
        if self.counts_triangles(object) {
            let fate = |t: usize| match self.walls.find(&self.eyes, &aim.one(t), t..t + 1, n_rays, &mut random) {
                Some(free) => Fate::Seen(free),
                None => self.enclosed(object, &triangles[t]).map_or(Fate::Undecided, Fate::Hidden),
            };
            return ObjectFate::of_triangles((0..n).map(fate).collect());
        }
        if let Some(free) = self.walls.find(&self.eyes, &aim, 0..n, n_rays, &mut random) {
            return ObjectFate::whole(Fate::Seen(free));
        }
        // The weakest reason of them.
        let reasons = triangles.iter().map(|t| self.enclosed(object, t)).collect::<Option<Vec<_>>>();
        let reason = reasons.and_then(|reasons| reasons.into_iter().max());
        ObjectFate::whole(reason.map_or(Fate::Undecided, Fate::Hidden))
    }

    /// Tries line space on what is undecided.
    fn by_lines(&self, object: u32, fate: &mut ObjectFate, cells: u32, search: &mut FaceSearch) {
        // Eyes that walk get next to whatever a way leads to: no box of theirs is apart from what is open.
        if fate.n_undecided() == 0 || self.eyes.are_joined() {
            return;
        }
        let triangles = self.scene.covering_triangles(object);
        let aim = Aim { object, only: None, triangles: &triangles };
        let from_fronts = self.scene.is_single_sided(object);
        if fate.triangles.is_empty() {
            match self.lines.hide(search, &triangles, from_fronts, cells) {
                Ok(()) => fate.fate = Fate::Hidden(HiddenReason::LineSpace),
                Err(open) => {
                    let at = open.triangle.unwrap_or(0);
                    let free = open.line.and_then(|line| self.along(&aim, at, line));
                    fate.fate = free.map_or(Fate::Undecided, Fate::Seen);
                }
            }
            return;
        }
        let mut fates = std::mem::take(&mut fate.triangles);
        let asked: Vec<u32> =
            (0u32..).zip(&fates).filter(|(_, fate)| **fate == Fate::Undecided).map(|(t, _)| t).collect();
        let mut lines = Vec::new();
        let hidden = self
            .lines
            .hide_each(search, &aim, &asked, (from_fronts, cells), |t, line| lines.extend(line.map(|l| (t, l))));
        hidden.into_iter().for_each(|t| fates[t as usize] = Fate::Hidden(HiddenReason::LineSpace));
        for (t, line) in lines {
            if let Some(free) = self.along(&aim.one(t as usize), t, line) {
                fates[t as usize] = Fate::Seen(free);
            }
        }
        *fate = ObjectFate::of_triangles(fates);
    }

    /// Tries more rays on what is undecided.
    fn by_more_rays(&self, object: u32, fate: &mut ObjectFate) {
        if fate.n_undecided() == 0 {
            return;
        }
        let triangles = self.scene.covering_triangles(object);
        let aim = Aim { object, only: None, triangles: &triangles };
        let (mut random, n_rays) = (self.random(object, 1), self.options.more_rays);
        if fate.triangles.is_empty() {
            let found = self.walls.find(&self.eyes, &aim, 0..triangles.len(), n_rays, &mut random);
            fate.fate = found.map_or(Fate::Undecided, Fate::Seen);
            return;
        }
        let mut fates = std::mem::take(&mut fate.triangles);
        for (t, fate) in fates.iter_mut().enumerate().filter(|(_, fate)| **fate == Fate::Undecided) {
            let found = self.walls.find(&self.eyes, &aim.one(t), t..t + 1, n_rays.div_ceil(16), &mut random);
            *fate = found.map_or(Fate::Undecided, Fate::Seen);
        }
        *fate = ObjectFate::of_triangles(fates);
    }

    /// Sends rays near the free segments that are known, which finds more of what is seen through the same narrow openings.
    fn spread(&self, objects: &mut [ObjectFate]) {
        for round in 0..SPREAD_ROUNDS {
            let mut known: Vec<[Point3; 2]> = Vec::new();
            for of in objects.iter() {
                let each = if of.triangles.is_empty() { std::slice::from_ref(&of.fate) } else { &of.triangles[..] };
                known.extend(
                    each.iter().filter_map(|fate| if let Fate::Seen(free) = fate { Some(*free) } else { None }),
                );
            }
            let step = known.len().div_ceil(MOST_SPREAD).max(1);
            if objects.iter().all(|of| of.n_undecided() == 0) {
                return;
            }
            let is_open = |object: u32, t: u32| {
                let of = &objects[object as usize];
                *of.triangles.get(t as usize).unwrap_or(&of.fate) == Fate::Undecided
            };
            let near = |k: usize| -> Vec<(u32, u32, [Point3; 2])> {
                let mut random = self.random(k as u32, 2 + round);
                let near = |_| {
                    self.walls.near(&self.eyes, known[k * step], &mut random, &is_open, |object| {
                        self.counts_triangles(object)
                    })
                };
                (0..SPREAD_RAYS).filter_map(near).collect()
            };
            let found: Vec<Vec<_>> = (0..known.len().div_ceil(step)).into_par_iter().map(near).collect();
            if found.iter().all(Vec::is_empty) {
                return;
            }
            let mut changed = BTreeSet::new();
            for (object, t, free) in found.into_iter().flatten() {
                let of = &mut objects[object as usize];
                let fate = of.triangles.get_mut(t as usize).unwrap_or(&mut of.fate);
                if *fate == Fate::Undecided {
                    *fate = Fate::Seen(free);
                    changed.insert(object);
                }
            }
            for object in changed {
                let of = &mut objects[object as usize];
                if !of.triangles.is_empty() {
                    *of = ObjectFate::of_triangles(std::mem::take(&mut of.triangles));
                }
            }
        }
    }

    fn along(&self, aim: &Aim<'_>, triangle: u32, line: [Point3; 2]) -> Option<[Point3; 2]> {
        let at = aim.triangles.get(triangle as usize)?;
        self.walls.along(&self.eyes, aim, at, line)
    }

    /// Why a triangle is hidden, if it is by what encloses it or by a table.
    fn enclosed(&self, object: u32, triangle: &[Point3; 3]) -> Option<HiddenReason> {
        if self.moves(object) && self.eyes.meet(&self.scene.extent(object)) {
            // Within the box that it does not leave it may be before the eye, whatever hides the sides of the box.
            return self.eyes.is_hidden_by_table(object).then_some(HiddenReason::Table);
        }
        let is_apart = || self.space.as_ref().is_some_and(|space| !space.touches(triangle));
        if self.closed.hide(&self.sides, triangle) || is_apart() {
            return Some(HiddenReason::Enclosed);
        }
        if self.eyes.is_hidden_by_table(object) {
            return Some(HiddenReason::Table);
        }
        let is_out_of_reach = self.ball.as_ref().is_some_and(|ball| !ball.touches(triangle));
        is_out_of_reach.then_some(HiddenReason::Gap)
    }
}
