//! Pictures show what the table says: colours are read back from the pixels.

use crate::common::{nothing, rooms};
use resvg::tiny_skia::Pixmap;
use sightlines_geometry::Point2;
use sightlines_pvs::{CellId, Locator, Table};
use sightlines_report::{DrawError, DrawOptions, PngError, View, plan_svg, svg_to_png};

type Rgb = [u8; 3];
const SEEN: Rgb = [0x8f, 0xc4, 0xf5];
const FROM: Rgb = [0xf0, 0x70, 0x1a];
const HIDDEN: Rgb = [0xec, 0xee, 0xf1];
const WALL: Rgb = [0x1c, 0x27, 0x33];

fn options(view: View) -> DrawOptions {
    DrawOptions { view, size: 820, objects: false, ..DrawOptions::default() }
}

/// Colours at points of the plan, which is 8 by 4 units: a hundred pixels less the margin for each.
fn colours<const N: usize>(table: &Table, options: &DrawOptions, points: [[f64; 2]; N]) -> [Rgb; N] {
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
    let from = |cell| options(View::Cell(CellId(cell)));
    assert_eq!(colours(&rooms(false), &from(0), INSIDE), [FROM, SEEN, HIDDEN]);
    assert_eq!(colours(&rooms(false), &from(1), INSIDE), [SEEN, FROM, HIDDEN]);
    assert_eq!(colours(&rooms(false), &from(2), INSIDE), [HIDDEN, HIDDEN, FROM]);
    // The impostor: one pair more, and the picture is another.
    assert_eq!(colours(&rooms(true), &from(0), INSIDE), [FROM, SEEN, SEEN]);
}

#[test]
fn an_eye_on_a_border_looks_from_both_cells() {
    let eye = |x, y| options(View::Eye(Point2::new(x, y)));
    assert_eq!(colours(&rooms(false), &eye(-1.0, 0.5), INSIDE), [FROM, SEEN, HIDDEN]);
    assert_eq!(colours(&rooms(false), &eye(-2.5, 2.0), INSIDE), [FROM, FROM, HIDDEN]);
    assert_eq!(colours(&rooms(false), &eye(99.0, 99.0), INSIDE), [HIDDEN; 3]);
}

#[test]
fn walls_are_dark_and_doors_are_not() {
    let at = [[-2.0, 2.0], [3.0, 2.0], [-0.5, 2.0]];
    let [left, right, door] = colours(&rooms(false), &options(View::Cell(CellId(2))), at);
    assert_eq!([left, right], [WALL, WALL]);
    assert_ne!(door, WALL);
}

#[test]
fn groups_are_tinted_if_asked() {
    let plain = DrawOptions { group_colours: false, ..options(View::Plan) };
    let [a, b, c] = colours(&rooms(false), &plain, INSIDE);
    assert!(a == b && b == c);
    let [a, b, c] = colours(&rooms(false), &options(View::Plan), INSIDE);
    assert!(a != b && b != c && a != c);
}

#[test]
fn marks_and_objects_are_drawn() {
    let mut all = DrawOptions { objects: true, ..options(View::Cell(CellId(0))) };
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
    let svg = |table: &Table| plan_svg(table, &options(View::Cell(CellId(2)))).unwrap();
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
    assert!(svg_to_png(&svg).is_ok() && !svg.contains("<path"));
    let stripped = rooms(false).strip_geometry();
    assert_ne!(colours(&stripped, &options(View::Plan), [[-2.0, 2.0]]), [WALL]);
}

#[test]
fn what_cannot_be_drawn_is_refused() {
    let refused = |options: DrawOptions| plan_svg(&rooms(false), &options).unwrap_err();
    let cell = refused(options(View::Cell(CellId(3))));
    assert_eq!(cell.to_string(), "there is no cell 3: the table has 3 cells");
    let target = DrawOptions { target: Some(CellId(8)), ..DrawOptions::default() };
    assert_eq!(refused(target), DrawError::NoSuchCell { cell: 8, n_cells: 3 });
    let marked = DrawOptions { marked_portals: vec![0, 1], ..DrawOptions::default() };
    assert_eq!(refused(marked), DrawError::NoSuchPortal { portal: 1, n_portals: 1 });
    for size in [0, 15, 8193, u32::MAX] {
        assert_eq!(refused(DrawOptions { size, ..DrawOptions::default() }), DrawError::Size(size));
    }
    assert_eq!(refused(options(View::Eye(Point2::new(0.0, f64::NAN)))), DrawError::NotFinite);
    assert!(matches!(svg_to_png("<svg"), Err(PngError::Svg(_))));
}
