//! Whether lines that leave a box through a part of one of its sides reach an object: one search for all triangles of the object.
//!
//! A question is a rectangle times a node of the object's tree, a triangle, or a piece of one. If no chain blocks all lines of it, it is cut
//! in the rectangle or in the object, as the gap suggests; the parts begin with the chain that did best for the whole. What is blocked for a
//! node is not asked again for its triangles. Depth first, so that few questions wait, and a search that fails knows the triangle at which
//! it did.

use crate::cell::Cell;
use crate::chain::{AtFold, Blocked, ChainFinder, Gap, Shaft};
use crate::end::End;
use crate::marks::Marks;
use crate::method::with_area;
use crate::roots::{Planes, beyond, start_at};
use crate::search::{AT_END, MOST_BEYOND_FOLD};
use crate::side::{Limit, Part, Side};
use crate::split::{promise, split, split_at};
use crate::surface::{Hit, Surface};
use crate::touch::Target;
use sightlines_geometry::{Aabb, BoxTree, Point3, Random, check_coordinate};
use sightlines_multifocal::mesh::collinear;
use std::sync::Arc;

/// What lines are to reach: triangles, in a tree.
#[derive(Debug, Clone)]
pub struct FaceTarget {
    triangles: Vec<[Point3; 3]>,
    tree: BoxTree<3>,
    bounds: Aabb<3>,
}

impl FaceTarget {
    /// Of triangles; one without area counts as a thin box. None if there are none, or coordinates that predicates cannot take. O(n log n).
    pub fn new(triangles: &[[Point3; 3]]) -> Option<Self> {
        let mut all = Vec::with_capacity(triangles.len());
        for &t in triangles {
            let [a, b, c] = t;
            if t.iter().flatten().any(|&x| check_coordinate(x).is_err()) {
                return None;
            }
            if collinear(a, b, c) { all.extend(sides_of(&Aabb::around(t))?) } else { all.push(t) }
        }
        Self::of(all)
    }

    /// Of a box, of which lines have to reach a side.
    pub fn of_box(bounds: &Aabb<3>) -> Option<Self> {
        Self::of(sides_of(bounds)?)
    }

    fn of(triangles: Vec<[Point3; 3]>) -> Option<Self> {
        let boxes: Vec<Aabb<3>> = triangles.iter().map(|t| Aabb::around(*t)).collect();
        let bounds = boxes.iter().copied().reduce(|a, b| a.with(b.min).with(b.max))?;
        let tree = BoxTree::build(&boxes, 4);
        Some(Self { triangles, tree, bounds })
    }

    /// Around all triangles.
    pub fn bounds(&self) -> &Aabb<3> {
        &self.bounds
    }

    /// The triangles.
    pub fn triangles(&self) -> &[[Point3; 3]] {
        &self.triangles
    }
}

/// The sides of a box that have an area, as triangles; thicker where it has no area at all. None for coordinates that predicates cannot take.
fn sides_of(b: &Aabb<3>) -> Option<Vec<[Point3; 3]>> {
    let b = with_area(b)?;
    let mut out = Vec::with_capacity(12);
    for axis in 0..3 {
        for at in [b.min[axis], b.max[axis]] {
            let (mut low, mut high) = (b.min, b.max);
            (low[axis], high[axis]) = (at, at);
            let Some(side) = End::rectangle(&Aabb { min: low, max: high }, axis) else { continue };
            let [p, q, r, s] = [0, 1, 2, 3].map(|i| side.corners()[i]);
            out.extend([[p, q, r], [p, r, s]]);
        }
    }
    Some(out)
}

/// Lines that leave a box through a part of one of its sides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FaceExit {
    /// The box.
    pub volume: Aabb<3>,
    /// The axis across which the side is.
    pub axis: usize,
    /// Whether it is the upper side.
    pub upward: bool,
    /// The part of the side, flat along the axis.
    pub part: Aabb<3>,
}

impl FaceExit {
    /// Whether a box has points strictly beyond the plane of the side. If not, no line to it leaves through this side.
    pub fn faces(&self, target: &Aabb<3>) -> bool {
        faces(self.axis, self.upward, self.at(), target)
    }

    fn at(&self) -> f64 {
        if self.upward { self.volume.max[self.axis] } else { self.volume.min[self.axis] }
    }
}

fn faces(axis: usize, upward: bool, at: f64, target: &Aabb<3>) -> bool {
    if upward { target.max[axis] > at } else { target.min[axis] < at }
}

/// How much is done for one question at most. More finds more hidden, as a rule; nothing is ever hidden wrongly.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FaceEffort {
    /// Cells of line space.
    pub cells: u32,
    /// Cells of line space in a row for one triangle.
    pub triangle_cells: u32,
    /// How many triangles that a line hits are tried as starts of chains.
    pub attempts: usize,
    /// A chain that blocks at least this share of the lines is taken without trying others.
    pub enough: f64,
}

