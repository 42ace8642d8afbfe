//! Oracle and strategies: can a directed line pass a sequence of axis-aligned rectangles in space?
//!
//! Method: with the signs of its direction given, a line reaches coordinate `c` of axis `i` at time
//! `± s_i c - q_i`. Passing the doors is a set of comparisons between times on two axes. The offsets `q`
//! are eliminated: comparisons hold for some offsets exactly if every cycle of them, through two or
//! three axes, adds up to something negative, which is a linear form in the slownesses `s`. All those
//! forms, of which there are many, cut the triangle of slownesses, corner by corner; lines are left if a
//! piece with an inside is. No simplex method, no duality, no weights, no incremental state.

use crate::exact::{Int, scaled, small};
use proptest::prelude::*;
use sightlines_geometry::{Aabb, AxialDoor, Point2};
use std::collections::BTreeSet;

/// A box in integers: low and high along each axis.
type Extent<T> = [[T; 2]; 3];

/// What a line has to do.
#[derive(Debug, Clone)]
struct Task<T> {
    /// Rectangles with their axis and direction.
    doors: Vec<(Extent<T>, usize, bool)>,
    /// A box to meet.
    target: Option<Extent<T>>,
}

/// Whether an open set of directed lines passes all doors strictly inside, each in its direction. Their
/// order does not matter. Exact for every finite coordinate.
///
/// # Panics
/// If a coordinate is not finite.
pub fn axial_stabbable_brute_force(doors: &[AxialDoor]) -> bool {
    solve(doors, None)
}

/// Whether an open set of directed lines passes all doors and meets a box at the plane of the last door
/// or beyond it. Exact for every finite coordinate.
///
/// # Panics
/// If there is no door, or a coordinate is not finite.
pub fn axial_meets_brute_force(doors: &[AxialDoor], bounds: &Aabb<3>) -> bool {
    let door = doors.last().expect("a sequence");
    let axis = usize::from(door.axis);
    // What is before the door's plane is cut off.
    let mut cut = *bounds;
    if door.forward {
        cut.min[axis] = cut.min[axis].max(door.at());
    } else {
        cut.max[axis] = cut.max[axis].min(door.at());
    }
    !cut.is_empty() && solve(doors, Some(&cut))
}

fn solve(doors: &[AxialDoor], target: Option<&Aabb<3>>) -> bool {
    let boxes = doors.iter().map(|d| d.extent).chain(target.copied());
    let points: Vec<Point2> = boxes.flat_map(|b| [0, 1, 2].map(|i| Point2::new(b.min[i], b.max[i]))).collect();
    let mut points = scaled(&points);
    for axis in 0..3 {
        let low = points.iter().skip(axis).step_by(3).map(|p| p[0].clone()).min();
        for p in points.iter_mut().skip(axis).step_by(3) {
            *p = p.each_ref().map(|x| x - low.clone().unwrap_or_default());
        }
    }
    // Up to 2^23, forms have coefficients of 23 bits and corners of 48; a new corner, before it is put in
    // lowest terms, has 2 * 48 + 26 bits.
    match small(&points, 1 << 23) {
        Some(points) => any_octant(&task(doors, target.is_some(), &points)),
        None => any_octant(&task(doors, target.is_some(), &points)),
    }
}

fn task<T: Int>(doors: &[AxialDoor], has_target: bool, points: &[[T; 2]]) -> Task<T> {
    let mut extents = points.chunks(3).map(|c| [c[0].clone(), c[1].clone(), c[2].clone()]);
    let doors = doors.iter().zip(&mut extents).map(|(d, e)| (e, usize::from(d.axis), d.forward)).collect();
    Task { doors, target: if has_target { extents.next() } else { None } }
}

fn any_octant<T: Int>(task: &Task<T>) -> bool {
    (0..8).any(|bits| {
        let signs = [bits & 1 == 1, bits & 2 == 2, bits & 4 == 4];
        task.doors.iter().all(|&(_, axis, forward)| signs[axis] == forward) && octant(task, signs)
    })
}

/// Comparisons of times: `arrows[i][j]` holds pairs of signed coordinates (c, e), and asks that axis `i`
/// is at `c` before axis `j` is at `e`.
type Arrows<T> = [[BTreeSet<(T, T)>; 3]; 3];

