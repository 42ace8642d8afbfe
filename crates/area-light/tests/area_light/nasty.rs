//! Lights and scenes that are not as one would like them: no panic, and the answers that are documented.

use crate::check::check;
use crate::common::{Triangle, classify, cuboid, floor, method, quad, volume};
use sightlines_area_light::{LightOptions, Lighting, Side, Sides, State};
use sightlines_geometry::Point3;
use sightlines_multifocal::Volume;
use sightlines_visible_surface::{FaceMask, Faces};

fn ask(triangles: &[Triangle], light: &Volume, sides: Sides, max_depth: u32) -> Lighting {
    let faces = Faces::new(triangles.to_vec()).unwrap();
    let options = LightOptions { sides, max_depth, ..LightOptions::default() };
    let lighting = classify(&faces, light, &mut method(triangles), &options);
    let checked = check(triangles, &lighting, 4, 7);
    assert!(checked.is_right(), "{checked:?}");
    lighting
}

fn states(lighting: &Lighting, face: u32, side: Side) -> Vec<State> {
    lighting.pieces().iter().filter(|p| p.face == face && p.side == side).map(|p| p.state).collect()
}

/// All inner sides of an empty room are lit wholly, without a cut: neighbours at concave edges do not block. A lamp that is flush
/// with the ceiling lights all but the ceiling.
#[test]
fn an_empty_room_is_lit_at_once() {
    let room = cuboid([0.0; 3], [6.0, 5.0, 3.0]);
    for (light, lit) in [
        (volume([2., 2., 1.], [3., 3., 2.]), 12),
        (volume([2., 2., 3.], [3., 3., 3.]), 10),
        (volume([2., 2., 2.5], [3., 3., 3.]), 12),
        (volume([1., 1., 1.], [1., 1., 1.]), 12),
    ] {
        let lighting = ask(&room, &light, Sides::Back, 6);
        let n_lit = lighting.pieces().iter().filter(|p| p.state == State::Lit && p.depth == 0).count();
        assert_eq!((n_lit, lighting.pieces().len()), (lit, 12), "{light:?}");
        // From outside nothing of it is seen.
        let outside = ask(&room, &light, Sides::Front, 6);
        assert!(outside.pieces().iter().all(|p| p.state == State::Umbra && p.depth == 0));
    }
}

/// The same turned by some angle, where no middle of an edge is a double: nothing is left in doubt at edges.
#[test]
fn a_turned_room_is_lit_at_once() {
    let turn = |p: Point3| [0.8 * p[0] - 0.6 * p[1] + 0.1, 0.6 * p[0] + 0.8 * p[1] + 0.1, p[2] * 0.7];
    let room: Vec<Triangle> = cuboid([0.0; 3], [6.0, 5.0, 3.0]).iter().map(|t| t.map(turn)).collect();
    let lighting = ask(&room, &volume([0.5, 4.0, 0.5], [1.0, 4.5, 1.0]), Sides::Back, 6);
    let in_doubt = lighting.areas().in_doubt / lighting.areas().total();
    // The corners of a wall are not in one plane when rounded: then its halves see each other edge-on.
    println!("in doubt: {in_doubt}");
    assert!(in_doubt < 0.02, "{in_doubt}");
}

#[test]
fn lights_in_planes_and_behind() {
    let ground = floor(4.0);
    // In the plane: neither side is lit, whether the light is beside the face or on it.
    for light in [volume([-1., -1., 0.], [1., 1., 0.]), volume([9., 9., 0.], [10., 10., 0.]), volume([0.; 3], [0.; 3])]
    {
        let lighting = ask(&ground, &light, Sides::Both, 3);
        assert!(lighting.pieces().iter().all(|p| p.state == State::Umbra && p.depth == 0), "{light:?}");
        assert_eq!(lighting.counters().n_facing_away, 4);
    }
    // On the plane with its border: a lamp that stands on the floor.
    let lighting = ask(&ground, &volume([-1., -1., 0.], [1., 1., 2.]), Sides::Both, 3);
    assert_eq!(
        (states(&lighting, 0, Side::Front), states(&lighting, 0, Side::Back)),
        (vec![State::Lit], vec![State::Umbra])
    );
    // Through the plane: no part is lit by all of it.
    let lighting = ask(&ground, &volume([-1., -1., -1.], [1., 1., 2.]), Sides::Both, 3);
    assert!(lighting.pieces().iter().all(|p| p.state == State::InDoubt && p.depth == 3));
}

