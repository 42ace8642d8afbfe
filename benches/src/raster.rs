//! A plain z-buffer: what a frame costs, and what is in it.
//!
//! Convex polygons are filled row by row, with no tricks but that nothing outside the picture is touched.
//! What a pixel shows depends on the triangles given and not on their order: the nearest wins, and of those
//! at the same distance the one with the lowest number. Edges are computed from their ends in one order, so
//! triangles that share an edge leave no gap.

use sightlines::cells::{Point3, Scene};
use sightlines::eye_to_cell::View;
use sightlines::geometry::Aabb;
use sightlines::geometry::vector::{cross, dot, sub};
use std::f64::consts::FRAC_PI_2;

/// Nothing nearer than this is drawn, in scene units.
const NEAR: f64 = 1.0 / 64.0;
/// What a pixel shows where nothing is.
pub const NOTHING: u32 = u32::MAX;

/// An eye, upright: y is up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Where it is, in scene units.
    pub eye: Point3,
    right: Point3,
    up: Point3,
    ahead: Point3,
}

impl Camera {
    /// An eye at `eye` that looks along `ahead`, which is neither zero nor vertical.
    pub fn new(eye: Point3, ahead: Point3) -> Self {
        let ahead = unit(ahead);
        let right = unit(cross(ahead, [0.0, 1.0, 0.0]));
        Self { eye, right, up: cross(right, ahead), ahead }
    }

    /// The same eye for a picture 90 degrees wide, `aspect` times as wide as high.
    ///
    /// # Panics
    /// If the eye is nowhere.
    pub fn view(&self, aspect: f64) -> View {
        View::perspective_horizontal(self.eye, self.ahead, self.up, FRAC_PI_2, aspect)
            .expect("an eye somewhere, looking somewhere")
    }

    /// Right, up and ahead of the eye.
    fn seen(&self, p: Point3) -> Point3 {
        let d = [0, 1, 2].map(|k| p[k] - self.eye[k]);
        [dot(d, self.right), dot(d, self.up), dot(d, self.ahead)]
    }
}

/// A picture: for each pixel the number of a triangle.
#[derive(Debug, Clone)]
pub struct Picture {
    width: usize,
    height: usize,
    /// Pixels for a slope of 1.
    focal: f64,
    /// Row by row from the top, the number of the triangle, or [`NOTHING`].
    pub faces: Vec<u32>,
    /// One over the distance ahead of the eye; 0 where nothing is.
    nearness: Vec<f64>,
    seen: Vec<Point3>,
}

/// How much was drawn.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Drawn {
    /// Objects whose triangles were looked at.
    pub n_objects: u64,
    /// Triangles of these.
    pub n_triangles: u64,
}

impl Picture {
    /// `width` by `height` pixels, 90 degrees wide.
    pub fn new(width: usize, height: usize) -> Self {
        let n = width * height;
        let (faces, nearness) = (vec![NOTHING; n], vec![0.0; n]);
        Self { width, height, focal: width as f64 / 2.0, faces, nearness, seen: Vec::new() }
    }

    /// How much wider it is than high.
    pub fn aspect(&self) -> f64 {
        self.width as f64 / self.height as f64
    }

    /// Draws `objects` of a scene anew. The number of a triangle counts through the whole scene, object by
    /// object; `first[o]` is that of the first one of object `o`.
    ///
    /// * `boxes`: if given, objects with boxes outside the view are left out.
    pub fn draw(
        &mut self,
        scene: &Scene,
        first: &[u32],
        objects: impl IntoIterator<Item = u32>,
        boxes: Option<&[Aabb<3>]>,
        camera: &Camera,
    ) -> Drawn {
        self.faces.fill(NOTHING);
        self.nearness.fill(0.0);
        let mut drawn = Drawn::default();
        for o in objects {
            if boxes.is_some_and(|boxes| self.is_outside(&boxes[o as usize], camera)) {
                continue;
            }
            let object = &scene.objects()[o as usize];
            let mut seen = std::mem::take(&mut self.seen);
            seen.clear();
            seen.extend(object.vertices.iter().map(|p| camera.seen(*p)));
            for (face, t) in (first[o as usize]..).zip(&object.triangles) {
                self.triangle(t.map(|i| seen[i as usize]), face);
            }
            self.seen = seen;
            drawn.n_objects += 1;
            drawn.n_triangles += object.triangles.len() as u64;
        }
        drawn
    }

