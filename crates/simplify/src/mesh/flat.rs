//! Merging of faces that lie exactly in one plane: the surface stays the same set of points.

use super::{Change, Mesh, State};
use sightlines_geometry::{Adaptive, Orient2d, Point2, Point3, orient3d};
use std::collections::VecDeque;

/// Merges faces without changing the surface of any object. O(n) attempts in practice.
pub(crate) fn merge(mesh: &mut Mesh) {
    let mut queue: VecDeque<u32> = (0..mesh.n_places() as u32).collect();
    let mut waits = vec![true; mesh.n_places()];
    while let Some(from) = queue.pop_front() {
        waits[from as usize] = false;
        let around = mesh.around(from);
        let fits = |to: u32| Change::new(mesh, from, to).filter(|change| keeps_the_surface(mesh, change));
        let Some(change) = around.iter().find_map(|(to, _)| fits(*to)) else { continue };
        change.apply_flat(mesh);
        for (place, _) in around {
            if !std::mem::replace(&mut waits[place as usize], true) {
                queue.push_back(place);
            }
        }
    }
}

/// Whether a change leaves the set of points of each object as it is.
///
/// The faces around the place, grouped by object and plane, have to form fans: a closed one, which covers the outline
/// of its rim once; or an open one, of which the target place is one end and the other end lies opposite on one line.
/// Then the new fan covers the same outline, if none of its faces turns over. All signs are exact.
fn keeps_the_surface(mesh: &Mesh, change: &Change) -> bool {
    let mut rest: Vec<u32> = mesh.at(change.from).to_vec();
    while let Some(&first) = rest.first() {
        let object = mesh.face(first).object;
        let [a, b, c] = mesh.corners(first);
        let Some(projection) = Projection::new([a, b, c]) else { return false };
        let in_plane =
            |f: &u32| mesh.face(*f).object == object && mesh.corners(*f).iter().all(|&p| orient3d(a, b, c, p) == 0.0);
        let (fan, others): (Vec<u32>, Vec<u32>) = rest.iter().partition(|f| in_plane(f));
        if !keeps_fan(mesh, change, &fan, &projection) {
            return false;
        }
        rest = others;
    }
    true
}

/// The projection of a plane along an axis, such that its front is counter-clockwise.
struct Projection {
    axes: [usize; 2],
}

impl Projection {
    /// One in which a triangle is counter-clockwise; `None` if it has no area.
    fn new([a, b, c]: [Point3; 3]) -> Option<Self> {
        let all = [[0, 1], [1, 0], [1, 2], [2, 1], [2, 0], [0, 2]];
        all.into_iter().map(|axes| Self { axes }).find(|projection| projection.turn([a, b, c]) > 0.0)
    }

    fn point(&self, p: Point3) -> Point2 {
        Point2::new(p[self.axes[0]], p[self.axes[1]])
    }

    fn turn(&self, t: [Point3; 3]) -> f64 {
        let [a, b, c] = t.map(|p| self.point(p));
        Adaptive.orient(a, b, c)
    }
}

fn keeps_fan(mesh: &Mesh, change: &Change, fan: &[u32], projection: &Projection) -> bool {
    let centre = mesh.place(change.from);
    // The rim's edges, each counter-clockwise around the centre.
    let edge = |f: &u32| {
        let corners = mesh.face(*f).corners;
        let at = corners.iter().position(|&c| c == change.from)?;
        Some([corners[(at + 1) % 3], corners[(at + 2) % 3]])
    };
    let Some(edges) = fan.iter().map(edge).collect::<Option<Vec<[u32; 2]>>>() else { return false };
    if edges.iter().any(|e| projection.turn([centre, mesh.place(e[0]), mesh.place(e[1])]) <= 0.0) {
        return false;
    }
    // All edges turn one way, so the rim winds as often as it crosses from below to above.
    let above = |p: u32| projection.point(mesh.place(p)).y >= projection.point(centre).y;
    if edges.iter().filter(|e| !above(e[0]) && above(e[1])).count() > 1 {
        return false;
    }
    let starts: Vec<u32> = edges.iter().map(|e| e[0]).filter(|p| edges.iter().all(|e| e[1] != *p)).collect();
    let ends: Vec<u32> = edges.iter().map(|e| e[1]).filter(|p| edges.iter().all(|e| e[0] != *p)).collect();
    let fits = match (&starts[..], &ends[..]) {
        ([], []) => edges.iter().any(|e| e[0] == change.to),
        (&[s], &[e]) if s == change.to => is_opposite(mesh, change, e),
        (&[s], &[e]) if e == change.to => is_opposite(mesh, change, s),
        _ => false,
    };
    let to = mesh.place(change.to);
    let mut left = edges.iter().filter(|e| !e.contains(&change.to));
    fits && left.all(|e| projection.turn([to, mesh.place(e[0]), mesh.place(e[1])]) > 0.0)
}

/// Whether the removed place lies on the segment between its target and another place.
fn is_opposite(mesh: &Mesh, change: &Change, other: u32) -> bool {
    let [p, q, r] = [change.to, change.from, other].map(|c| mesh.place(c));
    let flat = |i: usize, j: usize, v: Point3| Point2::new(v[i], v[j]);
    let on_line = [(0, 1), (1, 2), (2, 0)]
        .into_iter()
        .all(|(i, j)| Adaptive.orient(flat(i, j, p), flat(i, j, q), flat(i, j, r)) == 0.0);
    on_line && (0..3).all(|k| (p[k] <= q[k] && q[k] <= r[k]) || (r[k] <= q[k] && q[k] <= p[k]))
}

impl Change {
    /// Applies a change that keeps the surface: kept faces become merged ones, new ones stay new.
    fn apply_flat(&self, mesh: &mut Mesh) {
        // A replacement of new faces is new.
        let any_new = mesh.at(self.from).iter().any(|&f| mesh.face(f).state == State::New);
        self.apply(mesh);
        if !any_new {
            self.moved.iter().for_each(|&(face, _)| mesh.faces[face as usize].state = State::Merged);
        }
    }
}
