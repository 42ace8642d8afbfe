//! Axis-aligned boxes in any dimension.

/// The closed box of all points between `min` and `max`, in scene units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aabb<const D: usize> {
    /// Lower corner.
    pub min: [f64; D],
    /// Upper corner.
    pub max: [f64; D],
}

impl<const D: usize> Aabb<D> {
    /// The box that contains nothing: extending it by a point gives that point.
    pub const EMPTY: Self = Self { min: [f64::INFINITY; D], max: [f64::NEG_INFINITY; D] };

    /// Smallest box around `points`; [`Aabb::EMPTY`] for none.
    pub fn around(points: impl IntoIterator<Item = [f64; D]>) -> Self {
        points.into_iter().fold(Self::EMPTY, Self::with)
    }

    /// Half the surface of the box; in the plane, its area. Rounded.
    pub fn half_surface(&self) -> f64 {
        let size = |k: usize| self.max[k] - self.min[k];
        (0..D).flat_map(|i| (0..i).map(move |j| (i, j))).map(|(i, j)| size(i) * size(j)).sum()
    }

    /// The box extended to contain `p`.
    #[must_use]
    pub fn with(mut self, p: [f64; D]) -> Self {
        for (axis, &x) in p.iter().enumerate() {
            self.min[axis] = self.min[axis].min(x);
            self.max[axis] = self.max[axis].max(x);
        }
        self
    }

    /// The smallest box around this one and another. What is [empty](Self::is_empty) adds nothing.
    #[must_use]
    pub fn united(self, other: Self) -> Self {
        match (self.is_empty(), other.is_empty()) {
            (true, true) => Self::EMPTY,
            (true, false) => other,
            (false, true) => self,
            (false, false) => self.with(other.min).with(other.max),
        }
    }

    /// Whether `p` is inside or on the boundary.
    pub fn contains(&self, p: [f64; D]) -> bool {
        (0..D).all(|k| self.min[k] <= p[k] && p[k] <= self.max[k])
    }

    /// Whether no point is inside.
    pub fn is_empty(&self) -> bool {
        (0..D).any(|k| self.min[k] > self.max[k])
    }
}

impl Aabb<3> {
    /// The eight corners; bit `k` of the index selects lower (0) or upper along axis `k`.
    pub fn corners(&self) -> [[f64; 3]; 8] {
        std::array::from_fn(|i| std::array::from_fn(|k| if i >> k & 1 == 0 { self.min[k] } else { self.max[k] }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_are_numbered_by_their_sides() {
        let b = Aabb { min: [0.0, 1.0, 2.0], max: [3.0, 4.0, 5.0] };
        let corners = b.corners();
        assert_eq!([corners[0], corners[1], corners[6]], [[0.0, 1.0, 2.0], [3.0, 1.0, 2.0], [0.0, 4.0, 5.0]]);
        assert_eq!(Aabb::around(corners), b);
    }

    #[test]
    fn boxes_grow_and_contain() {
        let b = Aabb::around([[0.0, 2.0], [3.0, -1.0]]);
        assert_eq!(b, Aabb { min: [0.0, -1.0], max: [3.0, 2.0] });
        assert!(b.contains([3.0, 2.0]) && !b.contains([3.1, 0.0]));
        assert!(Aabb::<2>::EMPTY.is_empty() && !b.is_empty());
    }

    #[test]
    fn empty_boxes_add_nothing() {
        let (a, b) = (Aabb { min: [0.0, 2.0], max: [1.0, 3.0] }, Aabb { min: [-1.0, 2.5], max: [0.5, 2.5] });
        assert_eq!(a.united(b), Aabb { min: [-1.0, 2.0], max: [1.0, 3.0] });
        // Empty along one axis only: its ends along the other one do not count.
        let empty = Aabb { min: [9.0, 5.0], max: [10.0, 4.0] };
        assert_eq!([a.united(empty), empty.united(a), empty.united(empty)], [a, a, Aabb::EMPTY]);
    }
}
