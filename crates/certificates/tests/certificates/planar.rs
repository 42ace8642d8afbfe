//! Proofs of plans written by hand: good ones are accepted, impostors are refused, and whatever is accepted is true.

use proptest::prelude::*;
use sightlines_certificates::planar::{
    LineForm, NetworkError, PlanLine, PlanarBlock, PlanarMaker, PlanarNetwork, PlanarPortal, PlanarProofs, PlanarWalk,
};
use sightlines_certificates::{ChainSolver, ChainStep, Kind, ReadErrorKind, Refusal, kind_of};

/// Four rooms in a row. Doors are low, high and low again, so only the first and the last do not see each other.
fn rooms() -> (Vec<Vec<[f64; 2]>>, Vec<PlanarPortal>) {
    let room = |x: f64| vec![[x, 0.0], [x + 4.0, 0.0], [x + 4.0, 4.0], [x, 4.0]];
    let door = |a: u32, y: f64| {
        let x = 4.0 * f64::from(a + 1);
        PlanarPortal { cells: [a, a + 1], sides: [1, 3], left: [x, y + 1.0], right: [x, y] }
    };
    ((0..4).map(|k| room(4.0 * f64::from(k))).collect(), vec![door(0, 0.0), door(1, 3.0), door(2, 0.0)])
}

fn network() -> PlanarNetwork {
    let (cells, portals) = rooms();
    PlanarNetwork::new(&cells, &portals).unwrap()
}

/// The left ends of the first and the last door are below the right end of the second.
fn block() -> PlanarBlock {
    PlanarBlock { lefts: vec![2, 0], rights: vec![1, 2] }
}

fn proofs() -> PlanarProofs {
    let whole = |a: i32, b: i32, c: i32| LineForm::Whole(Box::new([a.into(), b.into(), c.into()]));
    PlanarProofs {
        checksum: network().checksum(),
        // Upwards through the first two doors, down through the last two.
        lines: vec![PlanLine::through(0, [4.0, 0.5], [8.0, 3.5]), PlanLine { cell: 2, form: whole(6, 8, -76) }],
        unproven: Vec::new(),
        walks: vec![PlanarWalk::new(0, &[true, false], vec![block()])],
    }
}

#[test]
fn whole_tables_are_proven() {
    let proven = proofs().check(&network()).unwrap();
    assert_eq!(proven.hidden.iter().collect::<Vec<_>>(), [[0, 3]]);
    assert_eq!(proven.visible.iter().collect::<Vec<_>>(), [[0, 1], [0, 2], [1, 2], [1, 3], [2, 3]]);
    assert_eq!(proven.n_open(), 0);
    let bytes = proofs().to_bytes();
    assert_eq!(PlanarProofs::from_bytes(&bytes), Ok(proofs()));
    assert_eq!(kind_of(&bytes), Ok(Kind::Planar));
}

/// Answers as the proof by hand does.
struct ByHand;

impl ChainSolver for ByHand {
    type Block = PlanarBlock;

    fn start(&mut self, _: u32) {}

    fn cross(&mut self, chain: &[u32], _: u32) -> ChainStep<PlanarBlock> {
        if chain.len() == 1 { ChainStep::Open } else { ChainStep::Blocked(block()) }
    }

    fn back(&mut self) {}
}

/// What one maker has taken is taken again from its bytes, and checked again; not from bytes that are damaged, nor twice.
#[test]
fn what_was_taken_is_checked_again() {
    let network = network();
    let mut maker = PlanarMaker::new(&network);
    assert!(proofs().lines.into_iter().all(|line| maker.take_line(line, 1)));
    let before = maker.n_taken();
    assert!(maker.prove_hidden(0, &mut ByHand, 99));
    assert_eq!((before, maker.n_taken()), ([2, 0], [2, 1]));
    let (all, last) = (maker.taken_since([0, 0]), maker.taken_since(before));
    let mut other = PlanarMaker::new(&network);
    assert!(other.take_again(&all) && other.take_again(&maker.taken_since([9, 9])));
    assert!(!other.take_again(&last), "a walk that proves nothing new");
    assert!((0..all.len()).all(|n| !PlanarMaker::new(&network).take_again(&all[..n])));
    // The impostor: without lines, the walk would enter a cell that is to be hidden.
    assert!(!PlanarMaker::new(&network).take_again(&last));
    let (mut n_taken, n) = (0, 8 * all.len());
    for (at, bit) in (0..all.len()).flat_map(|at| (0..8).map(move |bit| (at, bit))) {
        let mut changed = all.clone();
        changed[at] ^= 1 << bit;
        let mut maker = PlanarMaker::new(&network);
        if maker.take_again(&changed) {
            n_taken += 1;
            let proofs = maker.finish();
            assert!(proofs.check(&network).is_ok() && is_true(&proofs));
        }
    }
    assert!(n_taken < n / 2, "{n_taken} of {n}");
    assert_eq!(maker.finish(), proofs());
    assert_eq!(other.finish(), proofs());
}

