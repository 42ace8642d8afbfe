//! The benchmark of rectangles and boxes: what is found of what sampling calls hidden.

use crate::from_region::common::{around, buffers, hidden, triangles};
use sightlines::multifocal::{FromRegion, Layout, Measure};
use sightlines::scenes::occlusion::{Occlusion, OcclusionOptions, occlusion};
use sightlines_testkit::from_region::{SampledView, sampled_view};
use std::sync::LazyLock;

/// Half the side of the box of viewers.
const HALF: f64 = 0.25;

/// A benchmark, and what rays see in it.
struct Case {
    seed: u64,
    benchmark: Occlusion,
    seen: SampledView,
}

/// Benchmarks of three seeds, with rays once for all layouts.
fn cases(tilt: u32) -> [Case; 3] {
    [1, 2, 3].map(|seed| {
        let benchmark = occlusion(OcclusionOptions { seed, tilt, ..OcclusionOptions::default() }).expect("in range");
        let volume = Occlusion::volume(HALF);
        let seen = sampled_view(&benchmark.scene, &volume, &benchmark.occludees, 400_000, seed);
        Case { seed, benchmark, seen }
    })
}

static UPRIGHT: LazyLock<[Case; 3]> = LazyLock::new(|| cases(0));
static TILTED: LazyLock<[Case; 3]> = LazyLock::new(|| cases(60));

/// Boxes that are called hidden, of those that no ray reaches; and that none of them was reached.
fn found(case: &Case, layout: Layout) -> (usize, usize) {
    let Case { seed, benchmark, seen } = case;
    let triangles = triangles(&benchmark.scene);
    let mut method = buffers(&triangles, around(&benchmark.scene, &benchmark.occludees), layout);
    let found = hidden(&mut method, &Occlusion::volume(HALF), &benchmark.occludees);
    assert_eq!(seen.refuted(found.iter().copied()), [], "{} seed {seed}", method.name());
    (found.len(), seen.unseen().count())
}

fn share(cases: &[Case; 3], layout: Layout) -> f64 {
    let all = cases.each_ref().map(|case| found(case, layout));
    let (found, hidden) = all.iter().fold((0, 0), |(f, h), &(of, oh)| (f + of, h + oh));
    assert!(hidden > 300, "{hidden} boxes are hidden");
    let share = found as f64 / hidden as f64;
    println!("{layout:?}: {found} of {hidden}, {:.1} %", 100.0 * share);
    share
}

#[test]
fn benchmark_default_finds_most_of_what_is_hidden() {
    assert!(share(&UPRIGHT, Layout::default()) >= 0.85);
    assert!(share(&TILTED, Layout::default()) >= 0.70);
}

/// The reasons for what is shipped: each step finds more.
#[test]
fn benchmark_heights_and_planes_find_more() {
    let one = |measure| Layout { planes: 1, carry: false, measure, ..Layout::default() };
    let [euclid, vertex, section] =
        [Measure::Euclid, Measure::VertexHeight, Measure::SectionHeight].map(|m| share(&TILTED, one(m)));
    assert!(section >= vertex && section >= euclid);
    let many = share(&TILTED, Layout { carry: false, ..Layout::default() });
    assert!(many > section);
    assert!(share(&TILTED, Layout::default()) >= many);
}
