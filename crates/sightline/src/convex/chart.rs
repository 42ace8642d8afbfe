//! Lines, parametrised by where they meet two portals of a sequence.

use super::certificate::Block;
use super::vector::{along, cross, dot, scale, size, sub, unit};
use sightlines_geometry::{Point3, Portal3};

/// Error bound of a frame of unit vectors that is computed and used in doubles, relative to lengths. Each coefficient
/// of the frame is accurate to 2^-50, and so its inverse is its transpose to 2^-47; a difference of points and three
/// products add 2^-50. This is four times their sum.
const SKEW: f64 = f64::EPSILON * 512.0;

/// Error bound of a block's corner, relative to the magnitudes added up in it: three additions and the rounding of each
/// product.
const PLACE: f64 = f64::EPSILON * 8.0;

/// A box around a portal: as long and wide as the portal, and as thick as rounding requires.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plate {
    block: Block,
    centre: Point3,
    /// Unit vector in the direction of crossing.
    normal: Point3,
    /// Length and width.
    extent: [f64; 2],
}

impl Plate {
    /// The box along the portal's longest edge. It contains every corner, rigorously.
    pub(super) fn around(portal: &Portal3) -> Option<Self> {
        let longest = portal.edges().map(|[p, q]| sub(q, p)).max_by(|p, q| dot(*p, *p).total_cmp(&dot(*q, *q)))?;
        let first = unit(longest)?;
        let across = cross(unit(portal.normal())?, first);
        // The normal of a sliver may consist of rounding errors. The frame is accurate if the normal is not along the
        // edge.
        let second = unit(across).filter(|_| dot(across, across) > 0.25)?;
        let third = unit(cross(first, second))?;
        let frame = [first, second, third];
        let origin = portal.corners()[0];
        let (mut low, mut high, mut reach) = ([0.0f64; 3], [0.0f64; 3], 0.0f64);
        for &corner in portal.corners() {
            let from = sub(corner, origin);
            reach = reach.max(size(from));
            for i in 0..3 {
                let x = dot(frame[i], from);
                (low[i], high[i]) = (low[i].min(x), high[i].max(x));
            }
        }
        let slack = SKEW * reach + PLACE * (size(origin) + reach);
        let mut corner = origin;
        for i in 0..3 {
            corner = along(corner, frame[i], low[i] - slack);
        }
        let extent = [0, 1, 2].map(|i| high[i] - low[i] + 2.0 * slack);
        let edges = [0, 1, 2].map(|i| scale(frame[i], extent[i]));
        let finite = corner.into_iter().chain(extent).all(f64::is_finite);
        finite.then(|| Self {
            block: Block { corner, edges },
            centre: [0, 1, 2].map(|i| corner[i] + 0.5 * (edges[0][i] + edges[1][i] + edges[2][i])),
            normal: third,
            extent: [extent[0], extent[1]],
        })
    }

    /// Length and width together.
    fn reach(&self) -> f64 {
        self.extent[0] + self.extent[1]
    }

    /// From centre to centre.
    fn distance(&self, other: &Self) -> f64 {
        let between = sub(other.centre, self.centre);
        dot(between, between).sqrt()
    }

    /// How far the other box lies beyond this one, across one of them; negative if it does not.
    fn gap(&self, other: &Self) -> f64 {
        let gap = |w: Point3| other.span(w)[0] - self.span(w)[1];
        gap(self.normal).max(gap(other.normal))
    }

    /// The least and the greatest of `w · x` in it.
    fn span(&self, w: Point3) -> [f64; 2] {
        let middle = dot(w, self.centre);
        let half: f64 = self.block.edges.iter().map(|e| dot(w, *e).abs()).sum::<f64>() * 0.5;
        [middle - half, middle + half]
    }
}

