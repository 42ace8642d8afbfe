//! What an eye sees, triangle by triangle.
//!
//! Triangular expansion: Bungiu, Hemmer, Hershberger, Huang and Kröller, "Efficient computation of visibility polygons",
//! EuroCG 2014. A view enters a triangle through an edge between two rays, each through a corner, and leaves through the
//! edges that it meets. Rays are known by their corners, so which edges it meets is decided by orientations of the eye and two
//! corners, exactly.

use crate::WallMesh;
use crate::edge::{NONE, next, previous};
use crate::locate::MeshPlace;
use sightlines_geometry::Point2;
use std::collections::HashSet;

/// A part of what is seen through an edge: from the ray through `right`, counter-clockwise, to the ray through `left`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Window {
    pub(crate) edge: u32,
    pub(crate) right: u32,
    pub(crate) left: u32,
}

/// What is told while a view expands.
pub(crate) trait Visitor {
    /// The eye is in this triangle, or on its border.
    fn start(&mut self, triangle: u32);
    /// A triangle is entered through `window.edge`, which is one of its own.
    fn enter(&mut self, window: Window);
    /// The view ends at `window.edge`, a wall or the frame; counter-clockwise.
    fn end(&mut self, window: Window);
}

/// Whether a view that is a single ray is followed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Rays {
    /// A view has an open set of rays.
    Open,
    /// Single rays, which touch corners, are followed too.
    Closed,
}

impl WallMesh {
    /// Expands the view of an eye; `stack` is memory to be used again.
    pub(crate) fn expand(
        &self,
        eye: Point2,
        place: MeshPlace,
        rays: Rays,
        stack: &mut Vec<Window>,
        visitor: &mut impl Visitor,
    ) {
        stack.clear();
        match place {
            MeshPlace::Inside(t) => {
                visitor.start(t);
                self.first(rays, &[3 * t, 3 * t + 1, 3 * t + 2], eye, stack, visitor);
            }
            MeshPlace::OnEdge(edge) => {
                let twin = self.edges[edge as usize].twin;
                visitor.start(edge / 3);
                self.first(rays, &[next(edge), previous(edge)], eye, stack, visitor);
                if twin != NONE {
                    visitor.start(twin / 3);
                    self.first(rays, &[next(twin), previous(twin)], eye, stack, visitor);
                }
            }
            MeshPlace::OnCorner(edge) => {
                // Counter-clockwise; on the frame the first triangles come last, and the order begins with them.
                let mut out: Vec<u32> = self.leaving(edge).collect();
                if let Some(gap) =
                    out.windows(2).position(|pair| self.edges[previous(pair[0]) as usize].twin != pair[1])
                {
                    out[gap + 1..].reverse();
                    out.rotate_left(gap + 1);
                }
                for edge in out {
                    visitor.start(edge / 3);
                    self.first(rays, &[next(edge)], eye, stack, visitor);
                }
            }
        }
    }

    /// Follows the view through edges around the eye, whole.
    fn first(&self, rays: Rays, edges: &[u32], eye: Point2, stack: &mut Vec<Window>, visitor: &mut impl Visitor) {
        for &edge in edges {
            let (right, left) = self.ends(edge);
            stack.push(Window { edge, right, left });
            match rays {
                Rays::Open => self.follow::<false>(eye, stack, visitor),
                Rays::Closed => self.follow::<true>(eye, stack, visitor),
            }
        }
    }

    #[inline(always)]
    fn follow<const CLOSED: bool>(&self, eye: Point2, stack: &mut Vec<Window>, visitor: &mut impl Visitor) {
        // Single rays by edge and corner: several ways lead along one line of walls, and each edge is crossed once.
        let mut followed: HashSet<(u32, u32)> = HashSet::new();
        // Each window is about to leave a triangle through its edge.
        while let Some(Window { edge, right, left }) = stack.pop() {
            if CLOSED && self.orient(eye, right, left) == 0.0 && !followed.insert((edge, right)) {
                continue;
            }
            let crossed = self.edges[edge as usize];
            if crossed.wall != NONE || crossed.twin == NONE {
                visitor.end(Window { edge, right, left });
                continue;
            }
            let entered = crossed.twin;
            visitor.enter(Window { edge: entered, right, left });
            // The edge runs from left to right in the triangle behind it.
            let (on_right, on_left) = (next(entered), previous(entered));
            let apex = self.edges[on_left as usize].from;
            let (of_right, of_left) = (self.orient(eye, right, apex), self.orient(eye, left, apex));
            let (sees_right, sees_left) =
                if CLOSED { (of_right >= 0.0, of_left <= 0.0) } else { (of_right > 0.0, of_left < 0.0) };
            if sees_left {
                let right = if of_right > 0.0 { apex } else { right };
                stack.push(Window { edge: on_left, right, left });
            }
            if sees_right {
                let left = if of_left < 0.0 { apex } else { left };
                stack.push(Window { edge: on_right, right, left });
            }
        }
    }
}
