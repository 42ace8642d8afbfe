//! What of a cone of sight gets through a portal.

use crate::side::{MOST_SIDES, Reach, Side, Vector, sub};

/// A convex polygon clipped by as many sides as there may be has one corner more for each.
pub(super) const MOST_CORNERS: usize = 2 * MOST_SIDES;

/// The edge that begins at a corner of a clipped polygon.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Edge {
    /// Of the portal: from this corner to the next.
    Portal(u8),
    /// Along the side of the cone with this number.
    Side(u8),
}

/// A convex polygon of vectors from the eye: what of a portal is seen.
#[derive(Debug, Clone)]
struct Polygon {
    n: usize,
    corners: [Vector; MOST_CORNERS],
    edges: [Edge; MOST_CORNERS],
}

impl Polygon {
    const EMPTY: Self = Self { n: 0, corners: [[0.0; 3]; MOST_CORNERS], edges: [Edge::Portal(0); MOST_CORNERS] };

    /// Its corners, in turn.
    fn corners(&self) -> &[Vector] {
        &self.corners[..self.n]
    }

    /// Adds a corner, if there is room.
    #[inline]
    fn push(&mut self, corner: Vector, edge: Edge) -> bool {
        let room = self.n < MOST_CORNERS;
        if room {
            self.corners[self.n] = corner;
            self.edges[self.n] = edge;
            self.n += 1;
        }
        room
    }
}

/// Room for a polygon and what is clipped from it: kept, as it is not small.
#[derive(Debug, Clone)]
pub(crate) struct Clipper {
    polygon: Polygon,
    clipped: Polygon,
    values: [f64; MOST_CORNERS],
}

impl Default for Clipper {
    fn default() -> Self {
        Self { polygon: Polygon::EMPTY, clipped: Polygon::EMPTY, values: [0.0; MOST_CORNERS] }
    }
}

/// The eye, and how far it sees.
#[derive(Debug, Clone, Copy)]
pub(super) struct Eye {
    pub(super) planar: bool,
    pub(super) at: Vector,
    pub(super) reach: Reach,
}

impl Clipper {
    /// Adds to `out` the sides of the cone of all lines from the eye within `sides` and through the portal with these corners;
    /// `false` and nothing added if there is certainly none.
    ///
    /// The corners are as the eye sees them, which is before the portal: in a plane left end, right end; in space
    /// counter-clockwise. The new cone errs to the outside, by the tolerance of its sides.
    pub(super) fn narrow(&mut self, eye: Eye, corners: &[Vector], sides: &[Side], out: &mut Vec<Side>) -> bool {
        if corners.len() > MOST_SIDES {
            out.extend_from_slice(sides);
            return true;
        }
        self.narrow_part(eye, corners, sides, out).is_some()
    }

    /// As [`Clipper::narrow`] with at most [`MOST_SIDES`] corners; tells the corners of what is seen of the portal as
    /// well. In a plane they are its left and its right end, as are the sides. In space the new sides are those of its edges
    /// in turn; beyond [`MOST_SIDES`] they are left out.
    pub(super) fn narrow_part(
        &mut self,
        eye: Eye,
        corners: &[Vector],
        sides: &[Side],
        out: &mut Vec<Side>,
    ) -> Option<&[Vector]> {
        if let (true, &[left, right]) = (eye.planar, corners) {
            let ends = narrow_segment(sub(left, eye.at), sub(right, eye.at), sides, eye.reach, out)?;
            self.polygon.n = 0;
            for end in ends {
                self.polygon.push(end, Edge::Portal(0));
            }
            return Some(self.polygon.corners());
        }
        self.narrow_polygon(eye, corners, sides, out)
    }

    fn narrow_polygon(
        &mut self,
        eye: Eye,
        corners: &[Vector],
        sides: &[Side],
        out: &mut Vec<Side>,
    ) -> Option<&[Vector]> {
        let (mut polygon, mut clipped) = (&mut self.polygon, &mut self.clipped);
        polygon.n = 0;
        for (i, &corner) in corners.iter().enumerate() {
            polygon.push(sub(corner, eye.at), Edge::Portal(i as u8));
        }
        for (k, side) in sides.iter().enumerate() {
            let mut n_out = 0;
            for (value, &corner) in self.values.iter_mut().zip(polygon.corners()) {
                *value = side.value(corner);
                n_out += usize::from(side.lets_go(*value));
            }
            if n_out == polygon.n {
                return None;
            }
            if n_out > 0 && clip(polygon, &self.values, side, k as u8, clipped) {
                std::mem::swap(&mut polygon, &mut clipped);
            }
        }
        for edge in polygon.edges[..polygon.n].iter().take(MOST_SIDES) {
            out.push(match *edge {
                Edge::Side(k) => sides[usize::from(k)],
                Edge::Portal(i) => {
                    let i = usize::from(i);
                    let next = corners[if i + 1 == corners.len() { 0 } else { i + 1 }];
                    Side::through(sub(corners[i], eye.at), sub(next, corners[i]), eye.reach)
                }
            });
        }
        Some(polygon.corners())
    }
}

