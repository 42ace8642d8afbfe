//! Every entity that is read, in numbers that are exact.

use super::{lines, read, refused, vertices};
use crate::common::dxf::Dxf;
use sightlines_formats::dxf::parse_dxf;
use sightlines_formats::{DroppedLines, PlanReadOptions};

fn model(entities: &Dxf) -> Vec<u8> {
    entities.model(&Dxf::new())
}

const SQUARE: [([f64; 2], f64); 4] = [([0.0, 0.0], 0.0), ([2.0, 0.0], 0.0), ([2.0, 2.0], 0.0), ([0.0, 2.0], 0.0)];

#[test]
fn lines_are_taken_bit_by_bit() {
    let file = read(&model(&Dxf::new().line("A", [0.1, -0.0], [1e-5, 565432.123]).line("B", [0.3, 0.0], [0.0, 0.0])));
    assert_eq!(lines(&file), [[0.1, 0.0, 1e-5, 565432.123], [0.3, 0.0, 0.0, 0.0]]);
    assert!(file.plan.lines().iter().all(|line| line.opaque));
    assert_eq!((file.layers, file.warnings, file.crs), (vec!["A".to_owned(), "B".to_owned()], vec![], None));
}

#[test]
fn polylines_of_old_and_new_versions_are_the_same() {
    let square = [[0., 0., 2., 0.], [2., 0., 2., 2.], [2., 2., 0., 2.], [0., 2., 0., 0.]];
    for (closed, n) in [(true, 4), (false, 3)] {
        for dxf in [Dxf::new().path(closed, &SQUARE), Dxf::new().old_path(closed, &SQUARE)] {
            assert_eq!(lines(&read(&model(&dxf))), square[..n]);
        }
    }
    // In space: heights do not matter, and bulges mean nothing.
    let in_space = Dxf::new().entity("POLYLINE", "0").put(70, 8 | 1).put(230, -1);
    let vertex =
        |dxf: Dxf, (k, &(p, _)): (usize, &([f64; 2], f64))| dxf.entity("VERTEX", "0").at(10, p).put(30, k).put(42, 1);
    let in_space = SQUARE.iter().enumerate().fold(in_space, vertex).put(0, "SEQEND");
    assert_eq!(lines(&read(&model(&in_space))), square);
    // A smoothed one has its control points beside those of the curve.
    let smooth = Dxf::new().entity("POLYLINE", "0").put(70, 4).entity("VERTEX", "0").at(10, [9.0, 9.0]).put(70, 16);
    let smooth =
        SQUARE.iter().fold(smooth, |dxf, &(p, _)| dxf.entity("VERTEX", "0").at(10, p).put(70, 8)).put(0, "SEQEND");
    assert_eq!(lines(&read(&model(&smooth))), square[..3]);
}

