//! The classical methods by name, made ready for all pictures of a scene.

use crate::bsp::{BspOptions, FaceBsp};
use crate::faces::Faces;
use crate::method::VisibleSurface;
use crate::newell::Newell;
use crate::painter::Painter;
use crate::raycast::RayCaster;
use crate::schumacker::{Schumacker, SchumackerOptions};
use crate::zbuffer::{DepthFormat, ZBuffer};
use std::time::{Duration, Instant};

/// A classical method.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Technique {
    /// The painter's sort, by the depth of centres.
    Painter,
    /// That of Newell, Newell and Sancha.
    Newell,
    /// Schumacker's clusters.
    Schumacker,
    /// A BSP tree, back to front.
    Bsp,
    /// A BSP tree, front to back.
    BspFront,
    /// The z-buffer.
    Zbuffer,
    /// The ray caster.
    Raycast,
}

impl Technique {
    /// All of them, with their names and a line for help texts.
    const TABLE: [(Self, &'static str, &'static str); 7] = [
        (Self::Painter, "painter", "Faces sorted by the depth of their centres; wrong where that order is wrong"),
        (
            Self::Newell,
            "newell",
            "Newell, Newell and Sancha: faces sorted by depth, tested against each other, and split at cycles",
        ),
        (
            Self::Schumacker,
            "schumacker",
            "Schumacker: clusters of faces separated by planes, each with a fixed order of faces",
        ),
        (Self::Bsp, "bsp", "A BSP tree, drawn back to front"),
        (Self::BspFront, "bsp-front", "A BSP tree, drawn front to back"),
        (Self::Zbuffer, "zbuffer", "Z-buffer: each pixel keeps the nearest face"),
        (Self::Raycast, "raycast", "One ray through each pixel; the reference for all others"),
    ];

    /// All of them.
    pub const ALL: [Self; 7] = {
        let mut all = [Self::Painter; 7];
        let mut k = 0;
        while k < all.len() {
            all[k] = Self::TABLE[k].0;
            k += 1;
        }
        all
    };

    /// Lower-case name for options.
    pub const fn name(self) -> &'static str {
        Self::TABLE[self as usize].1
    }

    /// A line for help texts.
    pub const fn about(self) -> &'static str {
        Self::TABLE[self as usize].2
    }
}

/// A method that is ready to draw, and what that took.
#[derive(Debug)]
pub struct PreparedMethod {
    /// The method.
    pub method: Box<dyn VisibleSurface>,
    /// The time, independent of the eye.
    pub time: Duration,
    /// Splits of faces and their pieces.
    pub splits: u64,
}

/// Makes methods ready for the same faces, one after the other; a tree that serves two of them is built once.
#[derive(Debug)]
pub struct Preparer<'a> {
    faces: &'a Faces,
    tree: Option<(FaceBsp, Duration)>,
}

impl<'a> Preparer<'a> {
    /// For a scene.
    pub const fn new(faces: &'a Faces) -> Self {
        Self { faces, tree: None }
    }

    /// Makes a method ready.
    ///
    /// * `depth`: what a z-buffer keeps
    pub fn prepare(&mut self, technique: Technique, depth: DepthFormat) -> PreparedMethod {
        let (start, faces) = (Instant::now(), self.faces);
        let (method, splits): (Box<dyn VisibleSurface>, u64) = match technique {
            Technique::Painter => (Box::new(Painter), 0),
            Technique::Newell => (Box::new(Newell), 0),
            Technique::Schumacker => {
                let clusters = Schumacker::build(faces, &SchumackerOptions::default());
                let splits = clusters.stats().splits;
                (Box::new(clusters), splits)
            }
            Technique::Zbuffer => (Box::new(ZBuffer::new(depth)), 0),
            Technique::Raycast => (Box::new(RayCaster::build(faces)), 0),
            Technique::Bsp | Technique::BspFront => {
                let built = || {
                    let tree = FaceBsp::build(faces, &BspOptions::default());
                    (tree, start.elapsed())
                };
                let (tree, time) = self.tree.get_or_insert_with(built).clone();
                let splits = tree.stats().splits;
                let tree = if technique == Technique::BspFront { tree.front_to_back() } else { tree };
                return PreparedMethod { method: Box::new(tree), time, splits };
            }
        };
        PreparedMethod { method, time: start.elapsed(), splits }
    }
}
