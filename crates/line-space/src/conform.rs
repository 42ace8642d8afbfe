//! Faces cut along the edges that stand on them.
//!
//! A wall that stands on a floor shares no edge with it: the floor's triangles go on beneath. As seen by chains of triangles, the
//! wall's lower edge is open. Here flat regions are triangulated anew, with the open edges that lie on them as edges. No point is
//! constructed: all corners are corners of the input, and what lies on a region does so exactly.

use crate::orient::orient;
use sightlines_geometry::vector::normal;
use sightlines_geometry::{Aabb, BoxTree, Point3, orient3d};
use sightlines_multifocal::mesh::Mesh;
use spade::handles::FixedVertexHandle;
use spade::{ConstrainedDelaunayTriangulation, Intersection, LineIntersectionIterator, Point2, Triangulation};
use std::collections::{BTreeMap, BTreeSet};

/// The same surface, in which open edges that lie on a flat region are edges of it, except where they cross each other or its
/// border; none if nothing is to be cut. Errs towards less surface: what is covered an even number of times by one region may be left
/// out.
///
/// * `front_only`: for each triangle whether its front matters; empty if none does. It is told of the result, whose triangles keep their fronts
pub(crate) fn conform(mesh: &Mesh, front_only: &[bool]) -> Option<Vec<([Point3; 3], bool)>> {
    let is_front_only = |t: u32| front_only.get(t as usize) == Some(&true);
    let standing = edges_on_faces(mesh);
    let n = mesh.triangles().len();
    let mut all = Vec::new();
    let mut done = vec![false; n];
    for &seed in standing.keys() {
        if done[seed as usize] {
            continue;
        }
        let region = region(mesh, seed, &done, &is_front_only);
        let own: BTreeSet<u32> = region.iter().flat_map(|&t| mesh.outline_edges(t)).copied().collect();
        let on_it = region.iter().filter_map(|t| standing.get(t)).flatten().copied();
        let on_it: BTreeSet<u32> = on_it.filter(|edge| !own.contains(edge)).collect();
        if on_it.is_empty() {
            continue;
        }
        if let Some(triangles) = cut(mesh, &region, &own, &on_it) {
            region.iter().for_each(|&t| done[t as usize] = true);
            let (front_only, seed_corners) = (is_front_only(seed), mesh.corners(seed));
            let keeps_front = |t: &[Point3; 3]| !front_only || has_front_of(t, &seed_corners);
            let turned = |t: [Point3; 3]| if keeps_front(&t) { t } else { [t[0], t[2], t[1]] };
            all.extend(triangles.into_iter().map(|t| (turned(t), front_only)));
        }
    }
    if !done.contains(&true) {
        return None;
    }
    let rest = || (0..n as u32).filter(|&t| !done[t as usize]);
    all.reserve_exact(rest().count());
    all.extend(rest().map(|t| (mesh.corners(t), is_front_only(t))));
    Some(all)
}

/// Whether an odd number of triangles ends at an edge.
fn is_open(mesh: &Mesh, edge: u32) -> bool {
    mesh.triangles_at(edge).len() % 2 == 1
}

/// For each triangle the open edges of others that lie in its plane, near it, and do not belong to a triangle in the same plane.
fn edges_on_faces(mesh: &Mesh) -> BTreeMap<u32, Vec<u32>> {
    let boxes: Vec<Aabb<3>> = (0..mesh.triangles().len() as u32).map(|t| Aabb::around(mesh.corners(t))).collect();
    let tree = BoxTree::build(&boxes, 8);
    let meet = |a: &Aabb<3>, b: &Aabb<3>| (0..3).all(|k| a.min[k] <= b.max[k] && b.min[k] <= a.max[k]);
    let mut found: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for edge in (0..mesh.edges().len() as u32).filter(|&e| is_open(mesh, e)) {
        let ends = mesh.edges()[edge as usize].map(|v| mesh.vertices()[v as usize]);
        let around = Aabb::around(ends);
        let corners = mesh.triangles_at(edge).iter().map(|&t| mesh.corners(t));
        let corners: Vec<[Point3; 3]> = corners.collect();
        tree.visit(
            |b| meet(b, &around),
            |t| {
                let [a, b, c] = mesh.corners(t);
                let lies = |p: &Point3| orient(a, b, c, *p) == 0.0;
                if meet(&boxes[t as usize], &around)
                    && ends.iter().all(lies)
                    && !corners.iter().any(|t| t.iter().all(lies))
                {
                    found.entry(t).or_default().push(edge);
                }
            },
        );
    }
    found
}