#[test]
fn what_is_not_proven_is_open() {
    let with = |change: fn(&mut PlanarProofs)| {
        let mut proofs = proofs();
        change(&mut proofs);
        proofs.check(&network()).unwrap()
    };
    assert_eq!(with(|p| p.walks.clear()).n_open(), 1);
    let proven = with(|p| {
        p.lines.pop();
        p.unproven = vec![[1, 3], [2, 3]];
    });
    assert_eq!((proven.n_open(), proven.hidden.len(), proven.visible.len()), (2, 1, 3));
}

/// The impostors, one for each thing that can be wrong.
#[test]
fn impostors_are_refused() {
    let refused = |change: &dyn Fn(&mut PlanarProofs)| {
        let mut proofs = proofs();
        change(&mut proofs);
        proofs.check(&network()).unwrap_err()
    };
    let wall = |p: &mut PlanarProofs| p.lines.push(PlanLine::through(0, [0.0, 2.0], [16.0, 2.0]));
    assert_eq!(refused(&wall), Refusal::Line { index: 2, cell: 0 });
    let nowhere = |p: &mut PlanarProofs| p.lines[0].cell = 9;
    assert_eq!(refused(&nowhere), Refusal::Line { index: 0, cell: 9 });
    let open = |p: &mut PlanarProofs| p.walks[0] = PlanarWalk::new(0, &[true, true], vec![]);
    assert_eq!(refused(&open), Refusal::Entered { walk: 0, from: 0, cell: 3 });
    let short = |p: &mut PlanarProofs| p.walks[0] = PlanarWalk::new(0, &[true], vec![block()]);
    assert_eq!(refused(&short), Refusal::Block { walk: 0, from: 0, block: 0 });
    let early = |p: &mut PlanarProofs| p.walks[0] = PlanarWalk::new(0, &[false], vec![block()]);
    assert_eq!(refused(&early), Refusal::Block { walk: 0, from: 0, block: 0 });
    let long = |p: &mut PlanarProofs| p.walks[0] = PlanarWalk::new(0, &[true, false, true], vec![block()]);
    assert_eq!(refused(&long), Refusal::Unused { walk: 0, from: 0 });
    let more = |p: &mut PlanarProofs| p.walks[0].decisions.blocks.push(block());
    assert_eq!(refused(&more), Refusal::Unused { walk: 0, from: 0 });
    // A second walk from the same source has nothing left to prove.
    let twice = |p: &mut PlanarProofs| p.walks.push(p.walks[0].clone());
    assert_eq!(refused(&twice), Refusal::Unused { walk: 1, from: 0 });
    let elsewhere = |p: &mut PlanarProofs| p.walks[0].source = 4;
    assert_eq!(refused(&elsewhere), Refusal::Source { walk: 0, from: 4 });
    let other = |p: &mut PlanarProofs| p.checksum ^= 1;
    assert_eq!(refused(&other), Refusal::OtherTable);
    let pair = |p: &mut PlanarProofs| p.unproven.push([2, 2]);
    assert_eq!(refused(&pair), Refusal::Pair { index: 0 });
    // No ends of the first two doors are a reason to block them.
    let mut n_tried = 0;
    for lefts in [vec![0], vec![1], vec![0, 1]] {
        for rights in [vec![0], vec![1], vec![0, 1]] {
            let block = PlanarBlock { lefts: lefts.clone(), rights };
            let claim = |p: &mut PlanarProofs| {
                p.lines.clear();
                p.walks[0] = PlanarWalk::new(0, &[false], vec![block.clone()]);
            };
            // From the first room nothing is seen without lines, so its neighbour is entered at once.
            assert_eq!(refused(&claim), Refusal::Entered { walk: 0, from: 0, cell: 1 });
            let claim = |p: &mut PlanarProofs| {
                p.lines = vec![PlanLine::through(0, [4.0, 0.5], [5.0, 0.5])];
                p.walks[0] = PlanarWalk::new(0, &[false], vec![block.clone()]);
            };
            assert_eq!(refused(&claim), Refusal::Block { walk: 0, from: 0, block: 0 });
            n_tried += 1;
        }
    }
    assert_eq!(n_tried, 9);
}

/// A change of a plan's cells and portals.
type Change<'a> = &'a dyn Fn(&mut Vec<Vec<[f64; 2]>>, &mut Vec<PlanarPortal>);

