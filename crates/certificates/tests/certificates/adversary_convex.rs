//! An adversary that proves as much of a map as the checker accepts, true or not: no line refutes what is accepted.

use proptest::prelude::*;
use sightlines_certificates::convex::{
    ConvexBlock, ConvexLine, ConvexNetwork, ConvexPlane, ConvexPortal, ConvexProofs, ConvexSums, ConvexTerm,
    ConvexTree, ConvexWalk, Point,
};
use sightlines_certificates::{Pairs, Refusal};

/// Cells of a grid of cubes of 4 units, three in a row.
const WIDE: u32 = 3;

/// A door between a cell and its neighbour to the right or behind: a rectangle of their common side. Doors may overlap
/// or repeat.
#[derive(Debug, Clone, Copy)]
struct Door {
    cell: u32,
    behind: bool,
    from: [u8; 2],
    length: [u8; 2],
    turned: bool,
    /// A leaning door is no door of two cubes: its cells are not convex.
    leans: u8,
}

fn network(doors: &[Door]) -> ConvexNetwork {
    let is_inside = |d: &&Door| if d.behind { d.cell + WIDE < WIDE * WIDE } else { d.cell % WIDE + 1 < WIDE };
    let portals = doors.iter().filter(is_inside).map(|d| {
        let [x, y] = [4.0 * f64::from(d.cell % WIDE), 4.0 * f64::from(d.cell / WIDE)];
        let span = |k: usize| [d.from[k], (d.from[k] + d.length[k]).min(4)].map(f64::from);
        let ([a, b], [low, high]) = (span(0), span(1));
        let lean = f64::from(d.leans) / 4.0;
        let (other, corners): (u32, [Point; 4]) = if d.behind {
            let at = |u: f64, z: f64| [x + u, y + 4.0 + lean * z, z];
            (d.cell + WIDE, [at(a, low), at(a, high), at(b, high), at(b, low)])
        } else {
            let at = |u: f64, z: f64| [x + 4.0 + lean * z, y + u, z];
            (d.cell + 1, [at(a, low), at(b, low), at(b, high), at(a, high)])
        };
        let corners = corners.to_vec();
        match d.turned {
            false => ConvexPortal { cells: [d.cell, other], corners },
            true => ConvexPortal { cells: [other, d.cell], corners: corners.into_iter().rev().collect() },
        }
    });
    let portals: Vec<ConvexPortal> = portals.collect();
    ConvexNetwork::new((WIDE * WIDE) as usize, &portals, 0.0).expect("doors on sides")
}

/// A point of a gate, with random weights of its corners.
fn point(network: &ConvexNetwork, gate: u32, weights: [f64; 4]) -> Point {
    let sum: f64 = weights.iter().sum();
    let corners = network.corners(gate);
    [0, 1, 2].map(|k| corners.iter().zip(weights).map(|(p, w)| p[k] * w).sum::<f64>() / sum)
}

/// All pairs that are joined by lines through points of two gates, in the middle and near corners.
fn joined(network: &ConvexNetwork) -> Pairs {
    const CHOICES: [[f64; 4]; 5] =
        [[1., 1., 1., 1.], [60., 1., 2., 1.], [1., 60., 1., 2.], [2., 1., 60., 1.], [1., 2., 1., 60.]];
    let mut pairs = Pairs::none(network.n_cells());
    let n_gates = 2 * network.n_portals() as u32;
    for s in 0..n_gates {
        for t in (0..n_gates).filter(|&t| t / 2 != s / 2) {
            for (i, &v) in CHOICES.iter().enumerate() {
                // Every other choice, to limit the time.
                for &w in CHOICES.iter().skip(i % 2).step_by(2) {
                    let line = ConvexLine::through(s, point(network, s, v), point(network, t, w));
                    pairs.add_all(&network.follow(&line));
                }
            }
        }
    }
    pairs
}

