//! Sight between points, in plain loops over all walls in integers.

use crate::Walls;

fn cross(o: [i64; 2], p: [i64; 2], q: [i64; 2]) -> i64 {
    (p[0] - o[0]) * (q[1] - o[1]) - (p[1] - o[1]) * (q[0] - o[0])
}

fn dot(o: [i64; 2], p: [i64; 2], q: [i64; 2]) -> i64 {
    (p[0] - o[0]) * (q[0] - o[0]) + (p[1] - o[1]) * (q[1] - o[1])
}

/// A point of the line from `a` to `b`, as a fraction of the way: numerator, positive denominator.
type Way = (i64, i64);

fn less(p: Way, q: Way) -> bool {
    p.0 * q.1 < q.0 * p.1
}

/// Where a wall has points in common with the line: a stretch of the way, and the sides of the line that it has points on.
fn contact(w: &[i64; 4], a: [i64; 2], b: [i64; 2]) -> Option<(Way, Way, bool, bool)> {
    let (p, q) = ([w[0], w[1]], [w[2], w[3]]);
    let (s, t) = (cross(a, b, p), cross(a, b, q));
    let length = dot(a, b, b);
    let way = |x: [i64; 2]| (dot(a, b, x), length);
    if s == 0 && t == 0 {
        let (from, to) = if less(way(p), way(q)) { (way(p), way(q)) } else { (way(q), way(p)) };
        return Some((from, to, false, false));
    }
    if (s > 0 && t > 0) || (s < 0 && t < 0) {
        return None;
    }
    // The wall meets the line at s / (s - t) of its own way.
    let d = s - t;
    let (n, d) = (way(p).0 * d + s * (way(q).0 - way(p).0), length * d);
    let at = if d < 0 { (-n, -d) } else { (n, d) };
    Some((at, at, s > 0 || t > 0, s < 0 || t < 0))
}

/// Whether no wall touches the line strictly between its ends.
pub(crate) fn sees_brute(walls: &Walls, a: [i64; 2], b: [i64; 2]) -> bool {
    let (start, end) = ((0, 1), (1, 1));
    a == b
        || walls.iter().filter_map(|w| contact(w, a, b)).all(|(from, to, ..)| {
            let point = !less(from, to);
            let inside = less(start, from) && less(from, end);
            if point { !inside } else { !(less(from, end) && less(start, to)) }
        })
}

/// Whether no contact between the ends has walls on both sides of the line.
pub(crate) fn sees_touching(walls: &Walls, a: [i64; 2], b: [i64; 2]) -> bool {
    if a == b {
        return true;
    }
    let (start, end) = ((0, 1), (1, 1));
    let contacts: Vec<_> = walls.iter().filter_map(|w| contact(w, a, b)).collect();
    // Stretches along the line, joined where they touch.
    let mut stretches: Vec<(Way, Way)> = contacts.iter().map(|c| (c.0, c.1)).collect();
    loop {
        let touching = |p: &(Way, Way), q: &(Way, Way)| !less(p.1, q.0) && !less(q.1, p.0);
        let n = stretches.len();
        let found =
            (0..n).flat_map(|i| (i + 1..n).map(move |j| (i, j))).find(|&(i, j)| touching(&stretches[i], &stretches[j]));
        let Some((i, j)) = found else { break };
        let (p, q) = (stretches[i], stretches.remove(j));
        stretches[i] = (if less(p.0, q.0) { p.0 } else { q.0 }, if less(p.1, q.1) { q.1 } else { p.1 });
    }
    stretches.iter().all(|stretch| {
        let within = |c: &&(Way, Way, bool, bool)| {
            // Walls that leave the line at the two points themselves do not count.
            !less(c.0, stretch.0) && !less(stretch.1, c.0) && less(start, c.0) && less(c.0, end)
        };
        let sides = contacts.iter().filter(within);
        let (left, right) = sides.fold((false, false), |(l, r), c| (l || c.2, r || c.3));
        !(left && right)
    })
}
