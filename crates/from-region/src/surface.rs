//! Closed surfaces among the triangles of a scene.
//!
//! A *chain* is a set of triangles in which every edge lies on an even number of them. It separates points inside (a
//! ray from there crosses it an odd number of times) from points outside: the parity is the same all along a path that
//! does not meet the chain. That holds whatever else the triangles do, such as cutting each other, and it holds for
//! sets that share triangles.
//!
//! A surface that is open at one end, such as a house without a floor, is a chain as well once its hole is
//! closed by triangles that are not in the scene. It hides as long as lines cannot use the hole: if a
//! plane across an axis has the hole on one side, and the eye with what is looked at on the other.

use sightlines_cells::Scene;
use sightlines_geometry::{Aabb, Point3};
use std::collections::{BTreeMap, HashMap};

/// More holes than this, and a surface is not thought to be worth closing.
const MAX_HOLES: usize = 8;

/// A closed surface.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Chain {
    /// Triangles of the scene.
    pub(crate) triangles: Vec<[Point3; 3]>,
    /// Triangles that close its holes; each lies within one of `holes`.
    pub(crate) caps: Vec<[Point3; 3]>,
    /// Boxes around its holes; none if the scene's triangles are closed by themselves.
    pub(crate) holes: Vec<Aabb<3>>,
}

/// A triangle as places of its corners: equal corners have equal places.
type Welded = [u32; 3];

/// The chains of a scene that reach farther than `least` along every axis.
///
/// Tried are, for each object and for the scene as a whole, the pieces that hang together by edges: as they
/// are; with their holes closed; and without what has a free edge, repeatedly.
///
/// Cost: O(n log n).
pub(crate) fn chains(scene: &Scene, least: f64) -> Vec<Chain> {
    let (points, triangles) = weld(scene);
    let mut found = Vec::new();
    let mut add = |piece: &[Welded]| {
        let corners = |t: &Welded| t.map(|i| points[i as usize]);
        let bounds = Aabb::around(piece.iter().flat_map(corners));
        if (0..3).all(|k| bounds.max[k] - bounds.min[k] > least) {
            found.extend(close(piece, &bounds, &points));
        }
    };
    let mut start = 0;
    let mut object_of = Vec::with_capacity(triangles.len());
    for (object, o) in (0u32..).zip(scene.objects()) {
        let own = &triangles[start..start + o.triangles.len()];
        pieces(own).iter().for_each(|piece| add(&of(own, piece)));
        object_of.resize(start + own.len(), object);
        start += own.len();
    }
    for piece in pieces(&triangles) {
        // Pieces of one object were there before.
        if piece.iter().any(|&t| object_of[t as usize] != object_of[piece[0] as usize]) {
            add(&of(&triangles, &piece));
        }
    }
    found
}

fn of(triangles: &[Welded], chosen: &[u32]) -> Vec<Welded> {
    chosen.iter().map(|&t| triangles[t as usize]).collect()
}

/// All corners once, and all triangles in the order of the scene.
fn weld(scene: &Scene) -> (Vec<Point3>, Vec<Welded>) {
    let mut places: HashMap<[u64; 3], u32> = HashMap::new();
    let mut points = Vec::new();
    let mut place = |p: Point3| {
        // Negative zero is zero.
        *places.entry(p.map(|x| (x + 0.0).to_bits())).or_insert_with(|| {
            points.push(p);
            points.len() as u32 - 1
        })
    };
    let corners = scene.objects().iter().flat_map(|o| o.corners());
    let triangles = corners.map(|t| t.map(&mut place)).collect();
    (points, triangles)
}

/// The edges of a triangle with two different ends, lower place first. A triangle with equal corners is a
/// segment there and back, and bounds nothing.
fn edges(t: &Welded) -> impl Iterator<Item = [u32; 2]> {
    let t = *t;
    let is_whole = t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
    (0..3).filter(move |_| is_whole).map(move |k| {
        let (a, b) = (t[k], t[(k + 1) % 3]);
        [a.min(b), a.max(b)]
    })
}

/// Each edge with the triangles on it, by edge.
fn by_edge(triangles: &[Welded]) -> Vec<([u32; 2], u32)> {
    let each = (0u32..).zip(triangles).flat_map(|(i, t)| edges(t).map(move |e| (e, i)));
    let mut all: Vec<_> = each.collect();
    all.sort_unstable();
    all
}

/// The root of `i`, with the way there halved.
fn root(parents: &mut [u32], mut i: u32) -> u32 {
    while parents[i as usize] != i {
        parents[i as usize] = parents[parents[i as usize] as usize];
        i = parents[i as usize];
    }
    i
}

/// Makes two sets one; the lower root stays.
fn join(parents: &mut [u32], a: u32, b: u32) {
    let (a, b) = (root(parents, a), root(parents, b));
    parents[a.max(b) as usize] = a.min(b);
}