/// Extends the walk of the last source by one decision after the other: blocked by the first reason that is accepted,
/// else open.
fn grow(proofs: &mut ConvexProofs, network: &ConvexNetwork, source: u32, reasons: &[ConvexBlock]) -> usize {
    let mut decisions: Vec<usize> = Vec::new();
    for _ in 0..400 {
        let open: Vec<bool> = decisions.iter().map(|&k| k == reasons.len()).collect();
        let used = decisions.iter().filter(|&&k| k < reasons.len()).map(|&k| reasons[k].clone()).collect();
        // Without targets: the walk proves all pairs of its source that earlier walks left.
        let mut tried = proofs.clone();
        tried.walks.push(ConvexWalk::new(source, vec![], &open, used));
        match tried.check(network) {
            Ok(_) => {
                *proofs = tried;
                return open.iter().filter(|open| !**open).count();
            }
            Err(Refusal::Block { block, .. }) => match decisions.iter().rposition(|&k| k < reasons.len()) {
                // It is always the last one, or there is none for the next gate.
                Some(last) if block + 1 == open.iter().filter(|open| !**open).count() => decisions[last] += 1,
                _ => decisions.push(0),
            },
            Err(_) => return 0,
        }
    }
    0
}

fn door() -> impl Strategy<Value = Door> {
    let leans = prop_oneof![4 => Just(0u8), 1 => Just(1u8)];
    (0u32..9, any::<bool>(), [0u8..4, 0..4], [1u8..3, 1..3], any::<bool>(), leans)
        .prop_map(|(cell, behind, from, length, turned, leans)| Door { cell, behind, from, length, turned, leans })
}

fn reason() -> impl Strategy<Value = ConvexBlock> {
    let at = || (0u32..4, 0u32..4).prop_map(|(back, k)| [back, k]);
    let plane = (1u32..3, 1u32..3, at(), at())
        .prop_map(|(j, more, edge, corner)| ConvexBlock::Plane(ConvexPlane { stops: [j + more, j], edge, corner }));
    let term =
        (0u32..4, 0u32..4, 1u32..3).prop_map(|(gate, edge, times)| ConvexTerm { gate, edge, times: times.into() });
    let sums = (1u32..4, prop::collection::vec(term, 1..3))
        .prop_map(|(s, terms)| ConvexBlock::Sums(ConvexSums { ends: [s, 0], tree: ConvexTree::Sum(terms) }));
    prop_oneof![plane, sums]
}

fn input() -> impl Strategy<Value = (Vec<Door>, Vec<ConvexBlock>, Vec<u8>)> {
    let doors = prop::collection::vec(door(), 8..15);
    (doors, prop::collection::vec(reason(), 32), prop::collection::vec(0u8..8, 36))
}

/// Returns the number of pairs proven hidden, and the number of reasons accepted.
fn try_to_prove(doors: &[Door], reasons: &[ConvexBlock], left_out: &[u8]) -> [usize; 2] {
    let network = network(doors);
    let truth = joined(&network);
    // A few joined pairs are not left open, so the adversary tries to prove them hidden.
    let unproven = truth.iter().zip(left_out).filter(|(_, k)| **k > 0).map(|(pair, _)| pair).collect();
    let mut proofs = ConvexProofs { checksum: network.checksum(), unproven, ..ConvexProofs::default() };
    let n_reasons = (0..9).map(|source| grow(&mut proofs, &network, source, reasons)).sum();
    let proven = proofs.check(&network).expect("each walk was accepted");
    for [a, b] in truth.iter() {
        assert!(!proven.hidden.has(a, b), "{a} and {b} are joined: {doors:?} {proofs:?}");
    }
    assert_eq!(ConvexProofs::from_bytes(&proofs.to_bytes()), Ok(proofs));
    [proven.hidden.len() as usize, n_reasons]
}

proptest! {
    /// Doors of any kind, random reasons, and pairs left open at random, so that chains lead anywhere, and reasons are
    /// used again for other chains.
    #[test]
    fn no_line_refutes_what_is_accepted((doors, reasons, left_out) in input()) {
        let _ = try_to_prove(&doors, &reasons, &left_out);
    }
}

/// Some of its proofs are accepted, including reasons.
#[test]
fn something_is_accepted() {
    use proptest::strategy::ValueTree;
    use proptest::test_runner::TestRunner;
    let mut runner = TestRunner::deterministic();
    let mut sum = [0, 0];
    for _ in 0..48 {
        let (doors, reasons, left_out) = input().new_tree(&mut runner).expect("no filters").current();
        let counts = try_to_prove(&doors, &reasons, &left_out);
        sum = [sum[0] + counts[0], sum[1] + counts[1]];
    }
    assert!(sum[0] > 100 && sum[1] > 20, "{sum:?}");
}
