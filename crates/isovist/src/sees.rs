//! Whether two points see each other.

use crate::edge::{NONE, next, previous};
use crate::locate::MeshPlace;
use crate::{EyeError, WallMesh};
use sightlines_geometry::{Point2, along};

/// What a line of sight may do that touches a wall without crossing it: passes its end, or runs along it.
///
/// Walls at the two points themselves never block: a point on a wall looks to both sides of it, and is seen from both.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Touch {
    /// Walls are closed: to touch one between the two points is to be blocked. So is the connectivity of depthmapX.
    #[default]
    Blocks,
    /// Walls may be touched: a line is blocked where, in one contact, it has walls on both of its sides. So are visibility graphs for shortest
    /// paths, in which corners of obstacles see each other along their sides.
    Passes,
}

impl Touch {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Blocks, Self::Passes];

    /// Its name: `blocks`, `passes`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Blocks => "blocks",
            Self::Passes => "passes",
        }
    }
}

/// What a contact with walls has met so far.
#[derive(Debug, Clone, Copy, Default)]
struct Contact {
    left: bool,
    right: bool,
}

/// Where a line goes from a corner.
enum Next {
    /// Through the inside of the triangle in front of this edge's twin.
    Across(u32),
    /// Along an edge, which leaves the corner or ends there, to a corner at the start of an edge.
    Along { wall: bool, to: u32 },
}

impl WallMesh {
    /// Whether two points see each other: no wall is in the way of the straight line between them. Symmetric, exact.
    ///
    /// Points on a wall are on both of its sides. A point sees itself.
    ///
    /// Cost: about 10 ns for each triangle between the two.
    ///
    /// # Errors
    /// [`EyeError`] for a point outside of the frame or with coordinates that are none.
    pub fn sees(&self, a: Point2, b: Point2, touch: Touch) -> Result<bool, EyeError> {
        let (a, from) = self.locate(a)?;
        let (b, _) = self.locate(b)?;
        Ok(self.sees_from(a, from, b, touch))
    }

    /// The same for points that have been checked.
    pub(crate) fn sees_from(&self, a: Point2, from: MeshPlace, b: Point2, touch: Touch) -> bool {
        if a == b {
            return true;
        }
        let mut contact = Contact::default();
        let mut step = match from {
            MeshPlace::Inside(t) => match self.leave(a, b, [3 * t, 3 * t + 1, 3 * t + 2]) {
                None => return true,
                Some(step) => step,
            },
            MeshPlace::OnEdge(edge) => {
                let (u, v) = self.ends(edge);
                let side = self.orient(b, u, v);
                if side == 0.0 {
                    let is_wall = self.edges[edge as usize].wall != NONE;
                    if is_wall && touch == Touch::Blocks {
                        return false;
                    }
                    let to = if self.is_between(a, b, u) { edge } else { next(edge) };
                    if !self.is_between(a, b, self.edges[to as usize].from) {
                        return true;
                    }
                    Step::Corner { edge: to, along_wall: is_wall }
                } else {
                    let edge = if side > 0.0 { edge } else { self.edges[edge as usize].twin };
                    match self.leave(a, b, [next(edge), previous(edge), NONE]) {
                        None => return true,
                        Some(step) => step,
                    }
                }
            }
            MeshPlace::OnCorner(edge) => match self.go_on(a, b, edge) {
                Next::Across(edge) => match self.through(b, edge) {
                    None => return true,
                    Some(step) => step,
                },
                Next::Along { wall, to } => {
                    if wall && touch == Touch::Blocks {
                        return false;
                    }
                    if !self.is_between(a, b, self.edges[to as usize].from) {
                        return true;
                    }
                    Step::Corner { edge: to, along_wall: wall }
                }
            },
        };
        loop {
            match step {
                Step::Edge(edge) => {
                    if self.edges[edge as usize].wall != NONE {
                        return false;
                    }
                    contact = Contact::default();
                    match self.behind(a, b, edge) {
                        None => return true,
                        Some(behind) => step = behind,
                    }
                }
                Step::Corner { edge, along_wall } => {
                    // Strictly between the two. Every corner but those of the frame is the end of a wall.
                    if touch == Touch::Blocks {
                        return false;
                    }
                    if !along_wall {
                        contact = Contact::default();
                    }
                    self.touched(a, b, edge, &mut contact);
                    if contact.left && contact.right {
                        return false;
                    }
                    match self.go_on(a, b, edge) {
                        Next::Across(edge) => match self.through(b, edge) {
                            None => return true,
                            Some(next) => step = next,
                        },
                        Next::Along { wall, to } => {
                            if !self.is_between(a, b, self.edges[to as usize].from) {
                                return true;
                            }
                            step = Step::Corner { edge: to, along_wall: wall };
                        }
                    }
                }
            }
        }
    }

