//! A plan while it is read, feature by feature.

use super::Context;
use super::coordinates::{Coordinates, Geometry, GeometryKind};
use super::properties::{Properties, wrong};
use crate::error::Malformed;
use crate::plan::{PlanFile, PlanLines};
use sightlines_cells::{Plan, PlanLine, PlanObject};
use sightlines_geometry::{Aabb, Point2};

#[derive(Debug, Default)]
pub(super) struct PlanBuilder {
    lines: PlanLines,
    objects: Vec<PlanObject>,
    pub(super) crs: Option<String>,
    /// What the file states of its precision.
    pub(super) precision: Option<f64>,
    /// That of the texts before, where several are one plan.
    pub(super) crs_before: Option<String>,
    pub(super) context: Context,
}

impl PlanBuilder {
    /// Goes on to another text; its index counts as that of its feature, if it has only one.
    pub(super) fn begin_record(&mut self, record: usize) {
        self.crs_before = self.crs.take().or(self.crs_before.take());
        self.context.place.feature = Some(record);
    }

    pub(super) fn finish(mut self) -> Result<PlanFile, Malformed> {
        self.crs = self.crs.or(self.crs_before);
        // Coordinates and lengths were checked on the way; only the number of lines is left.
        let mut file = self.lines.finish(self.objects)?;
        file.warnings.extend(degrees_warning(&file.plan, self.crs.as_deref()));
        let plan = file.plan.with_precision(self.precision);
        Ok(PlanFile { crs: self.crs, plan, ..file })
    }

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

/// What a user should hear of a plan in degrees, as newer GeoJSON has them (RFC 7946): one whose `crs` says so, or one without `crs` that would be
/// smaller than a table in metres, away from the origin.
fn degrees_warning(plan: &Plan, crs: Option<&str>) -> Option<String> {
    let Aabb { min, max } = plan.bounds();
    let [width, height] = [max[0] - min[0], max[1] - min[1]];
    let fits = min[0] <= max[0] && min[0] >= -180.0 && max[0] <= 180.0 && min[1] >= -90.0 && max[1] <= 90.0;
    let is_degrees = match crs {
        Some(crs) => ["CRS84", "EPSG::4326", "EPSG:4326"].iter().any(|name| crs.contains(name)),
        None => width.max(height) < 0.25 && [min, max].iter().any(|p| p.iter().any(|x| x.abs() > 1.0)),
    };
    // The zone of UTM around the middle, in the north or the south.
    let zone = (((min[0] + max[0]) / 2.0 + 180.0) / 6.0).floor().clamp(0.0, 59.0) + 1.0;
    let system = 32600.0 + zone + if min[1] + max[1] < 0.0 { 100.0 } else { 0.0 };
    (fits && is_degrees).then(|| {
        format!(
            "the plan seems to be in degrees, {width:.6} by {height:.6}: it is read as one in a plane, where distances, angles and areas of degrees are wrong; \
             `ogr2ogr -t_srs EPSG:{system} OUT.geojson IN.geojson` projects it to metres"
        )
    })
}