/// Triangles that hang together by edges, as indices.
fn pieces(triangles: &[Welded]) -> Vec<Vec<u32>> {
    let mut parents: Vec<u32> = (0..triangles.len() as u32).collect();
    for pair in by_edge(triangles).windows(2) {
        if pair[0].0 == pair[1].0 {
            join(&mut parents, pair[0].1, pair[1].1);
        }
    }
    let mut found: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for i in 0..triangles.len() as u32 {
        found.entry(root(&mut parents, i)).or_default().push(i);
    }
    found.into_values().collect()
}

/// The edges on an odd number of triangles.
fn odd_edges(triangles: &[Welded]) -> Vec<[u32; 2]> {
    let all = by_edge(triangles);
    let runs = all.chunk_by(|a, b| a.0 == b.0);
    runs.filter(|run| run.len() % 2 == 1).map(|run| run[0].0).collect()
}

/// The chains that a piece can be made to.
fn close(piece: &[Welded], bounds: &Aabb<3>, points: &[Point3]) -> Vec<Chain> {
    let corners = |t: &Welded| t.map(|i| points[i as usize]);
    let odd = odd_edges(piece);
    let mut found = Vec::new();
    if let Some((holes, caps)) = caps(&odd, bounds, points) {
        let caps = caps.iter().map(corners).collect();
        found.push(Chain { triangles: piece.iter().map(corners).collect(), caps, holes });
    }
    if !odd.is_empty() {
        let rest = without_fins(piece);
        if !rest.is_empty() && odd_edges(&rest).is_empty() {
            let triangles = rest.iter().map(corners).collect();
            found.push(Chain { triangles, caps: Vec::new(), holes: Vec::new() });
        }
    }
    found
}

/// Boxes around holes and fans of triangles over them, if each hole is at an end of the piece: within a quarter of
/// it along some axis. A hole in the middle is one that lines will use.
///
/// The odd edges of a set of triangles come together in even numbers at every corner (each triangle has two edges or none
/// at a corner). So in the fan from a corner of a hole over the hole's edges, the edges between the fan's triangles
/// are on an even number of them, and what is left of the fan's border is the hole's.
fn caps(odd: &[[u32; 2]], bounds: &Aabb<3>, points: &[Point3]) -> Option<(Vec<Aabb<3>>, Vec<Welded>)> {
    let mut ends: Vec<u32> = odd.iter().flatten().copied().collect();
    ends.sort_unstable();
    ends.dedup();
    let place = |p: u32| ends.binary_search(&p).expect("ends of odd edges are listed") as u32;
    let mut parents: Vec<u32> = (0..ends.len() as u32).collect();
    for &[a, b] in odd {
        join(&mut parents, place(a), place(b));
    }
    let mut holes: BTreeMap<u32, Vec<[u32; 2]>> = BTreeMap::new();
    for &e in odd {
        holes.entry(root(&mut parents, place(e[0]))).or_default().push(e);
    }
    if holes.len() > MAX_HOLES {
        return None;
    }
    let mut boxes = Vec::with_capacity(holes.len());
    let mut fans = Vec::new();
    for (lowest, edges) in holes {
        let hole = Aabb::around(edges.iter().flatten().map(|&p| points[p as usize]));
        let quarter = |k: usize| (bounds.max[k] - bounds.min[k]) / 4.0;
        let at_an_end =
            |k: usize| hole.max[k] <= bounds.min[k] + quarter(k) || hole.min[k] >= bounds.max[k] - quarter(k);
        if !(0..3).any(at_an_end) {
            return None;
        }
        let apex = ends[lowest as usize];
        fans.extend(edges.iter().filter(|e| !e.contains(&apex)).map(|&[a, b]| [apex, a, b]));
        boxes.push(hole);
    }
    Some((boxes, fans))
}

/// What stays of a piece when triangles with an edge that no other one has are taken away, until there are none.
fn without_fins(piece: &[Welded]) -> Vec<Welded> {
    let all = by_edge(piece);
    let mut counts: HashMap<[u32; 2], u32> = HashMap::new();
    all.iter().for_each(|(e, _)| *counts.entry(*e).or_default() += 1);
    let mut stays = vec![true; piece.len()];
    let mut free: Vec<u32> = (0..piece.len() as u32).collect();
    while let Some(i) = free.pop() {
        let t = &piece[i as usize];
        if !stays[i as usize] || !edges(t).any(|e| counts[&e] == 1) {
            continue;
        }
        stays[i as usize] = false;
        for e in edges(t) {
            *counts.get_mut(&e).expect("edges were counted") -= 1;
            let first = all.partition_point(|(other, _)| *other < e);
            free.extend(all[first..].iter().take_while(|(other, _)| *other == e).map(|(_, i)| *i));
        }
    }
    piece.iter().zip(stays).filter(|(_, stays)| *stays).map(|(t, _)| *t).collect()
}

#[cfg(test)]
mod tests;
