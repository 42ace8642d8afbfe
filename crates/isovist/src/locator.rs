//! Triangles near a point.

use crate::corner::Corner;
use crate::edge::{Edge, NONE};
use sightlines_geometry::{Aabb, Point2};

/// Triangles to start from, on a grid.
#[derive(Debug, Clone)]
pub(crate) struct Locator {
    min: Point2,
    scale: Point2,
    n: usize,
    start: Vec<u32>,
}

impl Locator {
    /// About as many cells as triangles.
    pub(crate) fn new(corners: &[Corner], edges: &[Edge], frame: &Aabb<2>) -> Self {
        let n = ((edges.len() as f64 / 3.0).sqrt() as usize).clamp(1, 2048);
        let size = Point2::from(frame.max) - Point2::from(frame.min);
        let mut locator = Self { min: Point2::from(frame.min), scale: n as f64 / size, n, start: vec![NONE; n * n] };
        for triangle in 0..edges.len() as u32 / 3 {
            let at = |k: u32| corners[edges[(3 * triangle + k) as usize].from as usize].at;
            let cell = locator.cell((at(0) + at(1) + at(2)) / 3.0);
            locator.start[cell] = triangle;
        }
        // A cell without a triangle starts where the one before it does.
        let mut last = locator.start.iter().copied().find(|&t| t != NONE).unwrap_or(0);
        for start in &mut locator.start {
            if *start == NONE {
                *start = last;
            }
            last = *start;
        }
        locator
    }

    /// The triangle to start from.
    pub(crate) fn start(&self, p: Point2) -> u32 {
        self.start[self.cell(p)]
    }

    fn cell(&self, p: Point2) -> usize {
        let place = |x: f64| (x as usize).min(self.n - 1);
        let at = (p - self.min) * self.scale;
        place(at.y) * self.n + place(at.x)
    }
}
