//! What boxes see that are no cells: each is asked about as a whole, past the walls of a graph.
//!
//! Such a box may lie anywhere among the cells, with walls inside of it. They do not count: an eye is between any of them and
//! the side by which a line leaves the box, so what is asked is what stands between the box and a target ([`Shaft`]). That is exact: a line that is
//! free from where it leaves the box on is seen by eyes just before that place, and what an eye in the box sees is
//! seen along a line that is free from there on. Groups of targets are asked about first, then their halves.

use super::objects::touch;
use super::opaque::opaque_rectangles;
use super::pairs::{CELL_BUDGET, GROUP_BUDGET, apart};
use super::slivers::THIN;
use super::{components, on_threads};
use crate::search::SearchOptions;
use rayon::prelude::*;
use sightlines_cells::{Axial, CellGraph};
use sightlines_geometry::{Aabb, BoxTree};
use sightlines_pvs::BitMatrix;
use sightlines_sightline::{Blockers, Shaft, ShaftCounters, Sight, Target};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// What is asked about boxes: pairs of boxes, which has to be symmetric, and of a box and an object.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AskedOfBoxes {
    /// Boxes by boxes.
    pub boxes: BitMatrix,
    /// Boxes by objects.
    pub objects: BitMatrix,
}

/// The answer for boxes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SeenFromBoxes {
    /// Boxes by boxes: of the pairs that were asked, those that see each other. Symmetric.
    pub boxes: BitMatrix,
    /// Boxes by objects: of the pairs that were asked, those of which the box sees the object.
    pub objects: BitMatrix,
    /// Opaque rectangles that the walls were put together to.
    pub n_blockers: usize,
    /// Pairs that count as visible because it would have taken too much effort, or more digits than doubles have,
    /// to decide about them.
    pub n_assumed: u64,
    /// What it took.
    pub counters: ShaftCounters,
}

/// Finds which of `boxes` see each other, and which objects they see, past the walls of a graph.
///
/// * `graph`: cells that fill, with `solid`, all of the box around them; what is beyond it is unknown, so whatever
///   reaches out of it is visible.
/// * `solid`: boxes beside the cells, that no line from a cell gets into and no eye is in.
/// * `boxes`: closed boxes, scene units, that eyes are in. They may overlap, and lie astride of walls. They see each other if an
///   open set of lines leads from inside of one to inside of the other without meeting a wall between where it leaves the one and where it
///   enters the other, and if they touch. Flat ones, and ones that are thinner than 2^-32 of the scene, are made a
///   little thicker.
/// * `objects`: as for [`see_space`](super::see_space).
/// * `asked`: the pairs that are of interest.
///
/// Exact, but for thin boxes, which may see more, and pairs that take thousands of linear programs, which count as
/// visible. The same for any number of threads. Cost: O(log n) questions for each box and what it sees.
///
/// # Panics
/// If a matrix of `asked` is not about as many boxes and objects.
pub fn see_from_boxes(
    graph: &CellGraph<Axial>,
    solid: &[Aabb<3>],
    boxes: &[Aabb<3>],
    objects: &[Aabb<3>],
    asked: &AskedOfBoxes,
    options: &SearchOptions<'_>,
) -> SeenFromBoxes {
    let fits = |m: &BitMatrix, n_cols: usize| m.n_rows() == boxes.len() && m.n_cols() == n_cols;
    assert!(fits(&asked.boxes, boxes.len()) && fits(&asked.objects, objects.len()), "a row for each box");
    let blockers = Blockers::new(opaque_rectangles(graph, solid));
    let places = Places::new(graph);
    let thick: Vec<Aabb<3>> = boxes.iter().map(|b| places.thickened(b)).collect();
    let of_boxes = Targets::new(&thick, boxes, Target::Inside, &places);
    let of_objects = Targets::new(objects, objects, Target::Surface, &places);
    let done = AtomicUsize::new(0);
    let one = |shaft: &mut Shaft<'_>, eye: usize| {
        let before = shaft.counters();
        let mut from = Eye { own: &boxes[eye], thick: &thick[eye], places: &places, shaft, n_assumed: 0 };
        // Who sees whom is asked once, of the lower number.
        let later = asked.boxes.iter_ones(eye).filter(|&other| other > eye);
        let boxes = from.seen(&of_boxes, later, &blockers);
        let objects = from.seen(&of_objects, asked.objects.iter_ones(eye), &blockers);
        let n_assumed = from.n_assumed;
        options.progress.iter().for_each(|progress| progress(done.fetch_add(1, Relaxed) + 1, thick.len()));
        (boxes, objects, n_assumed, shaft.counters() - before)
    };
    let found: Vec<_> = on_threads(options.threads, |_| {
        (0..boxes.len()).into_par_iter().with_max_len(1).map_init(|| Shaft::new(&blockers), one).collect()
    });
    let mut answer = SeenFromBoxes {
        boxes: BitMatrix::new(boxes.len(), boxes.len()),
        objects: BitMatrix::new(boxes.len(), objects.len()),
        n_blockers: blockers.len(),
        n_assumed: 0,
        counters: ShaftCounters::default(),
    };
    for (eye, (boxes, objects, n_assumed, counters)) in found.into_iter().enumerate() {
        for other in boxes {
            answer.boxes.set(eye, other, true);
            answer.boxes.set(other, eye, true);
        }
        objects.into_iter().for_each(|object| answer.objects.set(eye, object, true));
        if asked.boxes.get(eye, eye) {
            answer.boxes.set(eye, eye, true);
        }
        answer.n_assumed += n_assumed;
        answer.counters = answer.counters + counters;
    }
    answer
}

