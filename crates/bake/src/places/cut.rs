//! Cutting a region into places, the most worthwhile cut first.

use super::views::{Cut, Views};
use super::{PlaceSummary, Places, n_boxes};
use sightlines_cells::Scene;
use sightlines_geometry::Aabb;
use sightlines_kdtree::{Matter, SceneOptions};
use sightlines_progress::{Cancelled, Observer, Progress, Work};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Parts of a side that are looked at for solid matter, apart from walls.
const SLABS: u32 = 16;

/// A box is not cut thinner than this share of the longest side of the region.
const THINNEST: f64 = 1.0 / (1u64 << 20) as f64;

pub(super) struct Cutter<'a> {
    scene: &'a Scene,
    /// None if the insides of solid things stay.
    matter: Option<Matter>,
    goal: Goal,
    progress: Option<&'a dyn Observer>,
}

/// How far to cut.
#[derive(Debug, Clone, Copy)]
pub(super) struct Goal {
    /// How many cells to make.
    pub(super) n_cells: usize,
    /// Whether boxes are halved where no cut pays, rather than that there are fewer cells.
    pub(super) all: bool,
    /// Longer boxes are cut first.
    pub(super) cell_size: f64,
    /// Whether no cell may be longer, so that there may be more cells.
    pub(super) is_bound: bool,
    /// The most cells.
    pub(super) max_cells: u32,
}

/// Why cutting ends without places.
pub(super) enum Stop {
    /// More cells than the limit.
    TooMany,
    /// The observer cancelled.
    Cancelled(Cancelled),
}

/// A box that may be cut.
struct Leaf {
    bounds: Aabb<3>,
    /// The longest side, by the bound on it, if that is above 1.
    too_long: f64,
    /// How much the cut pays: objects that viewers are spared, weighted.
    worth: f64,
    /// The longest side.
    side: f64,
    /// The fewest cells that it becomes, unless some of it is solid: more than one only where there is a bound on the sides of cells.
    needs: f64,
    cut: Option<Cut>,
    /// Its place in the tree: nodes are numbered as they are made.
    node: usize,
}

/// A node of the tree of all boxes.
enum Node {
    Place(Aabb<3>),
    Divided([usize; 2]),
    Solid,
}

impl Ord for Leaf {
    fn cmp(&self, other: &Self) -> Ordering {
        let by_length = self.too_long.total_cmp(&other.too_long);
        let by_worth = by_length.then(self.worth.total_cmp(&other.worth));
        by_worth.then(self.side.total_cmp(&other.side)).then(other.node.cmp(&self.node))
    }
}

impl PartialOrd for Leaf {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Leaf {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Leaf {}

fn report(progress: Option<&dyn Observer>, now: Progress) -> Result<(), Cancelled> {
    let is_cancelled = progress.is_some_and(|observer| observer.report(now).is_break());
    if is_cancelled { Err(Cancelled) } else { Ok(()) }
}

/// How far cutting is. Counts cuts, which are never taken back; the number of cells is no measure, as it falls where both halves of a box turn
/// out to be solid.
struct Cuts<'a> {
    progress: Option<&'a dyn Observer>,
    n_done: u64,
    /// The largest share that was reported.
    share: f64,
}

impl Cuts<'_> {
    /// Reports that at least `n_left` more cuts are needed, by what is known now. Solid halves, and cuts that leave more than the fewest boxes,
    /// raise that number; the share then stays until it is reached again.
    fn report(&mut self, n_left: u64) -> Result<(), Cancelled> {
        let now = Progress::new("cuts", self.n_done, self.n_done.saturating_add(n_left)).of(Work::Cutting);
        self.share = self.share.max(now.share);
        report(self.progress, now.with_share(self.share))
    }
}

fn longest_side(b: &Aabb<3>) -> (usize, f64) {
    let side = |k: usize| b.max[k] - b.min[k];
    let axis = (1..3).fold(0, |best, k| if side(k) > side(best) { k } else { best });
    (axis, side(axis))
}

impl<'a> Cutter<'a> {
    /// Finds what is solid, which takes a while for large scenes.
    pub(super) fn new(
        scene: &'a Scene,
        options: &SceneOptions,
        goal: Goal,
        progress: Option<&'a dyn Observer>,
    ) -> Result<Self, Cancelled> {
        report(progress, Progress::new("solid matter", 0, 1).of(Work::Cutting))?;
        let matter = (!options.keep_solid).then(|| Matter::of(scene));
        Ok(Self { scene, matter, goal, progress })
    }

    /// Cuts `region` into places.
    pub(super) fn run(&self, region: Aabb<3>) -> Result<Places, Stop> {
        let mut cuts = Cuts { progress: self.progress, n_done: 0, share: 0.0 };
        let places = self.cut(region, &mut cuts)?;
        // Where no more cuts pay, fewer are made than were thought to be needed.
        cuts.report(0).map_err(Stop::Cancelled)?;
        Ok(places)
    }

