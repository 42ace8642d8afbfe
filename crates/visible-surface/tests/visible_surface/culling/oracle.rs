//! Rays and triangles in whole numbers: what cannot be wrong by rounding.

use sightlines_geometry::{Aabb, Point3};
use sightlines_visible_surface::{Camera, FaceMask, Faces, Image, NOTHING};

pub(crate) type P = [i128; 3];

pub(crate) fn minus(a: P, b: P) -> P {
    [0, 1, 2].map(|k| a[k] - b[k])
}

pub(crate) fn cross(a: P, b: P) -> P {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| a[i] * b[j] - a[j] * b[i])
}

pub(crate) fn dot(a: P, b: P) -> i128 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn along(a: P, t: i128, d: P) -> P {
    [0, 1, 2].map(|k| a[k] + t * d[k])
}

pub(crate) fn real(p: P) -> Point3 {
    p.map(|x| x as f64)
}

/// Chance that is the same everywhere.
pub(crate) struct Chance(pub(crate) u64);

impl Chance {
    pub(crate) fn below(&mut self, n: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 33) % n
    }

    /// From `-n` to `n`.
    pub(crate) fn within(&mut self, n: i128) -> i128 {
        self.below(2 * n as u64 + 1) as i128 - n
    }

    pub(crate) fn point(&mut self, n: i128) -> P {
        [0; 3].map(|_| self.within(n))
    }
}

/// A camera of whole numbers.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Eye {
    pub(crate) eye: P,
    pub(crate) rays: [P; 3],
    pub(crate) size: [u32; 2],
    pub(crate) near: i128,
    /// None for infinite.
    pub(crate) far: Option<i128>,
}

impl Eye {
    /// One that looks along z, with about a quarter of a right angle to each side.
    pub(crate) fn ahead(eye: P, size: [u32; 2]) -> Self {
        let half = i128::from(size[0].max(size[1]));
        // Twice everything, so that the axis is in the middle of the picture.
        let rays = [[-i128::from(size[0]), i128::from(size[1]), 2 * half], [2, 0, 0], [0, -2, 0]];
        Self { eye, rays, size, near: 0, far: None }
    }

    pub(crate) fn any(chance: &mut Chance) -> Self {
        loop {
            let size = [1 + chance.below(9) as u32, 1 + chance.below(9) as u32];
            let near = chance.below(3) as i128;
            let far = (chance.below(3) > 0).then(|| near + 1 + chance.below(9) as i128);
            let rays = if chance.below(2) == 0 {
                Self::ahead([0; 3], size).rays
            } else {
                [chance.point(5), chance.point(2), chance.point(2)]
            };
            let out = Self { eye: chance.point(3), rays, size, near, far };
            if dot(rays[1], cross(rays[2], rays[0])) != 0 {
                return out;
            }
        }
    }

    pub(crate) fn camera(&self) -> Camera {
        let [corner, across, down] = self.rays.map(real);
        let camera = Camera::new(real(self.eye), corner, across, down, self.size).expect("the rays span space");
        let far = self.far.map_or(f64::INFINITY, |x| x as f64);
        camera.with_depths(self.near as f64, far).expect("near is less than far")
    }

    /// The ray through a place given in parts of a pixel, times `parts`.
    pub(crate) fn ray(&self, parts: i128, x: i128, y: i128) -> P {
        let [corner, across, down] = self.rays;
        along(along(corner.map(|v| v * parts), x, across), y, down)
    }

    /// The rays through all places of a grid with so many parts to a pixel, borders included; for 0 those through the
    /// centres of pixels. Each with the number that it was multiplied by.
    pub(crate) fn fan(&self, parts: i128) -> Vec<(i128, P)> {
        let [width, height] = self.size.map(i128::from);
        let mut all = Vec::new();
        if parts == 0 {
            for y in 0..height {
                all.extend((0..width).map(|x| (2, self.ray(2, 2 * x + 1, 2 * y + 1))));
            }
        } else {
            for y in 0..=height * parts {
                all.extend((0..=width * parts).map(|x| (parts, self.ray(parts, x, y))));
            }
        }
        all
    }

