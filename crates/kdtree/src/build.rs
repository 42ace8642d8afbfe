//! The subdivision itself: cells are divided until no plane is worth a cut.

use crate::error::KdError;
use crate::face::AxialFace;
use crate::portals::portals_of;
use crate::ranks::{Piece, RankBox, Ranks};
use crate::region::{Rect, covers, uncovered, unite};
use crate::skeleton::{RankNode, Skeleton};
use crate::split::choose;
use crate::tree::{AxialCell, AxialTree};
use sightlines_geometry::{Aabb, check_coordinate};
use sightlines_pvs::CellId;

/// How to subdivide.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KdOptions {
    /// Obscuration threshold, from 0 to 1: a plane divides a cell only if its faces cover at least
    /// this share of the cell's cross-section. Faces on planes that divide nothing are detail: they do not hide, so a
    /// larger threshold shows more. It usually gives fewer cells too, but not at every step: without one plane, a worse
    /// one may be chosen first.
    ///
    /// 0 follows every face and is exact; it is the default. A plane that is covered completely
    /// divides at any threshold; that is decided exactly. Other shares are compared in rounded
    /// arithmetic, with ties towards dividing.
    pub tau: f64,
    /// Gives up with [`KdError::TooManyCells`] beyond this many cells. n crossing walls may make n²/4
    /// cells; each takes about a hundred bytes.
    pub max_cells: u32,
}

impl Default for KdOptions {
    fn default() -> Self {
        Self { tau: 0.0, max_cells: 1 << 24 }
    }
}

/// Smallest box around all `faces`; empty for none.
pub fn bounds_of<const D: usize>(faces: &[AxialFace<D>]) -> Aabb<D> {
    Aabb::around(faces.iter().flat_map(|f| [f.min, f.max]))
}

/// Cuts `bounds` into axial cells along `faces`, and finds the portals between them.
///
/// * `faces`: in any order; they may overlap, cross, touch and repeat. What is outside of `bounds` is
///   cut off.
/// * `bounds`: the root cell, of positive extent along every axis; [`bounds_of`] gives the smallest one
///   that needs no cutting. It is convex, so no line leaves it between two points inside, and what is
///   outside cannot matter to what is seen inside. Outside there are no cells.
///
/// Errs towards "visible", see [`KdOptions::tau`]; with `tau` 0 it is exact.
///
/// Cost: O(n log n) to compress coordinates, then O(n) for each level of the tree: O(n log n) where the
/// tree is balanced, O(n * depth) at worst, for n pieces of faces.
///
/// # Errors
/// [`KdError`], with the index of the face; never because of how faces lie to each other, except for
/// [`KdError::TooManyCells`].
///
/// # Source
/// Teller and Séquin, SIGGRAPH 1991. Our own: coplanar faces are united before they are counted; the order of ties.
pub fn subdivide<const D: usize>(
    faces: &[AxialFace<D>],
    bounds: Aabb<D>,
    options: &KdOptions,
) -> Result<AxialTree<D>, KdError> {
    subdivide_with(&Cuts { walls: faces, open: &[], dividers: &[] }, bounds, options)
}

/// What a box is cut along.
pub(crate) struct Cuts<'a, const D: usize> {
    /// What hides from both sides.
    pub(crate) walls: &'a [AxialFace<D>],
    /// What divides as walls do, and leaves portals open.
    pub(crate) open: &'a [AxialFace<D>],
    /// Rectangles that hide nothing: where those of a plane cover the whole cross-section of a cell that nothing else divides any more, they
    /// divide it.
    pub(crate) dividers: &'a [AxialFace<D>],
}

/// As [`subdivide`].
pub(crate) fn subdivide_with<const D: usize>(
    cuts: &Cuts<'_, D>,
    bounds: Aabb<D>,
    options: &KdOptions,
) -> Result<AxialTree<D>, KdError> {
    const { assert!(D == 2 || D == 3, "axial subdivisions have two or three dimensions") };
    let bounds = checked_bounds(bounds)?;
    let [walls, open, dividers] = [cuts.walls, cuts.open, cuts.dividers].map(checked_faces);
    let (walls, open, dividers) = (walls?, open?, dividers?);
    if !(0.0..=1.0).contains(&options.tau) {
        return Err(KdError::Tau(options.tau));
    }
    let (ranks, [walls, open, dividers]) = Ranks::compress([&walls, &open, &dividers], &bounds);
    let (pieces, dividers) = (with_open(united(walls), &united(open)), united(dividers));
    let builder = Builder { ranks: &ranks, dividers: &dividers, options, n_cells: 0, skeleton: Skeleton::new() };
    let skeleton = builder.run(pieces)?;
    let portals = portals_of(&ranks, &skeleton);
    let cells = skeleton.cells.iter().map(|c| AxialCell { bounds: scene_box(&ranks, c) }).collect();
    Ok(AxialTree { bounds, nodes: skeleton.in_scene(&ranks), cells, portals, n_detail: skeleton.n_detail })
}

