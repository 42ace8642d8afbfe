//! Where the lines from a volume through an occludee meet a plane, and whether all of that is blocked.
//!
//! The projections of an occludee from the corners of a volume leave gaps; their convex hull does not: the place
//! where the line from `v` through `e` meets the plane is a quotient of affine functions of either, with a positive
//! denominator, so it stays in the hull of the corners' places.

use crate::{Buffer, BufferPlane, Volume};
use sightlines_geometry::{Aabb, Point3};

/// Where lines from a volume through an occludee meet a plane, in whole texels, and the value that blocks it.
///
/// Texel `(x, y)` is touched if it is within `bounds` and `A * x + B * y + C >= 0` for each of the edges. The occludee is
/// hidden if it is `inside`, and the value of every touched texel is more than `limit`.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Footprint {
    /// `x0, y0, x1, y1`: texels from `(x0, y0)` to before `(x1, y1)`, within the window.
    pub bounds: [i32; 4],
    /// `A, B, C` of each edge.
    pub edges: Vec<[i32; 3]>,
    /// Values up to this do not hide it.
    pub limit: u32,
    /// Whether all of it lies in the window.
    pub inside: bool,
}

impl Footprint {
    /// The footprint of the convex hull of `points`, for values that are heights. `None` if some line from an eye
    /// through the hull does not go towards the plane, or is parallel to it.
    ///
    /// * `unit`: scene units in one unit of the values, a power of two; see [`BufferJob::unit`](crate::BufferJob::unit)
    ///
    /// Errs by being too large. O(n log n).
    pub fn of_points(volume: &Volume, plane: &BufferPlane, unit: f64, points: &[Point3]) -> Option<Self> {
        let mut lines = Lines::new(volume, plane);
        for &p in points {
            let heights = plane.height(p);
            lines.add([heights, heights], plane.across().map(|a| [p[a], p[a]]))?;
        }
        lines.footprint(unit)
    }

    /// The footprint of a box, as [`Self::of_points`].
    pub fn of_box(volume: &Volume, plane: &BufferPlane, unit: f64, target: &Aabb<3>) -> Option<Self> {
        let mut lines = Lines::new(volume, plane);
        let heights = [plane.height(target.min), plane.height(target.max)];
        for height in heights {
            lines.add([height, height], plane.across().map(|a| [target.min[a], target.max[a]]))?;
        }
        lines.footprint(unit)
    }

    /// Whether all of it is blocked in `buffer`, whose values are heights.
    pub fn is_blocked(&self, buffer: &Buffer) -> bool {
        self.inside
            && self.all_touched(|x, y| {
                buffer.row(y as u32)[x.start as usize..x.end as usize].iter().all(|&v| v > self.limit)
            })
    }

    /// Whether `test` holds for the touched texels of each row.
    pub fn all_touched(&self, mut test: impl FnMut(std::ops::Range<i32>, i32) -> bool) -> bool {
        let [_, y0, _, y1] = self.bounds;
        (y0..y1).all(|y| {
            let span = self.span(y);
            span.is_empty() || test(span, y)
        })
    }

    /// The touched texels of a row.
    fn span(&self, y: i32) -> std::ops::Range<i32> {
        let [mut x0, _, mut x1, _] = self.bounds;
        for &[a, b, c] in &self.edges {
            let rest = b * y + c;
            if a > 0 {
                x0 = x0.max(-rest.div_euclid(a));
            } else if a < 0 {
                x1 = x1.min(rest.div_euclid(-a) + 1);
            } else if rest < 0 {
                return 0..0;
            }
        }
        x0..x1.max(x0)
    }
}

/// The largest value that does not suffice to hide something that reaches up to `height`, see [`Footprint::limit`].
///
/// Any blocked texel hides what is beyond the plane. To hide what reaches height `h`, a value must exceed `h`: whole
/// units above `floor(h / unit)`, and the encoding adds one.
pub(crate) fn limit(height: f64, unit: f64) -> u32 {
    if height < 0.0 {
        return 0;
    }
    // Heights are rounded to nearest.
    let units = (height.next_up() / unit).floor();
    if units < f64::from(1u32 << 30) { units as u32 + 1 } else { u32::MAX }
}

