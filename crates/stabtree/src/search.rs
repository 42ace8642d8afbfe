//! Which zones see each other: depth first from every zone, cut short by what is already known.
//!
//! From each exit of a zone the search follows every sequence of portals that the stabber lets pass.
//! The zones it enters are visible. A branch carries its *candidates*, the zones that it may still
//! reach and that matter, and ends when there are none. A candidate goes
//!
//! * when it has been seen from the source;
//! * when the branch enters a zone that is finished and does not see it: what a line sees after passing
//!   a zone, that zone sees (symmetry makes a finished zone count for both);
//! * when its bounds lie behind a portal of the branch, or outside all lines of the branch.
//!
//! Each rule only removes zones that no line of the branch reaches, so the answer is exact whatever the
//! order of the sources; the order, and zones known beforehand to be visible, only save work. That is
//! also why threads may share their findings and the result is still the same.
//!
//! Source: Teller and Séquin, SIGGRAPH 1991, section 4, for the search; the candidate sets are in the
//! spirit of the "might see" vectors of Quake's vis, made exact and symmetric.

use crate::network::{NO_ZONE, Network, Step};
use sightlines_pvs::BitMatrix;
use sightlines_sightline::Stabber;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering::Relaxed};

/// Called with the number of finished zones and of all zones; from any thread.
pub type Progress<'a> = &'a (dyn Fn(usize, usize) + Sync);

/// How to search. None of it changes the answer.
#[derive(Clone, Copy)]
pub struct SearchOptions<'a> {
    /// Number of threads; 0 for one for each core.
    pub threads: usize,
    /// Chords shot through each exit before the search.
    pub chords: u32,
    /// Told how far the search is.
    pub progress: Option<Progress<'a>>,
}

impl Default for SearchOptions<'_> {
    fn default() -> Self {
        Self { threads: 0, chords: 8, progress: None }
    }
}

impl std::fmt::Debug for SearchOptions<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SearchOptions").field("threads", &self.threads).field("chords", &self.chords).finish()
    }
}

/// What a search did. With several threads the counts vary from run to run; the answer does not.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct SearchSummary {
    /// Portals pushed, passable or not.
    pub n_pushes: u64,
    /// Cells entered, counted once for each sequence that enters them.
    pub n_visits: u64,
}

/// At most this many candidates are tested against the lines of a branch one by one. A test costs about
/// as much as a push, and cutting a branch saves several; with more candidates it rarely cuts.
const FEW: u32 = 16;

/// Largest table of "what lies in front of which exit", in words: 64 MiB.
const MAX_FRONT_WORDS: usize = 8 << 20;

/// Finds which zones see each other.
///
/// * `network`: cells, exits, zones.
/// * `stabber`: cloned for each thread; its state does not matter.
/// * `known`: zones by zones, pairs known to be visible; may be the identity. It must be a subset of
///   what is visible.
/// * Returns a symmetric matrix with the diagonal set.
///
/// Exact if the stabber is. Cost: output-sensitive in practice and exponential at worst, as every
/// search over portal sequences; memory is a few bit matrices.
///
/// # Panics
/// If `known` is not zones by zones.
pub fn visible_zones<S>(
    network: &Network<S::Portal, S::Bounds>,
    stabber: &S,
    known: BitMatrix,
    options: &SearchOptions<'_>,
) -> (BitMatrix, SearchSummary)
where
    S: Stabber,
    S::Portal: Sync,
    S::Bounds: Sync,
{
    let n = network.n_zones();
    assert!(known.n_rows() == n && known.n_cols() == n, "known pairs are zones by zones");
    let mut order: Vec<u32> = (0..n as u32).collect();
    // Zones that see little are finished quickly and then cut the searches of those that see much.
    order.sort_by_key(|&z| (known.count_row(z as usize), z));
    let shared = Shared {
        network,
        width: n.div_ceil(64),
        front: Front::build(network, stabber),
        seen: (0..n).flat_map(|z| known.row(z).iter().map(|&w| AtomicU64::new(w)).collect::<Vec<_>>()).collect(),
        might: might_rows(n),
        next: AtomicUsize::new(0),
        done: AtomicUsize::new(0),
    };
    let work = |stabber: S| {
        let mut worker = Worker::new(&shared, stabber);
        while let Some(&zone) = order.get(shared.next.fetch_add(1, Relaxed)) {
            worker.finish(zone);
            let done = shared.done.fetch_add(1, Relaxed) + 1;
            if let Some(progress) = options.progress {
                progress(done, n);
            }
        }
        worker.summary
    };
    let threads = match options.threads {
        0 => std::thread::available_parallelism().map_or(1, usize::from),
        t => t,
    };
    let summary = if threads == 1 {
        work(stabber.clone())
    } else {
        std::thread::scope(|scope| {
            let stabbers = (0..threads).map(|_| stabber.clone());
            let workers: Vec<_> = stabbers.map(|s| scope.spawn(|| work(s))).collect();
            let summaries = workers.into_iter().map(|w| w.join().expect("a search does not panic"));
            summaries.fold(SearchSummary::default(), |s, t| SearchSummary {
                n_pushes: s.n_pushes + t.n_pushes,
                n_visits: s.n_visits + t.n_visits,
            })
        })
    };
    (shared.into_matrix(n), summary)
}

