//! Where in a text the reader is.

use std::fmt;

/// The place in the text's scene, and why reading failed or is about to fail there.
pub(super) type Context = crate::json::Context<Place>;

/// A place in a scene; what is not known or not meant is `None`.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Place {
    /// Index of the feature; 0 for a lone feature or geometry.
    pub(super) feature: Option<usize>,
    /// Index of the geometry in a GeometryCollection, nested ones counted through.
    pub(super) geometry: Option<usize>,
    /// Index of the line or ring in the geometry, those of several polygons counted through.
    pub(super) part: Option<usize>,
    /// Index of the position in that line or ring.
    pub(super) position: Option<usize>,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let indices = [self.feature, self.geometry, self.part, self.position];
        let levels = ["feature", "geometry", "part", "position"].into_iter().zip(indices);
        let levels: Vec<String> = levels.filter_map(|(level, index)| Some(format!("{level} {}", index?))).collect();
        f.write_str(&levels.join(": "))
    }
}
