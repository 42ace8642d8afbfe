//! Entities that are made of others: multilines, filled quadrangles and hatches, against lines that were written one by one.

use super::{lines, read};
use crate::common::dxf::Dxf;
use proptest::prelude::*;
use sightlines_formats::dxf::parse_dxf;
use sightlines_formats::{PlanFile, PlanReadOptions};

fn model(entities: &Dxf) -> Vec<u8> {
    entities.model(&Dxf::new())
}

/// A vertex of a multiline, its miter, and the numbers of each of its elements.
type Vertex<'v> = ([f64; 2], [f64; 2], &'v [&'v [f64]]);

fn multiline(flags: u8, vertices: &[Vertex<'_>]) -> Dxf {
    let begun = Dxf::new().entity("MLINE", "0").put(2, "STANDARD").put(40, 1).put(70, 0).put(71, flags);
    vertices.iter().fold(begun.at(10, [9.0, 9.0]).put(30, 0), |dxf, &(at, miter, elements)| {
        let dxf = dxf.at(11, at).put(31, 0).at(12, [1.0, 0.0]).put(32, 0).at(13, miter).put(33, 0);
        elements.iter().fold(dxf, |dxf, element| {
            element.iter().fold(dxf.put(74, element.len()), |dxf, x| dxf.put(41, x)).put(75, 0)
        })
    })
}

#[test]
fn multilines_are_the_lines_of_their_elements() {
    // Around a corner: the miter there is a diagonal, along which the elements are further apart.
    let (outer, inner): (&[f64], &[f64]) = (&[0.5, 0.0], &[-0.5, 0.0]);
    let both: &[&[f64]] = &[outer, inner];
    let corner = [([0.0, 0.0], [0.0, 1.0], both), ([4.0, 0.0], [1.0, 1.0], both), ([4.0, -3.0], [1.0, 0.0], both)];
    let two = [[0.0, 0.5, 4.5, 0.5], [0.0, -0.5, 3.5, -0.5], [4.5, 0.5, 4.5, -3.0], [3.5, -0.5, 3.5, -3.0]];
    assert_eq!(lines(&read(&model(&multiline(1, &corner)))), two);
    // Closed: back to the first vertex.
    let back = [[4.5, -3.0, 0.0, 0.5], [3.5, -3.0, 0.0, -0.5]];
    assert_eq!(lines(&read(&model(&multiline(1 | 2, &corner)))), [&two[..], &back].concat());
    // With breaks, such as at a door: from 1 to 3 the first element is not drawn, nor the second behind 2.
    let broken: &[&[f64]] = &[&[0.5, 0.0, 1.0, 3.0], &[-0.5, 0.0, 2.0]];
    let straight = |first| multiline(1, &[([0.0, 0.0], [0.0, 1.0], first), ([4.0, 0.0], [0.0, 1.0], both)]);
    let parts = [[0.0, 0.5, 1.0, 0.5], [3.0, 0.5, 4.0, 0.5], [0.0, -0.5, 2.0, -0.5]];
    assert_eq!(lines(&read(&model(&straight(broken)))), parts);
    // What begins behind its vertex is left out, whatever programs count its stops from.
    assert_eq!(lines(&read(&model(&straight(&[&[0.5, 1.0, 2.0], inner])))), [[0.0, -0.5, 4.0, -0.5]]);
    // What is no multiline is ignored, with a warning.
    let ends = ([4.0, 0.0], [0.0, 1.0], both);
    for wrong in [
        multiline(1, &[([0.0, 0.0], [0.0, 1.0], &[outer]), ends]),
        multiline(1, &[([0.0, 0.0], [0.0, 1.0], &[&[], inner]), ends]),
        multiline(1, &[ends]),
        Dxf::new().entity("MLINE", "0").at(11, [0.0, 0.0]).put(41, 1),
    ] {
        let file = read(&model(&wrong));
        assert_eq!(lines(&file), [[0.0; 4]; 0]);
        assert_eq!(file.warnings, ["ignored what is no line or curve: 1 MLINE that is not understood"]);
    }
    let mut file = model(&multiline(1, &corner));
    file.splice(0..0, *b"999\nby hand\n");
    assert_eq!(lines(&read(&file)), two);
}

/// The corners in the order in which a SOLID has them.
fn solid(kind: &str, corners: &[[f64; 2]]) -> Dxf {
    let codes = [10, 11, 12, 13].into_iter().zip(corners);
    codes.fold(Dxf::new().entity(kind, "0"), |dxf, (code, &corner)| dxf.at(code, corner))
}

#[test]
fn solids_are_their_outlines() {
    let outline = [[0., 0., 2., 0.], [2., 0., 2., 3.], [2., 3., 0., 3.], [0., 3., 0., 0.]];
    for kind in ["SOLID", "TRACE"] {
        assert_eq!(lines(&read(&model(&solid(kind, &[[0., 0.], [2., 0.], [0., 3.], [2., 3.]])))), outline);
    }
    // A triangle has its third corner twice, or no fourth one.
    let triangle = [[0., 0., 2., 0.], [2., 0., 0., 3.], [0., 3., 0., 0.]];
    for corners in [&[[0., 0.], [2., 0.], [0., 3.]][..], &[[0., 0.], [2., 0.], [0., 3.], [0., 3.]]] {
        assert_eq!(lines(&read(&model(&solid("SOLID", corners)))), triangle);
    }
    // The impostor: corners in the order around it make a bow tie, as programs draw them.
    assert_ne!(lines(&read(&model(&solid("SOLID", &[[0., 0.], [2., 0.], [2., 3.], [0., 3.]])))), outline);
    let mirrored = solid("SOLID", &[[0., 0.], [2., 0.], [0., 3.], [2., 3.]]).put(230, -1);
    assert_eq!(lines(&read(&model(&mirrored)))[1], [-2., 0., -2., 3.]);
    assert!(parse_dxf(&model(&solid("SOLID", &[[0., 0.], [2., 0.]])), &PlanReadOptions::default()).is_err());
}

/// A hatch on a layer; `borders` have all that is behind their number.
fn hatch(layer: &str, is_filled: bool, n: usize, borders: &Dxf) -> Dxf {
    let begun = Dxf::new().entity("HATCH", layer).at(10, [0.0, 0.0]).put(30, 0).put(230, 1);
    let begun = begun.put(2, "SOLID").put(70, u8::from(is_filled)).put(71, 0).put(91, n);
    // Seeds, which are points of no border.
    begun.add(borders).put(75, 1).put(76, 1).put(98, 1).at(10, [7.0, 7.0])
}

/// A polyline as a border, with the entities that it was made of.
fn polyline(closed: bool, vertices: &[([f64; 2], f64)]) -> Dxf {
    let begun = Dxf::new().put(92, 2 | 1).put(72, 1).put(73, u8::from(closed)).put(93, vertices.len());
    vertices.iter().fold(begun, |dxf, &(p, bulge)| dxf.at(10, p).put(42, bulge)).put(97, 1).put(330, "1A")
}

const SQUARE: [([f64; 2], f64); 4] = [([0.0, 0.0], 0.0), ([2.0, 0.0], 0.0), ([2.0, 2.0], 0.0), ([0.0, 2.0], 0.0)];

/// A half disk: a straight edge and an arc, counter-clockwise or clockwise.
fn half_disk(clockwise: bool) -> Dxf {
    let edges = Dxf::new().put(92, 1).put(93, 2).put(72, 1).at(10, [8.0, 0.0]).at(11, [4.0, 0.0]);
    let [start, end] = if clockwise { [180, 360] } else { [0, 180] };
    edges.put(72, 2).at(10, [6.0, 0.0]).put(40, 2).put(50, start).put(51, end).put(73, u8::from(!clockwise)).put(97, 0)
}

fn on(layers: &[&str], file: &[u8]) -> PlanFile {
    let layers = Some(layers.iter().map(ToString::to_string).collect());
    parse_dxf(file, &PlanReadOptions { layers, deviation: Some(10.0) }).unwrap()
}

/// Filled hatches are walls on layers that are asked for; else they may be floors.
#[test]
fn filled_hatches_are_walls_where_their_layer_is_asked_for() {
    let square = [[0., 0., 2., 0.], [2., 0., 2., 2.], [2., 2., 0., 2.], [0., 2., 0., 0.]];
    let borders = polyline(true, &SQUARE).add(&half_disk(false));
    let all = model(&hatch("Columns", true, 2, &borders).line("Walls", [0.0, 9.0], [1.0, 9.0]));
    let found = on(&["columns"], &all);
    assert_eq!(lines(&found)[..4], square);
    // The straight side, and the disk's through its top.
    let disk = [[8., 0., 4., 0.], [8., 0., 6., 2.], [6., 2., 4., 0.]];
    assert_eq!(lines(&found)[4..], disk);
    assert!(found.warnings.is_empty());
    assert_eq!(lines(&on(&["Walls"], &all)), [[0., 9., 1., 9.]]);
    // The twin: without a choice of layers nothing of it is a wall, and a warning says so.
    let file = read(&all);
    assert_eq!(lines(&file), [[0., 9., 1., 9.]]);
    assert_eq!(file.warnings, ["ignored what is no line or curve: 1 HATCH"]);
    // Impostors: one with a pattern, one with an edge of another kind, and one that breaks off.
    let ellipse = Dxf::new().put(92, 1).put(93, 1).put(72, 3).at(10, [0.0, 0.0]).at(11, [1.0, 0.0]).put(40, 0.5);
    let short = Dxf::new().put(92, 2).put(72, 0).put(73, 1).put(93, 4).at(10, [0.0, 0.0]).at(10, [1.0, 0.0]);
    let wrong = Dxf::new().put(92, 2).put(72, 0).put(73, 1).put(93, "x");
    for (is_filled, n, borders) in
        [(false, 2, &borders), (true, 1, &ellipse), (true, 1, &short), (true, 3, &borders), (true, 1, &wrong)]
    {
        let file = on(&["Columns"], &model(&hatch("Columns", is_filled, n, borders)));
        assert_eq!((lines(&file).len(), file.warnings.len()), (0, 1));
    }
    // Clockwise, the angles are those of a mirrored disk; the arc is the same.
    let other = on(&["0"], &model(&hatch("0", true, 1, &half_disk(true))));
    assert_eq!(lines(&other), disk);
}

proptest! {
    /// In a block that is moved and turned, the parts are where lines of the same ends are.
    #[test]
    fn parts_are_placed_as_their_lines_are(at in prop::array::uniform2(-4..5_i32), turn in 0..4_i32, mirror in any::<bool>()) {
        let place = |blocks: &Dxf| {
            let insert = Dxf::new().insert("B", at.map(f64::from)).put(50, 90 * turn).put(41, if mirror { -1 } else { 1 });
            on(&["0"], &insert.model(&blocks.as_block("B", [1.0, 0.0])))
        };
        let quad = [[0., 0.], [2., 0.], [0., 3.], [2., 3.]];
        let both: &[&[f64]] = &[&[0.5, 0.0], &[-0.5, 0.0]];
        let parts = solid("SOLID", &quad)
            .add(&multiline(1, &[([0.0, 6.0], [0.0, 1.0], both), ([4.0, 6.0], [0.0, 1.0], both)]))
            .add(&hatch("0", true, 1, &polyline(true, &SQUARE[..3])));
        let one_by_one = [
            [0., 0., 2., 0.], [2., 0., 2., 3.], [2., 3., 0., 3.], [0., 3., 0., 0.], [0., 6.5, 4., 6.5], [0., 5.5, 4., 5.5],
            [2., 0., 2., 2.], [2., 2., 0., 0.],
        ];
        let written = one_by_one.iter().fold(Dxf::new(), |dxf, l| dxf.line("0", [l[0], l[1]], [l[2], l[3]]));
        // The side that the hatch and the quadrangle share is one wall.
        prop_assert_eq!(lines(&place(&parts)), lines(&place(&written)));
        prop_assert_ne!(lines(&place(&parts)), lines(&place(&written.line("0", [7.0, 7.0], [8.0, 8.0]))));
    }
}
