//! Walking, and taking the time.

use super::nesting::Sets;
use crate::error::{ErrorAbout, Result, bail};
use crate::tables::Cells;
use sightlines::eye_to_cell::{Method, View};
use sightlines::pvs::ObjectId;
use sightlines::walkthrough::{Answer, WalkOptions, Walkthrough};
use std::path::Path;
use std::thread;
use std::time::{Duration, Instant};

/// Frames that one method walks before the next one does: only so many answers are kept for the comparison.
const CHUNK: usize = 256;
/// A frame that was not answered is repeated at most so many times: with mirrors each may need one more to be prepared.
const TRIES: usize = 16;
/// How long to sleep while something is prepared.
const NAP: Duration = Duration::from_micros(50);

/// What is to be walked.
pub(super) struct Walk<'a, C> {
    pub(super) cells: &'a C,
    pub(super) file: &'a Path,
    pub(super) views: &'a [View],
    /// Of each object.
    pub(super) polygons: &'a [u32],
    pub(super) options: WalkOptions,
    pub(super) fps: Option<u32>,
}

/// What a method did on the frames that all methods answered in full.
#[derive(Debug, Clone)]
pub(super) struct MethodSums {
    pub(super) method: Method,
    /// Sums over frames.
    pub(super) cells: u64,
    pub(super) objects: u64,
    pub(super) polygons: u64,
    /// Sums of images in mirrors, and of polygons of the objects in them.
    pub(super) images: u64,
    pub(super) image_polygons: u64,
    /// Of each frame, ascending.
    pub(super) times: Vec<Duration>,
    /// Frames that had more to do than the steps allow, or than is in proportion, so that a coarser method answered in part.
    pub(super) n_fell_back: u64,
    /// Frames of the walk without waiting whose answer was not ready in time.
    pub(super) n_late: u64,
}

/// What was measured.
#[derive(Debug, Clone)]
pub(super) struct Measured {
    pub(super) methods: Vec<MethodSums>,
    /// Frames that count.
    pub(super) n_full: usize,
    /// Frames with the eye outside of every cell.
    pub(super) n_outside: usize,
    /// Frames that were never answered, because the budget is too small for what they need.
    pub(super) n_starved: usize,
    /// The most bytes of prepared subgraphs that were kept at once.
    pub(super) most_bytes: usize,
    /// Visible subgraphs that were prepared and dropped while waiting.
    pub(super) n_prepared: u64,
    pub(super) n_dropped: u64,
}

/// A frame by one method.
struct Shot {
    answer: Answer,
    cells: u64,
    objects: u64,
    polygons: u64,
    images: u64,
    image_polygons: u64,
    time: Duration,
    fell_back: bool,
}

