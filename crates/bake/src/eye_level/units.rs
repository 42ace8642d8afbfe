//! How long a metre is in a scene, by what can be measured.

use super::UnitsFrom;
use super::surfaces::Surfaces;
use sightlines_cells::Scene;
use sightlines_geometry::vector::normal;
use sightlines_geometry::{Aabb, Point3, Random};

/// Units of which there may be so many in a metre: kilometres, metres, feet, those of Cube, decimetres, those of Quake, inches, centimetres, millimetres.
const UNITS: [f64; 9] = [0.001, 1.0, 3.280_84, 8.0, 10.0, 32.0, 39.370_1, 100.0, 1000.0];

/// Points of floors at which it is measured how far above a ceiling is.
const N_POINTS: u32 = 4096;

/// So many of them have a ceiling, or nothing is known of ceilings.
const ENOUGH: usize = 128;

/// The height of ceilings of buildings, in metres: least, most and usual. Of real buildings 2.5 to 6.4 were measured.
const CEILING: [f64; 3] = [1.5, 12.0, 3.5];

/// The length of objects, likewise. It differs more: this finds the order of magnitude.
const OBJECT: [f64; 3] = [0.05, 200.0, 10.0];

/// So much of the air between floors and ceilings is under ceilings that are not higher than the measured height. By air, as there may be more area
/// under tables, in shelves and between slabs and what hangs below them than in rooms; less than half, as halls hold more air than people.
const SHARE_OF_AIR: f64 = 0.3;

/// The number of units in a metre.
///
/// A unit is a metre unless the height of ceilings above floors makes that implausible, or where there are no ceilings the median length of
/// objects. Then it is the unit of the list that brings this nearest to what is usual. Of units that differ by less than a third, such as those of
/// Quake and inches, either may be taken; where buildings are of a giant's size, smaller units than those of their authors.
pub(super) fn find(scene: &Scene, surfaces: &Surfaces<'_>) -> (f64, UnitsFrom) {
    if let Some(height) = height(clearances(surfaces)) {
        return nearest(height, CEILING, UnitsFrom::Clearances);
    }
    let longest = |b: Aabb<3>| (0..3).map(|k| b.max[k] - b.min[k]).fold(0.0, f64::max);
    let lengths = scene.objects().iter().map(|object| longest(object.bounds())).filter(|&length| length > 0.0);
    let mut lengths: Vec<f64> = lengths.collect();
    lengths.sort_by(f64::total_cmp);
    let median = lengths.get(lengths.len() / 2);
    median.map_or((1.0, UnitsFrom::Metres), |median| nearest(*median, OBJECT, UnitsFrom::Objects))
}

/// The unit that brings a measured length nearest to the usual one.
fn nearest(measured: f64, [least, most, usual]: [f64; 3], found: fn(f64) -> UnitsFrom) -> (f64, UnitsFrom) {
    if (least..=most).contains(&measured) {
        return (1.0, UnitsFrom::Metres);
    }
    let off = |units: f64| {
        let ratio = measured / (usual * units);
        ratio.max(1.0 / ratio)
    };
    let best = UNITS.into_iter().fold(1.0, |best, units| if off(units) < off(best) { units } else { best });
    (best, if best == 1.0 { UnitsFrom::Metres } else { found(measured) })
}

/// The height below which that share of the air is.
fn height(mut clearances: Vec<f64>) -> Option<f64> {
    clearances.sort_by(f64::total_cmp);
    let mut left = SHARE_OF_AIR * clearances.iter().sum::<f64>();
    clearances.into_iter().find(|clearance| {
        left -= clearance;
        left <= 0.0
    })
}

/// How far above points of floors ceilings are, both of which show their fronts to whoever is between them; none if there are too few.
fn clearances(surfaces: &Surfaces<'_>) -> Vec<f64> {
    let (up, triangles) = (surfaces.up, surfaces.triangles());
    let floors: Vec<u32> = surfaces.floors.iter().copied().filter(|&i| surfaces.faces_up(i)).collect();
    let heights = triangles
        .iter()
        .flatten()
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], p| [low.min(p[up]), high.max(p[up])]);
    // Off the floor itself.
    let off = (heights[1] - heights[0]) / (1u64 << 14) as f64;
    // Sums of areas, to choose by them.
    let mut sums = Vec::with_capacity(floors.len());
    let mut sum = 0.0;
    for &i in &floors {
        sum += normal(triangles[i as usize])[up].abs();
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
        found.extend(ceiling.filter(|&(i, _)| surfaces.is_level(i) && !surfaces.faces_up(i)).map(|of| of.1));
    }
    if found.len() < ENOUGH { Vec::new() } else { found }
}
