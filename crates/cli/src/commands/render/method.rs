//! The methods as arguments, made ready and timed.

use sightlines::visible_surface::{
    Bsp, BspOptions, Counters, DepthFormat, Faces, Image, Newell, Painter, RayCaster, RenderInput, Schumacker,
    SchumackerOptions, VisibleSurface, ZBuffer,
};
use std::time::{Duration, Instant};

/// A method as an argument.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum Kind {
    /// Faces sorted by the depth of their centres; wrong where that order is wrong
    Painter,
    /// Newell, Newell and Sancha: faces sorted by depth, tested against each other, and split at cycles
    Newell,
    /// Schumacker: clusters of faces separated by planes, each with a fixed order of faces
    Schumacker,
    /// A BSP tree, drawn back to front
    Bsp,
    /// A BSP tree, drawn front to back
    BspFront,
    /// Z-buffer: each pixel keeps the nearest face
    Zbuffer,
    /// One ray through each pixel; the reference for all others
    Raycast,
}

/// A method that is ready to draw.
#[derive(Debug)]
pub(super) struct Ready {
    method: Box<dyn VisibleSurface>,
    prepared: Prepared,
}

/// What it took to make a method ready for all pictures of a scene.
#[derive(Debug, Clone, Copy)]
pub(super) struct Prepared {
    pub(super) time: Duration,
    /// Splits of faces and their pieces.
    pub(super) splits: u64,
}

/// What a method drew.
#[derive(Debug)]
pub(super) struct Drawn {
    pub(super) method: &'static str,
    pub(super) image: Image,
    pub(super) counters: Counters,
    pub(super) prepared: Prepared,
    pub(super) time: Duration,
}

impl Ready {
    /// Makes a method ready.
    pub(super) fn new(kind: Kind, depth: DepthFormat, faces: &Faces) -> Self {
        let start = Instant::now();
        let (method, splits): (Box<dyn VisibleSurface>, u64) = match kind {
            Kind::Painter => (Box::new(Painter), 0),
            Kind::Newell => (Box::new(Newell), 0),
            Kind::Schumacker => {
                let clusters = Schumacker::build(faces, &SchumackerOptions::default());
                let splits = clusters.stats().splits;
                (Box::new(clusters), splits)
            }
            Kind::Bsp | Kind::BspFront => {
                let tree = Bsp::build(faces, &BspOptions::default());
                return Self::walking(kind, tree, start.elapsed());
            }
            Kind::Zbuffer => (Box::new(ZBuffer::new(depth)), 0),
            Kind::Raycast => (Box::new(RayCaster::build(faces)), 0),
        };
        let prepared = Prepared { time: start.elapsed(), splits };
        Self { method, prepared }
    }

    /// A tree that took so long to build, walked in the order of a method.
    fn walking(kind: Kind, tree: Bsp, time: Duration) -> Self {
        let prepared = Prepared { time, splits: tree.stats().splits };
        let tree = if kind == Kind::BspFront { tree.front_to_back() } else { tree };
        Self { method: Box::new(tree), prepared }
    }

    /// Draws a picture.
    pub(super) fn draw(&self, shot: &RenderInput<'_>) -> Drawn {
        let start = Instant::now();
        let (image, counters) = self.method.picture(shot);
        Drawn { method: self.method.name(), image, counters, prepared: self.prepared, time: start.elapsed() }
    }
}

/// Makes methods ready one after the other; a tree that serves two of them is built once.
#[derive(Debug, Default)]
pub(super) struct Readied {
    tree: Option<(Bsp, Duration)>,
}

impl Readied {
    /// Makes a method ready.
    pub(super) fn next(&mut self, kind: Kind, depth: DepthFormat, faces: &Faces) -> Ready {
        if !matches!(kind, Kind::Bsp | Kind::BspFront) {
            return Ready::new(kind, depth, faces);
        }
        let (tree, time) = self.tree.get_or_insert_with(|| {
            let start = Instant::now();
            let tree = Bsp::build(faces, &BspOptions::default());
            (tree, start.elapsed())
        });
        Ready::walking(kind, tree.clone(), *time)
    }
}

/// The methods that are compared, each with what a z-buffer keeps: those of `kinds` and the ray caster, or all if there are
/// none; z-buffers of all formats unless one is named.
pub(super) fn compared(kinds: &[Kind], depth: Option<DepthFormat>) -> Vec<(Kind, DepthFormat)> {
    let kinds = if kinds.is_empty() { <Kind as clap::ValueEnum>::value_variants() } else { kinds };
    let mut all = Vec::new();
    for &kind in kinds {
        match (kind, depth) {
            (Kind::Zbuffer, None) => all.extend(DepthFormat::ALL.map(|format| (kind, format))),
            _ => all.push((kind, depth.unwrap_or_default())),
        }
    }
    if !kinds.contains(&Kind::Raycast) {
        all.push((Kind::Raycast, DepthFormat::Exact));
    }
    all
}
