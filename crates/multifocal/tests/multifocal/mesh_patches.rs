//! Patches against rays: where a patch blocks, triangles do; and patches of known walls.

use proptest::prelude::*;
use sightlines_geometry::{Point3, orient3d};
use sightlines_multifocal::mesh::{Mesh, PatchOptions, patches};
use sightlines_multifocal::{BufferPlane, Occluder, Volume, mesh};
use sightlines_testkit::Random;
use sightlines_testkit::meshes::{Soup, quad, scene, soup, uneven};
use sightlines_testkit::{RayScene, draw};
use std::collections::{BTreeMap, BTreeSet};

fn at(p: [f64; 3], q: [f64; 3], t: f64) -> Point3 {
    std::array::from_fn(|k| p[k] + (q[k] - p[k]) * t)
}

/// Whether the occluder guarantees to hide on the line from `v` to `p`.
fn promises(o: &Occluder, v: Point3, p: Point3) -> bool {
    let front = o.side_of(&[v]);
    front.is_some() && o.side_of(&[p]) == front.map(|f| !f) && surrounds(o, v, p)
}

/// Whether a line passes all edges of the outline on one side.
fn surrounds(o: &Occluder, v: Point3, p: Point3) -> bool {
    let n = o.outline().len();
    let side = |i: usize| orient3d(o.outline()[i], o.outline()[(i + 1) % n], v, p);
    (0..n).all(|i| side(i) > 0.0) || (0..n).all(|i| side(i) < 0.0)
}

/// The numbers of lines through a patch that were tried, are guaranteed to be blocked, and are free.
fn judged(o: &Occluder, rays: &RayScene, seed: u64, n: u64) -> [usize; 3] {
    let mut counts = [0; 3];
    let outline = o.outline();
    for i in 0..n {
        let mut random = Random::new(seed, i);
        // Inside a triangle of corners: rays along edges test the ray tracer, not the patch.
        let (k, n) = (random.below(outline.len()), outline.len());
        let far = 1 + random.below(n - 2);
        let [a, b, c] = [k, (k + far) % n, (k + far + 1 + random.below(n - 1 - far)) % n].map(|i| outline[i]);
        let through = at(at(a, b, random.unit()), c, random.unit());
        let d = random.direction();
        let [v, p] = [-6.0, 6.0].map(|l| std::array::from_fn(|k| through[k] + l * d[k]));
        counts[0] += 1;
        if promises(o, v, p) {
            counts[1] += 1;
            let hit = rays.first_hit(v, std::array::from_fn(|k| p[k] - v[k]));
            counts[2] += usize::from(hit.is_none_or(|h| h.t > 1.0));
        }
    }
    counts
}

fn options() -> impl Strategy<Value = PatchOptions> {
    (-0.5f64..1.0, 3usize..20, 1usize..20, 0usize..20, 0.0f64..1.0).prop_map(
        |(cosine, corners, facets, patience, notch)| {
            let (least_cosine, max_corners) = (cosine, corners);
            PatchOptions { least_cosine, max_corners, max_facets: facets, patience, notch, ..PatchOptions::default() }
        },
    )
}