    /// Whether a depth, as numerator and positive denominator for a ray that was multiplied by `times`, is seen.
    fn sees(&self, times: i128, (t, per): (i128, i128)) -> bool {
        t * times >= self.near * per && self.far.is_none_or(|far| t * times <= far * per)
    }

    /// Where a ray meets a closed triangle, as a numerator and a positive denominator.
    pub(crate) fn hit(&self, times: i128, ray: P, corners: &[P; 3]) -> Option<(i128, i128)> {
        let [a, b, c] = corners.map(|p| minus(p, self.eye));
        let normal = cross(minus(b, a), minus(c, a));
        let (v, q) = (dot(normal, a), dot(normal, ray));
        if v == 0 || [(a, b), (b, c), (c, a)].iter().any(|&(p, q)| dot(cross(p, q), ray) * v.signum() < 0) {
            return None;
        }
        assert!(v * q > 0, "a ray inside of the cone of a triangle meets its plane in front");
        Some((v.abs(), q.abs())).filter(|&t| self.sees(times, t))
    }

    /// For each ray of a fan the nearest face, of several the first.
    pub(crate) fn picture(&self, parts: i128, faces: &[[P; 3]], keep: impl Fn(u32) -> bool) -> Vec<u32> {
        self.fan(parts).iter().map(|&(times, ray)| self.nearest(times, ray, faces, &keep).0).collect()
    }

    pub(crate) fn nearest(
        &self,
        times: i128,
        ray: P,
        faces: &[[P; 3]],
        keep: impl Fn(u32) -> bool,
    ) -> (u32, (i128, i128)) {
        let mut best = (NOTHING, (1, 0));
        for (id, face) in (0..).zip(faces).filter(|(id, _)| keep(*id)) {
            if let Some(t) = self.hit(times, ray, face).filter(|t| t.0 * best.1.1 < best.1.0 * t.1) {
                best = (id, t);
            }
        }
        best
    }

    pub(crate) fn image(&self, faces: &[[P; 3]], chosen: &FaceMask) -> Image {
        let mut image = Image::new(self.size);
        image.faces_mut().copy_from_slice(&self.picture(0, faces, |f| chosen.has(f)));
        image
    }

    /// Whether some ray of a fan sees a closed box: reaches it before it meets a face.
    pub(crate) fn sees_box(&self, parts: i128, faces: &[[P; 3]], keep: impl Fn(u32) -> bool, b: &[P; 2]) -> bool {
        self.fan(parts).iter().any(|&(times, ray)| {
            let Some(enter) = self.enters(times, ray, b) else { return false };
            let (_, t) = self.nearest(times, ray, faces, &keep);
            t.0 * enter.1 >= enter.0 * t.1
        })
    }

    /// Where a ray enters a box, at depths that are seen.
    fn enters(&self, times: i128, ray: P, [min, max]: &[P; 2]) -> Option<(i128, i128)> {
        let (mut low, mut high) = ((self.near, times), self.far.map_or((1, 0), |far| (far, times)));
        let less = |a: (i128, i128), b: (i128, i128)| a.0 * b.1 < b.0 * a.1;
        for k in 0..3 {
            let (a, b) = (min[k] - self.eye[k], max[k] - self.eye[k]);
            if ray[k] == 0 {
                if a > 0 || b < 0 {
                    return None;
                }
                continue;
            }
            let (a, b) = if ray[k] > 0 { (a, b) } else { (-b, -a) };
            let (from, to) = ((a, ray[k].abs()), (b, ray[k].abs()));
            low = if less(low, from) { from } else { low };
            high = if less(to, high) { to } else { high };
        }
        (!less(high, low)).then_some(low)
    }
}

pub(crate) fn faces_of(corners: &[[P; 3]]) -> Faces {
    Faces::new(corners.iter().map(|f| f.map(real)).collect()).expect("small whole numbers are coordinates")
}

pub(crate) fn any_box(chance: &mut Chance, n: i128) -> [P; 2] {
    let (a, b) = (chance.point(n), chance.point(n));
    [[0, 1, 2].map(|k| a[k].min(b[k])), [0, 1, 2].map(|k| a[k].max(b[k]))]
}

pub(crate) fn aabb([min, max]: &[P; 2]) -> Aabb<3> {
    Aabb { min: real(*min), max: real(*max) }
}