/// Lines from a volume through points, on their way to a plane.
struct Lines<'a> {
    plane: &'a BufferPlane,
    /// Heights of the eyes, least and largest, widened.
    eyes: [f64; 2],
    /// Eyes along the axes across.
    across: [[f64; 2]; 2],
    /// Rectangles in which the lines meet the plane, in texels.
    rectangles: Vec<[[f64; 2]; 2]>,
    highest: f64,
}

impl<'a> Lines<'a> {
    fn new(volume: &Volume, plane: &'a BufferPlane) -> Self {
        let b = volume.bounds();
        let heights = [plane.height(b.min), plane.height(b.max)];
        let eyes = [heights[0].min(heights[1]).next_down(), heights[0].max(heights[1]).next_up()];
        let across = plane.across().map(|a| [b.min[a], b.max[a]]);
        Self { plane, eyes, across, rectangles: Vec::with_capacity(4), highest: f64::NEG_INFINITY }
    }

    /// Adds points of a height (rounded to nearest) in a rectangle across; `None` if lines to them do not approach the
    /// plane.
    fn add(&mut self, heights: [f64; 2], at: [[f64; 2]; 2]) -> Option<()> {
        let heights = [heights[0].next_down(), heights[1].next_up()];
        self.highest = self.highest.max(heights[1]);
        for eye in self.eyes {
            // The distance to the plane over the distance to the point.
            let down = (eye - heights[1]).next_down();
            if down <= 0.0 {
                return None;
            }
            let (of_low, of_high) = (eye / (eye - heights[0]).next_up(), eye / down);
            let ratio = [of_low.min(of_high).next_down(), of_low.max(of_high).next_up()];
            let rectangle = std::array::from_fn(|k| self.interval(k, ratio, at[k]));
            self.rectangles.push(rectangle);
        }
        Some(())
    }

    /// Where `v + r (e - v)` lies for all eyes `v`, all `r` and all `e`, in texels: affine in each, so the ends are at
    /// ends. Rounded outwards, by 8 ε of the magnitudes that are added; the least and the largest eye stand for all.
    fn interval(&self, k: usize, ratio: [f64; 2], at: [f64; 2]) -> [f64; 2] {
        let (origin, step) = (self.plane.origin()[k], self.plane.step()[k]);
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for v in self.across[k] {
            for e in at {
                for r in ratio {
                    let error = (v.abs() + origin.abs() + r * (e.abs() + v.abs())) * (8.0 * f64::EPSILON);
                    let place = v + r * (e - v) - origin;
                    low = low.min(((place - error) / step).next_down());
                    high = high.max(((place + error) / step).next_up());
                }
            }
        }
        [low, high]
    }

    fn footprint(self, unit: f64) -> Option<Footprint> {
        let n = self.plane.texels().map(f64::from);
        let extent = |k: usize| {
            self.rectangles
                .iter()
                .fold([f64::INFINITY, f64::NEG_INFINITY], |e, r| [e[0].min(r[k][0]), e[1].max(r[k][1])])
        };
        let ([x0, x1], [y0, y1]) = (extent(0), extent(1));
        let inside = x0 >= 0.0 && y0 >= 0.0 && x1 <= n[0] && y1 <= n[1];
        let limit = limit(self.highest, unit);
        if !inside {
            return Some(Footprint { inside, limit, ..Footprint::default() });
        }
        let whole = |low: f64, high: f64, n: f64| {
            let first = low.floor().min(n - 1.0);
            (first as i32, high.ceil().max(first + 1.0) as i32)
        };
        let ((x0, x1), (y0, y1)) = (whole(x0, x1, n[0]), whole(y0, y1, n[1]));
        let bounds = [x0, y0, x1, y1];
        let largest = (f64::from(1u32 << 28) / n[0].max(n[1])).floor();
        let corners =
            self.rectangles.iter().flat_map(|[x, y]| [[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]]);
        let corners: Vec<[f64; 2]> = corners.collect();
        let edges = slanted(&corners, largest, bounds);
        Some(Footprint { bounds, edges, limit, inside })
    }
}

