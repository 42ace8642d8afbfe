//! Proofs of tables of plans: lines for what is visible, walks for what is hidden.

use super::{CertifyError, CertifyOptions, PHASE, Steps, through};
use crate::search::ones;
use sightlines_cells::{CellGraph, CellId, Exit, Planar};
use sightlines_certificates::planar::{
    LineForm, NetworkError, PlanLine, PlanarBlock, PlanarMaker, PlanarNetwork, PlanarPortal, PlanarProofs,
};
use sightlines_certificates::{ChainSolver, ChainStep, Pairs};
use sightlines_geometry::Random;
use sightlines_geometry::{Adaptive, Point2, Portal2, check_coordinate};
use sightlines_progress::Counter;
use sightlines_pvs::BitMatrix;
use sightlines_sightline::{Funnel, FunnelUndo, PlanarCertificate, PlanarWitness};

/// Longest sequence of doors in the search for a line between two single cells. Pairs farther apart need a line that
/// was shot, or stay open.
const MOST_DOORS: usize = 1500;

/// Proves the visibility in `rows` for the cells of `graph` (symmetric, with the diagonal set). Pairs without a proof,
/// because they are wrong or take too much effort, are left open.
///
/// Cost: about that of the search for the rows, and some more for each pair that few lines join.
///
/// # Errors
/// [`CertifyError`] with a [`NetworkError`] for a graph that is not well formed, or one of too large coordinates; or if the observer
/// or the store of units ends the work.
///
/// # Panics
/// If there is not a row for each cell.
pub fn certify_planar(
    graph: &CellGraph<Planar>,
    rows: &BitMatrix,
    options: &CertifyOptions<'_>,
) -> Result<PlanarProofs, CertifyError<NetworkError>> {
    assert!(rows.n_rows() == graph.n_cells() && rows.n_cols() == graph.n_cells(), "a row for each cell");
    let network = planar_network(graph).map_err(CertifyError::Network)?;
    let n = graph.n_cells();
    // Each cell is visited twice: for lines to what it sees, and for a walk to what it does not see.
    let counter = Counter::new(options.progress, "proofs", 2 * n);
    let shots = shots(graph, options.chords);
    let mut order: Vec<u32> = (0..n as u32).collect();
    order.sort_by_key(|&cell| (rows.count_row(cell as usize), cell));
    let start = || PlanarSteps {
        graph,
        rows,
        shots: &shots,
        order: &order,
        maker: PlanarMaker::new(&network),
        most_steps: options.most_steps,
        most_steps_in_all: options.most_steps_in_all,
        spent: 0,
    };
    let share = 1.0 / (2 * n).max(1) as f64;
    let found = through(PHASE, [shots.len(), n, n], (&counter, share), options.units, start)?;
    Ok(found.maker.finish())
}

/// A line that is shot, and a cell that it leaves or enters.
struct Shot {
    cell: u32,
    points: [Point2; 2],
}

/// Lines for cells, then walks.
struct PlanarSteps<'a> {
    graph: &'a CellGraph<Planar>,
    rows: &'a BitMatrix,
    shots: &'a [Shot],
    /// The order of walks: the cells that see least come first.
    order: &'a [u32],
    maker: PlanarMaker<'a>,
    most_steps: u64,
    most_steps_in_all: u64,
    spent: u64,
}

impl Steps for PlanarSteps<'_> {
    const ROUNDS: [usize; 3] = [32, 6, 1];
    const COSTS: [f64; 3] = [0.02, 1.0, 1.0];
    type Line = PlanLine;

    fn shot(&self, shot: usize) -> [PlanLine; 2] {
        let Shot { cell, points } = self.shots[shot];
        // Whether it leaves or enters the cell does not matter; where four bytes miss the portal, eight may not.
        let [p, q] = points.map(|p| [p.x, p.y]);
        [PlanLine::through(cell, p.map(short), q.map(short)), PlanLine::through(cell, p, q)]
    }

    fn take_line(&mut self, line: PlanLine, at_least: usize) -> bool {
        self.maker.take_line(line, at_least)
    }

    fn seek(&mut self, step: usize) {
        Seeker::new(self.graph, self.rows, &mut self.maker, self.most_steps).seek(CellId(step as u32));
    }

    fn begin_walks(&mut self) {
        for a in 0..self.graph.n_cells() {
            for b in self.rows.iter_ones(a).filter(|&b| b > a) {
                self.maker.leave_open(a as u32, b as u32);
            }
        }
    }

    fn walk(&mut self, step: usize) {
        let left = self.most_steps_in_all - self.spent;
        let mut guide = Guide::new(self.graph, self.most_steps.min(left));
        self.maker.prove_hidden(self.order[step], &mut guide, self.most_steps.min(left));
        self.spent += guide.n_steps.min(left);
    }

    fn spent(&self) -> u64 {
        self.spent
    }

    fn spend(&mut self, spent: u64, _: usize) -> bool {
        let is_left = spent <= self.most_steps_in_all - self.spent;
        self.spent += if is_left { spent } else { 0 };
        is_left
    }

    fn n_taken(&self) -> [usize; 2] {
        self.maker.n_taken()
    }

    fn taken_since(&self, n_taken: [usize; 2]) -> Vec<u8> {
        self.maker.taken_since(n_taken)
    }

    fn take_again(&mut self, bytes: &[u8]) -> bool {
        self.maker.take_again(bytes)
    }
}

