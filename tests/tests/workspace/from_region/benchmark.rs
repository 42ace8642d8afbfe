//! The benchmark of rectangles and boxes: what is found of what sampling calls hidden.

use crate::from_region::common::{around, buffers, hidden, triangles};
use sightlines::multifocal::{FromRegion, Layout, Measure};
use sightlines::scenes::occlusion::{Occlusion, OcclusionOptions, occlusion};
use sightlines_testkit::from_region::sampled_view;

/// Boxes that are called hidden, of those that no ray of 3 million reaches; and that none of them was reached.
fn found(half: f64, tilt: u32, seed: u64, layout: Layout) -> (usize, usize) {
    let benchmark = occlusion(OcclusionOptions { seed, tilt, ..OcclusionOptions::default() }).expect("in range");
    let volume = Occlusion::volume(half);
    let seen = sampled_view(&benchmark.scene, &volume, &benchmark.occludees, 1_500_000, seed);
    let triangles = triangles(&benchmark.scene);
    let mut method = buffers(&triangles, around(&benchmark.scene, &benchmark.occludees), layout);
    let found = hidden(&mut method, &volume, &benchmark.occludees);
    assert_eq!(seen.refuted(found.iter().copied()), [], "{} half {half} tilt {tilt} seed {seed}", method.name());
    (found.len(), seen.unseen().count())
}

fn share(half: f64, tilt: u32, layout: Layout) -> f64 {
    let all: Vec<(usize, usize)> = (1..=3).map(|seed| found(half, tilt, seed, layout)).collect();
    let (found, hidden) = all.iter().fold((0, 0), |(f, h), &(of, oh)| (f + of, h + oh));
    assert!(hidden > 300, "{hidden} boxes are hidden");
    let share = found as f64 / hidden as f64;
    println!("half {half} tilt 0.{tilt:02} {layout:?}: {found} of {hidden}, {:.1} %", 100.0 * share);
    share
}

#[test]
fn benchmark_default_finds_most_of_what_is_hidden() {
    assert!(share(0.25, 0, Layout::default()) >= 0.85);
    assert!(share(0.25, 60, Layout::default()) >= 0.70);
}

/// The reasons for what is shipped: each step finds more.
#[test]
fn benchmark_heights_and_planes_find_more() {
    let one = |measure| Layout { planes: 1, carry: false, measure, ..Layout::default() };
    let [euclid, vertex, section] =
        [Measure::Euclid, Measure::VertexHeight, Measure::SectionHeight].map(|m| share(0.25, 60, one(m)));
    assert!(section >= vertex && section >= euclid);
    let many = share(0.25, 60, Layout { carry: false, ..Layout::default() });
    assert!(many > section);
    assert!(share(0.25, 60, Layout::default()) >= many);
}