    /// Whether a corner on the line from `a` to `b` is strictly between them. A corner that is off the line may count as well.
    fn is_between(&self, a: Point2, b: Point2, corner: u32) -> bool {
        if self.is_at(a, corner) || self.is_at(b, corner) {
            return false;
        }
        let c = self.corners[corner as usize];
        if c.reach == 0.0 {
            return along(a, c.at, b) && along(b, c.at, a);
        }
        // On the line, the order of the larger coordinate is that of the line; ends that are near are compared exactly.
        let (x, y) = crate::corner::fractions(self.exact(corner));
        let exact = |x: f64| sightlines_exact::BigRational::from_float(x).expect("coordinates are finite");
        let inside =
            |lo: f64, x: &sightlines_exact::BigRational, hi: f64| exact(lo.min(hi)) <= *x && *x <= exact(lo.max(hi));
        inside(a.x, &x, b.x) && inside(a.y, &y, b.y)
    }

    /// How a line leaves a triangle in which it starts, through one of these edges; `None` if it ends there.
    fn leave(&self, a: Point2, b: Point2, edges: [u32; 3]) -> Option<Step> {
        let edges = edges.into_iter().filter(|&e| e != NONE);
        let beyond = |&edge: &u32| {
            let (u, v) = self.ends(edge);
            self.orient(b, u, v) < 0.0
        };
        // Of the edges that have `b` behind them, the one whose ends are on both sides.
        for edge in edges.filter(beyond) {
            let (u, v) = self.ends(edge);
            let (right, left) = (self.side(a, b, u), self.side(a, b, v));
            if right == 0.0 {
                return Some(Step::Corner { edge, along_wall: false });
            }
            if left == 0.0 {
                return Some(Step::Corner { edge: next(edge), along_wall: false });
            }
            if right < 0.0 && left > 0.0 {
                return Some(Step::Edge(edge));
            }
        }
        None
    }

    /// What follows when a line has crossed an edge; `None` if it ends before it leaves the next triangle.
    fn behind(&self, a: Point2, b: Point2, edge: u32) -> Option<Step> {
        let entered = self.edges[edge as usize].twin;
        if entered == NONE {
            return None;
        }
        self.leave(a, b, [next(entered), previous(entered), NONE])
    }

    /// What follows when a line leaves a corner through a triangle, towards its edge opposite the corner.
    fn through(&self, b: Point2, edge: u32) -> Option<Step> {
        let (u, v) = self.ends(edge);
        (self.orient(b, u, v) < 0.0).then_some(Step::Edge(edge))
    }

    /// How the line from `a` to `b` leaves a corner on it, given an edge that starts there.
    fn go_on(&self, a: Point2, b: Point2, corner: u32) -> Next {
        for out in self.leaving(corner) {
            let (opposite, into) = (next(out), previous(out));
            let (right, left) = (self.edges[opposite as usize].from, self.edges[into as usize].from);
            let (side_right, side_left) = (self.side(a, b, right), self.side(a, b, left));
            for (side, edge, to) in [(side_right, out, opposite), (side_left, into, into)] {
                if side == 0.0 && self.is_ahead(a, b, self.edges[out as usize].from, self.edges[to as usize].from) {
                    return Next::Along { wall: self.edges[edge as usize].wall != NONE, to };
                }
            }
            if side_right < 0.0 && side_left > 0.0 {
                return Next::Across(opposite);
            }
        }
        // The line leaves the frame, at which `b` lies.
        Next::Along { wall: false, to: corner }
    }

    /// Whether `to` lies ahead of `from` in the direction from `a` to `b`; all are on one line.
    fn is_ahead(&self, a: Point2, b: Point2, from: u32, to: u32) -> bool {
        let (p, q) = (self.corners[from as usize], self.corners[to as usize]);
        let direction = b - a;
        let far = (q.at - p.at).dot(direction);
        if far.abs() > 4.0 * (p.reach + q.reach) * (direction.x.abs() + direction.y.abs()) {
            return far > 0.0;
        }
        let ((px, py), (qx, qy)) =
            (crate::corner::fractions(self.exact(from)), crate::corner::fractions(self.exact(to)));
        if a.x != b.x { (a.x < b.x) == (px < qx) } else { (a.y < b.y) == (py < qy) }
    }

    /// Notes on which sides of the line from `a` to `b` walls leave a corner that it passes.
    fn touched(&self, a: Point2, b: Point2, corner: u32, contact: &mut Contact) {
        for out in self.leaving(corner) {
            let into = previous(out);
            for (edge, other) in [(out, next(out)), (into, into)] {
                if self.edges[edge as usize].wall != NONE {
                    let side = self.side(a, b, self.edges[other as usize].from);
                    contact.left |= side > 0.0;
                    contact.right |= side < 0.0;
                }
            }
        }
    }
}

/// What a line meets next.
#[derive(Debug, Clone, Copy)]
enum Step {
    /// It crosses the inside of an edge.
    Edge(u32),
    /// It passes the corner at the start of an edge, strictly before its end; it may have come along a wall.
    Corner { edge: u32, along_wall: bool },
}
