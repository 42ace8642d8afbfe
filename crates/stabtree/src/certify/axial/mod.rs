//! Proofs of tables of scenes in space: lines for what is visible, pairs of boxes for what is hidden.

mod lines;
mod terms;

use super::{CertifyError, CertifyOptions, OF, PHASE, through};
use crate::axial::{AtomicBitMatrix, halves_first, on_threads, opaque_without_solid};
use rayon::prelude::*;
use sightlines_cells::{Axial, CellGraph};
use sightlines_certificates::ObjectPairs;
use sightlines_certificates::axial::{
    AxialMaker, AxialNetwork, AxialNetworkError, AxialPortal, AxialProofs, Box3, CheckedProof,
};
use sightlines_geometry::{Aabb, BoxTree};
use sightlines_progress::{Counter, Halt, Phase};
use sightlines_pvs::{BitMatrix, ObjectId};
use sightlines_sightline::{BlockedProof, Blockers, BoxTarget, Shaft};
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use terms::translated;

/// The phase of objects.
const OBJECTS: &str = "object-proofs";

/// The phase of lines.
const LINES: &str = "line-proofs";

/// Linear programs spent on a pair of groups; one that takes more is halved.
const GROUP_BUDGET: u32 = 64;

/// Linear programs spent on a pair of single cells that is hidden: as many as the search spends.
const CELL_BUDGET: u64 = 2000;

/// Which cells see which objects.
#[derive(Debug, Clone, Copy)]
pub struct ObjectRows<'a> {
    /// A box around each object, in scene units.
    pub boxes: &'a [Aabb<3>],
    /// For each cell the objects that it sees.
    pub seen: &'a [Vec<ObjectId>],
}

/// Proves the visibility in `rows` for the cells of `graph` (symmetric, with the diagonal set), and that the objects that a cell does not
/// see are hidden from it. Pairs without a proof, because they are wrong, only assumed visible, or joined only by
/// lines that doubles do not hold, are left open. What hides from one side only is no wall of a graph: rows that rest on it are
/// contradicted by lines.
///
/// Cost: several times that of the search for the rows: each contradiction is converted to integers, and each visible
/// pair needs a line, its own or a shared one.
///
/// # Errors
/// [`CertifyError`] with a [`AxialNetworkError`] for a graph that is not well formed; or if the observer or the store of units ends
/// the work.
///
/// # Panics
/// If there is not a row for each cell, or not a list of objects, or an object in a list that has no box.
pub fn certify_axial(
    graph: &CellGraph<Axial>,
    rows: &BitMatrix,
    objects: Option<ObjectRows<'_>>,
    options: &CertifyOptions<'_>,
) -> Result<AxialProofs, CertifyError<AxialNetworkError>> {
    assert!(rows.n_rows() == graph.n_cells() && rows.n_cols() == graph.n_cells(), "a row for each cell");
    assert!(objects.is_none_or(|objects| objects.seen.len() == graph.n_cells()), "a list for each cell");
    let mut network = axial_network(graph).map_err(CertifyError::Network)?;
    if let Some(objects) = objects {
        network = network.with_objects(&objects.boxes.iter().map(corners).collect::<Vec<_>>());
    }
    let blockers = Blockers::new(opaque_without_solid(graph));
    let rectangles: Vec<Box3> = blockers.rectangles().iter().map(corners).collect();
    let maker = AxialMaker::new(&network, &rectangles);
    if graph.n_cells() == 0 {
        return Ok(maker.finish());
    }
    let search = Search::new(graph, rows, objects, &blockers, options);
    Ok(search.run(maker, &network, options)?)
}

/// The graph in the form that proofs use.
///
/// # Errors
/// [`AxialNetworkError`] for a graph that is not well formed.
pub fn axial_network(graph: &CellGraph<Axial>) -> Result<AxialNetwork, AxialNetworkError> {
    let cells: Vec<Box3> = graph.cells().iter().map(|cell| corners(&cell.bounds)).collect();
    let portals: Vec<AxialPortal> = graph
        .portals()
        .iter()
        .map(|p| AxialPortal {
            cells: p.cells.map(|cell| cell.0),
            extent: corners(&p.shape.extent),
            axis: p.shape.axis,
            forward: p.shape.forward,
        })
        .collect();
    AxialNetwork::new(&cells, &portals)
}

fn corners(b: &Aabb<3>) -> Box3 {
    [b.min, b.max]
}

