//! Pictures and numbers of tables in space.

use crate::common::tower::house;
use resvg::tiny_skia::Pixmap;
use sightlines_pvs::{CellId, Table};
use sightlines_report::{
    DrawError, DrawOptions, IsometricOptions, PictureSubject, SliceOptions, Up, ViewerShare, export_json,
    isometric_svg, plan_svg, slice_svg, svg_to_png,
};

type Rgb = [u8; 3];
const SEEN: Rgb = [0x8f, 0xc4, 0xf5];
const FROM: Rgb = [0xf0, 0x70, 0x1a];
const HIDDEN: Rgb = [0xec, 0xee, 0xf1];
const WALL: Rgb = [0x1c, 0x27, 0x33];
const PAPER: Rgb = [0xff; 3];

fn pixel(pixels: &Pixmap, x: f64, y: f64) -> Rgb {
    let pixel = pixels.pixel(x as u32, y as u32).expect("inside the picture");
    [pixel.red(), pixel.green(), pixel.blue()]
}

fn slice(view: PictureSubject<[f64; 3]>, height: f64) -> SliceOptions<'static> {
    SliceOptions { view, height, size: 625, legend: false, ..SliceOptions::default() }
}

/// Colours at places `[x, z]` of the house, which is 6 by 2 units of a hundred pixels, less the margin.
fn colours<const N: usize>(options: &SliceOptions<'_>, places: [[f64; 2]; N]) -> [Rgb; N] {
    let png = svg_to_png(&slice_svg(&house(), options).unwrap()).unwrap();
    let pixels = Pixmap::decode_png(&png).unwrap();
    assert_eq!((pixels.width(), pixels.height()), (625, 225));
    places.map(|[x, z]| pixel(&pixels, 12.5 + 100.0 * x, 12.5 + 100.0 * z))
}

const ROOMS: [[f64; 2]; 2] = [[1.0, 1.7], [5.0, 1.7]];

#[test]
fn a_floor_plan_shows_the_storey_that_it_cuts() {
    assert_eq!(colours(&slice(PictureSubject::Cell(CellId(0)), 1.0), ROOMS), [FROM, SEEN]);
    assert_eq!(colours(&slice(PictureSubject::Cell(CellId(1)), 1.0), ROOMS), [SEEN, FROM]);
    assert_eq!(colours(&slice(PictureSubject::Cell(CellId(2)), 1.0), ROOMS), [HIDDEN, HIDDEN]);
    assert_eq!(colours(&slice(PictureSubject::Cell(CellId(2)), 4.0), ROOMS), [FROM, FROM]);
    // On the border of two storeys it is the upper one; the viewer may be elsewhere.
    assert_eq!(colours(&slice(PictureSubject::Cell(CellId(0)), 3.0), ROOMS), [HIDDEN, HIDDEN]);
    assert_eq!(colours(&slice(PictureSubject::Eye([1.0, 1.0, 1.0]), 1.0), ROOMS), [FROM, SEEN]);
    assert_eq!(colours(&slice(PictureSubject::Eye([5.5, 4.0, 1.0]), 1.0), ROOMS), [HIDDEN, HIDDEN]);
    assert_eq!(colours(&slice(PictureSubject::Eye([5.5, 3.0, 1.0]), 4.0), ROOMS), [FROM, FROM]);
}

/// The z axis points down in the picture, towards the viewer of the scene: the lower z is above.
#[test]
fn walls_are_where_no_door_is_at_that_height() {
    let at = [[4.0, 0.25], [4.0, 1.0], [4.0, 1.75], [0.0, 1.0]];
    let [north, door, south, outer] = colours(&slice(PictureSubject::Cell(CellId(2)), 1.0), at);
    assert_eq!([north, south, outer], [WALL; 3]);
    assert_ne!(door, WALL);
    let [_, lintel, _, _] = colours(&slice(PictureSubject::Cell(CellId(2)), 2.0), at);
    assert_eq!(lintel, WALL, "the door ends below");
}

#[test]
fn the_eye_is_marked() {
    let [eye, beside] = colours(&slice(PictureSubject::Eye([1.0, 1.0, 0.5]), 1.0), [[1.0, 0.5], [1.0, 1.5]]);
    assert_eq!((eye, beside), ([0xd6, 0x24, 0x6e], FROM));
}

/// With another axis up, the same table has another plan.
#[test]
fn up_is_respected() {
    let seen = |up| {
        let options = SliceOptions { up, ..slice(PictureSubject::Cell(CellId(0)), 1.0) };
        let png = svg_to_png(&slice_svg(&house(), &options).unwrap()).unwrap();
        Pixmap::decode_png(&png).unwrap()
    };
    // z up: 6 wide, 5 high, room 0 at the lower left, the attic on top.
    let pixels = seen(Up::Z);
    assert_eq!((pixels.width(), pixels.height()), (625, 525));
    let at = |x: f64, y: f64| pixel(&pixels, 12.5 + 100.0 * x, 512.5 - 100.0 * y);
    assert_eq!([at(1.0, 1.0), at(5.0, 1.0), at(3.0, 4.5)], [FROM, SEEN, HIDDEN]);
    // x up: y to the right, z upwards; the plane at x = 1 cuts room 0 and the attic.
    let pixels = seen(Up::X);
    assert_eq!((pixels.width(), pixels.height()), (625, 265));
    let at = |y: f64, z: f64| pixel(&pixels, 12.5 + 120.0 * y, 252.5 - 120.0 * z);
    assert_eq!([at(1.0, 1.0), at(4.0, 1.0)], [FROM, HIDDEN]);
}

fn isometric(table: &Table, options: &IsometricOptions<'_>) -> String {
    isometric_svg(table, &IsometricOptions { size: 500, legend: false, ..*options }).unwrap()
}

