//! Coordinates as ranks: the `i`-th smallest coordinate of an axis becomes the integer `i`.
//!
//! Ranks keep order and equality, which is all that cutting needs, and turn "does this union cover that rectangle" into
//! a count of integer squares: exact, without any rounding.

use crate::face::{AxialFace, FaceClass, across, classify};
use sightlines_geometry::Aabb;

/// The coordinates of every axis, ascending and different.
#[derive(Debug, Clone)]
pub(crate) struct Ranks<const D: usize> {
    axes: [Vec<f64>; D],
}

/// A box in ranks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct RankBox<const D: usize> {
    pub(crate) lo: [u32; D],
    pub(crate) hi: [u32; D],
}

/// A piece of a face in ranks: a box that is flat along `axis`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Piece<const D: usize> {
    pub(crate) axis: u8,
    pub(crate) extent: RankBox<D>,
    /// Whether it hides from both sides.
    pub(crate) is_wall: bool,
}

impl<const D: usize> Piece<D> {
    /// The piece's plane: axis, then rank.
    pub(crate) fn plane(&self) -> (u8, u32) {
        (self.axis, self.extent.lo[usize::from(self.axis)])
    }
}

impl<const D: usize> Ranks<D> {
    /// Ranks for `bounds` and everything of some lists of faces that is inside, and those faces in ranks, clipped. Faces that only lie on the
    /// border of the bounds, or outside, are left out. O(n log n).
    pub(crate) fn compress<const N: usize>(
        faces: [&[AxialFace<D>]; N],
        bounds: &Aabb<D>,
    ) -> (Self, [Vec<Piece<D>>; N]) {
        let inside = faces.map(|faces| faces.iter().filter_map(|face| clipped(face, bounds)).collect::<Vec<_>>());
        let axes = std::array::from_fn(|k| {
            let ends = inside.iter().flatten().flat_map(|f| [f.min[k], f.max[k]]);
            let mut all: Vec<f64> = ends.chain([bounds.min[k], bounds.max[k]]).collect();
            all.sort_unstable_by(f64::total_cmp);
            all.dedup();
            all
        });
        let ranks = Self { axes };
        let pieces = inside.map(|faces| faces.iter().map(|f| ranks.piece(f)).collect());
        (ranks, pieces)
    }

    fn piece(&self, face: &AxialFace<D>) -> Piece<D> {
        let extent = RankBox { lo: self.ranks_of(face.min), hi: self.ranks_of(face.max) };
        Piece { axis: face.axis as u8, extent, is_wall: true }
    }

    fn ranks_of(&self, p: [f64; D]) -> [u32; D] {
        std::array::from_fn(|k| self.axes[k].partition_point(|&x| x < p[k]) as u32)
    }

    /// The box of all ranks.
    pub(crate) fn whole(&self) -> RankBox<D> {
        RankBox { lo: [0; D], hi: std::array::from_fn(|k| self.axes[k].len() as u32 - 1) }
    }

    /// The coordinate of a rank.
    pub(crate) fn value(&self, axis: usize, rank: u32) -> f64 {
        self.axes[axis][rank as usize]
    }

    /// The coordinates of a corner.
    pub(crate) fn corner(&self, ranks: [u32; D]) -> [f64; D] {
        std::array::from_fn(|k| self.value(k, ranks[k]))
    }

    /// Extent of a box across `axis`, in scene units to the power `D - 1`; rounded.
    pub(crate) fn measure_across(&self, extent: &RankBox<D>, axis: usize) -> f64 {
        across::<D>(axis).map(|k| self.value(k, extent.hi[k]) - self.value(k, extent.lo[k])).product()
    }
}

impl<const D: usize> RankBox<D> {
    /// The box below and the box above a plane that cuts it.
    pub(crate) fn split_at(self, axis: usize, rank: u32) -> [Self; 2] {
        let (mut low, mut high) = (self, self);
        low.hi[axis] = rank;
        high.lo[axis] = rank;
        [low, high]
    }
}

/// The part of a face inside the bounds, unless it is on their border.
fn clipped<const D: usize>(face: &AxialFace<D>, bounds: &Aabb<D>) -> Option<AxialFace<D>> {
    let inside = matches!(classify(face, bounds), FaceClass::Spanning | FaceClass::Incident);
    inside.then(|| AxialFace {
        min: std::array::from_fn(|k| face.min[k].max(bounds.min[k])),
        max: std::array::from_fn(|k| face.max[k].min(bounds.max[k])),
        ..*face
    })
}
