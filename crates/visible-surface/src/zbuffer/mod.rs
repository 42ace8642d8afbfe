//! The z-buffer: each face is drawn, and each pixel keeps what is nearest.
//!
//! Depth is kept as one over the depth, which is linear in the picture. In [`DepthFormat::Exact`] a pixel also keeps how much that may be off, and
//! where two faces are too near to each other for doubles, the question is decided without rounding; so the picture is the ray
//! caster's. The other formats are what hardware keeps; they err where faces are near to each other, which is what they are
//! here to show. In all of them the pixels that a face covers are exact, and of two equal depths the lower id wins.
//!
//! Source: Catmull, "A Subdivision Algorithm for Computer Display of Curved Surfaces", 1974; one over the depth kept reversed in floats: Lapidous and Jiao,
//! "Optimal Depth Buffer for Low-Cost Graphics Hardware", Graphics Hardware 1999.

mod formats;

use crate::counters::Counters;
use crate::faces::NOTHING;
use crate::fragment::{Fragment, facing};
use crate::image::Image;
use crate::method::{RenderInput, RenderOutput, VisibleSurface};
use crate::nearness::{DepthComparator, Nearness};
use crate::rows::spans;
use crate::side::Side;
use crate::window::Window;
use formats::{Double, F32, F32Reversed, Format, U24};

/// What a z-buffer keeps for each pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum DepthFormat {
    /// One over the depth as a double, and its error: 16 bytes with the face. Never wrong.
    #[default]
    Exact,
    /// One over the depth as a double.
    Double,
    /// From 0 at the camera's nearest depth to 1 at its farthest, as a float.
    F32,
    /// From 1 at the camera's nearest depth to 0 at its farthest, as a float: floats are densest where depths are.
    F32Reversed,
    /// From 0 to 1, as a whole number of 24 bits.
    U24,
}

impl DepthFormat {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Exact, Self::Double, Self::F32, Self::F32Reversed, Self::U24];

    /// Lower-case name for options and charts.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Double => "double",
            Self::F32 => "f32",
            Self::F32Reversed => "f32-reversed",
            Self::U24 => "u24",
        }
    }

    /// A line for help texts: what is stored.
    pub const fn about(self) -> &'static str {
        match self {
            Self::Exact => "Doubles, with an exact decision where they are too close",
            Self::Double => "Doubles",
            Self::F32 => "Floats from 0 at the nearest depth (1/64 if that is 0) to 1 at the farthest",
            Self::F32Reversed => "Reversed floats, from 1 at the nearest depth to 0 at the farthest",
            Self::U24 => "24-bit integers, 0 at the nearest depth",
        }
    }
}

/// Draws all faces into a z-buffer.
#[derive(Debug, Clone, Copy, Default)]
pub struct ZBuffer {
    format: DepthFormat,
}

impl ZBuffer {
    /// A z-buffer that keeps depth in this form. The formats from 0 to 1 take nearest and farthest depth from the camera;
    /// where that sees from depth 0 on, they begin at 1/64, and what is nearer counts as at 1/64.
    pub const fn new(format: DepthFormat) -> Self {
        Self { format }
    }
}

impl VisibleSurface for ZBuffer {
    fn name(&self) -> &'static str {
        match self.format {
            DepthFormat::Exact => "zbuffer",
            DepthFormat::Double => "zbuffer-double",
            DepthFormat::F32 => "zbuffer-f32",
            DepthFormat::F32Reversed => "zbuffer-f32-reversed",
            DepthFormat::U24 => "zbuffer-u24",
        }
    }

    fn see(&self, input: &RenderInput<'_>, counters: &mut Counters) -> RenderOutput {
        let depths = input.camera.depths();
        RenderOutput::Picture(match self.format {
            DepthFormat::Exact => exact(input, counters),
            DepthFormat::Double => rounded(input, counters, Double),
            DepthFormat::F32 => rounded(input, counters, F32::new(depths)),
            DepthFormat::F32Reversed => rounded(input, counters, F32Reversed::new(depths)),
            DepthFormat::U24 => rounded(input, counters, U24::new(depths)),
        })
    }
}

