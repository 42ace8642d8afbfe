//! Random triangles on a small grid, as they are and where doubles round.

use crate::check::{check, covers};
use crate::common::{Triangle, classify, method, volume};
use proptest::prelude::*;
use sightlines_area_light::{LightOptions, Sides, State};
use sightlines_geometry::Point3;
use sightlines_visible_surface::Faces;

fn grid(n: i32) -> impl Strategy<Value = Point3> {
    [-n..n + 1, -n..n + 1, -n..n + 1].prop_map(|p| p.map(f64::from))
}

fn soup() -> impl Strategy<Value = Vec<Triangle>> {
    let flat = (0usize..3, -3i32..4, grid(4), grid(4), grid(4)).prop_map(|(axis, at, a, b, c)| {
        [a, b, c].map(|mut p| {
            p[axis] = f64::from(at);
            p
        })
    });
    let any = [grid(4), grid(4), grid(4)];
    prop::collection::vec(prop_oneof![any, flat], 1..12)
}

fn light() -> impl Strategy<Value = (Point3, [i32; 3])> {
    (grid(5), [0i32..3, 0i32..3, 0i32..3])
}

/// As it is, or turned and scaled so that hardly a coordinate is short; the light's box stays one.
fn moved(triangles: &[Triangle], is_turned: bool) -> Vec<Triangle> {
    let (c, s) = (0.8317, 0.5552);
    let turn = |p: Point3| [(c * p[0] - s * p[1]) / 3.0, (s * p[0] + c * p[1]) / 3.0, p[2] / 3.0 + 0.1];
    triangles.iter().map(|t| if is_turned { t.map(turn) } else { *t }).collect()
}

proptest! {
    /// Invariant: no ray contradicts a piece, and pieces cover their faces.
    #[test]
    fn random_scenes_are_right(triangles in soup(), (min, size) in light(), is_turned: bool, seed: u64) {
        let triangles = moved(&triangles, is_turned);
        let scale = if is_turned { 1.0 / 3.0 } else { 1.0 };
        let max = std::array::from_fn(|k| (min[k] + f64::from(size[k])) * scale);
        let light = volume(min.map(|x| x * scale), max);
        let faces = Faces::new(triangles.clone()).unwrap();
        let options = LightOptions { max_depth: 4, ..LightOptions::default() };
        let lighting = classify(&faces, &light, &mut method(&triangles), &options);
        let checked = check(&triangles, &lighting, 4, seed);
        prop_assert!(checked.is_right(), "{:?} {:?}", checked, checked.wrong_lit.first().or(checked.wrong_umbra.first()).map(|&i| lighting.pieces()[i]));
        prop_assert!(covers(&triangles, &lighting));
        let areas = lighting.areas();
        prop_assert!(areas.mixed <= areas.in_doubt && areas.in_doubt >= 0.0);
        // Once more the same.
        prop_assert_eq!(&lighting, &classify(&faces, &light, &mut method(&triangles), &options));
    }

    /// Invariant: alone in the world, a side of a face is lit if the light is all in front of it, and in umbra if none is.
    #[test]
    fn a_single_face_is_decided_at_once(t in [grid(4), grid(4), grid(4)], (min, size) in light(), is_turned: bool) {
        let triangles = moved(&[t], is_turned);
        let light = volume(min, std::array::from_fn(|k| min[k] + f64::from(size[k])));
        let faces = Faces::new(triangles.clone()).unwrap();
        prop_assume!(faces.has_area(0));
        let lighting = classify(&faces, &light, &mut method(&triangles), &LightOptions { max_depth: 2, sides: Sides::Both, ..LightOptions::default() });
        let [a, b, c] = triangles[0];
        let sides: Vec<f64> = light.corners().iter().map(|&l| sightlines_geometry::orient3d(a, b, c, l)).collect();
        let is_cut = sides.iter().any(|&s| s > 0.0) && sides.iter().any(|&s| s < 0.0);
        let states: Vec<State> = lighting.pieces().iter().map(|p| p.state).collect();
        if is_cut {
            prop_assert_eq!(states, [State::InDoubt; 8]);
        } else {
            let lit = |positive: bool| {
                let any = sides.iter().any(|&s| if positive { s > 0.0 } else { s < 0.0 });
                if any { State::Lit } else { State::Umbra }
            };
            prop_assert_eq!(states, [lit(true), lit(false)]);
        }
    }
}
