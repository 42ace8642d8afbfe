//! Depths of all points from all points, by breadth-first searches of many points at once.
//!
//! A set of starting points is [`WORDS`] words of bits. Each search that is at a point has its bit in the point's set, so one pass over
//! the rows continues 256 searches (Then et al., "The more the merrier: efficient multi-source graph traversal", PVLDB 8(4), 2014).
//!
//! A step goes in the direction in which fewer rows are passed (Beamer, Asanović and Patterson, "Direction-optimizing breadth-first
//! search", SC 2012). Bottom-up, each point that some searches have not reached collects the searches that were at any point that it
//! sees, and stops when none is missing. Top-down, each point that searches have just reached hands them to all points that it sees.
//! A run costs the same whatever its length: the union over its points is that of two unions over a power of two of points, which are
//! computed once for each step; and what all its points get is handed to two such groups, and on from these at the end.

use crate::work::Stage;
use crate::{Run, VisibilityGraph, WorkOptions};
use sightlines_progress::{Halt, Kept};

/// Words of a set.
const WORDS: usize = 4;
/// Searches at once.
pub(crate) const WIDTH: usize = 64 * WORDS;

/// A set of searches.
type Set = [u64; WORDS];

const NONE: Set = [0; WORDS];

/// How many points each of some searches found at each depth.
pub(crate) struct Depths {
    /// `WIDTH` numbers for each depth from 0.
    counts: Vec<u32>,
}

impl Depths {
    /// The numbers of a search, up to its last depth.
    pub(crate) fn of(&self, search: usize, counts: &mut Vec<u32>) {
        counts.extend(self.counts.iter().skip(search).step_by(WIDTH));
        while counts.last() == Some(&0) {
            counts.pop();
        }
    }

    /// Whether they can be of a batch of so many points.
    fn fit(&self, batch: usize, n_points: usize) -> bool {
        let n_searches = (n_points - batch * WIDTH).min(WIDTH);
        let fits = |search: usize| {
            let found: u64 = self.counts.iter().skip(search).step_by(WIDTH).map(|&count| u64::from(count)).sum();
            self.counts[search] == u32::from(search < n_searches) && found <= n_points as u64
        };
        self.counts.len() >= WIDTH && (0..WIDTH).all(fits)
    }
}

/// How many depths there are, and all counts.
impl Kept for Depths {
    fn write(&self, out: &mut Vec<u8>) {
        (self.counts.len() / WIDTH).write(out);
        u32::write_all(&self.counts, out);
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        let n = usize::read(bytes)?.checked_mul(WIDTH)?;
        Some(Self { counts: u32::read_all(bytes, n)? })
    }
}

/// Memory of a thread.
struct Room {
    /// Searches that are done with a point, or will never come to it.
    done: Vec<Set>,
    /// `levels[k][p]`: searches that were, after the last step, at any of the 2^k points from p on.
    levels: Vec<Vec<Set>>,
    next: Vec<Set>,
}

/// The depths of all points from all points, in batches of [`WIDTH`].
pub(crate) fn depths(
    graph: &VisibilityGraph,
    radius: Option<u32>,
    effort: &WorkOptions<'_>,
) -> Result<Vec<Depths>, Halt> {
    let n = graph.n_points();
    let components = graph.components();
    let longest = (0..n as u32).flat_map(|p| graph.row(p)).map(|run| run.end - run.start).max().unwrap_or(1);
    let n_levels = longest.ilog2() as usize + 1;
    let room = || Room { done: vec![NONE; n], levels: vec![vec![NONE; n]; n_levels], next: vec![NONE; n] };
    let batch = |room: &mut Room, batch: usize| {
        let first = batch * WIDTH;
        Ok(search(graph, &components, first..(first + WIDTH).min(n), radius.unwrap_or(u32::MAX), room))
    };
    let fits = &|depths: &Depths, batch: usize| depths.fit(batch, n);
    let stage = Stage { title: "depths", phase: "depths", size: 1, cost: &|_| 1.0, fits };
    effort.each(&stage, n.div_ceil(WIDTH), room, batch)
}

