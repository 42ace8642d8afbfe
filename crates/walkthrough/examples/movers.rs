//! Moving objects in an office tower while a viewer walks through it: the cost of the movers in a frame with temporal
//! bounding volumes, and with the plain method that queries the position of every mover and the cells at every
//! position.
//!
//! `movers [FLOORS] [FRAMES] [CELLS]`: a tower of 6 floors, 900 frames at 60 frames per second, and the default of
//! [`MoverOptions`] as the largest number of cells of a volume.

use sightlines_bake::{SceneBakeOptions, bake_scene};
use sightlines_eye_to_cell::{Method, TableCells, View, VisibleSet};
use sightlines_geometry::Aabb;
use sightlines_pvs::Table;
use sightlines_scenes::{TowerOptions, tower, tower_rooms};
use sightlines_walkthrough::{
    AnswerKind, CameraPose, DrawList, Motion, MoverId, MoverOptions, Movers, WalkOptions, Walkthrough, wander,
};
use std::error::Error;
use std::sync::Arc;
use std::time::{Duration, Instant};

type Cells = TableCells<Arc<Table>>;

/// Frames per second.
const RATE: f64 = 60.0;

/// How a mover moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// To and fro in a room; promises a top speed, and to stay in the tower.
    Fast,
    /// The same; promises the room too.
    InRoom,
    /// Up and down through all floors.
    Lifts,
}

/// A box that goes to and fro between two corners.
#[derive(Debug, Clone)]
struct Thing {
    from: [f64; 3],
    to: [f64; 3],
    size: [f64; 3],
    /// Seconds for the way there and back, and the phase at the start.
    period: f64,
    phase: f64,
}

impl Thing {
    fn at(&self, now: f64) -> Aabb<3> {
        let t = (now / self.period + self.phase).fract();
        let share = 1.0 - (2.0 * t - 1.0).abs();
        let min = std::array::from_fn(|k| self.from[k] + share * (self.to[k] - self.from[k]));
        Aabb { min, max: std::array::from_fn(|k| min[k] + self.size[k]) }
    }

    /// The largest change of a coordinate per second, and a millionth more for the rounding of [`Thing::at`].
    fn speed(&self) -> f64 {
        let way = (0..3).map(|k| (self.to[k] - self.from[k]).abs()).fold(0.0, f64::max);
        2.0 * way / self.period * (1.0 + 1e-6) + 1e-6
    }
}

/// Pseudorandom numbers that are the same everywhere.
struct Chance(u64);

impl Chance {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f64 / (1u64 << 24) as f64
    }
}

fn things(n: usize, kind: Kind, rooms: &[Aabb<3>], all: &Aabb<3>) -> Vec<(Thing, Motion)> {
    let mut chance = Chance(7);
    let mut thing = |k: usize| {
        let mut room = rooms[(k * 7919) % rooms.len()];
        let size = [0.4, 0.4, 0.4];
        if kind == Kind::Lifts {
            (room.min[1], room.max[1]) = (all.min[1], all.max[1]);
        }
        let mut corner =
            || std::array::from_fn(|i| room.min[i] + chance.next() * (room.max[i] - room.min[i] - size[i]));
        let (from, to) = (corner(), corner());
        let thing = Thing { from, to, size, period: 4.0 + 8.0 * chance.next(), phase: chance.next() };
        let motion = Motion::speed(thing.speed())?;
        Ok((thing, motion.and_within(if kind == Kind::InRoom { room } else { *all })?))
    };
    (0..n)
        .map(&mut thing)
        .collect::<Result<_, sightlines_walkthrough::MotionError>>()
        .expect("rooms and speeds are finite")
}

/// A stored frame of the walk: its visible cells do not depend on movers.
struct Kept {
    seen: VisibleSet,
    answer: AnswerKind,
}

