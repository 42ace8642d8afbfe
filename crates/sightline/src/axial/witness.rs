//! A line that passes a sequence of doors in space, in fractions.

use super::rows::Line;
use crate::stabber::Witness;
use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive, Zero};
use sightlines_exact::rational;
use sightlines_geometry::AxialDoor;

/// A directed line in space with rational coordinates.
///
/// It is checked by crossing each door's plane ([`AxialWitness::passes`]), which shares no code with the solver.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AxialWitness {
    point: [BigRational; 3],
    direction: [BigRational; 3],
}

impl AxialWitness {
    pub(super) fn new(point: [BigRational; 3], direction: [BigRational; 3]) -> Self {
        Self { point, direction }
    }

    pub(super) fn through(line: &Line) -> Self {
        let (point, to) = (line.from.map(rational), line.to.map(rational));
        let direction = [0, 1, 2].map(|i| &to[i] - &point[i]);
        Self { point, direction }
    }

    /// A point of the line.
    pub const fn point(&self) -> &[BigRational; 3] {
        &self.point
    }

    /// Its direction, which has no zero.
    pub const fn direction(&self) -> &[BigRational; 3] {
        &self.direction
    }

    /// When it reaches the plane of a door, in lengths of its direction from its point.
    fn time(&self, door: &AxialDoor) -> Option<BigRational> {
        let axis = usize::from(door.axis);
        let speed = self.direction.get(axis).filter(|d| !d.is_zero())?;
        Some((rational(door.at()) - &self.point[axis]) / speed)
    }

    fn at(&self, time: &BigRational) -> [BigRational; 3] {
        [0, 1, 2].map(|i| &self.point[i] + time * &self.direction[i])
    }

    /// Whether the line passes the open rectangle, in its direction. Exact.
    pub fn passes(&self, door: &AxialDoor) -> bool {
        let Some(time) = self.time(door) else { return false };
        let axis = usize::from(door.axis);
        let place = self.at(&time);
        let inside = |b: usize| rational(door.extent.min[b]) < place[b] && place[b] < rational(door.extent.max[b]);
        self.direction[axis].is_positive() == door.forward && (0..3).filter(|&b| b != axis).all(inside)
    }

    /// Where the line crosses the plane of a door, rounded; `None` if it is parallel to it.
    pub fn crossing(&self, door: &AxialDoor) -> Option<[f64; 3]> {
        let place = self.at(&self.time(door)?).map(|x| x.to_f64());
        let [x, y, z] = place;
        Some([x?, y?, z?])
    }

    /// Two points in doubles whose line, from the first to the second, passes all of `doors` too
    /// (checked exactly): where this line crosses the first and the last of the planes that it meets.
    /// `None` if rounding spoils that.
    pub fn rounded(&self, doors: &[AxialDoor]) -> Option<[[f64; 3]; 2]> {
        let line = self.line(doors)?;
        doors.iter().all(|door| line.passes(door)).then_some([line.from, line.to])
    }

    /// The line rounded to doubles, without a check of what it passes.
    pub(super) fn line(&self, doors: &[AxialDoor]) -> Option<Line> {
        let times = doors.iter().map(|door| self.time(door)).collect::<Option<Vec<_>>>()?;
        let first = times.iter().min()?.clone();
        let last = times.into_iter().max().filter(|t| *t > first).unwrap_or_else(|| &first + BigRational::one());
        let round = |t: &BigRational| {
            let [x, y, z] = self.at(t).map(|x| x.to_f64());
            Some([x?, y?, z?])
        };
        Line::new(round(&first)?, round(&last)?)
    }
}

impl Witness<AxialDoor> for Box<AxialWitness> {
    fn passes(&self, portal: &AxialDoor) -> bool {
        AxialWitness::passes(self, portal)
    }
}
