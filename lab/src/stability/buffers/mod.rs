//! Multifocal buffers: does a texel that is called blocked really see nothing of the volume?
//!
//! A case is a texel. It is open if some open set of lines from the volume reaches it, decided in whole numbers
//! (`truth`); and if it is blocked, but by something less high above the plane than is stored, for then what lies between
//! is called hidden. Exact heights are the reference backend's.
//!
//! Sheets of a mesh are tested with whole boxes, see `sheets`.

mod naive;
mod scene;
mod sheets;
#[cfg(test)]
mod tests;
mod truth;

use super::predicates::cases::{Apart, Place};
use super::predicates::powers_of_ten;
use super::shader_float;
use super::sweep::caught;
use super::{Answer, Board, Kind, Outcome, Sweep, SweepMethod};
use scene::{Gap, Scene, Sizes};
use sightlines::geometry::Random;
use sightlines::multifocal::mesh::{PatchOptions, patches};
use sightlines::multifocal::{Buffer, BufferJob, Measure, MultifocalBackend, Occluder};
use sightlines::multifocal_cpu::{Fast, Reference};
use std::fmt::Debug;

/// Fills the only buffer of a job.
type Fill = fn(&BufferJob<'_>) -> Buffer;

fn render(backend: &mut dyn MultifocalBackend, job: &BufferJob<'_>) -> Buffer {
    let mut out = Vec::new();
    backend.render(job, &mut out).expect("processors have no device to lose");
    out.swap_remove(0)
}

fn integers(job: &BufferJob<'_>) -> Buffer {
    render(&mut Fast::new(), job)
}

fn reference(job: &BufferJob<'_>) -> Buffer {
    render(&mut Reference, job)
}

/// What naive programs take for nothing.
const EPSILON: f64 = 1e-6;

const INTEGERS: (SweepMethod, Fill) = (SweepMethod { name: "buffer integers", kind: Kind::Shipped }, integers);
const REFERENCE: (SweepMethod, Fill) = (SweepMethod { name: "buffer reference", kind: Kind::Reference }, reference);
const FLOATS: (SweepMethod, Fill) = (SweepMethod { name: "buffer f32 margin", kind: Kind::Shipped }, |job| {
    shader_float::draw(job, &job.planes()[0], shader_float::MARGIN)
});
const NO_MARGIN: (SweepMethod, Fill) = (SweepMethod { name: "buffer f32 no margin", kind: Kind::Naive }, |job| {
    shader_float::draw(job, &job.planes()[0], 0.0)
});
const DOUBLES: (SweepMethod, Fill) =
    (SweepMethod { name: "buffer f64", kind: Kind::Naive }, |job| naive::doubles(job, &job.planes()[0], 0.0));
const EPSILONS: (SweepMethod, Fill) = (SweepMethod { name: "buffer f64 epsilon", kind: Kind::Naive }, |job| {
    naive::doubles(job, &job.planes()[0], EPSILON)
});
const NEAREST: (SweepMethod, Fill) = (SweepMethod { name: "buffer nearest heights", kind: Kind::Naive }, |job| {
    naive::nearest_heights(job, &job.planes()[0])
});
const CENTRES: (SweepMethod, Fill) =
    (SweepMethod { name: "buffer texel centres", kind: Kind::Naive }, |job| naive::centres(job, &job.planes()[0]));
const ONE_EYE: (SweepMethod, Fill) =
    (SweepMethod { name: "buffer one eye", kind: Kind::Naive }, |job| naive::one_eye(job, &job.planes()[0]));

/// The methods that run on all scenes.
const ALL: [(SweepMethod, Fill); 9] =
    [INTEGERS, FLOATS, REFERENCE, NO_MARGIN, DOUBLES, EPSILONS, NEAREST, CENTRES, ONE_EYE];

/// Counts all texels of a buffer. `hidden`: the truth; `exact`: the values that must not be exceeded, if they count.
fn compare(
    board: &mut Board,
    method: usize,
    case: &dyn Debug,
    filled: Option<&Buffer>,
    hidden: &[bool],
    exact: Option<&Buffer>,
) {
    let Some(filled) = filled else {
        board.count(method, false, Outcome::Error, case);
        return;
    };
    for (i, (&got, &hidden)) in filled.values().iter().zip(hidden).enumerate() {
        let is_too_high = hidden && exact.is_some_and(|exact| got > exact.values()[i]);
        let open = !hidden || is_too_high;
        let answer = if got > 0 { Answer::Hidden } else { Answer::Seen };
        let width = filled.texels()[0] as usize;
        board.count(method, open, Outcome::of(open, answer), &Found { texel: [i % width, i / width], got, case });
    }
}

/// A texel of a scene.
#[derive(Debug)]
#[expect(dead_code, reason = "what is found is printed")]
struct Found<'a> {
    texel: [usize; 2],
    got: u32,
    case: &'a dyn Debug,
}