/// A pixel of the exact form.
#[derive(Debug, Clone, Copy)]
struct Pixel {
    nearness: f64,
    /// How much that may be off, at least.
    error: f32,
    face: u32,
}

const EMPTY: Pixel = Pixel { nearness: f64::NEG_INFINITY, error: 0.0, face: NOTHING };

fn exact(input: &RenderInput<'_>, counters: &mut Counters) -> Image {
    let RenderInput { camera, faces, .. } = *input;
    let [width, height] = camera.size();
    let mut pixels = vec![EMPTY; width as usize * height as usize];
    let mut comparator = DepthComparator::default();
    let (mut n_tests, mut n_written) = (0, 0);
    draw(input, counters, |face, plane, y, from, to| {
        // Rounded up to a float.
        let error = if plane.error > 1e-30 { plane.error as f32 * (1.0 + 2.0 * f32::EPSILON) } else { 1e-29 };
        let own = f64::from(error);
        let row = y as usize * width as usize;
        let base = plane.b * (f64::from(y) + 0.5) + plane.c;
        for (x, pixel) in (from..to).zip(&mut pixels[row + from as usize..row + to as usize]) {
            let nearness = plane.a * (f64::from(x) + 0.5) + base;
            let doubt = own + f64::from(pixel.error);
            let wins = if nearness > pixel.nearness + doubt {
                true
            } else if nearness < pixel.nearness - doubt {
                false
            } else {
                pixel.face == NOTHING || comparator.is_nearer(camera, faces, face, pixel.face, x, y)
            };
            if wins {
                *pixel = Pixel { nearness, error, face };
                n_written += 1;
            }
        }
        n_tests += u64::from(to - from);
    });
    counters.written += n_written;
    counters.exact += comparator.n_exact;
    counters.tested("depth", n_tests);
    let mut image = Image::new(camera.size());
    image.faces_mut().iter_mut().zip(&pixels).for_each(|(to, pixel)| *to = pixel.face);
    image
}

fn rounded<F: Format>(input: &RenderInput<'_>, counters: &mut Counters, format: F) -> Image {
    let [width, height] = input.camera.size();
    let mut depths = vec![F::FARTHEST; width as usize * height as usize];
    let mut image = Image::new(input.camera.size());
    let (mut n_tests, mut n_written) = (0, 0);
    draw(input, counters, |face, plane, y, from, to| {
        let row = y as usize * width as usize;
        let row = row + from as usize..row + to as usize;
        let base = plane.b * (f64::from(y) + 0.5) + plane.c;
        let pixels = depths[row.clone()].iter_mut().zip(&mut image.faces_mut()[row]);
        for (x, (depth, shown)) in (from..to).zip(pixels) {
            let new = format.depth(plane.a * (f64::from(x) + 0.5) + base);
            if F::is_nearer(new, *depth) || (new == *depth && face < *shown) {
                (*depth, *shown) = (new, face);
                n_written += 1;
            }
        }
        n_tests += u64::from(to - from);
    });
    counters.written += n_written;
    counters.tested("depth", n_tests);
    image
}

/// Calls `span(face, plane, y, from, to)` for each row of pixels that a chosen face covers.
fn draw(input: &RenderInput<'_>, counters: &mut Counters, mut span: impl FnMut(u32, &Nearness, u32, u32, u32)) {
    let RenderInput { camera, faces, mask: chosen } = *input;
    let plain = camera.depths() == [0.0, f64::INFINITY];
    for face in chosen.iter() {
        counters.polygons += 1;
        let window = Window::of_triangle(camera, faces.of(face));
        if window.is_empty() {
            continue;
        }
        let Some(sign) = facing(camera, faces, face) else { continue };
        counters.fragments += 1;
        let plane = Nearness::of(camera, faces, face);
        let each = |y: u32, from: u32, to: u32| span(face, &plane, y, from, to);
        counters.exact += if plain {
            let [p, q, r] = *faces.of(face);
            let sides = [(p, q), (q, r), (r, p)].map(|(a, b)| Side::edge(camera, a, b).times(sign));
            spans(camera, faces, &sides, window, each)
        } else {
            spans(camera, faces, &Fragment::whole(face).sides(camera, faces), window, each)
        };
    }
}
