//! Floors in columns, and the cells above them.

use super::grid::Grid;
use super::surfaces::{Standing, Surfaces};
use super::{LeftOut, WIDTH};
use rayon::prelude::*;
use sightlines_geometry::{Aabb, Point3};
use sightlines_progress::{Cancelled, Counter, Observer, Work};
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// Lengths, in scene units.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lengths {
    pub(super) metre: f64,
    pub(super) eye_height: [f64; 2],
}

/// Nobody stands where something is closer above than this, in metres.
const ROOM: f64 = 1.2;

/// What lies on a floor to that height is a part of it, in metres.
const ON_FLOOR: f64 = 0.1;

/// Parts of floors that are no farther apart are one to stand on, in metres.
const STEP: f64 = 0.3;

/// Nobody stands on less, in square metres; or than this share of a column.
const LEAST_AREA: f64 = 0.1;
const LEAST_SHARE: f64 = 1.0 / 16.0;

/// Most points at which it is tried whether somebody can stand on a part of a floor; as many as its area has square metres, and one.
const MOST_TRIES: u32 = 16;

/// A layer is at most so many times as high as eyes are, before its ends move to floors.
const HIGHEST: f64 = 1.5;

/// What was found.
pub(super) struct Found {
    /// For each column, the second axis first, the heights between which its cells are, ascending.
    pub(super) columns: Vec<Vec<[f64; 2]>>,
    pub(super) left_out: LeftOut,
}

impl Found {
    /// The lowest and the highest end of a cell.
    pub(super) fn heights(&self) -> Option<[f64; 2]> {
        let all = self.columns.iter().flatten();
        all.copied().reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
    }
}

/// A part of a floor: what of a triangle is in a column.
struct Piece {
    low: f64,
    high: f64,
    /// Seen from above.
    area: f64,
    /// The same of what is in the column or near to it: what is small at its border may be large beyond.
    area_near: f64,
    triangle: u32,
    /// Its corners.
    corners: Vec<Point3>,
}

/// The cells of all columns; none if there are more than `max_cells`.
pub(super) fn find(
    surfaces: &Surfaces<'_>,
    grid: &Grid,
    lengths: &Lengths,
    max_cells: usize,
    progress: Option<&dyn Observer>,
) -> Result<Option<Found>, Cancelled> {
    let n_rows = grid.n(1);
    let mut rows: Vec<Vec<u32>> = vec![Vec::new(); n_rows];
    for &floor in &surfaces.floors {
        let b = Aabb::around(surfaces.triangles()[floor as usize]);
        grid.meeting(1, b.min[grid.axes[1]], b.max[grid.axes[1]]).for_each(|row| rows[row].push(floor));
    }
    let counter = Counter::new(progress, "floors", n_rows).of(Work::Cutting);
    let n_cells = AtomicUsize::new(0);
    let row = |(row, floors): (usize, &Vec<u32>)| {
        counter.check()?;
        // What is too many does not become fewer.
        if n_cells.load(Relaxed) > max_cells {
            return Ok((Vec::new(), LeftOut::default()));
        }
        let mut columns: Vec<Vec<u32>> = vec![Vec::new(); grid.n(0)];
        for &floor in floors {
            let b = Aabb::around(surfaces.triangles()[floor as usize]);
            grid.meeting(0, b.min[grid.axes[0]], b.max[grid.axes[0]]).for_each(|column| columns[column].push(floor));
        }
        let mut left_out = LeftOut::default();
        let column = |(column, floors): (usize, Vec<u32>)| {
            Column { surfaces, grid, lengths, place: [column, row] }.cells(&floors, &mut left_out)
        };
        let columns: Vec<Vec<[f64; 2]>> = columns.into_iter().enumerate().map(column).collect();
        n_cells.fetch_add(columns.iter().map(Vec::len).sum(), Relaxed);
        counter.step()?;
        Ok((columns, left_out))
    };
    let rows = rows.par_iter().enumerate().map(row).collect::<Result<Vec<_>, Cancelled>>()?;
    if n_cells.into_inner() > max_cells {
        return Ok(None);
    }
    let mut found = Found { columns: Vec::with_capacity(grid.n(0) * n_rows), left_out: LeftOut::default() };
    for (columns, LeftOut { no_room, behind, slivers }) in rows {
        found.columns.extend(columns);
        found.left_out.no_room += no_room;
        found.left_out.behind += behind;
        found.left_out.slivers += slivers;
    }
    Ok(Some(found))
}

