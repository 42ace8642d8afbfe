//! Conditions on a line, as comparisons of the times at which it reaches planes; lines in doubles.

use sightlines_geometry::{Aabb, AxialDoor, Point2, check_coordinate, orient2d};

/// Signs of a direction: bit `i` is set if it goes towards larger coordinates on axis `i`.
pub(super) type Octant = u8;

/// A set of octants: bit `o` is set if octant `o` belongs to it.
pub(super) type Octants = u8;

/// The octants that go forward on each axis.
pub(super) const FORWARD: [Octants; 3] = [0b1010_1010, 0b1100_1100, 0b1111_0000];

/// The octants that cross a door in its direction.
pub(super) fn octants_through(door: &AxialDoor) -> Octants {
    let forward = FORWARD[usize::from(door.axis)];
    if door.forward { forward } else { !forward }
}

/// The common direction of `octants` on an axis, if they have one.
pub(super) fn common_direction(octants: Octants, axis: usize) -> Option<bool> {
    match (octants & FORWARD[axis], octants & !FORWARD[axis]) {
        (0, _) => Some(false),
        (_, 0) => Some(true),
        _ => None,
    }
}

/// The octants of a set, and those that differ from one of them on this axis only.
pub(super) fn both_directions(octants: Octants, axis: usize) -> Octants {
    let step = 1 << axis;
    octants | (octants & FORWARD[axis]) >> step | (octants & !FORWARD[axis]) << step
}

/// Whether an octant goes forward on an axis.
pub(super) const fn is_forward(octant: Octant, axis: usize) -> bool {
    octant >> axis & 1 == 1
}

/// 1 or -1.
pub(super) const fn sign(octant: Octant, axis: usize) -> f64 {
    if is_forward(octant, axis) { 1.0 } else { -1.0 }
}

/// The other two axes, in cyclic order.
pub(super) const fn others(axis: usize) -> [usize; 2] {
    [(axis + 1) % 3, (axis + 2) % 3]
}

/// The line reaches coordinate `from` on axis `early` before coordinate `to` on axis `late`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Row {
    pub(super) early: usize,
    pub(super) late: usize,
    pub(super) from: f64,
    pub(super) to: f64,
}

impl Row {
    /// The coordinate on `axis` and its sign in the row, if the row involves that axis.
    pub(super) fn term(&self, axis: usize) -> Option<(f64, f64)> {
        if self.early == axis { Some((1.0, self.from)) } else { (self.late == axis).then_some((-1.0, self.to)) }
    }
}

/// The sides of a box by which a line of the octant enters and leaves its extent on an axis.
pub(super) fn first_and_last(bounds: &Aabb<3>, octant: Octant, axis: usize) -> [f64; 2] {
    let [low, high] = [bounds.min[axis], bounds.max[axis]];
    if is_forward(octant, axis) { [low, high] } else { [high, low] }
}

/// Number of rows of a door.
pub(super) const ROWS_PER_DOOR: usize = 4;

/// A door is passed if it is reached after its extents are entered and before they are left: for each
/// of the [`others`] of its axis, the row of entering and the row of leaving.
pub(super) fn door_rows(door: &AxialDoor, octant: Octant) -> [Row; ROWS_PER_DOOR] {
    let (axis, at) = (usize::from(door.axis), door.at());
    let [b, c] = others(axis).map(|b| {
        let [first, last] = first_and_last(&door.extent, octant, b);
        [Row { early: b, late: axis, from: first, to: at }, Row { early: axis, late: b, from: at, to: last }]
    });
    [b[0], b[1], c[0], c[1]]
}

/// A box is met beyond a door if every two of its extents are passed at a common time, and each is
/// left after the door is reached. `None` if it has no part at the door's plane or beyond.
pub(super) fn box_rows(bounds: &Aabb<3>, door: &AxialDoor, octant: Octant) -> Option<Vec<Row>> {
    let (axis, at) = (usize::from(door.axis), door.at());
    let extents = [0, 1, 2].map(|i| first_and_last(bounds, octant, i));
    if !reaches(bounds, axis, door.forward, at) {
        return None;
    }
    let pairs = (0..3).flat_map(|i| others(i).map(|j| (i, j)));
    let overlaps = pairs.map(|(i, j)| Row { early: i, late: j, from: extents[i][0], to: extents[j][1] });
    let beyond = others(axis).map(|j| Row { early: axis, late: j, from: at, to: extents[j][1] });
    Some(overlaps.chain(beyond).collect())
}