impl Default for FaceEffort {
    fn default() -> Self {
        Self { cells: 200, triangle_cells: 100, attempts: 4, enough: 0.5 }
    }
}

/// Why lines were not found to be blocked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unblocked {
    /// The triangle of the target at which the search ended, if it was about a single one.
    pub triangle: Option<u32>,
    /// A line that meets nothing, as doubles have it, and ends at the target.
    pub line: Option<[Point3; 2]>,
}

/// The object's part of a question.
#[derive(Debug, Clone, Copy)]
enum Piece {
    Node(u32),
    Triangle(u32, End),
}

/// A question that waits.
#[derive(Debug, Clone, Copy)]
struct Question {
    from: End,
    to: Piece,
    limit: Option<Limit>,
    /// Where the chain began that did best for the question of which this is a part.
    hint: Option<u32>,
    /// The edge at which it was cut out of that.
    cut_at: Option<u32>,
}

/// What a chain, or none, made of a question.
enum Answer {
    Blocked(Blocked),
    Free,
    Open(Gap),
}

/// The search, with its memory. What it finds does not depend on the objects asked about before, once it [forgets](Self::forget) them.
#[derive(Debug)]
pub struct FaceSearch {
    surface: Arc<Surface>,
    finder: ChainFinder,
    waiting: Vec<Question>,
    hits: Vec<Hit>,
    folding: Vec<u32>,
    /// How often chains blocked all lines of a cell, by the triangle where they began.
    successes: Marks<u32>,
    /// Where the chain began that blocked last.
    last: Option<u32>,
    n_cells: u64,
}

impl FaceSearch {
    /// For a surface that others use as well, with chains of at most so many triangles. O(n).
    pub fn new(surface: Arc<Surface>, longest_chain: usize) -> Self {
        let finder = ChainFinder::new(&surface, longest_chain);
        let successes = Marks::new(surface.mesh().triangles().len());
        let (waiting, hits, folding) = (Vec::new(), Vec::new(), Vec::new());
        Self { surface, finder, waiting, hits, folding, successes, last: None, n_cells: 0 }
    }

    /// Forgets where chains that blocked lines began.
    pub fn forget(&mut self) {
        self.successes.forget();
        self.last = None;
    }

    /// How many cells of line space were tested until now.
    pub const fn n_cells(&self) -> u64 {
        self.n_cells
    }

    /// Whether all lines are blocked that begin anywhere in the box, leave it through the part of its side, and end on the target, or on one of
    /// its triangles, beyond the plane of the side. Exact: `Ok` is never wrong. The box has a volume, and does not meet that of the target.
    ///
    /// * `leave_out`: triangles of the target that do not count
    ///
    /// # Errors
    /// [`Unblocked`] if that was not found: some may be free, or it takes more than the effort allowed.
    pub fn is_blocked(
        &mut self,
        exit: &FaceExit,
        target: &FaceTarget,
        only: Option<u32>,
        leave_out: &dyn Fn(u32) -> bool,
        effort: &FaceEffort,
    ) -> Result<(), Unblocked> {
        let undecided = Unblocked { triangle: None, line: None };
        let usable = |x: &f64| check_coordinate(*x).is_ok();
        let volume = &exit.volume;
        if !volume.min.iter().chain(&volume.max).all(usable) || !(0..3).all(|k| volume.min[k] < volume.max[k]) {
            return Err(undecided);
        }
        let from = End::rectangle(&exit.part, exit.axis).ok_or(undecided)?;
        self.finder.look_from(volume);
        self.waiting.clear();
        let first = Question { from, to: Piece::Node(0), limit: None, hint: self.last, cut_at: None };
        match only {
            None => self.waiting.push(first),
            Some(t) => self.add_triangle(exit, target, &first, t),
        }
        self.run(exit, target, leave_out, effort)
    }

    /// Adds a triangle of the target as far as it is beyond the side.
    fn add_triangle(&mut self, exit: &FaceExit, target: &FaceTarget, of: &Question, t: u32) {
        let pieces = End::beyond(target.triangles[t as usize], exit.axis, exit.at(), exit.upward);
        self.waiting.extend(pieces.map(|piece| Question { to: Piece::Triangle(t, piece), ..*of }));
    }

