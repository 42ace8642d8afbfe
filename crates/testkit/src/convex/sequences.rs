//! Sequences of portals, each decided by all lines that touch four of its edges, in exact arithmetic.
//!
//! If any line passes a sequence, or touches it, then one does that touches four edges of it: from a line that
//! passes one can turn and move it until so many are touched, because portals are bounded. So if none of those
//! passes all edges on the inner side or on them, no line passes.

use super::lines::{Six, SurdLine, edge_row, lines_touching};
use super::surd::{Surd, approximate};
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};
use sightlines_cells::{CellGraph, CellId, Convex};
use sightlines_geometry::{Point3, Portal3, orient3d};
use std::collections::BTreeMap;

/// Whether lines pass a sequence of portals. The order is that of how much can be seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Passable {
    /// None does: proven.
    Blocked,
    /// Some touch it, or lie in the plane of a portal; none was found that passes. Nothing is proven.
    Touched,
    /// An open set of lines does: proven by one that passes all edges strictly.
    Open,
}

/// Decides a sequence of portals, each crossed forwards, the next in front of the one before. O(edges⁵); meant for up
/// to six portals whose corners are small integers, or such over a power of two.
///
/// # Panics
/// If the sequence is empty, or a coordinate is not finite.
pub fn sequence_brute_force(portals: &[Portal3]) -> Passable {
    assert!(!portals.is_empty(), "a sequence has a portal");
    if portals.len() == 1 {
        return Passable::Open;
    }
    let exact: Vec<Vec<[BigInt; 3]>> = scaled(portals);
    let behind = |i: usize| (0..portals.len()).any(|j| i != j && excludes(&exact[i], &exact[j], j > i));
    if (0..portals.len()).any(behind) {
        return Passable::Blocked;
    }
    let edges: Vec<[Point3; 2]> = portals.iter().flat_map(Portal3::edges).collect();
    let mut rows: Vec<Six> = Vec::new();
    for corners in &exact {
        let n = corners.len();
        rows.extend((0..n).map(|k| edge_row(&corners[k], &corners[(k + 1) % n])));
    }
    let ends = [&portals[0], &portals[portals.len() - 1]];
    let passes = |[p, q]: [Point3; 2]| p != q && edges.iter().all(|&[a, b]| orient3d(p, q, a, b) > 0.0);
    if passes(ends.map(middle)) {
        return Passable::Open;
    }
    let scale = scale_of(portals);
    let mut found: Vec<[Point3; 2]> = Vec::new();
    let mut answer = Passable::Blocked;
    for four in subsets(rows.len()) {
        for line in lines_touching(four.map(|k| &rows[k]), &rows) {
            if !touches_all(&line, &rows) {
                continue;
            }
            answer = Passable::Touched;
            let Some(ends) = crossings(&line, ends, scale) else { continue };
            let mean = |[p, q]: &[Point3; 2]| {
                let half = |a: Point3, b: Point3| [0, 1, 2].map(|k| (a[k] + b[k]) / 2.0);
                [half(*p, ends[0]), half(*q, ends[1])]
            };
            if found.iter().rev().take(40).any(|other| passes(mean(other))) || passes(centre(&found)) {
                return Passable::Open;
            }
            found.push(ends);
        }
    }
    answer
}

/// What is known of every pair of different cells, lower id first, by all sequences of up to `max_portals` portals
/// that enter no cell twice. Where longer ones could matter, a pair is at least `Touched`.
pub fn sequences_between(graph: &CellGraph<Convex>, max_portals: usize) -> BTreeMap<[u32; 2], Passable> {
    let mut known = BTreeMap::new();
    for from in graph.cell_ids() {
        for to in graph.cell_ids().filter(|&to| to > from) {
            known.insert([from.0, to.0], Passable::Blocked);
        }
    }
    for from in graph.cell_ids() {
        walk(graph, max_portals, &mut vec![from], &mut Vec::new(), &mut known);
    }
    known
}

fn walk(
    graph: &CellGraph<Convex>,
    max_portals: usize,
    cells: &mut Vec<CellId>,
    portals: &mut Vec<Portal3>,
    known: &mut BTreeMap<[u32; 2], Passable>,
) {
    let (start, at) = (cells[0], cells[cells.len() - 1]);
    for exit in graph.exits(at) {
        if cells.contains(&exit.to) {
            continue;
        }
        let pair = [start.0.min(exit.to.0), start.0.max(exit.to.0)];
        let shape = &graph.portal(exit.portal).shape;
        portals.push(if exit.forward { shape.clone() } else { shape.reversed() });
        cells.push(exit.to);
        // A pair that is known to be open need not be decided again; what comes behind it is.
        let entry = known.get_mut(&pair).expect("all pairs are listed");
        let passable = if *entry == Passable::Open { Passable::Open } else { sequence_brute_force(portals) };
        *entry = passable.max(*entry);
        if passable != Passable::Blocked {
            if portals.len() < max_portals {
                walk(graph, max_portals, cells, portals, known);
            } else {
                let unknown = known.iter_mut().filter(|(pair, _)| pair.contains(&start.0));
                unknown.for_each(|(_, passable)| *passable = Passable::Touched.max(*passable));
            }
        }
        cells.pop();
        portals.pop();
    }
}

