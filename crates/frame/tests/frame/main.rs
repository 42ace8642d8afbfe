//! Scenes along their frames, against exact arithmetic.

use proptest::prelude::*;
use sightlines_cells::{Scene, SceneObject};
use sightlines_exact::{BigRational, rational};
use sightlines_frame::{Areas, Moved, are_near, axes_near, find_axes};
use sightlines_geometry::{Aabb, Point3};
use sightlines_pvs::Frame;

/// A closed box.
fn block(name: &str, b: &Aabb<3>) -> SceneObject {
    let corner = |i: usize| -> Point3 { std::array::from_fn(|k| if i >> k & 1 == 0 { b.min[k] } else { b.max[k] }) };
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    SceneObject { name: name.to_owned(), vertices: (0..8).map(corner).collect(), triangles }
}

/// Blocks on a grid of eighths.
fn blocks() -> impl Strategy<Value = Vec<Aabb<3>>> {
    let side = (-80i32..80, 4i32..60);
    let block = [side.clone(), side.clone(), side].prop_map(|sides| Aabb {
        min: sides.map(|(at, _)| f64::from(at) / 8.0),
        max: sides.map(|(at, long)| f64::from(at + long) / 8.0),
    });
    prop::collection::vec(block, 2..9)
}

/// A rotation by a quaternion with integers as parts.
fn rotation() -> impl Strategy<Value = [Point3; 3]> {
    [-9i32..10, -9i32..10, -9i32..10, -9i32..10].prop_filter_map("no rotation", |q| {
        let [w, x, y, z] = q.map(f64::from);
        let n = w * w + x * x + y * y + z * z;
        let rows = [
            [w * w + x * x - y * y - z * z, 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
            [2.0 * (x * y + w * z), w * w - x * x + y * y - z * z, 2.0 * (y * z - w * x)],
            [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), w * w - x * x - y * y + z * z],
        ];
        (n > 0.0).then(|| rows.map(|row| row.map(|x| x / n)))
    })
}

fn turned(scene: &Scene, rows: &[Point3; 3]) -> Scene {
    let turn = |p: &Point3| rows.map(|row| f64::from((row[0] * p[0] + row[1] * p[1] + row[2] * p[2]) as f32));
    let object = |o: &SceneObject| SceneObject { vertices: o.vertices.iter().map(turn).collect(), ..o.clone() };
    Scene::new(scene.objects().iter().map(object).collect()).expect("a scene")
}

/// The largest distance of a coordinate of the moved scene from the true one, along the frame, exactly.
fn largest_move(scene: &Scene, moved: &Scene, frame: &Frame) -> BigRational {
    let mut most = rational(0.0);
    for (from, to) in scene.objects().iter().zip(moved.objects()) {
        for (p, q) in from.vertices.iter().zip(&to.vertices) {
            for (axis, q) in frame.axes().iter().zip(q) {
                let at: BigRational = axis.iter().zip(p).map(|(a, x)| rational(*a) * rational(*x)).sum();
                let off = at - rational(*q);
                let off = if off < rational(0.0) { -off } else { off };
                most = if off > most { off } else { most };
            }
        }
    }
    most
}

