//! Scenes in whole numbers, and segments that are free in them: exact, by determinants of 128 bits.

use sightlines_geometry::{Aabb, Point3, Random};

/// A point, in units of 2^-32 of a step of the lattice.
pub(super) type At = [i64; 3];

/// A step of the lattice.
pub(super) const STEP: i64 = 1 << 32;

/// Corners of triangles are multiples of this, so that points of them with weights that are multiples of 1/4096 are whole, too.
pub(super) const GRAIN: i64 = 1 << 12;

/// A closed box between two points.
pub(super) type Cuboid = [At; 2];

/// What may be seen.
#[derive(Debug, Clone, Copy)]
pub(super) enum Goal {
    Cuboid(Cuboid),
    /// The inner points of a triangle.
    Triangle([At; 3]),
}

/// Where numbers of the scene lie among doubles: every coordinate is exact.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    /// The size of a step of the lattice: few binary digits.
    pub(super) scale: f64,
    pub(super) shift: Point3,
}

impl Place {
    pub(super) fn point(&self, p: At) -> Point3 {
        std::array::from_fn(|k| (p[k] as f64 / STEP as f64) * self.scale + self.shift[k])
    }

    pub(super) fn cuboid(&self, [min, max]: Cuboid) -> Aabb<3> {
        Aabb { min: self.point(min), max: self.point(max) }
    }

    pub(super) fn soup(&self, triangles: &[[At; 3]]) -> Vec<[Point3; 3]> {
        triangles.iter().map(|t| t.map(|p| self.point(p))).collect()
    }
}

