//! Proofs of tables of maps: lines for what is visible, walks for what is hidden.

use super::beams::BeamTracer;
use super::bound;
use super::gates::Gates;
use super::pairs::SequenceTracer;
use super::vector::{Point3, add, cross, dot, scale};
use crate::certify::{CertifyError, CertifyOptions, PHASE, Steps, through};
use sightlines_cells::{CellGraph, Convex, Portal3};
use sightlines_certificates::convex::{
    ConvexBlock, ConvexCut, ConvexLine, ConvexMaker, ConvexNetwork, ConvexNetworkError, ConvexPlane, ConvexPortal,
    ConvexProofs, ConvexSums, ConvexTerm, ConvexTree,
};
use sightlines_certificates::{ChainSolver, ChainStep};
use sightlines_geometry::Random;
use sightlines_geometry::check_coordinate;
use sightlines_progress::Counter;
use sightlines_pvs::BitMatrix;
use sightlines_sightline::convex::{Block, BoxProof, ConvexCertificate, ConvexNode, HullProof, PlaneProof};
use sightlines_sightline::{ConvexStabber, Line3, StabLimits, Verdict};

/// Steps that a stabbing query counts for: it takes about as many times longer than a step in a plan.
const STEPS_EACH: u64 = 1000;
/// How often a walk that is too long is repeated with half of its targets.
const MOST_HALVINGS: u32 = 4;
/// The largest integer multipliers, tried in order: small ones take fewer bytes, but use up more of the margin.
const MULTIPLIERS: [f64; 3] = [120.0, 16_000.0, 2_000_000.0];

/// Proves the visibility in `rows` for the cells of `graph` (symmetric, with the diagonal set). Pairs without a proof,
/// because they are wrong, undecided or take too much effort, are left open.
///
/// Cost: for visible pairs about that of the search for the rows; for hidden pairs a query for each gate at the end of
/// a stabbable chain of gates, and through open space these are many.
///
/// # Errors
/// [`CertifyError`] with a [`ConvexNetworkError`] for a graph that is not well formed; or if the observer or the store of units ends
/// the work.
///
/// # Panics
/// If there is not a row for each cell.
pub fn certify_convex(
    graph: &CellGraph<Convex>,
    rows: &BitMatrix,
    options: &CertifyOptions<'_>,
) -> Result<ConvexProofs, CertifyError<ConvexNetworkError>> {
    assert!(rows.n_rows() == graph.n_cells() && rows.n_cols() == graph.n_cells(), "a row for each cell");
    let network = convex_network(graph).map_err(CertifyError::Network)?;
    let n = graph.n_cells();
    let gates = Gates::new(graph);
    // Lines are sought from each gate and each cell, then walks from each cell.
    let n_seeks = if options.most_steps > 0 { gates.len() + n } else { 0 };
    let counter = Counter::new(options.progress, "proofs", n_seeks + n);
    let shots = shots(&gates, options.chords);
    let mut order: Vec<u32> = (0..n as u32).collect();
    order.sort_by_key(|&cell| (rows.count_row(cell as usize), cell));
    let start = || ConvexSteps {
        rows,
        gates: &gates,
        shots: &shots,
        order: &order,
        maker: ConvexMaker::new(&network),
        seeker: None,
        guide: Guide::new(&gates, &network),
        most_steps: options.most_steps,
        left: options.most_steps_in_all / STEPS_EACH,
        spent: 0,
    };
    let share = 1.0 / (n_seeks + n).max(1) as f64;
    let found = through(PHASE, [shots.len(), n_seeks, n], (&counter, share), options.units, start)?;
    Ok(found.maker.finish())
}

/// Lines for gates and for cells, then walks.
struct ConvexSteps<'a> {
    rows: &'a BitMatrix,
    gates: &'a Gates,
    shots: &'a [[ConvexLine; 2]],
    /// The order of walks: the cells that see least come first.
    order: &'a [u32],
    maker: ConvexMaker<'a>,
    /// Made when it is needed: a run that goes on with walks does not need it.
    seeker: Option<Seeker>,
    guide: Guide<'a>,
    most_steps: u64,
    /// Queries that are left and spent, for all walks together.
    left: u64,
    spent: u64,
}