/// Every zone might see every other; bits past the last zone are clear.
fn might_rows(n: usize) -> Vec<AtomicU64> {
    let width = n.div_ceil(64);
    let word = |i: usize| if i + 1 == width { u64::MAX >> (n.wrapping_neg() % 64) } else { u64::MAX };
    (0..n).flat_map(|_| (0..width).map(|i| AtomicU64::new(word(i)))).collect()
}

/// The places of the ones of a word, ascending.
fn ones(mut word: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let place = (word != 0).then(|| word.trailing_zeros() as usize);
        word &= word.wrapping_sub(1);
        place
    })
}

/// For each exit into another zone, the zones that lie at least partly in front of it.
struct Front {
    /// Row of each exit; row 0 is "everything".
    row_of: Vec<u32>,
    rows: Vec<u64>,
}

impl Front {
    fn build<S: Stabber>(network: &Network<S::Portal, S::Bounds>, stabber: &S) -> Self {
        let width = network.n_zones().div_ceil(64);
        let mut front = Self { row_of: vec![0; network.steps.len()], rows: vec![u64::MAX; width] };
        let n_rows: usize = network.sources.iter().map(Vec::len).sum();
        if (n_rows + 1) * width > MAX_FRONT_WORDS {
            return front;
        }
        for &exit in network.sources.iter().flatten() {
            let portal = network.steps[exit as usize].portal;
            front.row_of[exit as usize] = (front.rows.len() / width) as u32;
            let words = network.bounds.chunks(64).map(|chunk| {
                let bit = |(i, b)| u64::from(stabber.in_front(portal, b)) << i;
                chunk.iter().enumerate().map(bit).fold(0, |w, b| w | b)
            });
            front.rows.extend(words);
        }
        front
    }
}

/// What all threads see.
struct Shared<'a, P, B> {
    network: &'a Network<P, B>,
    /// Words of a row.
    width: usize,
    front: Front,
    /// Pairs found visible.
    seen: Vec<AtomicU64>,
    /// Pairs not yet proven hidden.
    might: Vec<AtomicU64>,
    next: AtomicUsize,
    done: AtomicUsize,
}

impl<P, B> Shared<'_, P, B> {
    fn into_matrix(self, n: usize) -> BitMatrix {
        let mut matrix = BitMatrix::new(n, n);
        for zone in 0..n {
            let words = &self.seen[zone * self.width..(zone + 1) * self.width];
            for (to, from) in matrix.row_mut(zone).iter_mut().zip(words) {
                *to = from.load(Relaxed);
            }
        }
        matrix
    }
}

/// A cell on the current sequence.
struct Frame<U> {
    /// Next exit to try, and the end of the cell's exits.
    at: u32,
    end: u32,
    entry_side: u32,
    /// Latest zone on the sequence.
    zone: u32,
    /// Candidates, as a range of the worker's arena.
    candidates: (u32, u32),
    undo: Option<U>,
}

/// One thread's search.
struct Worker<'a, S: Stabber> {
    shared: &'a Shared<'a, S::Portal, S::Bounds>,
    stabber: S,
    /// Row of the source, as far as known.
    seen: Vec<u64>,
    /// Candidate words of all frames: index of the word, and its bits.
    arena: Vec<(u32, u64)>,
    stack: Vec<Frame<S::Undo>>,
    summary: SearchSummary,
}

impl<'a, S: Stabber> Worker<'a, S> {
    fn new(shared: &'a Shared<'a, S::Portal, S::Bounds>, stabber: S) -> Self {
        let (arena, stack) = (Vec::new(), Vec::new());
        Self { shared, stabber, seen: vec![0; shared.width], arena, stack, summary: SearchSummary::default() }
    }

    /// Decides all pairs of one zone and publishes them.
    fn finish(&mut self, zone: u32) {
        let width = self.shared.width;
        let row = zone as usize * width..(zone as usize + 1) * width;
        for (to, from) in self.seen.iter_mut().zip(&self.shared.seen[row.clone()]) {
            *to = from.load(Relaxed);
        }
        for &exit in &self.shared.network.sources[zone as usize] {
            self.search_from(zone, exit);
        }
        self.publish(zone);
    }