#[test]
fn boxes_are_drawn_from_back_to_front() {
    const TOPS: [&str; 4] = ["#eef2f6", "#ff9a52", "#b4d9fa", "#f3f4f6"];
    let n_tops = |svg: &str| TOPS.map(|colour| svg.matches(&format!("Z\" fill=\"{colour}\"/>")).count());
    let plain = isometric(&house(), &IsometricOptions::default());
    assert_eq!(n_tops(&plain), [3, 0, 0, 0]);
    assert_eq!(plain.matches("Z\" fill=").count(), 9, "three faces for each of three cells");
    let from = |cell| IsometricOptions { view: PictureSubject::Cell(CellId(cell)), ..IsometricOptions::default() };
    let seen = isometric(&house(), &from(0));
    // Room 0 lies behind room 1, and the attic, which is not seen, is grey and above both.
    assert_eq!(n_tops(&seen), [0, 1, 1, 1]);
    let places = [TOPS[1], TOPS[2], TOPS[3]].map(|colour| seen.find(colour).unwrap());
    assert!(places.is_sorted(), "{places:?}");
    // What is seen shows through what is drawn over it: both rooms, each in its colour.
    assert_eq!(seen.matches("fill-opacity").count(), 2);
    assert_eq!(n_tops(&isometric(&house(), &from(2))), [0, 1, 0, 2]);
    let below = IsometricOptions { below: Some(3.0), ..IsometricOptions::default() };
    assert_eq!(n_tops(&isometric(&house(), &below)), [2, 0, 0, 0], "the attic is cut off");
    assert!(isometric(&house(), &IsometricOptions { up: Up::Z, ..from(0) }) != seen);
    let eye = IsometricOptions { view: PictureSubject::Eye([1.0, 1.0, 1.0]), ..IsometricOptions::default() };
    let eye = isometric(&house(), &eye);
    assert!(eye.contains("<circle") && eye.contains("<title>What the cell of (1, 1, 1) sees</title>"));
}

/// Up is up: the picture of a tall box is taller than wide, and paper is left beside it.
#[test]
fn isometric_pictures_stand_upright() {
    let mut parts = house().into_parts();
    parts.cells.iter_mut().for_each(|cell| cell.max[1] *= 10.0);
    parts.cells[2].min[1] = 30.0;
    parts.locator = sightlines_pvs::Locator::build(&parts.cell_bounds(), 3);
    let table = Table::new(parts).unwrap();
    let pixels = Pixmap::decode_png(&svg_to_png(&isometric(&table, &IsometricOptions::default())).unwrap()).unwrap();
    assert!(pixels.height() == 500 && pixels.width() < 200, "{} wide", pixels.width());
    assert_eq!(pixel(&pixels, 2.0, 2.0), PAPER);
    assert_ne!(pixel(&pixels, f64::from(pixels.width()) / 2.0, 250.0), PAPER);
}

#[test]
fn what_cannot_be_drawn_is_refused() {
    let table = house();
    let refused = |options: SliceOptions<'_>| slice_svg(&table, &options).unwrap_err();
    let view = |view| slice(view, 1.0);
    assert_eq!(refused(view(PictureSubject::Cell(CellId(3)))), DrawError::NoSuchCell { cell: 3, n_cells: 3 });
    assert_eq!(refused(SliceOptions { size: 15, ..view(PictureSubject::Plan) }), DrawError::Size(15));
    assert_eq!(refused(view(PictureSubject::Eye([0.0, f64::NAN, 0.0]))), DrawError::NotFinite);
    assert_eq!(refused(slice(PictureSubject::Plan, f64::INFINITY)), DrawError::NotFinite);
    for height in [-0.5, 5.0] {
        let error = refused(slice(PictureSubject::Plan, height));
        assert_eq!(error, DrawError::NoCellAt { height, low: 0.0, high: 5.0 });
        assert_eq!(error.to_string(), format!("there is no cell at height {height}: the cells reach from 0 to 5"));
    }
    let below = |height| isometric_svg(&table, &IsometricOptions { below: Some(height), ..Default::default() });
    assert!(below(0.5).is_ok());
    assert_eq!(below(0.0), Err(DrawError::NoCellAt { height: 0.0, low: 0.0, high: 5.0 }));
    assert_eq!(below(f64::NAN), Err(DrawError::NotFinite));
    assert_eq!(plan_svg(&table, &DrawOptions::default()), Err(DrawError::NotPlanar(3)));
}

#[test]
fn shares_are_weighed_by_volume() {
    let share = ViewerShare::of(&house(), &[90, 10]);
    // 24, 12 and 24 of 60 cubic units.
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} is not {b}");
    near(share.cells, (0.4 * 2.0 + 0.2 * 2.0 + 0.4) / 3.0);
    near(share.objects, 0.4 * 0.5 + 0.4 * 0.5);
    near(share.polygons, 0.4 * 0.9 + 0.4 * 0.1);
    assert_eq!(ViewerShare::of(&house(), &[]).polygons, 0.0);
}

/// An object is listed where it is seen, not where objects of seen cells are.
#[test]
fn the_export_lists_objects_in_space() {
    let json: serde_json::Value = serde_json::from_str(&export_json(&house())).unwrap();
    assert_eq!(json["dimension"], 3);
    assert_eq!(
        json["objects"][1],
        serde_json::json!({"id": 1, "name": "cat", "min": [5.0, 3.0, 1.0], "max": [5.0, 3.0, 1.0]})
    );
    assert_eq!(json["cell_objects"], serde_json::json!([[0], [], [1]]));
    assert_eq!(json["portals"][0]["points"].as_array().unwrap().len(), 4);
}