fn octant<T: Int>(task: &Task<T>, signs: [bool; 3]) -> bool {
    let mut arrows: Arrows<T> = Default::default();
    // Sides in the order in which lines pass them.
    let ordered = |extent: &Extent<T>, axis: usize| {
        let [low, high] = extent[axis].clone();
        if signs[axis] { [low, high] } else { [-high, -low] }
    };
    for (extent, axis, _) in &task.doors {
        let at = ordered(extent, *axis)[0].clone();
        for other in (0..3).filter(|other| other != axis) {
            let [first, last] = ordered(extent, other);
            arrows[other][*axis].insert((first, at.clone()));
            arrows[*axis][other].insert((at.clone(), last));
        }
    }
    if let Some(target) = &task.target {
        for (i, j) in [(0, 1), (1, 0), (1, 2), (2, 1), (2, 0), (0, 2)] {
            arrows[i][j].insert((ordered(target, i)[0].clone(), ordered(target, j)[1].clone()));
        }
    }
    has_inside(cycle_forms(&arrows))
}

/// What cycles add up to: forms in the slownesses that must be negative.
fn cycle_forms<T: Int>(arrows: &Arrows<T>) -> BTreeSet<[T; 3]> {
    let mut forms = BTreeSet::new();
    for (i, j) in [(0, 1), (1, 2), (2, 0)] {
        for (c, e) in &arrows[i][j] {
            for (d, f) in &arrows[j][i] {
                let mut form = [T::zero(), T::zero(), T::zero()];
                form[i] = c.clone() - f.clone();
                form[j] = d.clone() - e.clone();
                forms.insert(form);
            }
        }
    }
    for [i, j, k] in [[0, 1, 2], [0, 2, 1]] {
        for (c, d) in &arrows[i][j] {
            for (e, f) in &arrows[j][k] {
                for (g, h) in &arrows[k][i] {
                    let mut form = [T::zero(), T::zero(), T::zero()];
                    form[i] = c.clone() - h.clone();
                    form[j] = e.clone() - d.clone();
                    form[k] = g.clone() - f.clone();
                    forms.insert(form);
                }
            }
        }
    }
    forms
}

fn gcd<T: Int>(a: T, b: T) -> T {
    if b.is_zero() { a } else { gcd(b.clone(), a % b) }
}

/// Whether the triangle of all positive slownesses keeps an inside where all forms are negative.
fn has_inside<T: Int>(forms: BTreeSet<[T; 3]>) -> bool {
    let unit = |i: usize| [0, 1, 2].map(|j| if i == j { T::one() } else { T::zero() });
    let mut corners = vec![unit(0), unit(1), unit(2)];
    for form in forms {
        let at = |p: &[T; 3]| form.iter().zip(p).map(|(f, x)| f.clone() * x.clone()).fold(T::zero(), |sum, x| sum + x);
        let values: Vec<T> = corners.iter().map(at).collect();
        if values.iter().all(|v| v.sign() >= 0) {
            return false;
        }
        if values.iter().all(|v| v.sign() <= 0) {
            continue;
        }
        let n = corners.len();
        let mut cut = Vec::with_capacity(n + 1);
        for i in 0..n {
            let k = (i + 1) % n;
            if values[i].sign() <= 0 {
                cut.push(corners[i].clone());
            }
            if values[i].sign() * values[k].sign() < 0 {
                let (u, v) = (values[k].abs(), values[i].abs());
                let mean = [0, 1, 2].map(|j| u.clone() * corners[i][j].clone() + v.clone() * corners[k][j].clone());
                let divisor = gcd(gcd(mean[0].clone(), mean[1].clone()), mean[2].clone());
                cut.push(mean.map(|x| x / divisor.clone()));
            }
        }
        corners = cut;
    }
    true
}

/// Permutes and mirrors axes: the image of axis `i` is `axes[i]`, reversed if `mirror[i]`.
pub fn axial_moved(doors: &[AxialDoor], axes: [usize; 3], mirror: [bool; 3]) -> Vec<AxialDoor> {
    let one = |door: &AxialDoor| {
        let mut extent = door.extent;
        for i in 0..3 {
            let [low, high] = [door.extent.min[i], door.extent.max[i]];
            let [low, high] = if mirror[i] { [0.0 - high, 0.0 - low] } else { [low, high] };
            (extent.min[axes[i]], extent.max[axes[i]]) = (low, high);
        }
        let axis = usize::from(door.axis);
        AxialDoor { extent, axis: axes[axis] as u8, forward: door.forward != mirror[axis] }
    };
    doors.iter().map(one).collect()
}