proptest! {
    /// Invariant: every coordinate is within the bound that is stated, and that is below the gap; corners at one place stay at one
    /// place. The twin: blocks that were turned and rounded to single precision are across the axes again, all of them, and to the same
    /// coordinates: as many different ones along each axis as before.
    #[test]
    fn turned_blocks_stand_upright_again(blocks in blocks(), rows in rotation()) {
        let objects: Vec<SceneObject> = blocks.iter().map(|b| block("block", b)).collect();
        let scene = Scene::new(objects).expect("a scene");
        let file = turned(&scene, &rows);
        let gap = 1e-4;
        let found = find_axes(&file, gap).expect("there is area");
        let frame = Frame::new(found.axes, gap).expect("axes at right angles");
        let moved = Moved::new(&file, &frame).expect("the gap is wide enough");
        let most = largest_move(&file, &moved.scene, &frame);
        prop_assert!(most <= rational(moved.most) && moved.most < gap, "{} {}", most, moved.most);
        prop_assert!(Areas::of(&moved.scene).axial_share() == 1.0, "{:?} of {:?}", found, rows);
        let counts = |scene: &Scene| {
            let along = |k: usize| {
                let mut all: Vec<f64> = scene.objects().iter().flat_map(|o| o.vertices.iter().map(move |p| p[k])).collect();
                all.sort_by(f64::total_cmp);
                all.dedup();
                all.len()
            };
            let mut counts = [along(0), along(1), along(2)];
            counts.sort_unstable();
            counts
        };
        prop_assert_eq!(counts(&moved.scene), counts(&scene));
        // The same again, to the last bit.
        prop_assert_eq!(Moved::new(&file, &frame).expect("as before"), moved);
    }

    /// Invariant: a box of the scene is inside the one along the frame, but for what goes with a plane.
    #[test]
    fn boxes_are_taken_along(blocks in blocks(), rows in rotation()) {
        let objects: Vec<SceneObject> = blocks.iter().map(|b| block("block", b)).collect();
        let file = turned(&Scene::new(objects).expect("a scene"), &rows);
        let gap = 1e-4;
        let frame = Frame::new(find_axes(&file, gap).expect("there is area").axes, gap).expect("axes");
        let moved = Moved::new(&file, &frame).expect("moved");
        let axes: [Point3; 3] = std::array::from_fn(|k| rows.map(|row| row[k]));
        for (b, o) in blocks.iter().zip(moved.scene.objects()) {
            let (own, around) = (moved.box_around(&frame, b, &axes), o.bounds());
            prop_assert!((0..3).all(|k| own.min[k] == around.min[k] && own.max[k] == around.max[k]), "{:?} {:?}", own, around);
            let plain = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
            let wide = moved.box_around(&frame, b, &plain);
            let middle = frame.to_frame(std::array::from_fn(|k| (b.min[k] + b.max[k]) / 2.0));
            prop_assert!(wide.contains(middle));
            for i in 0..8 {
                let p = frame.to_frame(std::array::from_fn(|k| if i >> k & 1 == 0 { b.min[k] } else { b.max[k] }));
                prop_assert!((0..3).all(|k| wide.min[k] - gap < p[k] && p[k] < wide.max[k] + gap));
            }
        }
    }
}