    /// Whether a box lies on the far side of one of the five planes of the view.
    fn is_outside(&self, b: &Aabb<3>, camera: &Camera) -> bool {
        let corners: [Point3; 8] =
            std::array::from_fn(|i| camera.seen([0, 1, 2].map(|k| if i >> k & 1 == 1 { b.max[k] } else { b.min[k] })));
        let [wide, high] = [self.width, self.height].map(|n| n as f64 / 2.0 / self.focal);
        let all = |outside: &dyn Fn(&Point3) -> bool| corners.iter().all(outside);
        all(&|p| p[2] < NEAR)
            || all(&|p| p[0] > wide * p[2])
            || all(&|p| p[0] < -wide * p[2])
            || all(&|p| p[1] > high * p[2])
            || all(&|p| p[1] < -high * p[2])
    }

    /// Draws one triangle, with corners as the eye sees them.
    fn triangle(&mut self, corners: [Point3; 3], face: u32) {
        if corners.iter().all(|p| p[2] < NEAR) {
            return;
        }
        let [a, b, c] = corners;
        let normal = cross(sub(b, a), sub(c, a));
        let away = dot(normal, a);
        if away == 0.0 {
            // Seen edge-on.
            return;
        }
        // One over the distance is linear in the picture.
        let slope = normal.map(|n| n / away);
        let mut outline = [[0.0; 2]; 4];
        let mut n = 0;
        for i in 0..3 {
            let (p, q) = (corners[i], corners[(i + 1) % 3]);
            if p[2] >= NEAR {
                outline[n] = self.place(p);
                n += 1;
            }
            if (p[2] >= NEAR) != (q[2] >= NEAR) {
                outline[n] = self.place(where_near(p, q));
                n += 1;
            }
        }
        self.fill(&outline[..n], slope, face);
    }

    /// Pixels to the right and down.
    fn place(&self, p: Point3) -> [f64; 2] {
        [self.width as f64 / 2.0 + self.focal * p[0] / p[2], self.height as f64 / 2.0 - self.focal * p[1] / p[2]]
    }

    /// Fills a convex polygon: the pixels whose middle is inside.
    fn fill(&mut self, outline: &[[f64; 2]], slope: Point3, face: u32) {
        let (low, high) = outline.iter().fold((f64::MAX, f64::MIN), |(l, h), p| (l.min(p[1]), h.max(p[1])));
        for row in first_middle(low, self.height)..first_middle(high, self.height) {
            let y = row as f64 + 0.5;
            let (mut left, mut right) = (f64::MAX, f64::MIN);
            for (i, &p) in outline.iter().enumerate() {
                let q = outline[(i + 1) % outline.len()];
                if let Some(x) = where_row(p, q, y) {
                    (left, right) = (left.min(x), right.max(x));
                }
            }
            let up = (self.height as f64 / 2.0 - y) / self.focal;
            for column in first_middle(left, self.width)..first_middle(right, self.width) {
                let aside = (column as f64 + 0.5 - self.width as f64 / 2.0) / self.focal;
                let near = slope[0] * aside + slope[1] * up + slope[2];
                let pixel = row * self.width + column;
                let old = self.nearness[pixel];
                if near > old || (near == old && face < self.faces[pixel]) {
                    self.nearness[pixel] = near;
                    self.faces[pixel] = face;
                }
            }
        }
    }
}

/// The first of `n` pixels whose middle is not before `x`; `n` if there is none.
fn first_middle(x: f64, n: usize) -> usize {
    // The cast stops at 0 and at the largest number.
    ((x - 0.5).ceil() as usize).min(n)
}

/// Where a side of a polygon crosses a row of pixels, if it does.
fn where_row(p: [f64; 2], q: [f64; 2], y: f64) -> Option<f64> {
    let [top, bottom] = if p[1] <= q[1] { [p, q] } else { [q, p] };
    (top[1] <= y && y < bottom[1]).then(|| top[0] + (y - top[1]) / (bottom[1] - top[1]) * (bottom[0] - top[0]))
}

