//! Straight pieces of curves, and the plan that they make.

use super::expand::{Drawn, Expanded};
use super::{DEFAULT_DEVIATION, MAX_ELEMENTS, too_many};
use crate::error::Malformed;
use crate::plan::{PlanFile, PlanLines};
use sightlines_cells::PlanLine;
use sightlines_geometry::{Aabb, Point2, Segment2, check_coordinate};

pub(super) fn flatten(expanded: &Expanded, deviation: Option<f64>) -> Result<PlanFile, Malformed> {
    let deviation = deviation.unwrap_or_else(|| default_deviation(expanded));
    let mut lines = PlanLines::default();
    let (mut n_lines, mut n_compared) = (0, 0);
    let mut stack = Vec::new();
    for Drawn { pieces, clip } in &expanded.entities {
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
                    let chord = Segment2 { a, b };
                    // The curve beside a chord may be clipped where that is not.
                    if clip.is_some()
                        && !piece.is_flat(0.0)
                        && !expanded.clips.has_all_near(*clip, chord, deviation, &mut n_compared)?
                    {
                        continue;
                    }
                    for part in expanded.clips.parts(*clip, chord, &mut n_compared)? {
                        lines.push(PlanLine::wall(part.a, part.b), false);
                    }
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

fn default_deviation(expanded: &Expanded) -> f64 {
    let corners = |Drawn { pieces, clip }: &'_ Drawn| {
        let corners = pieces.iter().flat_map(|piece| &piece.corners);
        Aabb::around(corners.map(|&(p, _)| expanded.clips.nearest(*clip, p)))
    };
    let bounds = expanded.entities.iter().map(corners).fold(Aabb::around([]), Aabb::united);
    let longest = (0..2).map(|k| bounds.max[k] - bounds.min[k]).fold(0.0, f64::max);
    DEFAULT_DEVIATION * longest
}