impl Steps for ConvexSteps<'_> {
    const ROUNDS: [usize; 3] = [32, 6, 1];
    const COSTS: [f64; 3] = [0.02, 1.0, 1.0];
    type Line = ConvexLine;

    fn shot(&self, shot: usize) -> [ConvexLine; 2] {
        self.shots[shot]
    }

    fn take_line(&mut self, line: ConvexLine, at_least: usize) -> bool {
        self.maker.take_line(line, at_least)
    }

    fn seek(&mut self, step: usize) {
        let seeker = self.seeker.get_or_insert_with(|| Seeker::new(self.gates));
        match step.checked_sub(self.gates.len()) {
            None => seeker.follow_beams(self.gates, step as u32, self.rows, &mut self.maker),
            Some(cell) => seeker.follow_sequences(self.gates, cell as u32, self.rows, &mut self.maker),
        }
    }

    fn begin_walks(&mut self) {
        self.seeker = None;
        for a in 0..self.rows.n_rows() {
            for b in self.rows.iter_ones(a).filter(|&b| b > a) {
                self.maker.leave_open(a as u32, b as u32);
            }
        }
    }

    fn walk(&mut self, step: usize) {
        let (source, most) = (self.order[step], self.most_steps / STEPS_EACH);
        let mut waiting = vec![(self.maker.left(source), 0)];
        while let Some((targets, n_halvings)) = waiting.pop() {
            self.guide.left = (most >> n_halvings).min(self.left);
            let before = self.guide.left;
            // If it covers all that is left, the list is empty.
            let listed = if n_halvings == 0 { &[][..] } else { &targets[..] };
            let is_proven = self.maker.prove_hidden(source, listed, &mut self.guide, self.most_steps);
            self.spend(before - self.guide.left, 1);
            if !is_proven && targets.len() > 1 && n_halvings < MOST_HALVINGS && self.left > 0 {
                let (low, high) = targets.split_at(targets.len() / 2);
                waiting.extend([(high.to_vec(), n_halvings + 1), (low.to_vec(), n_halvings + 1)]);
            }
        }
    }

    fn spent(&self) -> u64 {
        self.spent
    }

    fn spend(&mut self, spent: u64, _: usize) -> bool {
        let Some(left) = self.left.checked_sub(spent) else { return false };
        self.left = left;
        self.spent += spent;
        true
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
/// [`ConvexNetworkError`] for a graph that is not well formed.
pub fn convex_network(graph: &CellGraph<Convex>) -> Result<ConvexNetwork, ConvexNetworkError> {
    let portal = |p: &sightlines_cells::Portal<Convex>| ConvexPortal {
        cells: p.cells.map(|cell| cell.0),
        corners: p.shape.corners().to_vec(),
    };
    let portals: Vec<ConvexPortal> = graph.portals().iter().map(portal).collect();
    ConvexNetwork::new(graph.n_cells(), &portals, ConvexNetwork::OF_FILES)
}

/// A line through a gate with coordinates of four bytes, and with those of eight. Which of them passes depends on the
/// line.
fn lines(gate: u32, points: [Point3; 2]) -> [ConvexLine; 2] {
    let short = |x: f64| check_coordinate(f64::from(x as f32)).unwrap_or(x);
    let [a, b] = points;
    [ConvexLine::through(gate, a.map(short), b.map(short)), ConvexLine::through(gate, a, b)]
}

/// Lines through random points of portals.
fn shots(gates: &Gates, per_portal: u32) -> Vec<[ConvexLine; 2]> {
    let mut random = Random::new(0x7072_6F6F_6673_0002);
    let mut shots = Vec::new();
    for gate in (0..gates.len() as u32).step_by(2) {
        for _ in 0..per_portal {
            let (mut sum, mut weights) = ([0.0; 3], 0.0);
            for corner in gates.shape(gate).corners() {
                let weight = random.open_unit();
                sum = add(sum, scale(*corner, weight));
                weights += weight;
            }
            let from = scale(sum, 1.0 / weights);
            let way: Point3 = std::array::from_fn(|_| random.open_unit() - 0.5);
            let normal = gates.get(gate).normal;
            let is_back = dot(way, normal) < 0.0;
            shots.push(lines(gate ^ u32::from(is_back), [from, add(from, scale(way, 1024.0))]));
        }
    }
    shots
}

/// Searches for lines to visible cells that have none yet: by beams, then by sequences.
struct Seeker {
    /// For each gate the cells that may be seen through it.
    through: BitMatrix,
    stabber: ConvexStabber,
    beams: BeamTracer,
    sequences: SequenceTracer,
}

impl Seeker {
    fn new(gates: &Gates) -> Self {
        let mut through = BitMatrix::new(gates.len(), gates.n_cells());
        for gate in 0..gates.len() {
            through.row_mut(gate).copy_from_slice(&bound::seen_through(gates, gate as u32));
        }
        let stabber = ConvexStabber::new(StabLimits::default());
        Self { through, stabber, beams: BeamTracer::new(gates), sequences: SequenceTracer::new(gates) }
    }

    /// Searches through a gate.
    fn follow_beams(&mut self, gates: &Gates, gate: u32, rows: &BitMatrix, maker: &mut ConvexMaker<'_>) {
        let from = gates.get(gate).from;
        let in_doubt = rows.row(from as usize).iter().zip(maker.visible().row(from)).map(|(row, known)| row & !known);
        let mut in_doubt: Vec<u64> = in_doubt.collect();
        in_doubt[from as usize / 64] &= !(1 << (from % 64));
        let traced = self.beams.trace(gates, gate, in_doubt, &self.through);
        traced.chains.iter().for_each(|chain| self.take(gates, chain, maker));
    }

    /// Searches from a cell.
    fn follow_sequences(&mut self, gates: &Gates, a: u32, rows: &BitMatrix, maker: &mut ConvexMaker<'_>) {
        for b in rows.iter_ones(a as usize).map(|b| b as u32).filter(|&b| b > a) {
            if !maker.visible().has(a, b)
                && let Verdict::Visible(chain) = self.sequences.decide(gates, [a, b], &self.through)
            {
                self.take(gates, &chain, maker);
            }
        }
    }

    /// Passes on a line through a chain of gates, if cells of it have none yet.
    fn take(&mut self, gates: &Gates, chain: &[u32], maker: &mut ConvexMaker<'_>) {
        let cells = || chain.iter().map(|&g| gates.get(g).from).chain(chain.last().map(|&g| gates.get(g).to));
        if cells().all(|a| cells().all(|b| a == b || maker.visible().has(a, b))) {
            return;
        }
        let shapes: Vec<&Portal3> = chain.iter().map(|&gate| gates.shape(gate)).collect();
        match self.stabber.stab(&shapes, None) {
            Verdict::Visible(line) => {
                let _ = lines(chain[0], [line.a, line.b]).into_iter().any(|line| maker.take_line(line, 1));
            }
            Verdict::Hidden(_) => {}
            Verdict::Undecided(_) => {
                if let Verdict::Visible(line) = self.stabber.stab_finely(&shapes) {
                    maker.take_line(ConvexLine::through_sums(chain[0], line.points()), 1);
                }
            }
        }
    }
}

/// Searches for a line through each chain, or the reason why there is none.
struct Guide<'a> {
    gates: &'a Gates,
    network: &'a ConvexNetwork,
    stabber: ConvexStabber,
    /// For each gate of the chain, a line up to there, if one is known.
    lines: Vec<Option<Line3>>,
    /// Queries left.
    left: u64,
}