fn sub(a: At, b: At) -> At {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// The sign of the volume of four points. Exact.
fn side(a: At, b: At, c: At, d: At) -> i32 {
    let [u, v, w] = [b, c, d].map(|p| sub(p, a));
    let [x, y, z] = [u, v, w].map(|p| p.map(|x| x as f64));
    // Differences are below 2^38, so doubles have them exactly, and the sum is off by less than 2^-49 of the magnitudes.
    let (mut sum, mut size) = (0.0, 0.0);
    for [i, j, k] in [[0, 1, 2], [1, 2, 0], [2, 0, 1]] {
        let [p, q] = [x[i] * y[j], x[j] * y[i]];
        sum += (p - q) * z[k];
        size += (p.abs() + q.abs()) * z[k].abs();
    }
    if sum.abs() > size * 1e-14 {
        return if sum > 0.0 { 1 } else { -1 };
    }
    let [u, v, w] = [u, v, w].map(|p| p.map(i128::from));
    let minor = |i: usize, j: usize| u[i] * v[j] - u[j] * v[i];
    (minor(0, 1) * w[2] + minor(1, 2) * w[0] + minor(2, 0) * w[1]).signum() as i32
}

/// Whether a segment may meet a closed triangle. Certain, except that segments in its plane are said to.
fn meets([a, b]: [At; 2], [x, y, z]: &[At; 3]) -> bool {
    let ends = [side(*x, *y, *z, a), side(*x, *y, *z, b)];
    if ends[0] * ends[1] > 0 {
        return false;
    }
    let sides = [side(a, b, *x, *y), side(a, b, *y, *z), side(a, b, *z, *x)];
    !(sides.contains(&1) && sides.contains(&-1))
}

fn are_coplanar(s: &[At; 3], t: &[At; 3]) -> bool {
    t.iter().all(|&p| side(s[0], s[1], s[2], p) == 0)
}

/// Whether a point is on a triangle. Exact.
pub(super) fn is_on(p: At, t: &[At; 3]) -> bool {
    let beside = |k: usize| {
        let mut q = p;
        q[k] += STEP;
        q
    };
    let off = (0..3).map(beside).find(|&q| side(t[0], t[1], t[2], q) != 0);
    side(t[0], t[1], t[2], p) == 0 && off.is_some_and(|q| meets([p, q], t))
}

/// The point of a triangle with these weights of its corners, of 4096 together.
pub(super) fn weighted(t: &[At; 3], w: [i64; 3]) -> At {
    std::array::from_fn(|k| (0..3).map(|i| t[i][k] / GRAIN * w[i]).sum())
}

/// Whether a segment shows that its goal can be seen through an open set of lines: it meets nothing, except that, where it ends on a
/// triangle, there may be others in the same plane, and where it begins in a box that is flat, in the plane of the box.
fn is_free(triangles: &[[At; 3]], segment: [At; 2], from: &Cuboid, goal: &Goal) -> bool {
    let in_goal = |t: &[At; 3]| match goal {
        Goal::Cuboid(_) => false,
        Goal::Triangle(g) => side(g[0], g[1], g[2], segment[0]) != 0 && are_coplanar(g, t),
    };
    let flat = (0..3).find(|&k| from[0][k] == from[1][k] && segment[1][k] != from[0][k]);
    let in_start = |t: &[At; 3]| flat.is_some_and(|k| t.iter().all(|p| p[k] == from[0][k]));
    triangles.iter().all(|t| !meets(segment, t) || in_goal(t) || in_start(t))
}

fn mix(a: i64, b: i64, random: &mut Random) -> i64 {
    a + ((b - a) as f64 * random.unit()) as i64
}

fn point_of([min, max]: &Cuboid, random: &mut Random) -> At {
    std::array::from_fn(|k| mix(min[k], max[k], random))
}

/// A point of a goal near the line through two points, or anywhere in it.
fn point_of_goal(goal: &Goal, near: Option<[At; 2]>, random: &mut Random) -> Option<At> {
    match goal {
        Goal::Cuboid(cuboid) => Some(match near {
            Some(line) => clipped(line, cuboid, random)?,
            None => point_of(cuboid, random),
        }),
        Goal::Triangle(t) => {
            let weights = match near {
                Some(line) => weights_where(line, t)?,
                None => [random.unit(), random.unit(), random.unit()],
            };
            let sum: f64 = weights.iter().sum();
            let [u, v] = [weights[0] / sum, weights[1] / sum].map(|w| (w * 4096.0).round() as i64);
            let w = [u, v, 4096 - u - v];
            w.iter().all(|&w| w > 0).then(|| weighted(t, w))
        }
    }
}

/// A point of a box that is near a line.
fn clipped([p, q]: [At; 2], [min, max]: &Cuboid, random: &mut Random) -> Option<At> {
    let (p, d) = (p.map(|x| x as f64), sub(q, p).map(|x| x as f64));
    let (mut first, mut last) = (f64::NEG_INFINITY, f64::INFINITY);
    for k in 0..3 {
        let [mut a, mut b] = [min[k], max[k]].map(|x| (x as f64 - p[k]) / d[k]);
        if d[k] == 0.0 {
            (a, b) = (f64::NEG_INFINITY, f64::INFINITY);
        }
        first = first.max(a.min(b));
        last = last.min(a.max(b));
    }
    if !(first.is_finite() && last.is_finite() && first <= last + 1e-9) {
        return None;
    }
    let at = first + (last - first) * random.unit();
    Some(std::array::from_fn(|k| ((p[k] + d[k] * at).round() as i64).clamp(min[k], max[k])))
}

/// The weights of the point where a line meets the plane of a triangle.
fn weights_where([p, q]: [At; 2], t: &[At; 3]) -> Option<[f64; 3]> {
    let float = |p: At| p.map(|x| x as f64);
    let [u, v, w] = [sub(t[1], t[0]), sub(t[2], t[0]), sub(p, t[0])].map(float);
    let d = float(sub(q, p));
    let det = |a: [f64; 3], b: [f64; 3], c: [f64; 3]| {
        (a[1] * b[2] - a[2] * b[1]) * c[0] + (a[2] * b[0] - a[0] * b[2]) * c[1] + (a[0] * b[1] - a[1] * b[0]) * c[2]
    };
    let all = det(u, v, d);
    let [b, c] = [det(w, v, d) / all, det(u, w, d) / all];
    (b > 0.0 && c > 0.0 && b + c < 1.0).then_some([1.0 - b - c, b, c])
}

/// A point beside an edge of some triangle: on it, or very near.
fn beside_edge(triangles: &[[At; 3]], random: &mut Random) -> At {
    let t = &triangles[random.below(triangles.len())];
    let i = random.below(3);
    let (p, q) = (t[i], t[(i + 1) % 3]);
    let at = random.unit();
    let wide = [4, GRAIN, GRAIN, 1 << 28][random.below(4)];
    std::array::from_fn(|k| p[k] + ((q[k] - p[k]) as f64 * at) as i64 + mix(-wide, wide, random))
}

/// A free segment from a box to a goal, out of `n`: at random, past an edge, and past two edges.
pub(super) fn witness(triangles: &[[At; 3]], from: &Cuboid, goal: &Goal, n: usize, seed: u64) -> Option<[At; 2]> {
    let mut random = Random::new(seed);
    (0..n).find_map(|i| {
        let segment = if i % 4 == 0 || triangles.is_empty() {
            [point_of(from, &mut random), point_of_goal(goal, None, &mut random)?]
        } else {
            let past = beside_edge(triangles, &mut random);
            match i % 4 {
                1 => {
                    let eye = point_of(from, &mut random);
                    [eye, point_of_goal(goal, Some([eye, past]), &mut random)?]
                }
                2 => {
                    let to = point_of_goal(goal, None, &mut random)?;
                    [clipped([to, past], from, &mut random)?, to]
                }
                _ => {
                    let eye = clipped([beside_edge(triangles, &mut random), past], from, &mut random)?;
                    [eye, point_of_goal(goal, Some([eye, past]), &mut random)?]
                }
            }
        };
        is_free(triangles, segment, from, goal).then_some(segment)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: i64, y: i64, z: i64) -> At {
        [x, y, z].map(|x| x * STEP)
    }

    #[test]
    fn witnesses_find_slits_and_no_others() {
        let quad = |y: [i64; 2]| {
            let c = |y: i64, z: i64| [4 * STEP, y, z * STEP];
            [[c(y[0], -9), c(y[1], -9), c(y[1], 9)], [c(y[0], -9), c(y[1], 9), c(y[0], 9)]]
        };
        let walls = |gap: i64| [quad([-9 * STEP, 0]), quad([gap, 9 * STEP])].concat();
        let (v, e) = ([at(0, 0, 0), at(1, 1, 1)], [at(8, -1, 0), at(9, 1, 1)]);
        let t = [at(8, -1, 0), at(8, 1, 0), at(8, 0, 1)];
        for goal in [Goal::Cuboid(e), Goal::Triangle(t)] {
            for (gap, seen) in [(0, false), (-1, false), (1 << 20, true), (1 << 26, true)] {
                let found = witness(&walls(gap), &v, &goal, 20_000, 1);
                assert_eq!(found.is_some(), seen, "{gap} {goal:?}: {found:?}");
            }
        }
        assert_eq!([side(at(0, 0, 0), at(1, 0, 0), at(0, 1, 0), at(0, 0, 1)), side(t[0], t[1], t[2], t[0])], [1, 0]);
        assert_eq!(side([0; 3], at(16, 0, 0), at(0, 16, 0), [STEP, STEP, 1]), 1);
    }
}