/// The same faces in ranks without overlap: in each plane the disjoint pieces of their union, planes
/// ascending.
pub(crate) fn united<const D: usize>(mut pieces: Vec<Piece<D>>) -> Vec<Piece<D>> {
    pieces.sort_unstable_by_key(Piece::plane);
    let in_plane = |group: &[Piece<D>]| -> Vec<Piece<D>> {
        let (axis, rank) = group[0].plane();
        let rects: Vec<Rect> = group.iter().map(|p| Rect::across(&p.extent, usize::from(axis))).collect();
        unite(&rects)
            .into_iter()
            .map(|r| Piece { axis, extent: r.on_plane(usize::from(axis), rank), is_wall: true })
            .collect()
    };
    pieces.chunk_by(|a, b| a.plane() == b.plane()).flat_map(in_plane).collect()
}

/// Walls, and the parts of what is open that no wall covers, planes ascending. Both are disjoint in each plane, planes ascending.
fn with_open<const D: usize>(mut walls: Vec<Piece<D>>, open: &[Piece<D>]) -> Vec<Piece<D>> {
    let mut bare = Vec::new();
    for group in open.chunk_by(|a, b| a.plane() == b.plane()) {
        let ((axis, rank), across) = (group[0].plane(), usize::from(group[0].axis));
        let first = walls.partition_point(|wall| wall.plane() < (axis, rank));
        let same = walls[first..].iter().take_while(|wall| wall.plane() == (axis, rank));
        let same: Vec<Rect> = same.map(|wall| Rect::across(&wall.extent, across)).collect();
        let rects = group.iter().flat_map(|piece| uncovered(Rect::across(&piece.extent, across), &same));
        bare.extend(rects.map(|r| Piece { axis, extent: r.on_plane(across, rank), is_wall: false }));
    }
    walls.extend(bare);
    walls.sort_by_key(Piece::plane);
    walls
}

fn scene_box<const D: usize>(ranks: &Ranks<D>, cell: &RankBox<D>) -> Aabb<D> {
    Aabb { min: ranks.corner(cell.lo), max: ranks.corner(cell.hi) }
}

fn checked_faces<const D: usize>(faces: &[AxialFace<D>]) -> Result<Vec<AxialFace<D>>, KdError> {
    // Ranks are 32 bits, with two ends per face and two of the bounds.
    if u32::try_from(faces.len()).is_ok_and(|n| n < u32::MAX / 2 - 1) {
        let check = |(face, f): (usize, &AxialFace<D>)| f.checked().map_err(|kind| KdError::Face { face, kind });
        faces.iter().enumerate().map(check).collect()
    } else {
        Err(KdError::TooManyFaces(faces.len()))
    }
}

fn checked_bounds<const D: usize>(bounds: Aabb<D>) -> Result<Aabb<D>, KdError> {
    if bounds.is_empty() {
        return Err(KdError::Empty);
    }
    let mut out = bounds;
    for x in out.min.iter_mut().chain(&mut out.max) {
        *x = check_coordinate(*x).map_err(KdError::Bounds)?;
    }
    match (0..D).find(|&axis| out.min[axis] >= out.max[axis]) {
        Some(axis) => Err(KdError::Flat { axis }),
        None => Ok(out),
    }
}

/// A cell that waits to be divided.
struct Pending<const D: usize> {
    cell: RankBox<D>,
    /// What is inside, in the order that [`choose`] requires.
    pieces: Vec<Piece<D>>,
    /// The node whose high child this is; the low child of a node follows it.
    high_of: Option<u32>,
}

struct Builder<'a, const D: usize> {
    ranks: &'a Ranks<D>,
    /// What divides without hiding, disjoint in each plane, planes ascending.
    dividers: &'a [Piece<D>],
    options: &'a KdOptions,
    n_cells: u32,
    skeleton: Skeleton<D>,
}

