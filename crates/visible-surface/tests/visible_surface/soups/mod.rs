//! Small scenes on small grids, in which whatever can coincide does; and eyes on the same grids.
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;
use sightlines_cells::{Scene, SceneObject};
use sightlines_geometry::Point3;
use sightlines_visible_surface::{Camera, Faces};

pub(crate) type Triangle = [Point3; 3];

fn point(range: std::ops::RangeInclusive<i8>) -> impl Strategy<Value = Point3> + Clone {
    [range.clone(), range.clone(), range].prop_map(|p| p.map(f64::from))
}

/// Triangles of every kind: through each other, in one plane, with common corners and edges, thin, without area.
pub(crate) fn triangles(most: usize) -> impl Strategy<Value = Vec<Triangle>> {
    let random = || [point(0..=4), point(0..=4), point(0..=4)];
    // In the planes x + y + z = 4 and 5, and x = 1 and 2.
    let slanted = point(0..=4).prop_map(|[x, y, z]| [x, y, 4.0 + f64::from(z > 3.0) - x - y]);
    let upright = point(0..=4).prop_map(|[x, y, z]| [1.0 + f64::from(x > 2.0), y, z]);
    // Edges that are much longer than the triangle is wide.
    let thin = (point(0..=4), point(0..=4), 0..3usize).prop_map(|(p, q, k)| {
        let mut r = [0, 1, 2].map(|i| (p[i] + q[i]) / 2.0);
        r[k] += 1.0 / 64.0;
        [p, q, r]
    });
    // A few points, used again and again.
    let mesh = proptest::collection::vec(point(0..=4), 4..7);
    let picks = proptest::collection::vec([any_index(), any_index(), any_index()], 3..most);
    let mesh = (mesh, picks).prop_map(|(points, picks)| {
        picks.into_iter().map(|pick| pick.map(|i: prop::sample::Index| points[i.index(points.len())])).collect()
    });
    let cycle = (point(0..=1), 0..3usize, any::<bool>()).prop_map(|(at, turn, flip)| cycle(at, turn, flip));
    let of = |one: BoxedStrategy<Triangle>| proptest::collection::vec(one, 1..most).boxed();
    let one =
        prop_oneof![random(), [slanted.clone(), slanted.clone(), slanted], [upright.clone(), upright.clone(), upright]];
    prop_oneof![
        of(random().boxed()),
        of(prop_oneof![one, thin].boxed()),
        mesh.boxed(),
        (cycle, of(random().boxed())).prop_map(|(mut a, b)| {
            a.extend(b.into_iter().take(3));
            a
        }),
    ]
}

fn any_index() -> impl Strategy<Value = prop::sample::Index> {
    any::<prop::sample::Index>()
}

/// Three bars of which each is partly before the next, seen from far along z.
pub(crate) fn cycle(at: Point3, turn: usize, flip: bool) -> Vec<Triangle> {
    let bars = [
        [[0., 0., 0.], [4., 0., 2.], [4., 1., 2.]],
        [[4., 0., 0.], [3., 4., 2.], [2., 4., 2.]],
        [[3., 4., 0.], [0., 0., 2.], [0., 1., 2.]],
    ];
    let turned = |p: Point3| [0, 1, 2].map(|k| at[k] + p[(k + turn) % 3]);
    let mut out: Vec<Triangle> = bars.iter().map(|t| t.map(turned)).collect();
    if flip {
        out.reverse();
    }
    out
}

/// The triangles of a cube, outwards.
pub(crate) fn cube(at: [f64; 3], size: f64) -> Vec<Triangle> {
    let corner = |i: usize| [0, 1, 2].map(|k| at[k] + if i >> k & 1 == 1 { size } else { 0.0 });
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    sides.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).map(|t| t.map(corner)).collect()
}

/// Triangles as some objects.
pub(crate) fn objects(triangles: &[Triangle], of: impl Fn(usize) -> usize) -> Faces {
    let n = (0..triangles.len()).map(&of).max().map_or(0, |k| k + 1);
    let mut objects = vec![SceneObject { name: String::new(), vertices: Vec::new(), triangles: Vec::new() }; n];
    for (k, triangle) in triangles.iter().enumerate() {
        let object = &mut objects[of(k)];
        let first = object.vertices.len() as u32;
        object.vertices.extend(triangle);
        object.triangles.push([first, first + 1, first + 2]);
    }
    Faces::of_scene(&Scene::new(objects).unwrap()).unwrap()
}

/// Eyes in, before and around the grid, often in planes of faces; their rays go through the grid's points, or anywhere.
pub(crate) fn cameras(side: u32) -> impl Strategy<Value = Camera> {
    let depths = |near: f64, far: f64| prop_oneof![3 => Just([0.0, f64::INFINITY]), 1 => Just([near, far])];
    let straight = (point(-2..=6), point(1..=3), 0..3usize, any::<bool>(), depths(0.5, 1.25));
    let straight = straight.prop_map(move |(eye, at, axis, swap, depths)| {
        // Depth 1 is the plane across the axis through `at`, where pixels are half a unit wide and have their centres on the grid.
        let (right, below) = if swap { ((axis + 1) % 3, (axis + 2) % 3) } else { ((axis + 2) % 3, (axis + 1) % 3) };
        let start = -f64::from(side / 2) / 2.0 - 0.25;
        let mut corner = [0, 1, 2].map(|k| at[k] - eye[k] + if k == axis { 0.0 } else { start });
        if corner[axis] == 0.0 {
            corner[axis] = 2.0;
        }
        let (mut across, mut down) = ([0.0; 3], [0.0; 3]);
        (across[right], down[below]) = (0.5, 0.5);
        (Camera::new(eye, corner, across, down, [side; 2]).unwrap(), depths)
    });
    let looking = (point(-4..=8), point(1..=3), 0..3usize, depths(2.0, 7.0));
    let looking = looking.prop_filter_map("looks nowhere", move |(eye, at, up, depths)| {
        let up = [0, 1, 2].map(|k| f64::from(u8::from(k == up)));
        Some((Camera::look_at(eye, at, up, 40.0, [side; 2]).ok()?, depths))
    });
    prop_oneof![straight, looking].prop_map(|(camera, [near, far])| camera.with_depths(near, far).unwrap())
}

/// Small soups side by side, `n` along each of two axes.
pub(crate) fn field(n: usize, runner: &mut TestRunner) -> Vec<Triangle> {
    let places = (0..n).flat_map(|x| (0..n).map(move |y| [x as f64 * 3.0, y as f64 * 3.0, 0.0]));
    let soups = places.map(|at| {
        let soup = triangles(8).new_tree(runner).expect("nothing is refused").current();
        soup.into_iter().map(move |t| t.map(|p| [0, 1, 2].map(|k| p[k] + at[k])))
    });
    soups.collect::<Vec<_>>().into_iter().flatten().collect()
}