/// The triangles in exactly the plane of `seed` that hang together with it by edges of two triangles, and block as it does.
fn region(mesh: &Mesh, seed: u32, done: &[bool], is_front_only: &dyn Fn(u32) -> bool) -> Vec<u32> {
    let [a, b, c] = mesh.corners(seed);
    let blocks_alike = |other: u32| {
        is_front_only(other) == is_front_only(seed)
            && (!is_front_only(seed) || has_front_of(&mesh.corners(other), &[a, b, c]))
    };
    let (mut region, mut known) = (vec![seed], BTreeSet::from([seed]));
    let mut n = 0;
    while let Some(&t) = region.get(n) {
        n += 1;
        for &edge in mesh.outline_edges(t) {
            let &[p, q] = mesh.triangles_at(edge) else { continue };
            let other = if p == t { q } else { p };
            let is_flat = || mesh.corners(other).iter().all(|&p| orient(a, b, c, p) == 0.0);
            if !done[other as usize] && !known.contains(&other) && is_flat() && blocks_alike(other) {
                known.insert(other);
                region.push(other);
            }
        }
    }
    region
}

/// Whether two triangles in one plane, with an area each, have their fronts on the same side of it. Exact.
fn has_front_of([p, q, r]: &[Point3; 3], &[a, b, c]: &[Point3; 3]) -> bool {
    // A point beside a corner along some axis is off the plane.
    let beside = |k: usize| {
        let mut e = a;
        e[k] += 1.0_f64.max(e[k].abs());
        e
    };
    let off = (0..3).map(beside).find(|&e| orient3d(a, b, c, e) != 0.0);
    off.is_some_and(|e| (orient3d(a, b, c, e) > 0.0) == (orient3d(*p, *q, *r, e) > 0.0))
}