/// Where boxes lie among the cells.
struct Places {
    all: Aabb<3>,
    /// Half of how thick a box is made, at least.
    thin: f64,
    extents: Vec<Aabb<3>>,
    tree: BoxTree<3>,
    /// For each cell, which cells it hangs together with through portals, as the least of them.
    component: Vec<u32>,
}

impl Places {
    fn new(graph: &CellGraph<Axial>) -> Self {
        let extents: Vec<Aabb<3>> = graph.cells().iter().map(|c| c.bounds).collect();
        let all = Aabb::<3>::around(extents.iter().flat_map(|b| [b.min, b.max]));
        let longest = (0..3).map(|k| all.max[k] - all.min[k]).fold(0.0, f64::max);
        let tree = BoxTree::build(&extents, 4);
        Self { all, thin: longest * THIN, extents, tree, component: components(graph) }
    }

    /// The box, and a little around it along axes on which it is too thin to be asked about.
    fn thickened(&self, b: &Aabb<3>) -> Aabb<3> {
        let mut thick = *b;
        for k in 0..3 {
            if b.max[k] - b.min[k] < self.thin {
                thick.min[k] = (b.min[k] - self.thin).next_down();
                thick.max[k] = (b.max[k] + self.thin).next_up();
            }
        }
        thick
    }

    fn holds(&self, b: &Aabb<3>) -> bool {
        self.all.contains(b.min) && self.all.contains(b.max)
    }

    /// The components of the cells that a box touches, ascending.
    fn components(&self, b: &Aabb<3>) -> Vec<u32> {
        let mut found = Vec::new();
        self.tree.visit(
            |node| touch(node, b),
            |cell| {
                if touch(&self.extents[cell as usize], b) {
                    found.push(self.component[cell as usize]);
                }
            },
        );
        found.sort_unstable();
        found.dedup();
        found
    }
}

/// What is asked about, all of one kind.
struct Targets<'a> {
    /// What has to be reached.
    boxes: &'a [Aabb<3>],
    /// What is seen if it is touched.
    own: &'a [Aabb<3>],
    target: Target,
    tree: BoxTree<3>,
    components: Vec<Vec<u32>>,
    /// Those that reach out of the cells.
    outside: Vec<bool>,
}

