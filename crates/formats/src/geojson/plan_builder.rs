//! A plan while it is read, feature by feature.

use super::context::Context;
use super::coordinates::Coordinates;
use super::geometry::{Geometry, GeometryKind};
use super::properties::{Properties, wrong};
use crate::error::Malformed;
use crate::plan::{PlanFile, PlanLines};
use sightlines_cells::{PlanLine, PlanObject};
use sightlines_geometry::{Aabb, Point2};

/// The plan so far, and where in the text the reader is.
#[derive(Debug, Default)]
pub(super) struct PlanBuilder {
    lines: PlanLines,
    objects: Vec<PlanObject>,
    /// The JSON text of the member `crs`.
    pub(super) crs: Option<String>,
    pub(super) context: Context,
}

impl PlanBuilder {
    /// The plan, when all is read.
    pub(super) fn finish(self) -> Result<PlanFile, Malformed> {
        // Coordinates and lengths were checked on the way; only the number of lines is left.
        let file = self.lines.finish(self.objects)?;
        Ok(PlanFile { crs: self.crs, ..file })
    }

    /// Adds the geometries of one feature to the plan.
    pub(super) fn add_feature(&mut self, geometries: &[Geometry], about: &Properties) -> Result<(), Malformed> {
        if about.is_mirror && about.transparent {
            return Err(wrong("mirror", "false where lines do not block sight"));
        }
        for geometry in geometries {
            self.context.place.geometry = geometry.index;
            match geometry.kind {
                GeometryKind::Point | GeometryKind::MultiPoint => self.add_points(&geometry.coordinates.points, about),
                kind => self.add_lines(kind, &geometry.coordinates, about),
            }
        }
        self.context.place.geometry = None;
        Ok(())
    }

    fn add_points(&mut self, points: &[Point2], about: &Properties) {
        let mut add = |points: &[Point2], suffix: &str| {
            let base = about.name.as_ref().or(about.id.as_ref());
            let name = base.map_or_else(|| format!("object {}", self.objects.len()), |base| format!("{base}{suffix}"));
            self.objects.push(PlanObject { name, bounds: Aabb::around(points.iter().map(|p| [p.x, p.y])) });
        };
        match points {
            [] => {}
            [_] => add(points, ""),
            _ if about.is_box => add(points, ""),
            _ => points.iter().enumerate().for_each(|(k, &point)| add(&[point], &format!(" #{k}"))),
        }
    }

    fn add_lines(&mut self, kind: GeometryKind, coordinates: &Coordinates, about: &Properties) {
        let closed = matches!(kind, GeometryKind::Polygon | GeometryKind::MultiPolygon);
        for points in coordinates.parts() {
            if points.iter().all(|point| *point == points[0]) {
                self.lines.count_without_length();
                continue;
            }
            let back = closed.then(|| (points[points.len() - 1], points[0]));
            let steps = points.windows(2).map(|pair| (pair[0], pair[1])).chain(back);
            for (a, b) in steps.filter(|(a, b)| a != b) {
                let &Properties { transparent, left, right, .. } = about;
                self.lines.push(PlanLine { a, b, opaque: !transparent, left, right }, about.is_mirror);
            }
        }
    }
}
