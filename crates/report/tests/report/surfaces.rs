//! Pictures with the scene that the table was made of.

use crate::common::svg::{lines_of, words_of};
use crate::common::tower::house;
use resvg::tiny_skia::Pixmap;
use sightlines_cells::{Scene, SceneObject};
use sightlines_geometry::Point3;
use sightlines_pvs::CellId;
use sightlines_report::{
    IsometricOptions, PictureSubject, SliceOptions, Surfaces, isometric_svg, slice_svg, svg_to_png,
};

const SEEN: &str = "#1c2733";
const HIDDEN: &str = "#9aa5b1";
const SEE_THROUGH: &str = "#12a594";
const FLAT: &str = "#c3cad2";

fn object(name: &str, triangles: &[[Point3; 3]]) -> SceneObject {
    let indices = (0..triangles.len() as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    SceneObject { name: name.into(), vertices: triangles.concat(), triangles: indices }
}

/// The two objects of the house: a slanted wall, which crosses height 1 where z is 1, and a shelf at height 1.5.
fn scene() -> Scene {
    let slanted = [[0.5, 0.0, 0.5], [3.5, 0.0, 0.5], [0.5, 2.0, 1.5]];
    let shelf = [[4.5, 1.5, 0.5], [5.5, 1.5, 0.5], [4.5, 1.5, 1.5]];
    Scene::new(vec![object("lamp", &[slanted]), object("cat", &[shelf])]).unwrap()
}

fn drawn(scene: &Scene, view: PictureSubject<[f64; 3]>, height: f64) -> String {
    let surfaces = Surfaces::of_scene(scene);
    let options = SliceOptions { view, height, surfaces: Some(&surfaces), size: 625, ..SliceOptions::default() };
    slice_svg(&house(), &options).unwrap()
}

/// Six units are the picture less its margins.
const UNIT: f64 = (625.0 - 2.0 * 12.5) / 6.0;

#[test]
fn slanted_triangles_are_cut_where_the_plane_is() {
    let mut n = 0;
    for (height, z, x) in [(0.5, 0.75, 2.75), (1.0, 1.0, 2.0), (1.5, 1.25, 1.25)] {
        let lines = lines_of(&drawn(&scene(), PictureSubject::Plan, height), SEEN);
        let [[[x0, y0], [x1, y1]]] = lines[..] else { panic!("at {height}: {lines:?}") };
        let near = |a: f64, b: f64| assert!((a - b).abs() < 0.06, "at {height}: {a} is not {b}");
        near(x0, 12.5 + 0.5 * UNIT);
        near(x1, 12.5 + x * UNIT);
        near(y0, 12.5 + z * UNIT);
        near(y1, y0);
        n += 1;
    }
    assert_eq!(n, 3);
    // The twins: above the triangle there is nothing, and without the scene there are the walls of the cells.
    assert!(lines_of(&drawn(&scene(), PictureSubject::Plan, 2.5), SEEN).is_empty());
    let bare = SliceOptions { height: 2.5, size: 625, ..SliceOptions::default() };
    assert!(lines_of(&slice_svg(&house(), &bare).unwrap(), SEEN).len() > 4);
}

#[test]
fn surfaces_in_the_plane_are_filled() {
    let is_filled =
        |height| drawn(&scene(), PictureSubject::Plan, height).contains(&format!("fill=\"{FLAT}\" fill-opacity"));
    assert_eq!([1.0, 1.5, 2.0].map(is_filled), [false, true, false]);
    assert!(words_of(&drawn(&scene(), PictureSubject::Plan, 1.5)).contains(&"surfaces in the plane".to_owned()));
}

/// Room 0 sees the lamp, and room 1 does not.
#[test]
fn surfaces_that_are_seen_are_darker() {
    let count = |scene: &Scene, cell| {
        let svg = drawn(scene, PictureSubject::Cell(CellId(cell)), 1.0);
        [SEEN, HIDDEN, SEE_THROUGH].map(|colour| lines_of(&svg, colour).len())
    };
    assert_eq!([count(&scene(), 0), count(&scene(), 1)], [[1, 0, 0], [0, 1, 0]]);
    let glass = scene().with_see_through(vec![0]).unwrap();
    assert_eq!([count(&glass, 0), count(&glass, 1)], [[0, 0, 1], [0, 1, 0]]);
    let words = words_of(&drawn(&scene(), PictureSubject::Cell(CellId(0)), 1.0));
    for (label, is_there) in [("surfaces seen", true), ("surfaces not seen", false), ("walls", false)] {
        assert_eq!(words.contains(&label.to_owned()), is_there, "{label}");
    }
    assert_eq!(words[0], "What cell 0 sees at height 1");
}

/// A scene that is larger than the cells is drawn whole, within the picture.
#[test]
fn the_picture_is_as_large_as_the_scene() {
    let far = object("cat", &[[[-20.0, 0.0, 30.0], [40.0, 0.0, 30.0], [40.0, 3.0, 30.0]]]);
    let scene = Scene::new(vec![scene().objects()[0].clone(), far]).unwrap();
    let svg = drawn(&scene, PictureSubject::Plan, 1.0);
    let lines = lines_of(&svg, SEEN);
    assert_eq!(lines.len(), 2);
    assert!(lines.iter().flatten().flatten().all(|x| (0.0..=625.0).contains(x)), "{lines:?}");
}

/// Lines that coincide in the picture are drawn once.
#[test]
fn lines_are_merged() {
    let twice: Vec<[Point3; 3]> = vec![[[0.5, 0.0, 0.5], [3.5, 0.0, 0.5], [0.5, 2.0, 1.5]]; 50];
    let scene = Scene::new(vec![object("lamp", &twice), object("cat", &[])]).unwrap();
    assert_eq!(lines_of(&drawn(&scene, PictureSubject::Plan, 1.0), SEEN).len(), 1);
}

#[test]
fn faces_of_maps_are_cut_as_polygons() {
    let square: [Point3; 4] = [[1.0, 0.0, 1.0], [3.0, 0.0, 1.0], [3.0, 2.0, 1.0], [1.0, 2.0, 1.0]];
    let surfaces = Surfaces::of_polygons([&square[..], &[]].into_iter().map(std::iter::once));
    assert_eq!(surfaces.n_triangles(), 2);
    let options = SliceOptions { height: 1.0, surfaces: Some(&surfaces), size: 625, ..SliceOptions::default() };
    let lines = lines_of(&slice_svg(&house(), &options).unwrap(), SEEN);
    let length: f64 = lines.iter().map(|[a, b]| (b[0] - a[0]).abs()).sum();
    assert!(lines.len() == 2 && (length - 2.0 * UNIT).abs() < 0.2, "{lines:?}");
}

/// The floor of both rooms, and a wall between them that stands in room 1, seen from its front at greater x.
fn rooms(is_single_sided: bool) -> Surfaces {
    let floor =
        [[[0.0, 0.0, 0.0], [0.0, 0.0, 2.0], [6.0, 0.0, 2.0]], [[0.0, 0.0, 0.0], [6.0, 0.0, 2.0], [6.0, 0.0, 0.0]]];
    let wall =
        [[[5.9, 0.0, 0.0], [5.9, 3.0, 0.0], [5.9, 3.0, 2.0]], [[5.9, 0.0, 0.0], [5.9, 3.0, 2.0], [5.9, 0.0, 2.0]]];
    let scene = Scene::new(vec![object("lamp", &floor), object("cat", &wall.map(|[a, b, c]| [a, c, b]))]).unwrap();
    Surfaces::of_scene(&scene.with_single_sided(if is_single_sided { vec![0, 1] } else { vec![] }).unwrap())
}

fn isometric(surfaces: &Surfaces, view: PictureSubject<[f64; 3]>, below: f64) -> String {
    let options = IsometricOptions {
        view,
        below: Some(below),
        surfaces: Some(surfaces),
        size: 500,
        ..IsometricOptions::default()
    };
    isometric_svg(&house(), &options).unwrap()
}

/// How many pixels are more orange than blue, more blue than orange, and grey but not white.
fn hues(svg: &str) -> [usize; 3] {
    let pixels = Pixmap::decode_png(&svg_to_png(svg).unwrap()).unwrap();
    let mut n = [0; 3];
    for p in pixels.pixels() {
        let [red, blue] = [p.red(), p.blue()].map(i32::from);
        n[0] += usize::from(red > blue + 60);
        n[1] += usize::from(blue > red + 60);
        n[2] += usize::from((red - blue).abs() < 20 && (100..240).contains(&red));
    }
    n
}

/// What is in front of cells has their colours, pixel by pixel: the floor of one triangle pair lies in both rooms.
#[test]
fn surfaces_are_coloured_by_the_cells_in_front_of_them() {
    let both = hues(&isometric(&rooms(true), PictureSubject::Cell(CellId(0)), 2.0));
    assert!(both[0] > 5_000 && both[1] > 3_000, "{both:?}");
    // Room 0 is four units long, and room 1 two.
    let floors = both[0] as f64 / both[1] as f64;
    assert!((1.6..2.4).contains(&floors), "{both:?}");
    let none = hues(&isometric(&rooms(true), PictureSubject::Cell(CellId(2)), 2.0));
    assert!(none[0] < 300 && none[1] < 300 && none[2] > 10_000, "{none:?}");
}

/// The back of the wall hides the room, unless it has one side only.
#[test]
fn single_sided_surfaces_are_left_out_from_behind() {
    let [open, shut] =
        [true, false].map(|is_single| hues(&isometric(&rooms(is_single), PictureSubject::Cell(CellId(0)), 2.0)));
    assert_ne!(open, shut);
    assert!(shut[0] <= open[0], "{open:?}, {shut:?}");
}

#[test]
fn pictures_of_surfaces_have_a_line_where_they_are_cut_and_do_not_grow() {
    let svg = isometric(&rooms(true), PictureSubject::Cell(CellId(0)), 2.0);
    assert_eq!(svg.matches("<image ").count(), 1);
    let words = words_of(&svg);
    assert_eq!(words[0], "What cell 0 sees, cut at height 2");
    for label in ["the cell", "seen from the cell", "where the height cuts surfaces"] {
        assert!(words.contains(&label.to_owned()), "{label}: {words:?}");
    }
    let lines = lines_of(&svg, SEEN);
    assert!(!lines.is_empty() && lines.iter().flatten().flatten().all(|x| (0.0..=500.0).contains(x)), "{lines:?}");
    let many: Vec<[Point3; 3]> = (0..20_000)
        .map(|k| f64::from(k) / 20_000.0)
        .map(|t| [[4.0 * t, t, 0.0], [4.0 * t, t, 2.0], [4.0 * t + 0.001, t, 2.0]])
        .collect();
    let scene = Scene::new(vec![object("lamp", &many), object("cat", &[])]).unwrap();
    let large = isometric(&Surfaces::of_scene(&scene), PictureSubject::Cell(CellId(0)), 2.0);
    assert!(large.len() < 120_000, "{}", large.len());
}