/// What stands along the axes to the last bit keeps them, whatever else is in the scene.
#[test]
fn upright_scenes_keep_their_axes() {
    let walls = Aabb { min: [0.0; 3], max: [9.0, 7.0, 3.0] };
    let small = Aabb { min: [1.0; 3], max: [2.0; 3] };
    let tilted = turned(
        &Scene::new(vec![block("small", &small)]).expect("a scene"),
        &[[0.8, 0.6, 0.0], [-0.6, 0.8, 0.0], [0.0, 0.0, 1.0]],
    );
    let objects = vec![block("walls", &walls), tilted.objects()[0].clone()];
    let found = find_axes(&Scene::new(objects).expect("a scene"), 1e-5).expect("there is area");
    assert_eq!(found.axes, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    assert!(found.flat < found.all);
    assert_eq!(find_axes(&Scene::default(), 1e-5), None);
}

/// The twin of closing cracks: two panels that are farther apart than the gap stay apart, those that are nearer meet.
#[test]
fn only_narrow_cracks_close() {
    let gap = 1e-3;
    let panel = |from: f64, to: f64| block("panel", &Aabb { min: [from, 0.0, 0.0], max: [to, 0.25, 2.0] });
    for (width, closes) in [(1e-6, true), (4e-4, true), (1.1e-3, false), (0.1, false)] {
        let scene = Scene::new(vec![panel(0.0, 4.0), panel(4.0 + width, 8.0)]).expect("a scene");
        let frame = Frame::new([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], gap).expect("a frame");
        let moved = Moved::new(&scene, &frame).expect("moved").scene;
        let [left, right] = [0, 1].map(|k| moved.objects()[k].bounds());
        assert_eq!(left.max[0] == right.min[0], closes, "{width}");
        assert!(left.max[0] <= right.min[0], "{width}");
    }
}

/// A rod that becomes a line, and a sliver, have no fronts any more; what is wider keeps them.
#[test]
fn what_becomes_flat_is_seen_from_both_sides() {
    let rod = |width: f64| block("rod", &Aabb { min: [0.0; 3], max: [width, width, 4.0] });
    let scene = Scene::new(vec![rod(1.0), rod(4e-4)]).expect("a scene").with_single_sided(vec![0, 1]).expect("objects");
    let frame = Frame::new([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], 1e-3).expect("a frame");
    let moved = Moved::new(&scene, &frame).expect("moved").scene;
    assert_eq!(moved.objects()[1].bounds().max[0], moved.objects()[1].bounds().min[0], "a line");
    assert_eq!(moved.single_sided(), [0]);
}

/// A wall one triangle of which becomes a line still hides from its front, as that triangle hides nothing; but it is seen from both sides, unlike the twin.
#[test]
fn walls_hide_from_their_fronts_but_for_lines() {
    let wall = |third: Point3| {
        let vertices = vec![[0.0; 3], [4.0, 0.0, 0.0], [4.0, 4.0, 0.0], third];
        SceneObject { name: "wall".into(), vertices, triangles: vec![[0, 1, 2], [1, 2, 3]] }
    };
    // Beside the edge of the other one: by less than the gap, and by more.
    let walls = vec![wall([4.0 + 4e-4, 2.0, 0.0]), wall([5.0, 2.0, 0.0])];
    let scene = Scene::new(walls).and_then(|scene| scene.with_single_sided(vec![0, 1])).expect("a scene");
    let scene = scene.with_front_occluders(vec![0, 1]).expect("objects");
    let frame = Frame::new([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], 1e-3).expect("a frame");
    let moved = Moved::new(&scene, &frame).expect("moved").scene;
    assert_eq!(moved.objects()[0].vertices[3], [4.0, 2.0, 0.0]);
    assert_eq!((moved.front_occluders(), moved.single_sided()), (&[0, 1][..], &[1][..]));
}

/// As users write axes: in any order and with any signs, left-handed too, rounded to single precision.
fn written() -> impl Strategy<Value = [Point3; 3]> {
    let orders = [[0usize, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
    (rotation(), prop::sample::select(orders.to_vec()), [any::<bool>(), any::<bool>(), any::<bool>()]).prop_map(
        |(axes, order, flips)| {
            std::array::from_fn(|k| {
                let sign = if flips[k] { -1.0 } else { 1.0 };
                axes[order[k]].map(|x| f64::from((sign * x) as f32))
            })
        },
    )
}

proptest! {
    /// Invariant: from axes as users write them comes a frame, which stands along them but for their rounding; and the more of a scene is across
    /// it, the better.
    #[test]
    fn written_axes_bring_a_frame(blocks in blocks(), axes in written()) {
        let objects = blocks.iter().map(|b| block("block", b)).collect();
        let upright = Scene::new(objects).expect("a scene");
        let gap = 1e-5;
        let found = axes_near(&upright, gap, axes);
        let frame = Frame::new(found.axes, gap);
        prop_assert!(frame.is_ok(), "{found:?}");
        prop_assert!(are_near(axes, found.axes), "{axes:?} {found:?}");
        // The twin: what stands along the axes is flat, though these are rounded.
        let columns = std::array::from_fn(|k| found.axes.map(|axis| axis[k]));
        let along = axes_near(&turned(&upright, &columns), gap, axes);
        prop_assert!(along.flat > 0.999 * along.all, "{along:?}");
        prop_assert!(Frame::new(along.axes, gap).is_ok());
    }
}

/// The impostors: axes a thousandth away, and half a right angle, are others; order and signs make no difference.
#[test]
fn other_axes_are_not_near() {
    let plain = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let about_z = |s: f64| [[(1.0 - s * s).sqrt(), s, 0.0], [-s, (1.0 - s * s).sqrt(), 0.0], [0.0, 0.0, 1.0]];
    assert!(are_near(plain, [[0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]));
    assert!(are_near(about_z(5e-5), plain) && !are_near(about_z(1e-3), plain) && !are_near(about_z(0.7), plain));
}