impl<'a> Targets<'a> {
    fn new(boxes: &'a [Aabb<3>], own: &'a [Aabb<3>], target: Target, places: &Places) -> Self {
        Self {
            boxes,
            own,
            target,
            tree: BoxTree::build(boxes, 1),
            components: own.par_iter().map(|b| places.components(b)).collect(),
            outside: own.iter().map(|b| !b.is_empty() && !places.holds(b)).collect(),
        }
    }

    /// Whether lines can reach it at all: not if it is empty, or, for objects, flat along two axes.
    fn can_be_reached(&self, i: usize) -> bool {
        let b = &self.boxes[i];
        !b.is_empty() && (0..3).filter(|&k| b.min[k] == b.max[k]).count() < 2
    }
}

/// A box that eyes are in, and its solver.
struct Eye<'a, 's, 'b> {
    own: &'a Aabb<3>,
    thick: &'a Aabb<3>,
    places: &'a Places,
    shaft: &'s mut Shaft<'b>,
    n_assumed: u64,
}

/// What is known of a target.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    NotAsked,
    InDoubt,
    Seen,
}

impl Eye<'_, '_, '_> {
    /// Those of the targets asked about that may be seen, ascending.
    fn seen(&mut self, targets: &Targets<'_>, asked: impl Iterator<Item = usize>, blockers: &Blockers) -> Vec<usize> {
        let mut states = vec![State::NotAsked; targets.boxes.len()];
        let all = !self.places.holds(self.own);
        let near = self.places.components(self.own);
        for i in asked {
            let at_once = all || targets.outside[i] || touch(self.own, &targets.own[i]);
            if at_once {
                states[i] = State::Seen;
            } else if targets.can_be_reached(i) && targets.components[i].iter().any(|c| near.binary_search(c).is_ok()) {
                states[i] = State::InDoubt;
            }
        }
        let mut stack = if targets.boxes.is_empty() { Vec::new() } else { vec![0u32] };
        while let Some(n) = stack.pop() {
            let node = &targets.tree.nodes()[n as usize];
            let within = &targets.tree.order()[node.start as usize..node.end as usize];
            let n_left = within.iter().filter(|&&i| states[i as usize] == State::InDoubt).count();
            if n_left == 0 {
                continue;
            }
            if node.is_leaf() {
                for &i in within.iter().filter(|&&i| states[i as usize] == State::InDoubt).collect::<Vec<_>>() {
                    states[i as usize] = self.settle(targets, i as usize);
                }
                continue;
            }
            // Of a group of which something is seen it is known that nothing hides it.
            let none_seen = || within.iter().all(|&i| states[i as usize] != State::Seen);
            if n_left > 1 && apart(self.thick, &node.bounds) && none_seen() {
                match self.shaft.decide(self.thick, &node.bounds, targets.target, GROUP_BUDGET) {
                    Sight::Blocked => {
                        within.iter().for_each(|&i| {
                            if states[i as usize] == State::InDoubt {
                                states[i as usize] = State::NotAsked;
                            }
                        });
                        continue;
                    }
                    Sight::Open(line) => {
                        let span = line.span(self.thick, &node.bounds, blockers);
                        for &i in within.iter().filter(|&&i| span.may_meet(&targets.boxes[i as usize])) {
                            let b = &targets.boxes[i as usize];
                            let met = match targets.target {
                                Target::Inside => span.passes_some_of(b),
                                Target::Surface => span.meets(b),
                            };
                            if met && states[i as usize] == State::InDoubt {
                                states[i as usize] = State::Seen;
                            }
                        }
                    }
                    Sight::Undecided => {}
                }
            }
            stack.extend(targets.tree.children(n));
        }
        (0..states.len()).filter(|&i| states[i] == State::Seen).collect()
    }

    fn settle(&mut self, targets: &Targets<'_>, i: usize) -> State {
        let target = &targets.boxes[i];
        if !apart(self.thick, target) {
            return State::Seen;
        }
        match self.shaft.decide(self.thick, target, targets.target, CELL_BUDGET) {
            Sight::Blocked => State::NotAsked,
            Sight::Open(_) => State::Seen,
            Sight::Undecided => {
                self.n_assumed += 1;
                State::Seen
            }
        }
    }
}
