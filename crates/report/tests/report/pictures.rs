//! Pictures show what the table says: colours are read back from the pixels.

use crate::common::{nothing, rooms};
use resvg::tiny_skia::Pixmap;
use sightlines_geometry::Point2;
use sightlines_pvs::{CellId, Locator, ObjectId, Table};
use sightlines_report::{
    DrawError, DrawOptions, Drawing, PictureSubject, PngError, SeenFromEye, plan_drawing, plan_svg, svg_to_png,
};

type Rgb = [u8; 3];
const SEEN: Rgb = [0x8f, 0xc4, 0xf5];
const FROM: Rgb = [0xf0, 0x70, 0x1a];
const HIDDEN: Rgb = [0xec, 0xee, 0xf1];
const WALL: Rgb = [0x1c, 0x27, 0x33];

fn options(view: PictureSubject) -> DrawOptions<'static> {
    DrawOptions { view, size: 820, objects: false, legend: false, ..DrawOptions::default() }
}

/// Colours at points of the plan, which is 8 by 4 units: a hundred pixels less the margin for each.
fn colours<const N: usize>(table: &Table, options: &DrawOptions<'_>, points: [[f64; 2]; N]) -> [Rgb; N] {
    let png = svg_to_png(&plan_svg(table, options).unwrap()).unwrap();
    let pixels = Pixmap::decode_png(&png).unwrap();
    assert_eq!(pixels.width(), options.size);
    let margin = f64::from(options.size) / 50.0;
    let scale = (f64::from(options.size) - 2.0 * margin) / 8.0;
    points.map(|[x, y]| {
        let (column, row) = ((x + 3.0) * scale + margin, (4.0 - y) * scale + margin);
        let pixel = pixels.pixel(column as u32, row as u32).expect("inside the picture");
        [pixel.red(), pixel.green(), pixel.blue()]
    })
}

/// A point of each room: long lower one, upper left, upper right.
const INSIDE: [[f64; 2]; 3] = [[3.0, 1.0], [-2.0, 3.0], [3.5, 3.0]];

#[test]
fn seen_and_hidden_cells_have_their_colours() {
    let from = |cell| options(PictureSubject::Cell(CellId(cell)));
    assert_eq!(colours(&rooms(false), &from(0), INSIDE), [FROM, SEEN, HIDDEN]);
    assert_eq!(colours(&rooms(false), &from(1), INSIDE), [SEEN, FROM, HIDDEN]);
    assert_eq!(colours(&rooms(false), &from(2), INSIDE), [HIDDEN, HIDDEN, FROM]);
    // The impostor: one pair more, and the picture is another.
    assert_eq!(colours(&rooms(true), &from(0), INSIDE), [FROM, SEEN, SEEN]);
}

#[test]
fn an_eye_on_a_border_looks_from_both_cells() {
    let eye = |x, y| options(PictureSubject::Eye(Point2::new(x, y)));
    assert_eq!(colours(&rooms(false), &eye(-1.0, 0.5), INSIDE), [FROM, SEEN, HIDDEN]);
    assert_eq!(colours(&rooms(false), &eye(-2.5, 2.0), INSIDE), [FROM, FROM, HIDDEN]);
    assert_eq!(colours(&rooms(false), &eye(99.0, 99.0), INSIDE), [HIDDEN; 3]);
}