struct Column<'a> {
    surfaces: &'a Surfaces<'a>,
    grid: &'a Grid,
    lengths: &'a Lengths,
    place: [usize; 2],
}

impl Column<'_> {
    fn sides(&self) -> [[f64; 2]; 2] {
        [0, 1].map(|k| [0, 1].map(|end| self.grid.lines[k][self.place[k] + end]))
    }

    /// The same of a narrow column with what is around it, as wide as cells are by default.
    fn near_sides(&self) -> [[f64; 2]; 2] {
        self.sides().map(|[low, high]| {
            let more = (WIDTH * self.lengths.metre - (high - low)).max(0.0) / 2.0;
            [low - more, high + more]
        })
    }

    /// What of a triangle is between sides, seen from above.
    fn between(&self, corners: [Point3; 3], sides: [[f64; 2]; 2]) -> Vec<Point3> {
        (0..2).fold(corners.to_vec(), |polygon, k| {
            let axis = self.grid.axes[k];
            clip(&clip(&polygon, axis, sides[k][0], 1.0), axis, sides[k][1], -1.0)
        })
    }

    /// The cells above floors.
    fn cells(&self, floors: &[u32], left_out: &mut LeftOut) -> Vec<[f64; 2]> {
        let mut pieces: Vec<Piece> = floors.iter().filter_map(|&floor| self.piece(floor)).collect();
        pieces.sort_by(|p, q| q.area.total_cmp(&p.area).then(p.triangle.cmp(&q.triangle)));
        // The largest first: what is as high as others on which somebody stands needs no rays.
        let mut known = Intervals::default();
        pieces.retain(|piece| {
            let stands = known.holds([piece.low, piece.high]) || self.stands(piece, left_out);
            if stands {
                known.add([piece.low, piece.high]);
            }
            stands
        });
        pieces.sort_by(|p, q| p.low.total_cmp(&q.low).then(p.high.total_cmp(&q.high)));
        let metre = self.lengths.metre;
        let [[a, b], [c, d]] = self.sides();
        let least = (LEAST_AREA * metre * metre).min(LEAST_SHARE * (b - a) * (d - c));
        let mut runs: Vec<Run<'_>> = Vec::new();
        for patch in patches(&pieces, STEP * metre) {
            if patch.iter().map(|piece| piece.area_near).sum::<f64>() < least {
                left_out.slivers += patch.len();
                continue;
            }
            for piece in patch {
                self.join(piece, &mut runs);
            }
        }
        runs.iter().flat_map(|run| self.layers(run)).collect()
    }

    /// What of a triangle is in the column.
    fn piece(&self, triangle: u32) -> Option<Piece> {
        let corners = self.surfaces.triangles()[triangle as usize];
        let up = self.grid.up;
        let clipped = self.between(corners, self.sides());
        let area_of = |polygon: &[Point3]| area(polygon, self.grid.axes);
        let area = area_of(&clipped);
        if clipped.len() < 3 || area <= 0.0 {
            return None;
        }
        // Rounded outwards. A new corner's height comes from a few operations for each of four cuts, each wrong by at most 2^-53 of the largest number.
        let whole = Aabb::around(corners);
        let error = whole.min[up].abs().max(whole.max[up].abs()) / (1u64 << 46) as f64;
        let heights = clipped
            .iter()
            .map(|p| p[up])
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
        let (low, high) = ((heights[0] - error).max(whole.min[up]), (heights[1] + error).min(whole.max[up]));
        let near = self.between(corners, self.near_sides());
        Some(Piece { low, high, area, area_near: area_of(&near), triangle, corners: clipped })
    }

    /// Whether somebody can stand somewhere on a part of a floor; or, as who stands beside furniture may be missed, near to it on the same floor.
    fn stands(&self, piece: &Piece, left_out: &mut LeftOut) -> bool {
        let mut found = self.tried(&piece.corners, piece.area);
        if found != Standing::Free && piece.area_near > piece.area {
            let near = self.between(self.surfaces.triangles()[piece.triangle as usize], self.near_sides());
            found = self.tried(&near, piece.area_near);
        }
        match found {
            Standing::Free => {}
            Standing::Behind => left_out.behind += 1,
            Standing::NoRoom => left_out.no_room += 1,
        }
        found == Standing::Free
    }

    /// Whether somebody can stand at one of some points.
    fn tried(&self, corners: &[Point3], area: f64) -> Standing {
        let metre = self.lengths.metre;
        let tries = 1 + ((area / (metre * metre)) as u32).min(MOST_TRIES - 1);
        let mut found = Standing::NoRoom;
        for i in 0..tries {
            let p = point(corners, self.grid.axes, i, tries);
            found = self.surfaces.standing(p, ON_FLOOR * metre, ROOM * metre);
            if found == Standing::Free {
                break;
            }
        }
        found
    }

    /// Adds the heights of eyes above a part of a floor. Parts come by height, ascending.
    fn join<'a>(&self, piece: &'a Piece, runs: &mut Vec<Run<'a>>) {
        let [from, to] = self.lengths.eye_height;
        let [lowest, highest] = self.grid.within;
        let (low, high) = ((piece.low + from).max(lowest), (piece.high + to).min(highest));
        if low >= high {
            return;
        }
        match runs.last_mut() {
            Some(last) if low <= last.high => {
                last.high = last.high.max(high);
                last.floors.push(piece);
            }
            _ => runs.push(Run { low, high, floors: vec![piece] }),
        }
    }

    /// A run cut into layers, none too high, at floors where there are some.
    fn layers(&self, run: &Run<'_>) -> Vec<[f64; 2]> {
        let [from, to] = self.lengths.eye_height;
        let n = ((run.high - run.low) / (HIGHEST * (to - from))).ceil().max(1.0) as u32;
        let tall = (run.high - run.low) / f64::from(n);
        let [[a, b], [c, d]] = self.sides();
        let mut ends = vec![run.low];
        for i in 1..n {
            let at = run.low + tall * f64::from(i);
            // By height; equal heights of flat floors are together.
            let near = run.floors.iter().filter(|p| (p.low + from - at).abs() <= tall / 4.0);
            let mut best: Option<(f64, f64)> = None;
            let mut sum = (f64::NAN, 0.0);
            for piece in near {
                sum = (piece.low, if piece.low == sum.0 { sum.1 + piece.area } else { piece.area });
                if sum.1 >= LEAST_SHARE * (b - a) * (d - c) && best.is_none_or(|best| best.1 < sum.1) {
                    best = Some(sum);
                }
            }
            ends.push(best.map_or(at, |(low, _)| low + from));
        }
        ends.push(run.high);
        // Where doubles are too coarse, layers without height.
        ends.dedup();
        ends.windows(2).filter(|pair| pair[0] < pair[1]).map(|pair| [pair[0], pair[1]]).collect()
    }
}

