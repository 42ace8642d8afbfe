//! Clipped inserts (XCLIP), against points of the block that are inside of the clip by another method; and clips that are not understood.

use super::{lines, read};
use crate::common::dxf::Dxf;
use proptest::prelude::*;

/// An insert whose extension dictionary has this handle.
pub(super) fn clipped(insert: &Dxf, handle: u32) -> Dxf {
    insert.clone().put(102, "{ACAD_XDICTIONARY").put(360, format!("{handle:X}")).put(102, "}")
}

pub(super) const IDENTITY: [f64; 12] = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0];

/// The objects that clip the insert with this handle; `change` is put into the clip before its maps.
pub(super) fn filter(handle: u32, corners: &[[f64; 2]], change: &Dxf, maps: [[f64; 12]; 2]) -> Dxf {
    let dictionary = |own: u32, key: &str, entry: u32| {
        Dxf::new().put(0, "DICTIONARY").put(5, format!("{own:X}")).put(3, key).put(350, format!("{entry:X}"))
    };
    let clip = Dxf::new().put(0, "SPATIAL_FILTER").put(5, format!("{:X}", handle + 2)).put(70, corners.len());
    let clip = corners.iter().fold(clip, |dxf, &corner| dxf.at(10, corner)).add(change);
    let clip = maps.as_flattened().iter().fold(clip, |dxf, number| dxf.put(40, number));
    dictionary(handle, "ACAD_FILTER", handle + 1).add(&dictionary(handle + 1, "SPATIAL", handle + 2)).add(&clip)
}

/// A file with these blocks, entities of the model and objects.
pub(super) fn file(blocks: &Dxf, model: &Dxf, objects: &Dxf) -> Vec<u8> {
    let sections = [("BLOCKS", blocks), ("ENTITIES", model), ("OBJECTS", objects)];
    sections.iter().fold(Dxf::new(), |dxf, (name, section)| dxf.add(&section.as_section(name))).as_file()
}

/// A line across, in a block whose base is not its origin.
fn partition() -> Dxf {
    Dxf::new().line("0", [2.0, 1.0], [2.0, 7.0]).as_block("P", [2.0, 1.0])
}

const ALL: [f64; 4] = [5.0, 0.0, 5.0, 6.0];

/// The line of an insert at (5, 0) with one clip; and the warnings.
fn one(insert: &Dxf, corners: &[[f64; 2]], change: &Dxf, maps: [[f64; 12]; 2]) -> (Vec<[f64; 4]>, Vec<String>) {
    let model = clipped(insert, 0x34).line("0", [0.0, 0.0], [9.0, 0.0]);
    let read = read(&file(&partition(), &model, &filter(0x34, corners, change, maps)));
    let all = lines(&read);
    assert_eq!((all.last(), &read.dropped.n_without_length), (Some(&[0.0, 0.0, 9.0, 0.0]), &0));
    (all[..all.len() - 1].to_vec(), read.warnings)
}

fn at_five() -> Dxf {
    Dxf::new().insert("P", [5.0, 0.0])
}

#[test]
fn what_is_clipped_away_is_no_wall() {
    let show = |corners: &[[f64; 2]]| {
        let (lines, warnings) = one(&at_five(), corners, &Dxf::new().put(71, 1), [IDENTITY; 2]);
        assert_eq!(warnings, [""; 0]);
        lines
    };
    // Two corners are a box, in any order.
    for corners in [[[0.0, 0.0], [4.0, 3.0]], [[4.0, 3.0], [0.0, 0.0]], [[0.0, 3.0], [4.0, 0.0]]] {
        assert_eq!(show(&corners), [[5.0, 0.0, 5.0, 2.0]]);
    }
    assert_eq!(show(&[[0.0, 3.0], [4.0, 4.0]]), [[5.0, 2.0, 5.0, 3.0]]);
    assert_eq!(show(&[[0.0, 0.0], [4.0, 9.0]]), [ALL]);
    assert_eq!(show(&[[3.0, 0.0], [4.0, 9.0]]), [[0.0; 4]; 0]);
    // What lies on the border is drawn, whichever side of the clip that is.
    assert_eq!(show(&[[2.0, 0.0], [4.0, 9.0]]), [ALL]);
    assert_eq!(show(&[[0.0, 0.0], [2.0, 9.0]]), [ALL]);
    // A triangle, and a shape that the line leaves and enters again, in both directions.
    assert_eq!(show(&[[2.0, 0.0], [4.0, 4.0], [0.0, 4.0]]), [[5.0, 0.0, 5.0, 3.0]]);
    let mut comb = vec![[0.0, 0.0], [4.0, 0.0], [4.0, 8.0], [0.0, 8.0], [0.0, 5.0], [3.0, 5.0], [3.0, 3.0], [0.0, 3.0]];
    let teeth = [[5.0, 0.0, 5.0, 2.0], [5.0, 4.0, 5.0, 6.0]];
    assert_eq!(show(&comb), teeth);
    comb.reverse();
    assert_eq!(show(&comb), teeth);
    // Inverted: the rest, with a slit from the hole to its border.
    let (hole, outer) =
        ([[1.0, 3.0], [3.0, 3.0], [3.0, 5.0], [1.0, 5.0]], [[0.0, 0.0], [9.0, 0.0], [9.0, 9.0], [0.0, 9.0]]);
    let inverted: Vec<[f64; 2]> = hole.into_iter().chain([hole[0]]).chain(outer).chain([outer[0]]).collect();
    assert_eq!(show(&inverted), teeth);
}