impl<C: Cells> Walk<'_, C> {
    /// Walks all frames by each of the methods, which are in order, each no more than the one before: once waiting for
    /// what is prepared, taking times and checking that the answers are nested, and once without waiting.
    pub(super) fn measure(&self, methods: &[Method], progress: &dyn Fn(usize, usize)) -> Result<Measured> {
        let sums = |&method: &Method| MethodSums {
            method,
            cells: 0,
            objects: 0,
            polygons: 0,
            images: 0,
            image_polygons: 0,
            times: Vec::new(),
            n_fell_back: 0,
            n_late: 0,
        };
        let mut measured = Measured {
            methods: methods.iter().map(sums).collect(),
            n_full: 0,
            n_outside: 0,
            n_starved: 0,
            most_bytes: 0,
            n_prepared: 0,
            n_dropped: 0,
        };
        let mut walk = Walkthrough::new(self.cells.clone(), self.cells.clone(), self.options);
        for (chunk, views) in self.views.chunks(CHUNK).enumerate() {
            let shots = self.chunk(&mut walk, methods, chunk * CHUNK, views, &mut measured.most_bytes)?;
            for k in 0..views.len() {
                measured.add(shots.iter().map(|shots| &shots[k]));
            }
            progress((chunk + 1) * CHUNK, 2 * self.views.len());
        }
        (measured.n_prepared, measured.n_dropped) = walk.prepared();
        for (k, sums) in measured.methods.iter_mut().enumerate() {
            sums.times.sort_unstable();
            sums.n_late = self.hurry(sums.method);
            progress(self.views.len() * (methods.len() + k + 1) / methods.len(), 2 * self.views.len());
        }
        Ok(measured)
    }

    /// Some frames by all methods.
    fn chunk(
        &self,
        walk: &mut Walkthrough<C, C>,
        methods: &[Method],
        first: usize,
        views: &[View],
        most_bytes: &mut usize,
    ) -> Result<Vec<Vec<Shot>>> {
        let mut all = Vec::new();
        let mut coarser: Vec<Option<(Method, Sets)>> = vec![None; views.len()];
        for &method in methods {
            let mut shots = Vec::new();
            for (k, view) in views.iter().enumerate() {
                let (shot, sets) = self.shoot(walk, view, method)?;
                if let Some(sets) = sets {
                    if let Some((coarser, found)) = &coarser[k]
                        && let Some(what) = sets.beyond(found)
                    {
                        let (path, frame) = (self.file.to_owned(), first + k);
                        bail!(
                            "{}: frame {frame}: {method} finds {what}, which {coarser} does not; this is a defect of the program",
                            path.display(),
                            coarser = *coarser
                        );
                    }
                    coarser[k] = Some((method, sets));
                }
                *most_bytes = walk.kept().0.max(*most_bytes);
                shots.push(shot);
            }
            all.push(shots);
        }
        Ok(all)
    }

    /// A frame, repeated until it is answered in full; the time is that of the last. Its sets, if it was.
    fn shoot(&self, walk: &mut Walkthrough<C, C>, view: &View, method: Method) -> Result<(Shot, Option<Sets>)> {
        for left in (0..TRIES).rev() {
            while !walk.is_idle() {
                thread::sleep(NAP);
            }
            if let Some((_, error)) = walk.take_error() {
                return Err(error).in_file(self.file);
            }
            let start = Instant::now();
            let frame = walk.frame(view, method);
            let time = start.elapsed();
            if frame.answer == Answer::Late && left > 0 {
                continue;
            }
            let polygons =
                |objects: &[ObjectId]| objects.iter().map(|o| u64::from(self.polygons[o.idx()])).sum::<u64>();
            let shot = Shot {
                answer: frame.answer,
                cells: frame.seen.cells().len() as u64,
                objects: frame.seen.objects().len() as u64,
                polygons: polygons(frame.seen.objects()),
                images: frame.images.len() as u64,
                image_polygons: frame.images.iter().map(|image| polygons(&image.objects)).sum(),
                time,
                fell_back: frame.method < method,
            };
            let sets = (frame.answer == Answer::Full).then(|| Sets::of(&frame));
            return Ok((shot, sets));
        }
        unreachable!("the last try is not repeated")
    }

    /// Number of frames whose answer is not ready in time in a walk without waiting.
    fn hurry(&self, method: Method) -> u64 {
        let mut walk = Walkthrough::new(self.cells.clone(), self.cells.clone(), self.options);
        let pause = self.fps.map(|fps| Duration::from_secs(1) / fps);
        let start = Instant::now();
        for (k, view) in (0u32..).zip(self.views) {
            if let Some(pause) = pause {
                thread::sleep((pause * k).saturating_sub(start.elapsed()));
            }
            walk.frame(view, method);
        }
        walk.counters().late
    }
}

impl Measured {
    /// Adds a frame, as all methods had it.
    fn add<'a>(&mut self, shots: impl Iterator<Item = &'a Shot> + Clone) {
        let all = |answer: Answer| shots.clone().all(|shot| shot.answer == answer);
        if all(Answer::Outside) {
            self.n_outside += 1;
        } else if all(Answer::Full) {
            self.n_full += 1;
            for (sums, shot) in self.methods.iter_mut().zip(shots) {
                sums.cells += shot.cells;
                sums.objects += shot.objects;
                sums.polygons += shot.polygons;
                sums.images += shot.images;
                sums.image_polygons += shot.image_polygons;
                sums.times.push(shot.time);
                sums.n_fell_back += u64::from(shot.fell_back);
            }
        } else {
            self.n_starved += 1;
        }
    }
}
