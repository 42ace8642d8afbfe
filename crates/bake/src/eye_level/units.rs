//! How long a metre is in a scene, by what can be measured.

use super::UnitsFrom;
use super::surfaces::Surfaces;
use sightlines_cells::Scene;
use sightlines_geometry::{Aabb, Point3, Random};

/// Units of which there may be so many in a metre: kilometres, metres, feet, those of Cube, decimetres, those of Quake, inches, centimetres, millimetres.
const UNITS: [f64; 9] = [0.001, 1.0, 3.280_84, 8.0, 10.0, 32.0, 39.370_1, 100.0, 1000.0];

/// Points of floors at which it is measured how far above a ceiling is.
const N_POINTS: u32 = 4096;

/// So many of them have a ceiling, or nothing is known of ceilings.
const ENOUGH: usize = 128;

/// Ceilings of buildings in metres are between these heights, and mostly about the third: half of them at least.
const CEILING: [f64; 3] = [1.5, 12.0, 3.0];

/// Objects of scenes in metres are so long, and mostly about the third: half of them at least.
const OBJECT: [f64; 3] = [0.02, 500.0, 3.0];

/// The number of units in a metre.
///
/// A unit is a metre unless the median height of ceilings above floors makes that implausible, or where there are no ceilings the median length of
/// objects. Then it is the unit of the list that brings this median nearest to what is usual. Of units that differ by less than a third, such as those of
/// Quake and inches, either may be taken.
pub(super) fn find(scene: &Scene, surfaces: &Surfaces<'_>) -> (f64, UnitsFrom) {
    if let Some(median) = median(clearances(surfaces)) {
        return nearest(median, CEILING, UnitsFrom::Clearances);
    }
    let longest = |b: Aabb<3>| (0..3).map(|k| b.max[k] - b.min[k]).fold(0.0, f64::max);
    let lengths = scene.objects().iter().map(|object| longest(object.bounds())).filter(|&length| length > 0.0);
    median(lengths.collect()).map_or((1.0, UnitsFrom::Metres), |median| nearest(median, OBJECT, UnitsFrom::Objects))
}

fn nearest(median: f64, [least, most, usual]: [f64; 3], found: fn(f64) -> UnitsFrom) -> (f64, UnitsFrom) {
    if (least..=most).contains(&median) {
        return (1.0, UnitsFrom::Metres);
    }
    let off = |units: f64| {
        let ratio = median / (usual * units);
        ratio.max(1.0 / ratio)
    };
    let best = UNITS.into_iter().fold(1.0, |best, units| if off(units) < off(best) { units } else { best });
    (best, found(median))
}

fn median(mut of: Vec<f64>) -> Option<f64> {
    of.sort_by(f64::total_cmp);
    of.get(of.len() / 2).copied()
}

/// How far above points of floors ceilings are; none if there are too few.
///
/// Both show their fronts to whoever is between them, unless hardly any do: then whichever way they face.
fn clearances(surfaces: &Surfaces<'_>) -> Vec<f64> {
    [true, false].into_iter().map(|fronts| measured(surfaces, fronts)).find(|of| of.len() >= ENOUGH).unwrap_or_default()
}

fn measured(surfaces: &Surfaces<'_>, fronts: bool) -> Vec<f64> {
    let (up, triangles) = (surfaces.up, surfaces.triangles());
    let floors: Vec<u32> = surfaces.floors.iter().copied().filter(|&i| !fronts || surfaces.faces_up(i)).collect();
    let heights = triangles.iter().flatten().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], p| {
        [low.min(p[up]), high.max(p[up])]
    });
    // Off the floor itself.
    let off = (heights[1] - heights[0]) / (1u64 << 14) as f64;
    // Sums of areas, to choose by them.
    let mut sums = Vec::with_capacity(floors.len());
    let mut sum = 0.0;
    for &i in &floors {
        sum += sightlines_geometry::vector::normal(triangles[i as usize])[up].abs();
        sums.push(sum);
    }
    let mut random = Random::new(0);
    let mut found = Vec::new();
    for _ in 0..N_POINTS {
        let (at, x, y) = (random.unit() * sum, random.unit(), random.unit());
        let Some(&floor) = floors.get(sums.partition_point(|&sum| sum <= at)) else { continue };
        let (x, y) = if x + y > 1.0 { (1.0 - x, 1.0 - y) } else { (x, y) };
        let [a, b, c] = triangles[floor as usize];
        let mut p: Point3 = std::array::from_fn(|k| a[k] + x * (b[k] - a[k]) + y * (c[k] - a[k]));
        p[up] += off;
        let ceiling = surfaces.above(p);
        found.extend(ceiling.filter(|&(i, _)| surfaces.is_level(i) && !(fronts && surfaces.faces_up(i))).map(|of| of.1));
    }
    found
}
