//! Proofs of tables of scenes in space: lines for what is visible, pairs of boxes for what is hidden.

use super::{CertifyError, CertifyOptions, kept};
use crate::space::{AtomicBitMatrix, halves_first, on_threads, opaque_without_solid};
use rayon::prelude::*;
use sightlines_cells::{Axial, CellGraph};
use sightlines_certificates::ObjectPairs;
use sightlines_certificates::space::{
    Box3, BoxLine, BoxMaker, BoxNetwork, BoxNetworkError, BoxPortal, BoxProofs, Branch as Proof,
    Bypass as ProvenBypass, Claim, Sum,
};
use sightlines_geometry::Random;
use sightlines_geometry::{Aabb, BoxTree, check_coordinate};
use sightlines_progress::{Cancelled, Counter};
use sightlines_pvs::{BitMatrix, ObjectId};
use sightlines_sightline::{
    BlockedProof, Blockers, Branch, BranchRow, Bypass, Contradiction, Shaft, ShaftLine, Target, Verdict,
};

/// Lines are added in rounds: at first only those that prove at least this many new pairs.
const ROUNDS: [usize; 3] = [64, 8, 1];

/// Linear programs spent on a pair of groups; one that takes more is halved.
const GROUP_BUDGET: u32 = 64;

/// Linear programs spent on a pair of single cells that is hidden: as many as the search spends.
const CELL_BUDGET: u64 = 2000;

/// Linear programs spent on a line between two cells. A pair that takes more is left open, which hides nothing; most
/// such pairs are only assumed visible.
const LINE_BUDGET: u64 = 100;

/// Number of nearby lines that are tried where a line touches an edge of a portal.
const MOST_TRIED: u32 = 24;

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
/// lines that doubles do not hold, are left open.
///
/// Cost: several times that of the search for the rows: each contradiction is converted to integers, and each visible
/// pair needs a line, its own or a shared one.
///
/// # Errors
/// [`CertifyError`] with a [`BoxNetworkError`] for a graph that is not well formed; or if the observer or the store of units ends
/// the work.
///
/// # Panics
/// If there is not a row for each cell, or not a list of objects, or an object in a list that has no box.
pub fn certify_space(
    graph: &CellGraph<Axial>,
    rows: &BitMatrix,
    objects: Option<ObjectRows<'_>>,
    options: &CertifyOptions<'_>,
) -> Result<BoxProofs, CertifyError<BoxNetworkError>> {
    assert!(rows.n_rows() == graph.n_cells() && rows.n_cols() == graph.n_cells(), "a row for each cell");
    assert!(objects.is_none_or(|objects| objects.seen.len() == graph.n_cells()), "a list for each cell");
    let mut network = space_network(graph).map_err(CertifyError::Network)?;
    if let Some(objects) = objects {
        network = network.with_objects(&objects.boxes.iter().map(corners).collect::<Vec<_>>());
    }
    let read = |bytes: &[u8]| {
        let proofs = BoxProofs::from_bytes(bytes).ok()?;
        let are_objects = proofs.objects.is_empty() || proofs.objects_checksum == network.objects_checksum();
        (are_objects && proofs.checksum == network.checksum()).then_some(proofs)
    };
    kept(options.units, || find(graph, rows, objects, &network, options), BoxProofs::to_bytes, read)
}

fn find(
    graph: &CellGraph<Axial>,
    rows: &BitMatrix,
    objects: Option<ObjectRows<'_>>,
    network: &BoxNetwork,
    options: &CertifyOptions<'_>,
) -> Result<BoxProofs, CertifyError<BoxNetworkError>> {
    let blockers = Blockers::new(opaque_without_solid(graph));
    let rectangles: Vec<Box3> = blockers.rectangles().iter().map(corners).collect();
    let mut maker = BoxMaker::new(network, &rectangles);
    shoot(graph, &mut maker, options.chords);
    if graph.n_cells() == 0 {
        return Ok(maker.finish());
    }
    let search = Search::new(graph, rows, objects, &blockers, options);
    Ok(search.run(maker, options)?)
}

