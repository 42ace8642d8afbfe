//! Damaged drawings, and plans that are read from a drawing as from GeoJSON.

use super::read;
use crate::common::dxf::{Dxf, small_drawing};
use crate::common::setting;
use proptest::prelude::*;
use sightlines_cells::Plan;
use sightlines_formats::PlanReadOptions;
use sightlines_formats::dxf::parse_dxf;
use sightlines_formats::geojson::{parse_plan, write_plan};
use sightlines_geometry::Point2;
use sightlines_testkit::mutate::{SplitMix, flipped_bits, mutate};

/// Whether a damaged drawing is read; what is read is a plan that can be written.
fn check(bytes: &[u8]) -> bool {
    // Few pieces: how many there are is for others to check.
    let options = PlanReadOptions { deviation: Some(0.5), ..PlanReadOptions::default() };
    let Ok(file) = parse_dxf(bytes, &options) else { return false };
    assert_eq!(parse_plan(write_plan(&file.plan).as_bytes()).unwrap(), file.plan);
    true
}

#[test]
fn damaged_drawings_are_read_or_refused() {
    let seed = small_drawing();
    assert!(check(&seed));
    let (rounds, first) = (setting("SIGHTLINES_FUZZ_ROUNDS", 5_000), setting("SIGHTLINES_FUZZ_SEED", 0));
    let mut n_read = 0;
    for number in first..first + rounds {
        let broken = mutate(&seed, &mut SplitMix::new(number));
        let Ok(is_read) = std::panic::catch_unwind(|| check(&broken)) else {
            panic!("replay with SIGHTLINES_FUZZ_ROUNDS=1 SIGHTLINES_FUZZ_SEED={number}")
        };
        n_read += u64::from(is_read);
    }
    assert!(rounds < 1000 || (rounds / 100..=rounds * 95 / 100).contains(&n_read), "{n_read} of {rounds} read");
}

#[test]
fn every_prefix_is_refused_and_every_flipped_bit_survived() {
    let text = small_drawing();
    // Only blanks follow the end mark.
    let whole = text.trim_ascii_end().len();
    assert!((0..whole).all(|len| !check(&text[..len])) && (whole..=text.len()).all(|len| check(&text[..len])));
    let n_read = flipped_bits(&text).filter(|bytes| check(bytes)).count();
    assert!(n_read > 1000, "{n_read}");
}

proptest! {
    /// Invariant: the same walls are the same plan in both formats, bit by bit.
    #[test]
    fn drawings_are_the_plans_of_their_lines(walls in prop::collection::vec((any::<[i8; 4]>(), 1u8..9), 1..20)) {
        let place = |x: i8, y: i8, by: u8| Point2::new(f64::from(x) / f64::from(by), f64::from(y) * 0.1);
        let lines = walls.iter().map(|&([a, b, c, d], by)| (place(a, b, by), place(c, d, by))).filter(|(a, b)| a != b);
        let plan = Plan::from_walls(lines.clone()).unwrap();
        let dxf = lines.fold(Dxf::new(), |dxf, (a, b)| dxf.line("0", a.to_array(), b.to_array()));
        let file = read(&dxf.model(&Dxf::new()));
        prop_assert_eq!(file.plan, parse_plan(write_plan(&plan).as_bytes()).unwrap());
    }
}