#[test]
fn networks_that_are_none_are_refused() {
    let with = |change: Change<'_>| {
        let (mut cells, mut portals) = rooms();
        change(&mut cells, &mut portals);
        PlanarNetwork::new(&cells, &portals).unwrap_err()
    };
    assert_eq!(with(&|c, _| c[2][1] = [9.0, 3.0]), NetworkError::NotConvex(2));
    assert_eq!(with(&|c, _| c[2].reverse()), NetworkError::NotConvex(2));
    assert_eq!(with(&|c, _| c[3].truncate(2)), NetworkError::NotConvex(3));
    assert_eq!(with(&|c, _| c[0][0][0] = f64::NAN), NetworkError::Coordinate(0));
    assert_eq!(with(&|_, p| p[1].cells = [1, 1]), NetworkError::Cells(1));
    assert_eq!(with(&|_, p| p[1].cells = [1, 4]), NetworkError::Cells(1));
    assert_eq!(with(&|_, p| p[1].left = [8.0, 5.0]), NetworkError::OffBorder { portal: 1, cell: 1 });
    assert_eq!(with(&|_, p| p[0].cells = [0, 2]), NetworkError::OffBorder { portal: 0, cell: 2 });
    let turned = |_: &mut Vec<Vec<[f64; 2]>>, p: &mut Vec<PlanarPortal>| {
        let PlanarPortal { left, right, .. } = p[2];
        (p[2].left, p[2].right) = (right, left);
    };
    assert_eq!(with(&turned), NetworkError::OffBorder { portal: 2, cell: 2 });
    let sides = with(&|_, p| p[1].sides = [3, 3]);
    assert_eq!(sides.to_string(), "portals 0 and 1 are listed on one side of cell 1, and are not");
}

#[test]
fn bytes_that_are_damaged_are_refused() {
    let bytes = proofs().to_bytes();
    for n in 0..bytes.len() {
        assert!(PlanarProofs::from_bytes(&bytes[..n]).is_err(), "{n} bytes");
    }
    for at in 0..bytes.len() {
        let mut other = bytes.clone();
        other[at] ^= 0x10;
        let error = PlanarProofs::from_bytes(&other).unwrap_err();
        assert!(error.offset <= bytes.len() && error.to_string().starts_with("byte "), "{error}");
    }
    let trailing = with_body(&bytes, |body| body.push(0));
    assert_eq!(PlanarProofs::from_bytes(&trailing).unwrap_err().kind, ReadErrorKind::Trailing(1));
}

/// The same frame with a right checksum around another body.
fn with_body(bytes: &[u8], change: impl FnOnce(&mut Vec<u8>)) -> Vec<u8> {
    let mut other = bytes[..bytes.len() - 4].to_vec();
    change(&mut other);
    let checksum = crc32fast::hash(&other);
    other.extend(checksum.to_le_bytes());
    other
}

/// Whether what is proven is true of the four rooms.
fn is_true(proofs: &PlanarProofs) -> bool {
    let Ok(proven) = proofs.check(&network()) else { return true };
    proven.hidden.iter().all(|pair| pair == [0, 3]) && !proven.visible.has(0, 3)
}

fn any_proofs() -> impl Strategy<Value = PlanarProofs> {
    let ends = || prop::collection::vec(0u32..4, 1..4);
    let block = (ends(), ends()).prop_map(|(lefts, rights)| PlanarBlock { lefts, rights });
    let walk = (0u32..5, prop::collection::vec(any::<bool>(), 0..6), prop::collection::vec(block, 0..4));
    let walk = walk.prop_map(|(source, open, blocks)| PlanarWalk::new(source, &open, blocks));
    let point = || prop::array::uniform2((0i32..17).prop_map(f64::from));
    let line = (0u32..4, point(), point()).prop_map(|(cell, p, q)| PlanLine::through(cell, p, q));
    let parts = (prop::collection::vec(line, 0..4), prop::collection::vec(walk, 0..3), any::<bool>());
    parts.prop_map(|(lines, walks, real)| {
        let mut all = if real { proofs().lines } else { Vec::new() };
        all.extend(lines.into_iter().filter(|line| !network().follow(line).is_empty()));
        PlanarProofs { checksum: network().checksum(), lines: all, unproven: Vec::new(), walks }
    })
}

proptest! {
    /// Whatever is claimed, only true claims are accepted.
    #[test]
    fn nothing_wrong_is_proven(proofs in any_proofs()) {
        prop_assert!(is_true(&proofs), "{proofs:?}");
        prop_assert_eq!(PlanarProofs::from_bytes(&proofs.to_bytes()).map(|read| is_true(&read)), Ok(true));
    }

    /// Bytes that are changed, with a right checksum, are refused or prove only what is true.
    #[test]
    fn nothing_wrong_is_proven_by_changed_bytes(changes in prop::collection::vec((13usize..200, any::<u8>()), 1..4)) {
        let bytes = with_body(&proofs().to_bytes(), |body| {
            for &(at, byte) in &changes {
                if let Some(old) = body.get_mut(at) {
                    *old = byte;
                }
            }
        });
        if let Ok(read) = PlanarProofs::from_bytes(&bytes) {
            prop_assert!(is_true(&read), "{read:?}");
        }
    }
}