    fn publish(&self, zone: u32) {
        let width = self.shared.width;
        let (own_word, own_bit) = (zone as usize / 64, 1u64 << (zone % 64));
        for (i, &seen) in self.seen.iter().enumerate() {
            let own = zone as usize * width + i;
            self.shared.seen[own].fetch_or(seen, Relaxed);
            let might = self.shared.might[own].fetch_and(seen, Relaxed);
            for other in ones(seen) {
                self.shared.seen[(i * 64 + other) * width + own_word].fetch_or(own_bit, Relaxed);
            }
            for other in ones(might & !seen) {
                self.shared.might[(i * 64 + other) * width + own_word].fetch_and(!own_bit, Relaxed);
            }
        }
    }

    fn search_from(&mut self, zone: u32, exit: u32) {
        let shared = self.shared;
        let step = &shared.network.steps[exit as usize];
        self.arena.clear();
        for (i, might) in shared.might[zone as usize * shared.width..][..shared.width].iter().enumerate() {
            let bits = might.load(Relaxed);
            if bits != 0 {
                self.arena.push((i as u32, bits));
            }
        }
        let all = (0, self.arena.len() as u32);
        self.stabber.start(step.portal);
        self.summary.n_pushes += 1;
        self.enter(exit, zone, all, None);
        while let Some(frame) = self.stack.last_mut() {
            if frame.at == frame.end {
                self.leave();
                continue;
            }
            let exit = frame.at;
            frame.at += 1;
            let step: &Step<S::Portal> = &shared.network.steps[exit as usize];
            if step.side == frame.entry_side {
                continue;
            }
            self.summary.n_pushes += 1;
            if let Some(undo) = self.stabber.push(step.portal) {
                let (zone, candidates) = (frame.zone, frame.candidates);
                if !self.enter(exit, zone, candidates, Some(undo)) {
                    self.stabber.undo(undo);
                }
            }
        }
    }

    fn leave(&mut self) {
        if let Some(frame) = self.stack.pop() {
            // The arena ends with the list of the latest frame.
            self.arena.truncate(self.stack.last().map_or(0, |f| f.candidates.1) as usize);
            if let Some(undo) = frame.undo {
                self.stabber.undo(undo);
            }
        }
    }

    /// Enters the cell behind `exit`: marks its zone, and goes on if that can show anything new.
    fn enter(&mut self, exit: u32, from_zone: u32, candidates: (u32, u32), undo: Option<S::Undo>) -> bool {
        let step = &self.shared.network.steps[exit as usize];
        self.summary.n_visits += 1;
        let new_zone = step.zone != NO_ZONE && step.zone != from_zone;
        let (zone, candidates) = if new_zone {
            self.seen[step.zone as usize / 64] |= 1 << (step.zone % 64);
            (step.zone, self.narrow(exit, step.zone, candidates))
        } else {
            let list = &self.arena[candidates.0 as usize..candidates.1 as usize];
            let any = list.iter().any(|&(i, bits)| bits & !self.seen[i as usize] != 0);
            (from_zone, if any { candidates } else { (0, 0) })
        };
        if candidates.0 == candidates.1 {
            return false;
        }
        let first = &self.shared.network.first;
        let (at, end) = (first[step.to as usize], first[step.to as usize + 1]);
        self.stack.push(Frame { at, end, entry_side: step.entry_side, zone, candidates, undo });
        true
    }

    /// The candidates that remain after crossing `exit` into `zone`, as a new list; nothing is added to
    /// the arena if none remain.
    fn narrow(&mut self, exit: u32, zone: u32, candidates: (u32, u32)) -> (u32, u32) {
        let shared = self.shared;
        let might = &shared.might[zone as usize * shared.width..][..shared.width];
        let front = &shared.front.rows[shared.front.row_of[exit as usize] as usize * shared.width..][..shared.width];
        let start = self.arena.len();
        let mut count = 0;
        for k in candidates.0 as usize..candidates.1 as usize {
            let (i, bits) = self.arena[k];
            let word = i as usize;
            let bits = bits & might[word].load(Relaxed) & front[word] & !self.seen[word];
            if bits != 0 {
                count += bits.count_ones();
                self.arena.push((i, bits));
            }
        }
        if count <= FEW {
            self.keep_reachable(start);
        }
        (start as u32, self.arena.len() as u32)
    }

    /// Drops candidates of the latest list that lie outside all lines of the sequence.
    fn keep_reachable(&mut self, start: usize) {
        let mut kept = start;
        for k in start..self.arena.len() {
            let (i, bits) = self.arena[k];
            let reachable = ones(bits)
                .filter(|&b| self.stabber.may_meet(&self.shared.network.bounds[i as usize * 64 + b]))
                .fold(0u64, |w, b| w | 1 << b);
            if reachable != 0 {
                self.arena[kept] = (i, reachable);
                kept += 1;
            }
        }
        self.arena.truncate(kept);
    }
}