fn frames_of(cells: &Cells, stands: &[CameraPose]) -> Result<Vec<Kept>, Box<dyn Error>> {
    let mut walk = Walkthrough::new(cells.clone(), cells.clone(), WalkOptions::default());
    let mut frames = Vec::new();
    for stand in stands {
        let view = View::perspective_horizontal(stand.eye, stand.dir, [0.0, 1.0, 0.0], 1.2, 1.6)?;
        walk.frame(&view, Method::Exact);
        while !walk.is_idle() {
            std::thread::yield_now();
        }
        let frame = walk.frame(&view, Method::Exact);
        frames.push(Kept { seen: frame.seen.clone(), answer: frame.answer });
    }
    Ok(frames)
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1);
    let floors = args.next().map_or(Ok(6), |text| text.parse())?;
    let n_frames = args.next().map_or(Ok(900), |text| text.parse())?;
    let mut how = MoverOptions::default();
    how.cells = args.next().map_or(Ok(how.cells), |text| text.parse())?;
    let options = TowerOptions { floors, furniture: 0, ..TowerOptions::default() };
    let rooms: Vec<Aabb<3>> = tower_rooms(options)?.into_iter().map(|room| room.bounds).collect();
    let start = Instant::now();
    let table = bake_scene(&tower(options)?, &SceneBakeOptions::default())?.table;
    println!("{} cells, {} rooms, table after {:.1} s", table.n_cells(), rooms.len(), start.elapsed().as_secs_f64());
    let all = rooms.iter().fold(Aabb::EMPTY, |all: Aabb<3>, room| all.with(room.min).with(room.max));
    let cells = TableCells::new(Arc::new(table));
    // A walk at 1.5 units a second.
    let stands = wander(&cells, n_frames, 1.5 / RATE, 3)?;
    let frames = frames_of(&cells, &stands)?;
    let in_view = frames.iter().map(|f| f.seen.cells().len()).sum::<usize>() as f64 / n_frames as f64;
    println!("{in_view:.0} cells in view of a mean frame");
    for kind in [Kind::InRoom, Kind::Fast, Kind::Lifts] {
        for n in [10, 1_000, 100_000] {
            compare(&cells, &frames, how, kind, &things(n, kind, &rooms, &all));
        }
    }
    Ok(())
}

/// Runs the frames with both methods, and prints their cost.
fn compare(cells: &Cells, frames: &[Kept], how: MoverOptions, kind: Kind, things: &[(Thing, Motion)]) {
    let n = things.len();
    let mut movers = Movers::new(cells.clone(), how);
    let mut twin = Movers::new(cells.clone(), MoverOptions::default());
    for (thing, motion) in things {
        movers.add(thing.at(0.0), *motion, 0.0).expect("a finite box");
    }
    let (mut ours, mut plain) = (Vec::new(), Vec::new());
    let mut n_seen = 0;
    for (k, kept) in frames.iter().enumerate() {
        let now = k as f64 / RATE;
        let frame =
            DrawList { seen: &kept.seen, at: &[], answer: kept.answer, method: Method::Exact, images: &[], ahead: &[] };
        let start = Instant::now();
        let reported = movers.frame(now, &frame, &mut |id: MoverId| things[id.slot()].0.at(now)).expect("time goes on");
        ours.push(start.elapsed());
        let reported: Vec<usize> = reported.iter().map(|id| id.slot()).collect();
        // The plain method is slow with many movers: a sample of the frames measures its time and checks that the
        // answers are equal.
        if k % 20 == 1 {
            let start = Instant::now();
            let all: Vec<usize> = (0..n).filter(|&i| twin.sees(&frame, &things[i].0.at(now))).collect();
            plain.push(start.elapsed());
            assert_eq!(reported, all, "frame {k}");
        }
        n_seen += reported.len();
    }
    let n_frames = frames.len() as f64;
    // In the first quarter all movers fall asleep for the first time.
    let (early, late) = ours.split_at(ours.len() / 4);
    let (early, ours, plain) = (Times::of(early), Times::of(late), Times::of(&plain));
    let counters = movers.counters();
    let per_frame = |count: u64| count as f64 / n_frames;
    assert_eq!(counters.broken, 0);
    println!(
        "{kind:?} {n}: us a frame {:.1} (median {:.1}, worst {:.0}; in the first quarter {:.1}, worst {:.0}), plain {:.1} (median {:.1}): {:.1} times less; \
         a frame sees {:.1}, asks {:.1}, expired {:.2}, in vain {:.2}, tried {:.2}, entered {:.2}; entries {}",
        ours.mean,
        ours.median,
        ours.worst,
        early.mean,
        early.worst,
        plain.mean,
        plain.median,
        plain.mean / ours.mean,
        n_seen as f64 / n_frames,
        per_frame(counters.asked),
        per_frame(counters.expired),
        per_frame(counters.in_vain),
        per_frame(counters.tried),
        per_frame(counters.entered),
        movers.n_entries(),
    );
}

/// Times in microseconds.
struct Times {
    mean: f64,
    median: f64,
    worst: f64,
}

fn micros(time: Duration) -> f64 {
    time.as_secs_f64() * 1e6
}

impl Times {
    fn of(times: &[Duration]) -> Self {
        let mut all: Vec<f64> = times.iter().copied().map(micros).collect();
        all.sort_by(f64::total_cmp);
        let mean = all.iter().sum::<f64>() / all.len().max(1) as f64;
        let at = |k: usize| all.get(k).copied().unwrap_or_default();
        Self { mean, median: at(all.len() / 2), worst: at(all.len().saturating_sub(1)) }
    }
}
