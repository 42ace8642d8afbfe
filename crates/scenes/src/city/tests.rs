//! Cities: closed, disjoint houses, and the documented size.

use super::*;
use std::collections::BTreeSet;

const SMALL: CityOptions = CityOptions { seed: 3, blocks_x: 3, blocks_z: 2, detail: 1 };

/// The defect of an object: an edge without its partner, or a surface that does not face outwards.
fn fault(o: &SceneObject) -> Option<&'static str> {
    let mut edges = BTreeSet::new();
    for t in &o.triangles {
        for k in 0..3 {
            if !edges.insert([t[k], t[(k + 1) % 3]]) {
                return Some("an edge twice");
            }
        }
    }
    if edges.iter().any(|&[a, b]| !edges.contains(&[b, a])) {
        return Some("an open edge");
    }
    let volume: f64 = o.corners().map(|[a, b, c]| det(a, b, c)).sum::<f64>() / 6.0;
    let b = o.bounds();
    let whole: f64 = (0..3).map(|k| b.max[k] - b.min[k]).product();
    (volume != whole).then_some("not the volume of its box")
}

fn det(a: [f64; 3], b: [f64; 3], c: [f64; 3]) -> f64 {
    a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
}

fn overlap(a: &Aabb<3>, b: &Aabb<3>) -> bool {
    (0..3).all(|k| a.min[k] < b.max[k] && b.min[k] < a.max[k])
}

#[test]
fn city_houses_are_closed_and_apart() {
    for detail in [1, 2] {
        let scene = city(CityOptions { detail, ..SMALL }).unwrap();
        assert_eq!(scene.objects().len(), 1 + 4 * 6);
        let boxes: Vec<Aabb<3>> = scene.objects().iter().map(SceneObject::bounds).collect();
        for (i, o) in scene.objects().iter().enumerate() {
            assert_eq!(fault(o), None, "{}", o.name);
            assert!(boxes[..i].iter().all(|b| !overlap(b, &boxes[i])), "{}", o.name);
        }
        // The ground is below all of it, and the highest house has at least 2 storeys.
        let bounds = scene.bounds();
        assert_eq!((bounds.min, bounds.max[0], bounds.max[2]), ([-12.0, -4.0, -12.0], 156.0, 104.0));
        assert!(bounds.max[1] >= 8.0);
    }
}

/// The impostor: a hole and a reversed face are detected, and so are houses that overlap.
#[test]
fn city_faults_are_noticed() {
    let house = city(SMALL).unwrap().objects()[1].clone();
    let mut open = house.clone();
    open.triangles.pop();
    assert_eq!(fault(&open), Some("an open edge"));
    let mut twice = house.clone();
    twice.triangles[0].swap(0, 1);
    assert_eq!(fault(&twice), Some("an edge twice"));
    let mut inside_out = house.clone();
    inside_out.triangles.iter_mut().for_each(|t| t.swap(0, 1));
    assert_eq!(fault(&inside_out), Some("not the volume of its box"));
    assert!(overlap(&house.bounds(), &house.bounds()));
}

#[test]
fn city_grows_with_blocks_and_detail() {
    assert_eq!(city(SMALL).unwrap(), city(SMALL).unwrap());
    assert_ne!(city(SMALL).unwrap(), city(CityOptions { seed: 4, ..SMALL }).unwrap());
    let n = |options| city(options).unwrap().n_triangles() - 12;
    assert_eq!(4 * n(SMALL), n(CityOptions { detail: 2, ..SMALL }));
    let standard = n(CityOptions::default());
    assert!((30_000..80_000).contains(&standard), "{standard}");
}

#[test]
fn city_crossings_are_in_streets() {
    let (scene, crossings) = (city(SMALL).unwrap(), city_crossings(SMALL).unwrap());
    assert_eq!(crossings.len(), 2);
    assert_eq!((crossings[0].min, crossings[0].max), ([45.5, 1.25, 45.5], [46.5, 2.25, 46.5]));
    for o in scene.objects() {
        assert!(crossings.iter().all(|b| !overlap(b, &o.bounds())), "{}", o.name);
    }
    assert!(city_crossings(CityOptions { blocks_x: 1, ..SMALL }).unwrap().is_empty());
}

#[test]
fn city_options_are_checked() {
    let error = |options: CityOptions| city(options).unwrap_err().to_string();
    assert_eq!(error(CityOptions { blocks_x: 0, ..SMALL }), "blocks_x is 0, but must be from 1 to 64");
    assert_eq!(error(CityOptions { blocks_z: 65, ..SMALL }), "blocks_z is 65, but must be from 1 to 64");
    assert_eq!(error(CityOptions { detail: 9, ..SMALL }), "detail is 9, but must be from 1 to 8");
    assert!(city_crossings(CityOptions { detail: 0, ..SMALL }).is_err());
}

/// Tiles share out the houses of the city, and their cells lie in streets.
#[test]
fn city_tiles_are_the_city() {
    let whole = city(SMALL).unwrap();
    for (per_tile, n_tiles) in [(1, 6), (2, 2), (3, 1)] {
        let tiles = city_tiles(SMALL, per_tile).unwrap();
        assert_eq!(tiles.len(), n_tiles);
        let houses: BTreeSet<&str> =
            tiles.iter().flat_map(|tile| &tile.scene.objects()[1..]).map(|o| &*o.name).collect();
        let expected: BTreeSet<&str> = whole.objects()[1..].iter().map(|o| &*o.name).collect();
        assert_eq!(houses, expected);
        for tile in &tiles {
            let ground = tile.scene.objects()[0].bounds();
            let solid: Vec<Aabb<3>> = tile.scene.objects().iter().map(SceneObject::bounds).collect();
            for cell in &tile.cells {
                assert!((0..3).step_by(2).all(|k| ground.min[k] <= cell.min[k] && cell.max[k] <= ground.max[k]));
                assert!(solid.iter().all(|house| !overlap(house, cell)), "{}", tile.name);
            }
        }
        assert_eq!(tiles.iter().map(|tile| tile.cells.len()).sum::<usize>(), 6 * 69);
    }
    assert!(city_tiles(SMALL, 0).is_err());
}
