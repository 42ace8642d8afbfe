//! A block above a floor under a square light: umbra and penumbra are squares that are known.

use crate::check::check;
use crate::common::{Triangle, classify, cuboid, floor, method, multifocal, shafts, volume};
use sightlines_area_light::{LightOptions, Lighting, Sides, State};
use sightlines_geometry::Point3;
use sightlines_multifocal::mesh::SheetMethod;
use sightlines_multifocal::{BackendError, FromRegion, Guarantee, Umbra, UnionMethod, Volume};
use sightlines_visible_surface::Faces;

/// Half sides of the light, the block and the floor; heights of the light, the block's top and bottom.
const A: f64 = 1.0;
const B: f64 = 2.1;
const F: f64 = 8.0;
const H: f64 = 6.0;
const TOP: f64 = 2.0;
const BOTTOM: f64 = 1.75;

fn scene() -> Vec<Triangle> {
    [floor(F), cuboid([-B, -B, BOTTOM], [B, B, TOP])].concat()
}

fn light() -> Volume {
    volume([-A, -A, H], [A, A, H])
}

/// Half sides of the umbra and of the penumbra's outer border: from a point of the light at `l` the top's edge at `b` is cast to
/// `l + (b - l) k`, and the top's shadow holds the bottom's, as the block is larger than the light.
fn squares() -> [f64; 2] {
    let k = H / (H - TOP);
    [B * k - A * (k - 1.0), B * k + A * (k - 1.0)]
}

/// The areas of the floor's parts.
fn floor_areas(lighting: &Lighting) -> [f64; 3] {
    let area = |state: State| -> f64 {
        let of = lighting.pieces().iter().filter(|p| p.face < 2 && p.state == state);
        of.map(|p| 2.0 * F * F * 0.5f64.powi(p.depth as i32)).fold(0.0, |a, b| a + b)
    };
    [area(State::Umbra), area(State::Lit), area(State::InDoubt)]
}

fn front(max_depth: u32) -> LightOptions {
    LightOptions { max_depth, sides: Sides::Front, ..LightOptions::default() }
}

/// Invariant: what is decided lies within the known squares, and what is not shrinks towards the penumbra: by the root of two
/// with each halving, as pieces at two borders do.
#[test]
fn doubt_shrinks_to_the_penumbra() {
    let triangles = scene();
    let faces = Faces::new(triangles.clone()).unwrap();
    let [inner, outer] = squares();
    assert!((inner - 2.65).abs() < 1e-12 && (outer - 3.65).abs() < 1e-12);
    let [umbra, lit, penumbra] =
        [4.0 * inner * inner, 4.0 * (F * F - outer * outer), 4.0 * (outer * outer - inner * inner)];
    let mut last = f64::INFINITY;
    for depth in [4, 6, 8, 10, 12, 14] {
        let lighting = classify(&faces, &light(), &mut method(&triangles), &front(depth));
        let [u, l, d] = floor_areas(&lighting);
        println!("depth {depth}: umbra {u} of {umbra}, lit {l} of {lit}, in doubt {d}, of which penumbra {penumbra}");
        assert!(u <= umbra && l <= lit && d >= penumbra);
        assert!((u + l + d - 4.0 * F * F).abs() < 1e-9);
        // Pieces that a border passes: an edge of sqrt(2) F / sqrt(2)^depth or so to both sides of 8 (inner + outer).
        let piece = 2.0 * F * 0.5f64.powf(f64::from(depth) / 2.0);
        assert!(d - penumbra <= 8.0 * (inner + outer) * piece, "depth {depth}: {d}");
        assert!(d - penumbra <= last, "depth {depth}");
        last = d - penumbra;
        assert!(lighting.areas().mixed >= 0.5 * d && lighting.areas().mixed <= d + 1e-9);
        // The top of the block is lit, and its sides and bottom as orientations say.
        let whole =
            |face: u32| lighting.pieces().iter().filter(|p| p.face == face).map(|p| p.state).collect::<Vec<_>>();
        for face in 2..14 {
            let [a, b, c] = triangles[face as usize];
            let z = [a[2], b[2], c[2]];
            if z == [TOP; 3] {
                assert_eq!(whole(face), [State::Lit]);
            } else {
                // The light is above the block and smaller: it is behind the planes of all other sides.
                assert_eq!(whole(face), [State::Umbra]);
            }
        }
    }
    assert!(last < 0.25 * penumbra, "{last}");
}

