//! The method: what is hidden from a box, target by target.

use crate::roots::Roots;
use crate::search::{Outcome, Patience, Search};
use crate::surface::Surface;
use crate::touch::Target;
use sightlines_geometry::coordinate::MIN_MAGNITUDE;
use sightlines_geometry::{Aabb, Point3, check_coordinate};
use sightlines_multifocal::mesh::{avoids, collinear};
use sightlines_multifocal::{BackendError, FromRegion, Guarantee, Umbra, Volume};
use std::sync::Arc;

/// How much is done for one target at most. More finds more hidden, as a rule; nothing is ever hidden wrongly.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Effort {
    /// Cells of line space for a box. A box around triangles, each of which can be tested instead, gets at most half a cell for each.
    pub box_cells: u32,
    /// Cells of line space for a triangle.
    pub triangle_cells: u32,
    /// How many triangles that a line hits are tried as starts of chains.
    pub attempts: u32,
    /// How many triangles a chain has.
    pub longest_chain: u32,
}

impl Default for Effort {
    fn default() -> Self {
        Self { box_cells: 32, triangle_cells: 400, attempts: 4, longest_chain: 300 }
    }
}

/// Hides by subdividing line space; see the front page of this crate.
#[derive(Debug)]
pub struct LineSpace {
    surface: Arc<Surface>,
    effort: Effort,
    search: Search,
    n_cells: u64,
}

impl LineSpace {
    /// For a scene of triangles, with the default effort. O(n log² n).
    pub fn new(triangles: &[[Point3; 3]]) -> Self {
        Self::shared(Arc::new(Surface::new(triangles)), Effort::default())
    }

    /// The same of triangles that hide from both sides, and of others that hide from their fronts only.
    pub fn with_fronts(both_sides: &[[Point3; 3]], fronts: &[[Point3; 3]]) -> Self {
        Self::shared(Arc::new(Surface::with_fronts(both_sides, fronts)), Effort::default())
    }

    /// For a surface that others use as well. O(n).
    pub fn shared(surface: Arc<Surface>, effort: Effort) -> Self {
        let search = Search::new(&surface, effort.attempts as usize, effort.longest_chain as usize);
        Self { surface, effort, search, n_cells: 0 }
    }

    /// How many cells of line space were tested until now.
    pub const fn n_cells(&self) -> u64 {
        self.n_cells
    }

    /// Decides whether a box can be seen from another one: about the lines from all points of `volume` to all points of
    /// `target`.
    pub fn see_box(&mut self, volume: &Aabb<3>, target: &Aabb<3>, budget: u32) -> Outcome {
        self.search.look_from(volume);
        self.box_from(volume, target, budget, Patience::Full)
    }

    fn box_from(&mut self, volume: &Aabb<3>, target: &Aabb<3>, budget: u32, patience: Patience) -> Outcome {
        let Some((volume, target)) = with_area(volume).zip(with_area(target)) else { return Outcome::Undecided };
        if (0..3).all(|k| volume.min[k] <= target.max[k] && target.min[k] <= volume.max[k]) {
            return Outcome::Undecided;
        }
        self.run(&Roots::to_box(&volume, &target), &Target::Box, budget, patience)
    }

    /// Decides whether a triangle can be seen from a box: about the lines from all points of `volume` to all inner points of the
    /// triangle.
    pub fn see_triangle(&mut self, volume: &Aabb<3>, triangle: [Point3; 3], budget: u32) -> Outcome {
        self.search.look_from(volume);
        self.triangle_from(volume, triangle, budget, Patience::Full)
    }

    fn triangle_from(&mut self, volume: &Aabb<3>, triangle: [Point3; 3], budget: u32, patience: Patience) -> Outcome {
        let Some(volume) = with_area(volume) else { return Outcome::Undecided };
        if triangle.iter().flatten().any(|&x| check_coordinate(x).is_err()) || !avoids(&triangle, &volume, false) {
            return Outcome::Undecided;
        }
        let [a, b, c] = triangle;
        if collinear(a, b, c) {
            return self.box_from(&volume, &Aabb::around(triangle), budget, patience);
        }
        self.run(&Roots::to_triangle(&volume, triangle), &Target::Triangle(triangle), budget, patience)
    }

    fn run(&mut self, roots: &Roots, target: &Target, budget: u32, patience: Patience) -> Outcome {
        let (outcome, n) = self.search.run(&self.surface, roots, target, budget, patience);
        self.n_cells += u64::from(n);
        outcome
    }
}

/// The box, or a larger one where it has no area: a box that is flat along two axes is made thicker along these, by a 2^-40th of its
/// coordinates or size. None for boxes without points and coordinates that predicates cannot take.
pub(crate) fn with_area(b: &Aabb<3>) -> Option<Aabb<3>> {
    let is_flat = |k: usize| b.min[k] == b.max[k];
    let mut larger = *b;
    if (0..3).filter(|&k| is_flat(k)).count() > 1 {
        let size =
            (0..3).map(|k| b.min[k].abs().max(b.max[k].abs())).fold(MIN_MAGNITUDE * (1u64 << 50) as f64, f64::max);
        let more = size / (1u64 << 40) as f64;
        for k in (0..3).filter(|&k| is_flat(k)) {
            (larger.min[k], larger.max[k]) = (b.min[k] - more, b.max[k] + more);
        }
    }
    let usable = |x: &f64| check_coordinate(*x).is_ok();
    (!b.is_empty() && larger.min.iter().chain(&larger.max).all(usable)).then_some(larger)
}

impl FromRegion for LineSpace {
    fn name(&self) -> String {
        "line-space".to_owned()
    }

    fn guarantee(&self) -> Guarantee {
        Guarantee::Conservative
    }

    fn umbra(&mut self, volume: &Volume) -> Result<Box<dyn Umbra + '_>, BackendError> {
        let volume = *volume.bounds();
        self.search.look_from(&volume);
        Ok(Box::new(LineUmbra { method: self, volume }))
    }
}

#[derive(Debug)]
struct LineUmbra<'a> {
    method: &'a mut LineSpace,
    volume: Aabb<3>,
}

impl Umbra for LineUmbra<'_> {
    fn hides(&mut self, target: &Aabb<3>) -> bool {
        let budget = self.method.effort.box_cells;
        self.method.box_from(&self.volume, target, budget, Patience::WhileItPays) == Outcome::Hidden
    }

    fn hides_box_of(&mut self, target: &Aabb<3>, n_triangles: usize) -> bool {
        let budget = u32::try_from(n_triangles / 2).unwrap_or(u32::MAX).min(self.method.effort.box_cells);
        self.method.box_from(&self.volume, target, budget, Patience::WhileItPays) == Outcome::Hidden
    }

    fn forget(&mut self) {
        self.method.search.forget();
    }

    fn hides_points(&mut self, points: &[Point3]) -> bool {
        let budget = self.method.effort.triangle_cells;
        match *points {
            [a, b, c] => {
                self.method.triangle_from(&self.volume, [a, b, c], budget, Patience::WhileItPays) == Outcome::Hidden
            }
            _ => self.hides(&Aabb::around(points.iter().copied())),
        }
    }
}