/// The graph in the form that proofs use.
///
/// # Errors
/// [`NetworkError`] for a graph that is not well formed, or one of too large coordinates.
pub fn planar_network(graph: &CellGraph<Planar>) -> Result<PlanarNetwork, NetworkError> {
    let point = |p: Point2| [p.x, p.y];
    let cells: Vec<Vec<[f64; 2]>> =
        graph.cells().iter().map(|cell| cell.polygon.iter().map(|&p| point(p)).collect()).collect();
    let portals: Vec<PlanarPortal> = graph
        .portals()
        .iter()
        .map(|p| PlanarPortal {
            cells: p.cells.map(|cell| cell.0),
            sides: p.sides,
            left: point(p.shape.left),
            right: point(p.shape.right),
        })
        .collect();
    PlanarNetwork::new(&cells, &portals)
}

/// A coordinate, rounded to four bytes if it fits.
fn short(x: f64) -> f64 {
    check_coordinate(f64::from(x as f32)).unwrap_or(x)
}

/// Lines through random points of portals.
fn shots(graph: &CellGraph<Planar>, per_portal: u32) -> Vec<Shot> {
    let mut random = Random::new(0x7072_6F6F_6673_0001);
    let bounds = graph.cells().iter().flat_map(|c| &c.polygon).map(|p| [p.x, p.y]);
    let bounds = sightlines_geometry::Aabb::<2>::around(bounds);
    let extent = (bounds.max[0] - bounds.min[0]).max(bounds.max[1] - bounds.min[1]);
    let mut shots = Vec::new();
    for portal in graph.portals() {
        let (left, right) = (portal.shape.left, portal.shape.right);
        for _ in 0..per_portal {
            let p = right + (left - right) * random.open_unit();
            let q = p + Point2::new(random.open_unit() - 0.5, random.open_unit() - 0.5) * extent;
            shots.push(Shot { cell: portal.cells[0].0, points: [p, q] });
        }
    }
    shots
}

/// Which cells reach in front of a portal: errs towards reaching.
fn front(portal: Portal2, bounds: &sightlines_geometry::Aabb<2>) -> bool {
    sightlines_sightline::Stabber::in_front(&Funnel::new(Adaptive), &portal, bounds)
}

/// Searches for lines from one cell to cells that are known to be visible.
struct Seeker<'a, 'm, 'n> {
    graph: &'a CellGraph<Planar>,
    rows: &'a BitMatrix,
    maker: &'m mut PlanarMaker<'n>,
    funnel: Funnel<Adaptive>,
    doors: Vec<Portal2>,
    left: u64,
}

impl<'a, 'm, 'n> Seeker<'a, 'm, 'n> {
    fn new(graph: &'a CellGraph<Planar>, rows: &'a BitMatrix, maker: &'m mut PlanarMaker<'n>, most_steps: u64) -> Self {
        Self { graph, rows, maker, funnel: Funnel::new(Adaptive), doors: Vec::new(), left: most_steps }
    }

    /// Finds a line to each cell with a greater number that has none yet.
    fn seek(&mut self, from: CellId) {
        let missing: Vec<u64> = missing(self.rows, self.maker.visible(), from);
        if missing.iter().all(|word| *word == 0) {
            return;
        }
        let graph = self.graph;
        for exit in graph.exits(from) {
            let door = graph.crossing(exit);
            self.funnel.start(door);
            self.doors.push(door);
            self.enter(from, exit, &missing);
            self.doors.pop();
        }
    }

    /// Continues behind an exit; some of `wanted` may have been found meanwhile.
    fn enter(&mut self, from: CellId, entered_by: &Exit, wanted: &[u64]) {
        let (graph, here) = (self.graph, entered_by.to);
        if self.left == 0 || self.doors.len() > MOST_DOORS {
            return;
        }
        self.left -= 1;
        let is_wanted = wanted[here.idx() / 64] >> (here.idx() % 64) & 1 == 1;
        if is_wanted && !self.maker.visible().has(from.0, here.0) {
            self.take(from);
        }
        let door = self.doors[self.doors.len() - 1];
        let known = self.maker.visible().row(from.0);
        let rows = self.rows.row(here.idx());
        let mut wanted: Vec<u64> = (0..wanted.len()).map(|i| wanted[i] & !known[i] & rows[i]).collect();
        for (i, word) in wanted.iter_mut().enumerate() {
            let behind = ones(*word).filter(|b| !front(door, &graph.cells()[i * 64 + b].bounds()));
            *word &= !behind.fold(0u64, |out, b| out | 1 << b);
        }
        for exit in graph.exits(here) {
            if wanted.iter().all(|word| *word == 0) {
                return;
            }
            if exit.side == entered_by.entry_side {
                continue;
            }
            let door = graph.crossing(exit);
            let Some(undo) = self.funnel.push(door) else { continue };
            self.doors.push(door);
            self.enter(from, exit, &wanted);
            self.doors.pop();
            self.funnel.undo(undo);
            let known = self.maker.visible().row(from.0);
            wanted.iter_mut().zip(known).for_each(|(word, known)| *word &= !known);
        }
    }