#[test]
fn clips_that_are_off_show_all_and_others_are_where_they_were_made() {
    let corners = [[0.0, 0.0], [4.0, 3.0]];
    assert_eq!(one(&at_five(), &corners, &Dxf::new().put(71, 0), [IDENTITY; 2]), (vec![ALL], vec![]));
    let below = vec![[5.0, 0.0, 5.0, 2.0]];
    // Where the insert was when it was clipped counts, not where it is.
    let to_block = [0.0, 1.0, 0.0, 2.0, -1.0, 0.0, 0.0, 11.0, 0.0, 0.0, 1.0, 0.0];
    // The block's (0, 0) and (4, 3) were at (11, -2) and (8, 2).
    let found = one(&at_five(), &[[11.0, -2.0], [8.0, 2.0]], &Dxf::new(), [to_block, IDENTITY]);
    assert_eq!(found, (below, vec![]));
}

/// A clip that was inverted, of which these polygons are stored: in the clip, as what was inverted, and as the rest.
fn inverted([own, hole, rest]: [&[[f64; 2]]; 3]) -> (Vec<[f64; 4]>, Vec<String>) {
    let points = |dxf: Dxf, all: &[[f64; 2]]| all.iter().fold(dxf, |dxf, &p| dxf.at(10, p).put(30, 0));
    let leads = Dxf::new().put(102, "{ACAD_XDICTIONARY").put(360, "90").put(102, "}").put(71, 1);
    let dictionary = Dxf::new().put(0, "DICTIONARY").put(5, "90").put(3, "ACAD_XREC_ROUNDTRIP").put(360, "91");
    let record = Dxf::new().put(0, "XRECORD").put(5, "91").put(280, 1).put(102, "ACAD_INVERTEDCLIP_ROUNDTRIP");
    let record = points(points(record, hole).put(102, "ACAD_INVERTEDCLIP_ROUNDTRIP_COMPARE"), rest);
    let objects = dictionary.add(&record).add(&filter(0x34, own, &leads, [IDENTITY; 2]));
    let read = read(&file(&partition(), &clipped(&at_five(), 0x34), &objects));
    (lines(&read), read.warnings)
}

