//! Where to cut a cell of line space whose lines no chain blocked. Heuristic: halves cover the cell, whatever is chosen.

use crate::cell::Cell;
use crate::chain::{Gap, Shaft};
use crate::end::End;
use crate::orient::height;
use crate::side::Limit;
use crate::surface::Surface;
use sightlines_geometry::Point3;
use sightlines_geometry::vector::{cross, dot, length, sub};

/// A cut with this share of a side on its smaller part is worth it if nothing is left to decide there.
const WORTH: f64 = 0.15;

/// How near to the ends of a side other cuts may be.
const MARGIN: f64 = 0.1;

/// How far beyond an edge a cut is made, as a part of a side, so that rounding does not matter: 2^-40.
const BEYOND: f64 = 1.0 / (1u64 << 40) as f64;

/// How promising it is to cut at a gap: the share of pairs of corners whose line passes on the chain's side.
pub(crate) fn promise(surface: &Surface, shaft: &Shaft, gap: &Gap) -> f64 {
    match *gap {
        Gap::Edge { edge, triangle } => {
            let values = Values::of_edge(surface, shaft, edge, triangle);
            let all = values.n[0] * values.n[1];
            let good =
                (0..values.n[0]).map(|i| (0..values.n[1]).filter(|&j| values.of[i][j] > 0.0).count()).sum::<usize>();
            good as f64 / all as f64
        }
        Gap::Start { triangle } if straddles(surface, triangle, &shaft.cell.from) => 2.0,
        Gap::Target { triangle } if straddles(surface, triangle, &shaft.cell.to) => 2.0,
        _ => -1.0,
    }
}

/// The parts of a cell, cut as a gap suggests, or else across its longest side; none if doubles leave no room.
pub(crate) fn split(surface: &Surface, shaft: &Shaft, gap: &Gap) -> Option<[Option<Cell>; 3]> {
    let cell = shaft.cell;
    let suggested = match *gap {
        Gap::Edge { edge, triangle } => at_edge(&Values::of_edge(surface, shaft, edge, triangle), &cell).map(both),
        Gap::Start { triangle } => at_plane(surface, triangle, &cell.from, true)
            .map(|parts| parts.map(|part| part.map(|from| Cell { from, ..cell }))),
        Gap::Target { triangle } => {
            let is_triangle = cell.to.corners().len() == 3;
            at_plane(surface, triangle, &cell.to, is_triangle)
                .map(|parts| parts.map(|part| part.map(|to| Cell { to, ..cell })))
        }
        Gap::Other => None,
    };
    suggested.or_else(|| longest(&cell).map(both))
}

fn both<T>([a, b]: [T; 2]) -> [Option<T>; 3] {
    [Some(a), Some(b), None]
}

/// The parts of a cell, cut where its lines begin to pass an edge on a side, or else across its longest side; none if doubles leave no room.
pub(crate) fn split_at(shaft: &Shaft, limit: &Limit) -> Option<[Option<Cell>; 3]> {
    let halves = at_edge(&Values::of(shaft, limit.edge, limit.sign), &shaft.cell);
    halves.or_else(|| longest(&shaft.cell)).map(both)
}

fn with_from(cell: &Cell, halves: [End; 2]) -> [Cell; 2] {
    halves.map(|from| Cell { from, ..*cell })
}

fn with_to(cell: &Cell, halves: [End; 2]) -> [Cell; 2] {
    halves.map(|to| Cell { to, ..*cell })
}

/// On which side of an edge lines between corners pass: positive on the side of the chain.
#[derive(Debug)]
struct Values {
    of: [[f64; 4]; 4],
    n: [usize; 2],
}

impl Values {
    fn of_edge(surface: &Surface, shaft: &Shaft, edge: u32, triangle: u32) -> Self {
        let [x, y] = surface.edge(edge);
        let eye = shaft.line[0];
        let side = dot(cross(sub(x, eye), sub(y, eye)), sub(surface.middle(triangle), eye));
        Self::of(shaft, [x, y], if side > 0.0 { 1.0 } else { -1.0 })
    }

    fn of(shaft: &Shaft, [x, y]: [Point3; 2], sign: f64) -> Self {
        let (from, to) = (shaft.cell.from.corners(), shaft.cell.to.corners());
        let mut values = Self { of: [[0.0; 4]; 4], n: [from.len(), to.len()] };
        for (i, &a) in from.iter().enumerate() {
            let normal = cross(sub(x, a), sub(y, a));
            for (j, &b) in to.iter().enumerate() {
                values.of[i][j] = sign * dot(normal, sub(b, a));
            }
        }
        values
    }

    /// With the ends exchanged.
    fn turned(&self) -> Self {
        Self { of: std::array::from_fn(|i| std::array::from_fn(|j| self.of[j][i])), n: [self.n[1], self.n[0]] }
    }

    /// How much they differ along the first end at most, for one point of the second.
    fn spread(&self) -> f64 {
        let column = |j: usize| (0..self.n[0]).map(move |i| self.of[i][j]);
        let range = |j: usize| column(j).fold(f64::NEG_INFINITY, f64::max) - column(j).fold(f64::INFINITY, f64::min);
        (0..self.n[1]).map(range).fold(0.0, f64::max)
    }
}

