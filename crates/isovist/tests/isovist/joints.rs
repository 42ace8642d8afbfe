//! Isovists in plans whose walls meet only up to rounding: with joints nothing is seen through a slit that nobody drew.
//!
//! The impostor is the same plan without its joints.

use sightlines_cells::Plan;
use sightlines_geometry::{Point2, Random};
use sightlines_isovist::{Boundary, Touch, WallMesh};

/// A triangle with a partition from a corner to the opposite side, the first wall, in millimetres; and both ends of the partition, the corner first.
fn sibling(random: &mut Random) -> (Plan, [Point2; 2]) {
    loop {
        let mut point = || Point2::new(10.0 * random.unit(), 10.0 * random.unit());
        let [a, b, c] = [point(), point(), point()];
        if (b - a).perp_dot(c - a) > 8.0 {
            let d = a + (b - a) * (0.2 + 0.6 * random.unit());
            let [a, b, c, d] = [a, b, c, d].map(|p| (p * 1e3).round() / 1e3);
            return (Plan::from_walls([(a, b), (b, c), (c, a), (c, d)]).expect("walls"), [c, d]);
        }
    }
}

#[test]
fn nothing_is_seen_through_a_slit_of_rounding() {
    let mut random = Random::new(3);
    let [mut n_joined, mut n_slits] = [0; 2];
    for k in 0..1000 {
        let (plan, [c, d]) = sibling(&mut random);
        let joined = plan.joined(plan.precision()).expect("a precision that can be had");
        if joined.joints().is_empty() {
            continue;
        }
        n_joined += 1;
        // From one side of the slit to the other, in the middle of it.
        let wall = plan.lines()[0];
        let along = (wall.b - wall.a).normalize();
        let middle = (d + wall.a + along * (d - wall.a).dot(along)) / 2.0;
        let [p, q] = [-0.1, 0.1].map(|by| middle + along * by);
        let sees = |plan: &Plan| {
            let mesh = WallMesh::new(plan).expect("a mesh");
            let isovist = mesh.isovist(p).expect("an eye");
            // How far a point is behind the partition.
            let behind = |at: Point2| (c - d).normalize().perp_dot(d - at);
            let past = isovist.vertices().iter().any(|&at| behind(at) * behind(q).signum() > 0.01);
            assert!(isovist.edges().all(|(_, _, kind)| match kind {
                Boundary::Wall(line) => (line.0 as usize) < plan.lines().len(),
                _ => true,
            }));
            (mesh.sees(p, q, Touch::Blocks).expect("inside of the frame"), past)
        };
        assert_eq!(sees(&joined), (false, false), "{k}");
        n_slits += usize::from(sees(&plan) == (true, true));
    }
    assert!(n_joined > 300 && n_slits > n_joined - 20, "{n_joined} {n_slits}");
}
