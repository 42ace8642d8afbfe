//! Which boxes of a graph in space see each other, and which objects: from pairs of groups to pairs of cells.
//!
//! This search does not follow sequences of portals: in open space that is cut into many cells there are too many. What
//! matters is what lies *between* two boxes ([`Shaft`]), first for large groups of cells, then for their halves, until
//! a wall hides one group from the other or single cells are left. Lines found on the way are followed through all
//! cells that they pass, all of which see each other.
//!
//! A group is tested with the bounding box of its cells: if nothing of its box is visible, none of its cells is;
//! otherwise nothing follows, and its halves are tested. Single cells are decided exactly, except for [`slivers`]. So
//! the answer depends neither on how cells are grouped nor on the order of work.
//!
//! In a tower, groups are not enough: stairs join each storey with each other. What is far is decided for many
//! pairs at once, by [`columns`] and [`horizons`].

mod atomic_bits;
mod columns;
mod explain;
mod first_true;
mod from_boxes;
mod horizons;
mod kept;
mod limited;
mod live;
mod objects;
mod opaque;
mod pairs;
mod slivers;
mod witness_log;

pub use explain::{AxialExplainer, AxialExplanation, AxialPath, AxialProof, explain_axial};
pub use from_boxes::{BoxVisibility, PairMask, box_visibility};
pub use live::{AxialUpdate, LiveAxial};

use crate::search::SearchOptions;
pub(crate) use atomic_bits::AtomicBitMatrix;
use columns::Columns;
use horizons::Horizons;
use opaque::blockers_of;
pub(crate) use opaque::opaque_without_solid;
use pairs::Pair;
pub(crate) use pairs::halves_first;
use rayon::prelude::*;
use sightlines_cells::{Axial, CellGraph};
use sightlines_geometry::BoxTree;
use sightlines_geometry::{Aabb, OneWayRectangle};
use sightlines_progress::{Allowance, Counter, Halt, Units, Work, scattered};
use sightlines_pvs::BitMatrix;
use sightlines_sightline::Shaft;
use sightlines_sightline::{Blockers, ShaftCounters};
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use witness_log::{WitnessLog, Worker};

/// The answer for a graph in space.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AxialVisibility {
    /// Cells by cells: symmetric, with the diagonal set.
    pub cells: BitMatrix,
    /// Cells by objects.
    pub objects: BitMatrix,
    /// For each cell the objects whose closed boxes touch it, ascending.
    pub touching: Vec<Vec<u32>>,
    /// Number of opaque rectangles that the walls were merged into.
    pub n_blockers: usize,
    /// Pairs of a cell and a cell or object that count as visible because deciding them would take too much effort, or
    /// more digits than two doubles have. Like `counters`, it varies with threads, as a line for another pair may prove
    /// such a pair visible first.
    pub n_assumed: u64,
    /// The visible pairs that were not decided because the budget was spent; none if all were. Cells that are too thin to be decided
    /// have those of their neighbours.
    pub left: Option<PairMask>,
    /// The work done. With several threads the counts vary from run to run; the answer does not.
    pub counters: ShaftCounters,
}

/// The undecided pairs. All others are already visible or hidden.
#[derive(Debug)]
struct PairsInDoubt {
    /// Places by places.
    cells: AtomicBitMatrix,
    /// Objects by places.
    objects: AtomicBitMatrix,
    /// Places in doubt about some object that is not new.
    rows: Vec<bool>,
    /// New objects, each with the places that it is within reach of.
    near_new: Vec<(u32, usize)>,
}

