//! Three directions at right angles in which most surfaces lie.
//!
//! The largest triangles propose directions; of all pairs at right angles the one across which most area lies is a first guess. It is then
//! turned, a little at a time, to where the edges of the triangles across each axis are at right angles to it with the least sum of
//! squares: each corner has an error of the same size, so an edge tells a direction better the longer it is. Only square roots are
//! taken, so the result has the same bits everywhere. Nothing is decided here: a poor frame hides less.

use crate::area::{area, magnitude, main_axis, spread};
use sightlines_cells::Scene;
use sightlines_geometry::Point3;
use sightlines_geometry::vector::{add, cross, dot, normal, scale, sub, unit};

/// Directions that the largest triangles propose.
const MOST_SEEDS: usize = 48;
/// Seeds that are tried as the first of a pair.
const MOST_FIRST: usize = 8;
/// The square of the sine of the angle below which two directions are one: about 1 degree.
const SAME: f64 = 4e-4;
/// By how much less area than the best a simpler choice of axes may have across it.
const SIMPLER: f64 = 1e-3;
/// Rounds of turning, and the squares of the sines of the angles within which triangles count in each.
const ROUNDS: [f64; 10] = [4e-4, 1e-4, 2.5e-5, 2.5e-5, 1e-6, 1e-6, 1e-8, 1e-8, 1e-10, 1e-10];

/// Axes, and what lies across them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FoundAxes {
    /// Unit vectors at right angles, in the order of the right hand, each as near to the axis of the scene in its place as any order allows.
    pub axes: [Point3; 3],
    /// The area of the triangles that are flat across one of them within half the gap.
    pub flat: f64,
    /// The area of all triangles.
    pub all: f64,
}

/// What is known of a triangle.
struct Face {
    corners: [Point3; 3],
    normal: Point3,
    area: f64,
}

/// Finds the axes across which most of what hides in a scene lies within half of `gap` (scene units).
///
/// Of choices that do nearly as well, the simplest: the axes of the scene, a turn about one of them, any other. `None` for a
/// scene without area. O(n log n) for n triangles.
pub fn find_axes(scene: &Scene, gap: f64) -> Option<FoundAxes> {
    let faces = faces(scene);
    if faces.is_empty() || !magnitude(&scene.bounds()).is_finite() {
        return None;
    }
    let fit = Fit { faces: &faces, most: gap / 2.0 };
    let plain = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let mut candidates = vec![plain];
    if let Some(first) = fit.first_guess() {
        let free = fit.turned(in_place(first), None);
        let about = (0..3).filter_map(|k| Some(fit.turned(upright(free, k)?, Some(k))));
        candidates.extend(about);
        candidates.push(free);
    }
    let flat: Vec<f64> = candidates.iter().map(|axes| fit.flat(axes)).collect();
    let best = flat.iter().fold(0.0f64, |m, &x| m.max(x));
    let chosen = flat.iter().position(|&x| x >= best * (1.0 - SIMPLER)).unwrap_or(0);
    let all = faces.iter().map(|f| f.area).sum();
    Some(FoundAxes { axes: candidates[chosen], flat: flat[chosen], all })
}

/// Axes along given ones, for boxes that stand along them: exactly at right angles, in the order of the right hand, each as near to the
/// axis of the scene in its place as any order allows.
///
/// Where more of what hides in a scene lies across axes that are turned from these by less than [`NEAR_SINE`], it is those: axes are
/// rounded where they are written down, to single precision or to fewer digits, and walls tell them better. A box along such axes around one along
/// the given ones is larger by that share. O(n) for n triangles.
pub fn axes_near(scene: &Scene, gap: f64, given: [Point3; 3]) -> FoundAxes {
    let faces = faces(scene);
    let fit = Fit { faces: &faces, most: gap / 2.0 };
    let given = in_place(given);
    let fitted = fit.turned(given, None);
    let is_near = (0..3).all(|k| apart(fitted[k], given[k]) <= NEAR_SINE * NEAR_SINE);
    let [of_given, of_fitted] = [given, fitted].map(|axes| fit.flat(&axes));
    let (axes, flat) = if is_near && of_fitted > of_given { (fitted, of_fitted) } else { (given, of_given) };
    FoundAxes { axes, flat, all: faces.iter().map(|f| f.area).sum() }
}