    /// Cuts a node into its children, or its triangles.
    fn cut_node(
        &mut self,
        exit: &FaceExit,
        target: &FaceTarget,
        of: &Question,
        n: u32,
        leave_out: &dyn Fn(u32) -> bool,
    ) {
        let node = &target.tree.nodes()[n as usize];
        if node.is_leaf() {
            for &t in &target.tree.order()[node.start as usize..node.end as usize] {
                if !leave_out(t) {
                    self.add_triangle(exit, target, of, t);
                }
            }
            return;
        }
        let children = target.tree.children(n);
        self.waiting.extend(children.into_iter().rev().map(|child| Question { to: Piece::Node(child), ..*of }));
    }

    fn run(
        &mut self,
        exit: &FaceExit,
        target: &FaceTarget,
        leave_out: &dyn Fn(u32) -> bool,
        effort: &FaceEffort,
    ) -> Result<(), Unblocked> {
        let surface = self.surface.clone();
        let surface = &*surface;
        let start = start_at(&exit.volume, exit.axis, exit.upward);
        let mut random = Random::new(1);
        let (mut n, mut same, mut n_same) = (0, None, 0);
        while let Some(question) = self.waiting.pop() {
            let triangle = match question.to {
                Piece::Node(k) => {
                    let node = &target.tree.nodes()[k as usize];
                    if !faces(exit.axis, exit.upward, exit.at(), &node.bounds) {
                        continue;
                    }
                    if node.is_leaf() {
                        let all = &target.tree.order()[node.start as usize..node.end as usize];
                        if all.iter().filter(|&&t| !leave_out(t)).count() < 2 {
                            self.cut_node(exit, target, &question, k, leave_out);
                            continue;
                        }
                    }
                    None
                }
                Piece::Triangle(t, _) => Some(t),
            };
            let failed = Unblocked { triangle, line: None };
            if n == effort.cells {
                return Err(failed);
            }
            n += 1;
            self.n_cells += 1;
            if triangle.is_some() {
                n_same = if same == triangle { n_same + 1 } else { 1 };
                same = triangle;
                if n_same > effort.triangle_cells {
                    return Err(failed);
                }
            }
            let Some((cell, end)) = cell_of(exit, target, &question) else {
                // Not apart along any axis.
                let Piece::Node(k) = question.to else { return Err(failed) };
                self.cut_node(exit, target, &question, k, leave_out);
                continue;
            };
            if cell.from.counts_for_nothing(|t| surface.corners(t)) {
                continue;
            }
            let Some(mut shaft) = Shaft::new(cell, start, &end, surface, &mut random) else { return Err(failed) };
            let cell = shaft.cell;
            let side = question.limit.map(|limit| Side::new(&cell, limit));
            let side = match side.map(|side| (side, side.part())) {
                Some((_, Part::None)) => continue,
                Some((side, Part::Some)) => Some(side),
                // Asks a little more, never less.
                Some((_, Part::All)) | None => None,
            };
            let mut question = Question { from: cell.from, limit: side.map(|side| side.limit), ..question };
            let is_ready = side.is_none_or(|side| shaft.limit(side, &mut random));
            // If they may not be connected, or no line of them is found, all lines are looked at: a little more.
            let enough = if is_ready { effort.enough } else { f64::INFINITY };
            let answer = match self.block(surface, &shaft, &end, &mut question, &FaceEffort { enough, ..*effort }) {
                Answer::Blocked(Blocked::Side { .. }) | Answer::Free if !is_ready => Answer::Open(Gap::Other),
                answer => answer,
            };
            let gap = match answer {
                Answer::Blocked(Blocked::All) => continue,
                Answer::Blocked(Blocked::Side { limit, .. }) => {
                    self.waiting.push(Question { limit: Some(limit.opposite()), ..question });
                    continue;
                }
                Answer::Free if triangle.is_some() => return Err(Unblocked { line: Some(shaft.line), ..failed }),
                Answer::Free => Gap::Other,
                Answer::Open(gap) => gap,
            };
            let parts = match question.limit {
                Some(limit) if !is_ready => split_at(&shaft, &limit),
                _ => split(surface, &shaft, &gap),
            };
            question.cut_at = if let Gap::Edge { edge, .. } = gap { Some(edge) } else { None };
            match (question.to, parts) {
                (Piece::Node(k), parts) => {
                    let of = |part: Cell| (part.from != cell.from).then_some(Question { from: part.from, ..question });
                    let n = self.waiting.len();
                    self.waiting.extend(parts.into_iter().flatten().flatten().filter_map(of));
                    if self.waiting.len() == n {
                        self.cut_node(exit, target, &question, k, leave_out);
                    }
                }
                (Piece::Triangle(..), None) => return Err(failed),
                (Piece::Triangle(t, _), Some(parts)) => {
                    let of = |part: Cell| Question { from: part.from, to: Piece::Triangle(t, part.to), ..question };
                    self.waiting.extend(parts.into_iter().flatten().map(of));
                }
            }
        }
        Ok(())
    }