/// What all threads share. Places number the cells in the order of the tree.
struct AxialSearch<'a> {
    graph: &'a CellGraph<Axial>,
    boxes: &'a [Aabb<3>],
    blockers: &'a Blockers,
    tree: BoxTree<3>,
    object_tree: BoxTree<3>,
    /// The cells that are not slivers, which the tree contains.
    regular: Vec<u32>,
    /// The cell at each place of the tree.
    cell_at: Vec<u32>,
    /// The place of each cell; [`SLIVER`] for slivers.
    place: Vec<u32>,
    touching: Vec<Vec<u32>>,
    /// For each cell the objects that a line may reach in it or in a sliver behind it.
    within_reach: Vec<Vec<u32>>,
    /// For each cell the objects that contain it.
    around: Vec<Vec<u32>>,
    /// The places of cells that lie in some object.
    inner: Vec<usize>,
    /// For each cell, its connected component through portals, given by the least cell in it.
    component: Vec<u32>,
    /// Places by places.
    cells: AtomicBitMatrix,
    /// Objects by places: which places see the object.
    objects: AtomicBitMatrix,
    /// Objects by places: which places may see the object.
    maybe: AtomicBitMatrix,
    /// The only pairs to decide; `None` for all pairs.
    doubt: Option<PairsInDoubt>,
    /// What is decided for several cells in a row; none for a search that keeps its lines, or decides few pairs.
    columns: Columns,
    /// The same for groups; none likewise.
    horizons: Horizons,
    /// What was not decided because the budget was spent: places by places, and objects by places.
    left: Option<[AtomicBitMatrix; 2]>,
    /// Whether lines are kept for later.
    logging: bool,
    n_assumed: AtomicU64,
}

/// For each cell the least cell in its connected component.
fn components(graph: &CellGraph<Axial>) -> Vec<u32> {
    let mut of = vec![u32::MAX; graph.n_cells()];
    for first in graph.cell_ids() {
        let mut stack = vec![first];
        while let Some(cell) = stack.pop() {
            if of[cell.idx()] == u32::MAX {
                of[cell.idx()] = first.0;
                stack.extend(graph.exits(cell).iter().map(|exit| exit.to));
            }
        }
    }
    of
}

/// The share of a budget that pairs of cells may spend; the rest is for objects. About what they take.
const PAIRS: f64 = 0.6;

/// The index of a cell that is too thin to be decided.
const SLIVER: u32 = u32::MAX;

/// Pairs of groups are halved on one thread until there are this many for each thread.
const TASKS_PER_THREAD: usize = 256;

/// If results are kept, there are two tasks for each cell, between these bounds. A task is what is lost when a bake is stopped, and the least
/// that a process takes.
const KEPT_TASKS: [usize; 2] = [64, 1 << 16];

/// The same for a search that decides few pairs.
const FEW_TASKS_PER_THREAD: usize = 16;

/// Finds which cells of a graph see each other, and which objects they see.
///
/// * `solid`: boxes beside the cells that no line from a cell enters; they make walls larger, which saves much work,
///   and affect the answer only in that fewer pairs are assumed visible.
/// * `fronts`: rectangles that hide from one side. They count where they lie in portals: what reaches into cells hides nothing. Two cells see
///   each other if either sees the other.
/// * `objects`: closed boxes, in scene units. A cell sees those that touch it, and those that an open set of lines from
///   inside the cell reaches before meeting a wall. Flat boxes can be seen; boxes that are flat along two axes are seen
///   only where they touch. Empty ones are never seen.
///
/// Exact, unless a pair takes thousands of linear programs, or more digits than two doubles have: such pairs count as visible, and are counted
/// in [`AxialVisibility::n_assumed`].
///
/// Cost: near-linear in the number of cells in practice, as long as each sees only nearby cells; visible pairs cost a
/// few bits each. Memory: two bit matrices.
///
/// # Errors
/// [`Halt`] by the observer, or by the store of units.
pub fn axial_visibility(
    graph: &CellGraph<Axial>,
    solid: &[Aabb<3>],
    fronts: &[OneWayRectangle],
    objects: &[Aabb<3>],
    options: &SearchOptions<'_>,
) -> Result<AxialVisibility, Halt> {
    on_threads(options.threads, |threads| {
        let blockers = blockers_of(graph, solid, fronts);
        let mut search = AxialSearch::new(graph, objects, &blockers);
        search.use_columns();
        if options.budget.is_limited() {
            search.expect_to_leave_pairs();
        }
        let (counters, _) = search.answer(threads, options)?;
        Ok(search.into_seen(counters))
    })
}

