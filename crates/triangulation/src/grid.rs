//! Buckets on a square grid, to find segments and points that may be near each other.
//!
//! Buckets only narrow a search: things near each other share a bucket, and the caller tests those that share one
//! exactly.

use sightlines_geometry::{Aabb, Point2, Segment2};

/// A square grid over a box.
#[derive(Debug, Clone)]
struct Frame {
    min: Point2,
    /// Buckets per unit of length, along each axis.
    scale: Point2,
    n: usize,
}

impl Frame {
    fn new(bounds: &Aabb<2>, n: usize) -> Self {
        // A bucket is at least 2^12 units in the last place of the largest coordinate wide, so that
        // rounding is far below a bucket.
        let fine = |k: usize| {
            let largest = bounds.min[k].abs().max(bounds.max[k].abs());
            let size = bounds.max[k] - bounds.min[k];
            if size > 0.0 { size / (largest * 2f64.powi(-40)) } else { f64::INFINITY }
        };
        let finest = if bounds.is_empty() { 1.0 } else { fine(0).min(fine(1)) };
        let n = n.clamp(1, 1024).min(finest as usize).max(1);
        let scale = |k: usize| {
            let size = bounds.max[k] - bounds.min[k];
            if size > 0.0 { n as f64 / size } else { 0.0 }
        };
        let min = if bounds.is_empty() { Point2::ZERO } else { Point2::from(bounds.min) };
        Self { min, scale: Point2::new(scale(0), scale(1)), n }
    }

    /// The column or row of a coordinate. Monotonic in the coordinate, because each operation is.
    fn column(&self, x: f64) -> usize {
        (((x - self.min.x) * self.scale.x) as usize).min(self.n - 1)
    }

    fn row(&self, y: f64) -> usize {
        (((y - self.min.y) * self.scale.y) as usize).min(self.n - 1)
    }

    /// Calls `visit` for each bucket that the segment, widened by `slack`, meets, and perhaps for others.
    ///
    /// What is within `slack` of the segment in a column is within `slack` above or below the part of
    /// the segment over the column widened by `slack`. Heights are computed in doubles, with an error far
    /// below a bucket's size; a whole bucket is added on both sides.
    fn along(&self, s: &Segment2, slack: f64, mut visit: impl FnMut(usize)) {
        let (lo, hi) = (s.a.min(s.b) - Point2::splat(slack), s.a.max(s.b) + Point2::splat(slack));
        let (first, last) = (self.column(lo.x), self.column(hi.x));
        let (bottom, top) = (self.row(lo.y), self.row(hi.y));
        let d = s.b - s.a;
        for column in first..=last {
            let (mut from, mut to) = (bottom, top);
            if last - first > 1 && top - bottom > 1 && d.x != 0.0 {
                let height = |x: f64| s.a.y + (x - s.a.x) * (d.y / d.x);
                let edge = |c: usize| self.min.x + c as f64 / self.scale.x;
                let (p, q) = (height(edge(column) - slack), height(edge(column + 1) + slack));
                from = from.max(self.row(p.min(q) - slack).saturating_sub(1));
                to = to.min(self.row(p.max(q) + slack) + 1);
            }
            for row in from..=to {
                visit(column * self.n + row);
            }
        }
    }
}

/// Lists of items by bucket, packed.
#[derive(Debug, Clone)]
struct Buckets {
    first: Vec<u32>,
    items: Vec<u32>,
}

impl Buckets {
    /// From (bucket, item) pairs, in order of items within a bucket.
    fn new(n_buckets: usize, mut entries: Vec<(u32, u32)>) -> Self {
        entries.sort_unstable();
        entries.dedup();
        let mut first = vec![0u32; n_buckets + 1];
        for &(bucket, _) in &entries {
            first[bucket as usize + 1] += 1;
        }
        for i in 0..n_buckets {
            first[i + 1] += first[i];
        }
        Self { first, items: entries.into_iter().map(|(_, item)| item).collect() }
    }

    fn get(&self, bucket: usize) -> &[u32] {
        &self.items[self.first[bucket] as usize..self.first[bucket + 1] as usize]
    }
}

/// Segments by bucket.
#[derive(Debug, Clone)]
pub(crate) struct SegmentGrid {
    buckets: Buckets,
    n_buckets: usize,
}

