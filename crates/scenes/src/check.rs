//! Checks of plans, shared by the tests of several generators.

use sightlines_cells::Plan;
use sightlines_geometry::Segment2;
use std::collections::BTreeMap;

/// FNV-1a over the whole content of a plan, so that a changed bit changes the number.
pub(crate) fn checksum(plan: &Plan) -> u64 {
    let mut hash = 0xCBF2_9CE4_8422_2325_u64;
    let mut eat = |bytes: &[u8]| {
        for &b in bytes {
            hash = (hash ^ u64::from(b)).wrapping_mul(0x0100_0000_01B3);
        }
    };
    for l in plan.lines() {
        [l.a.x, l.a.y, l.b.x, l.b.y].iter().for_each(|x| eat(&x.to_bits().to_le_bytes()));
        [l.left, l.right].iter().for_each(|g| eat(&g.map_or(u64::MAX, u64::from).to_le_bytes()));
        eat(&[u8::from(l.opaque)]);
    }
    for o in plan.objects() {
        eat(o.name.as_bytes());
        o.bounds.min.iter().chain(&o.bounds.max).for_each(|x| eat(&x.to_bits().to_le_bytes()));
    }
    hash
}

/// Whether opaque walls cover the four sides of the bounding box without a gap.
pub(crate) fn outer_boundary_is_closed(plan: &Plan) -> bool {
    let b = plan.bounds();
    (0..4).all(|side| {
        let (axis, at) = (side % 2, if side < 2 { b.min[side % 2] } else { b.max[side % 2] });
        let mut on_side: Vec<[f64; 2]> = plan
            .lines()
            .iter()
            .filter(|l| l.opaque && l.a.to_array()[axis] == at && l.b.to_array()[axis] == at)
            .map(|l| [l.a.to_array()[1 - axis], l.b.to_array()[1 - axis]])
            .map(|[s, t]| [s.min(t), s.max(t)])
            .collect();
        on_side.sort_unstable_by(|s, t| s[0].total_cmp(&t[0]));
        let reached = on_side.iter().fold(b.min[1 - axis], |r, s| if s[0] <= r { r.max(s[1]) } else { r });
        reached == b.max[1 - axis]
    })
}

/// Number of pairs of lines that meet elsewhere than in a common end point.
pub(crate) fn crossings(plan: &Plan) -> usize {
    let lines: Vec<Segment2> = plan.lines().iter().map(|l| Segment2::new(l.a, l.b)).collect();
    // Buckets by a coarse grid keep this linear for large plans.
    let bucket = |x: f64| (x / 64.0).floor() as i64;
    let mut buckets: BTreeMap<(i64, i64), Vec<usize>> = BTreeMap::new();
    for (i, s) in lines.iter().enumerate() {
        for x in bucket(s.a.x.min(s.b.x))..=bucket(s.a.x.max(s.b.x)) {
            for y in bucket(s.a.y.min(s.b.y))..=bucket(s.a.y.max(s.b.y)) {
                buckets.entry((x, y)).or_default().push(i);
            }
        }
    }
    let mut bad: Vec<(usize, usize)> = Vec::new();
    for list in buckets.values() {
        for (k, &i) in list.iter().enumerate() {
            bad.extend(list[k + 1..].iter().filter(|&&j| meet_badly(&lines[i], &lines[j])).map(|&j| (i, j)));
        }
    }
    bad.sort_unstable();
    bad.dedup();
    bad.len()
}

fn meet_badly(s: &Segment2, t: &Segment2) -> bool {
    let inside = |s: &Segment2, p| s.contains(p) && p != s.a && p != s.b;
    let same = (s.a == t.a && s.b == t.b) || (s.a == t.b && s.b == t.a);
    same || s.crosses(t) || inside(s, t.a) || inside(s, t.b) || inside(t, s.a) || inside(t, s.b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sightlines_geometry::Point2;

    /// The impostor: a box with a gap is not closed, crossing walls are counted.
    #[test]
    fn checks_can_fail() {
        let p = |x: f64, y: f64| Point2::new(x, y);
        let mut walls =
            vec![(p(0., 0.), p(4., 0.)), (p(4., 0.), p(4., 4.)), (p(4., 4.), p(0., 4.)), (p(0., 4.), p(0., 1.))];
        let open = Plan::from_walls(walls.clone()).unwrap();
        assert!(!outer_boundary_is_closed(&open) && crossings(&open) == 0);
        walls.push((p(0., 1.), p(0., 0.)));
        let closed = Plan::from_walls(walls.clone()).unwrap();
        assert!(outer_boundary_is_closed(&closed) && checksum(&closed) != checksum(&open));
        walls.push((p(1., 1.), p(1., 0.)));
        assert_eq!(crossings(&Plan::from_walls(walls).unwrap()), 1);
    }
}