/// All corners times one power of two.
fn scaled(portals: &[Portal3]) -> Vec<Vec<[BigInt; 3]>> {
    let exact = |x: f64| BigRational::from_float(x).expect("coordinates are finite");
    let corners: Vec<Vec<[BigRational; 3]>> =
        portals.iter().map(|p| p.corners().iter().map(|c| c.map(exact)).collect()).collect();
    let denominators = corners.iter().flatten().flatten().map(|x| x.denom().clone());
    let scale = denominators.max().unwrap_or_else(BigInt::one);
    let whole = |x: &BigRational| x.numer() * (&scale / x.denom());
    corners.iter().map(|p| p.iter().map(|c| c.each_ref().map(whole)).collect()).collect()
}

/// The power of two that [`scaled`] multiplies by.
fn scale_of(portals: &[Portal3]) -> f64 {
    let fits = |scale: f64| portals.iter().flat_map(Portal3::corners).flatten().all(|x| (x * scale).fract() == 0.0);
    (0..200).map(|k| 2f64.powi(k)).find(|&scale| fits(scale)).unwrap_or(f64::NAN)
}

/// Whether `other` is nowhere on that side of a portal's plane on which a line has to be when it crosses: in front
/// if it comes later, else behind. Portals that are not exactly flat exclude nothing.
fn excludes(portal: &[[BigInt; 3]], other: &[[BigInt; 3]], comes_later: bool) -> bool {
    let o = &portal[0];
    let from = |p: &[BigInt; 3]| [&p[0] - &o[0], &p[1] - &o[1], &p[2] - &o[2]];
    let (u, v) = (from(&portal[1]), from(&portal[2]));
    let m = |i: usize, j: usize| &u[i] * &v[j] - &u[j] * &v[i];
    let normal = [m(1, 2), m(2, 0), m(0, 1)];
    let height = |p: &[BigInt; 3]| from(p).iter().zip(&normal).map(|(x, n)| x * n).sum::<BigInt>();
    let is_flat = portal.iter().all(|p| height(p).is_zero()) && normal.iter().any(|n| !n.is_zero());
    let is_wrong = |p: &[BigInt; 3]| if comes_later { !height(p).is_positive() } else { !height(p).is_negative() };
    is_flat && other.iter().all(is_wrong)
}

fn touches_all(line: &SurdLine, rows: &[Six]) -> bool {
    let has_direction = line.coordinates[..3].iter().any(|x| x.sign(&line.discriminant) != 0);
    // Either way of going along the line will do.
    let mut way = 0;
    has_direction
        && rows.iter().all(|row| {
            let sign = Surd::dot(&line.coordinates, row).sign(&line.discriminant);
            if way == 0 {
                way = sign;
            }
            sign == 0 || sign == way
        })
}

/// About where a line crosses the first and the last portal's plane.
fn crossings(line: &SurdLine, ends: [&Portal3; 2], scale: f64) -> Option<[Point3; 2]> {
    let l = approximate(&line.coordinates, &line.discriminant);
    let (d, m) = ([l[0], l[1], l[2]], [l[3], l[4], l[5]].map(|x| x / scale));
    let length = d.iter().map(|x| x * x).sum::<f64>();
    // The point of the line that is nearest to the origin.
    let foot = [0, 1, 2].map(|k| (d[(k + 1) % 3] * m[(k + 2) % 3] - d[(k + 2) % 3] * m[(k + 1) % 3]) / length);
    let points = ends.map(|portal| {
        let (n, c) = (portal.normal(), portal.corners()[0]);
        let along = (0..3).map(|k| n[k] * d[k]).sum::<f64>();
        let t = (0..3).map(|k| n[k] * (c[k] - foot[k])).sum::<f64>() / along;
        [0, 1, 2].map(|k| foot[k] + t * d[k])
    });
    points.iter().flatten().all(|x| x.abs() < 1e9).then_some(points)
}

fn middle(portal: &Portal3) -> Point3 {
    let n = portal.corners().len() as f64;
    [0, 1, 2].map(|k| portal.corners().iter().map(|p| p[k]).sum::<f64>() / n)
}

fn centre(found: &[[Point3; 2]]) -> [Point3; 2] {
    let n = found.len().max(1) as f64;
    [0, 1].map(|end| [0, 1, 2].map(|k| found.iter().map(|pair| pair[end][k]).sum::<f64>() / n))
}

/// All sets of four numbers below `n`.
fn subsets(n: usize) -> impl Iterator<Item = [usize; 4]> {
    (0..n).flat_map(move |a| {
        (a + 1..n).flat_map(move |b| (b + 1..n).flat_map(move |c| (c + 1..n).map(move |d| [a, b, c, d])))
    })
}

#[cfg(test)]
mod tests;
