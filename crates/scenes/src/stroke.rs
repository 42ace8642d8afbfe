//! Axis-parallel walls on an integer grid, and the outlines of the area that thick walls cover.

use sightlines_cells::PlanLine;
use sightlines_geometry::Point2;

/// A wall parallel to an axis, in grid steps, with `lo < hi`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Stroke {
    /// Whether it runs along x (and `at` is its y).
    pub(crate) horizontal: bool,
    /// The coordinate that all its points share.
    pub(crate) at: i32,
    /// Its lower end.
    pub(crate) lo: i32,
    /// Its upper end.
    pub(crate) hi: i32,
}

impl Stroke {
    /// Along x from `lo` to `hi` at height `y`.
    pub(crate) const fn along_x(y: i32, lo: i32, hi: i32) -> Self {
        Self { horizontal: true, at: y, lo, hi }
    }

    /// Along y from `lo` to `hi` at `x`.
    pub(crate) const fn along_y(x: i32, lo: i32, hi: i32) -> Self {
        Self { horizontal: false, at: x, lo, hi }
    }

    /// The four sides of a box.
    pub(crate) const fn sides(r: Rect) -> [Self; 4] {
        [
            Self::along_x(r.y0, r.x0, r.x1),
            Self::along_x(r.y1, r.x0, r.x1),
            Self::along_y(r.x0, r.y0, r.y1),
            Self::along_y(r.x1, r.y0, r.y1),
        ]
    }

    /// The parts that remain without `gaps` (ascending, disjoint, inside).
    pub(crate) fn without(self, gaps: &[[i32; 2]]) -> Vec<Self> {
        let starts = std::iter::once(self.lo).chain(gaps.iter().map(|g| g[1]));
        let ends = gaps.iter().map(|g| g[0]).chain(std::iter::once(self.hi));
        starts.zip(ends).filter(|(lo, hi)| lo < hi).map(|(lo, hi)| Self { lo, hi, ..self }).collect()
    }

    /// All points within `half` of the wall, in the maximum norm.
    pub(crate) const fn thick(self, half: i32) -> Rect {
        let (lo, hi, low, high) = (self.lo - half, self.hi + half, self.at - half, self.at + half);
        if self.horizontal {
            Rect { x0: lo, y0: low, x1: hi, y1: high }
        } else {
            Rect { x0: low, y0: lo, x1: high, y1: hi }
        }
    }

    /// The wall in scene units: a grid step is 1 / `steps_per_unit`, a power of two.
    pub(crate) fn wall(self, steps_per_unit: u32) -> PlanLine {
        let scale = 1.0 / f64::from(steps_per_unit);
        let point = |t: i32| {
            let (x, y) = if self.horizontal { (t, self.at) } else { (self.at, t) };
            Point2::new(f64::from(x) * scale, f64::from(y) * scale)
        };
        PlanLine::wall(point(self.lo), point(self.hi))
    }
}

/// A box on the grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Rect {
    pub(crate) x0: i32,
    pub(crate) y0: i32,
    pub(crate) x1: i32,
    pub(crate) y1: i32,
}

/// The union of `strokes` as the fewest strokes, sorted: collinear ones that touch become one.
pub(crate) fn merge(mut strokes: Vec<Stroke>) -> Vec<Stroke> {
    strokes.sort_unstable();
    let mut merged: Vec<Stroke> = Vec::with_capacity(strokes.len());
    for s in strokes {
        match merged.last_mut() {
            Some(m) if m.horizontal == s.horizontal && m.at == s.at && s.lo <= m.hi => m.hi = m.hi.max(s.hi),
            _ => merged.push(s),
        }
    }
    merged
}

/// The boundary of the union of `rects`, merged.
///
/// Cost: the number of distinct x times the number of distinct y, and the area of each box in that grid.
pub(crate) fn outline(rects: &[Rect]) -> Vec<Stroke> {
    let mut xs: Vec<i32> = rects.iter().flat_map(|r| [r.x0, r.x1]).collect();
    let mut ys: Vec<i32> = rects.iter().flat_map(|r| [r.y0, r.y1]).collect();
    for v in [&mut xs, &mut ys] {
        v.sort_unstable();
        v.dedup();
    }
    let place = |v: &[i32], x: i32| v.binary_search(&x).expect("every box side is in the list");
    // A border of free cells around the grid avoids special cases.
    let width = xs.len() + 1;
    let mut solid = vec![false; width * (ys.len() + 1)];
    for r in rects {
        let (i0, i1) = (place(&xs, r.x0), place(&xs, r.x1));
        for j in place(&ys, r.y0)..place(&ys, r.y1) {
            solid[(j + 1) * width + i0 + 1..(j + 1) * width + i1 + 1].fill(true);
        }
    }
    let mut strokes = Vec::new();
    for (j, &y) in ys.iter().enumerate() {
        for (i, &x) in xs.iter().enumerate() {
            // The cell up and to the right of this grid point, against its two neighbours.
            let here = solid[(j + 1) * width + i + 1];
            if i + 1 < xs.len() && here != solid[j * width + i + 1] {
                strokes.push(Stroke::along_x(y, x, xs[i + 1]));
            }
            if j + 1 < ys.len() && here != solid[(j + 1) * width + i] {
                strokes.push(Stroke::along_y(x, y, ys[j + 1]));
            }
        }
    }
    merge(strokes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strokes_gaps_and_merging() {
        let wall = Stroke::along_x(3, 0, 20);
        let parts = wall.without(&[[0, 2], [5, 7]]);
        assert_eq!(parts, [Stroke::along_x(3, 2, 5), Stroke::along_x(3, 7, 20)]);
        assert_eq!(merge(vec![Stroke::along_x(3, 5, 9), parts[0], parts[1]]), [Stroke::along_x(3, 2, 20)]);
    }

    #[test]
    fn outline_of_a_cross_has_twelve_sides() {
        let cross = [Stroke::along_x(0, -5, 5).thick(1), Stroke::along_y(0, -5, 5).thick(1)];
        let sides = outline(&cross);
        assert_eq!(sides.len(), 12);
        assert_eq!(sides.iter().map(|s| s.hi - s.lo).sum::<i32>(), 4 * 2 + 8 * 5);
        let ring: Vec<Rect> = Stroke::sides(Rect { x0: 0, y0: 0, x1: 9, y1: 9 }).map(|s| s.thick(1)).to_vec();
        assert_eq!(outline(&ring).len(), 8, "an outer and an inner square");
    }
}
