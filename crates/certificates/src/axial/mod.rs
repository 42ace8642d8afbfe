//! Proofs of tables of scenes in space that were cut into boxes.
//!
//! *Visible* pairs are proven by lines, each followed exactly through the portals that it crosses. *Hidden* pairs are proven
//! for pairs of boxes, most of them around many cells: for each octant of directions a tree of rectangles shows that no line
//! gets past them ([`Branch`]). The rectangles are checked to be walls: no part of one is inside a cell, and no portal lies
//! in one. Each point of a line that goes from cell to cell through portals is inside a cell or a portal (unless the line
//! passes an edge, which no open set of lines does), so the line meets no wall. A pair of a cell and an *object* is proven hidden in the
//! same way, with lines that go from cell to cell and end on the object; or because every cell that the object touches is proven hidden, and
//! so no line gets there.

mod branch;
mod bytes;
mod make;
mod network;

pub use branch::{Branch, Bypass, Claim, Sum};
pub use make::{AxialMaker, CheckedProof};
pub use network::{AxialLine, AxialName, AxialNetwork, AxialNetworkError, AxialPortal, Box3, Point3};

use crate::pairs::{ObjectPairs, Pairs, ones};
use crate::proven::{NoWall, Proven, Refusal, joined_along};
use branch::Lines;
use network::{flat_axis, is_within};

/// A proof that no cell in one box sees a cell in another.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BoxProof {
    /// The two boxes.
    pub boxes: [AxialName; 2],
    /// Octants of directions from the first box to the second (bit `k`: towards larger coordinates on axis `k`), each with the
    /// reason why no line passes. Octants that are missing lead away from the second box.
    pub octants: Vec<(u8, Branch)>,
}

/// A proof that no cell in a box sees an object.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ObjectProof {
    /// The box.
    pub cells: AxialName,
    /// The index of the object.
    pub object: u32,
    /// As in [`BoxProof::octants`], from the box to the object's, with lines that end on its surface.
    pub octants: Vec<(u8, Branch)>,
}

/// Proofs of a table of boxes.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct AxialProofs {
    /// [`AxialNetwork::checksum`] of the cells and portals.
    pub checksum: u32,
    /// Lines that prove pairs visible.
    pub lines: Vec<AxialLine>,
    /// Rectangles that proofs name.
    pub blockers: Vec<AxialName>,
    /// Proofs that pairs of cells are hidden.
    pub boxes: Vec<BoxProof>,
    /// [`AxialNetwork::objects_checksum`] of the objects; 0 without proofs about any.
    pub objects_checksum: u32,
    /// Proofs that objects are hidden from cells, beside those that no line gets to because of the proofs about boxes.
    pub objects: Vec<ObjectProof>,
}

impl AxialProofs {
    /// Checks every proof, and returns what they prove together. Exact.
    ///
    /// Cost: O(blockers (cells + portals)) comparisons, and those of the proofs, with O(cells) for each proof of boxes, and
    /// O(objects cells) comparisons of boxes for what is out of reach. Memory: a
    /// few bits for each pair of cells, and one for each pair of a cell and an object.
    ///
    /// # Errors
    /// [`Refusal`] for proofs of another network and for the first proof that does not hold.
    pub fn check(&self, network: &AxialNetwork) -> Result<Proven, Refusal> {
        if self.checksum != network.checksum() {
            return Err(Refusal::OtherTable);
        }
        if !self.objects.is_empty() && self.objects_checksum != network.objects_checksum() {
            return Err(Refusal::OtherObjects);
        }
        let refusal = |index, line: &AxialLine| Refusal::Line { index, cell: line.cell };
        let visible = joined_along(network.n_cells(), &self.lines, |line| network.follow(line), refusal)?;
        let mut hidden = Pairs::none(network.n_cells());
        let mut blockers = Vec::with_capacity(self.blockers.len());
        for (index, name) in self.blockers.iter().enumerate() {
            let shape = Err(Refusal::Blocker { index, why: NoWall::Shape });
            let Some(rectangle) = network.named(name) else { return shape };
            if let Some(why) = no_wall(&rectangle, network) {
                return Err(Refusal::Blocker { index, why });
            }
            blockers.push(rectangle);
        }
        for (index, proof) in self.boxes.iter().enumerate() {
            let boxes = proof.boxes.map(|name| network.named(&name));
            let [Some(first), Some(second)] = boxes else { return Err(Refusal::Boxes { index }) };
            if !are_hidden([&first, &second], &proof.octants, &blockers) {
                return Err(Refusal::Boxes { index });
            }
            add_hidden([&first, &second], network, &mut hidden);
        }
        let mut hidden_objects = ObjectPairs::none(network.n_cells(), network.n_objects());
        for (index, proof) in self.objects.iter().enumerate() {
            let refusal = Refusal::Object { index, object: proof.object };
            let (Some(cells), Some(object)) = (network.named(&proof.cells), network.object(proof.object)) else {
                return Err(refusal);
            };
            if !is_object_hidden([&cells, object], &proof.octants, &blockers) {
                return Err(refusal);
            }
            add_hidden_object(&cells, proof.object, network, &mut hidden_objects);
        }
        add_out_of_reach(network, &hidden, &mut hidden_objects);
        Ok(Proven { hidden_objects, ..Proven::new(visible, hidden) })
    }
}