/// All orders of the axes.
pub const AXIS_ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];

/// 2 to 10 doors of a true corridor of boxes, as a k-d tree makes them: consecutive ones lie on
/// different sides of one box, lines go one way along each axis. Shared edges and equal extents are
/// common; about as many corridors are passable as not.
pub fn axial_corridor() -> impl Strategy<Value = Vec<AxialDoor>> {
    corridor_along(3)
}

/// The same, with doors that all face one axis.
pub fn straight_axial_corridor() -> impl Strategy<Value = Vec<AxialDoor>> {
    corridor_along(1)
}

fn corridor_along(n_axes: usize) -> impl Strategy<Value = Vec<AxialDoor>> {
    let step = (0..n_axes, [0i32..12, 0..12, 0..12, 0..12], [0i32..3, 0..3, 0..3, 0..3, 0..3]);
    let moved = (prop::sample::select(AXIS_ORDERS.to_vec()), any::<[bool; 3]>());
    (prop::collection::vec(step, 2..=10), moved)
        .prop_map(|(steps, (axes, mirror))| axial_moved(&walk(&steps), axes, mirror))
}

/// A walk that goes forward along every axis.
fn walk(steps: &[(usize, [i32; 4], [i32; 5])]) -> Vec<AxialDoor> {
    let mut cell = [[0, 3]; 3];
    let mut doors = Vec::new();
    for &(axis, [a, b, c, d], [deep, grow @ ..]) in steps {
        let at = cell[axis][1];
        let mut hole = cell;
        hole[axis] = [at, at];
        cell[axis] = [at, at + 1 + deep];
        for (k, [a, b]) in [(0, [a, b]), (1, [c, d])] {
            let other = (axis + 1 + k) % 3;
            let [low, high] = hole[other];
            let from = low + a % (high - low);
            let to = from + 1 + b % (high - from);
            hole[other] = [from, to];
            cell[other] = [from - grow[2 * k], to + grow[2 * k + 1]];
        }
        let [min, max] = [0, 1].map(|side| hole.map(|h| f64::from(h[side])));
        doors.push(AxialDoor { extent: Aabb { min, max }, axis: axis as u8, forward: true });
    }
    doors
}