/// The graph in the form that proofs use.
///
/// # Errors
/// [`BoxNetworkError`] for a graph that is not well formed.
pub fn space_network(graph: &CellGraph<Axial>) -> Result<BoxNetwork, BoxNetworkError> {
    let cells: Vec<Box3> = graph.cells().iter().map(|cell| corners(&cell.bounds)).collect();
    let portals: Vec<BoxPortal> = graph
        .portals()
        .iter()
        .map(|p| BoxPortal {
            cells: p.cells.map(|cell| cell.0),
            extent: corners(&p.shape.extent),
            axis: p.shape.axis,
            forward: p.shape.forward,
        })
        .collect();
    BoxNetwork::new(&cells, &portals)
}

fn corners(b: &Aabb<3>) -> Box3 {
    [b.min, b.max]
}

/// A coordinate, rounded to four bytes if it fits.
fn short(x: f64) -> f64 {
    check_coordinate(f64::from(x as f32)).unwrap_or(x)
}

/// A coordinate in the range that proofs accept; tiny ones become zero.
fn valid(x: f64) -> f64 {
    check_coordinate(x).unwrap_or(0.0)
}

/// Passes on a line: with four bytes per coordinate, else with eight.
fn take(maker: &mut BoxMaker<'_>, cell: u32, [p, q]: [[f64; 3]; 2], at_least: usize) -> bool {
    maker.take_line(BoxLine::through(cell, p.map(short), q.map(short)), at_least)
        || maker.take_line(BoxLine::through(cell, p.map(valid), q.map(valid)), at_least)
}