    fn cut(&self, region: Aabb<3>, cuts: &mut Cuts<'_>) -> Result<Places, Stop> {
        let views = Views::of(self.scene, &region);
        let thinnest = longest_side(&region).1 * THINNEST;
        let mut summary = PlaceSummary::default();
        let mut nodes = vec![Node::Solid];
        let whole = self.place(&views, region, &mut summary).unwrap_or(region);
        let first = self.leaf(&views, whole, 0, &mut nodes);
        let mut needed = first.needs;
        let mut queue = BinaryHeap::from([first]);
        let mut n_done = 0;
        while let Some(leaf) = queue.pop() {
            let n_cells = n_done + queue.len() + 1;
            let n_left = needed.max(self.goal.n_cells as f64) - n_cells as f64;
            cuts.report(n_left as u64).map_err(Stop::Cancelled)?;
            let is_enough = n_cells >= self.goal.n_cells;
            let full = is_enough && !(self.goal.is_bound && leaf.too_long > 0.0);
            let Some(cut) = leaf.cut.filter(|_| !full) else {
                n_done += 1;
                needed -= leaf.needs - 1.0;
                continue;
            };
            let halves = halves(&leaf.bounds, cut.axis, cut.at);
            if halves.iter().any(|half| half.max[cut.axis] - half.min[cut.axis] < thinnest) {
                n_done += 1;
                needed -= leaf.needs - 1.0;
                continue;
            }
            let counted = if cut.gain == 0.0 {
                &mut summary.n_by_size
            } else if cut.wall {
                &mut summary.n_along_walls
            } else {
                &mut summary.n_by_views
            };
            *counted += 1;
            cuts.n_done += 1;
            needed -= leaf.needs;
            let children = [nodes.len(), nodes.len() + 1];
            nodes.extend([Node::Solid, Node::Solid]);
            nodes[leaf.node] = Node::Divided(children);
            for (half, node) in halves.into_iter().zip(children) {
                if let Some(place) = self.place(&views, half, &mut summary) {
                    let leaf = self.leaf(&views, place, node, &mut nodes);
                    needed += leaf.needs;
                    queue.push(leaf);
                }
            }
            if n_done + queue.len() > self.goal.max_cells as usize {
                return Err(Stop::TooMany);
            }
        }
        let cells = in_order(&nodes);
        // Where nothing is a place, all is one.
        if cells.is_empty() && self.matter.is_some() {
            return Self { matter: None, ..*self }.cut(region, cuts);
        }
        summary.n_cells = cells.len();
        summary.cell_size = cells.iter().map(|cell| longest_side(cell).1).fold(0.0, f64::max);
        Ok(Places { cells, summary })
    }

    fn leaf(&self, views: &Views, bounds: Aabb<3>, node: usize, nodes: &mut [Node]) -> Leaf {
        nodes[node] = Node::Place(bounds);
        let Goal { cell_size, all, is_bound, .. } = self.goal;
        let (axis, side) = longest_side(&bounds);
        let too_long = if side > cell_size { side / cell_size } else { 0.0 };
        let mut cut = views.best_cut(&bounds);
        let worth = cut.map_or(0.0, |cut| cut.gain * volume(&bounds).sqrt());
        if (too_long > 0.0 && cut.is_none_or(|cut| cut.axis != axis)) || (all && cut.is_none()) {
            // As many parts as the bound needs, in equal halves or nearly so.
            let parts = too_long.ceil().max(2.0);
            let at = bounds.min[axis] + side * ((parts / 2.0).floor() / parts);
            cut = Some(Cut { axis, at, wall: false, gain: 0.0 });
        }
        let needs = if is_bound { n_boxes(&bounds, cell_size).max(1.0) } else { 1.0 };
        Leaf { bounds, too_long, worth, side, needs, cut, node }
    }

    /// A box without the sides of it that are in solid matter, or behind the backs of things; none if all is.
    fn place(&self, views: &Views, bounds: Aabb<3>, summary: &mut PlaceSummary) -> Option<Aabb<3>> {
        let Some(matter) = &self.matter else { return Some(bounds) };
        let Some(before) = views.before_fronts(&bounds) else {
            summary.n_behind += 1;
            return None;
        };
        summary.n_behind += (0..3)
            .map(|k| usize::from(before.min[k] > bounds.min[k]) + usize::from(before.max[k] < bounds.max[k]))
            .sum::<usize>();
        let bounds = before;
        if matter.holds(&bounds) {
            summary.n_solid += 1;
            return None;
        }
        let mut place = bounds;
        for axis in 0..3 {
            let (low, side) = (place.min[axis], place.max[axis] - place.min[axis]);
            let mut ends: Vec<f64> = (1..SLABS).map(|i| low + side * (f64::from(i) / f64::from(SLABS))).collect();
            ends.extend(views.walls_in(axis, &place));
            ends.retain(|at| place.min[axis] < *at && *at < place.max[axis]);
            ends.sort_by(f64::total_cmp);
            ends.dedup();
            // A part of a slab in solid matter is in it too.
            let [below, above] = [0, 1].map(|side| {
                let held = |at: &f64| matter.holds(&halves(&place, axis, *at)[side]);
                if side == 0 { ends.partition_point(held) } else { ends.len() - ends.partition_point(|at| !held(at)) }
            });
            // Both together cannot be all of it: that would be solid as a whole, unless two objects share it.
            if below + above <= ends.len() {
                if below > 0 {
                    place.min[axis] = ends[below - 1];
                    summary.n_solid += 1;
                }
                if above > 0 {
                    place.max[axis] = ends[ends.len() - above];
                    summary.n_solid += 1;
                }
            }
        }
        Some(place)
    }
}

fn volume(b: &Aabb<3>) -> f64 {
    (0..3).map(|k| b.max[k] - b.min[k]).product()
}

/// The parts of a box below and above a coordinate.
fn halves(b: &Aabb<3>, axis: usize, at: f64) -> [Aabb<3>; 2] {
    let (mut low, mut high) = (*b, *b);
    (low.max[axis], high.min[axis]) = (at, at);
    [low, high]
}

/// The places of a tree, depth-first, low before high.
fn in_order(nodes: &[Node]) -> Vec<Aabb<3>> {
    let (mut out, mut stack) = (Vec::new(), vec![0]);
    while let Some(node) = stack.pop() {
        match &nodes[node] {
            Node::Place(bounds) => out.push(*bounds),
            Node::Divided([low, high]) => stack.extend([*high, *low]),
            Node::Solid => {}
        }
    }
    out
}