/// Runs something on this many threads and passes their number; 0 uses one for each core. Whoever is on so many already stays there.
pub(crate) fn on_threads<T: Send>(threads: usize, run: impl FnOnce(usize) -> T + Send) -> T {
    let threads = sightlines_progress::memory::n_threads(threads);
    if rayon::current_thread_index().is_some() && rayon::current_num_threads() == threads {
        return run(threads);
    }
    match rayon::ThreadPoolBuilder::new().num_threads(threads).build() {
        Ok(pool) => pool.install(|| run(threads)),
        // No threads could be created: the existing ones are used.
        Err(_) => run(threads),
    }
}

impl<'a> AxialSearch<'a> {
    fn new(graph: &'a CellGraph<Axial>, boxes: &'a [Aabb<3>], blockers: &'a Blockers) -> Self {
        let extents: Vec<Aabb<3>> = graph.cells().iter().map(|c| c.bounds).collect();
        let slivers = slivers::find(&extents);
        let regular: Vec<u32> = (0u32..).zip(&slivers).filter(|(_, sliver)| !**sliver).map(|(cell, _)| cell).collect();
        let boxes_of: Vec<Aabb<3>> = regular.iter().map(|&cell| extents[cell as usize]).collect();
        let (tree, object_tree) = rayon::join(|| BoxTree::build(&boxes_of, 1), || BoxTree::build(boxes, 2));
        let cell_at: Vec<u32> = tree.order().iter().map(|&i| regular[i as usize]).collect();
        let mut place = vec![SLIVER; extents.len()];
        for (at, &cell) in (0u32..).zip(&cell_at) {
            place[cell as usize] = at;
        }
        let touching = extents.par_iter().map(|cell| {
            let mut found = Vec::new();
            object_tree.visit(
                |b| objects::touch(b, cell),
                |o| {
                    if objects::touch(&boxes[o as usize], cell) {
                        found.push(o);
                    }
                },
            );
            found.sort_unstable();
            found
        });
        let touching: Vec<Vec<u32>> = touching.collect();
        let within_reach = slivers::within_reach(graph, &slivers, &touching);
        let lies_in = |(cell, near): (&Aabb<3>, &Vec<u32>)| -> Vec<u32> {
            near.iter().copied().filter(|&o| objects::within(cell, &boxes[o as usize])).collect()
        };
        let around: Vec<Vec<u32>> = extents.iter().zip(&within_reach).map(lies_in).collect();
        let inner = (0..cell_at.len()).filter(|&at| !around[cell_at[at] as usize].is_empty()).collect();
        let cells = AtomicBitMatrix::new(cell_at.len(), cell_at.len());
        for at in 0..cell_at.len() {
            cells.set(at, at);
        }
        let [objects, maybe] = [(); 2].map(|()| AtomicBitMatrix::new(boxes.len(), cell_at.len()));
        Self {
            graph,
            boxes,
            blockers,
            tree,
            object_tree,
            regular,
            cell_at,
            place,
            touching,
            within_reach,
            around,
            inner,
            component: components(graph),
            cells,
            objects,
            maybe,
            doubt: None,
            columns: Columns::default(),
            horizons: Horizons::default(),
            left: None,
            logging: false,
            n_assumed: AtomicU64::new(0),
        }
    }

    fn may_see_cell(&self, a: usize, b: usize) -> bool {
        let cell = |place: usize| self.cell_at[place] as usize;
        self.component[cell(a)] == self.component[cell(b)]
    }

