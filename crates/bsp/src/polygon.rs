//! Convex polygons on a plane of a set, bounded by others of it.

use crate::corner::Corner;
use crate::plane::{PlaneId, Planes};
use std::rc::Rc;

/// A convex polygon with an area. Its corners go round counter-clockwise as seen from in front of its plane.
#[derive(Debug, Clone)]
pub(crate) struct Polygon {
    plane: PlaneId,
    corners: Vec<Rc<Corner>>,
    /// The planes of the edges: `k` is from corner `k` to the next.
    edges: Vec<PlaneId>,
}

/// What a plane leaves of a polygon on its sides; nothing where only an edge or a corner would be left.
#[derive(Debug)]
pub(crate) enum Cut {
    /// All of it is on one side: 1 in front, -1 behind.
    Whole(i32),
    /// In front, and behind.
    Both(Polygon, Polygon),
    /// The polygon lies on it.
    On,
}

impl Polygon {
    /// What of a plane is within a box, given by its planes: two across each axis, those of smaller coordinates first. None if
    /// the plane is outside, or touches an edge.
    pub(crate) fn of_plane(plane: PlaneId, walls: &[[PlaneId; 2]; 3], rows: &Planes) -> Option<Self> {
        let normal = &rows.row(plane)[..3];
        let axis = (0..3).max_by(|&i, &j| normal[i].abs().total_cmp(&normal[j].abs()))?;
        let (mut u, mut v) = (walls[(axis + 1) % 3], walls[(axis + 2) % 3]);
        if normal[axis] < 0.0 {
            (u, v) = (v, u);
        }
        let edges = vec![v[0], u[1], v[1], u[0]];
        let corner = |k: usize| Corner::of([plane, edges[(k + 3) % 4], edges[k]], rows).map(Rc::new);
        let corners = (0..4).map(corner).collect::<Option<Vec<_>>>()?;
        let [low, high] = walls[axis];
        Self { plane, corners, edges }.on_side(low, 1, rows)?.on_side(high, -1, rows)
    }

    pub(crate) fn corners(&self) -> &[Rc<Corner>] {
        &self.corners
    }

    /// The part on a side of a plane: 1 in front, -1 behind. None also if the polygon lies on the plane.
    pub(crate) fn on_side(self, of: PlaneId, sign: i32, rows: &Planes) -> Option<Self> {
        let sides = self.sides(of, rows);
        match (sides.contains(&sign), sides.contains(&-sign)) {
            (true, true) => Some(self.part(of, &sides, sign, rows)),
            (true, false) => Some(self),
            (false, _) => None,
        }
    }

    /// The parts on both sides of a plane.
    pub(crate) fn cut(&self, by: PlaneId, rows: &Planes) -> Cut {
        let sides = self.sides(by, rows);
        match (sides.contains(&1), sides.contains(&-1)) {
            (true, true) => Cut::Both(self.part(by, &sides, 1, rows), self.part(by, &sides, -1, rows)),
            (true, false) => Cut::Whole(1),
            (false, true) => Cut::Whole(-1),
            (false, false) => Cut::On,
        }
    }

    /// The sides of a plane that the corners are on.
    fn sides(&self, of: PlaneId, rows: &Planes) -> Vec<i32> {
        if of == self.plane {
            return vec![0; self.corners.len()];
        }
        self.corners.iter().map(|corner| corner.side(of, rows)).collect()
    }

    /// The part on a side of a plane that has corners on both.
    fn part(&self, plane: PlaneId, sides: &[i32], sign: i32, rows: &Planes) -> Self {
        let n = sides.len();
        let (mut corners, mut edges) = (Vec::with_capacity(n + 1), Vec::with_capacity(n + 1));
        for k in 0..n {
            let (here, next) = (sides[k] * sign, sides[(k + 1) % n] * sign);
            if here >= 0 {
                corners.push(Rc::clone(&self.corners[k]));
                // Behind a corner on the plane, the polygon goes on along its own edge or along the plane.
                edges.push(if here == 0 && next < 0 { plane } else { self.edges[k] });
            }
            if here * next < 0 {
                let crossing = Corner::of([self.plane, self.edges[k], plane], rows);
                corners.push(Rc::new(crossing.expect("an edge with its ends on two sides of a plane crosses it")));
                edges.push(if here > 0 { plane } else { self.edges[k] });
            }
        }
        Self { plane: self.plane, corners, edges }
    }
}
