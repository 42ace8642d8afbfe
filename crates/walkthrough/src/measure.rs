//! What eye-to-cell methods leave to draw along a walk, and what they cost.

use crate::coarse::CoarseVisibility;
use crate::nesting::{Found, Sets};
use crate::walkthrough::{AnswerKind, WalkOptions, Walkthrough};
use sightlines_eye_to_cell::{CellSource, Method, View};
use sightlines_pvs::ObjectId;
use std::thread;
use std::time::{Duration, Instant};

/// Frames that one method walks before the next one does: only so many answers are kept for the comparison.
const CHUNK: usize = 256;
/// A frame that was not answered is repeated at most so many times: with mirrors each may need one more to be prepared.
const TRIES: usize = 16;
/// How long to sleep while something is prepared.
const NAP: Duration = Duration::from_micros(50);

/// A walk to be measured.
#[derive(Debug, Clone, Copy)]
pub struct WalkMeasure<'a, C> {
    /// The table.
    pub cells: &'a C,
    /// The frames.
    pub views: &'a [View],
    /// The number of polygons of each object.
    pub polygons: &'a [u32],
    /// How to walk.
    pub options: WalkOptions,
    /// Frames in a second of the walk that does not wait; `None` for as many as possible.
    pub fps: Option<u32>,
}

/// What is left to draw: of a frame, or sums over frames.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct LeftToDraw {
    /// Cells.
    pub cells: u64,
    /// Objects.
    pub objects: u64,
    /// Polygons of the objects.
    pub polygons: u64,
    /// Images in mirrors.
    pub images: u64,
    /// Polygons of the objects in them.
    pub image_polygons: u64,
}

impl std::ops::AddAssign for LeftToDraw {
    fn add_assign(&mut self, other: Self) {
        self.cells += other.cells;
        self.objects += other.objects;
        self.polygons += other.polygons;
        self.images += other.images;
        self.image_polygons += other.image_polygons;
    }
}

/// What a method did on the frames that all methods answered in full.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MethodSums {
    /// The method.
    pub method: Method,
    /// Sums over frames.
    pub left: LeftToDraw,
    /// Of each frame, ascending.
    pub times: Vec<Duration>,
    /// Frames that had more to do than the steps allow, or than is in proportion, so that a coarser method answered in part.
    pub n_fell_back: u64,
    /// Frames of the walk without waiting whose answer was not ready in time.
    pub n_late: u64,
}

/// What was measured.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct WalkMeasured {
    /// Method by method.
    pub methods: Vec<MethodSums>,
    /// Frames that count.
    pub n_full: usize,
    /// Frames with the eye outside of every cell.
    pub n_outside: usize,
    /// Frames that were never answered, because the budget is too small for what they need.
    pub n_starved: usize,
    /// The most bytes of prepared subgraphs that were kept at once.
    pub most_bytes: usize,
    /// Visible subgraphs that were prepared while waiting.
    pub n_prepared: u64,
    /// Of these, those that were dropped.
    pub n_dropped: u64,
}

/// Why a walk is not measured.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MeasureError<E> {
    /// The table cannot be read.
    #[error(transparent)]
    Source(E),
    /// A method finds what a coarser one does not: a defect of these methods, or a table that is damaged.
    #[error("frame {frame}: {method} finds {found}, which {coarser} does not")]
    NotNested {
        /// The frame.
        frame: usize,
        /// The method.
        method: Method,
        /// What it finds.
        found: Found,
        /// The coarser method.
        coarser: Method,
    },
}

/// A frame by one method.
struct Shot {
    answer: AnswerKind,
    left: LeftToDraw,
    time: Duration,
    fell_back: bool,
}