/// The same by each method alone; the buffer may leave more in doubt, as texels round.
#[test]
fn each_method_finds_umbra() {
    let triangles = scene();
    let faces = Faces::new(triangles.clone()).unwrap();
    let umbra = 4.0 * squares()[0].powi(2);
    let methods: [(Box<dyn FromRegion>, f64); 3] = [
        (Box::new(shafts(&triangles)), 0.7),
        (Box::new(SheetMethod::new(&triangles)), 0.7),
        (Box::new(multifocal(&triangles)), 0.6),
    ];
    for (mut method, least) in methods {
        let lighting = classify(&faces, &light(), method.as_mut(), &front(10));
        let [u, ..] = floor_areas(&lighting);
        println!("{}: umbra {u} of {umbra}", method.name());
        assert!(u <= umbra && u >= least * umbra, "{}: {u}", method.name());
        assert!(check(&triangles, &lighting, 4, 1).is_right());
    }
}

/// A light of one point has no penumbra, so doubt shrinks to nothing.
#[test]
fn a_point_has_no_penumbra() {
    let triangles = scene();
    let faces = Faces::new(triangles.clone()).unwrap();
    let half = B * H / (H - TOP);
    let mut last = f64::INFINITY;
    for depth in [6, 10, 14] {
        let lighting = classify(&faces, &volume([0.0, 0.0, H], [0.0, 0.0, H]), &mut method(&triangles), &front(depth));
        let [u, l, d] = floor_areas(&lighting);
        assert!(u <= 4.0 * half * half && l <= 4.0 * (F * F - half * half));
        assert!(d < 0.5 * last && check(&triangles, &lighting, 4, 2).is_right(), "depth {depth}: {d}");
        last = d;
    }
    assert!(last < 4.0, "{last}");
}

/// Hides what is hidden from the middle of the volume: an impostor.
#[derive(Debug)]
struct MiddleOnly(UnionMethod);

impl FromRegion for MiddleOnly {
    fn name(&self) -> String {
        "middle".to_owned()
    }

    fn guarantee(&self) -> Guarantee {
        Guarantee::Conservative
    }

    fn umbra(&mut self, v: &Volume) -> Result<Box<dyn Umbra + '_>, BackendError> {
        let b = v.bounds();
        let middle: Point3 = std::array::from_fn(|k| (b.min[k] + b.max[k]) / 2.0);
        self.0.umbra(&volume(middle, middle))
    }
}

/// Invariant of the checks themselves: they notice a method that hides too much, and a proof of light that forgot a blocker.
#[test]
fn impostors_are_noticed() {
    let triangles = scene();
    let faces = Faces::new(triangles.clone()).unwrap();
    let right = classify(&faces, &light(), &mut method(&triangles), &front(10));
    let checked = check(&triangles, &right, 8, 3);
    assert!(checked.is_right() && checked.n_umbra > 100 && checked.n_lit > 100, "{checked:?}");

    let too_much = classify(&faces, &light(), &mut MiddleOnly(method(&triangles)), &front(10));
    let checked = check(&triangles, &too_much, 8, 3);
    assert!(!checked.wrong_umbra.is_empty() && checked.wrong_lit.is_empty());

    // The block's top is forgotten by the search for blockers; without a bottom as well, light falls through.
    let is_level = |t: &Triangle| t[0][2] == t[1][2] && t[1][2] == t[2][2] && t[0][2] > 0.0;
    let open: Vec<Triangle> = triangles.iter().copied().filter(|t| !is_level(t)).collect();
    let forgot = classify(&Faces::new(open.clone()).unwrap(), &light(), &mut method(&open), &front(10));
    assert!(check(&open, &forgot, 8, 3).is_right());
    let kept: Vec<Triangle> = open.iter().copied().chain(triangles.iter().copied().filter(is_level)).collect();
    let checked = check(&kept, &forgot, 8, 3);
    assert!(!checked.wrong_lit.is_empty());
}
