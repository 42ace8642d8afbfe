//! What one eye sees: does a pixel show the face that is nearest there?
//!
//! A case is a pixel. It is open if its ray meets a face; who shows another one there, or nothing, hides what is seen. The truth is
//! brute force in whole numbers (`truth`); pixels whose rays meet an edge, or two faces at one depth, are no cases. Before anything
//! is drawn, culling may hide as well (`cull`); there a case is a face.

mod cull;
mod naive;
mod scene;
#[cfg(test)]
mod tests;
mod truth;

use super::predicates::cases::Apart;
use super::predicates::powers_of_ten;
use super::sweep::caught;
use super::{Answer, Board, Kind, Outcome, Sweep, SweepMethod};
use naive::Ordered;
use scene::{PIXELS, Setting, View};
use sightlines::geometry::Random;
use sightlines::visible_surface::{
    BspOptions, DepthFormat, FaceBsp, FaceMask, NOTHING, Newell, Painter, RayCaster, RenderInput, Schumacker,
    SchumackerOptions, VisibleSurface, ZBuffer,
};
use std::fmt::Debug;

/// What each pixel shows, row by row.
type Draw = fn(&View) -> Vec<u32>;

fn drawn(view: &View, method: &dyn VisibleSurface) -> Vec<u32> {
    let chosen = FaceMask::all(&view.faces);
    let shot = RenderInput { faces: &view.faces, camera: &view.camera, mask: &chosen };
    method.picture(&shot).0.faces().to_vec()
}

const fn method(name: &'static str, kind: Kind) -> SweepMethod {
    SweepMethod { name, kind }
}

/// What naive programs take for "on the plane".
const EPSILON: f64 = 1e-6;

const METHODS: [(SweepMethod, Draw); 16] = [
    (method("newell", Kind::Shipped), |v| drawn(v, &Newell)),
    (method("schumacker", Kind::Shipped), |v| drawn(v, &Schumacker::build(&v.faces, &SchumackerOptions::default()))),
    (method("bsp", Kind::Shipped), |v| drawn(v, &FaceBsp::build(&v.faces, &BspOptions::default()))),
    (method("zbuffer", Kind::Shipped), |v| drawn(v, &ZBuffer::new(DepthFormat::Exact))),
    (method("raycast", Kind::Reference), |v| drawn(v, &RayCaster::build(&v.faces))),
    (method("painter", Kind::Naive), |v| drawn(v, &Painter)),
    (method("zbuffer double", Kind::Naive), |v| drawn(v, &ZBuffer::new(DepthFormat::Double))),
    (method("zbuffer f32", Kind::Naive), |v| drawn(v, &ZBuffer::new(DepthFormat::F32))),
    (method("zbuffer f32 reversed", Kind::Naive), |v| drawn(v, &ZBuffer::new(DepthFormat::F32Reversed))),
    (method("zbuffer 24 bit", Kind::Naive), |v| drawn(v, &ZBuffer::new(DepthFormat::U24))),
    (method("zbuffer 16 bit", Kind::Naive), |v| naive::z16(&v.faces, &v.camera)),
    (method("bsp f64", Kind::Naive), |v| Ordered::<f64>::bsp(0.0).picture(&v.faces, &v.camera)),
    (method("bsp f64 epsilon", Kind::Naive), |v| Ordered::<f64>::bsp(EPSILON).picture(&v.faces, &v.camera)),
    (method("bsp f32", Kind::Naive), |v| Ordered::<f32>::bsp(0.0).picture(&v.faces, &v.camera)),
    (method("newell f64", Kind::Naive), |v| Ordered::<f64>::newell(0.0).picture(&v.faces, &v.camera)),
    (method("newell f64 epsilon", Kind::Naive), |v| Ordered::<f64>::newell(EPSILON).picture(&v.faces, &v.camera)),
];

/// A pixel of a view.
#[derive(Debug)]
#[expect(dead_code, reason = "what is found is printed")]
struct Found<'a> {
    pixel: [u32; 2],
    shown: u32,
    nearest: u32,
    view: &'a View,
}