/// Two portals of a sequence, the earlier first, and the boxes around them: a line is given by a point of
/// each, and these by coordinates from 0 to 1.
#[derive(Debug, Clone, Copy)]
pub(super) struct Chart {
    pub(super) portals: [usize; 2],
    pub(super) blocks: [Block; 2],
    /// A length of the order of the boxes.
    pub(super) unit: f64,
    /// The distance of their centres.
    pub(super) distance: f64,
    /// Whether the second box lies wholly beyond the first. If not, no box of lines can be refuted that contains two
    /// equal points.
    pub(super) apart: bool,
}

impl Chart {
    /// The two portals between which lines differ least: the product of their extents, divided by the gap between them,
    /// is least. Boxes that touch or overlap are the last resort; of those, the farthest apart. `None` if there are not
    /// two portals. O(n²), with little work for most pairs.
    pub(super) fn best(plates: &[Plate]) -> Option<Self> {
        let mut best: Option<(f64, [usize; 2])> = None;
        let mut farthest: Option<(f64, [usize; 2])> = None;
        for j in 1..plates.len() {
            for i in 0..j {
                let (p, q) = (&plates[i], &plates[j]);
                let distance = p.distance(q);
                let likeness = p.reach() * q.reach();
                if best.is_some_and(|(score, _)| likeness >= score * distance) {
                    continue;
                }
                if best.is_none() && farthest.is_none_or(|(d, _)| distance > d) {
                    farthest = Some((distance, [i, j]));
                }
                let gap = p.gap(q);
                if gap > 1e-6 * distance && best.is_none_or(|(score, _)| likeness < score * gap) {
                    best = Some((likeness / gap, [i, j]));
                }
            }
        }
        Some(Self::between(plates, best.or(farthest)?.1, best.is_some()))
    }

    /// At most `n` pairs of portals whose boxes lie apart, those between which lines differ least first.
    pub(super) fn several(plates: &[Plate], n: usize) -> Vec<[usize; 2]> {
        let mut pairs: Vec<(f64, [usize; 2])> = Vec::new();
        for j in 1..plates.len() {
            for i in 0..j {
                let (p, q) = (&plates[i], &plates[j]);
                let gap = p.gap(q);
                if gap > 1e-6 * p.distance(q) {
                    pairs.push((p.reach() * q.reach() / gap, [i, j]));
                }
            }
        }
        pairs.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        pairs.into_iter().take(n).map(|(_, pair)| pair).collect()
    }

    /// Two portals, the earlier first, and whether the box of the second lies wholly beyond that of the first.
    pub(super) fn between(plates: &[Plate], portals: [usize; 2], apart: bool) -> Self {
        let [p, q] = portals.map(|i| &plates[i]);
        let unit = p.reach().max(q.reach());
        let distance = p.distance(q).max(1e-3 * unit);
        Self { portals, blocks: [p.block, q.block], unit, distance, apart }
    }

    /// The points with coordinates `at`: two of the first box, two of the second; in the middle of their
    /// thickness.
    pub(super) fn points(&self, at: &[f64; 4]) -> [Point3; 2] {
        let place = |block: &Block, x: f64, y: f64| {
            along(along(along(block.corner, block.edges[0], x), block.edges[1], y), block.edges[2], 0.5)
        };
        [place(&self.blocks[0], at[0], at[1]), place(&self.blocks[1], at[2], at[3])]
    }

    /// The coordinates, within the first box, of where a line meets it: rounded, and the middle if it is
    /// parallel to it or the place is far off.
    pub(super) fn coordinates(&self, a: Point3, b: Point3) -> [f64; 2] {
        let block = &self.blocks[0];
        let normal = cross(block.edges[0], block.edges[1]);
        let (direction, to) = (sub(b, a), sub(block.corner, a));
        let place = along(to, direction, -dot(normal, to) / dot(normal, direction));
        let coordinate = |edge: Point3| -dot(place, edge) / dot(edge, edge);
        let at = [coordinate(block.edges[0]), coordinate(block.edges[1])];
        at.map(|x| if x > -1.0 && x < 2.0 { x.clamp(0.0, 1.0) } else { 0.5 })
    }
}
