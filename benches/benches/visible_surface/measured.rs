//! What is measured of each method on each scene.

use crate::families::{Case, Family, camera};
use sightlines::visible_surface::{
    BspOptions, Counters, DepthFormat, FaceBsp, FaceMask, Faces, Image, Newell, Painter, RayCaster, RenderInput,
    Schumacker, SchumackerOptions, VisibleSurface, ZBuffer, compare,
};
use sightlines_benches::csv_row;
use std::collections::BTreeMap;
use std::time::Instant;

csv_row! {
    /// One method on one scene.
    #[derive(Debug, Clone, PartialEq)]
    pub(crate) struct Row {
        pub(crate) family: String,
        pub(crate) faces: u64,
        pub(crate) method: String,
        /// Whether it promises to show what is seen.
        pub(crate) is_exact: bool,
        /// Seconds for what does not depend on the eye.
        pub(crate) prepare_s: f64,
        /// Seconds for a picture.
        pub(crate) draw_s: f64,
        /// Pixels that show another face than the ray caster, ties left out.
        pub(crate) wrong: u64,
        pub(crate) ties: u64,
        pub(crate) covered: u64,
        /// Pieces that faces were split into, which includes those that were not.
        pub(crate) pieces: u64,
        pub(crate) written: u64,
        /// Decisions that doubles could not make.
        pub(crate) exact: u64,
    }
}

/// Which methods have become too slow for a family.
#[derive(Debug)]
pub(crate) struct Limits {
    seconds: f64,
    /// For each method faces and seconds of the last scene.
    last: BTreeMap<String, (f64, f64)>,
}

impl Limits {
    pub(crate) fn new(seconds: f64) -> Self {
        Self { seconds, last: BTreeMap::new() }
    }

    /// Whether a method is expected to end in time: it is taken to grow with the square.
    fn allow(&self, method: &str, faces: f64) -> bool {
        self.last.get(method).is_none_or(|(n, s)| s * (faces / n).max(1.0).powi(2) < self.seconds)
    }
}

/// A method that is ready to draw, or how it is made ready.
type Make = Box<dyn Fn(&Faces) -> Box<dyn VisibleSurface>>;

fn methods() -> Vec<(&'static str, bool, Make)> {
    let z = |format: DepthFormat| -> Make { Box::new(move |_| Box::new(ZBuffer::new(format))) };
    vec![
        ("painter", false, Box::new(|_| Box::new(Painter))),
        ("newell", true, Box::new(|_| Box::new(Newell))),
        ("schumacker", true, Box::new(|f| Box::new(Schumacker::build(f, &SchumackerOptions::default())))),
        ("bsp", true, Box::new(|f| Box::new(FaceBsp::build(f, &BspOptions::default())))),
        ("bsp-front", true, Box::new(|f| Box::new(FaceBsp::build(f, &BspOptions::default()).front_to_back()))),
        ("zbuffer", true, z(DepthFormat::Exact)),
        ("zbuffer-f32", false, z(DepthFormat::F32)),
        ("zbuffer-f32-reversed", false, z(DepthFormat::F32Reversed)),
        ("zbuffer-u24", false, z(DepthFormat::U24)),
    ]
}

fn timed<T>(f: impl FnOnce() -> T) -> (T, f64) {
    let start = Instant::now();
    let out = f();
    (out, start.elapsed().as_secs_f64())
}

/// All methods on one scene, the ray caster last.
pub(crate) fn all(family: Family, case: &Case, size: [u32; 2], limits: &mut Limits) -> Vec<Row> {
    let faces = Faces::of_scene(&case.scene).expect("scenes are not that large");
    let camera = camera(case, size);
    let chosen = FaceMask::all(&faces);
    let shot = RenderInput { faces: &faces, camera: &camera, mask: &chosen };
    let family = case.name.clone().unwrap_or_else(|| family.name().to_owned());
    let n = faces.len() as f64;
    let (caster, prepare) = timed(|| RayCaster::build(&faces));
    let ((reference, counters), draw) = timed(|| caster.picture(&shot));
    let row = |method: &str, is_exact: bool, times: [f64; 2], image: &Image, counters: &Counters| {
        let found = compare(&shot, &reference, image);
        Row {
            family: family.clone(),
            faces: faces.len() as u64,
            method: method.to_owned(),
            is_exact,
            prepare_s: times[0],
            draw_s: times[1],
            wrong: found.wrong.len() as u64,
            ties: found.ties,
            covered: counters.covered,
            pieces: counters.fragments,
            written: counters.written,
            exact: counters.exact,
        }
    };
    let mut rows = Vec::new();
    for (name, is_exact, make) in methods() {
        if !limits.allow(name, n) {
            eprintln!("{family}, {n} faces: {name} is left out, it would take more than {} s", limits.seconds);
            continue;
        }
        let (method, prepare) = timed(|| make(&faces));
        let ((image, counters), draw) = timed(|| method.picture(&shot));
        limits.last.insert(name.to_owned(), (n, prepare + draw));
        eprintln!("{family}, {n} faces: {name} {prepare:.3} + {draw:.3} s");
        rows.push(row(name, is_exact, [prepare, draw], &image, &counters));
    }
    rows.push(row("raycast", true, [prepare, draw], &reference, &counters));
    rows
}

pub(crate) fn print(rows: &[Row]) {
    println!(
        "| scene | faces | method | prepare, ms | draw, ms | wrong | ties | covered | pieces | overdraw | exact |"
    );
    println!("| --- | --: | --- | --: | --: | --: | --: | --: | --: | --: | --: |");
    for r in rows {
        println!(
            "| {} | {} | {} | {:.1} | {:.1} | {} | {} | {} | {} | {:.2} | {} |",
            r.family,
            r.faces,
            r.method,
            r.prepare_s * 1e3,
            r.draw_s * 1e3,
            r.wrong,
            r.ties,
            r.covered,
            r.pieces,
            r.written as f64 / r.covered.max(1) as f64,
            r.exact
        );
    }
}
