//! What to classify, and how finely.

use sightlines_geometry::{Point3, orient3d};

/// A side of a face.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Side {
    /// From which the corners go round counter-clockwise.
    Front,
    /// The other one.
    Back,
}

impl Side {
    /// The corners of a face, so turned that this side is their front.
    pub fn turned(self, [a, b, c]: [Point3; 3]) -> [Point3; 3] {
        match self {
            Self::Front => [a, b, c],
            Self::Back => [a, c, b],
        }
    }

    /// The side of a face that a point is on; none if it lies on the face's plane. Exact.
    pub fn towards([a, b, c]: [Point3; 3], p: Point3) -> Option<Self> {
        match orient3d(a, b, c, p) {
            s if s > 0.0 => Some(Self::Front),
            s if s < 0.0 => Some(Self::Back),
            _ => None,
        }
    }
}

/// Which sides of faces are classified.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Sides {
    /// Fronts: enough for closed surfaces that face outwards.
    Front,
    /// Backs.
    Back,
    /// Both, each for itself.
    #[default]
    Both,
    /// The side that an eye sees. Faces whose plane it lies on have none.
    Towards(Point3),
}

impl Sides {
    /// The sides of a face.
    pub(crate) fn of(self, corners: [Point3; 3]) -> impl Iterator<Item = Side> {
        let sides = match self {
            Self::Front => [Some(Side::Front), None],
            Self::Back => [Some(Side::Back), None],
            Self::Both => [Some(Side::Front), Some(Side::Back)],
            Self::Towards(eye) => [Side::towards(corners, eye), None],
        };
        sides.into_iter().flatten()
    }
}

/// How finely faces are cut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightOptions {
    /// Which sides are classified.
    pub sides: Sides,
    /// How often a piece is halved at most: a face becomes up to `2^max_depth` pieces for each side.
    pub max_depth: u32,
    /// Pieces whose longest edge is no longer than this, in scene units, are not halved.
    pub min_size: f64,
}

impl Default for LightOptions {
    /// Both sides, up to 1024 pieces of a face, of any size.
    fn default() -> Self {
        Self { sides: Sides::Both, max_depth: 10, min_size: 0.0 }
    }
}