fn at_edge(values: &Values, cell: &Cell) -> Option<[Cell; 2]> {
    let turned = values.turned();
    if values.spread() > turned.spread() {
        cut_by(values, &cell.from).map(|halves| with_from(cell, halves))
    } else {
        cut_by(&turned, &cell.to).map(|halves| with_to(cell, halves))
    }
}

/// Cuts an end, the first of the values, where lines begin to pass on one side.
fn cut_by(values: &Values, end: &End) -> Option<[End; 2]> {
    let (n, m) = (values.n[0], values.n[1]);
    let mean = |i: usize| values.of[i][..m].iter().sum::<f64>() / m as f64;
    // Along a side of a rectangle the opposite side moves, too.
    let pairs = |side: usize| -> ([usize; 2], Option<[usize; 2]>) {
        let (a, b) = (side, (side + 1) % n);
        ([a, b], (n == 4).then(|| [(a + 3) % 4, (b + 1) % 4]))
    };
    let change = |side: usize| {
        let ([a, b], other) = pairs(side);
        let of = |[a, b]: [usize; 2]| mean(b) - mean(a);
        of([a, b]) + other.map_or(of([a, b]), of)
    };
    let side = (0..end.n_sides_to_cut()).max_by(|&s, &t| change(s).abs().total_cmp(&change(t).abs()))?;
    let (pair, other) = pairs(side);
    let rising = change(side) > 0.0;
    if n == 4 {
        // The part of the side beyond which all lines pass on the chain's side.
        let mut reach: Option<f64> = Some(0.0);
        for [a, b] in [Some(pair), other].into_iter().flatten() {
            let [a, b] = if rising { [a, b] } else { [b, a] };
            for j in 0..m {
                let (low, high) = (values.of[a][j], values.of[b][j]);
                reach = match reach {
                    Some(r) if high > 0.0 => Some(if low < 0.0 { r.max(low / (low - high)) } else { r }),
                    _ => None,
                };
            }
        }
        if let Some(t) = reach.filter(|&t| t > 0.0 && t <= 1.0 - WORTH) {
            let t = t + BEYOND;
            return end.cut(side, if rising { t } else { 1.0 - t });
        }
    }
    let both = |k: usize| (mean(pair[k]) + other.map_or(mean(pair[k]), |o| mean(o[k]))) / 2.0;
    let (low, high) = (both(0), both(1));
    let t = low / (low - high);
    let t = if (MARGIN..=1.0 - MARGIN).contains(&t) { t } else { 0.5 };
    end.cut(side, t)
}

fn straddles(surface: &Surface, triangle: u32, end: &End) -> bool {
    let (mut up, mut down) = (false, false);
    for &p in end.corners() {
        let [h, error] = height(surface.corners(triangle), p, end.radius());
        up |= h > error;
        down |= h < -error;
    }
    up && down
}

/// Cuts an end where a plane crosses it: exactly along planes across an axis.
///
/// * `may_know`: whether the parts may know on which side they are
fn at_plane(surface: &Surface, triangle: u32, end: &End, may_know: bool) -> Option<[Option<End>; 3]> {
    let [a, b, c] = surface.corners(triangle);
    if let Some(k) = (0..3).find(|&k| a[k] == b[k] && b[k] == c[k])
        && let Some(halves) = end.cut_across(k, a[k])
    {
        return Some(both(halves));
    }
    if may_know && let Some(parts) = end.cut_by(triangle, [a, b, c]) {
        return Some(parts);
    }
    let mut heights: Vec<f64> = end.corners().iter().map(|&p| height([a, b, c], p, [0.0; 3])[0]).collect();
    if heights.len() == 4 {
        // Both sides of a rectangle along a direction count.
        heights =
            vec![heights[0] + heights[3], heights[1] + heights[2], heights[0] + heights[1], heights[3] + heights[2]];
        let sides = [[heights[0], heights[1]], [heights[2], heights[3]]];
        let side = if (sides[0][1] - sides[0][0]).abs() >= (sides[1][1] - sides[1][0]).abs() { 0 } else { 1 };
        return cut_at_root(end, side, sides[side]).map(both);
    }
    let sides = [[heights[0], heights[1]], [heights[1], heights[2]], [heights[2], heights[0]]];
    let side =
        (0..3).max_by(|&s, &t| (sides[s][1] - sides[s][0]).abs().total_cmp(&(sides[t][1] - sides[t][0]).abs()))?;
    cut_at_root(end, side, sides[side]).map(both)
}

fn cut_at_root(end: &End, side: usize, [low, high]: [f64; 2]) -> Option<[End; 2]> {
    let t = low / (low - high);
    if !(0.0..=1.0).contains(&t) {
        return None;
    }
    end.cut(side, t.clamp(MARGIN, 1.0 - MARGIN))
}

fn longest(cell: &Cell) -> Option<[Cell; 2]> {
    let longest_side = |end: &End| {
        let size = |i: usize| {
            length({
                let [a, b] = end.side(i);
                sub(b, a)
            })
        };
        let i = (0..end.n_sides_to_cut()).max_by(|&i, &j| size(i).total_cmp(&size(j))).unwrap_or(0);
        (size(i), i)
    };
    let ((a, i), (b, j)) = (longest_side(&cell.from), longest_side(&cell.to));
    if a > b {
        cell.from.cut(i, 0.5).map(|halves| with_from(cell, halves))
    } else {
        cell.to.cut(j, 0.5).map(|halves| with_to(cell, halves))
    }
}
