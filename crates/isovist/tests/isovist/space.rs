//! Isovists in space against shapes whose volumes and shares are known, and rays against a table.

use sightlines_cells::{Scene, SceneObject};
use sightlines_geometry::Point3;
use sightlines_isovist::{Estimate, Surroundings};

/// The sides of a box, all of one object.
fn cuboid(name: &str, min: Point3, max: Point3) -> SceneObject {
    let corner = |i: usize| std::array::from_fn(|k| if i >> k & 1 == 0 { min[k] } else { max[k] });
    let vertices = (0..8).map(corner).collect();
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    SceneObject { name: name.to_owned(), vertices, triangles }
}

fn plate(name: &str, x: f64, y: [f64; 2], z: [f64; 2]) -> SceneObject {
    let vertices = vec![[x, y[0], z[0]], [x, y[1], z[0]], [x, y[1], z[1]], [x, y[0], z[1]]];
    SceneObject { name: name.to_owned(), vertices, triangles: vec![[0, 1, 2], [0, 2, 3]] }
}

fn holds(estimate: Estimate, truth: f64) -> bool {
    estimate.low <= truth && truth <= estimate.high && estimate.high - estimate.low < 0.1 * truth.max(1.0)
}

#[test]
fn volumes_of_rooms_are_known() {
    // A room of 6 by 4 by 3 is seen whole from anywhere in it.
    let scene =
        Scene::new(vec![cuboid("room", [0.0; 3], [6.0, 4.0, 3.0]), cuboid("far", [9.0; 3], [10.0; 3])]).unwrap();
    let around = Surroundings::new(&scene);
    for eye in [[3.0, 2.0, 1.5], [1.0, 1.0, 1.0], [5.5, 0.5, 2.5]] {
        let volume = around.volume(eye, 40_000, 1);
        assert!(holds(volume, 72.0), "{volume:?} from {eye:?}");
        assert_eq!(volume, around.volume(eye, 40_000, 1), "the same rays");
    }
    // A wall across half of the room hides what is behind it: from x = 2 the plate at x = 4 covers y < 2 at x = 4 and a wedge behind.
    let wall = plate("wall", 4.0, [0.0, 2.0], [0.0, 3.0]);
    let scene = Scene::new(vec![cuboid("room", [0.0; 3], [6.0, 4.0, 3.0]), wall]).unwrap();
    let volume = Surroundings::new(&scene).volume([2.0, 2.0, 1.5], 40_000, 1);
    // The ray past the edge of the wall runs along y = 2, so behind the wall half of the rest, 2 by 2 by 3, is hidden.
    assert!(holds(volume, 60.0), "{volume:?}");
    assert!(volume.high < 72.0, "the impostor: without the wall it is another volume");
    assert_eq!(Surroundings::new(&scene).volume([-9.0; 3], 100, 1).value, 0.0);
}

#[test]
fn shares_of_objects_are_known() {
    // Seen from the origin, a plate at x = 1 covers half, a quarter or nothing of one at x = 2.
    let target = plate("target", 2.0, [-1.0, 1.0], [-1.0, 1.0]);
    let eye = [0.0; 3];
    for (cover, truth) in [([-1.0, 0.0], 0.5), ([5.0, 6.0], 1.0), ([-9.0, 9.0], 0.0)] {
        let scene = Scene::new(vec![target.clone(), plate("cover", 1.0, cover, [-9.0, 9.0])]).unwrap();
        let shares = Surroundings::new(&scene).visible_shares(eye, None, 8000, 3);
        assert!(holds(shares[0], truth), "{cover:?}: {:?}", shares[0]);
        assert_eq!(shares[1].value, 1.0, "nothing is in front of the cover");
    }
    // A closed box in front of nothing is seen as a whole, though only from its front.
    let scene = Scene::new(vec![cuboid("box", [2.0, -1.0, -1.0], [4.0, 1.0, 1.0])]).unwrap();
    assert_eq!(Surroundings::new(&scene).visible_shares(eye, None, 500, 3)[0].value, 1.0);
    // From behind, single-sided faces are not there.
    let sheet = Scene::new(vec![plate("sheet", 2.0, [-1.0, 1.0], [-1.0, 1.0])]).unwrap();
    let of = |eye: Point3, scene: &Scene| Surroundings::new(scene).visible_shares(eye, None, 500, 3)[0].value;
    let one_sided = sheet.with_single_sided(vec![0]).unwrap();
    let sides = [of([0.0; 3], &one_sided), of([9.0, 0.0, 0.0], &one_sided)];
    assert_eq!(sides.iter().sum::<f64>(), 1.0, "{sides:?}");
}