fn cells_within<'a>(b: &'a Box3, network: &'a AxialNetwork) -> impl Iterator<Item = u32> + 'a {
    (0u32..).zip(&network.cells).filter(|(_, cell)| is_within(cell, b)).map(|(id, _)| id)
}

/// Adds every pair of a cell in the box and the object.
fn add_hidden_object(cells: &Box3, object: u32, network: &AxialNetwork, hidden: &mut ObjectPairs) {
    cells_within(cells, network).for_each(|cell| {
        hidden.add(cell, object);
    });
}

/// Adds the objects that are out of reach: those of which all cells that they touch are hidden. A line to an object ends in the closed
/// box of a cell that it has passed; so of an open set of lines to it an open subset passes one of the cells that it touches.
fn add_out_of_reach(network: &AxialNetwork, hidden: &Pairs, hidden_objects: &mut ObjectPairs) {
    let touch = |a: &Box3, b: &Box3| (0..3).all(|k| a[0][k] <= b[1][k] && b[0][k] <= a[1][k]);
    for (object, around) in (0u32..).zip(&network.objects) {
        // A box with a coordinate that is none touches nothing, and is nowhere.
        if !(0..3).all(|k| around[0][k] <= around[1][k]) {
            continue;
        }
        let mut out_of_reach: Option<Vec<u64>> = None;
        for (cell, _) in (0u32..).zip(&network.cells).filter(|(_, cell)| touch(cell, around)) {
            let row = hidden.row(cell);
            match &mut out_of_reach {
                None => out_of_reach = Some(row.to_vec()),
                Some(all) => all.iter_mut().zip(row).for_each(|(all, word)| *all &= word),
            }
        }
        match out_of_reach {
            None => (0..network.n_cells() as u32).for_each(|cell| {
                hidden_objects.add(cell, object);
            }),
            Some(all) => ones(&all).for_each(|cell| {
                hidden_objects.add(cell, object);
            }),
        }
    }
}

/// Adds every pair of a cell in the first box and another in the second.
fn add_hidden([first, second]: [&Box3; 2], network: &AxialNetwork, hidden: &mut Pairs) {
    let within = |b| -> Vec<u32> { cells_within(b, network).collect() };
    let (firsts, seconds) = (within(first), within(second));
    for &a in &firsts {
        // A cell in both boxes still sees itself.
        seconds.iter().filter(|&&b| b != a).for_each(|&b| hidden.add(a, b));
    }
}

/// Whether for every octant no line leads from inside of the first box to inside of the second past the blockers.
fn are_hidden(boxes: [&Box3; 2], octants: &[(u8, Branch)], blockers: &[Box3]) -> bool {
    for_all_octants(octants, |forward| Lines::new(boxes, blockers, forward))
}

/// Whether for every octant no line leads from inside of the first box to the surface of the second past the blockers.
fn is_object_hidden(boxes: [&Box3; 2], octants: &[(u8, Branch)], blockers: &[Box3]) -> bool {
    for_all_octants(octants, |forward| Lines::new(boxes, blockers, forward).ending_on_surface())
}

fn for_all_octants<'a>(octants: &[(u8, Branch)], lines: impl Fn([bool; 3]) -> Lines<'a>) -> bool {
    (0..8u8).all(|octant| {
        let mut lines = lines([0, 1, 2].map(|k| octant >> k & 1 == 1));
        let mut own = octants.iter().filter(|(o, _)| *o == octant);
        lines.lead_away() || own.any(|(_, branch)| lines.none_left(branch))
    })
}

/// Why a rectangle is no wall, so lines from cell to cell through portals might pass it; `None` if it is a wall. Exact.
fn no_wall(rectangle: &Box3, network: &AxialNetwork) -> Option<NoWall> {
    let Some(axis) = flat_axis(rectangle) else { return Some(NoWall::Shape) };
    let at = rectangle[0][axis];
    let overlap = |b: &Box3| (0..3).all(|k| k == axis || (b[0][k] < rectangle[1][k] && rectangle[0][k] < b[1][k]));
    let through = |b: &Box3| b[0][axis] < at && at < b[1][axis] && overlap(b);
    let inside = |p: &Box3| flat_axis(p) == Some(axis) && p[0][axis] == at && overlap(p);
    let cell = (0u32..).zip(&network.cells).find(|(_, b)| through(b)).map(|(id, _)| NoWall::Cell(id));
    let portal = || (0u32..).zip(&network.portals).find(|(_, p)| inside(&p.extent)).map(|(id, _)| NoWall::Portal(id));
    cell.or_else(portal)
}