/// Counts all pixels of all methods' pictures.
fn ask(board: &mut Board, view: &View) {
    let truth = truth::picture(&view.faces, &view.camera);
    for (k, (_, draw)) in METHODS.iter().enumerate() {
        let mut picture = None;
        let answer = caught(|| {
            picture = Some(draw(view));
            Answer::Seen
        });
        let Some(picture) = picture.filter(|_| answer != Answer::Failed) else {
            board.count(k, false, Outcome::Error, view);
            continue;
        };
        for ((i, &shown), nearest) in (0u32..).zip(&picture).zip(&truth) {
            let Some(nearest) = *nearest else { continue };
            let outcome = match (shown == nearest, nearest == NOTHING) {
                (true, _) => Outcome::Right,
                (false, true) => Outcome::Loose,
                (false, false) => Outcome::Unsafe,
            };
            board.count(
                k,
                nearest != NOTHING,
                outcome,
                &Found { pixel: [i % PIXELS, i / PIXELS], shown, nearest, view },
            );
        }
    }
}

fn of_views(
    [name, about, parameter]: [&'static str; 3],
    levels: Vec<f64>,
    batches: usize,
    make: fn(f64, &mut Random) -> Option<View>,
) -> Sweep {
    let batch = move |level: f64, random: &mut Random, board: &mut Board| {
        if let Some(view) = (0..100).find_map(|_| make(level, random)) {
            ask(board, &view);
        }
    };
    let methods = METHODS.iter().map(|m| m.0).collect();
    Sweep { name, about, parameter, levels, batches, methods, batch: Box::new(batch) }
}

fn levels_of_two(low: i32, high: i32, step: usize) -> Vec<f64> {
    (low..=high).step_by(step).map(|e| 2f64.powi(e)).collect()
}

/// All sweeps of visible surfaces.
pub fn sweeps(quick: bool) -> Vec<Sweep> {
    let step = if quick { 3 } else { 1 };
    let batches = if quick { 16 } else { 100 };
    let mut out = vec![
        of_views(
            [
                "surface-separation",
                "Three triangles that overlap in the picture, parallel, each some units in the last place of its depth before the one behind, \
                 which has the lower id. A case is a pixel; the truth is brute force in whole numbers.",
                "apart (units in the last place)",
            ],
            levels_of_two(0, 48, 4 * step),
            batches,
            |level, random| scene::stacked(Setting { far: 0.3, scale: 1.0, apart: Apart::Ulps(level as i64) }, random),
        ),
        of_views(
            [
                "surface-distance",
                "The same a thousandth of a unit apart at depth 16, far from the origin with the eye.",
                "distance from the origin (units)",
            ],
            powers_of_ten(0, 9, step),
            batches,
            |level, random| scene::stacked(Setting { far: level, scale: 1.0, apart: Apart::Part(1e-3) }, random),
        ),
        of_views(
            ["surface-scale", "The same at the origin, of all sizes.", "size of a unit"],
            powers_of_ten(-6, 6, step),
            batches,
            |level, random| scene::stacked(Setting { far: 0.0, scale: level, apart: Apart::Part(1e-3) }, random),
        ),
        of_views(
            [
                "surface-depths",
                "The same a thousandth of the depth apart, at half of the farthest depth that the camera sees, for all nearest depths.",
                "farthest over nearest depth",
            ],
            powers_of_ten(1, 9, step),
            batches,
            scene::deep,
        ),
        of_views(
            [
                "surface-slivers",
                "Eight long triangles on one row and one column of pixels, through each other, of all widths.",
                "width over length",
            ],
            levels_of_two(-32, 0, 4 * step),
            batches,
            |level, random| scene::slivers(Setting { far: 3.0, scale: 1.0, apart: Apart::Ulps(0) }, level, random),
        ),
        of_views(
            [
                "surface-families",
                "Generated scenes that are hard for some method: triangles in any position, slivers, circles of three, long before short, \
                 lattices.",
                "triangles",
            ],
            vec![6.0, 12.0, 24.0],
            if quick { 16 } else { 100 },
            |level, random| scene::family(level as u32, random),
        ),
    ];
    out.extend(cull::sweeps(quick));
    out
}