/// Where an edge comes near enough to be cut off.
fn where_near(p: Point3, q: Point3) -> Point3 {
    let [p, q] = if p[2] <= q[2] { [p, q] } else { [q, p] };
    let t = (NEAR - p[2]) / (q[2] - p[2]);
    [p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1]), NEAR]
}

fn unit(a: Point3) -> Point3 {
    let l = dot(a, a).sqrt();
    a.map(|x| x / l)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sightlines::scenes::{TowerOptions, tower};
    use sightlines_testkit::rays::RayScene;

    fn first_faces(scene: &Scene) -> Vec<u32> {
        let mut next = 0;
        let count = |o: &sightlines::cells::SceneObject| {
            next += o.triangles.len() as u32;
            next - o.triangles.len() as u32
        };
        scene.objects().iter().map(count).collect()
    }

    /// The picture shows what rays through the middles of the pixels hit first.
    #[test]
    fn pictures_agree_with_rays() {
        let options = TowerOptions { floors: 1, rooms_x: 2, rooms_y: 1, furniture: 2, ..TowerOptions::default() };
        let scene = tower(options).unwrap();
        let (rays, first) = (RayScene::new(&scene), first_faces(&scene));
        let (mut same, mut other) = (0, 0);
        for i in 0..6 {
            let eye = [1.03 + 0.7 * f64::from(i), 1.61, 2.07];
            let camera = Camera::new(eye, [1.3 - 0.9 * f64::from(i), -0.07, 0.61]);
            let mut picture = Picture::new(80, 60);
            let all = 0..scene.objects().len() as u32;
            picture.draw(&scene, &first, all, None, &camera);
            for (pixel, &face) in picture.faces.iter().enumerate() {
                let (column, row) = (pixel % 80, pixel / 80);
                let [x, y] = [column as f64 + 0.5 - 40.0, 30.0 - row as f64 - 0.5].map(|p| p / 40.0);
                let way = [0, 1, 2].map(|k| camera.ahead[k] + x * camera.right[k] + y * camera.up[k]);
                let hit = rays.first_hit(eye, way);
                let shown = hit.map_or(NOTHING, |h| first[h.object as usize] + h.triangle);
                *(if shown == face { &mut same } else { &mut other }) += 1;
            }
        }
        // Coplanar triangles and edges are the only places where the two may choose differently.
        assert!(other * 200 < same, "{other} of {} pixels differ", same + other);
    }

    /// Two triangles that share an edge leave no gap and no order, also where the eye is between them.
    #[test]
    fn edges_are_shared() {
        let corner = |x: f64, z: f64| [x, -1.0, z];
        let floor = sightlines::cells::SceneObject {
            name: String::new(),
            vertices: vec![corner(-500.0, -500.0), corner(500.0, -500.0), corner(500.0, 500.0), corner(-500.0, 500.0)],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
        };
        let scene = Scene::new(vec![floor]).unwrap();
        let mut picture = Picture::new(64, 64);
        picture.draw(&scene, &[0], [0], None, &Camera::new([0.1, 0.0, 0.2], [0.3, -3.0, 0.7]));
        assert!(picture.faces.iter().all(|f| *f != NOTHING));
        let mut seen: Vec<u32> = picture.faces.clone();
        seen.sort_unstable();
        seen.dedup();
        assert_eq!(seen, [0, 1]);
    }

    /// Leaving out objects outside the view changes no pixel, and leaves something out.
    #[test]
    fn views_leave_out_only_what_is_outside() {
        let options = TowerOptions { floors: 2, rooms_x: 2, rooms_y: 1, furniture: 1, ..TowerOptions::default() };
        let scene = tower(options).unwrap();
        let boxes: Vec<Aabb<3>> = scene.objects().iter().map(|o| o.bounds()).collect();
        let (first, n) = (first_faces(&scene), scene.objects().len() as u32);
        for i in 0..8 {
            let camera = Camera::new([3.1, 1.63, 2.2], [f64::from(i) - 3.6, 0.1, 1.1]);
            let [mut all, mut some] = [(); 2].map(|()| Picture::new(64, 48));
            let whole = all.draw(&scene, &first, 0..n, None, &camera);
            let part = some.draw(&scene, &first, 0..n, Some(&boxes), &camera);
            assert!(all.faces == some.faces && part.n_triangles < whole.n_triangles);
        }
    }
}