/// What an inverted clip hides is inside of the polygon that was inverted, however it is stored; what contradicts itself is left out.
#[test]
fn inverted_clips_hide_what_is_inside() {
    let hole = [[1.0, 3.0], [3.0, 3.0], [3.0, 5.0], [1.0, 5.0]];
    let outer = [[0.0, 0.0], [9.0, 0.0], [9.0, 9.0], [0.0, 9.0]];
    let rest: Vec<[f64; 2]> = hole.into_iter().chain([hole[0]]).chain(outer).chain([outer[0]]).collect();
    let teeth = [[5.0, 0.0, 5.0, 2.0], [5.0, 4.0, 5.0, 6.0]];
    for stored in [[&rest[..], &hole, &rest], [&hole, &hole, &rest], [&hole, &hole, &hole], [&hole, &hole, &[]]] {
        assert_eq!(inverted(stored), (teeth.to_vec(), vec![]));
    }
    // A box by two of its corners; and one beside the line, which is drawn whole, bit by bit, or around it.
    let corners = [[1.0, 3.0], [3.0, 5.0]];
    assert_eq!(inverted([&corners, &corners, &rest]).0, teeth);
    assert_eq!(inverted([&[[3.0, 0.0], [4.0, 9.0]]; 3]).0, [ALL]);
    assert_eq!(inverted([&[[0.0, 0.0], [4.0, 9.0]]; 3]).0, [[0.0; 4]; 0]);
    // Impostors: without the record the same polygon shows what is inside; with another one nothing is known.
    assert_eq!(one(&at_five(), &hole, &Dxf::new().put(71, 1), [IDENTITY; 2]).0, [[5.0, 2.0, 5.0, 4.0]]);
    for stored in [[&hole[..], &outer, &rest], [&outer, &hole, &rest], [&hole, &[], &[]]] {
        let (lines, warnings) = inverted(stored);
        assert_eq!(
            (lines.len(), &warnings[..]),
            (0, &["left out inserts whose clip (XCLIP) is not understood: 1 of P".to_owned()][..])
        );
    }
}

/// What may be clipped away hides nothing.
#[test]
fn inserts_whose_clip_is_not_understood_are_left_out() {
    let corners = [[0.0, 0.0], [4.0, 3.0]];
    let mut moved = IDENTITY;
    moved[3] = 1.0;
    let on = Dxf::new().put(71, 1);
    let rows = at_five().put(71, 2).put(45, 10);
    let tilted = at_five().put(210, 1).put(220, 0).put(230, 1);
    for (insert, corners, change, maps) in [
        (at_five(), &corners[..], on.clone().put(210, 1), [IDENTITY; 2]),
        (at_five(), &corners, on.clone(), [IDENTITY, moved]),
        (at_five(), &corners, on.clone().put(72, 1).put(40, 3), [IDENTITY; 2]),
        (at_five(), &corners, on.clone().put(73, 1).put(41, -3), [IDENTITY; 2]),
        (at_five(), &corners[..1], on.clone(), [IDENTITY; 2]),
        (at_five(), &corners, on.clone().put(10, 5), [IDENTITY; 2]),
        (at_five(), &corners, on.clone().put(20, "x"), [IDENTITY; 2]),
        (rows, &corners, on.clone(), [IDENTITY; 2]),
        (tilted, &corners, on, [IDENTITY; 2]),
    ] {
        let (lines, warnings) = one(&insert, corners, &change, maps);
        assert_eq!(lines, [[0.0; 4]; 0]);
        assert_eq!(warnings, ["left out inserts whose clip (XCLIP) is not understood: 1 of P"]);
    }
    // A filter that is not there; but a dictionary of something else, or one that is not there, is no clip.
    let of = |objects: &Dxf| {
        lines(&read(&file(&partition(), &clipped(&at_five(), 0x34).line("0", [0.0; 2], [9.0, 0.0]), objects)))
    };
    let dictionary = |own: u8, key: &str| Dxf::new().put(0, "DICTIONARY").put(5, own).put(3, key).put(350, own + 1);
    assert_eq!(of(&dictionary(34, "ACAD_FILTER")).len(), 1);
    assert_eq!(of(&dictionary(34, "ACAD_FILTER").add(&dictionary(35, "SPATIAL"))).len(), 1);
    assert_eq!(of(&dictionary(34, "ACAD_FILTER").add(&dictionary(35, "LAYER"))).len(), 2);
    assert_eq!(of(&dictionary(34, "ACAD_GROUP")).len(), 2);
    assert_eq!(of(&Dxf::new()).len(), 2);
}