impl<const D: usize> Builder<'_, D> {
    /// Depth-first, low before high. The stack is explicit: a tree may be as deep as there are planes.
    fn run(mut self, pieces: Vec<Piece<D>>) -> Result<Skeleton<D>, KdError> {
        let mut stack = vec![Pending { cell: self.ranks.whole(), pieces, high_of: None }];
        while let Some(Pending { cell, pieces, high_of }) = stack.pop() {
            let node = self.skeleton.nodes.len() as u32;
            if let Some(RankNode::Inner { high, .. }) = high_of.map(|i| &mut self.skeleton.nodes[i as usize]) {
                *high = node;
            }
            match choose(self.ranks, &cell, &pieces, self.options.tau).or_else(|| self.divider_of(&cell)) {
                Some((axis, rank)) => stack.extend(self.divide(cell, pieces, axis, rank)),
                None => self.finish(cell, &pieces)?,
            }
        }
        Ok(self.skeleton)
    }

    /// The first plane of dividers that fill the cross-section of a cell.
    fn divider_of(&self, cell: &RankBox<D>) -> Option<(usize, u32)> {
        let fills = |plane: &&[Piece<D>]| {
            let (axis, rank) = plane[0].plane();
            let axis = usize::from(axis);
            let section = Rect::across(cell, axis);
            let inside = plane.iter().filter_map(|piece| Rect::across(&piece.extent, axis).common(section));
            cell.lo[axis] < rank && rank < cell.hi[axis] && covers(section, inside)
        };
        let plane = self.dividers.chunk_by(|a, b| a.plane() == b.plane()).find(fills)?;
        let (axis, rank) = plane[0].plane();
        Some((usize::from(axis), rank))
    }

    fn finish(&mut self, cell: RankBox<D>, pieces: &[Piece<D>]) -> Result<(), KdError> {
        if self.n_cells >= self.options.max_cells.min(u32::MAX / 2) {
            return Err(KdError::TooManyCells { limit: self.options.max_cells });
        }
        self.skeleton.nodes.push(RankNode::Leaf(CellId(self.n_cells)));
        self.skeleton.cells.push(cell);
        self.skeleton.n_detail += pieces.len();
        self.n_cells += 1;
        Ok(())
    }

    /// Writes an inner node; returns the high, then the low half, so that low is processed first.
    fn divide(&mut self, cell: RankBox<D>, pieces: Vec<Piece<D>>, axis: usize, rank: u32) -> [Pending<D>; 2] {
        let node = self.skeleton.nodes.len() as u32;
        let (sides, walls) = cut(pieces, axis, rank);
        let open = uncovered(Rect::across(&cell, axis), &walls);
        self.skeleton.nodes.push(RankNode::Inner { axis, rank, high: 0, open });
        let [low_cell, high_cell] = cell.split_at(axis, rank);
        let [low, high] = sides;
        let high = Pending { cell: high_cell, pieces: high, high_of: Some(node) };
        [high, Pending { cell: low_cell, pieces: low, high_of: None }]
    }
}

/// The pieces below and above a plane, in the same order, and those on it.
fn cut<const D: usize>(mut pieces: Vec<Piece<D>>, axis: usize, rank: u32) -> ([Vec<Piece<D>>; 2], Vec<Rect>) {
    let (mut low, mut walls) = (Vec::new(), Vec::new());
    pieces.retain_mut(|piece| {
        if piece.plane() == (axis as u8, rank) {
            if piece.is_wall {
                walls.push(Rect::across(&piece.extent, axis));
            }
            return false;
        }
        let below = piece.extent.lo[axis] < rank;
        let above = piece.extent.hi[axis] > rank;
        if below {
            let mut part = *piece;
            part.extent.hi[axis] = part.extent.hi[axis].min(rank);
            low.push(part);
        }
        piece.extent.lo[axis] = piece.extent.lo[axis].max(rank);
        above
    });
    // The list may stay on the stack for long, so spare capacity is released.
    if pieces.capacity() > 2 * pieces.len() {
        pieces.shrink_to_fit();
    }
    ([low, pieces], walls)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(faces: &[AxialFace<2>], bounds: Aabb<2>, options: KdOptions) -> String {
        subdivide(faces, bounds, &options).unwrap_err().to_string()
    }

    #[test]
    fn bad_input_is_named() {
        let unit = Aabb { min: [0.0; 2], max: [1.0; 2] };
        let good = AxialFace::new(0, [0.5, 0.0], [0.5, 1.0]);
        let bad = AxialFace { at: 0.25, ..good };
        let plain = KdOptions::default();
        assert_eq!(message(&[good, bad], unit, plain), "face 1: extends from 0.5 to 0.5 across its plane at 0.25");
        assert_eq!(message(&[], bounds_of::<2>(&[]), plain), "the scene is empty");
        assert_eq!(message(&[good], bounds_of(&[good]), plain), "the scene has no extent along axis 0");
        let infinite = Aabb { min: [0.0; 2], max: [1.0, f64::INFINITY] };
        assert_eq!(message(&[], infinite, plain), "bounds: coordinate inf is not a finite number");
        let tau = |tau| message(&[good], unit, KdOptions { tau, ..plain });
        assert_eq!(tau(-0.5), "obscuration threshold -0.5 is not a number from 0 to 1");
        assert_eq!(tau(f64::NAN), "obscuration threshold NaN is not a number from 0 to 1");
        let limited = KdOptions { max_cells: 1, ..plain };
        assert_eq!(
            message(&[good], unit, limited),
            "the scene falls into more than 1 cells; raise the limit, the threshold tau, or the size of detail"
        );
    }
}
