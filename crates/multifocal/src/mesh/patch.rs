//! Triangles merged into occluders.

use super::flat::convex_polygons;
use super::grow::Grower;
use super::patch_options::PatchOptions;
use super::vector::{length, vector_area};
use super::weld::Mesh;
use crate::Occluder;
use sightlines_geometry::Point3;

/// As few and as large occluders as a heuristic finds in a soup of triangles; they may overlap. Sorted by the area of their
/// outlines, largest first.
///
/// Every triangle of at least `min_area` is in some patch, as far as possible: on planes perpendicular to an axis,
/// convex polygons inside coplanar areas; elsewhere, patches that grow over edges. Neighbours may have opposite
/// orientations; triangles with coordinates that predicates do not accept, and those without area, are left out.
///
/// The same triangles in the same order give the same patches. O(n log n), times factors that depend on `patience` and
/// `max_corners`.
pub fn patches(triangles: &[[Point3; 3]], options: &PatchOptions) -> Vec<Occluder> {
    patches_of(&Mesh::weld(triangles), options)
}

/// The [`patches`] of a mesh. Of [triangles that hide from their fronts only](Mesh::is_front_only) there are patches of their own, which
/// [do so too](Occluder::is_front_only): neighbours are joined whose fronts are on one side of the surface.
pub fn patches_of(mesh: &Mesh, options: &PatchOptions) -> Vec<Occluder> {
    let found = convex_polygons(mesh, options);
    let mut occluders = found.occluders;
    let n = mesh.triangles().len();
    let mut is_covered = vec![false; n];
    found.covered.iter().for_each(|&t| is_covered[t as usize] = true);
    let mut grower = Grower::new(mesh, options);
    let mut seeds: Vec<(f64, u32)> = (0..n as u32).map(|t| (grower.twice_area(t), t)).collect();
    seeds.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    // After this many neighbours the remaining small patches stay as they are.
    let most_work = 100 * n as u64 + (1 << 16);
    for (_, seed) in seeds {
        if is_covered[seed as usize] {
            continue;
        }
        if grower.work > most_work {
            occluders.extend(alone(mesh, seed));
            continue;
        }
        let patch = grower.grow(seed);
        grower.covered(&patch).into_iter().for_each(|t| is_covered[t as usize] = true);
        occluders.extend(grower.occluder(&patch));
        // The starting triangle may have ended up in a notch.
        if !is_covered[seed as usize] {
            occluders.extend(alone(mesh, seed));
        }
    }
    let area = |o: &Occluder| length(vector_area(o.outline()));
    let mut sorted: Vec<(f64, Occluder)> = occluders.into_iter().map(|o| (area(&o), o)).collect();
    sorted.retain(|o| o.0 >= options.min_area);
    // Stable, so equal areas stay in the order in which they were found.
    sorted.sort_by(|a, b| b.0.total_cmp(&a.0));
    sorted.truncate(options.limit);
    sorted.into_iter().map(|o| o.1).collect()
}

/// A triangle as a patch.
fn alone(mesh: &Mesh, triangle: u32) -> Option<Occluder> {
    Some(mesh.sided(triangle, Occluder::triangle(mesh.corners(triangle)).ok()?))
}
