use super::*;
use sightlines_cells::SceneObject;

/// The corners of a cube of side 2, and its sides, low and high along each axis.
const SIDES: [[u32; 4]; 6] = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];

fn cube(sides: &[usize]) -> SceneObject {
    let corner = |i: usize| [0, 1, 2].map(|k| f64::from(u8::from(i >> k & 1 == 1)) * 2.0);
    let halves = |&[a, b, c, d]: &[u32; 4]| [[a, b, c], [a, c, d]];
    let triangles = sides.iter().flat_map(|&s| halves(&SIDES[s])).collect();
    SceneObject { name: String::new(), vertices: (0..8).map(corner).collect(), triangles }
}

fn found(objects: Vec<SceneObject>) -> Vec<Chain> {
    let chains = chains(&Scene::new(objects).unwrap(), 1.0);
    chains.iter().for_each(assert_closed);
    chains
}

/// Every edge is on an even number of triangles and caps, by another way of counting; caps are within holes.
fn assert_closed(chain: &Chain) {
    let mut counts: BTreeMap<[[u64; 3]; 2], u32> = BTreeMap::new();
    for t in chain.triangles.iter().chain(&chain.caps) {
        for k in 0..3 {
            let mut ends = [t[k], t[(k + 1) % 3]].map(|p| p.map(f64::to_bits));
            ends.sort_unstable();
            if ends[0] != ends[1] {
                *counts.entry(ends).or_default() += 1;
            }
        }
    }
    assert!(!counts.is_empty() && counts.values().all(|n| n % 2 == 0), "{chain:?}");
    let inside = |t: &[Point3; 3]| chain.holes.iter().any(|hole| t.iter().all(|&p| hole.contains(p)));
    assert!(chain.caps.iter().all(inside), "{chain:?}");
}

fn counts(chains: &[Chain]) -> Vec<(usize, usize, usize)> {
    chains.iter().map(|c| (c.triangles.len(), c.caps.len(), c.holes.len())).collect()
}

#[test]
fn whole_surfaces_and_those_with_holes_at_the_ends_are_closed() {
    assert_eq!(counts(&found(vec![cube(&[0, 1, 2, 3, 4, 5])])), [(12, 0, 0)]);
    assert_eq!(counts(&found(vec![cube(&[0, 1, 2, 3, 4])])), [(10, 2, 1)]);
    assert_eq!(counts(&found(vec![cube(&[0, 1, 2, 3])])), [(8, 4, 2)]);
    // One hole around a corner, which is at no end; a side alone is flat.
    assert_eq!(counts(&found(vec![cube(&[1, 3, 5])])), []);
    assert_eq!(counts(&found(vec![cube(&[1])])), []);
    assert_eq!(counts(&found(Vec::new())), []);
}

#[test]
fn objects_close_each_other() {
    // Neither part is closed; together they are. Parts with holes at an end are chains of their own as well.
    assert_eq!(counts(&found(vec![cube(&[0, 2, 4]), cube(&[1, 3, 5])])), [(12, 0, 0)]);
    assert_eq!(counts(&found(vec![cube(&[0, 1, 2, 3, 4]), cube(&[5])])), [(10, 2, 1), (12, 0, 0)]);
    // What touches itself twice over is not counted twice.
    assert_eq!(counts(&found(vec![cube(&[0, 1, 2, 3, 4, 5]), cube(&[0, 1, 2, 3, 4, 5])]))[..2], [(12, 0, 0); 2]);
}

#[test]
fn fins_and_triangles_without_area_do_not_matter() {
    let mut finned = cube(&[0, 1, 2, 3, 4, 5]);
    finned.vertices.extend([[1.0, 1.0, 3.0], [1.0, 1.0, 5.0]]);
    // A fin of two triangles on an edge, and a triangle that is an edge.
    finned.triangles.extend([[4, 5, 8], [4, 8, 9], [0, 1, 1]]);
    let chains = found(vec![finned]);
    assert!(counts(&chains).contains(&(12, 0, 0)), "{:?}", counts(&chains));
}

#[test]
fn small_surfaces_are_left_out() {
    assert!(chains(&Scene::new(vec![cube(&[0, 1, 2, 3, 4, 5])]).unwrap(), 2.0).is_empty());
}