impl SegmentGrid {
    /// About as many buckets as segments.
    pub(crate) fn new(segments: &[Segment2]) -> Self {
        let bounds = Aabb::around(segments.iter().flat_map(|s| [[s.a.x, s.a.y], [s.b.x, s.b.y]]));
        let frame = Frame::new(&bounds, (segments.len() as f64).sqrt() as usize);
        let mut entries = Vec::with_capacity(2 * segments.len());
        for (i, s) in (0u32..).zip(segments) {
            frame.along(s, 0.0, |bucket| entries.push((bucket as u32, i)));
        }
        let n_buckets = frame.n * frame.n;
        Self { buckets: Buckets::new(n_buckets, entries), n_buckets }
    }

    /// For each bucket, the segments in it, ascending.
    pub(crate) fn buckets(&self) -> impl Iterator<Item = &[u32]> {
        (0..self.n_buckets).map(|b| self.buckets.get(b))
    }
}

/// Points by bucket.
#[derive(Debug, Clone)]
pub(crate) struct PointGrid {
    frame: Frame,
    buckets: Buckets,
    points: Vec<Point2>,
}

impl PointGrid {
    /// About as many buckets as points.
    pub(crate) fn new(points: impl IntoIterator<Item = Point2>) -> Self {
        let points: Vec<Point2> = points.into_iter().collect();
        let bounds = Aabb::around(points.iter().map(|p| [p.x, p.y]));
        let frame = Frame::new(&bounds, (points.len() as f64).sqrt() as usize);
        let bucket = |p: &Point2| (frame.column(p.x) * frame.n + frame.row(p.y)) as u32;
        let entries = (0u32..).zip(&points).map(|(i, p)| (bucket(p), i)).collect();
        Self { buckets: Buckets::new(frame.n * frame.n, entries), frame, points }
    }

    /// Whether `test` holds for a point near the segment: at least all within `slack` of it are tested.
    pub(crate) fn any_near(&self, s: &Segment2, slack: f64, test: impl Fn(Point2) -> bool) -> bool {
        let (lo, hi) = (s.a.min(s.b) - Point2::splat(slack), s.a.max(s.b) + Point2::splat(slack));
        let near = |p: Point2| lo.x <= p.x && p.x <= hi.x && lo.y <= p.y && p.y <= hi.y;
        let mut found = false;
        self.frame.along(s, slack, |bucket| {
            found =
                found || self.buckets.get(bucket).iter().map(|&i| self.points[i as usize]).any(|p| near(p) && test(p));
        });
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn point() -> impl Strategy<Value = Point2> {
        (-9i32..10, -9i32..10).prop_map(|(x, y)| Point2::new(f64::from(x) * 0.7, f64::from(y) * 1.3))
    }

    proptest! {
        /// Invariant: segments that meet share a bucket.
        #[test]
        fn segments_that_meet_share_a_bucket(ends in prop::collection::vec((point(), point()), 1..60)) {
            let segments: Vec<Segment2> = ends.into_iter().map(|(a, b)| Segment2::new(a, b)).collect();
            let grid = SegmentGrid::new(&segments);
            for (i, s) in segments.iter().enumerate() {
                for (j, t) in segments[..i].iter().enumerate() {
                    let share = grid.buckets().any(|b| b.contains(&(i as u32)) && b.contains(&(j as u32)));
                    prop_assert!(share || !s.meets(t), "{:?} {:?}", s, t);
                }
            }
        }

        /// Invariant: points on or near a segment are found.
        #[test]
        fn points_near_a_segment_are_found(points in prop::collection::vec(point(), 1..60), a in point(), b in point()) {
            let s = Segment2::new(a, b);
            let grid = PointGrid::new(points.iter().copied());
            for p in points {
                let along = (b - a).normalize_or_zero();
                let t = (p - a).dot(along).clamp(0.0, (b - a).length());
                let distance = p.distance(a + along * t);
                let found = grid.any_near(&s, 0.5, |q| q == p);
                prop_assert!(found || distance > 0.49, "{:?} {:?}", p, s);
            }
        }
    }

    /// The impostor: a grid of many buckets does separate things that are far apart.
    #[test]
    fn far_segments_do_not_share_a_bucket() {
        let segments: Vec<Segment2> = (0..100)
            .map(|i| Segment2::new(Point2::new(f64::from(i), 0.0), Point2::new(f64::from(i), 0.5)))
            .chain([Segment2::new(Point2::new(0.0, 100.0), Point2::new(1.0, 100.0))])
            .collect();
        let grid = SegmentGrid::new(&segments);
        assert!(!grid.buckets().any(|b| b.contains(&0) && b.contains(&50)));
    }
}