#[test]
fn lights_within_and_across_solids() {
    let solid = [floor(8.0), cuboid([-2., -2., 2.], [2., 2., 4.])].concat();
    // Within: the floor is in umbra, as far as sheets tell, which is wholly here; the inside is lit.
    let within = ask(&solid, &volume([-1., -1., 2.5], [1., 1., 3.]), Sides::Both, 4);
    assert_eq!(states(&within, 0, Side::Front), [State::Umbra]);
    assert!(
        (2..14).all(
            |f| states(&within, f, Side::Back) == [State::Lit] && states(&within, f, Side::Front) == [State::Umbra]
        )
    );
    // Across: lines from the part within end at the solid, the others do not; nothing of the floor is known to be lit.
    let across = ask(&solid, &volume([-1., -1., 3.], [1., 1., 5.]), Sides::Both, 6);
    assert!(states(&across, 0, Side::Front).iter().all(|&s| s != State::Lit));
    // On top of it, and touching a side.
    ask(&solid, &volume([-1., -1., 4.], [1., 1., 5.]), Sides::Both, 6);
    ask(&solid, &volume([2., -1., 2.], [3., 1., 4.]), Sides::Both, 6);
}

#[test]
fn triangles_without_area_and_twice() {
    let thin: Triangle = [[0., 0., 1.], [1., 0., 1.], [2., 0., 1.]];
    let point: Triangle = [[0., 0., 1.]; 3];
    let triangles = [floor(2.0), floor(2.0), vec![thin, point]].concat();
    let lighting = ask(&triangles, &volume([-1., -1., 3.], [1., 1., 3.]), Sides::Both, 5);
    assert_eq!(lighting.pieces().len(), 8);
    assert!((0..4).all(|f| states(&lighting, f, Side::Front) == [State::Lit]));
    assert!((0..4).all(|f| states(&lighting, f, Side::Back) == [State::Umbra]));
    // Nothing at all.
    let nothing = ask(&[], &volume([0.; 3], [1.; 3]), Sides::Both, 5);
    assert!(nothing.pieces().is_empty() && nothing.areas().total() == 0.0);
}

/// An open mesh: a box without a bottom, which hides and is lit from inside as well.
#[test]
fn open_meshes_have_two_sides() {
    let lid: Vec<Triangle> =
        cuboid([-1., -1., 1.], [1., 1., 2.]).into_iter().filter(|t| t.iter().any(|p| p[2] == 2.0)).collect();
    let triangles = [floor(6.0), lid].concat();
    let lighting = ask(&triangles, &volume([-0.25, -0.25, 0.5], [0.25, 0.25, 0.75]), Sides::Both, 6);
    let inside = (2..triangles.len() as u32).flat_map(|f| states(&lighting, f, Side::Back)).collect::<Vec<_>>();
    assert!(inside.iter().all(|&s| s == State::Lit));
    assert!(states(&lighting, 0, Side::Front).iter().all(|&s| s == State::Lit));
}