#[test]
fn a_coarse_circle_is_its_four_points() {
    let options = PlanReadOptions { deviation: Some(10.0), ..PlanReadOptions::default() };
    let circle = |radius: f64| {
        let circle = Dxf::new().entity("CIRCLE", "0").at(10, [3.0, 1.0]).put(40, radius);
        parse_dxf(&model(&circle), &options).unwrap()
    };
    assert_eq!(vertices(&circle(2.0)), [[5., 1.], [3., 3.], [1., 1.], [3., -1.], [5., 1.]]);
    assert_eq!(circle(0.0).dropped, DroppedLines { n_without_length: 1, n_doubled: 0 });
    let arc = |start: f64, end: f64, normal: i8| {
        let arc = Dxf::new().entity("ARC", "0").at(10, [3.0, 1.0]).put(40, 2);
        parse_dxf(&model(&arc.put(50, start).put(51, end).put(230, normal)), &options)
            .map(|file| vertices(&file))
            .unwrap()
    };
    assert_eq!(arc(90.0, 180.0, 1), [[3., 3.], [1., 1.]]);
    assert_eq!(arc(270.0, 90.0, 1), [[3., -1.], [5., 1.], [3., 3.]]);
    assert_eq!(arc(-90.0, 450.0, 1), arc(270.0, 90.0, 1));
    assert_eq!(arc(90.0, 90.0, 1).len(), 5);
    // Seen from below: x is mirrored, the centre's too.
    assert_eq!(arc(90.0, 180.0, -1), [[-3., 3.], [-1., 1.]]);
    // Half a circle as a bulge, to the right of its chord if it is positive.
    let half = |bulge: f64| {
        vertices(&parse_dxf(&model(&Dxf::new().path(false, &[([0., 0.], bulge), ([4., 0.], 0.)])), &options).unwrap())
    };
    assert_eq!([half(1.0), half(-1.0)], [[[0., 0.], [2., -2.], [4., 0.]], [[0., 0.], [2., 2.], [4., 0.]]]);
    let ellipse = Dxf::new().entity("ELLIPSE", "0").at(10, [1.0, 1.0]).at(11, [0.0, 4.0]).put(40, 0.5);
    let whole = |to: f64, normal: i8| {
        let dxf = ellipse.clone().put(41, 0).put(42, to).put(230, normal);
        vertices(&parse_dxf(&model(&dxf), &options).unwrap())
    };
    let round = [[1., 5.], [-1., 1.], [1., -3.], [3., 1.], [1., 5.]];
    // A whole turn as drawings write it: with all digits, six or fourteen.
    for full in ["6.283185307179586", "6.283185", "6.28318530717959"].map(|text| text.parse::<f64>().unwrap()) {
        assert_eq!(whole(full, 1), round);
    }
    // The direction in which it turns is that of the extrusion; its centre and axes are the world's.
    let back: Vec<_> = round.iter().rev().copied().collect();
    assert_eq!(whole(std::f64::consts::TAU, -1), back);
}

#[test]
fn entities_seen_from_below_are_mirrored() {
    let below = Dxf::new().path(true, &SQUARE).put(210, 0).put(220, 0).put(230, -1);
    let mirrored = [[0., 0., -2., 0.], [-2., 0., -2., 2.], [-2., 2., 0., 2.], [0., 2., 0., 0.]];
    assert_eq!(lines(&read(&model(&below))).map_zero(), mirrored);
    // Lines are in the world's coordinates, whatever their extrusion.
    let line = Dxf::new().line("0", [1.0, 2.0], [3.0, 4.0]).put(230, -1);
    assert_eq!(lines(&read(&model(&line))), [[1., 2., 3., 4.]]);
    // A wall that stands upright as an entity of its own plane: seen from above it is a line.
    let upright = Dxf::new().path(true, &SQUARE).put(210, 0).put(220, -1).put(230, 0);
    let file = read(&model(&upright));
    assert_eq!((lines(&file).map_zero(), file.dropped.n_doubled), (vec![[0., 0., 2., 0.]], 1));
    let error = refused(&model(&Dxf::new().path(true, &SQUARE).put(230, 0)));
    assert_eq!(error.what, "an extrusion direction is 0, which cannot be");
}

/// Numbers without negative zeros.
trait MapZero {
    fn map_zero(self) -> Vec<[f64; 4]>;
}

impl MapZero for Vec<[f64; 4]> {
    fn map_zero(self) -> Vec<[f64; 4]> {
        self.into_iter().map(|line| line.map(|x| x + 0.0)).collect()
    }
}

#[test]
fn lines_without_length_and_doubled_ones_are_dropped() {
    let dxf = Dxf::new()
        .line("A", [0.0, 0.0], [1.0, 0.0])
        .line("B", [1.0, 0.0], [0.0, 0.0])
        .line("A", [2.0, 0.0], [2.0, 0.0])
        .entity("LINE", "A")
        .at(10, [3.0, 3.0])
        .put(30, 0)
        .at(11, [3.0, 3.0])
        .put(31, 2.5)
        .path(true, &[([5.0, 5.0], 0.0)])
        .path(false, &[([0.0, 0.0], 0.0), ([0.0, 0.0], 0.0), ([1.0, 0.0], 0.0), ([1.0, 1.0], 0.0)]);
    let file = read(&model(&dxf));
    assert_eq!(lines(&file), [[0., 0., 1., 0.], [1., 0., 1., 1.]]);
    assert_eq!(file.dropped, DroppedLines { n_without_length: 3, n_doubled: 2 });
    assert_eq!(file.warnings, ["dropped 3 lines without length", "dropped 2 lines that repeat others"]);
}