proptest! {
    /// Invariant: with any options, a line that passes an outline all on one side meets a triangle between the two
    /// ends.
    #[test]
    fn patches_are_in_the_way_where_they_say(soup in soup(), options in options(), seed in any::<u64>()) {
        let rays = scene(&soup);
        for o in patches(&soup, &options) {
            let [_, _, n_free] = judged(&o, &rays, seed, 60);
            prop_assert_eq!(n_free, 0, "{:?}", o);
        }
    }

    /// Invariant: a part of every triangle is within some patch, and patches come largest first, up to the limit.
    #[test]
    fn patches_lose_nothing(soup in soup(), limit in 0usize..6) {
        let found = patches(&soup, &PatchOptions::default());
        let mesh = Mesh::weld(&soup);
        for t in 0..mesh.triangles().len() as u32 {
            let [a, b, c] = mesh.corners(t);
            // Not all of a triangle need be within one patch, and its very middle may lie on a border.
            let inner = |[a, b, c]: [Point3; 3]| at(at(a, b, 0.44), c, 0.31);
            let inner = [inner([a, b, c]), inner([b, c, a]), inner([c, a, b])];
            // Patches of several planes are seen straight from in front only along their own mean normal.
            let passed = |o: &Occluder| inner.iter().any(|&middle| {
                let normal = vector_area(o.outline());
                let [v, p] = [-1.0, 1.0].map(|s| std::array::from_fn(|k| middle[k] + s * normal[k]));
                o.facets().iter().any(|&[a, b, c]| (orient3d(a, b, c, middle).abs()) < 1e-9) && surrounds(o, v, p)
            });
            prop_assert!(found.iter().any(passed), "triangle {:?}", mesh.corners(t));
        }
        let areas: Vec<f64> = found.iter().map(|o| area(o.outline())).collect();
        prop_assert!(areas.is_sorted_by(|a, b| a * (1.0 + 1e-12) >= *b));
        let few = patches(&soup, &PatchOptions { limit, ..PatchOptions::default() });
        prop_assert_eq!(&few[..], &found[..limit.min(found.len())]);
    }

    /// Invariant: welding finds the same triangles at every edge as a comparison of all pairs of sides, and splits
    /// edges only at corners that lie on them.
    #[test]
    fn weld_edges_are_the_shared_sides(soup in soup()) {
        let mesh = Mesh::weld(&soup);
        let mut sides: BTreeMap<[[u64; 3]; 2], BTreeSet<u32>> = BTreeMap::new();
        let bits = |p: Point3| p.map(|x| (x + 0.0).to_bits());
        for t in 0..mesh.triangles().len() as u32 {
            let corners = mesh.corners(t);
            prop_assert_eq!(corners, soup[mesh.source(t) as usize]);
            for k in 0..3 {
                let mut side = [bits(corners[k]), bits(corners[(k + 1) % 3])];
                side.sort_unstable();
                sides.entry(side).or_default().insert(t);
            }
        }
        let (vertices, mut n_cut) = (mesh.vertices(), 0);
        for (e, ends) in (0u32..).zip(mesh.edges()) {
            prop_assert!(ends[0] < ends[1]);
            let mut key = ends.map(|v| bits(vertices[v as usize]));
            key.sort_unstable();
            let triangles: BTreeSet<u32> = mesh.triangles_at(e).iter().copied().collect();
            prop_assert_eq!(triangles.len(), mesh.triangles_at(e).len());
            let whole = sides.get(&key).cloned().unwrap_or_default();
            prop_assert!(whole.is_subset(&triangles));
            n_cut += triangles.len() - whole.len();
            for &t in triangles.difference(&whole) {
                // A part of a side: both ends are on it.
                let c = mesh.corners(t);
                let on = |k: usize, v: u32| length(cross(minus(c[k], vertices[v as usize]), minus(c[(k + 1) % 3], vertices[v as usize]))) == 0.0;
                prop_assert!((0..3).any(|k| ends.iter().all(|&v| on(k, v))));
            }
        }
        let n_loops: usize = (0..mesh.triangles().len() as u32).map(|t| mesh.outline(t).len()).sum();
        prop_assert!(n_loops >= 3 * mesh.triangles().len() && (n_cut > 0) == (n_loops > 3 * mesh.triangles().len()));
    }
}

fn minus(a: Point3, b: Point3) -> Point3 {
    std::array::from_fn(|k| a[k] - b[k])
}

fn cross(a: Point3, b: Point3) -> Point3 {
    std::array::from_fn(|k| a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3])
}