/// What the viewer sees lies over what their cell sees, which is paler.
#[test]
fn a_viewer_may_see_less_than_their_cell() {
    const PALE: Rgb = [0xcf, 0xe4, 0xfa];
    let eye = options(PictureSubject::Eye(Point2::new(-1.0, 0.5)));
    let sees = |cells: &[CellId]| {
        let looks = Some((Point2::new(1.0, 0.0), 1.0));
        colours(
            &rooms(true),
            &DrawOptions { sight: Some(SeenFromEye { cells, objects: &[], looks }), ..eye.clone() },
            INSIDE,
        )
    };
    assert_eq!(sees(&[CellId(0), CellId(1), CellId(2)]), [FROM, SEEN, SEEN]);
    assert_eq!(sees(&[CellId(0), CellId(2)]), [FROM, PALE, SEEN]);
    assert_eq!(sees(&[CellId(0)]), [FROM, PALE, PALE]);
    let title = |sight| plan_svg(&rooms(true), &DrawOptions { sight, ..eye.clone() }).unwrap();
    assert!(title(None).contains("<title>What the cell of (-1, 0.5) sees</title>"));
    let own = SeenFromEye { cells: &[CellId(0)], objects: &[ObjectId(0)], looks: None };
    assert!(title(Some(own)).contains("<title>What a viewer at (-1, 0.5) sees</title>"));
    let refused = |sight| plan_svg(&rooms(true), &DrawOptions { sight: Some(sight), ..eye.clone() }).unwrap_err();
    assert_eq!(refused(SeenFromEye { cells: &[CellId(3)], ..own }), DrawError::NoSuchCell { cell: 3, n_cells: 3 });
    assert_eq!(
        refused(SeenFromEye { objects: &[ObjectId(7)], ..own }),
        DrawError::NoSuchObject { object: 7, n_objects: 2 }
    );
    assert_eq!(refused(SeenFromEye { looks: Some((Point2::new(f64::NAN, 0.0), 1.0)), ..own }), DrawError::NotFinite);
}

/// The legend names every colour that the picture shows, and no other; the picture with it is as large as was asked for.
#[test]
fn legends_name_what_is_there() {
    let with = |view, size| DrawOptions { view, size, objects: true, ..DrawOptions::default() };
    let svg = |options: &DrawOptions<'_>| plan_svg(&rooms(false), options).unwrap();
    let cell = svg(&with(PictureSubject::Cell(CellId(0)), 820));
    let labels = ["the cell", "seen from the cell", "not seen", "walls", "portals", "objects seen", "objects not seen"];
    for label in labels.into_iter().chain(["scale: 1 scene units"]) {
        assert!(cell.contains(&format!("<title>{label}</title>")), "{label}");
    }
    for label in ["the viewer", "seen by the viewer", "a line of sight", "cells"] {
        assert!(!cell.contains(&format!("<title>{label}</title>")), "{label}");
    }
    // Where all is seen, nothing is told about what is not.
    assert!(!plan_svg(&rooms(true), &with(PictureSubject::Cell(CellId(0)), 820)).unwrap().contains("<title>not seen"));
    for size in [200, 300, 820, 1600] {
        let pixels = Pixmap::decode_png(&svg_to_png(&svg(&with(PictureSubject::Plan, size))).unwrap()).unwrap();
        assert_eq!(pixels.width().max(pixels.height()), size);
    }
    assert!(!svg(&with(PictureSubject::Plan, 199)).contains("scale"), "no room for words");
    let bare = DrawOptions { legend: false, ..with(PictureSubject::Plan, 820) };
    assert!(!svg(&bare).contains("scale"));
}

/// The scale bar is as long as the number of scene units beside it: one unit is a hundred pixels here, less
/// the margin of a fiftieth.
#[test]
fn scale_bars_are_true() {
    let svg = plan_svg(&rooms(false), &DrawOptions { objects: false, size: 820, ..DrawOptions::default() }).unwrap();
    let (_, after) = svg.split_once("<title>scale: 1 scene units</title>").expect("a scale bar");
    let path = after.split('"').nth(1).unwrap();
    let numbers: Vec<f64> =
        path.split(|c: char| c.is_ascii_alphabetic() || c == ' ').filter_map(|n| n.parse().ok()).collect();
    // M x y V y, M x y H x, and so on.
    assert_eq!(numbers[5] - numbers[3], (820.0 - 2.0 * 16.4) / 8.0, "{path}");
}

#[test]
fn several_pictures_stand_side_by_side() {
    let one = |cell| {
        plan_drawing(&rooms(false), &DrawOptions { size: 300, ..options(PictureSubject::Cell(CellId(cell))) }).unwrap()
    };
    let pictures: Vec<(String, Drawing)> = (0..3).map(|k| (format!("from {k}"), one(k))).collect();
    let svg = Drawing::side_by_side("rooms", &pictures);
    for heading in ["from 0", "from 1", "from 2"] {
        assert!(svg.contains(&format!("<title>{heading}</title>")), "{heading}");
    }
    assert_eq!(svg.matches("<title>the cell</title>").count(), 1, "one legend");
    let pixels = Pixmap::decode_png(&svg_to_png(&svg).unwrap()).unwrap();
    let alone = Pixmap::decode_png(&svg_to_png(&pictures[2].1.to_svg()).unwrap()).unwrap();
    let [from, whole] =
        [alone, pixels].map(|p| p.pixels().iter().filter(|p| [p.red(), p.green(), p.blue()] == FROM).count());
    assert!(whole > 2 * from, "{whole}, {from}");
}

