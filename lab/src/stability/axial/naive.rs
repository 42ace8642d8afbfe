//! Lines through axis-aligned doors by clipping slownesses, in plain floating point: warning examples.
//!
//! Comparisons of crossing times hold for some offsets if every cycle of them, through two or three axes, adds up to
//! something negative, which is a linear form in the slownesses. The triangle of slownesses is clipped by all of them.
//! In exact numbers that is right; here sums and corners are rounded.

use sightlines::geometry::AxialDoor;
use std::fmt::Debug;
use std::ops::{Add, Mul, Neg, Sub};

/// A floating-point number.
pub trait Real:
    Copy + PartialOrd + Debug + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    /// The nearest one.
    fn of(x: f64) -> Self;
}

impl Real for f64 {
    fn of(x: f64) -> Self {
        x
    }
}

impl Real for f32 {
    fn of(x: f64) -> Self {
        x as Self
    }
}

/// Whether a line passes, as far as this arithmetic knows. O(doors³).
pub fn passes<T: Real>(doors: &[AxialDoor]) -> bool {
    (0..8u8).any(|bits| {
        let signs = [0, 1, 2].map(|axis| bits >> axis & 1 == 1);
        doors.iter().all(|d| signs[usize::from(d.axis)] == d.forward) && octant::<T>(doors, signs)
    })
}

fn octant<T: Real>(doors: &[AxialDoor], signs: [bool; 3]) -> bool {
    // Pairs (c, e) at [i][j]: axis i is at c before axis j is at e.
    let mut before: [[Vec<(T, T)>; 3]; 3] = Default::default();
    for door in doors {
        let axis = usize::from(door.axis);
        let sides = |k: usize| {
            let [low, high] = [T::of(door.extent.min[k]), T::of(door.extent.max[k])];
            if signs[k] { [low, high] } else { [-high, -low] }
        };
        let at = sides(axis)[0];
        for other in (0..3).filter(|&other| other != axis) {
            let [first, last] = sides(other);
            before[other][axis].push((first, at));
            before[axis][other].push((at, last));
        }
    }
    let zero = T::of(0.0);
    let mut corners = vec![[T::of(1.0), zero, zero], [zero, T::of(1.0), zero], [zero, zero, T::of(1.0)]];
    for (i, j) in [(0, 1), (1, 2), (2, 0)] {
        for &(c, e) in &before[i][j] {
            for &(d, f) in &before[j][i] {
                let mut form = [zero; 3];
                form[i] = c - f;
                form[j] = d - e;
                if !clip(&mut corners, form) {
                    return false;
                }
            }
        }
    }
    for [i, j, k] in [[0, 1, 2], [0, 2, 1]] {
        for &(c, d) in &before[i][j] {
            for &(e, f) in &before[j][k] {
                for &(g, h) in &before[k][i] {
                    let mut form = [zero; 3];
                    form[i] = c - h;
                    form[j] = e - d;
                    form[k] = g - f;
                    if !clip(&mut corners, form) {
                        return false;
                    }
                }
            }
        }
    }
    true
}

/// Keeps where a form is negative; whether anything is left.
fn clip<T: Real>(corners: &mut Vec<[T; 3]>, form: [T; 3]) -> bool {
    let zero = T::of(0.0);
    let values: Vec<T> = corners.iter().map(|p| form[0] * p[0] + form[1] * p[1] + form[2] * p[2]).collect();
    if values.iter().all(|&v| v >= zero) {
        return false;
    }
    if values.iter().all(|&v| v <= zero) {
        return true;
    }
    let n = corners.len();
    let mut cut = Vec::with_capacity(n + 1);
    for i in 0..n {
        let k = (i + 1) % n;
        if values[i] <= zero {
            cut.push(corners[i]);
        }
        if (values[i] < zero && values[k] > zero) || (values[i] > zero && values[k] < zero) {
            let size = |x: T| if x < zero { -x } else { x };
            let (u, v) = (size(values[k]), size(values[i]));
            cut.push([0, 1, 2].map(|j| u * corners[i][j] + v * corners[k][j]));
        }
    }
    *corners = cut;
    true
}