/// Heights of eyes without a gap, and the floors below.
struct Run<'a> {
    low: f64,
    high: f64,
    floors: Vec<&'a Piece>,
}

/// Parts of floors by height, in groups with gaps between them.
fn patches(pieces: &[Piece], step: f64) -> impl Iterator<Item = &[Piece]> {
    let mut rest = pieces;
    std::iter::from_fn(move || {
        let mut high = rest.first()?.high;
        let n = rest.iter().take_while(|piece| {
            let joins = piece.low <= high + step;
            high = high.max(piece.high);
            joins
        });
        let (patch, others) = rest.split_at(n.count());
        rest = others;
        Some(patch)
    })
}

/// Closed intervals, disjoint and ascending.
#[derive(Default)]
struct Intervals(Vec<[f64; 2]>);

impl Intervals {
    /// Those that have a point in common with an interval.
    fn meeting(&self, [low, high]: [f64; 2]) -> Range<usize> {
        self.0.partition_point(|of| of[1] < low)..self.0.partition_point(|of| of[0] <= high)
    }

    fn holds(&self, [low, high]: [f64; 2]) -> bool {
        self.0.get(self.meeting([low, high]).start).is_some_and(|of| of[0] <= low && high <= of[1])
    }

    fn add(&mut self, of: [f64; 2]) {
        let at = self.meeting(of);
        let all = self.0[at.clone()].iter().fold(of, |all, of| [all[0].min(of[0]), all[1].max(of[1])]);
        self.0.splice(at, [all]);
    }
}