fn search(
    graph: &VisibilityGraph,
    components: &[u32],
    sources: std::ops::Range<usize>,
    radius: u32,
    room: &mut Room,
) -> Depths {
    let bit = |source: usize| {
        (source - sources.start, (source - sources.start) / 64, 1u64 << ((source - sources.start) % 64))
    };
    let mut counts = vec![0u32; WIDTH];
    // No search comes to another component; it need not be looked for there.
    let mut of_component = vec![(u32::MAX, NONE); 0];
    for source in sources.clone() {
        let (_, word, bit) = bit(source);
        match of_component.iter_mut().find(|(component, _)| *component == components[source]) {
            Some((_, set)) => set[word] |= bit,
            None => {
                let mut set = NONE;
                set[word] |= bit;
                of_component.push((components[source], set));
            }
        }
    }
    of_component.sort_unstable_by_key(|(component, _)| *component);
    for (done, component) in room.done.iter_mut().zip(components) {
        let found = of_component.binary_search_by_key(component, |(component, _)| *component);
        *done = found.map_or([!0; WORDS], |k| of_component[k].1.map(|word| !word));
    }
    let frontier = &mut room.levels[0];
    frontier.fill(NONE);
    for source in sources.clone() {
        let (search, word, bit) = bit(source);
        counts[search] = 1;
        room.done[source][word] |= bit;
        for point in graph.seen(source as u32) {
            frontier[point as usize][word] |= bit;
        }
    }
    for depth in 1u32.. {
        // The frontier is what a step came to; what was there already is taken out.
        let mut at_depth = vec![0u32; WIDTH];
        let mut is_any = false;
        if depth <= radius {
            for (frontier, done) in room.levels[0].iter_mut().zip(&mut room.done) {
                for word in 0..WORDS {
                    let new = frontier[word] & !done[word];
                    frontier[word] = new;
                    done[word] |= new;
                    is_any |= new != 0;
                    let mut rest = new;
                    while rest != 0 {
                        at_depth[64 * word + rest.trailing_zeros() as usize] += 1;
                        rest &= rest - 1;
                    }
                }
            }
        }
        if !is_any {
            break;
        }
        counts.extend(at_depth);
        let n_runs = |of: &dyn Fn(usize) -> bool| -> usize {
            (0..room.done.len()).filter(|&p| of(p)).map(|p| graph.row(p as u32).len()).sum()
        };
        let bottom_up = n_runs(&|p| room.done[p] != [!0; WORDS]);
        let top_down = n_runs(&|p| room.levels[0][p] != NONE);
        if bottom_up == 0 {
            break;
        }
        if bottom_up < top_down { collect(graph, room) } else { hand_on(graph, room) }
    }
    Depths { counts }
}

/// A step bottom-up, from the frontier to all points that are not done with.
fn collect(graph: &VisibilityGraph, room: &mut Room) {
    let n = room.done.len();
    for k in 1..room.levels.len() {
        let (lower, upper) = room.levels.split_at_mut(k);
        let (lower, upper) = (&lower[k - 1], &mut upper[0]);
        let half = 1 << (k - 1);
        for p in 0..n.saturating_sub(half) {
            upper[p] = union(lower[p], lower[p + half]);
        }
    }
    for (point, (done, next)) in room.done.iter().zip(&mut room.next).enumerate() {
        *next = NONE;
        if *done != [!0; WORDS] {
            for &Run { start, end } in graph.row(point as u32) {
                let k = (end - start).ilog2();
                let level = &room.levels[k as usize];
                *next = union(*next, union(level[start as usize], level[end as usize - (1 << k)]));
                if union(*next, *done) == [!0; WORDS] {
                    break;
                }
            }
        }
    }
    std::mem::swap(&mut room.levels[0], &mut room.next);
}

/// A step top-down, from the points of the frontier to all that they see.
fn hand_on(graph: &VisibilityGraph, room: &mut Room) {
    std::mem::swap(&mut room.levels[0], &mut room.next);
    room.levels.iter_mut().for_each(|level| level.fill(NONE));
    for (point, &searches) in room.next.iter().enumerate().filter(|(_, searches)| **searches != NONE) {
        for &Run { start, end } in graph.row(point as u32) {
            let k = (end - start).ilog2();
            let level = &mut room.levels[k as usize];
            for group in [start as usize, end as usize - (1 << k)] {
                level[group] = union(level[group], searches);
            }
        }
    }
    let n = room.done.len();
    for k in (1..room.levels.len()).rev() {
        let (lower, upper) = room.levels.split_at_mut(k);
        let (lower, upper) = (&mut lower[k - 1], &upper[0]);
        let half = 1 << (k - 1);
        for p in 0..n.saturating_sub(half) {
            lower[p] = union(lower[p], upper[p]);
            lower[p + half] = union(lower[p + half], upper[p]);
        }
    }
}

fn union(a: Set, b: Set) -> Set {
    std::array::from_fn(|k| a[k] | b[k])
}
