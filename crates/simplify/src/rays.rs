//! Rays through a scene, one by one, by the exact ray caster.

use sightlines_geometry::Point3;
use sightlines_visible_surface::{Camera, FaceMask, Faces, NOTHING, RayCaster, Rays};

/// A scene that rays are sent through.
#[derive(Debug)]
pub(crate) struct Traced<'a> {
    faces: &'a Faces,
    chosen: FaceMask,
    caster: RayCaster,
}

impl<'a> Traced<'a> {
    /// O(n log n).
    pub(crate) fn new(faces: &'a Faces) -> Self {
        Self::of(faces, |_| true)
    }

    /// With those faces only that `keeps`: rays pass all others. O(n log n).
    pub(crate) fn of(faces: &'a Faces, keeps: impl FnMut(u32) -> bool) -> Self {
        let mut chosen = FaceMask::all(faces);
        chosen.retain(keeps);
        Self { faces, chosen, caster: RayCaster::build(faces) }
    }

    /// Rays for one thread.
    pub(crate) fn rays(&self) -> FirstHits<'_> {
        FirstHits(self.caster.rays(self.faces, &self.chosen))
    }
}

/// Rays, one by one.
#[derive(Debug)]
pub(crate) struct FirstHits<'a>(Rays<'a>);

impl FirstHits<'_> {
    /// The face that a ray hits first; `None` if it hits nothing, or if the direction is zero.
    pub(crate) fn of(&mut self, eye: Point3, direction: Point3) -> Option<u32> {
        let camera = one_pixel(eye, direction)?;
        Some(self.0.first(&camera, 0, 0)).filter(|&face| face != NOTHING)
    }
}

/// A camera with one pixel, whose ray has a direction except for the last bits.
fn one_pixel(eye: Point3, direction: Point3) -> Option<Camera> {
    let [x, y, z] = direction.map(f64::abs);
    // Right and down along the axes to which the direction is most perpendicular; half of each is subtracted again.
    let (i, j) = if x >= y && x >= z {
        (1, 2)
    } else if y >= z {
        (2, 0)
    } else {
        (0, 1)
    };
    let size = x.max(y).max(z);
    let along = |k: usize| std::array::from_fn(|axis| if axis == k { size } else { 0.0 });
    let mut corner = direction;
    corner[i] -= size / 2.0;
    corner[j] -= size / 2.0;
    Camera::new(eye, corner, along(i), along(j), [1, 1]).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use sightlines_geometry::Random;

    #[test]
    fn rays_go_where_they_are_sent() {
        let mut random = Random::new(9);
        for _ in 0..1000 {
            let way = random.direction();
            let camera = one_pixel([1.0, 2.0, 3.0], way).unwrap();
            let ray = camera.ray(0.5, 0.5);
            assert!((0..3).all(|k| (ray[k] - way[k]).abs() < 1e-15), "{way:?} {ray:?}");
        }
        assert!(one_pixel([0.0; 3], [0.0; 3]).is_none());
    }

    #[test]
    fn the_nearer_face_is_met() {
        let square = |x: f64| [[x, -1.0, -1.0], [x, 3.0, -1.0], [x, -1.0, 3.0]];
        let faces = Faces::new(vec![square(2.0), square(1.0), square(-1.0)]).unwrap();
        let traced = Traced::new(&faces);
        let mut rays = traced.rays();
        assert_eq!(rays.of([0.0; 3], [1.0, 0.1, 0.1]), Some(1));
        assert_eq!(rays.of([1.5, 0.0, 0.0], [1.0, 0.1, 0.1]), Some(0));
        assert_eq!(rays.of([0.0; 3], [-1.0, 0.1, 0.1]), Some(2));
        assert_eq!(rays.of([0.0; 3], [0.0, 1.0, 0.0]), None);
    }
}
