//! Whether the corners of portals go round the way that the map's tree demands.

use crate::quake::bsp::ClusterPlaces;
use crate::quake::prt::MAX_UNEVENNESS;
use crate::quake::{Bsp, Prt};
use sightlines_geometry::{Point3, Portal3};

/// Cosine of the angle between a portal and a plane of the tree up to which they are taken for parallel. Chosen: portals lie on planes, and a narrow
/// one may be tilted by the rounding of its corners.
const PARALLEL: f64 = 0.5;

/// Portals of clusters with more leafs are not judged, to bound the cost: detail makes some hundreds.
const MOST_LEAFS: usize = 4096;

/// A portal of which the tree says that its second cluster lies where the corners say that the first does, with its clusters. It lies on a plane
/// that divides the two. `leafs` are the clusters of the map's leafs.
///
/// Rounded arithmetic: it catches mistakes, and errs towards silence. Of no map whose tree cannot be read, and of no two clusters without a plane
/// between them at the portal, anything is said. O(nodes + portals * leafs of a cluster * depth).
pub(super) fn inside_out(bsp: &Bsp, prt: &Prt, leafs: &[Option<u32>]) -> Option<(usize, [u32; 2])> {
    let tree = bsp.world_tree().ok()?;
    let mut places = ClusterPlaces::new(&tree, leafs, prt.n_clusters() as usize);
    let is_small = |cluster: &u32| places.n_places(*cluster) <= MOST_LEAFS;
    let small: Vec<bool> = prt.portals().map(|portal| portal.clusters.iter().all(is_small)).collect();
    prt.portals().enumerate().filter(|&(k, _)| small[k]).find_map(|(k, portal)| {
        let shape = Portal3::around(portal.points)?;
        places.stand_in(portal.clusters[0]);
        is_contradicted(&places, portal.clusters[1], &shape).then_some((k, portal.clusters))
    })
}

/// Whether all planes at a portal that divide the current cluster from the one behind it have them the other way round than the portal's corners, and
/// there is one.
fn is_contradicted(places: &ClusterPlaces<'_>, behind: u32, shape: &Portal3) -> bool {
    let (mut agrees, mut contradicts) = (false, false);
    places.planes_towards(behind, |plane, side| {
        if shape.corners().iter().all(|&p| plane.height(p).abs() <= MAX_UNEVENNESS) {
            let cosine = cosine(plane.normal, shape.normal()) * if side == 0 { 1.0 } else { -1.0 };
            agrees |= cosine > PARALLEL;
            contradicts |= cosine < -PARALLEL;
        }
    });
    contradicts && !agrees
}

/// 0 for a vector without a direction.
fn cosine(a: Point3, b: Point3) -> f64 {
    let dot = |a: Point3, b: Point3| (0..3).map(|k| a[k] * b[k]).sum::<f64>();
    let largest = b.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    let b = b.map(|x| x / largest);
    let cosine = dot(a, b) / (dot(a, a) * dot(b, b)).sqrt();
    if cosine.is_finite() { cosine } else { 0.0 }
}