/// Adds the left and the right side of the cone, and tells the left and the right end of what is seen.
fn narrow_segment(
    left: Vector,
    right: Vector,
    sides: &[Side],
    reach: Reach,
    out: &mut Vec<Side>,
) -> Option<[Vector; 2]> {
    let mut ends = [(left, None), (right, None)];
    for side in sides {
        let values = ends.map(|(v, _)| side.value(v));
        match values.map(|value| side.lets_go(value)) {
            [false, false] => {}
            [true, true] => return None,
            [true, false] => ends[0] = (between(side, ends[1].0, ends[0].0, values[1], values[0]), Some(*side)),
            [false, true] => ends[1] = (between(side, ends[0].0, ends[1].0, values[0], values[1]), Some(*side)),
        }
    }
    out.push(ends[0].1.unwrap_or_else(|| Side::right_of(left, reach)));
    out.push(ends[1].1.unwrap_or_else(|| Side::left_of(right, reach)));
    Some(ends.map(|(end, _)| end))
}

/// The part of `polygon` that the side numbered `k` keeps; `false` if it has too many corners, which only rounding can make.
#[inline]
fn clip(polygon: &Polygon, values: &[f64], side: &Side, k: u8, out: &mut Polygon) -> bool {
    out.n = 0;
    for i in 0..polygon.n {
        let j = if i + 1 == polygon.n { 0 } else { i + 1 };
        let (a, b) = (polygon.corners[i], polygon.corners[j]);
        let fits = match (side.lets_go(values[i]), side.lets_go(values[j])) {
            (false, false) => out.push(a, polygon.edges[i]),
            (false, true) => {
                out.push(a, polygon.edges[i]) && out.push(between(side, a, b, values[i], values[j]), Edge::Side(k))
            }
            (true, false) => out.push(between(side, b, a, values[j], values[i]), polygon.edges[i]),
            (true, true) => true,
        };
        if !fits {
            return false;
        }
    }
    true
}

/// Where the border crosses from `kept` to `gone`.
#[inline]
fn between(side: &Side, kept: Vector, gone: Vector, value: f64, gone_value: f64) -> Vector {
    let t = (value - side.border()) / (value - gone_value);
    std::array::from_fn(|k| kept[k] + t * (gone[k] - kept[k]))
}

#[cfg(test)]
mod tests {
    use super::*;

    const REACH: Reach = Reach { radius: 100.0, slack: 0.0 };

    /// A square at x = `x`, counter-clockwise as seen from the origin.
    fn square(x: f64, y: [f64; 2], z: [f64; 2]) -> Vec<Vector> {
        vec![[x, y[0], z[0]], [x, y[0], z[1]], [x, y[1], z[1]], [x, y[1], z[0]]]
    }

    fn narrow(planar: bool, corners: &[Vector], at: Vector, sides: &[Side], reach: Reach, out: &mut Vec<Side>) -> bool {
        Clipper::default().narrow(Eye { planar, at, reach }, corners, sides, out)
    }

    fn inside(sides: &[Side], v: Vector) -> bool {
        sides.iter().all(|s| !s.lets_go(s.value(v)))
    }

    #[test]
    fn squares_narrow_each_other() {
        let mut first = Vec::new();
        assert!(narrow(false, &square(1.0, [-1.0, 1.0], [-1.0, 1.0]), [0.0; 3], &[], REACH, &mut first));
        assert_eq!(first.len(), 4);
        let mut both = Vec::new();
        let second = square(2.0, [0.0, 5.0], [-1.0, 1.0]);
        assert!(narrow(false, &second, [0.0; 3], &first, REACH, &mut both));
        // Of the first only its left edge is left: y <= x.
        assert_eq!(both.len(), 4);
        for (v, expected) in [
            ([1.0, 0.5, 0.0], true),
            ([1.0, 1.01, 0.0], false),
            ([1.0, 0.99, 0.49], true),
            ([1.0, 0.5, 0.51], false),
            ([1.0, -0.01, 0.0], false),
            ([50.0, 25.0, -24.0], true),
        ] {
            assert_eq!(inside(&both, v), expected, "{v:?}");
        }
        let mut none = Vec::new();
        assert!(!narrow(false, &square(2.0, [2.1, 5.0], [-1.0, 1.0]), [0.0; 3], &first, REACH, &mut none));
        assert!(none.is_empty());
        // It touches the cone along an edge: kept, as rounding cannot tell.
        assert!(narrow(false, &square(2.0, [2.0, 5.0], [-1.0, 1.0]), [0.0; 3], &first, REACH, &mut none));
    }

    #[test]
    fn segments_narrow_each_other() {
        let door = |x: f64, left: f64, right: f64| [[x, left, 0.0], [x, right, 0.0]];
        let mut first = Vec::new();
        assert!(narrow(true, &door(1.0, 1.0, -1.0), [0.0; 3], &[], REACH, &mut first));
        let mut both = Vec::new();
        assert!(narrow(true, &door(2.0, 5.0, 0.0), [0.0; 3], &first, REACH, &mut both));
        assert!(
            inside(&both, [1.0, 0.5, 0.0]) && !inside(&both, [1.0, 1.01, 0.0]) && !inside(&both, [1.0, -0.01, 0.0])
        );
        assert!(!narrow(true, &door(2.0, 5.0, 2.1), [0.0; 3], &first, REACH, &mut Vec::new()));
    }

    #[test]
    fn numbers_that_overflow_hide_nothing() {
        let huge = square(1e200, [-1e200, 1e200], [-1e200, 1e200]);
        let mut out = Vec::new();
        let reach = Reach { radius: 1e201, slack: 0.0 };
        assert!(narrow(false, &huge, [0.0; 3], &[], reach, &mut out));
        assert!(narrow(false, &square(2e200, [3e200, 4e200], [0.0, 1.0]), [0.0; 3], &out, reach, &mut Vec::new()));
    }
}
