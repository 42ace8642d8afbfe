//! Faces in any order, which is right for a single convex object once its back faces are gone.

use crate::counters::Counters;
use crate::faces::Faces;
use crate::fragment::Fragment;
use crate::method::{RenderInput, RenderOutput, VisibleSurface};
use crate::plane::InputPlane;
use sightlines_geometry::{Adaptive, Orient2d, Point2, Point3};
use std::collections::BTreeSet;

/// Draws the faces of which the eye is in front, in the order of their ids. Right if [`is_convex`] says so of the
/// faces, and wherever else no two faces that are turned to the eye overlap in the picture.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct AnyOrder;

impl VisibleSurface for AnyOrder {
    fn name(&self) -> &'static str {
        "any order"
    }

    fn see(&self, input: &RenderInput<'_>, counters: &mut Counters) -> RenderOutput {
        let eye = input.camera.eye();
        let mut n_tested = 0;
        let is_front = |&face: &u32| {
            n_tested += 1;
            InputPlane::Face(face).side(input.faces, eye) > 0
        };
        let fragments: Vec<Fragment> = input.mask.iter().filter(is_front).map(Fragment::whole).collect();
        counters.polygons += fragments.len() as u64;
        counters.tested("facing", n_tested);
        RenderOutput::BackToFront(fragments)
    }
}

/// Whether some faces are the whole boundary of one convex object, each point of it once, turned outwards, so that from
/// every eye any order of those that are turned to it shows what is seen: all corners are behind or on the plane of
/// each face, every edge of a face is that of another one the other way round, and no two faces in one plane overlap.
///
/// Exact, but for closed objects of which a corner lies on the inside of an edge: these are refused. An object without
/// volume counts if both of its sides are there. Faces without area are left out; of nothing it is true. Cost: faces
/// times corners.
///
/// Why that is enough: faces of which all corners are behind lie on the boundary of the corners' hull, which is a
/// sphere. Edges in opposite pairs make them a cycle, and a cycle on a sphere covers all of it equally often; and no
/// point is covered twice from one side.
pub fn is_convex(faces: &Faces, of: impl IntoIterator<Item = u32>) -> bool {
    let of: Vec<u32> = of.into_iter().filter(|&f| faces.has_area(f)).collect();
    let corners: BTreeSet<[u64; 3]> = of.iter().flat_map(|&f| faces.of(f).map(|p| p.map(f64::to_bits))).collect();
    let corners: Vec<Point3> = corners.into_iter().map(|p| p.map(f64::from_bits)).collect();
    is_closed(faces, &of)
        && of.iter().all(|&f| corners.iter().all(|&p| InputPlane::Face(f).side(faces, p) <= 0))
        && of.iter().enumerate().all(|(k, &f)| of[..k].iter().all(|&g| !overlap_in_plane(faces, f, g)))
}

/// Whether each directed edge is there once, and its opposite too.
fn is_closed(faces: &Faces, of: &[u32]) -> bool {
    let mut edges = BTreeSet::new();
    let bits = |p: Point3| p.map(f64::to_bits);
    let once = of.iter().all(|&f| {
        let corners = faces.of(f).map(bits);
        (0..3).all(|k| edges.insert((corners[k], corners[(k + 1) % 3])))
    });
    once && edges.iter().all(|&(p, q)| edges.contains(&(q, p)))
}

/// Whether two faces lie in one plane, turned the same way, and share an area.
fn overlap_in_plane(faces: &Faces, f: u32, g: u32) -> bool {
    let plane = InputPlane::Face(f);
    if faces.of(g).iter().any(|&p| plane.side(faces, p) != 0) {
        return false;
    }
    // Along an axis along which the plane does not lie, triangles keep what they share.
    for (i, j) in [(0, 1), (1, 2), (2, 0)] {
        let flat = |face: u32| faces.of(face).map(|p| Point2::new(p[i], p[j]));
        let (f, g) = (flat(f), flat(g));
        let turn = |[a, b, c]: [Point2; 3]| Adaptive.orient(a, b, c);
        if turn(f) != 0.0 {
            let same_way = (turn(f) > 0.0) == (turn(g) > 0.0);
            // In a plane an edge of one of two convex pieces parts them if anything does.
            let parts = |f: [Point2; 3], g: [Point2; 3]| {
                (0..3).any(|k| {
                    let outside = |p: &Point2| {
                        let side = Adaptive.orient(f[k], f[(k + 1) % 3], *p);
                        side == 0.0 || (side > 0.0) != (turn(f) > 0.0)
                    };
                    g.iter().all(outside)
                })
            };
            return same_way && !parts(f, g) && !parts(g, f);
        }
    }
    false
}