/// Triangulates a region anew, with these edges in it; none if numbers or borders are beyond what can be triangulated.
fn cut(mesh: &Mesh, region: &[u32], own: &BTreeSet<u32>, on_it: &BTreeSet<u32>) -> Option<Vec<[Point3; 3]>> {
    let normal = normal(mesh.corners(region[0]));
    let drop = (0..3).max_by(|&i, &j| normal[i].abs().total_cmp(&normal[j].abs()))?;
    let flat = |v: u32| {
        let p = mesh.vertices()[v as usize];
        Point2::new(p[(drop + 1) % 3], p[(drop + 2) % 3])
    };
    // The border is where an odd number of the region's triangles ends.
    let mut uses: BTreeMap<u32, u32> = BTreeMap::new();
    region.iter().flat_map(|&t| mesh.outline_edges(t)).for_each(|&e| *uses.entry(e).or_default() += 1);
    let border: Vec<[u32; 2]> = own.iter().filter(|e| uses[e] % 2 == 1).map(|&e| mesh.edges()[e as usize]).collect();
    let standing: Vec<[u32; 2]> = on_it.iter().map(|&e| mesh.edges()[e as usize]).collect();
    let vertices: BTreeSet<u32> = border.iter().chain(&standing).flatten().copied().collect();
    let mut plane = ConstrainedDelaunayTriangulation::<Point2<f64>>::new();
    let mut handles: BTreeMap<u32, FixedVertexHandle> = BTreeMap::new();
    let mut of_handle: Vec<u32> = Vec::new();
    for &v in &vertices {
        let handle = plane.insert(flat(v)).ok()?;
        // Points that differ in space differ here.
        if handle.index() != of_handle.len() {
            return None;
        }
        handles.insert(v, handle);
        of_handle.push(v);
    }
    for (k, &[a, b]) in border.iter().chain(&standing).enumerate() {
        let (a, b) = (handles[&a], handles[&b]);
        if plane.can_add_constraint(a, b) {
            plane.add_constraint(a, b);
        } else if k < border.len() {
            return None;
        }
    }
    // Pieces of the border, each by its ends; what is there twice is none.
    let mut pieces: BTreeSet<[usize; 2]> = BTreeSet::new();
    for &[a, b] in &border {
        for met in LineIntersectionIterator::new_from_handles(&plane, handles[&a], handles[&b]) {
            match met {
                Intersection::EdgeOverlap(edge) => {
                    let mut ends = edge.vertices().map(|v| v.fix().index());
                    ends.sort_unstable();
                    if !pieces.remove(&ends) {
                        pieces.insert(ends);
                    }
                }
                Intersection::VertexIntersection(_) => {}
                Intersection::EdgeIntersection(_) => return None,
            }
        }
    }
    // From outside inwards: whether an odd number of the region's triangles covers a face.
    let mut covered: BTreeMap<usize, bool> = BTreeMap::new();
    let mut waiting = vec![(plane.outer_face().fix(), false)];
    covered.insert(plane.outer_face().fix().index(), false);
    while let Some((face, is_covered)) = waiting.pop() {
        let sides: Vec<_> = match plane.face(face).as_inner() {
            Some(inner) => inner.adjacent_edges().to_vec(),
            None => plane.convex_hull().map(|edge| if edge.face().is_outer() { edge } else { edge.rev() }).collect(),
        };
        for side in sides {
            let mut ends = side.vertices().map(|v| v.fix().index());
            ends.sort_unstable();
            let other = side.rev().face().fix();
            let is_covered = is_covered != pieces.contains(&ends);
            if let std::collections::btree_map::Entry::Vacant(entry) = covered.entry(other.index()) {
                entry.insert(is_covered);
                waiting.push((other, is_covered));
            }
        }
    }
    let inside = plane.inner_faces().filter(|face| covered.get(&face.fix().index()) == Some(&true));
    let corners = inside.map(|face| face.vertices().map(|v| mesh.vertices()[of_handle[v.fix().index()] as usize]));
    Some(corners.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The surface, cut or not.
    fn conformed(mesh: &Mesh) -> Vec<[Point3; 3]> {
        let all = || (0..mesh.triangles().len() as u32).map(|t| mesh.corners(t)).collect();
        conform(mesh, &[]).map_or_else(all, |cut| cut.into_iter().map(|(t, _)| t).collect())
    }
    use sightlines_geometry::vector::length;

    fn area(triangles: &[[Point3; 3]]) -> f64 {
        triangles.iter().map(|t| length(normal(*t)) / 2.0).sum()
    }

    fn quad([a, b, c, d]: [Point3; 4]) -> [[Point3; 3]; 2] {
        [[a, b, c], [a, c, d]]
    }

    fn floor() -> Vec<[Point3; 3]> {
        quad([[0., 0., 0.], [8., 0., 0.], [8., 8., 0.], [0., 8., 0.]]).to_vec()
    }

    fn wall(from: [f64; 2], to: [f64; 2]) -> [[Point3; 3]; 2] {
        let [[a, b], [c, d]] = [from, to];
        quad([[a, b, 0.], [c, d, 0.], [c, d, 3.], [a, b, 3.]])
    }

    #[test]
    fn walls_on_a_floor_share_edges_with_it() {
        let mut soup = floor();
        soup.extend(wall([1., 2.], [6., 3.]));
        soup.extend(wall([6., 3.], [6., 7.]));
        let before = Mesh::weld(&soup);
        let after = Mesh::weld(&conformed(&before));
        let on_floor = |mesh: &Mesh| {
            let flat = |v: u32| mesh.vertices()[v as usize][2] == 0.0;
            let all = (0..mesh.edges().len() as u32).filter(|&e| mesh.edges()[e as usize].iter().all(|&v| flat(v)));
            all.filter(|&e| mesh.triangles_at(e).len() == 3).count()
        };
        assert_eq!((on_floor(&before), on_floor(&after)), (0, 2));
        assert_eq!(area(&conformed(&before)), area(&soup));
    }

    /// The twin: nothing is changed where nothing stands, and the surface stays where it was.
    #[test]
    fn regions_with_holes_keep_them() {
        let soup = floor();
        assert_eq!(conformed(&Mesh::weld(&soup)).len(), 2);
        // A ring of eight squares around a hole, and a wall across one of them and beyond.
        let square = |i: i32, j: i32| {
            let [x, y] = [f64::from(i), f64::from(j)];
            quad([[x, y, 0.], [x + 1., y, 0.], [x + 1., y + 1., 0.], [x, y + 1., 0.]])
        };
        let ring = (0..9).filter(|&k| k != 4).flat_map(|k| square(k % 3, k / 3));
        let mut soup: Vec<[Point3; 3]> = ring.collect();
        soup.extend(wall([0.25, 0.25], [0.75, 2.5]));
        soup.extend(wall([1.25, 1.25], [1.75, 1.75]));
        let all = conformed(&Mesh::weld(&soup));
        assert!((area(&all) - area(&soup)).abs() < 1e-12, "{} {}", area(&all), area(&soup));
        let inside = |t: &[Point3; 3]| {
            let middle = [0, 1].map(|k| (t[0][k] + t[1][k] + t[2][k]) / 3.0);
            t.iter().all(|p| p[2] == 0.0) && middle.iter().all(|&x| 1.0 < x && x < 2.0)
        };
        assert!(!all.iter().any(inside), "the hole stays open");
    }

    /// A slanted plane with exact coordinates works as well; one with rounded corners is left as it is.
    #[test]
    fn planes_in_any_direction_if_they_are_exact() {
        let slanted = |t: [Point3; 3]| t.map(|[x, y, z]| [x, y + 2.0 * z, x + 3.0 * y + z]);
        let mut soup = floor();
        soup.extend(wall([1., 2.], [6., 3.]));
        let exact: Vec<[Point3; 3]> = soup.iter().map(|&t| slanted(t)).collect();
        assert!(conformed(&Mesh::weld(&exact)).len() > 4);
        let rounded: Vec<[Point3; 3]> = exact.iter().map(|t| t.map(|p| p.map(|x| x * 0.1))).collect();
        let all = conformed(&Mesh::weld(&rounded));
        assert!((area(&all) - area(&rounded)).abs() < 1e-12);
        // What is nearly flat is not cut: the floor's two triangles are still there.
        assert!(
            rounded[..2].iter().all(|t| all.contains(t))
                && !exact[..2].iter().any(|t| conformed(&Mesh::weld(&exact)).contains(t))
        );
    }
}
