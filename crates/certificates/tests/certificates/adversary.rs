//! An adversary that proves as much as the checker accepts, true or not: no line refutes what is accepted.

use proptest::prelude::*;
use sightlines_certificates::planar::{PlanLine, PlanarBlock, PlanarNetwork, PlanarPortal, PlanarProofs, PlanarWalk};
use sightlines_certificates::{Pairs, Refusal};

/// Cells of a grid of squares of 4 units, three in a row.
const WIDE: u32 = 3;

fn corner(cell: u32) -> [f64; 2] {
    [4.0 * f64::from(cell % WIDE), 4.0 * f64::from(cell / WIDE)]
}

/// A door between a cell and its right or upper neighbour: an interval of the common side. Doors may overlap or repeat.
#[derive(Debug, Clone, Copy)]
struct Door {
    cell: u32,
    above: bool,
    from: u8,
    length: u8,
    turned: bool,
}

fn network(n_rows: u32, doors: &[Door]) -> PlanarNetwork {
    let cells: Vec<Vec<[f64; 2]>> = (0..WIDE * n_rows)
        .map(|cell| {
            let [x, y] = corner(cell);
            vec![[x, y], [x + 4.0, y], [x + 4.0, y + 4.0], [x, y + 4.0]]
        })
        .collect();
    let portals: Vec<PlanarPortal> = doors
        .iter()
        .filter(|d| if d.above { d.cell + WIDE < WIDE * n_rows } else { d.cell % WIDE + 1 < WIDE })
        .map(|d| {
            let [x, y] = corner(d.cell);
            let (low, high) = (f64::from(d.from), f64::from((d.from + d.length).min(4)));
            let (other, sides, left, right) = match d.above {
                true => (d.cell + WIDE, [2, 0], [x + low, y + 4.0], [x + high, y + 4.0]),
                false => (d.cell + 1, [1, 3], [x + 4.0, y + high], [x + 4.0, y + low]),
            };
            match d.turned {
                false => PlanarPortal { cells: [d.cell, other], sides, left, right },
                true => PlanarPortal { cells: [other, d.cell], sides: [sides[1], sides[0]], left: right, right: left },
            }
        })
        .collect();
    PlanarNetwork::new(&cells, &portals).expect("doors on sides")
}

/// All pairs that are joined by lines next to two ends of doors.
fn joined(network: &PlanarNetwork) -> Pairs {
    const NEAR: f64 = 1.0 / 64.0;
    let mut pairs = Pairs::none(network.n_cells());
    let mut ends: Vec<[f64; 2]> = (0..network.n_portals() as u32).flat_map(|p| network.gate_ends(2 * p)).collect();
    ends.sort_by(|p, q| p[0].total_cmp(&q[0]).then(p[1].total_cmp(&q[1])));
    ends.dedup();
    let around =
        |p: [f64; 2]| [[1., 1.], [1., -1.], [-1., 1.], [-1., -1.]].map(|d| [p[0] + d[0] * NEAR, p[1] + d[1] * NEAR]);
    for (k, &p) in ends.iter().enumerate() {
        for &q in &ends[..k] {
            for p in around(p) {
                for q in around(q) {
                    for cell in 0..network.n_cells() as u32 {
                        pairs.add_all(&network.follow(&PlanLine::through(cell, p, q)));
                    }
                }
            }
        }
    }
    pairs
}

/// Extends the walk of the last source by one decision after the other: blocked by the first reason that is accepted,
/// else open.
fn grow(proofs: &mut PlanarProofs, network: &PlanarNetwork, source: u32, reasons: &[PlanarBlock]) -> bool {
    let mut decisions: Vec<usize> = Vec::new();
    for _ in 0..4000 {
        let open: Vec<bool> = decisions.iter().map(|&k| k == reasons.len()).collect();
        let used = decisions.iter().filter(|&&k| k < reasons.len()).map(|&k| reasons[k].clone()).collect();
        proofs.walks.push(PlanarWalk::new(source, &open, used));
        match proofs.check(network) {
            Ok(_) => return true,
            Err(Refusal::Block { block, .. }) => match decisions.iter().rposition(|&k| k < reasons.len()) {
                // It is always the last one, or there is none for the next gate.
                Some(last) if block + 1 == open.iter().filter(|open| !**open).count() => decisions[last] += 1,
                _ => decisions.push(0),
            },
            Err(_) => {
                proofs.walks.pop();
                return false;
            }
        }
        proofs.walks.pop();
    }
    false
}

fn door() -> impl Strategy<Value = Door> {
    (0u32..9, any::<bool>(), 0u8..4, 1u8..3, any::<bool>()).prop_map(|(cell, above, from, length, turned)| Door {
        cell,
        above,
        from,
        length,
        turned,
    })
}

fn reason() -> impl Strategy<Value = PlanarBlock> {
    let shape = prop::sample::select(vec![[1, 1], [1, 2], [2, 1], [2, 2], [1, 3], [3, 1]]);
    shape.prop_flat_map(|[l, r]| {
        (prop::collection::vec(0u32..5, l), prop::collection::vec(0u32..5, r))
            .prop_map(|(lefts, rights)| PlanarBlock { lefts, rights })
    })
}

proptest! {
    /// Doors of any kind, random reasons, and pairs left open at random, so that chains lead anywhere, and reasons are
    /// used again for other chains.
    #[test]
    fn no_line_refutes_what_is_accepted(
        doors in prop::collection::vec(door(), 10..26),
        reasons in prop::collection::vec(reason(), 120),
        left_out in prop::collection::vec(0u8..8, 36),
    ) {
        let network = network(3, &doors);
        let truth = joined(&network);
        // A few joined pairs are not left open, so the adversary tries to prove them hidden.
        let unproven = truth.iter().zip(left_out).filter(|(_, k)| *k > 0).map(|(pair, _)| pair).collect();
        let mut proofs = PlanarProofs { checksum: network.checksum(), unproven, ..PlanarProofs::default() };
        for source in 0..9 {
            let _ = grow(&mut proofs, &network, source, &reasons);
        }
        let proven = proofs.check(&network).expect("each walk was accepted");
        for [a, b] in truth.iter() {
            prop_assert!(!proven.hidden.has(a, b), "{a} and {b} are joined: {proofs:?}");
        }
        prop_assert_eq!(PlanarProofs::from_bytes(&proofs.to_bytes()), Ok(proofs));
    }
}
