//! What the premise of a frame closes, and what is noticed where it does not hold.

use super::{n_violations, rotation, slit, turn, turned, with};
use sightlines::bake::{Baked, Gap, bake};
use sightlines::cells::Point3;
use sightlines::pvs::{Frame, ObjectId, Table};
use sightlines::verify::{Truth, VerifyOptions, verify};

/// Whether the eye sees the thing at the other end.
fn sees_east(table: &Table, eye: Point3) -> bool {
    table.place_at(eye).inside().is_none_or(|at| at.visible_objects().contains(&ObjectId(2)))
}

/// Invariant: an opening wider than the gap stays open, one that is narrower may close. The impostor: a gap that closes a real opening is
/// noticed as soon as the table states another.
#[test]
fn a_gap_that_is_too_wide_is_noticed() {
    let rows = rotation(20.0, 0.0);
    let eye = turn(&rows, [0.5, 1.6, 0.5]);
    let detail = |gap| {
        let mut options = with(Gap::Width(gap));
        options.detail_below = Some(0.0);
        options
    };
    let scene = turned(&slit(0.25), &rows);
    let honest = bake(&scene, &detail(1e-4)).unwrap();
    assert!(sees_east(&honest.table, eye) && honest.table.frame().is_some());
    assert_eq!(n_violations(&honest, &scene), 0);
    let wide = bake(&scene, &detail(0.75)).unwrap();
    assert!(!sees_east(&wide.table, eye), "the slit is closed");
    // As stated, that is within the premise.
    assert_eq!(n_violations(&wide, &scene), 0);
    let frame = wide.table.frame().copied().expect("a frame");
    let less = Frame::new(frame.axes(), 1e-4).unwrap();
    let table = wide.table.clone().with_frame(Some(less)).unwrap();
    assert!(n_violations(&Baked { table, ..wide }, &scene) > 0, "it hides what is seen through the slit");
    // A hairline is closed by default precision, and open without.
    let scene = turned(&slit(1e-6), &rows);
    assert!(!sees_east(&bake(&scene, &detail(1e-5)).unwrap().table, eye));
    assert!(sees_east(&bake(&scene, &detail(0.0)).unwrap().table, eye));
}

/// The impostor: a table whose frame is forgotten takes an eye on one side of a wall for one on the other.
#[test]
fn a_frame_that_is_forgotten_hides_what_is_seen() {
    let rows = rotation(-17.0, 0.0);
    let mut options = with(Gap::Width(1e-4));
    options.detail_below = Some(0.0);
    let table = bake(&turned(&slit(0.0), &rows), &options).unwrap().table;
    let eye = turn(&rows, [6.55, 1.6, 1.0]);
    assert!(sees_east(&table, eye) && !table.place_at(eye).is_outside());
    assert!(!sees_east(&table.with_frame(None).unwrap(), eye));
}

/// Rays that pass hairlines of the file, which the frame closes, are counted apart. The twin: of what is open along the frame too, nothing is a crack.
#[test]
fn cracks_are_counted_apart() {
    let rows = rotation(20.0, 0.0);
    let detail = |gap| {
        let mut options = with(Gap::Width(gap));
        options.detail_below = Some(0.0);
        options
    };
    let remarks = |width: f64, gap: f64| {
        let scene = turned(&slit(width), &rows);
        let baked = bake(&scene, &detail(gap)).unwrap();
        let options = VerifyOptions { rays: 20_000, pairs: 400, tries: 256, threads: 2, ..VerifyOptions::default() };
        let found = verify(&baked.table, &Truth::Scene(&scene), &options).unwrap();
        assert!(found.is_true(), "{:?}", found.by_kind);
        found.remarks
    };
    let [wide, narrow] = [0.75, 1e-4].map(|gap| remarks(0.25, gap).cracks);
    // Rays that graze an edge pass within any gap.
    assert!(wide > 4 * narrow, "{wide} where the slit is closed, {narrow} where it is open");
}
