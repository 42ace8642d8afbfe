//! Cracks, by a stated width: what is wider than the gap shows what is behind it, however little; what is narrower counts as closed.

use crate::sides::block;
use crate::truth::hidden;
use sightlines_cells::Scene;
use sightlines_scenes::cupboard;
use sightlines_strip::{Eyes, Fate, HiddenReason, LineEffort, StripError, StripOptions, strip};

/// A housing of six thick boards with a slit along an edge of its lid, and a thing inside of it that only a line through the slit reaches.
fn slit(width: f64) -> Scene {
    let boards = [
        block("Bottom", [0.0, 0.0, 0.0], [8.0, 1.0, 8.0]),
        block("Left", [0.0, 1.0, 0.0], [1.0, 8.0, 8.0]),
        block("Right", [7.0, 1.0, 0.0], [8.0, 8.0, 8.0]),
        block("Front", [1.0, 1.0, 0.0], [7.0, 8.0, 1.0]),
        block("Back", [1.0, 1.0, 7.0], [7.0, 8.0, 8.0]),
        block("Lid", [0.0, 8.0 + width, 0.0], [8.0, 9.0, 8.0]),
        block("Thing", [3.0, 2.0, 3.0], [5.0, 8.0 + width / 2.0, 5.0]),
    ];
    Scene::new(boards.into()).expect("a scene")
}

/// Line space is not what this is about.
fn little() -> LineEffort {
    LineEffort { shared_cells: 0, ..LineEffort::default() }
}

fn thing(scene: &Scene, gap: f64) -> Fate {
    let options = StripOptions { gap, ..StripOptions::default() };
    strip(scene, &Eyes::outside(), &options, None).expect("a gap").objects[6].fate
}

/// A slit of one unit in the last place above the gap is open to the ball or left undecided, never closed; sight through any slit is found or undecided
/// without a gap.
#[test]
fn a_slit_hides_only_if_it_is_within_the_gap() {
    let gap = 0.25;
    assert_eq!(thing(&slit(gap / 8.0), gap), Fate::Hidden(HiddenReason::Gap));
    // The narrowest slit that is not within the gap.
    assert!(!thing(&slit(gap.next_up()), gap).is_hidden());
    for width in [1.0, gap, 0.125] {
        let fate = thing(&slit(width), 0.0);
        assert!(matches!(fate, Fate::Seen(_)), "{width}: {fate:?}");
    }
    for width in [1e-3, 1e-9, 8.0 * f64::EPSILON] {
        assert!(!thing(&slit(width), 0.0).is_hidden(), "{width}");
    }
}

/// What touches the hull is hidden where the hull is thick, and stays where it comes out of it.
#[test]
fn what_touches_the_hull_is_hidden_within_the_gap() {
    let of = cupboard(0).expect("none");
    let options = StripOptions { gap: 0.0625, effort: little(), ..StripOptions::default() };
    let found = strip(&of.scene, &Eyes::outside(), &options, None).expect("a gap");
    assert_eq!(hidden(&found), of.hidden);
    // A keyhole within the gap counts as closed; one that is as wide as five gaps does not.
    let with = |hole: u32, gap: f64| {
        let of = cupboard(hole).expect("no wider than 64");
        let options = StripOptions { gap, first_rays: 0, effort: little(), ..StripOptions::default() };
        let found = strip(&of.scene, &Eyes::outside(), &options, None).expect("a gap");
        found.objects[7].fate
    };
    assert_eq!(with(1, 0.0625), Fate::Hidden(HiddenReason::Gap));
    assert!(!with(20, 0.0625).is_hidden());
}

#[test]
fn gaps_that_cannot_be_used_are_refused() {
    let error = |gap: f64| {
        let options = StripOptions { gap, ..StripOptions::default() };
        match strip(&slit(1.0), &Eyes::outside(), &options, None) {
            Err(StripError::Gap(error)) => error.to_string(),
            other => panic!("{other:?}"),
        }
    };
    assert!(
        error(1e-6).starts_with("a gap of 0.000001 is too narrow for a scene 9 long: at least 0.0"),
        "{}",
        error(1e-6)
    );
    assert!(error(f64::NAN).contains("is no width") && error(-1.0).contains("is no width"));
}
