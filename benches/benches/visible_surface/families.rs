//! Families of scenes, and where they are looked at from.

use sightlines::cells::Scene;
use sightlines::formats::scene::{BackFaces, SceneReadOptions, read_scene_with};
use sightlines::scenes::surfaces::{self, SurfaceOptions};
use sightlines::visible_surface::Camera;
use std::path::Path;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Family {
    Soup,
    Cycles,
    Lattice,
    SplitWorst,
    Coplanar,
    Slivers,
    Interleaved,
    Real,
}

/// A scene and where it is looked at from.
#[derive(Debug)]
pub(crate) struct Case {
    /// Of a real scene.
    pub(crate) name: Option<String>,
    pub(crate) scene: Scene,
}

/// Scenes of the data folder, small ones first.
const REAL: [&str; 8] = ["whale_tall", "duplex", "whale_large", "delft", "office_a", "pandora", "sponza", "castle"];

impl Family {
    pub(crate) const ALL: [Self; 8] = [
        Self::Soup,
        Self::Cycles,
        Self::Lattice,
        Self::SplitWorst,
        Self::Coplanar,
        Self::Slivers,
        Self::Interleaved,
        Self::Real,
    ];

    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Soup => "soup",
            Self::Cycles => "cycles",
            Self::Lattice => "lattice",
            Self::SplitWorst => "split_worst",
            Self::Coplanar => "coplanar",
            Self::Slivers => "slivers",
            Self::Interleaved => "interleaved",
            Self::Real => "real",
        }
    }

    pub(crate) fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|f| f.name() == name)
    }

    /// A scene for each size that the family has.
    pub(crate) fn scenes(self, sizes: &[u32]) -> Vec<Case> {
        if self == Self::Real {
            return real();
        }
        let quadratic = matches!(self, Self::Lattice | Self::SplitWorst);
        let sizes = sizes.iter().filter(|&&n| !quadratic || n <= 10_000);
        sizes.map(|&n| Case { name: None, scene: self.made(n) }).collect()
    }

    fn made(self, n: u32) -> Scene {
        let options = SurfaceOptions { triangles: n, ..SurfaceOptions::default() };
        let made = match self {
            Self::Soup => surfaces::soup(options),
            Self::Cycles => surfaces::cycles(n),
            Self::Lattice => surfaces::lattice(n),
            Self::SplitWorst => surfaces::split_worst(n),
            Self::Coplanar => surfaces::coplanar(options),
            Self::Slivers => surfaces::slivers(options),
            Self::Interleaved => surfaces::interleaved(n),
            Self::Real => unreachable!("real scenes are read"),
        };
        made.expect("sizes are in range")
    }
}

fn real() -> Vec<Case> {
    let Some(data) = std::env::var_os("SIGHTLINES_DATA") else {
        eprintln!("!! SIGHTLINES_DATA is not set: real scenes are left out");
        return Vec::new();
    };
    let read = |name: &str| {
        let file = Path::new(&data).join("scenes").join(name).join(format!("{name}.glb"));
        Case {
            name: Some(name.to_owned()),
            scene: read_scene_with(file, &SceneReadOptions::with_backs(BackFaces::Drawn))
                .expect("the scene can be read")
                .scene,
        }
    };
    REAL.map(read).into()
}

/// Generated scenes are made to be seen from one place; real ones are seen from inside, an eye at a third.
pub(crate) fn camera(case: &Case, size: [u32; 2]) -> Camera {
    if case.name.is_none() {
        return Camera::look_at(surfaces::EYE, surfaces::AT, surfaces::UP, surfaces::ANGLE, size)
            .expect("generated scenes have an eye");
    }
    let b = case.scene.bounds();
    let at = |part: [f64; 3]| [0, 1, 2].map(|k| b.min[k] + part[k] * (b.max[k] - b.min[k]));
    Camera::look_at(at([0.31, 0.37, 0.43]), at([0.83, 0.29, 0.71]), [0.0, 1.0, 0.0], 70.0, size)
        .expect("a scene has a size")
}
