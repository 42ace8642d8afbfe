//! Halls full of pillars: free-standing occluders, almost everything partly visible.

use crate::error::{GenerateError, check_range};
use crate::rng::Rng;
use crate::stroke::{Rect, Stroke};
use sightlines_cells::{Plan, PlanLine};
use sightlines_geometry::Point2;

/// Distance between the middles of neighbouring pillars, in scene units.
const SPACING: i32 = 16;

/// A closed hall with `nx` times `ny` square pillars, sides parallel to the axes, integer coordinates.
///
/// # Errors
/// [`GenerateError::OutOfRange`] unless both counts are from 1 to 500.
pub fn pillared_hall(seed: u64, nx: u32, ny: u32) -> Result<Plan, GenerateError> {
    hall(seed, nx, ny, |rng| (rng.between(2, 4), None))
}

/// As [`pillared_hall`], but every pillar is a square turned by its own angle, so that few of its
/// sides are parallel to an axis. The corners are integers: a square is given by half a diagonal.
///
/// # Errors
/// As [`pillared_hall`].
pub fn turned_pillared_hall(seed: u64, nx: u32, ny: u32) -> Result<Plan, GenerateError> {
    hall(seed, nx, ny, |rng| (rng.between(1, 5), Some(rng.between(0, 3))))
}

/// The hall; `pillar` draws half the side of a square, or half a diagonal (a, b) of a turned one.
fn hall(
    seed: u64,
    nx: u32,
    ny: u32,
    mut pillar: impl FnMut(&mut Rng) -> (i32, Option<i32>),
) -> Result<Plan, GenerateError> {
    let nx = check_range("nx", nx, 1, 500)?.cast_signed();
    let ny = check_range("ny", ny, 1, 500)?.cast_signed();
    let mut rng = Rng::new(seed, 2);
    let mut lines: Vec<PlanLine> =
        Stroke::sides(Rect { x0: 0, y0: 0, x1: nx * SPACING, y1: ny * SPACING }).map(|s| s.wall(1)).to_vec();
    for j in 0..ny {
        for i in 0..nx {
            // A pillar reaches at most 6 steps from its middle, which stays 7 or more from its
            // neighbours' border: pillars never touch each other or the wall.
            let x = i * SPACING + SPACING / 2 + rng.between(-1, 1);
            let y = j * SPACING + SPACING / 2 + rng.between(-1, 1);
            let corners = match pillar(&mut rng) {
                (half, None) => [(half, half), (-half, half), (-half, -half), (half, -half)],
                (a, Some(b)) => [(a, b), (-b, a), (-a, -b), (b, -a)],
            };
            lines.extend(ring(&corners.map(|(dx, dy)| [x + dx, y + dy])));
        }
    }
    Ok(Plan::new(lines, Vec::new()).expect("walls on the integer grid make a plan"))
}

/// The closed polygon through `corners` as walls.
fn ring(corners: &[[i32; 2]]) -> impl Iterator<Item = PlanLine> + '_ {
    let point = |[x, y]: [i32; 2]| Point2::new(f64::from(x), f64::from(y));
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).map(move |(&a, &b)| PlanLine::wall(point(a), point(b)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::{checksum, crossings, outer_boundary_is_closed};

    #[test]
    fn halls_are_deterministic_and_closed() {
        let square = pillared_hall(3, 5, 4).unwrap();
        let turned = turned_pillared_hall(3, 5, 4).unwrap();
        assert_eq!([checksum(&square), checksum(&turned)], PINNED);
        for plan in [&square, &turned] {
            assert_eq!(plan.lines().len(), 4 + 4 * 20);
            assert!(outer_boundary_is_closed(plan) && plan.small_grid().is_some());
            assert_eq!(crossings(plan), 0);
        }
        assert!(square.is_axial() && !turned.is_axial());
        assert_ne!(pillared_hall(4, 5, 4).unwrap(), square);
    }

    const PINNED: [u64; 2] = [17778628000416006197, 7631690064607112101];

    #[test]
    fn hall_sizes_scale_and_are_checked() {
        assert_eq!(pillared_hall(1, 30, 20).unwrap().lines().len(), 4 + 4 * 600);
        assert_eq!(pillared_hall(1, 0, 2).unwrap_err().to_string(), "nx is 0, but must be from 1 to 500");
        assert!(turned_pillared_hall(1, 2, 501).is_err());
    }
}