    /// Blocks the lines of a cell, or those on one side of an edge, by one of several chains, the one from the hint first; or says where best
    /// to cut.
    fn block(
        &mut self,
        surface: &Surface,
        shaft: &Shaft,
        target: &Target,
        question: &mut Question,
        effort: &FaceEffort,
    ) -> Answer {
        self.finder.next_cell();
        self.folding.clear();
        let (mut best, mut most) = ((f64::NEG_INFINITY, Gap::Other), None::<(f64, Blocked, u32)>);
        let Question { hint, cut_at, .. } = question;
        let first = hint.filter(|&t| self.finder.blocks(surface, shaft, t));
        let mut is_free = false;
        for is_hinted in [true, false] {
            if is_hinted {
                self.hits.clear();
                self.hits.extend(first.map(|triangle| Hit { at: 0.0, triangle }));
            } else {
                self.look(surface, shaft);
                is_free = self.hits.iter().all(|hit| hit.at > 1.0 - AT_END);
                if is_free {
                    break;
                }
                let is_level = |t: u32| target.is_level_with(&surface.corners(t));
                self.hits.retain(|hit| Some(hit.triangle) != first && !is_level(hit.triangle));
                self.hits.truncate(effort.attempts);
            }
            for k in 0..self.hits.len() {
                let start = self.hits[k].triangle;
                match self.finder.block(surface, shaft, target, start, AtFold::Leave) {
                    Ok(Blocked::All) => {
                        let n = self.successes.get(start).unwrap_or_default();
                        self.successes.set(start, n.saturating_add(1));
                        (*hint, self.last) = (Some(start), Some(start));
                        return Answer::Blocked(Blocked::All);
                    }
                    Ok(part @ Blocked::Side { share, .. }) => {
                        if most.is_none_or(|most| share > most.0) {
                            most = Some((share, part, start));
                        }
                        if share >= effort.enough {
                            *hint = Some(start);
                            return Answer::Blocked(part);
                        }
                    }
                    Err(failure) => {
                        if failure.can_fold {
                            self.folding.push(start);
                        }
                        // To cut at the same edge again and again converges to lines that touch it.
                        let is_again = matches!(failure.gap, Gap::Edge { edge, .. } if Some(edge) == *cut_at);
                        let promise = promise(surface, shaft, &failure.gap) - f64::from(u8::from(is_again));
                        if promise > best.0 {
                            best = (promise, failure.gap);
                            *hint = Some(start);
                        }
                    }
                }
            }
        }
        if let Some((_, part, start)) = most {
            *hint = Some(start);
            return Answer::Blocked(part);
        }
        if is_free {
            return Answer::Free;
        }
        for k in 0..self.folding.len() {
            let start = self.folding[k];
            if let Ok(blocked) = self.finder.block(surface, shaft, target, start, AtFold::Follow(MOST_BEYOND_FOLD)) {
                *hint = Some(start);
                return Answer::Blocked(blocked);
            }
        }
        Answer::Open(best.1)
    }

    /// What the middle line meets, the most promising starts of chains first.
    fn look(&mut self, surface: &Surface, shaft: &Shaft) {
        surface.hits(shaft.line[0], shaft.line[1], &mut self.hits);
        let finder = &mut self.finder;
        self.hits.retain(|hit| finder.blocks(surface, shaft, hit.triangle));
        let successes = |hit: &Hit| self.successes.get(hit.triangle).unwrap_or_default();
        self.hits.sort_unstable_by(|a, b| {
            let by_success = successes(b).cmp(&successes(a));
            let by_area = || surface.area(b.triangle).total_cmp(&surface.area(a.triangle));
            by_success.then_with(by_area).then(a.triangle.cmp(&b.triangle)).then(a.at.total_cmp(&b.at))
        });
        self.hits.dedup_by_key(|hit| hit.triangle);
    }
}

/// The lines of a question, and what they end at; none if the rectangle and the node are not apart along any axis.
fn cell_of(exit: &FaceExit, target: &FaceTarget, question: &Question) -> Option<(Cell, Target)> {
    match question.to {
        Piece::Node(n) => {
            let (node, from) = (&target.tree.nodes()[n as usize].bounds, question.from.bounds());
            let planes = Planes::between(from, node)?;
            let to = planes.crossed_at(&from.corners(), &node.corners(), 1)?;
            let to = beyond(to, exit.axis, exit.at(), exit.upward)?;
            Some((Cell { from: question.from, to: End::rectangle(&to, planes.axis)? }, Target::Box))
        }
        Piece::Triangle(t, to) => {
            Some((Cell { from: question.from, to }, Target::Triangle(target.triangles[t as usize])))
        }
    }
}