/// Integer edges around `points`, in the directions of the slanted edges of their hull. The bounds cover those along
/// the axes.
fn slanted(points: &[[f64; 2]], largest: f64, bounds: [i32; 4]) -> Vec<[i32; 3]> {
    let hull = hull(points);
    let mut edges = Vec::new();
    for (i, p) in hull.iter().enumerate() {
        let q = hull[(i + 1) % hull.len()];
        let (dx, dy) = (q[0] - p[0], q[1] - p[1]);
        if dx == 0.0 || dy == 0.0 {
            continue;
        }
        // Inside is to the left.
        let scale = largest / dx.abs().max(dy.abs());
        let (a, b) = ((-dy * scale).round(), (dx * scale).round());
        let low = |p: &[f64; 2]| {
            let error = ((a * p[0]).abs() + (b * p[1]).abs()) * (4.0 * f64::EPSILON);
            a * p[0] + b * p[1] - error
        };
        let least = points.iter().map(low).fold(f64::INFINITY, f64::min);
        // A texel is touched if its best corner is inside.
        let c = -least.floor() + a.max(0.0) + b.max(0.0);
        let corners = [[bounds[0], bounds[1]], [bounds[2], bounds[1]], [bounds[0], bounds[3]], [bounds[2], bounds[3]]];
        let superfluous = corners.iter().all(|&[x, y]| a * f64::from(x) + b * f64::from(y) + c >= 0.0);
        if !superfluous {
            edges.push([a as i32, b as i32, c as i32]);
        }
    }
    edges
}

/// Corners of the convex hull, counter-clockwise, in plain doubles: only directions are taken from it.
fn hull(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    sorted.dedup();
    if sorted.len() < 3 {
        return sorted;
    }
    let left =
        |a: [f64; 2], b: [f64; 2], c: [f64; 2]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 0.0;
    let chain = |points: &mut dyn Iterator<Item = [f64; 2]>| {
        let mut chain: Vec<[f64; 2]> = Vec::new();
        for p in points {
            while chain.len() >= 2 && !left(chain[chain.len() - 2], chain[chain.len() - 1], p) {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut hull = chain(&mut sorted.iter().copied());
    hull.extend(chain(&mut sorted.iter().rev().copied()));
    hull
}

/// Whether an occludee is hidden by a buffer of distances: for each texel it is compared with the largest distance
/// from the texel to a point of it.
///
/// Distance is convex in both ends, so the largest is between corners.
pub fn is_blocked_by_distance(
    footprint: &Footprint,
    plane: &BufferPlane,
    unit: f64,
    points: &[Point3],
    buffer: &Buffer,
) -> bool {
    let beyond = points.iter().all(|&p| plane.height(p) < 0.0);
    let largest = |x: u32, y: u32| {
        let corners = [plane.corner(x, y), plane.corner(x + 1, y), plane.corner(x, y + 1), plane.corner(x + 1, y + 1)];
        let square = |a: Point3, b: Point3| (0..3).map(|k| (a[k] - b[k]) * (a[k] - b[k])).sum::<f64>();
        let all = corners.iter().flat_map(|&c| points.iter().map(move |&p| square(c, p)));
        // Seven roundings; the root halves them.
        all.fold(0.0, f64::max).sqrt() * (1.0 + 8.0 * f64::EPSILON)
    };
    footprint.inside
        && footprint.all_touched(|mut xs, y| {
            xs.all(|x| {
                let (x, y) = (x as u32, y as u32);
                let limit = if beyond { 0 } else { limit(largest(x, y), unit) };
                buffer.get(x, y) > limit
            })
        })
}
