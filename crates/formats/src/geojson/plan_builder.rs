//! A plan while it is read, feature by feature.

use super::context::Context;
use super::coordinates::Coordinates;
use super::error::{GeoJsonError, GeoJsonErrorKind, GeoJsonPlace, GeometryKind};
use super::geometry::Geometry;
use super::properties::{Properties, wrong};
use sightlines_cells::{LineId, Plan, PlanLine, PlanObject};
use sightlines_geometry::{Aabb, Point2};

/// The plan so far, and where in the text the reader is.
#[derive(Debug, Default)]
pub(super) struct PlanBuilder {
    lines: Vec<PlanLine>,
    objects: Vec<PlanObject>,
    mirrors: Vec<LineId>,
    pub(super) context: Context,
}

impl PlanBuilder {
    /// The plan, when all is read.
    pub(super) fn finish(self) -> Result<Plan, GeoJsonError> {
        let place = GeoJsonPlace::default();
        // Coordinates and lengths were checked on the way; only the number of lines is left.
        let plan = Plan::new(self.lines, self.objects).and_then(|plan| plan.with_mirrors(self.mirrors));
        plan.map_err(|e| GeoJsonError { line: 1, column: 1, place, kind: e.into() })
    }

    /// Adds the geometries of one feature to the plan.
    pub(super) fn add_feature(&mut self, geometries: &[Geometry], about: &Properties) -> Result<(), GeoJsonErrorKind> {
        if about.is_mirror && about.transparent {
            return Err(wrong("mirror", "false where lines do not block sight"));
        }
        for geometry in geometries {
            self.context.place.geometry = geometry.index;
            match geometry.kind {
                GeometryKind::Point | GeometryKind::MultiPoint => self.add_points(&geometry.coordinates.points, about),
                kind => self.add_lines(kind, &geometry.coordinates, about)?,
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

    fn add_lines(
        &mut self,
        kind: GeometryKind,
        coordinates: &Coordinates,
        about: &Properties,
    ) -> Result<(), GeoJsonErrorKind> {
        let closed = matches!(kind, GeometryKind::Polygon | GeometryKind::MultiPolygon);
        let first = self.lines.len();
        for (part, points) in coordinates.parts().enumerate() {
            let before = self.lines.len();
            let back = closed.then(|| (points[points.len() - 1], points[0]));
            let steps = points.windows(2).map(|pair| (pair[0], pair[1])).chain(back);
            self.lines.extend(steps.filter(|(a, b)| a != b).map(|(a, b)| {
                let &Properties { transparent, left, right, .. } = about;
                PlanLine { a, b, opaque: !transparent, left, right }
            }));
            if self.lines.len() == before {
                self.context.place.part = Some(part);
                return Err(GeoJsonErrorKind::NoExtent(kind));
            }
        }
        if about.is_mirror {
            // More lines than ids are refused in the end.
            self.mirrors.extend((first..self.lines.len()).filter_map(|line| u32::try_from(line).ok().map(LineId)));
        }
        Ok(())
    }
}