/// A curve is clipped as well, and what is clipped away does not make its pieces coarser.
#[test]
fn curves_are_clipped() {
    let circle = Dxf::new().entity("CIRCLE", "0").at(10, [0.0, 0.0]).put(40, 1).line("0", [-1e6, 5.0], [1e6, 5.0]);
    let of = |corners: &[[f64; 2]]| {
        let model = clipped(&Dxf::new().insert("C", [0.0, 0.0]), 0x34);
        lines(&read(&file(
            &circle.as_block("C", [0.0, 0.0]),
            &model,
            &filter(0x34, corners, &Dxf::new(), [IDENTITY; 2]),
        )))
    };
    let half = of(&[[0.0, -2.0], [2.0, 2.0]]);
    assert!(half.len() > 40, "{}", half.len());
    assert!(half.iter().all(|l| l[0] >= 0.0 && l[2] >= 0.0 && (l[0].hypot(l[1]) - 1.0).abs() < 1e-3));
    let length: f64 = half.iter().map(|l| (l[2] - l[0]).hypot(l[3] - l[1])).sum();
    // What is near the border of the clip is left out: there a piece may be drawn whose curve is not.
    let missing = std::f64::consts::PI - length;
    assert!(missing > 0.0 && missing < 3.0 * std::f64::consts::PI / half.len() as f64, "{length}");
    // A line is clipped exactly.
    let line = of(&[[-2.0, 4.0], [2.0, 6.0]]);
    assert_eq!(line, [[-2.0, 5.0, 2.0, 5.0]]);
}

/// Where an insert puts a point: scaled, turned by quarters, moved; from the origin of the block.
#[derive(Debug, Clone, Copy)]
struct Placed {
    at: [f64; 2],
    scale: [f64; 2],
    quarters: u8,
}

impl Placed {
    fn insert(&self, block: &str) -> Dxf {
        let turned = Dxf::new().insert(block, self.at).put(41, self.scale[0]).put(42, self.scale[1]);
        turned.put(50, 90 * i32::from(self.quarters))
    }

    fn point(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let scaled = [x * self.scale[0], y * self.scale[1]];
        let [x, y] = (0..self.quarters).fold(scaled, |[x, y], _| [-y, x]);
        [x + self.at[0], y + self.at[1]]
    }
}

fn placed() -> impl Strategy<Value = Placed> {
    let whole = || (-8i8..8).prop_map(f64::from);
    let scale = || prop::sample::select(vec![1.0, -1.0, 2.0, -0.5]);
    ([whole(), whole()], [scale(), scale()], 0u8..4).prop_map(|(at, scale, quarters)| Placed { at, scale, quarters })
}

proptest! {
    /// Invariant: of a line in a clipped block in a clipped block exactly those points are drawn that both boxes show. The block has a line along x
    /// only, so that points of it are numbers.
    #[test]
    fn nested_and_turned_clips_show_what_both_show(
        outer in placed(),
        inner in placed(),
        boxes in prop::array::uniform2((-9i8..9, -9i8..9, 1i8..9, 1i8..9)),
    ) {
        let [of_inner, of_outer] = boxes.map(|(x, y, dx, dy)| {
            [[f64::from(x) + 0.25, f64::from(y) + 0.25], [f64::from(x + dx) + 0.25, f64::from(y + dy) + 0.25]]
        });
        let leaf = Dxf::new().line("0", [-9.0, 0.0], [9.0, 0.0]).as_block("Leaf", [0.0; 2]);
        let twig = clipped(&inner.insert("leaf"), 0x40).as_block("Twig", [0.0; 2]);
        let model = clipped(&outer.insert("twig"), 0x50).line("0", [500.0, 0.0], [501.0, 0.0]);
        let on = Dxf::new().put(71, 1);
        let objects = filter(0x40, &of_inner, &on, [IDENTITY; 2]).add(&filter(0x50, &of_outer, &on, [IDENTITY; 2]));
        let drawn = lines(&read(&file(&leaf.add(&twig), &model, &objects)));
        let inside = |p: [f64; 2], [low, high]: [[f64; 2]; 2]| (0..2).all(|k| low[k] < p[k] && p[k] < high[k]);
        let mut n_shown = 0;
        for step in 0..144 {
            let p = [-8.9375 + f64::from(step) * 0.125, 0.0];
            let in_twig = inner.point(p);
            let is_shown = inside(p, of_inner) && inside(in_twig, of_outer);
            let [x, y] = outer.point(in_twig);
            let between = |a: f64, b: f64, x: f64| a.min(b) <= x && x <= a.max(b);
            let is_drawn = drawn.iter().any(|l| between(l[0], l[2], x) && between(l[1], l[3], y));
            prop_assert_eq!(is_shown, is_drawn, "{:?} {:?}", p, drawn);
            n_shown += usize::from(is_shown);
        }
        prop_assert_eq!(drawn.len(), 1 + usize::from(n_shown > 0));
    }
}