#[test]
fn everything_else_is_ignored_and_counted() {
    let mut dxf = Dxf::new().line("0", [0.0, 0.0], [1.0, 0.0]);
    for (kind, n) in [("TEXT", 3), ("HATCH", 2), ("DIMENSION", 1), ("3DFACE", 1)] {
        for _ in 0..n {
            dxf = dxf.entity(kind, "0").at(10, [0.0, 0.0]).at(11, [5.0, 5.0]).put(1, "LINE");
        }
    }
    dxf = dxf.entity("POLYLINE", "0").put(70, 64).entity("VERTEX", "0").put(0, "SEQEND");
    dxf = dxf.entity("SPLINE", "0").put(71, 3).put(74, 2).at(11, [0.0, 0.0]).at(11, [1.0, 1.0]);
    let file = read(&model(&dxf));
    assert_eq!(file.plan.lines().len(), 1);
    let expected = "ignored what is no line or curve: 1 3DFACE, 1 DIMENSION, 2 HATCH, 1 POLYLINE (mesh), \
        1 SPLINE without control points, 3 TEXT";
    assert_eq!(file.warnings, [expected]);
}

#[test]
fn errors_name_the_line() {
    let error = |bytes: &[u8]| refused(bytes).to_string();
    let with = |text: &str| error(format!("0\nSECTION\n2\nENTITIES\n{text}0\nENDSEC\n0\nEOF\n").as_bytes());
    assert_eq!(with("0\nLINE\n10\nx\n"), "line 8: this is no finite number");
    assert_eq!(with("0\nLINE\n10\nnan\n"), "line 8: this is no finite number");
    assert_eq!(with("0\nLINE\n10\n1\n20\n2\n"), "line 6: the LINE has no end");
    assert_eq!(
        with("0\nLINE\n10\n1e99\n20\n2\n11\n3\n21\n4\n"),
        "line 6: coordinate 1e99 is neither 0 nor between 2^-140 and 2^200 in magnitude"
    );
    assert_eq!(with("0\nCIRCLE\n10\n1\n20\n2\n40\n-3\n"), "line 6: a radius is -3, which cannot be");
    assert_eq!(with("LINE\n0\n"), "line 5: this is no group code, which is a whole number");
    assert_eq!(with("8\n0\n"), "line 6: expected a group with the code 0");
    assert_eq!(with("0\nPOLYLINE\n0\nLINE\n"), "line 8: expected VERTEX or SEQEND");
    assert_eq!(with("0\nINSERT\n2\nDoor\n10\n0\n20\n0\n"), "line 6: there is no block \"Door\"");
    assert_eq!(
        with("0\nSPLINE\n71\n3\n10\n0\n20\n0\n"),
        "line 6: the spline is malformed: there are no more control points than its degree"
    );
    assert_eq!(
        error(b"AutoCAD Binary DXF\r\n\x1a\0"),
        "this is binary DXF, which is not read: save it as text (ASCII)"
    );
    let cut = "drawing ends without EOF, so that a part of it may be missing";
    assert_eq!(error(b"0\nSECTION\n2\nENTITIES\n0\nENDSEC\n"), format!("line 6: the {cut}"));
    assert_eq!(error(b""), format!("line 1: the {cut}"));
    assert_eq!(error(b"0\nSECTION\n2\nENTITIES\n0\nEOF\n"), "line 6: expected the end of the section before EOF");
    assert_eq!(error(b"0\nLINE\n"), "line 2: expected SECTION or EOF");
    // Lines may end as on any system, and be indented.
    let crlf = b"  0\r\nSECTION\r\n  2\r\nENTITIES\r\n  0\r\nENDSEC\r\n  0\r\nEOF\r\n\x1a";
    assert!(read(crlf).plan.lines().is_empty());
    for deviation in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let options = PlanReadOptions { deviation: Some(deviation), ..PlanReadOptions::default() };
        let error = parse_dxf(crlf, &options).unwrap_err().to_string();
        assert_eq!(error, format!("{deviation} is no deviation of curves, which is a number above 0"));
    }
}
