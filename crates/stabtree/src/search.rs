//! Which zones see each other: a depth-first search from every zone, pruned by what is already known.
//!
//! From each exit of a zone the search follows every sequence of portals that the stabber finds passable. The zones it
//! enters are visible. A branch carries its *candidates*, the zones that it may still reach and that are not decided
//! yet, and ends when there are none. A candidate is dropped
//!
//! * when it has been seen from the source;
//! * when the branch enters a finished zone that does not see it: whatever a line sees after passing a zone is visible
//!   from that zone (by symmetry a finished zone counts for both directions);
//! * when its bounds lie behind a portal of the branch, or outside all lines of the branch.
//!
//! Each rule removes only zones that no line of the branch reaches, so the answer is exact for every order of the
//! sources; the order, and zones known beforehand to be visible, only save work. For the same reason threads may share
//! their findings without affecting the result.
//!
//! Source: Teller and Séquin, SIGGRAPH 1991, section 4, for the search; the candidate sets are in the
//! spirit of the "might see" vectors of Quake's vis, made exact and symmetric.

use crate::network::{NO_ZONE, Network, Step};
use sightlines_progress::{Allowance, Cancelled, Counter, Observer, Units};
use sightlines_pvs::BitMatrix;
use sightlines_sightline::Stabber;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering::Relaxed};

/// Options of a search. None of them but a budget affects the answer.
#[derive(Clone, Copy)]
pub struct SearchOptions<'a> {
    /// Number of threads; 0 for one per core.
    pub threads: usize,
    /// Chords shot through each exit before the search.
    pub chords: u32,
    /// Receives a report for each finished unit (zone, box, or group of pairs and object), and may cancel the search.
    pub progress: Option<&'a dyn Observer>,
    /// Searches in space: what may be spent. Pairs that are not decided then count as visible, and are listed; without a limit the
    /// answer is always the same. Other searches ignore it.
    pub budget: Allowance<'a>,
    /// Searches in space, without a budget: where results of groups of pairs are kept. Others ignore it.
    pub units: Units<'a>,
}

impl Default for SearchOptions<'_> {
    fn default() -> Self {
        Self { threads: 0, chords: 8, progress: None, budget: Allowance::default(), units: Units::default() }
    }
}

impl std::fmt::Debug for SearchOptions<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SearchOptions").field("threads", &self.threads).field("chords", &self.chords).finish()
    }
}

/// The work of a search. With several threads the counts vary from run to run; the answer does not.
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

/// The answer of a search.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ZoneVisibility {
    /// Zones by zones: symmetric, with the diagonal set.
    pub zones: BitMatrix,
    /// Zones by objects: which objects are seen from which zones.
    pub objects: BitMatrix,
    /// The work done.
    pub summary: SearchSummary,
}

/// Finds which zones see each other, and which objects.
///
/// * `network`: cells, exits, zones, objects.
/// * `stabber`: cloned for each thread; its state does not matter.
/// * `known`: zones by zones, pairs known to see each other, at least the diagonal: a symmetric subset of the answer. It
///   affects only the cost; [`BitMatrix::identity`] if nothing is known.
///
/// Exact if the stabber is. Cost: output-sensitive in practice and exponential in the worst case, as for every
/// search over portal sequences; memory is a few bit matrices.
///
/// # Errors
/// [`Cancelled`] by the observer.
///
/// # Panics
/// If `known` has the wrong size.
pub fn visible_zones<S>(
    network: &Network<S::Portal, S::Bounds>,
    stabber: &S,
    known: &BitMatrix,
    options: &SearchOptions<'_>,
) -> Result<ZoneVisibility, Cancelled>
where
    S: Stabber,
    S::Portal: Sync,
    S::Bounds: Sync,
{
    let n = network.n_zones();
    assert!(known.n_rows() == n && known.n_cols() == n, "the known pairs are pairs of the network's zones");
    let mut order: Vec<u32> = (0..n as u32).collect();
    // Zones that see little are finished quickly and then prune the searches of those that see much.
    order.sort_by_key(|&z| (known.count_row(z as usize), z));
    let shared = Shared::new(network, stabber, known);
    let counter = Counter::new(options.progress, "zones", n);
    let work = |stabber: S| {
        let mut worker = Worker::new(&shared, stabber);
        while let Some(&zone) = order.get(shared.next.fetch_add(1, Relaxed)) {
            worker.finish(zone);
            if counter.step().is_err() {
                break;
            }
        }
        worker.summary
    };
    let threads = sightlines_progress::memory::n_threads(options.threads);
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
    counter.check()?;
    let (zones, objects) = shared.into_matrices();
    Ok(ZoneVisibility { zones, objects, summary })
}

/// A row of ones, with the bits past the last one clear.
fn all_ones(n: usize) -> impl Iterator<Item = u64> {
    let width = n.div_ceil(64);
    (0..width).map(move |i| if i + 1 == width { u64::MAX >> (n.wrapping_neg() % 64) } else { u64::MAX })
}

