//! Scenes written as OBJ, and rounded as GLB: what is read again, and what is refused.

use sightlines_cells::{MovingObject, Scene, SceneObject};
use sightlines_formats::scene::{
    Rounding, SceneWriteError, Simplification, parse_glb, parse_obj, write_glb, write_obj, write_rounded_glb,
    write_simplified_glb, write_simplified_obj,
};
use sightlines_geometry::{Aabb, Random};

/// A triangle of decimals, at a distance along x.
fn decimals(name: &str, far: f64) -> SceneObject {
    let vertices = vec![[far + 0.1, -0.0, 1e-7], [far + 0.7, 2.0 / 3.0, 1e21], [far, 1.5, -2.3]];
    SceneObject { name: name.to_owned(), vertices, triangles: vec![[0, 1, 2]] }
}

fn scene(objects: Vec<SceneObject>) -> Scene {
    Scene::new(objects).unwrap()
}

const OCCLUDER: Simplification = Simplification { occluder: true };

#[test]
fn an_obj_is_read_again_bit_by_bit() {
    let mut random = Random::new(5);
    let mut many = decimals("a # b \u{e9}", 0.0);
    many.vertices
        .extend((0..1000).map(|_| [0; 3].map(|_| (random.unit() - 0.5) * 10f64.powi(random.below(30) as i32))));
    many.triangles.extend((0..1001).map(|k| [k, k + 1, k + 2]));
    let all = vec![many, decimals("pane", 5.0), decimals("x-mirror", 1e6), decimals("object 0", 0.0)];
    let scene = scene(all).with_mirrors(vec![2]).unwrap().with_see_through(vec![1]).unwrap();
    let text = write_obj(&scene).unwrap();
    let read = parse_obj(&text).unwrap();
    assert_eq!(read.scene, scene);
    assert_eq!((read.info.simplified, &read.info.warnings[..]), (None, &[][..]));
    assert_eq!(write_obj(&read.scene).unwrap(), text);
    // Impostors: one coordinate next to its own, and glass that is not stated.
    let text = String::from_utf8(text).unwrap();
    for (from, to) in [("-2.3\n", "-2.3000000000000003\n"), ("#sightlines see-through\n", "# see-through\n")] {
        assert!(text.contains(from), "{from}");
        assert_ne!(parse_obj(text.replacen(from, to, 1).as_bytes()).unwrap().scene, scene, "{to}");
    }
    for occluder in [true, false] {
        let said = Simplification { occluder };
        let read = parse_obj(&write_simplified_obj(&scene, said).unwrap()).unwrap();
        assert_eq!((read.info.simplified, &read.scene), (Some(said), &scene));
    }
    // What is not stated as we state it is taken for the worst.
    let other = text.replacen("o ", "#sightlines simplified occluder, more or less\no ", 1);
    assert_eq!(parse_obj(other.as_bytes()).unwrap().info.simplified, Some(Simplification { occluder: false }));
}

#[test]
fn what_an_obj_cannot_hold_is_refused() {
    let refused = |scene: &Scene, wanted: &'static str| {
        assert_eq!(write_obj(scene), Err(SceneWriteError::Obj { object: 1, what: wanted }));
    };
    let named = |name: &str| scene(vec![decimals("a", 0.0), decimals(name, 0.0)]);
    for name in ["", " ", " a", "a ", "a\r", "a\nf 1 2 3", "a\\", "a\tb\t"] {
        refused(&named(name), "its name");
    }
    for name in ["b", "a\tb", "\\ a", "#", "#sightlines see-through", "o", "\u{feff}a"] {
        let scene = named(name);
        assert_eq!(parse_obj(&write_obj(&scene).unwrap()).unwrap().scene, scene, "{name:?}");
    }
    refused(&named("b-mirror"), "a mirror whose name does not end in -mirror, nor such a name of anything else");
    refused(
        &named("b").with_mirrors(vec![1]).unwrap(),
        "a mirror whose name does not end in -mirror, nor such a name of anything else",
    );
    refused(&named("b").with_single_sided(vec![1]).unwrap(), "what has one side");
    let bounds = Aabb { min: [-1e22; 3], max: [1e22; 3] };
    refused(&named("b").with_moving(vec![MovingObject { object: 1, within: Some(bounds) }]).unwrap(), "what moves");
    let empty = SceneObject { triangles: vec![], ..decimals("b", 0.0) };
    refused(&scene(vec![decimals("a", 0.0), empty]), "what has no triangles");
    let error = write_obj(&named("")).unwrap_err().to_string();
    assert_eq!(error, "object 1: an OBJ cannot hold its name");
}

/// The changes of all coordinates.
fn changes(before: &Scene, bytes: &[u8]) -> Rounding {
    let after = parse_glb(bytes, None).unwrap().scene;
    let all = |scene: &Scene| -> Vec<f64> {
        scene.objects().iter().flat_map(|o| o.vertices.iter().flatten().copied()).collect()
    };
    let (before, after) = (all(before), all(&after));
    assert_eq!(before.len(), after.len());
    let off = before.iter().zip(&after).map(|(a, b)| (a - b).abs()).filter(|off| *off > 0.0);
    off.fold(Rounding::default(), |sum, off| Rounding {
        n_coordinates: sum.n_coordinates + 1,
        largest: sum.largest.max(off),
    })
}

#[test]
fn rounding_is_counted_and_small() {
    let near = |x: f64| SceneObject {
        vertices: vec![[x, 0.1, 7.0], [x + 1.0, 0.3, 7.0], [x, 1.2, 7.0]],
        ..decimals("a", 0.0)
    };
    for (far, most) in [(0.1, 6e-8), (430_000.1, 6e-8), (-1e6 + 0.1, 6e-8)] {
        let scene = scene(vec![near(far), near(far + 0.5)]);
        let around = Aabb::around(scene.objects().iter().flat_map(|o| o.vertices.iter().copied()));
        assert!(write_glb(&scene).is_err());
        let (bytes, rounding) = write_rounded_glb(&scene, &around, OCCLUDER).unwrap();
        assert_eq!(changes(&scene, &bytes), rounding);
        assert!(rounding.n_coordinates > 5 && rounding.largest < most, "{far} {rounding:?}");
        assert_eq!(parse_glb(&bytes, None).unwrap().info.simplified, Some(Simplification { occluder: false }));
        // An impostor rounds without a translation.
        let plain = Aabb { min: [-1e300; 3], max: [1e300; 3] };
        let (bytes, plain) = write_rounded_glb(&scene, &plain, OCCLUDER).unwrap();
        assert_eq!(changes(&scene, &bytes), plain);
        assert_eq!(plain.largest > most, far.abs() > 1.0, "{far} {plain:?}");
    }
    // What needs no rounding has the same bytes as ever.
    let exact =
        scene(vec![SceneObject { vertices: vec![[1e6, 0.25, 0.0], [1e6, 1.0, 0.0], [1e6, 0.0, 4.0]], ..near(0.0) }]);
    let around = Aabb { min: [1e6, 0.0, 0.0], max: [1e6, 1.0, 4.0] };
    let written = write_rounded_glb(&exact, &around, OCCLUDER).unwrap();
    assert_eq!(written, (write_simplified_glb(&exact, OCCLUDER).unwrap(), Rounding::default()));
    // Nothing is near a number beyond single precision.
    let error = write_rounded_glb(&scene(vec![near(0.1), near(1e39)]), &around, OCCLUDER).unwrap_err();
    assert_eq!(error, SceneWriteError::Precision { object: 1, vertex: 0, value: 1e39 });
}