/// Lines through random points of portals, those that prove most first.
fn shoot(graph: &CellGraph<Axial>, maker: &mut BoxMaker<'_>, per_portal: u32) {
    let mut random = Random::new(0x7072_6F6F_6673_0002);
    let all = Aabb::<3>::around(graph.cells().iter().flat_map(|c| [c.bounds.min, c.bounds.max]));
    let mut lines = Vec::new();
    for portal in graph.portals() {
        let extent = &portal.shape.extent;
        for k in 0..per_portal {
            let p = [0, 1, 2].map(|k| extent.min[k] + (extent.max[k] - extent.min[k]) * random.open_unit());
            // Rooms are wide and low: half of the lines are nearly level.
            let step = [0, 1, 2].map(|axis| {
                let size = all.max[axis] - all.min[axis];
                (random.open_unit() - 0.5) * size * if k.is_multiple_of(2) { 1.0 } else { 1.5 - 0.7 * axis as f64 }
            });
            let q = [0, 1, 2].map(|k| p[k] + step[k]);
            lines.push((portal.cells[0].0, [p, q]));
        }
    }
    for at_least in ROUNDS {
        lines.retain(|&(cell, points)| !take(maker, cell, points, at_least));
    }
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

/// A finding about two boxes: they are hidden from each other.
type Found = ([Aabb<3>; 2], BlockedProof);

/// A finding about a box and an object: it is hidden from there.
type FoundObject = (Aabb<3>, u32, BlockedProof);

/// Pairs of groups are halved on one thread until there are this many. Independent of the number of threads.
const N_TASKS: usize = 2048;

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
        let budgets = [CELL_BUDGET, LINE_BUDGET].map(|budget| budget.min(options.most_steps) as u32);
        Self { graph, blockers, tree, cell_at, sees, objects: boxes, seen_from, budgets }
    }

    fn run(&self, mut maker: BoxMaker<'_>, options: &CertifyOptions<'_>) -> Result<BoxProofs, Cancelled> {
        let (mut tasks, mut found) = (vec![[0u32, 0u32]], Vec::new());
        let mut shaft = Shaft::new(self.blockers);
        while !tasks.is_empty() && tasks.len() < N_TASKS {
            let mut smaller = Vec::new();
            tasks.iter().for_each(|&pair| self.hide(pair, &mut shaft, &mut found, &mut smaller));
            tasks = smaller;
        }
        // Half of the effort is for objects, if there are any.
        let halves = if self.objects.is_empty() { 1 } else { 2 };
        let share = options.most_steps_in_all / halves / tasks.len().max(1) as u64;
        // Groups are hidden from each other, then lines are sought from each cell.
        let n_objects = self.objects.len();
        let counter = Counter::new(options.progress, "proofs", tasks.len() + n_objects + self.cell_at.len());
        let work = |shaft: &mut Shaft<'a>, task: Pair| {
            let (mut found, mut stack) = (Vec::new(), vec![task]);
            let before = shaft.counters().n_programs;
            while let Some(pair) = stack.pop() {
                if counter.is_cancelled() || shaft.counters().n_programs - before >= share {
                    break;
                }
                self.hide(pair, shaft, &mut found, &mut stack);
            }
            // A cancellation is noticed below, when all threads are done.
            let _ = counter.step();
            found
        };
        let all: Vec<Vec<Found>> = on_threads(options.threads, |_| {
            tasks.into_par_iter().with_max_len(1).map_init(|| Shaft::new(self.blockers), work).collect()
        });
        counter.check()?;
        for ([a, b], proof) in found.into_iter().chain(all.into_iter().flatten()) {
            let _ = maker.take_boxes([&corners(&a), &corners(&b)], translated(&proof));
        }
        maker.add_out_of_reach();
        let open = self.open_objects(maker.hidden_objects());
        let share = options.most_steps_in_all / halves / n_objects.max(1) as u64;
        let work = |shaft: &mut Shaft<'a>, object: u32| {
            let found = self.hide_object(object, &open, shaft, share, &|| counter.is_cancelled());
            let _ = counter.step();
            found
        };
        let all: Vec<Vec<FoundObject>> = on_threads(options.threads, |_| {
            let objects = (0..n_objects as u32).into_par_iter().with_max_len(1);
            objects.map_init(|| Shaft::new(self.blockers), work).collect()
        });
        counter.check()?;
        for (cells, object, proof) in all.into_iter().flatten() {
            let _ = maker.take_object(&corners(&cells), object, translated(&proof));
        }
        self.seek_all(&mut maker, &mut shaft, &counter)?;
        Ok(maker.finish())
    }

    /// Proves that two groups are hidden from each other, or passes on smaller pairs.
    fn hide(&self, [a, b]: Pair, shaft: &mut Shaft<'a>, found: &mut Vec<Found>, smaller: &mut Vec<Pair>) {
        let (na, nb) = (self.tree.nodes()[a as usize], self.tree.nodes()[b as usize]);
        if a == b {
            if !na.is_leaf() {
                let [left, right] = self.tree.children(a);
                smaller.extend([[left, left], [left, right], [right, right]]);
            }
            return;
        }
        let (rows, cols) = ([na.start as usize, na.end as usize], [nb.start as usize, nb.end as usize]);
        if self.sees.all(rows, cols) {
            return;
        }
        let is_leaf = na.is_leaf() && nb.is_leaf();
        if !self.sees.any(rows, cols) {
            let budget = if is_leaf { self.budgets[0] } else { GROUP_BUDGET.min(self.budgets[0]) };
            if let Some(proof) = self.blocked([&na.bounds, &nb.bounds], shaft, budget, is_leaf) {
                found.push(([na.bounds, nb.bounds], proof));
                return;
            }
        }
        if is_leaf {
            return;
        }
        if halves_first(&self.tree, [a, b]) {
            smaller.extend(self.tree.children(a).map(|a| [a, b]));
        } else {
            smaller.extend(self.tree.children(b).map(|b| [a, b]));
        }
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
    fn hide_object(
        &self,
        object: u32,
        open: &AtomicBitMatrix,
        shaft: &mut Shaft<'a>,
        share: u64,
        is_cancelled: &dyn Fn() -> bool,
    ) -> Vec<FoundObject> {
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
                let worth_it = is_leaf || shaft.decide(a, target, Target::Surface, budget).is_hidden();
                if let Some(proof) = worth_it.then(|| shaft.certify(a, target, Target::Surface, budget)).flatten() {
                    found.push((*a, object, proof));
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
        let worth_it = apart && (is_leaf || shaft.decide(a, b, Target::Inside, budget).is_hidden());
        if worth_it { shaft.certify(a, b, Target::Inside, budget) } else { None }
    }

    /// Finds a line for each visible pair of cells that has none yet.
    fn seek_all(
        &self,
        maker: &mut BoxMaker<'_>,
        shaft: &mut Shaft<'a>,
        counter: &Counter<'_>,
    ) -> Result<(), Cancelled> {
        let mut random = Random::new(0x7072_6F6F_6673_0003);
        for a in 0..self.cell_at.len() {
            for b in self.sees.ones(a).filter(|&b| b > a) {
                self.seek([a, b], maker, shaft, &mut random);
            }
            counter.step()?;
        }
        Ok(())
    }

    /// Finds a line between two cells, given by their positions, if they have none yet.
    fn seek(&self, places: [usize; 2], maker: &mut BoxMaker<'_>, shaft: &mut Shaft<'a>, random: &mut Random) {
        let cells = places.map(|place| self.cell_at[place]);
        if maker.visible().has(cells[0], cells[1]) {
            return;
        }
        let [a, b] = cells.map(|cell| self.graph.cells()[cell as usize].bounds);
        let apart = (0..3).any(|k| a.max[k] <= b.min[k] || b.max[k] <= a.min[k]);
        if !apart {
            return;
        }
        let Verdict::Visible(ShaftLine::Free(line)) = shaft.decide(&a, &b, Target::Inside, self.budgets[1]) else {
            return;
        };
        let [p, q] = line.points();
        // A free line may pass the common edge of two portals; lines next to it do not.
        let mut width = 0.25;
        for k in 0..=MOST_TRIED {
            let mut beside = |p: [f64; 3], b: &Aabb<3>| {
                [0, 1, 2].map(|i| {
                    let to = b.min[i] + (b.max[i] - b.min[i]) * random.open_unit();
                    if k == 0 { p[i] } else { p[i] + (to - p[i]) * width }
                })
            };
            let points = [beside(p, &a), beside(q, &b)];
            let _ = take(maker, cells[0], points, 1);
            if maker.visible().has(cells[0], cells[1]) {
                return;
            }
            width *= 0.5;
        }
    }
}

/// A proof in the terms of the proof format.
fn translated(proof: &BlockedProof) -> Vec<(u8, Proof)> {
    let octant = |signs: &[bool; 3]| (0..3).fold(0u8, |bits, k| bits | u8::from(signs[k]) << k);
    proof.octants.iter().map(|(signs, branch)| (octant(signs), branch_of(branch))).collect()
}

fn branch_of(branch: &Branch) -> Proof {
    match branch {
        Branch::Empty(terms) => Proof::Empty(sum_of(terms)),
        Branch::Past { rectangle, ways, rest } => Proof::Past {
            blocker: *rectangle,
            ways: ways.iter().map(|(way, branch)| (way_of(*way), branch_of(branch))).collect(),
            rest: rest.as_ref().map(sum_of),
        },
    }
}

fn way_of(way: Bypass) -> ProvenBypass {
    match way {
        Bypass::Beside { axis, entering } => ProvenBypass::Beside { axis, before: entering },
        Bypass::Before => ProvenBypass::InFirst,
        Bypass::After => ProvenBypass::InSecond,
    }
}

fn sum_of(terms: &Contradiction) -> Sum {
    let claim = |row: &BranchRow| match *row {
        BranchRow::End { second, early, late } => Claim::Box { second, enter: early, leave: late },
        BranchRow::Taken { depth, row } => Claim::Taken { depth: depth as u32, part: row },
        BranchRow::NotTaken { depth, way } => Claim::Reversed { depth: depth as u32, way: way_of(way) },
    };
    terms.iter().map(|(row, multiplier)| (claim(row), multiplier.clone())).collect()
}