fn length(a: Point3) -> f64 {
    a.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn area(outline: &[Point3]) -> f64 {
    length(vector_area(outline))
}

fn vector_area(outline: &[Point3]) -> Point3 {
    let mut sum = [0.0; 3];
    for i in 1..outline.len() - 1 {
        let n = cross(minus(outline[i], outline[0]), minus(outline[i + 1], outline[0]));
        sum = std::array::from_fn(|k| sum[k] + n[k]);
    }
    sum.map(|x| x / 2.0)
}

/// The twin of the first invariant: lines are guaranteed, and through most of each patch; and the impostor: patches of
/// a mesh from which triangles are removed afterwards are detected.
#[test]
fn patches_promise_much_and_can_be_caught() {
    let (mut whole, mut open) = ([0; 3], [0; 3]);
    for (i, soup) in draw(&soup(), 200).iter().enumerate() {
        let found = patches(soup, &PatchOptions::default());
        let fewer: Soup = soup.iter().enumerate().filter(|(k, _)| k % 3 != 0).map(|(_, t)| *t).collect();
        for (rays, counts) in [(scene(soup), &mut whole), (scene(&fewer), &mut open)] {
            for o in &found {
                judged(o, &rays, i as u64, 40).iter().zip(counts.iter_mut()).for_each(|(&n, c)| *c += n);
            }
        }
    }
    eprintln!("{whole:?} {open:?}");
    assert!(whole[2] == 0 && whole[0] > 10_000 && whole[1] * 2 > whole[0], "{whole:?}");
    assert!(open[2] * 20 > open[1], "{open:?}");
}

/// The areas of the patches of a wall that is not divided into its convex parts.
fn areas(soup: &[[Point3; 3]]) -> Vec<f64> {
    let found = patches(soup, &PatchOptions::default());
    found.iter().map(|o| (area(o.outline()) * 100.0).round() / 100.0).collect()
}

#[test]
fn flat_walls_are_one_patch() {
    assert_eq!(areas(&uneven(&[])), [100.0]);
    assert_eq!(areas(&uneven(&[9, 130, 77, 201, 14, 160, 33])), [100.0], "corners on the sides of others");
    let mut turned = uneven(&[9, 130, 77]);
    turned.iter_mut().step_by(2).for_each(|t| t.swap(0, 1));
    assert_eq!(areas(&turned), [100.0], "whichever way triangles turn");
    // A slanted plane with integer coordinates: 4 by 3 rhombi, exactly flat.
    let p = |i: i32, k: i32| [f64::from(i + k), f64::from(2 * i), f64::from(3 * k)];
    let slanted = |(i, k): (i32, i32)| quad([p(i, k), p(i + 1, k), p(i + 1, k + 1), p(i, k + 1)], i == k);
    let all: Soup = (0..12).map(|n| (n % 4, n / 4)).flat_map(slanted).collect();
    let found = patches(&all, &PatchOptions::default());
    assert_eq!((found.len(), found[0].outline().len(), found[0].facets().len()), (1, 4, 1), "{found:?}");
    assert_eq!(areas(&all), [84.0]);
    assert_eq!(areas(&[]), [0.0; 0]);
    let nonsense = [[[f64::NAN; 3], [0.0; 3], [1.0; 3]], [[0.0; 3], [1.0; 3], [2.0; 3]]];
    assert_eq!(areas(&nonsense), [0.0; 0]);
}

/// A wall 10 by 4 with a door from 4 to 5, 3 high: the strip above it, and the parts on both sides up to the ceiling.
#[test]
fn walls_with_doors_give_strips_that_overlap() {
    let ring = [[0, 0], [4, 0], [4, 3], [5, 3], [5, 0], [10, 0], [10, 4], [0, 4]];
    let ears = [[0, 1, 2], [0, 2, 7], [2, 3, 7], [3, 6, 7], [3, 4, 5], [3, 5, 6]];
    let corner = |i: usize| [f64::from(ring[i][0]), 7.0, f64::from(ring[i][1])];
    let wall: Soup = ears.iter().map(|t| t.map(corner)).collect();
    let all = areas(&wall);
    assert!([16.0, 20.0, 10.0].iter().all(|a| all.contains(a)), "{all:?}");
}

/// A bent wall gives patches of several planes, which together are few.
#[test]
fn bent_walls_give_patches_of_several_planes() {
    let at = |i: i32, z: i32| [f64::from(i), f64::from(i * i) / 200.0, f64::from(z)];
    let square =
        |k: i32| quad([at(k / 4, k % 4), at(k / 4 + 1, k % 4), at(k / 4 + 1, k % 4 + 1), at(k / 4, k % 4 + 1)], false);
    let wall: Soup = (0..20 * 4).flat_map(square).collect();
    let found = patches(&wall, &PatchOptions { max_corners: 64, ..PatchOptions::default() });
    assert!(found.len() <= 8 && found[0].facets().len() > 3, "{} {}", found.len(), found[0].facets().len());
    assert!(area(found[0].outline()) > 40.0, "of 80: {:?}", area(found[0].outline()));
}

/// The selected occluders hide nearly as much as the best possible selection, measured by points behind.
#[test]
fn the_chosen_hide_most() {
    let volume = Volume::new(sightlines_geometry::Aabb { min: [-0.5; 3], max: [0.5; 3] }).unwrap();
    let plane = BufferPlane::new(2, true, 24.0, [-20.0; 2], [20.0; 2], [64, 64]).unwrap();
    let mut random = Random::new(5, 0);
    let rectangle = |random: &mut Random| {
        let [x, y] = [0; 2].map(|_| random.unit() * 16.0 - 8.0);
        let (z, [w, h]) = (1.5 + 20.0 * random.unit(), [0; 2].map(|_| 0.1 + 5.0 * random.unit() * random.unit()));
        let tilt = random.unit();
        let corner = |u: f64, v: f64| [x + u * w, y + v * h, z + tilt * u * w];
        let all = quad([corner(0., 0.), corner(1., 0.), corner(1., 1.), corner(0., 1.)], false);
        patches(&all, &PatchOptions::default()).swap_remove(0)
    };
    let occluders: Vec<Occluder> = (0..200).map(|_| rectangle(&mut random)).collect();
    let points: Vec<Point3> =
        (0..4000).map(|_| [[-20., 20.], [-20., 20.], [1., 24.]].map(|[l, h]| l + (h - l) * random.unit())).collect();
    let hidden = |o: &Occluder| points.iter().filter(|&&p| volume.corners().iter().all(|&v| promises(o, v, p))).count();
    let counts: Vec<usize> = occluders.iter().map(hidden).collect();
    let mut best = counts.clone();
    best.sort_unstable_by(|a, b| b.cmp(a));
    let n_useful = counts.iter().filter(|&&n| n > 0).count();
    for n in [5, 20, 60] {
        let chosen = mesh::select(&volume, &plane, &occluders, n);
        assert_eq!(chosen.len(), n.min(chosen.len()));
        let (ours, most): (usize, usize) = (chosen.iter().map(|&i| counts[i as usize]).sum(), best[..n].iter().sum());
        assert!(most > 50 && ours * 10 > most * 8, "{n}: {ours} of {most}");
        let lowest: usize = best[200 - n..].iter().sum();
        assert!(lowest * 10 < most * 8, "the test could not fail: {lowest} of {most}");
    }
    let all = mesh::select(&volume, &plane, &occluders, 200);
    let n_lost = (0..200).filter(|i| counts[*i as usize] > 3 && !all.contains(i)).count();
    assert!(all.len() < 200 && n_lost * 20 < n_useful, "{} {n_lost} {n_useful}", all.len());
    assert!(mesh::select(&volume, &plane, &occluders, 0).is_empty());
}