/// The part of a convex polygon on one side of a coordinate: above it if `side` is 1, below it if `side` is -1. Rounded.
///
/// # Source
/// Sutherland and Hodgman, "Reentrant polygon clipping", CACM 17(1), 1974.
fn clip(polygon: &[Point3], axis: usize, at: f64, side: f64) -> Vec<Point3> {
    let mut clipped = Vec::with_capacity(polygon.len() + 1);
    let inside = |p: &Point3| (p[axis] - at) * side >= 0.0;
    for (i, p) in polygon.iter().enumerate() {
        let q = &polygon[(i + 1) % polygon.len()];
        if inside(p) {
            clipped.push(*p);
        }
        if inside(p) != inside(q) {
            let t = (at - p[axis]) / (q[axis] - p[axis]);
            let mut cut: Point3 = std::array::from_fn(|k| p[k] + t * (q[k] - p[k]));
            cut[axis] = at;
            clipped.push(cut);
        }
    }
    clipped
}

/// Twice the area of a triangle along two axes, without its sign.
fn doubled_area([a, b, c]: [Point3; 3], [u, v]: [usize; 2]) -> f64 {
    ((b[u] - a[u]) * (c[v] - a[v]) - (c[u] - a[u]) * (b[v] - a[v])).abs()
}

/// The triangles of a convex polygon.
fn fan(polygon: &[Point3]) -> impl Iterator<Item = [Point3; 3]> + '_ {
    polygon.windows(2).skip(1).map(|pair| [polygon[0], pair[0], pair[1]])
}

/// The area of a convex polygon along two axes.
fn area(polygon: &[Point3], axes: [usize; 2]) -> f64 {
    fan(polygon).map(|t| doubled_area(t, axes)).sum::<f64>() / 2.0
}

/// The `i`-th of `n` points of a convex polygon, spread over it; the first is its middle.
fn point(polygon: &[Point3], axes: [usize; 2], i: u32, n: u32) -> Point3 {
    if i == 0 {
        let share = 1.0 / polygon.len() as f64;
        return std::array::from_fn(|k| polygon.iter().map(|p| p[k] * share).sum());
    }
    let mut left = 2.0 * area(polygon, axes) * (f64::from(i) / f64::from(n));
    let mut triangle = [polygon[0]; 3];
    for t in fan(polygon) {
        triangle = t;
        left -= doubled_area(t, axes);
        if left <= 0.0 {
            break;
        }
    }
    // Multiples of the inverse of the plastic number and of its square are spread evenly.
    let [x, y] = [0.754_877_666_246_692_8, 0.569_840_290_998_053_3].map(|step| (f64::from(i) * step).fract());
    let (x, y) = if x + y > 1.0 { (1.0 - x, 1.0 - y) } else { (x, y) };
    let [a, b, c] = triangle;
    std::array::from_fn(|k| a[k] + x * (b[k] - a[k]) + y * (c[k] - a[k]))
}
