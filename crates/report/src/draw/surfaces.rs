//! The scene that a table was made of, as pictures show it.

use sightlines_cells::Scene;
use sightlines_geometry::Point3;
use sightlines_pvs::Table;

/// The triangles of a scene, to be drawn beside the cells of a table that was made of it. No decision is made by them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Surfaces {
    triangles: Vec<Surface>,
}

/// A triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Surface {
    /// In scene units, counter-clockwise as seen from the front.
    pub(super) corners: [Point3; 3],
    /// The object of the table that it is of.
    pub(super) object: u32,
    /// Whether it hides what is behind it.
    pub(super) is_opaque: bool,
    /// Whether it is not seen from behind.
    pub(super) is_single_sided: bool,
}

impl Surfaces {
    /// The triangles of a scene, whose objects are those of the table. O(triangles).
    #[must_use]
    pub fn of_scene(scene: &Scene) -> Self {
        let mut triangles = Vec::with_capacity(scene.n_triangles());
        for (object, found) in (0..).zip(scene.objects()) {
            let (is_opaque, is_single_sided) = (scene.is_opaque(object), scene.is_single_sided(object));
            triangles.extend(found.corners().map(|corners| Surface { corners, object, is_opaque, is_single_sided }));
        }
        Self { triangles }
    }

    /// Objects that are made of convex polygons and seen from the front only, where their corners turn clockwise, such as the faces of a Quake
    /// map. O(corners).
    #[must_use]
    pub fn of_polygons<'a>(objects: impl Iterator<Item = impl Iterator<Item = &'a [Point3]>>) -> Self {
        let fan = |(object, corners): (u32, &'a [Point3])| {
            corners.windows(2).skip(1).map(move |side| {
                let corners = [corners[0], side[1], side[0]];
                Surface { corners, object, is_opaque: true, is_single_sided: true }
            })
        };
        let polygons = (0..).zip(objects).flat_map(|(object, polygons)| polygons.map(move |p| (object, p)));
        Self { triangles: polygons.flat_map(fan).collect() }
    }

    /// Number of triangles.
    #[must_use]
    pub fn n_triangles(&self) -> usize {
        self.triangles.len()
    }

    /// The triangles along the axes of a table.
    pub(super) fn along<'a>(&'a self, table: &'a Table) -> impl Iterator<Item = Surface> + 'a {
        let along = |p: Point3| table.frame().map_or(p, |frame| frame.to_frame(p));
        self.triangles.iter().map(move |surface| Surface { corners: surface.corners.map(along), ..*surface })
    }
}
