//! Tables that stand along axes of their own.

use crate::common::file::File;
use proptest::prelude::*;
use sightlines_pvs::{
    BitMatrix, CellId, CellRecord, DecodeErrorKind, Frame, FrameError, Locator, Table, TableError, TableKind,
    TableParts,
};

/// Turned about z by an angle with the tangent `t / 8`.
fn turned(t: i32, gap: f64) -> Frame {
    let (x, y) = (8.0, f64::from(t));
    let length = (x * x + y * y).sqrt();
    let (c, s) = (x / length, y / length);
    Frame::new([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]], gap).expect("a frame")
}

/// A row of four boxes, two units long each, along the axes of a frame.
fn row(frame: Option<Frame>) -> TableParts {
    let cell = |i: u32| {
        let x = 2.0 * f64::from(i);
        CellRecord { min: [x, 0.0, 0.0], max: [x + 2.0, 3.0, 4.0], group: None, polygon: Vec::new() }
    };
    let cells: Vec<CellRecord> = (0..4).map(cell).collect();
    let bounds: Vec<_> = cells.iter().map(|c| (c.min, c.max)).collect();
    TableParts {
        rows: BitMatrix::identity(4),
        cell_objects: vec![Vec::new(); 4],
        locator: Locator::build(&bounds, 3),
        cells,
        frame,
        ..TableParts::empty(3, TableKind::Unspecified)
    }
}

proptest! {
    /// Invariant: a point of the scene is found in the cells that contain it along the frame, in all within the gap, and in no others
    /// beyond rounding; boxes touch what their points are in.
    #[test]
    fn points_of_the_scene_are_located(t in -20i32..20, p in [-1.0f64..9.0, -1.0f64..4.0, -1.0f64..5.0], gap in 0.0f64..0.2) {
        let frame = turned(t, gap);
        let table = Table::new(row(Some(frame))).expect("a table");
        let p = frame.to_scene(p);
        let along = frame.to_frame(p);
        // How far each cell is, along the axis where it is farthest.
        let off = |c: &CellRecord| (0..3).map(|k| (c.min[k] - along[k]).max(along[k] - c.max[k])).fold(f64::MIN, f64::max);
        let found = table.place_at(p).cells().to_vec();
        for (id, cell) in (0u32..).map(CellId).zip(table.cells()) {
            let off = off(cell);
            prop_assert!(off > gap || found.contains(&id), "{} is {} away", id, off);
            prop_assert!(off < gap + 1e-12 || !found.contains(&id), "{} is {} away", id, off);
        }
        let (low, high) = (p.map(|x| x - 0.3), p.map(|x| x + 0.4));
        let mut touched = Vec::new();
        table.for_each_touching(low, high, &mut Vec::new(), |cell| { touched.push(cell); true });
        prop_assert!(found.iter().all(|cell| touched.contains(cell)));
    }
}

#[test]
fn frames_are_stored() {
    let plain = Table::new(row(None)).expect("a table");
    let table = Table::new(row(Some(turned(3, 0.125)))).expect("a table");
    let bytes = table.to_bytes();
    assert_eq!((bytes[10], plain.to_bytes()[10]), (5, 0), "the minor version");
    assert_eq!(Table::from_bytes(&bytes), Ok(table.clone()));
    assert_eq!(table.clone().with_frame(None), Ok(plain.clone()));
    assert_eq!(plain.clone().with_frame(table.frame().copied()), Ok(table.clone()));
    // Without the frame the same point is elsewhere.
    let p = turned(3, 0.125).to_scene([7.0, 2.9, 1.0]);
    assert_ne!(table.place_at(p).cells(), plain.place_at(p).cells());
    // Who does not have frames must not skip the section.
    let mut file = File::parse(&bytes);
    assert_eq!(file.part(b"FRAM").flags, 0);
    file.part(b"FRAM").id = *b"FRAX";
    assert_eq!(Table::from_bytes(&file.write()).expect_err("needed").kind, DecodeErrorKind::Unknown);
}

#[test]
fn damaged_frames_are_refused() {
    let table = Table::new(row(Some(turned(3, 0.125)))).expect("a table");
    for (at, value) in [(0, f64::NAN), (0, 2.0), (72, -1.0), (72, f64::INFINITY)] {
        let mut file = File::parse(&table.to_bytes());
        file.part(b"FRAM").bytes[at..at + 8].copy_from_slice(&value.to_le_bytes());
        let error = Table::from_bytes(&file.write()).expect_err("no frame");
        assert_eq!(error.section.map(|id| id.0), Some(*b"FRAM"));
        assert!(matches!(error.kind, DecodeErrorKind::Table(TableError::Frame(_))), "{error}");
    }
    let flat = TableParts { frame: table.frame().copied(), ..crate::common::rooms() };
    assert_eq!(Table::new(flat), Err(TableError::Frame(FrameError::Plane)));
}
