//! Where fragments lie to planes, and cutting them.

use super::{Edge, Fragment, On, corner_sign};
use crate::faces::Faces;
use crate::plane::InputPlane;

/// How a fragment lies to a plane; touching it does not count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Relation {
    /// On the positive side or on the plane, not all of it on the plane.
    Front,
    /// On the negative side or on the plane, not all of it on the plane.
    Behind,
    /// In the plane.
    In,
    /// On both sides.
    Across,
}

impl Relation {
    fn of(signs: &[i32]) -> Self {
        match (signs.iter().any(|&s| s > 0), signs.iter().any(|&s| s < 0)) {
            (true, true) => Self::Across,
            (true, false) => Self::Front,
            (false, true) => Self::Behind,
            (false, false) => Self::In,
        }
    }
}

impl Fragment {
    /// For each corner on which side of a plane it lies, exactly. Corner k is where edge k begins.
    fn signs(&self, faces: &Faces, plane: &InputPlane) -> Vec<i32> {
        let own = InputPlane::of(faces, self.face);
        if own == *plane {
            return vec![0; self.n_edges()];
        }
        let at = faces.of(self.face).map(|p| plane.at(faces, p));
        let edges = self.edges();
        let before = |k: usize| &edges[(k + edges.len() - 1) % edges.len()];
        (0..edges.len()).map(|k| corner_sign(faces, self.face, before(k), &edges[k], plane, &at)).collect()
    }

    /// How it lies to a plane, exactly.
    pub fn relation(&self, faces: &Faces, plane: &InputPlane) -> Relation {
        // All corners of the face on one side is the commonest case, and says it without the fragment's own.
        let at = faces.of(self.face).map(|p| plane.at(faces, p));
        if at.iter().all(|a| a.value > a.error) {
            return Relation::Front;
        }
        if at.iter().all(|a| a.value < -a.error) {
            return Relation::Behind;
        }
        Relation::of(&self.signs(faces, plane))
    }

    /// How it lies to a plane, and if it is on both sides its parts: in front (on the positive side), and behind.
    pub fn split(&self, faces: &Faces, plane: &InputPlane) -> (Relation, Option<[Self; 2]>) {
        let relation = self.relation(faces, plane);
        if relation != Relation::Across {
            return (relation, None);
        }
        let signs = self.signs(faces, plane);
        (relation, Some([1, -1].map(|side| self.part(faces, plane, &signs, side))))
    }

    /// The part on one side of a plane that has corners on both.
    fn part(&self, faces: &Faces, plane: &InputPlane, signs: &[i32], side: i8) -> Self {
        let edges = self.edges();
        let n = edges.len();
        // Edge k goes from corner k to the next. It has a part on this side if one of its ends is strictly there.
        let is_there = |k: usize| signs[k % n] * i32::from(side) > 0;
        let stays = |k: usize| is_there(k) || is_there(k + 1);
        let first = (0..n).find(|&k| stays(k) && !stays(k + n - 1)).unwrap_or_else(|| {
            // All edges stay: the plane cuts off a corner between two edges that both reach it.
            (0..n).find(|&k| !is_there(k)).expect("corners lie on both sides")
        });
        let mut out: Vec<Edge> = (0..n).map(|i| (first + i) % n).take_while(|&k| stays(k)).map(|k| edges[k]).collect();
        out.push(Edge::new(faces, self.face, *plane, side));
        Self { face: self.face, edges: Some(out.into()) }
    }

    /// Whether an edge of it lies on a plane that cut it.
    pub fn is_cut_by(&self, plane: &InputPlane) -> bool {
        self.edges().iter().any(|e| e.on == On::Plane(*plane))
    }
}