/// 1 to 6 doors without any relation.
pub fn any_axial_doors() -> impl Strategy<Value = Vec<AxialDoor>> {
    let side = || (-4i32..=4, 1i32..=5);
    let door = ([side(), side(), side()], 0u8..3, prop::bool::weighted(0.8)).prop_map(|(sides, axis, forward)| {
        let min = sides.map(|s| f64::from(s.0));
        let mut max = sides.map(|s| f64::from(s.0 + s.1));
        max[usize::from(axis)] = min[usize::from(axis)];
        AxialDoor { extent: Aabb { min, max }, axis, forward }
    });
    prop::collection::vec(door, 1..=6)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn door(axis: u8, min: [f64; 3], max: [f64; 3]) -> AxialDoor {
        AxialDoor { extent: Aabb { min, max }, axis, forward: true }
    }

    #[test]
    fn axial_hand_made_cases() {
        let x = |at: f64, y: [f64; 2], z: [f64; 2]| door(0, [at, y[0], z[0]], [at, y[1], z[1]]);
        let y = |at: f64, x: [f64; 2], z: [f64; 2]| door(1, [x[0], at, z[0]], [x[1], at, z[1]]);
        let unit = [0.0, 1.0];
        assert!(axial_stabbable_brute_force(&[]));
        assert!(axial_stabbable_brute_force(&[x(0., unit, unit)]));
        assert!(axial_stabbable_brute_force(&[x(0., unit, unit), x(1., [5., 6.], [-9., -8.])]));
        let bend = |low: f64| [x(0., unit, unit), x(1., [low, low + 1.], unit), x(2., unit, unit)];
        assert!(axial_stabbable_brute_force(&bend(0.5)));
        assert!(!axial_stabbable_brute_force(&bend(1.)));
        assert!(!axial_stabbable_brute_force(&bend(2.)));
        // Round a corner: in at x = 0, out at y = 1, which lies ahead for x and beside for z.
        assert!(axial_stabbable_brute_force(&[x(0., unit, unit), y(1., [0., 4.], [0., 1.])]));
        assert!(!axial_stabbable_brute_force(&[x(0., unit, unit), y(1., [-4., 0.], [0., 1.])]));
        assert!(!axial_stabbable_brute_force(&[x(0., unit, unit), x(0., unit, unit).reversed()]));
    }

    #[test]
    fn axial_boxes_are_met() {
        let first = door(0, [0., 0., 0.], [0., 1., 1.]);
        let second = door(0, [1., 0., 0.], [1., 1., 1.]);
        let cube = |low: f64, high: f64| Aabb { min: [low; 3], max: [high; 3] };
        assert!(axial_meets_brute_force(&[first, second], &cube(2., 3.)));
        assert!(!axial_meets_brute_force(&[first, second], &cube(-3., -2.)));
        // At x = 2, lines are between -1 and 2 along y and z: a box from 2 to 2.1 is only grazed there,
        // and met once it is deeper.
        let beside = |depth: f64| Aabb { min: [2., 2., 0.], max: [2. + depth, 3., 1.] };
        assert!(axial_meets_brute_force(&[first, second], &beside(0.1)));
        assert!(!axial_meets_brute_force(&[first, second], &beside(0.)));
    }

    /// Invariant: in every corridor, consecutive doors are on different sides of one box.
    #[test]
    fn axial_corridors_lead_from_box_to_box() {
        for doors in crate::draw(&axial_corridor(), 300) {
            for w in doors.windows(2) {
                let [a, b] = [0, 1].map(|i| usize::from(w[i].axis));
                let ahead = |forward: bool, x: f64, y: f64| if forward { y > x } else { y < x };
                let beyond = [w[1].extent.min[a], w[1].extent.max[a]];
                assert!(beyond.iter().any(|&y| ahead(w[0].forward, w[0].at(), y)), "{w:?}");
                let before = [w[0].extent.min[b], w[0].extent.max[b]];
                assert!(before.iter().any(|&y| ahead(w[1].forward, y, w[1].at())), "{w:?}");
            }
        }
    }

    /// Passable and blocked ones are common, and so are all numbers of axes.
    #[test]
    fn axial_corridor_cases_are_mixed() {
        for (kind, strategy) in [axial_corridor().boxed(), straight_axial_corridor().boxed()].iter().enumerate() {
            let drawn = crate::draw(strategy, 300);
            let open = drawn.iter().filter(|doors| axial_stabbable_brute_force(doors)).count();
            assert!((60..240).contains(&open), "{kind}: {open}");
        }
    }

    proptest! {
        /// Invariant: a line that passes all doors is found; lines join places in the first and last door.
        #[test]
        fn axial_sampled_lines_are_open(
            doors in prop_oneof![axial_corridor(), any_axial_doors()],
            places in prop::collection::vec([1i32..16, 1..16, 1..16, 1..16], 16),
        ) {
            let passes = |place: &[i32; 4]| {
                let at = |door: &AxialDoor, u: &[i32]| {
                    let mut k = 0;
                    [0, 1, 2].map(|i| {
                        let [low, high] = [door.extent.min[i], door.extent.max[i]];
                        // Sixteenths of small integers are exact.
                        if low == high { low } else { k += 1; low + (high - low) * f64::from(u[k - 1]) / 16.0 }
                    })
                };
                let (p, q) = (at(&doors[0], &place[..2]), at(&doors[doors.len() - 1], &place[2..]));
                doors.len() > 1 && doors.iter().all(|d| line_passes(p, q, d))
            };
            if places.iter().any(passes) {
                prop_assert!(axial_stabbable_brute_force(&doors), "{:?}", doors);
            }
        }
    }

    /// Products of small multiples of a sixteenth are exact in doubles.
    fn line_passes(p: [f64; 3], q: [f64; 3], door: &AxialDoor) -> bool {
        let a = usize::from(door.axis);
        let d = [0, 1, 2].map(|i| q[i] - p[i]);
        let way = if door.forward { 1.0 } else { -1.0 };
        way * d[a] > 0.0
            && (0..3).filter(|&b| b != a).all(|b| {
                let at = way * (p[b] * d[a] + (door.at() - p[a]) * d[b]);
                way * door.extent.min[b] * d[a] < at && at < way * door.extent.max[b] * d[a]
            })
    }
}