impl<C, E: Send + 'static> WalkMeasure<'_, C>
where
    C: CellSource<Error = E> + CoarseVisibility<PlaceError = E> + Clone + Send + 'static,
{
    /// Walks all frames by each of the methods, which are in order, each no more than the one before: once waiting for
    /// what is prepared, taking times and checking that the answers are nested, and once without waiting.
    ///
    /// * `progress`: hears how many frames of how many are done
    ///
    /// # Errors
    /// [`MeasureError`].
    pub fn run(&self, methods: &[Method], progress: &dyn Fn(usize, usize)) -> Result<WalkMeasured, MeasureError<E>> {
        let sums = |&method: &Method| MethodSums {
            method,
            left: LeftToDraw::default(),
            times: Vec::new(),
            n_fell_back: 0,
            n_late: 0,
        };
        let mut measured = WalkMeasured { methods: methods.iter().map(sums).collect(), ..WalkMeasured::default() };
        let mut walk = self.start();
        let n_views = self.views.len();
        for (chunk, views) in self.views.chunks(CHUNK).enumerate() {
            let shots = self.chunk(&mut walk, methods, (chunk * CHUNK, views), &mut measured.most_bytes)?;
            for k in 0..views.len() {
                measured.add(shots.iter().map(|shots| &shots[k]));
            }
            progress((chunk + 1) * CHUNK, 2 * n_views);
        }
        (measured.n_prepared, measured.n_dropped) = walk.prepared();
        for (k, sums) in measured.methods.iter_mut().enumerate() {
            sums.times.sort_unstable();
            sums.n_late = self.hurry(sums.method);
            progress(n_views * (methods.len() + k + 1) / methods.len(), 2 * n_views);
        }
        Ok(measured)
    }

    fn start(&self) -> Walkthrough<C, C> {
        Walkthrough::new(self.cells.clone(), self.cells.clone(), self.options)
    }

    /// Some frames by all methods, from the frame `first` on.
    fn chunk(
        &self,
        walk: &mut Walkthrough<C, C>,
        methods: &[Method],
        (first, views): (usize, &[View]),
        most_bytes: &mut usize,
    ) -> Result<Vec<Vec<Shot>>, MeasureError<E>> {
        let mut all = Vec::new();
        let mut coarser: Vec<Option<(Method, Sets)>> = vec![None; views.len()];
        for &method in methods {
            let mut shots = Vec::new();
            for ((frame, view), coarser) in (first..).zip(views).zip(&mut coarser) {
                let (shot, sets) = self.shoot(walk, view, method)?;
                if let Some(sets) = sets {
                    let before = coarser.as_ref().and_then(|(coarser, found)| Some((*coarser, sets.beyond(found)?)));
                    if let Some((coarser, found)) = before {
                        return Err(MeasureError::NotNested { frame, method, found, coarser });
                    }
                    *coarser = Some((method, sets));
                }
                *most_bytes = walk.kept().0.max(*most_bytes);
                shots.push(shot);
            }
            all.push(shots);
        }
        Ok(all)
    }

    /// A frame, repeated until it is answered in full; the time is that of the last. Its sets, if it was.
    fn shoot(
        &self,
        walk: &mut Walkthrough<C, C>,
        view: &View,
        method: Method,
    ) -> Result<(Shot, Option<Sets>), MeasureError<E>> {
        for left in (0..TRIES).rev() {
            while !walk.is_idle() {
                thread::sleep(NAP);
            }
            if let Some((_, error)) = walk.take_error() {
                return Err(MeasureError::Source(error));
            }
            let start = Instant::now();
            let frame = walk.frame(view, method);
            let time = start.elapsed();
            if frame.answer == AnswerKind::Late && left > 0 {
                continue;
            }
            let polygons =
                |objects: &[ObjectId]| objects.iter().map(|o| u64::from(self.polygons[o.idx()])).sum::<u64>();
            let left = LeftToDraw {
                cells: frame.seen.cells().len() as u64,
                objects: frame.seen.objects().len() as u64,
                polygons: polygons(frame.seen.objects()),
                images: frame.images.len() as u64,
                image_polygons: frame.images.iter().map(|image| polygons(&image.objects)).sum(),
            };
            let sets = (frame.answer == AnswerKind::Full).then(|| Sets::of(&frame));
            return Ok((Shot { answer: frame.answer, left, time, fell_back: frame.method < method }, sets));
        }
        unreachable!("the last try is not repeated")
    }

    /// Number of frames whose answer is not ready in time in a walk without waiting.
    fn hurry(&self, method: Method) -> u64 {
        let mut walk = self.start();
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

impl WalkMeasured {
    /// Adds a frame, as all methods had it.
    fn add<'a>(&mut self, shots: impl Iterator<Item = &'a Shot> + Clone) {
        let all = |answer: AnswerKind| shots.clone().all(|shot| shot.answer == answer);
        if all(AnswerKind::Outside) {
            self.n_outside += 1;
        } else if all(AnswerKind::Full) {
            self.n_full += 1;
            for (sums, shot) in self.methods.iter_mut().zip(shots) {
                sums.left += shot.left;
                sums.times.push(shot.time);
                sums.n_fell_back += u64::from(shot.fell_back);
            }
        } else {
            self.n_starved += 1;
        }
    }
}