/// Whether two sets of axes are one but for their order, their signs, and turns whose sine is below [`NEAR_SINE`].
pub fn are_near(a: [Point3; 3], b: [Point3; 3]) -> bool {
    a.iter().all(|&a| b.iter().any(|&b| unit(b).is_some_and(|b| apart(a, b) <= NEAR_SINE * NEAR_SINE)))
}

/// The sine of the angle below which axes count as the same: as fine as three digits and a half tell them.
pub const NEAR_SINE: f64 = 1e-4;

/// The triangles of a scene that hide, but for those without area.
fn faces(scene: &Scene) -> Vec<Face> {
    let face = |corners: [Point3; 3]| {
        let normal = unit(normal(corners))?;
        Some(Face { corners, normal, area: area(&corners) })
    };
    scene.occluding_triangles().chain(scene.front_occluding_triangles()).filter_map(face).collect()
}

struct Fit<'a> {
    faces: &'a [Face],
    /// How far apart the corners of a flat triangle may be along its axis.
    most: f64,
}

impl Fit<'_> {
    /// The area that is flat across one of the axes.
    fn flat(&self, axes: &[Point3; 3]) -> f64 {
        let flat = |f: &&Face| {
            let along = |p: Point3| axes.map(|a| dot(a, p));
            spread(&f.corners.map(along), main_axis(along(f.normal))) <= self.most
        };
        self.faces.iter().filter(flat).map(|f| f.area).sum()
    }

    /// The area across a direction, within about a degree.
    fn across(&self, direction: Point3) -> f64 {
        let is_across = |f: &&Face| apart(f.normal, direction) < SAME;
        self.faces.iter().filter(is_across).map(|f| f.area).sum()
    }

    /// The pair of proposed directions at right angles, and the third, that have most area across them.
    fn first_guess(&self) -> Option<[Point3; 3]> {
        let mut order: Vec<usize> = (0..self.faces.len()).collect();
        order.sort_by(|&a, &b| self.faces[b].area.total_cmp(&self.faces[a].area));
        let mut seeds: Vec<Point3> = Vec::new();
        // Small triangles propose nothing new, and would take long.
        for &i in order.iter().take(64 * MOST_SEEDS) {
            let n = self.faces[i].normal;
            if seeds.iter().all(|&s| apart(s, n) >= SAME) {
                seeds.push(n);
            }
            if seeds.len() == MOST_SEEDS {
                break;
            }
        }
        let mut seeds: Vec<(Point3, f64)> = seeds.iter().map(|&s| (s, self.across(s))).collect();
        seeds.sort_by(|a, b| b.1.total_cmp(&a.1));
        let mut best: Option<([Point3; 3], f64)> = None;
        for (i, &(a, of_a)) in seeds.iter().enumerate().take(MOST_FIRST) {
            let right = seeds[i + 1..].iter().find(|(b, _)| dot(a, *b).powi(2) < SAME);
            let (b, of_b) = right.copied().unwrap_or_else(|| (any_across(a), 0.0));
            let Some(c) = unit(cross(a, b)) else { continue };
            let area = of_a + of_b + self.across(c);
            if best.is_none_or(|(_, most)| area > most) {
                best = Some(([a, cross(c, a), c], area));
            }
        }
        best.map(|(axes, _)| right_angled(axes))
    }

    /// Turns axes to where the edges of the triangles across each are at right angles to it. With `about`, only about that axis.
    fn turned(&self, mut axes: [Point3; 3], about: Option<usize>) -> [Point3; 3] {
        for within in ROUNDS {
            // A turn by the small vector w moves the value of an edge e along axis d by w · (d × e).
            let (mut a, mut b) = ([[0.0; 3]; 3], [0.0; 3]);
            for f in self.faces {
                let k = main_axis(axes.map(|d| dot(d, f.normal)));
                let d = axes[k];
                let along = f.corners.map(|p| dot(d, p));
                let is_flat = along.iter().fold(0.0f64, |m, x| m.max((x - along[0]).abs())) <= self.most;
                if !is_flat && apart(f.normal, d) >= within {
                    continue;
                }
                for i in 0..3 {
                    let e = sub(f.corners[(i + 1) % 3], f.corners[i]);
                    let (row, off) = (cross(d, e), dot(d, e));
                    for r in 0..3 {
                        for c in 0..3 {
                            a[r][c] += row[r] * row[c];
                        }
                        b[r] -= row[r] * off;
                    }
                }
            }
            let w = match about {
                Some(k) => scale(axes[k], dot(axes[k], b) / quadratic(&a, axes[k]).max(f64::MIN_POSITIVE)),
                None => solve(a, b),
            };
            if !w.iter().all(|x| x.is_finite() && x.abs() < 0.1) {
                break;
            }
            let next = axes.map(|d| add(d, cross(w, d)));
            axes = match about {
                Some(k) => upright(next, k).unwrap_or(axes),
                None => right_angled(next),
            };
        }
        axes
    }
}