/// Coordinates at the ends of what is accepted, and large ones beside small ones.
#[test]
fn coordinates_of_any_size() {
    let (huge, tiny) = (2f64.powi(200), 2f64.powi(-140));
    for unit in [huge / 8.0, tiny * 16.0, 1e9, 0.1] {
        let scaled: Vec<Triangle> = [floor(4.0), cuboid([-1., -1., 1.], [1., 1., 2.])]
            .concat()
            .iter()
            .map(|t| t.map(|p| p.map(|x| x * unit)))
            .collect();
        let light = volume([-unit, -unit, 5.0 * unit], [unit, unit, 5.0 * unit]);
        let faces = Faces::new(scaled.clone()).unwrap();
        let options = LightOptions { max_depth: 7, sides: Sides::Front, ..LightOptions::default() };
        let lighting = classify(&faces, &light, &mut method(&scaled), &options);
        let areas = lighting.areas();
        assert!(areas.lit > 0.0 && areas.umbra > 0.0, "{unit:e}: {areas:?}");
        // The scene of unit 1 has the same parts, wherever scaling is exact.
        assert!(areas.in_doubt < 0.7 * areas.total(), "{unit:e}: {areas:?}");
    }
    let mixed =
        [floor(huge), floor(1.0), quad([[tiny, 0., 1.], [1., 0., 1.], [1., tiny, 1.], [0., huge, 1.]])].concat();
    let faces = Faces::new(mixed.clone()).unwrap();
    for light in
        [volume([-huge; 3], [huge; 3]), volume([0., 0., tiny], [tiny; 3]), volume([0., 0., 3.], [1., huge, 3.])]
    {
        let lighting =
            classify(&faces, &light, &mut method(&mixed), &LightOptions { max_depth: 5, ..LightOptions::default() });
        assert!(!lighting.pieces().is_empty());
    }
}

/// Options end cutting; nonsense does no harm.
#[test]
fn options_end_cutting() {
    let triangles = [floor(4.0), cuboid([-1., -1., 1.], [1., 1., 2.])].concat();
    let faces = Faces::new(triangles.clone()).unwrap();
    let light = volume([-1., -1., 5.], [1., 1., 5.]);
    let n = |max_depth: u32, min_size: f64| {
        let options = LightOptions { max_depth, min_size, sides: Sides::Front };
        classify(&faces, &light, &mut method(&triangles), &options).pieces().len()
    };
    assert_eq!(n(0, 0.0), 14);
    assert_eq!(n(20, f64::INFINITY), 14);
    assert_eq!(n(20, 1e300), 14);
    assert!(n(6, 0.0) > n(4, 0.0) && n(6, f64::NAN) == n(6, 0.0) && n(6, -1.0) == n(6, 0.0));
    let lighting = |options: &LightOptions| classify(&faces, &light, &mut method(&triangles), options);
    let sized = lighting(&LightOptions { max_depth: 30, min_size: 0.5, sides: Sides::Front });
    let longest = |p: &sightlines_area_light::Piece| {
        let edge = |i: usize| (0..3).map(|k| (p.corners[i][k] - p.corners[(i + 1) % 3][k]).powi(2)).sum::<f64>().sqrt();
        edge(0).max(edge(1)).max(edge(2))
    };
    assert!(sized.pieces().iter().filter(|p| p.state == State::InDoubt).all(|p| longest(p) <= 0.5));
    // The side that an eye sees; none of faces that it lies in the plane of.
    let eye = lighting(&LightOptions { max_depth: 2, sides: Sides::Towards([9., 9., 0.]), ..LightOptions::default() });
    assert!(eye.pieces().iter().all(|p| p.face >= 2));
    // Only what is chosen has pieces, and all blocks.
    let mut chosen = FaceMask::all(&faces);
    chosen.retain(|f| f < 2);
    let shadows = sightlines_area_light::Shadows::new(&faces);
    let options = LightOptions { max_depth: 6, sides: Sides::Front, ..LightOptions::default() };
    let some = shadows.classify(&chosen, &light, &mut method(&triangles), &options).unwrap();
    let all = lighting(&options);
    let of_floor: Vec<_> = all.pieces().iter().filter(|p| p.face < 2).copied().collect();
    assert_eq!(some.pieces(), of_floor);
}