/// What a method fills; nothing if it panics.
fn filled(fill: Fill, job: &BufferJob<'_>) -> Option<Buffer> {
    let mut out = None;
    let answer = caught(|| {
        out = Some(fill(job));
        Answer::Seen
    });
    out.filter(|_| answer != Answer::Failed)
}

/// Asks methods about a scene with one occluder.
fn ask(board: &mut Board, scene: &Scene, methods: &[(SweepMethod, Fill)], measure: Measure) {
    let job = scene.job(measure);
    let (hidden, exact) = (truth::hidden(scene), reference(&job));
    for (k, (_, fill)) in methods.iter().enumerate() {
        compare(board, k, scene, filled(*fill, &job).as_ref(), &hidden, Some(&exact));
    }
}

const SIZES: Sizes = Sizes { volume: [1.0, 0.8, 0.6], window: [8.0, 8.0], texels: [16, 16], slope: 0.0 };

fn levels_of_two(low: i32, high: i32, step: usize) -> Vec<f64> {
    (low..=high).step_by(step).map(|e| 2f64.powi(e)).collect()
}

/// A sweep of scenes that `make` draws at a level.
fn of_scenes(
    [name, about, parameter]: [&'static str; 3],
    levels: Vec<f64>,
    batches: usize,
    measure: Measure,
    make: fn(f64, &mut Random) -> Option<Scene>,
) -> Sweep {
    let methods: Vec<(SweepMethod, Fill)> = match measure {
        Measure::VertexHeight => ALL.to_vec(),
        _ => vec![INTEGERS, REFERENCE],
    };
    let names = methods.iter().map(|m| m.0).collect();
    let batch = move |level: f64, random: &mut Random, board: &mut Board| {
        if let Some(scene) = (0..100).find_map(|_| make(level, random)) {
            ask(board, &scene, &methods, measure);
        }
    };
    Sweep { name, about, parameter, levels, batches, methods: names, batch: Box::new(batch) }
}

/// All sweeps of buffers.
pub fn sweeps(quick: bool) -> Vec<Sweep> {
    let step = if quick { 3 } else { 1 };
    let batches = if quick { 12 } else { 60 };
    vec![
        of_scenes(
            [
                "buffer-distance",
                "One rectangle whose umbra ends on lines between texels, but for a ten-thousandth of the scene's unit, far from the \
                 origin. A case is a texel of 256; the truth is in whole numbers.",
                "distance from the origin (units)",
            ],
            powers_of_ten(0, 7, step),
            batches,
            Measure::VertexHeight,
            |level, random| scene::aligned(Place { far: level, scale: 1.0, apart: Apart::Part(1e-4) }, &SIZES, random),
        ),
        of_scenes(
            ["buffer-scale", "The same at the origin, of all sizes.", "size of a unit"],
            powers_of_ten(-6, 6, step),
            batches,
            Measure::VertexHeight,
            |level, random| scene::aligned(Place { far: 0.0, scale: level, apart: Apart::Part(1e-4) }, &SIZES, random),
        ),
        of_scenes(
            [
                "buffer-ulps",
                "The same near the origin, with each side of the rectangle some units in the last place from where the umbra \
                 would end on a line between texels.",
                "moved by (units in the last place)",
            ],
            levels_of_two(0, 40, 4 * step),
            batches,
            Measure::VertexHeight,
            |level, random| {
                let place = Place { far: 0.37, scale: 1.0, apart: Apart::Ulps(level as i64) };
                scene::aligned(place, &SIZES, random)
            },
        ),
        of_scenes(
            [
                "buffer-slope",
                "The same with a rectangle that is nearly parallel to the plane: higher on one side, by a slope.",
                "slope",
            ],
            levels_of_two(-44, -4, 4 * step),
            batches,
            Measure::VertexHeight,
            sloped,
        ),
        of_scenes(
            [
                "buffer-slope-sections",
                "The same, with the heights at which lines meet the rectangle in the place of its lowest corner.",
                "slope",
            ],
            levels_of_two(-44, -4, 4 * step),
            batches,
            Measure::SectionHeight,
            sloped,
        ),
        of_scenes(
            [
                "buffer-slivers",
                "The same, squeezed along one axis to a sliver, with volume and texels.",
                "width over length",
            ],
            levels_of_two(-20, 0, 2 * step),
            batches,
            Measure::VertexHeight,
            |level, random| {
                let sizes = Sizes { volume: [level, 0.8, 0.6], window: [8.0 * level, 8.0], ..SIZES };
                scene::aligned(Place { far: 3.0, scale: 1.0, apart: Apart::Ulps(4) }, &sizes, random)
            },
        ),
        resolutions(quick),
        gaps(quick),
        sheets::gaps(quick),
    ]
}

fn sloped(level: f64, random: &mut Random) -> Option<Scene> {
    let place = Place { far: 50.0, scale: 1.0, apart: Apart::Part(1e-4) };
    scene::aligned(place, &Sizes { slope: level, ..SIZES }, random)
}

/// The reference is the truth here: whole numbers are slow for so many texels.
fn resolutions(quick: bool) -> Sweep {
    let methods = [INTEGERS, FLOATS, NO_MARGIN, DOUBLES, NEAREST, CENTRES, ONE_EYE];
    let batch = move |level: f64, random: &mut Random, board: &mut Board| {
        let sizes = Sizes { texels: [level as u32; 2], ..SIZES };
        let place = Place { far: 0.37, scale: 1.0, apart: Apart::Ulps(4) };
        let Some(scene) = (0..100).find_map(|_| scene::aligned(place, &sizes, random)) else { return };
        let job = scene.job(Measure::VertexHeight);
        let exact = reference(&job);
        let hidden: Vec<bool> = exact.values().iter().map(|&v| v > 0).collect();
        for (k, (_, fill)) in methods.iter().enumerate() {
            compare(board, k, &scene, filled(*fill, &job).as_ref(), &hidden, Some(&exact));
        }
    };
    Sweep {
        name: "buffer-resolution",
        about: "The same in buffers of other sizes. The truth is the reference backend, with exact predicates for each texel.",
        parameter: "texels along a side",
        levels: levels_of_two(3, if quick { 6 } else { 9 }, 1),
        batches: if quick { 4 } else { 8 },
        methods: methods.iter().map(|m| m.0).collect(),
        batch: Box::new(batch),
    }
}

const PATCHES: SweepMethod = SweepMethod { name: "buffer patches", kind: Kind::Shipped };
const SNAPPED: SweepMethod = SweepMethod { name: "buffer patches snapped", kind: Kind::Naive };

/// What patches of triangles fill.
fn of_patches(scene: &Scene, triangles: &[[sightlines::geometry::Point3; 3]]) -> Buffer {
    let occluders: Vec<Occluder> = patches(triangles, &PatchOptions::default());
    integers(&Scene { occluders, ..scene.clone() }.job(Measure::VertexHeight))
}

fn gaps(quick: bool) -> Sweep {
    let batch = move |level: f64, random: &mut Random, board: &mut Board| {
        let place = Place { far: 3.0, scale: 1.0, apart: Apart::Ulps(0) };
        let Some(gap) = (0..100).find_map(|_| scene::gap(place, level as i64, &SIZES, random)) else { return };
        let Gap { scene, triangles, .. } = &gap;
        let hidden = truth::hidden_with_gap(&gap);
        let job = scene.job(Measure::VertexHeight);
        let answers = [
            Some(of_patches(scene, triangles)),
            filled(integers, &job),
            filled(FLOATS.1, &job),
            Some(of_patches(scene, &naive::snapped(triangles, EPSILON))),
        ];
        for (k, buffer) in answers.iter().enumerate() {
            compare(board, k, &gap, buffer.as_ref(), &hidden, None);
        }
    };
    Sweep {
        name: "buffer-gaps",
        about: "Two rectangles side by side, with a gap of some units in the last place between; with none they are one surface. The truth \
                is in whole numbers.",
        parameter: "gap (units in the last place)",
        levels: std::iter::once(0.0).chain(levels_of_two(0, 48, if quick { 12 } else { 4 })).collect(),
        batches: if quick { 8 } else { 50 },
        methods: vec![PATCHES, INTEGERS.0, FLOATS.0, SNAPPED],
        batch: Box::new(batch),
    }
}