/// The square of the sine of the angle between two unit vectors, either way round.
fn apart(a: Point3, b: Point3) -> f64 {
    let across = cross(a, b);
    dot(across, across)
}

/// A direction at a right angle to a unit vector: one across an axis of the scene, if there is a choice.
fn any_across(a: Point3) -> Point3 {
    let k = main_axis(a.map(|x| 1.0 - x.abs()));
    let mut axis = [0.0; 3];
    axis[k] = 1.0;
    unit(sub(axis, scale(a, a[k]))).unwrap_or(axis)
}

/// The nearest axes at right angles, the first one first. Twice, so that what is left of the angles is rounding.
fn right_angled(axes: [Point3; 3]) -> [Point3; 3] {
    let once = |[x, y, _]: [Point3; 3]| {
        let x = unit(x).unwrap_or([1.0, 0.0, 0.0]);
        let y = unit(sub(y, scale(x, dot(x, y)))).unwrap_or_else(|| any_across(x));
        [x, y, cross(x, y)]
    };
    once(once(axes))
}

/// The axes with one of them exactly along that of the scene; `None` if it is more than some 6 degrees away from it.
fn upright(axes: [Point3; 3], k: usize) -> Option<[Point3; 3]> {
    if axes[k][k] < 0.995 {
        return None;
    }
    let (i, j) = ((k + 1) % 3, (k + 2) % 3);
    let mut out = [[0.0; 3]; 3];
    out[k][k] = 1.0;
    let mut flat = axes[i];
    flat[k] = 0.0;
    out[i] = unit(unit(flat)?)?;
    out[j][i] = -out[i][j];
    out[j][j] = out[i][i];
    Some(out)
}

/// The same axes in another order and with other signs: the right-handed order that is nearest to the axes of the scene.
fn in_place(axes: [Point3; 3]) -> [Point3; 3] {
    let mut best = (axes, f64::NEG_INFINITY);
    for (i, j) in [(0, 1), (0, 2), (1, 0), (1, 2), (2, 0), (2, 1)] {
        for signs in [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]] {
            let (x, y) = (scale(axes[i], signs[0]), scale(axes[j], signs[1]));
            let z = cross(x, y);
            let near = x[0] + y[1] + z[2];
            if near > best.1 {
                best = ([x, y, z], near);
            }
        }
    }
    right_angled(best.0)
}

fn quadratic(a: &[Point3; 3], v: Point3) -> f64 {
    dot(v, a.map(|row| dot(row, v)))
}

/// Solves `a w = b` for a symmetric matrix without negative values; directions about which nothing is known stay.
fn solve(mut a: [Point3; 3], b: Point3) -> Point3 {
    let trace = a[0][0] + a[1][1] + a[2][2];
    (0..3).for_each(|k| a[k][k] += trace * 1e-12 + f64::MIN_POSITIVE);
    let [p, q, r] = [cross(a[1], a[2]), cross(a[2], a[0]), cross(a[0], a[1])];
    let det = dot(a[0], p);
    std::array::from_fn(|k| (p[k] * b[0] + q[k] * b[1] + r[k] * b[2]) / det)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equations_are_solved() {
        let a = [[4.0, 1.0, 0.0], [1.0, 3.0, -1.0], [0.0, -1.0, 2.0]];
        let w = solve(a, [6.0, 4.0, 4.0]);
        let back = a.map(|row| dot(row, w));
        assert!((0..3).all(|k| (back[k] - [6.0, 4.0, 4.0][k]).abs() < 1e-9), "{w:?}");
        assert!(solve([[0.0; 3]; 3], [0.0; 3]).iter().all(|x| x.is_nan()), "nothing is known");
    }

    #[test]
    fn axes_are_put_in_place() {
        let (s, c) = (0.6, 0.8);
        let axes = in_place([[0.0, -1.0, 0.0], [-s, 0.0, c], [c, 0.0, s]]);
        assert_eq!(axes, [[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]]);
        assert_eq!(upright(axes, 1), Some(axes));
        assert_eq!(upright(axes, 0), None);
    }
}
