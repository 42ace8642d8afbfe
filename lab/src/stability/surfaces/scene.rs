//! Pictures that are hard to draw: faces close behind each other, thin ones, and the families of the generators.

use crate::stability::predicates::cases::Apart;
use sightlines::geometry::{Point3, Random};
use sightlines::scenes::surfaces;
use sightlines::visible_surface::{Camera, Faces};

/// What is drawn, printable.
#[derive(Debug, Clone)]
pub(super) struct View {
    pub(super) faces: Faces,
    pub(super) camera: Camera,
}

/// Where a scene is, how large, and how far apart its faces are.
#[derive(Debug, Clone, Copy)]
pub(super) struct Setting {
    /// Of the eye from the origin, in units of `scale`.
    pub(super) far: f64,
    pub(super) scale: f64,
    /// Of a face from the one behind.
    pub(super) apart: Apart,
}

/// Pixels along a side.
pub(super) const PIXELS: u32 = 24;

/// Depth around which all is, in units.
const DEPTH: f64 = 16.0;

impl Setting {
    fn put(&self, p: Point3) -> Point3 {
        let away = [self.far, -0.71 * self.far, 0.43 * self.far];
        std::array::from_fn(|k| (p[k] + away[k]) * self.scale)
    }

    fn camera(&self) -> Camera {
        let [eye, at] = [[0.0; 3], [0.03, -0.02, 1.0]].map(|p| self.put(p));
        // The direction is that of the axis, however far away the eye is.
        let at =
            std::array::from_fn(|k| if at[k] == eye[k] { at[k] } else { eye[k] + [0.03, -0.02, 1.0][k] * self.scale });
        Camera::look_at(eye, at, [0.0, 1.0, 0.0], 60.0, [PIXELS; 2]).expect("it looks ahead")
    }

    /// A point moved towards the eye.
    fn nearer(&self, p: Point3) -> Point3 {
        match self.apart {
            Apart::Part(part) => [p[0], p[1], p[2] - part * self.scale],
            Apart::Ulps(n) => {
                let steps = if p[2] > 0.0 { -n } else { n };
                [p[0], p[1], f64::from_bits(p[2].to_bits().wrapping_add_signed(steps))]
            }
        }
    }
}

/// A triangle across some part of the picture, in a plane given by its depth and slopes.
fn triangle(random: &mut Random, depth: impl Fn(f64, f64) -> f64) -> [Point3; 3] {
    const ROUND: [[f64; 2]; 3] = [[-6.0, -5.0], [6.0, -4.0], [0.0, 6.0]];
    let turned = random.below(2) == 0;
    ROUND.map(|[x, y]| {
        let [x, y] = if turned { [-x, -y] } else { [x, y] };
        let (x, y) = (x + 3.0 * random.unit(), y + 3.0 * random.unit());
        [x, y, depth(x, y)]
    })
}

/// Three triangles that overlap in the picture, nearly in one plane, each a step nearer than the one before.
pub(super) fn stacked(setting: Setting, random: &mut Random) -> Option<View> {
    let slopes = [random.unit() - 0.5, random.unit() - 0.5];
    let depth = |x: f64, y: f64| DEPTH + slopes[0] * x + slopes[1] * y;
    let mut corners = Vec::new();
    for layer in 0..3 {
        corners.push(triangle(random, depth).map(|p| (0..layer).fold(setting.put(p), |p, _| setting.nearer(p))));
    }
    // What is in front has the higher id, so that who cannot tell shows the wrong one.
    Some(View { faces: Faces::new(corners).ok()?, camera: setting.camera() })
}

/// Long triangles of a given width over length, along few rows and columns of pixels, whose centres they hold, through each other.
pub(super) fn slivers(setting: Setting, width: f64, random: &mut Random) -> Option<View> {
    let camera = setting.camera();
    let eye = camera.eye();
    let side = f64::from(PIXELS);
    let lines = [0; 2].map(|_| 8.5 + random.below(8) as f64);
    let corners: Vec<[Point3; 3]> = (0..8)
        .map(|_| {
            let k = random.below(2);
            // Half of them lie wholly below the middle of the pixels but for their tip.
            let off = side * width * (0.5 + random.unit());
            let mut at = |along: f64, off: f64| -> Point3 {
                let [x, y] = if k == 0 { [along, lines[0] + off] } else { [lines[1] + off, along] };
                let (ray, depth) = (camera.ray(x, y), (DEPTH + 8.0 * random.unit() - 4.0) * setting.scale);
                std::array::from_fn(|i| eye[i] + ray[i] * depth)
            };
            [at(-1.0, -off), at(side + 1.0, -off), at(side / 2.0, off)]
        })
        .collect();
    Some(View { faces: Faces::new(corners).ok()?, camera })
}

/// One of the families that are hard for some method: in any position, passing through each other, in circles, in lattices.
pub(super) fn family(triangles: u32, random: &mut Random) -> Option<View> {
    let options = surfaces::SurfaceOptions { seed: random.bits(), triangles, layers: 3 };
    let scene = match random.below(5) {
        0 => surfaces::soup(options),
        1 => surfaces::slivers(options),
        2 => surfaces::cycles(triangles),
        3 => surfaces::interleaved(triangles),
        _ => surfaces::lattice(triangles),
    };
    let camera = Camera::look_at(surfaces::EYE, surfaces::AT, surfaces::UP, surfaces::ANGLE, [PIXELS; 2]).ok()?;
    Some(View { faces: Faces::of_scene(&scene.ok()?).ok()?, camera })
}

/// Stacked triangles at seven tenths of the farthest depth, a thousandth of their depth apart, seen from a nearest depth that is smaller by
/// a ratio.
pub(super) fn deep(ratio: f64, random: &mut Random) -> Option<View> {
    let view = stacked(Setting { far: 0.0, scale: 1.0, apart: Apart::Part(DEPTH * 1e-3) }, random)?;
    let far = 2.0 * DEPTH;
    Some(View { camera: view.camera.with_depths(far / ratio, far).ok()?, ..view })
}