    fn may_see_object(&self, place: usize, object: usize) -> bool {
        self.doubt.as_ref().is_none_or(|doubt| doubt.objects.get(object, place))
    }

    fn worker(&self) -> Worker<'a> {
        Worker { shaft: Shaft::new(self.blockers), log: self.logging.then(WitnessLog::default) }
    }

    /// Decides all requested pairs; returns the effort, and the log of lines.
    fn answer(&self, threads: usize, options: &SearchOptions<'_>) -> Result<(ShaftCounters, WitnessLog), Halt> {
        let n = self.cell_at.len();
        // Who keeps lines for later has room for no pairs that are left.
        let budget = if self.left.is_some() { options.budget } else { Allowance::default() };
        if n == 0 {
            return Ok((ShaftCounters::default(), WitnessLog::default()));
        }
        // A result of a group says nothing of what was left, of lines, or of pairs that were not asked for.
        let are_all_decided = self.left.is_none() && !self.logging && self.doubt.is_none();
        let units = if are_all_decided { options.units } else { Units::default() };
        let mut first = self.worker();
        let mut tasks = vec![[0, 0]];
        let per_thread = if self.doubt.is_some() { FEW_TASKS_PER_THREAD } else { TASKS_PER_THREAD };
        // What is kept must not depend on the number of threads.
        let n_tasks = if units.are_kept() { (2 * n).clamp(KEPT_TASKS[0], KEPT_TASKS[1]) } else { per_thread * threads };
        while tasks.len() < n_tasks && !budget.is_over() {
            let mut smaller = Vec::new();
            tasks.iter().for_each(|&pair| self.settle(pair, &mut first, &mut |p| smaller.push(p)));
            tasks = smaller;
            if tasks.is_empty() {
                break;
            }
        }
        let tasks: Vec<Pair> = scattered(tasks.len()).map(|i| tasks[i]).collect();
        let n_units = tasks.len() + self.boxes.len();
        let counter = Counter::new(options.progress, "pairs and objects", n_units).of(Work::Deciding);
        let pairs = self.settle_pairs(tasks, threads, budget.part(PAIRS), &counter, units)?;
        let survey = (0..n).into_par_iter().map(|place| {
            let mut log = self.logging.then(WitnessLog::default);
            self.survey_objects(place, log.as_mut());
            (ShaftCounters::default(), log.unwrap_or_default())
        });
        let survey: Vec<(ShaftCounters, WitnessLog)> = survey.collect();
        let objects = self.settle_objects(threads, budget, &counter, units)?;
        let mut all = (first.shaft.counters(), first.take_log());
        for (counters, log) in pairs.into_iter().chain(survey).chain(objects) {
            all.0 = all.0 + counters;
            all.1.append(log);
        }
        Ok(all)
    }

    fn into_seen(self, counters: ShaftCounters) -> AxialVisibility {
        let n = self.graph.n_cells();
        let n_assumed = self.n_assumed.load(Relaxed);
        let left = self.left_pairs();
        let Self {
            graph, boxes, blockers, cell_at, place, touching, cells: by_place, objects: by_object, maybe, ..
        } = self;
        // What is not needed any more is dropped at once: these matrices are most of the memory.
        drop(maybe);
        let mut cells = BitMatrix::identity(n);
        for (place, &cell) in cell_at.iter().enumerate() {
            for other in by_place.ones(place) {
                cells.set(cell as usize, cell_at[other] as usize, true);
            }
        }
        drop(by_place);
        let mut objects = BitMatrix::new(n, boxes.len());
        for object in 0..boxes.len() {
            for place in by_object.ones(object) {
                objects.set(cell_at[place] as usize, object, true);
            }
        }
        drop(by_object);
        slivers::fill(graph, |cell| place[cell] == SLIVER, &touching, &mut cells, &mut objects);
        AxialVisibility { cells, objects, touching, n_blockers: blockers.len(), n_assumed, left, counters }
    }
}
