//! Where walks over a mesh start, if one can find a chain at all.

use super::super::probe::{meet, segment};
use super::super::vector::sub;
use super::super::weld::Mesh;
use super::{SheetTester, Sheets};
use sightlines_geometry::{Aabb, Point3, ray_box};

impl SheetTester<'_> {
    /// Finds the triangles from which a walk may find a chain: those that the first segment meets, in the order in which it does, of
    /// pieces of the mesh that all other segments meet as well. A chain is of one piece, all segments cross it, and none of its triangles
    /// touches the target. Returns whether there are any.
    #[inline(never)]
    pub(super) fn find_starts(&mut self, v: &Aabb<3>, e: &Aabb<3>) -> bool {
        let sheets = self.sheets;
        let Self { starts, pieces, met, from_volume, volume, segment_order, .. } = self;
        if volume.0 != *v || volume.1 == 0 {
            if volume.1 == u32::MAX >> 1 {
                from_volume.fill(0);
                volume.1 = 0;
            }
            *volume = (*v, volume.1 + 1);
        }
        let mut may_hide = |t: u32| sheets.may_hide(v, e, t, volume.1, &mut from_volume[t as usize]);
        starts.clear();
        let Some(first) = segment(v, e, 0) else { return false };
        sheets.hits(first, |t, at| {
            if may_hide(t) {
                starts.push((at, t));
            }
            true
        });
        pieces.clear();
        pieces.extend(starts.iter().map(|s| (sheets.piece[s.1 as usize], false)));
        pieces.sort_unstable();
        pieces.dedup();
        let place = |pieces: &[(u32, bool)], t: u32| {
            pieces.binary_search_by_key(&sheets.piece[t as usize], |piece| piece.0).ok()
        };
        met.clear();
        met.extend(starts.iter().map(|s| s.1));
        for at in 0..segment_order.len() {
            if pieces.is_empty() {
                return false;
            }
            let Some([p, q]) = segment(v, e, segment_order[at]) else { return false };
            pieces.iter_mut().for_each(|piece| piece.1 = false);
            let mut n_left = pieces.len();
            // What earlier segments met is met by most.
            let d = sub(q, p);
            for &t in met.iter() {
                if let Some(at) = place(pieces, t)
                    && !pieces[at].1
                    && meet(sheets.mesh.corners(t), p, d).is_some()
                {
                    pieces[at].1 = true;
                    n_left -= 1;
                }
            }
            if n_left == 0 {
                continue;
            }
            sheets.hits([p, q], |t, _| {
                if let Some(at) = place(pieces, t)
                    && !pieces[at].1
                    && may_hide(t)
                {
                    pieces[at].1 = true;
                    n_left -= 1;
                    met.push(t);
                }
                n_left > 0
            });
            if n_left > 0 {
                pieces.retain(|piece| piece.1);
                met.retain(|&t| place(pieces, t).is_some());
            }
            if pieces.is_empty() {
                // What lies beside this target is often found out by the same segment.
                segment_order[..=at].rotate_right(1);
            }
        }
        starts.retain(|s| place(pieces, s.1).is_some());
        starts.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        !starts.is_empty()
    }
}

impl Sheets {
    /// Passes the triangles that a segment meets to `each`, with the parameter of the hit, until it returns `false`; in
    /// doubles. Only used where an error leads to the answer `false`, or to a walk.
    #[inline(never)]
    fn hits(&self, [p, q]: [Point3; 2], mut each: impl FnMut(u32, f64) -> bool) {
        let d = sub(q, p);
        // An axis without motion is left out.
        let inverse = d.map(|x| if x == 0.0 { f64::NAN } else { 1.0 / x });
        let enter = |b: &Aabb<3>| {
            let [first, last] = ray_box(b, p, inverse);
            first.max(0.0) <= last.min(1.0) + 1e-12
        };
        let more = std::cell::Cell::new(true);
        let wanted = |b: &Aabb<3>| more.get() && enter(b);
        self.tree.visit(wanted, |t| {
            if wanted(&self.boxes[t as usize])
                && let Some(at) = meet(self.mesh.corners(t), p, d)
            {
                more.set(each(t, at));
            }
        });
    }
}

/// For each triangle the least one of its piece: of those that hang together by edges. O(n) but for a factor that never exceeds 5.
pub(super) fn pieces(mesh: &Mesh) -> Vec<u32> {
    let mut parents: Vec<u32> = (0..mesh.triangles().len() as u32).collect();
    let root = |parents: &mut [u32], mut t: u32| {
        while parents[t as usize] != t {
            parents[t as usize] = parents[parents[t as usize] as usize];
            t = parents[t as usize];
        }
        t
    };
    for edge in 0..mesh.edges().len() as u32 {
        for pair in mesh.triangles_at(edge).windows(2) {
            let [a, b] = [pair[0], pair[1]].map(|t| root(&mut parents, t));
            parents[a.max(b) as usize] = a.min(b);
        }
    }
    (0..parents.len() as u32).map(|t| root(&mut parents, t)).collect()
}

#[cfg(test)]
mod tests {
    use super::super::Sheets;
    use sightlines_geometry::{Aabb, Point3};

    /// A wall from `y` to `to` at `x`, of 20 by 20 squares.
    fn wall(x: f64, y: f64, to: f64) -> Vec<[Point3; 3]> {
        let at = |i: u32, k: u32| [x, y + (to - y) * f64::from(i) / 20.0, f64::from(k) - 10.0];
        let square = |n: u32| {
            let (i, k) = (n / 20, n % 20);
            [[at(i, k), at(i + 1, k), at(i, k + 1)], [at(i + 1, k), at(i + 1, k + 1), at(i, k + 1)]]
        };
        (0..400).flat_map(square).collect()
    }

    /// What only two walls hide together is given up without a walk; what one of them hides is found by one.
    #[test]
    fn nothing_is_walked_over_that_some_lines_pass_by() {
        let both = Sheets::new(&[wall(2.0, -10.0, 0.3), wall(2.5, -0.3, 10.0)].concat());
        let whole = Sheets::new(&wall(2.0, -10.0, 10.0));
        let v = Aabb { min: [-1.0, -1.0, -1.0], max: [0.0, 1.0, 1.0] };
        let (mut n_hidden, mut tester, mut by_one) = (0, both.tester(), whole.tester());
        for k in 0..40 {
            let y = f64::from(k) / 40.0 - 0.5;
            let e = Aabb { min: [6.0, y - 0.1, 0.0], max: [7.0, y + 0.1, 0.2] };
            assert!(!tester.hides(&v, &e, 1024) && by_one.hides(&v, &e, 1024));
            n_hidden += 1;
        }
        assert!(n_hidden == 40 && tester.n_walked() < n_hidden, "{}", tester.n_walked());
        assert!(by_one.n_walked() >= 4 * n_hidden, "{}", by_one.n_walked());
        // Off to the side one of both walls hides, and is walked over.
        let e = Aabb { min: [6.0, 8.0, 0.0], max: [7.0, 8.1, 0.2] };
        assert!(tester.hides(&v, &e, 1024) && tester.n_walked() > 0);
        // Without pieces, as if all triangles hung together, every wall would be walked over.
        let mut joined = Sheets::new(&[wall(2.0, -10.0, 0.3), wall(2.5, -0.3, 10.0)].concat());
        joined.piece.fill(0);
        let mut tester = joined.tester();
        let e = Aabb { min: [6.0, -0.1, 0.0], max: [7.0, 0.1, 0.2] };
        assert!(!tester.hides(&v, &e, 1024) && tester.n_walked() >= 4, "{}", tester.n_walked());
    }
}