    /// Passes on a line through all doors: in four bytes, in eight, or in integers.
    fn take(&mut self, from: CellId) {
        let witness = self.funnel.witness();
        if let Some([p, q]) = witness.rounded(&self.doors) {
            for [p, q] in [[p, q].map(|p| [short(p.x), short(p.y)]), [p, q].map(|p| [p.x, p.y])] {
                if self.maker.take_line(PlanLine::through(from.0, p, q), 1) {
                    return;
                }
            }
        }
        self.maker.take_line(PlanLine { cell: from.0, form: whole(&witness) }, 1);
    }
}

/// The cells with greater numbers that a cell sees and that have no line yet.
fn missing(rows: &BitMatrix, visible: &Pairs, from: CellId) -> Vec<u64> {
    let words = rows.row(from.idx()).iter().zip(visible.row(from.0));
    let mut missing: Vec<u64> = words.map(|(sees, proven)| sees & !proven).collect();
    for (i, word) in missing.iter_mut().enumerate() {
        match (from.idx() / 64).cmp(&i) {
            std::cmp::Ordering::Greater => *word = 0,
            std::cmp::Ordering::Equal => *word &= !(u64::MAX >> (63 - from.idx() % 64)),
            std::cmp::Ordering::Less => {}
        }
    }
    missing
}

/// A line in integers.
fn whole(witness: &PlanarWitness) -> LineForm {
    let [a, b, c] = witness.coefficients();
    let common = a.denom() * b.denom() * c.denom();
    LineForm::Whole(Box::new([a, b, c].map(|x| x.numer() * (&common / x.denom()))))
}

/// The funnel, and for a blocked sequence the reason.
struct Guide<'a> {
    graph: &'a CellGraph<Planar>,
    funnel: Funnel<Adaptive>,
    undos: Vec<FunnelUndo>,
    n_steps: u64,
    most_steps: u64,
}

impl<'a> Guide<'a> {
    fn new(graph: &'a CellGraph<Planar>, most_steps: u64) -> Self {
        Self { graph, funnel: Funnel::new(Adaptive), undos: Vec::new(), n_steps: 0, most_steps }
    }

    fn door(&self, gate: u32) -> Portal2 {
        let shape = self.graph.portals()[gate as usize / 2].shape;
        if gate.is_multiple_of(2) { shape } else { shape.reversed() }
    }

    /// Ends of few gates that no line separates: most often of the gates that hold the limit of the funnel that the
    /// new gate is beyond, else of any.
    fn block(&self, chain: &[u32], gate: u32) -> Option<PlanarBlock> {
        let doors: Vec<Portal2> = chain.iter().chain([&gate]).map(|&g| self.door(g)).collect();
        let last = chain.len();
        let holding = |left: Point2, right: Point2| {
            let l = doors[..last].iter().rposition(|d| d.left == left)?;
            let r = doors[..last].iter().rposition(|d| d.right == right)?;
            let mut few = vec![l, r, last];
            few.sort_unstable();
            few.dedup();
            Some(few)
        };
        let (l0, r0) = self.funnel.clockwise_limit();
        let (r1, l1) = self.funnel.counter_clockwise_limit();
        let choices = [holding(l0, r0), holding(l1, r1), Some((0..doors.len()).collect())];
        choices.into_iter().flatten().find_map(|few| {
            let of: Vec<Portal2> = few.iter().map(|&k| doors[k]).collect();
            let found = PlanarCertificate::find(&of)?;
            let back = |ends: &[sightlines_sightline::End]| {
                ends.iter().map(|end| (last - few[end.portal]) as u32).collect::<Vec<u32>>()
            };
            Some(PlanarBlock { lefts: back(&found.lefts), rights: back(&found.rights) })
        })
    }
}

impl ChainSolver for Guide<'_> {
    type Block = PlanarBlock;

    fn start(&mut self, gate: u32) {
        self.undos.clear();
        self.funnel.start(self.door(gate));
    }

    fn cross(&mut self, chain: &[u32], gate: u32) -> ChainStep<PlanarBlock> {
        self.n_steps += 1;
        if self.n_steps > self.most_steps {
            return ChainStep::GiveUp;
        }
        match self.funnel.push(self.door(gate)) {
            Some(undo) => {
                self.undos.push(undo);
                ChainStep::Open
            }
            None => self.block(chain, gate).map_or(ChainStep::GiveUp, ChainStep::Blocked),
        }
    }

    fn back(&mut self) {
        if let Some(undo) = self.undos.pop() {
            self.funnel.undo(undo);
        }
    }
}
