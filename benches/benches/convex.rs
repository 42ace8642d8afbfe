//! Lines through convex polygons: what a decision costs, by the length of the sequence and by the answer.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use sightlines::geometry::{Point3, Portal3, Random};
use sightlines::sightline::{ConvexStabber, StabLimits, Verdict};

fn main() {
    divan::main();
}

const LENGTHS: [usize; 5] = [3, 5, 10, 20, 50];

/// Number of sequences of each length.
const N_SEQUENCES: usize = 400;

/// Tilted polygons of 3 to 6 corners along a corridor, in each sequence of another size, so that both
/// answers are common.
fn sequences(n: usize) -> Vec<Vec<Portal3>> {
    let mut random = Random::new(n as u64);
    let mut next = |low: f64, high: f64| low + (high - low) * random.unit();
    let mut portal = |k: usize, size: f64| {
        let [x, y] = [next(-40.0, 40.0), next(-40.0, 40.0)];
        let tilt = [next(-0.6, 0.6), next(-0.6, 0.6)];
        let corners = 3.0 + next(0.0, 4.0).floor();
        let points: Vec<Point3> = (0..corners as usize)
            .map(|i| {
                let angle = (i as f64 + next(-0.3, 0.3)) / corners * std::f64::consts::TAU;
                let (dx, dy) = (angle.cos() * size, angle.sin() * size);
                [x + dx, y + dy, k as f64 * (2.0 * size + 50.0) + tilt[0] * dx + tilt[1] * dy]
            })
            .collect();
        Portal3::around(&points).expect("a polygon around its middle")
    };
    let size = |i: usize| 10.0 + (60.0 + 2.0 * n as f64) * i as f64 / N_SEQUENCES as f64;
    (0..N_SEQUENCES).map(|i| (0..n).map(|k| portal(k, size(i))).collect()).collect()
}

/// The sequences of one answer, each of which is proven first.
fn of_answer(n: usize, visible: bool) -> Vec<Vec<Portal3>> {
    let mut stabber = ConvexStabber::new(StabLimits::default());
    let mut sequences = sequences(n);
    sequences.retain(|portals| {
        let portals: Vec<&Portal3> = portals.iter().collect();
        match stabber.stab(&portals, None) {
            Verdict::Visible(line) => {
                assert!(portals.iter().all(|p| line.passes(p)));
                visible
            }
            Verdict::Hidden(proof) => {
                assert!(proof.holds(&portals));
                !visible
            }
            Verdict::Undecided(_) => panic!("a random sequence is undecided"),
        }
    });
    assert!(sequences.len() >= 20, "{} of {n} portals", sequences.len());
    sequences
}

fn bench(bencher: Bencher<'_, '_>, n: usize, visible: bool) {
    let sequences = of_answer(n, visible);
    let sequences: Vec<Vec<&Portal3>> = sequences.iter().map(|s| s.iter().collect()).collect();
    let mut stabber = ConvexStabber::new(StabLimits::default());
    bencher.counter(ItemsCount::new(sequences.len())).bench_local(move || {
        sequences.iter().filter(|s| matches!(stabber.stab(black_box(s), None), Verdict::Visible(_))).count()
    });
}

/// A line is found.
#[divan::bench(args = LENGTHS, name = "convex/visible", sample_count = 20)]
fn visible(bencher: Bencher<'_, '_>, n: usize) {
    bench(bencher, n, true);
}

/// A certificate is found.
#[divan::bench(args = LENGTHS, name = "convex/hidden", sample_count = 20)]
fn hidden(bencher: Bencher<'_, '_>, n: usize) {
    bench(bencher, n, false);
}