impl<'a> Guide<'a> {
    fn new(gates: &'a Gates, network: &'a ConvexNetwork) -> Self {
        Self { gates, network, stabber: ConvexStabber::new(StabLimits::default()), lines: Vec::new(), left: 0 }
    }

    /// The content of a proof, in a form that the checker accepts.
    fn block(&self, proof: &ConvexCertificate, chain: &[u32], gate: u32) -> Option<ConvexBlock> {
        let last = chain.len();
        let back = |place: usize| (last - place) as u32;
        match proof {
            ConvexCertificate::Plane(PlaneProof { edge, corner, stops }) => {
                let at = |(place, k): (usize, usize)| [back(place), k as u32];
                let stops = [back(stops[0]), back(stops[1])];
                let block = ConvexBlock::Plane(ConvexPlane { stops, edge: at(*edge), corner: at(*corner) });
                Some(block).filter(|block| block.holds(self.network, chain, gate))
            }
            ConvexCertificate::Boxes(proof) => MULTIPLIERS.into_iter().map(Some).chain([None]).find_map(|most| {
                let tree = tree(proof, 0, &back, most)?;
                let block = ConvexBlock::Sums(ConvexSums { ends: proof.portals.map(back), tree });
                Some(block).filter(|block| block.holds(self.network, chain, gate))
            }),
            ConvexCertificate::Hulls(HullProof { portals, terms }) => {
                let term = |t: &sightlines_sightline::convex::ConvexTerm| ConvexTerm {
                    gate: back(t.portal),
                    edge: t.edge as u32,
                    times: t.multiplier,
                };
                let tree = ConvexTree::Sum(terms.iter().map(term).collect());
                let block = ConvexBlock::Sums(ConvexSums { ends: portals.map(back), tree });
                Some(block).filter(|block| block.holds(self.network, chain, gate))
            }
            _ => None,
        }
    }
}

