//! Straight pieces of curves, and the plan that they make.

use super::curve::Bezier;
use super::expand::too_many;
use super::{DEFAULT_DEVIATION, MAX_ELEMENTS};
use crate::error::Malformed;
use crate::plan::{PlanFile, PlanLines};
use sightlines_cells::PlanLine;
use sightlines_geometry::{Aabb, Point2, check_coordinate};

/// The plan of all pieces, entity by entity.
pub(super) fn flatten(entities: &[Vec<Bezier<2>>], deviation: Option<f64>) -> Result<PlanFile, Malformed> {
    let deviation = deviation.unwrap_or_else(|| default_deviation(entities));
    let mut lines = PlanLines::default();
    let mut n_lines = 0;
    let mut stack = Vec::new();
    for pieces in entities {
        let mut has_length = false;
        for piece in pieces {
            stack.push(piece.clone());
            while let Some(piece) = stack.pop() {
                n_lines += 1;
                if n_lines > MAX_ELEMENTS {
                    return Err(too_many());
                }
                if !piece.is_flat(deviation) {
                    let [first, second] = piece.halves();
                    stack.extend([second, first]);
                    continue;
                }
                let ends = [piece.corners.first(), piece.corners.last()].map(|end| end.map(|&(p, _)| p));
                let [Some(a), Some(b)] = ends else { continue };
                let [a, b] = [checked(a)?, checked(b)?];
                if a != b {
                    has_length = true;
                    lines.push(PlanLine::wall(a, b), false);
                }
            }
        }
        if !has_length {
            lines.count_without_length();
        }
    }
    Ok(lines.finish(Vec::new())?)
}

/// A point that may have been computed.
fn checked(point: [f64; 2]) -> Result<Point2, Malformed> {
    Ok(Point2::new(check_coordinate(point[0])?, check_coordinate(point[1])?))
}

fn default_deviation(entities: &[Vec<Bezier<2>>]) -> f64 {
    let bounds = Aabb::around(entities.iter().flatten().flat_map(|piece| &piece.corners).map(|&(p, _)| p));
    let longest = (0..2).map(|k| bounds.max[k] - bounds.min[k]).fold(0.0, f64::max);
    DEFAULT_DEVIATION * longest
}