/// The places of the ones of a word, ascending.
pub(crate) fn ones(mut word: u64) -> impl Iterator<Item = usize> {
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
        let width = network.row_width();
        let mut front = Self { row_of: vec![0; network.steps.len()], rows: vec![u64::MAX; width] };
        let n_rows: usize = network.sources.iter().map(Vec::len).sum();
        if (n_rows + 1) * width > MAX_FRONT_WORDS {
            return front;
        }
        for &exit in network.sources.iter().flatten() {
            let portal = &network.steps[exit as usize].portal;
            front.row_of[exit as usize] = (front.rows.len() / width) as u32;
            let word = |chunk: &[S::Bounds]| {
                let bit = |(i, b)| u64::from(stabber.in_front(portal, b)) << i;
                chunk.iter().enumerate().map(bit).fold(0, |w, b| w | b)
            };
            front.rows.extend(network.bounds.chunks(64).chain(network.objects.bounds.chunks(64)).map(word));
        }
        front
    }
}

/// What all threads share. Rows have a bit for each zone and, from the next whole word on, one for each object.
struct Shared<'a, P, B> {
    network: &'a Network<P, B>,
    /// Words of a row.
    width: usize,
    /// Words of the zone part of a row.
    zone_width: usize,
    front: Front,
    /// Zones and objects found visible.
    seen: Vec<AtomicU64>,
    /// Zones and objects not yet proven hidden.
    might: Vec<AtomicU64>,
    next: AtomicUsize,
}

impl<'a, P: Clone, B> Shared<'a, P, B> {
    fn new<S>(network: &'a Network<P, B>, stabber: &S, known: &BitMatrix) -> Self
    where
        S: Stabber<Portal = P, Bounds = B>,
    {
        let (n, n_objects) = (network.n_zones(), network.n_objects());
        let (width, zone_width) = (network.row_width(), n.div_ceil(64));
        let (mut seen, mut might) = (Vec::with_capacity(n * width), Vec::with_capacity(n * width));
        for zone in 0..n {
            seen.extend(known.row(zone).iter().map(|&w| AtomicU64::new(w)));
            seen.extend((zone_width..width).map(|_| AtomicU64::new(0)));
            might.extend(all_ones(n).chain(all_ones(n_objects)).map(AtomicU64::new));
        }
        let front = Front::build(network, stabber);
        Self { network, width, zone_width, front, seen, might, next: AtomicUsize::new(0) }
    }

    fn into_matrices(self) -> (BitMatrix, BitMatrix) {
        let n = self.network.n_zones();
        let mut zones = BitMatrix::new(n, n);
        let mut objects = BitMatrix::new(n, self.network.n_objects());
        for (zone, row) in self.seen.chunks(self.width.max(1)).enumerate() {
            let (of_zones, of_objects) = row.split_at(self.zone_width);
            for (to, from) in zones.row_mut(zone).iter_mut().zip(of_zones) {
                *to = from.load(Relaxed);
            }
            for (to, from) in objects.row_mut(zone).iter_mut().zip(of_objects) {
                *to = from.load(Relaxed);
            }
        }
        (zones, objects)
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
    /// The row of the source so far.
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
        for &object in &self.shared.network.objects.of_zone[zone as usize] {
            self.mark_object(object);
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
            if i >= self.shared.zone_width {
                continue;
            }
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
        self.stabber.start(step.portal.clone());
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
            if let Some(undo) = self.stabber.push(step.portal.clone()) {
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

    /// Enters the cell behind `exit`: marks its zone, and continues if that can reveal anything new.
    fn enter(&mut self, exit: u32, from_zone: u32, candidates: (u32, u32), undo: Option<S::Undo>) -> bool {
        let step = &self.shared.network.steps[exit as usize];
        self.summary.n_visits += 1;
        self.look_around(step.to);
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

    /// Marks the objects in a cell that lines of the sequence meet.
    fn look_around(&mut self, cell: u32) {
        let network = self.shared.network;
        for (object, part) in network.objects.in_cell(cell) {
            let (word, bit) = self.object_bit(*object);
            if self.seen[word] & bit == 0 && self.stabber.meets(part) {
                self.seen[word] |= bit;
            }
        }
    }

    fn object_bit(&self, object: u32) -> (usize, u64) {
        (self.shared.zone_width + object as usize / 64, 1 << (object % 64))
    }

    fn mark_object(&mut self, object: u32) {
        let (word, bit) = self.object_bit(object);
        self.seen[word] |= bit;
    }

    /// The candidates that remain after crossing `exit` into `zone`, as a new list; nothing is added to the arena if
    /// none remain.
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
                .filter(|&b| self.stabber.may_meet(self.shared.network.target(self.shared.zone_width, i as usize, b)))
                .fold(0u64, |w, b| w | 1 << b);
            if reachable != 0 {
                self.arena[kept] = (i, reachable);
                kept += 1;
            }
        }
        self.arena.truncate(kept);
    }
}