/// Whether a box has a part at coordinate `at` or beyond it.
pub(super) fn reaches(bounds: &Aabb<3>, axis: usize, forward: bool, at: f64) -> bool {
    if forward { bounds.max[axis] >= at } else { bounds.min[axis] <= at }
}

/// Whether a line of the octant, given by the rows that it obeys, passes the plane of a closed rectangle outside of it.
pub(super) fn misses(rectangle: &Aabb<3>, axis: usize, octant: Octant, obeys: impl Fn(&Row) -> bool) -> bool {
    let at = rectangle.min[axis];
    others(axis).into_iter().any(|b| {
        let [first, last] = first_and_last(rectangle, octant, b);
        obeys(&Row { early: axis, late: b, from: at, to: first })
            || obeys(&Row { early: b, late: axis, from: last, to: at })
    })
}

/// A directed line through two points that differ on every axis.
///
/// Rows about two axes are orientations in the plane of those axes, so the exact planar predicate
/// decides them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Line {
    pub(super) from: [f64; 3],
    pub(super) to: [f64; 3],
}

impl Line {
    /// Rounds two points to accepted coordinates; `None` if that is not possible.
    pub(super) fn new(from: [f64; 3], to: [f64; 3]) -> Option<Self> {
        const TINY: f64 = sightlines_geometry::coordinate::MIN_MAGNITUDE;
        let round = |x: f64| check_coordinate(if x.abs() < TINY { 0.0 } else { x }).ok();
        let point = |p: [f64; 3]| Some([round(p[0])?, round(p[1])?, round(p[2])?]);
        Some(Self { from: point(from)?, to: point(to)? })
    }

    #[inline(always)]
    fn orient(&self, i: usize, j: usize, x: f64, y: f64) -> f64 {
        let p = Point2::new(self.from[i], self.from[j]);
        let q = Point2::new(self.to[i], self.to[j]);
        orient2d(p, q, Point2::new(x, y))
    }

    /// Whether it passes the open rectangle in its direction. Exact.
    #[inline(always)]
    pub(super) fn passes(&self, door: &AxialDoor) -> bool {
        let (a, at) = (usize::from(door.axis), door.at());
        let (ahead, behind) = (self.to[a] > self.from[a], self.to[a] < self.from[a]);
        if !(if door.forward { ahead } else { behind }) {
            return false;
        }
        // Seen along the axis of the door, larger coordinates of the other axis are on the left.
        let left = if door.forward { 1.0 } else { -1.0 };
        others(a).iter().all(|&b| {
            left * self.orient(a, b, at, door.extent.max[b]) > 0.0
                && left * self.orient(a, b, at, door.extent.min[b]) < 0.0
        })
    }

    /// Whether it passes the plane of a closed rectangle outside of it, if it is in the octant. Exact.
    pub(super) fn misses(&self, rectangle: &Aabb<3>, axis: usize, octant: Octant) -> bool {
        misses(rectangle, axis, octant, |row| self.obeys(row, octant))
    }

    /// The octant of its direction; forward on an axis on which it does not move.
    pub(super) fn octant(&self) -> Octant {
        (0..3).fold(0, |o, i| o | Octant::from(self.to[i] >= self.from[i]) << i)
    }

    /// Whether its direction is strictly in the octant. Exact.
    pub(super) fn is_in(&self, octant: Octant) -> bool {
        (0..3).all(|i| sign(octant, i) * self.from[i] < sign(octant, i) * self.to[i])
    }

    /// Whether it obeys a row strictly, if it is in the octant. Exact.
    ///
    /// The row (x - p_i) / d_i < (y - p_j) / d_j, times d_i d_j, compares an orientation with zero.
    pub(super) fn obeys(&self, row: &Row, octant: Octant) -> bool {
        let turn = sign(octant, row.early) * sign(octant, row.late);
        turn * self.orient(row.early, row.late, row.from, row.to) > 0.0
    }
}
