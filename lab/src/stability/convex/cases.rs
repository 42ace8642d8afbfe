//! The sweeps with convex portals, and the sequences that they test.

use super::methods::{ConvexPortals, methods};
use crate::stability::draws::{between, nudged, powers_of_ten, signed_unit};
use crate::stability::plane::{Doors, cases as plane, gaps};
use crate::stability::sweep::Sweep;
use sightlines::geometry::{Aabb, Point3, Portal3, Random};
use sightlines_testkit::convex::{Passable, sequence_brute_force};

/// All sweeps with convex portals.
pub fn sweeps(quick: bool) -> Vec<Sweep> {
    let cases = if quick { 50 } else { 300 };
    let step = if quick { 3 } else { 1 };
    let sweep = |texts, levels, cases, short, make: fn(f64, &mut Random) -> Option<(ConvexPortals, bool)>| {
        Sweep::of_cases(texts, levels, cases, methods(short), make)
    };
    vec![
        sweep(
            [
                "convex-distance",
                "Upright portals over the corridors in the plane: quadrilaterals whose lower and upper sides slope, all \
                 across one level. A line passes them exactly if one passes the doors of the plane, so the truth is that \
                 of the plane. They are moved away from the origin and rounded there.",
                "distance from the origin",
            ],
            powers_of_ten(0, 9, step),
            cases,
            true,
            |far, random| upright(plane::distance(far, random)?, far, random),
        ),
        sweep(
            ["convex-scale", "The same at the origin, scaled.", "scale"],
            powers_of_ten(-6, 6, step),
            cases,
            true,
            |factor, random| upright(plane::scale(factor, random)?, 0.0, random),
        ),
        sweep(
            [
                "convex-gap",
                "Upright portals over the three doors of plane-gap: a gap of some units in the last place, grazing, or \
                 blocked by as little.",
                "gap in units in the last place",
            ],
            gaps(quick),
            cases.div_ceil(2),
            true,
            |ulps, random| upright(plane::gap(ulps, random)?, 0.0, random),
        ),
        sweep(
            [
                "convex-coplanar",
                "Upright portals over corridors pressed flat: all are nearly on one plane, and seen edge on.",
                "flatness: depth by width",
            ],
            powers_of_ten(-14, 0, if quick { 7 } else { 2 }),
            cases,
            false,
            |flat, random| upright(plane::parallel(flat, random)?, 0.0, random),
        ),
        sweep(
            [
                "convex-grazing",
                "Upright portals over the doors of plane-grazing, with a side each on one upright plane.",
                "number of portals",
            ],
            if quick { vec![3.0, 16.0] } else { vec![3.0, 4.0, 6.0, 8.0, 16.0, 32.0] },
            cases,
            false,
            |n, random| upright(plane::grazing(n, random)?, 0.0, random),
        ),
        sweep(
            [
                "convex-slivers",
                "Upright portals over the doors of plane-slivers: all as wide as the parameter says, as high as they are \
                 far apart.",
                "width of the portals",
            ],
            powers_of_ten(-12, 6, if quick { 6 } else { 2 }),
            cases,
            false,
            |width, random| upright(plane::sliver(width, random)?, 0.0, random),
        ),
        sweep(
            ["convex-length", "Upright portals over the long sequences of plane-length.", "number of portals"],
            if quick { vec![2.0, 20.0] } else { vec![2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0] },
            cases.min(100),
            false,
            |n, random| upright(plane::length(n, random)?, 0.0, random),
        ),
        sweep(
            [
                "convex-triangles",
                "Three triangles in general position with corners on a small grid, moved away from the origin and \
                 rounded there. The truth is that of all lines through four edges, in exact numbers; sequences that are \
                 only touched are left out.",
                "distance from the origin",
            ],
            powers_of_ten(0, 9, step),
            cases.min(100),
            true,
            triangles,
        ),
    ]
}

/// Upright portals over doors, about a level; axes are exchanged in turn, which changes no direction of turning.
fn upright((Doors(doors), open): (Doors, bool), level: f64, random: &mut Random) -> Option<(ConvexPortals, bool)> {
    let bounds = Aabb::around(doors.iter().flat_map(|d| [[d.left.x, d.left.y], [d.right.x, d.right.y]]));
    let size = (bounds.max[0] - bounds.min[0]).max(bounds.max[1] - bounds.min[1]);
    let level = level * signed_unit(random);
    let turn = random.below(3);
    let portals = doors.iter().map(|door| {
        let height = [0; 4].map(|_| size * (0.25 + random.unit()));
        let corner = |x: f64, y: f64, z: f64| -> Point3 {
            let mut p = [0.0; 3];
            (p[turn], p[(turn + 1) % 3], p[(turn + 2) % 3]) = (x, y, z);
            p
        };
        // Low and high sides are apart from the level, also rounded: then the line at the level tells.
        let heights = [level - height[0], level - height[1], level + height[2], level + height[3]];
        let [right, left] = [door.right, door.left];
        let corners = vec![
            corner(right.x, right.y, heights[0]),
            corner(left.x, left.y, heights[1]),
            corner(left.x, left.y, heights[2]),
            corner(right.x, right.y, heights[3]),
        ];
        let is_across = heights[..2].iter().all(|&z| z < level) && heights[2..].iter().all(|&z| z > level);
        if is_across { Portal3::of_corners(corners) } else { None }
    });
    let portals: Option<Vec<Portal3>> = portals.collect();
    Some((ConvexPortals(portals?), open))
}

fn triangles(far: f64, random: &mut Random) -> Option<(ConvexPortals, bool)> {
    let by = [0, 1, 2].map(|_| far * signed_unit(random));
    let unit = 0.1 + 0.4 * random.unit();
    let turn = random.below(3);
    let mut portals = Vec::with_capacity(3);
    for k in 0..3 {
        let corners = [0; 3].map(|_| {
            let p = [10 * k + between(random, 0, 4), between(random, -4, 4), between(random, -4, 4)];
            let mut q = [0.0; 3];
            for i in 0..3 {
                q[(turn + i) % 3] = nudged(random, by[i] + unit * p[i] as f64, 3);
            }
            q
        });
        let ahead = |portal: &Portal3| portal.normal()[turn];
        let portal = Portal3::of_corners(corners.to_vec())?;
        // Seen rather from the front than edge on.
        let portal = if ahead(&portal) < 0.0 { portal.reversed() } else { portal };
        portals.push(portal);
    }
    match sequence_brute_force(&portals) {
        Passable::Open => Some((ConvexPortals(portals), true)),
        Passable::Blocked => Some((ConvexPortals(portals), false)),
        Passable::Touched => None,
    }
}
