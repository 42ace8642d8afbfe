//! Mazes: narrow passages, many portals in a row, small visible sets.

use crate::error::{GenerateError, check_range};
use crate::rng::Rng;
use crate::spanning::Passages;
use crate::stroke::{Rect, Stroke, merge};
use sightlines_cells::Plan;

/// A maze of `w` times `h` square rooms of side 1 with corner (0, 0): every room can be reached, and one wall in
/// sixteen of those of a tree is missing. Axial, thin walls, closed boundary.
///
/// # Errors
/// [`GenerateError::OutOfRange`] unless both counts are from 1 to 1000.
pub fn maze(seed: u64, w: u32, h: u32) -> Result<Plan, GenerateError> {
    check_range("w", w, 1, 1000)?;
    check_range("h", h, 1, 1000)?;
    let mut rng = Rng::new(seed, 1);
    let passages = Passages::random(&mut rng, w as usize, h as usize, 16);
    let (w, h) = (w.cast_signed(), h.cast_signed());
    let mut strokes = Stroke::sides(Rect { x0: 0, y0: 0, x1: w, y1: h }).to_vec();
    for y in 0..h {
        for x in 0..w {
            let (i, j) = (x.cast_unsigned() as usize, y.cast_unsigned() as usize);
            if !passages.east(i, j) {
                strokes.push(Stroke::along_y(x + 1, y, y + 1));
            }
            if !passages.north(i, j) {
                strokes.push(Stroke::along_x(y + 1, x, x + 1));
            }
        }
    }
    let lines = merge(strokes).into_iter().map(|s| s.wall(1)).collect();
    Ok(Plan::new(lines, Vec::new()).expect("walls on the integer grid make a plan"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::{checksum, outer_boundary_is_closed};

    #[test]
    fn maze_is_deterministic_closed_and_axial() {
        let plan = maze(5, 12, 9).unwrap();
        assert_eq!(checksum(&plan), PINNED);
        assert_eq!(maze(5, 12, 9).unwrap(), plan);
        assert_ne!(maze(6, 12, 9).unwrap(), plan);
        assert!(plan.is_axial() && outer_boundary_is_closed(&plan));
        assert_eq!(plan.bounds().max, [12.0, 9.0]);
    }

    const PINNED: u64 = 10769803248601080277;

    /// Total wall length counts the missing walls: a perfect maze of n rooms keeps all but n - 1.
    #[test]
    fn maze_has_a_tree_and_some_loops() {
        let plan = maze(1, 20, 20).unwrap();
        let length: f64 = plan.lines().iter().map(|l| l.a.distance(l.b)).sum();
        let inner = 2.0 * 19.0 * 20.0;
        let open = inner - (length - 80.0);
        assert!((399.0..450.0).contains(&open), "{open} passages");
    }

    #[test]
    fn maze_sizes_scale_and_are_checked() {
        assert_eq!(maze(1, 1, 1).unwrap().lines().len(), 4);
        assert_eq!(maze(1, 30, 1).unwrap().bounds().max, [30.0, 1.0]);
        assert_eq!(maze(1, 1, 30).unwrap().bounds().max, [1.0, 30.0]);
        assert!(maze(1, 30, 30).unwrap().lines().len() > 4 * maze(1, 10, 10).unwrap().lines().len());
        let error = maze(1, 0, 5).unwrap_err();
        assert_eq!(error.to_string(), "w is 0, but must be from 1 to 1000");
        assert!(maze(1, 5, 1001).is_err());
    }
}