/// The search for proofs, from pairs of groups to pairs of cells.
struct Search<'a> {
    graph: &'a CellGraph<Axial>,
    blockers: &'a Blockers,
    tree: BoxTree<3>,
    /// The cell at each position of the tree.
    cell_at: Vec<u32>,
    /// Positions by positions: which see each other.
    sees: AtomicBitMatrix,
    /// The boxes of objects.
    objects: &'a [Aabb<3>],
    /// Objects by positions: which are seen from where.
    seen_from: AtomicBitMatrix,
    /// Linear programs for a hidden pair of cells, and for a visible one.
    budgets: [u32; 2],
}

/// Two nodes of the tree of cells.
type Pair = [u32; 2];

/// What goes through a phase.
#[derive(Clone, Copy)]
struct Through<'o> {
    options: &'o CertifyOptions<'o>,
    counter: &'o Counter<'o>,
    /// Of a unit in what is counted.
    share: f64,
}

/// Pairs of groups are halved until there are this many. Independent of the number of threads.
const N_TASKS: usize = 2048;

/// A pair of groups is large if it has at least one in the square of this of all pairs.
const LARGE: f64 = 24.0;

impl<'a> Search<'a> {
    fn new(
        graph: &'a CellGraph<Axial>,
        rows: &BitMatrix,
        objects: Option<ObjectRows<'a>>,
        blockers: &'a Blockers,
        options: &CertifyOptions<'_>,
    ) -> Self {
        let boxes: Vec<Aabb<3>> = graph.cells().iter().map(|cell| cell.bounds).collect();
        let tree = BoxTree::build(&boxes, 1);
        let cell_at = tree.order().to_vec();
        let mut place = vec![0; cell_at.len()];
        cell_at.iter().enumerate().for_each(|(at, &cell)| place[cell as usize] = at);
        let sees = AtomicBitMatrix::new(cell_at.len(), cell_at.len());
        for (row, &cell) in cell_at.iter().enumerate() {
            for other in rows.iter_ones(cell as usize) {
                sees.set(row, place[other]);
            }
        }
        let boxes = objects.map_or(&[][..], |objects| objects.boxes);
        let seen_from = AtomicBitMatrix::new(boxes.len(), cell_at.len());
        for (cell, seen) in objects.iter().flat_map(|objects| objects.seen.iter().enumerate()) {
            seen.iter().for_each(|object| {
                seen_from.set(object.idx(), place[cell]);
            });
        }
        let budgets = [CELL_BUDGET, lines::BUDGET].map(|budget| budget.min(options.most_steps) as u32);
        Self { graph, blockers, tree, cell_at, sees, objects: boxes, seen_from, budgets }
    }

    fn run(
        &self,
        mut maker: AxialMaker<'_>,
        network: &AxialNetwork,
        options: &CertifyOptions<'_>,
    ) -> Result<AxialProofs, Halt> {
        let (tasks, first) = self.divided(&maker);
        let n_objects = self.objects.len();
        // Groups are hidden from each other, then lines are sought from each cell.
        let n = tasks.len() + n_objects + self.cell_at.len();
        let counter = Counter::new(options.progress, "proofs", n);
        let pass = Through { options, counter: &counter, share: 1.0 / n as f64 };
        // Half of the effort is for objects, if there are any.
        let halves = if self.objects.is_empty() { 1 } else { 2 };
        let share = |n: usize| options.most_steps_in_all / halves / n.max(1) as u64;

        let costs: Vec<f64> = tasks.iter().map(|pair| self.cost_of(*pair)).collect();
        let found = self.in_units(PHASE, &costs, &maker, pass, |shaft, unit| {
            self.hide_below(tasks[unit], shaft, &maker, share(tasks.len()), &|| counter.is_cancelled())
        })?;
        for proof in first.into_iter().chain(found) {
            maker.take(proof);
        }
        maker.add_out_of_reach();

        let open = self.open_objects(maker.hidden_objects());
        let costs: Vec<f64> = (0..n_objects).map(|object| 1.0 + open.ones(object).count() as f64).collect();
        let found = self.in_units(OBJECTS, &costs, &maker, pass, |shaft, object| {
            let is_cancelled = || counter.is_cancelled();
            self.hide_object(object as u32, &open, shaft, &maker, share(n_objects), &is_cancelled)
        })?;
        for proof in found {
            maker.take(proof);
        }
        let hidden = maker.finish();

        let shots = lines::shots(self.graph, options.chords);
        let start = || lines::LineSteps::new(self, &shots, network);
        let n_steps = [shots.len(), self.cell_at.len(), 0];
        let found = through(LINES, n_steps, (&counter, pass.share), options.units, start)?;
        Ok(AxialProofs { lines: found.finish().lines, ..hidden })
    }