#[test]
fn walls_are_dark_and_doors_are_not() {
    let at = [[-2.0, 2.0], [3.0, 2.0], [-0.5, 2.0]];
    let [left, right, door] = colours(&rooms(false), &options(PictureSubject::Cell(CellId(2))), at);
    assert_eq!([left, right], [WALL, WALL]);
    assert_ne!(door, WALL);
}

#[test]
fn groups_are_tinted_if_asked() {
    let plain = DrawOptions { group_colours: false, ..options(PictureSubject::Plan) };
    let [a, b, c] = colours(&rooms(false), &plain, INSIDE);
    assert!(a == b && b == c);
    let [a, b, c] = colours(&rooms(false), &options(PictureSubject::Plan), INSIDE);
    assert!(a != b && b != c && a != c);
}

#[test]
fn marks_and_objects_are_drawn() {
    let mut all = DrawOptions { objects: true, ..options(PictureSubject::Cell(CellId(0))) };
    all.line = Some([Point2::new(-0.5, 0.5), Point2::new(-0.5, 3.5)]);
    all.target = Some(CellId(1));
    all.marked_portals = vec![0];
    let [desk, line, target] = colours(&rooms(false), &all, [[-1.5, 0.75], [-0.5, 1.5], [-2.0, 3.0]]);
    assert_ne!(desk, FROM);
    assert_eq!((line, target), ([0xd6, 0x24, 0x6e], [0x8a, 0x5c, 0xd6]));
}

/// A cell too thin to be seen has a ring around it; a large one has none.
#[test]
fn thin_cells_are_ringed() {
    let svg = |table: &Table| plan_svg(table, &options(PictureSubject::Cell(CellId(2)))).unwrap();
    assert!(!svg(&rooms(false)).contains("<circle"));
    let mut parts = rooms(false).into_parts();
    parts.cells[2].max[0] = 2.01;
    parts.cells[2].polygon = vec![[2.0, 2.0], [2.01, 2.0], [2.01, 4.0], [2.0, 4.0]];
    parts.locator = Locator::build(&parts.cell_bounds(), 2);
    assert!(svg(&Table::new(parts).unwrap()).contains("<circle"));
}

#[test]
fn an_empty_table_has_an_empty_picture_and_a_stripped_one_no_walls() {
    let svg = plan_svg(&nothing(), &DrawOptions::default()).unwrap();
    assert!(svg_to_png(&svg).is_ok() && !svg.contains("fill=\"#ec"));
    let stripped = rooms(false).strip_geometry();
    assert_ne!(colours(&stripped, &options(PictureSubject::Plan), [[-2.0, 2.0]]), [WALL]);
}

#[test]
fn what_cannot_be_drawn_is_refused() {
    let refused = |options: DrawOptions<'_>| plan_svg(&rooms(false), &options).unwrap_err();
    let cell = refused(options(PictureSubject::Cell(CellId(3))));
    assert_eq!(cell.to_string(), "there is no cell 3: the table has 3 cells");
    let target = DrawOptions { target: Some(CellId(8)), ..DrawOptions::default() };
    assert_eq!(refused(target), DrawError::NoSuchCell { cell: 8, n_cells: 3 });
    let marked = DrawOptions { marked_portals: vec![0, 1], ..DrawOptions::default() };
    assert_eq!(refused(marked), DrawError::NoSuchPortal { portal: 1, n_portals: 1 });
    for size in [0, 15, 8193, u32::MAX] {
        assert_eq!(refused(DrawOptions { size, ..DrawOptions::default() }), DrawError::Size(size));
    }
    assert_eq!(refused(options(PictureSubject::Eye(Point2::new(0.0, f64::NAN)))), DrawError::NotFinite);
    assert!(matches!(svg_to_png("<svg"), Err(PngError::Svg(_))));
}