impl ChainSolver for Guide<'_> {
    type Block = ConvexBlock;

    fn start(&mut self, _gate: u32) {
        self.lines.clear();
        self.lines.push(None);
    }

    fn cross(&mut self, chain: &[u32], gate: u32) -> ChainStep<ConvexBlock> {
        if self.left == 0 {
            return ChainStep::GiveUp;
        }
        self.left -= 1;
        let shapes: Vec<&Portal3> = chain.iter().chain([&gate]).map(|&g| self.gates.shape(g)).collect();
        let hint = self.lines.last().copied().flatten();
        let mut line = None;
        let proof = match self.stabber.stab(&shapes, hint.as_ref()) {
            Verdict::Visible(found) => {
                line = Some(found);
                None
            }
            Verdict::Hidden(proof) => Some(proof),
            Verdict::Undecided(_) => match self.stabber.stab_finely(&shapes) {
                Verdict::Hidden(proof) => Some(proof),
                Verdict::Visible(_) | Verdict::Undecided(_) => None,
            },
        };
        if let Some(block) = proof.and_then(|proof| self.block(&proof, chain, gate)) {
            return ChainStep::Blocked(block);
        }
        self.lines.push(line);
        ChainStep::Open
    }

    fn back(&mut self) {
        self.lines.pop();
    }
}

/// The boxes of a proof from a node on. Multipliers are integers up to `most`, or left as they are.
fn tree(proof: &BoxProof, node: usize, back: &impl Fn(usize) -> u32, most: Option<f64>) -> Option<ConvexTree> {
    match proof.nodes.get(node)? {
        ConvexNode::Leaf(terms) => {
            let largest = terms.iter().map(|t| t.multiplier).fold(0.0, f64::max);
            let times = |x: f64| most.map_or(x, |most| (x / largest * most).round());
            let term = |t: &sightlines_sightline::convex::ConvexTerm| ConvexTerm {
                gate: back(t.portal),
                edge: t.edge as u32,
                times: times(t.multiplier),
            };
            Some(ConvexTree::Sum(terms.iter().map(term).filter(|term| term.times > 0.0).collect()))
        }
        ConvexNode::Split { axis, at, parts } => {
            let (end, k) = (usize::from(axis / 2), usize::from(axis % 2));
            let [low, high] = *parts;
            let parts = [tree(proof, low, back, most)?, tree(proof, high, back, most)?];
            let plane = plane_across(&proof.blocks[end], k, *at);
            Some(ConvexTree::Cut(Box::new(ConvexCut { later: end == 1, plane, parts })))
        }
    }
}

/// The plane on which a coordinate of a block is `at`, rounded.
fn plane_across(block: &Block, k: usize, at: f64) -> [f64; 4] {
    let (a, b) = (block.edges[(k + 1) % 3], block.edges[(k + 2) % 3]);
    let normal = cross(a, b);
    let normal = scale(normal, 1.0 / dot(normal, block.edges[k]));
    [normal[0], normal[1], normal[2], -dot(normal, block.corner) - at].map(|x| check_coordinate(x).unwrap_or(0.0))
}