    /// Halves pairs of groups until there are many, or none of which some cells see each other. Only the largest ones are tried to be proven
    /// hidden here, as they would be long tasks if that fails. Returns tasks, and proofs.
    fn divided<'m>(&self, maker: &AxialMaker<'m>) -> (Vec<Pair>, Vec<CheckedProof<'m>>) {
        let (mut next, mut tasks, mut found) = (vec![[0u32, 0u32]], Vec::new(), Vec::new());
        let mut shaft = Shaft::new(self.blockers);
        while !next.is_empty() && next.len() + tasks.len() < N_TASKS {
            let mut smaller = Vec::new();
            for pair in next {
                let is_large = self.cost_of(pair) * LARGE > self.cell_at.len() as f64;
                if self.is_hidden(pair) && !is_large {
                    tasks.push(pair);
                } else {
                    self.hide(pair, &mut shaft, maker, &mut found, &mut smaller);
                }
            }
            next = smaller;
        }
        tasks.append(&mut next);
        (tasks, found)
    }

    /// The places of two groups.
    fn places(&self, pair: Pair) -> [[usize; 2]; 2] {
        pair.map(|node| &self.tree.nodes()[node as usize]).map(|node| [node.start as usize, node.end as usize])
    }

    /// Whether no cell of one group sees one of another.
    fn is_hidden(&self, pair: Pair) -> bool {
        let [rows, cols] = self.places(pair);
        pair[0] != pair[1] && !self.sees.any(rows, cols)
    }

    /// Pairs of smaller groups, unless all cells of two groups see each other or the groups are single cells.
    fn halve(&self, [a, b]: Pair, smaller: &mut Vec<Pair>) {
        let is_leaf = |node: u32| self.tree.nodes()[node as usize].is_leaf();
        let [rows, cols] = self.places([a, b]);
        if a == b {
            if !is_leaf(a) {
                let [left, right] = self.tree.children(a);
                smaller.extend([[left, left], [left, right], [right, right]]);
            }
            return;
        }
        if self.sees.all(rows, cols) || (is_leaf(a) && is_leaf(b)) {
            return;
        }
        if halves_first(&self.tree, [a, b]) {
            smaller.extend(self.tree.children(a).map(|a| [a, b]));
        } else {
            smaller.extend(self.tree.children(b).map(|b| [a, b]));
        }
    }

    /// The predicted cost of a pair of groups: in proportion to its pairs of cells, most of which are decided together.
    fn cost_of(&self, pair: Pair) -> f64 {
        let n = self.places(pair).map(|[start, end]| (end - start) as f64);
        (n[0] * n[1]).sqrt()
    }

    /// Proofs of all units of a phase, which do not depend on each other.
    fn in_units<'m>(
        &self,
        phase: &'static str,
        costs: &[f64],
        maker: &AxialMaker<'m>,
        Through { options, counter, share }: Through<'_>,
        find: impl Fn(&mut Shaft<'a>, usize) -> Vec<CheckedProof<'m>> + Sync,
    ) -> Result<Vec<CheckedProof<'m>>, Halt> {
        let units = options.units;
        // A worker may go through the phase several times.
        let counted: Vec<AtomicBool> = costs.iter().map(|_| AtomicBool::new(false)).collect();
        let work = |shaft: &mut Shaft<'a>, unit: usize| {
            counter.check()?;
            let compute = || {
                let all = find(shaft, unit);
                // Whoever was cancelled has found a part.
                counter.check()?;
                Ok::<_, Halt>(all)
            };
            let read = |bytes: &[u8]| if units.has_all(phase) { maker.check_bytes(bytes) } else { Some(Vec::new()) };
            let (found, is_kept) =
                units.value((phase, unit, OF), compute, |all| CheckedProof::all_to_bytes(all), read)?;
            match (units.are_kept(), counted[unit].swap(true, Relaxed)) {
                (_, true) => counter.check()?,
                (true, false) => counter.step_by(share, is_kept)?,
                (false, false) => counter.step()?,
            }
            Ok((unit, found.unwrap_or_default()))
        };
        units.through(&Phase::new(phase, costs), || {
            let order = units.in_order(phase, 0..costs.len());
            let mut all: Vec<(usize, Vec<CheckedProof<'m>>)> = on_threads(options.threads, |_| {
                let order = order.into_par_iter().with_max_len(1);
                order.map_init(|| Shaft::new(self.blockers), work).collect::<Result<_, Halt>>()
            })?;
            all.sort_by_key(|(unit, _)| *unit);
            Ok(all.into_iter().flat_map(|(_, found)| found).collect())
        })
    }

    /// Proves that two groups are hidden from each other, or else smaller groups of them.
    fn hide_below<'m>(
        &self,
        task: Pair,
        shaft: &mut Shaft<'a>,
        maker: &AxialMaker<'m>,
        share: u64,
        is_cancelled: &dyn Fn() -> bool,
    ) -> Vec<CheckedProof<'m>> {
        let (mut found, mut stack) = (Vec::new(), vec![task]);
        let before = shaft.counters().n_programs;
        while let Some(pair) = stack.pop() {
            if is_cancelled() || shaft.counters().n_programs - before >= share {
                break;
            }
            self.hide(pair, shaft, maker, &mut found, &mut stack);
        }
        found
    }

    /// Proves that two groups are hidden from each other, or passes on smaller pairs.
    fn hide<'m>(
        &self,
        [a, b]: Pair,
        shaft: &mut Shaft<'a>,
        maker: &AxialMaker<'m>,
        found: &mut Vec<CheckedProof<'m>>,
        smaller: &mut Vec<Pair>,
    ) {
        if self.is_hidden([a, b]) {
            let (na, nb) = (&self.tree.nodes()[a as usize], &self.tree.nodes()[b as usize]);
            let is_leaf = na.is_leaf() && nb.is_leaf();
            let budget = if is_leaf { self.budgets[0] } else { GROUP_BUDGET.min(self.budgets[0]) };
            if let Some(proof) = self.blocked([&na.bounds, &nb.bounds], shaft, budget, is_leaf) {
                let boxes = [na.bounds, nb.bounds].map(|b| corners(&b));
                found.extend(maker.check_boxes([&boxes[0], &boxes[1]], translated(&proof)));
                return;
            }
        }
        self.halve([a, b], smaller);
    }

    /// Objects by positions: those that are not seen and not proven to be hidden.
    fn open_objects(&self, proven: &ObjectPairs) -> AtomicBitMatrix {
        let open = AtomicBitMatrix::new(self.objects.len(), self.cell_at.len());
        for (object, (place, &cell)) in
            (0..self.objects.len()).flat_map(|object| self.cell_at.iter().enumerate().map(move |at| (object, at)))
        {
            if !self.seen_from.get(object, place) && !proven.has(cell, object as u32) {
                open.set(object, place);
            }
        }
        open
    }

    /// Proofs that an object is hidden from groups of cells: from those that do not see it, as large as they can be, with a cell for which
    /// that is still open.
    fn hide_object<'m>(
        &self,
        object: u32,
        open: &AtomicBitMatrix,
        shaft: &mut Shaft<'a>,
        maker: &AxialMaker<'m>,
        share: u64,
        is_cancelled: &dyn Fn() -> bool,
    ) -> Vec<CheckedProof<'m>> {
        let (target, rows) = (&self.objects[object as usize], [object as usize, object as usize + 1]);
        let before = shaft.counters().n_programs;
        let (mut found, mut stack) = (Vec::new(), vec![0]);
        while let Some(n) = stack.pop() {
            if is_cancelled() || shaft.counters().n_programs - before >= share {
                break;
            }
            let node = &self.tree.nodes()[n as usize];
            let places = [node.start as usize, node.end as usize];
            if !open.any(rows, places) {
                continue;
            }
            let (a, is_leaf) = (&node.bounds, node.is_leaf());
            // A cell that touches the object sees it.
            let apart = (0..3).any(|k| a.max[k] < target.min[k] || target.max[k] < a.min[k]);
            if apart && !self.seen_from.any(rows, places) {
                let budget = if is_leaf { self.budgets[0] } else { GROUP_BUDGET.min(self.budgets[0]) };
                // As for groups of cells.
                let worth_it = is_leaf || shaft.decide(a, target, BoxTarget::Surface, budget).is_hidden();
                if let Some(proof) = worth_it.then(|| shaft.certify(a, target, BoxTarget::Surface, budget)).flatten() {
                    found.extend(maker.check_object(&corners(a), object, translated(&proof)));
                    continue;
                }
            }
            if !is_leaf {
                stack.extend(self.tree.children(n));
            }
        }
        found
    }

    /// A proof that two boxes are hidden from each other.
    fn blocked(
        &self,
        [a, b]: [&Aabb<3>; 2],
        shaft: &mut Shaft<'a>,
        budget: u32,
        is_leaf: bool,
    ) -> Option<BlockedProof> {
        let apart = (0..3).any(|k| a.max[k] <= b.min[k] || b.max[k] <= a.min[k]);
        // Single cells are known to be hidden. For groups this is unknown, and deciding is quicker than proving.
        let worth_it = apart && (is_leaf || shaft.decide(a, b, BoxTarget::Inside, budget).is_hidden());
        if worth_it { shaft.certify(a, b, BoxTarget::Inside, budget) } else { None }
    }
}
