//! Proofs of boxes written by hand: good ones are accepted, impostors are refused, and whatever is accepted is true.

use proptest::prelude::*;
use sightlines_certificates::axial::{
    AxialLine, AxialMaker, AxialNetwork, AxialNetworkError, AxialPortal, AxialProofs, Box3, Branch, Bypass,
    CheckedProof, Claim, Sum,
};
use sightlines_certificates::{Kind, NoWall, Refusal, kind_of};

/// Two rooms side by side with a thick wall between them, and a corridor behind both that joins them. Doors are at
/// the far ends, so that the rooms do not see each other.
fn rooms() -> (Vec<Box3>, Vec<AxialPortal>) {
    let cells = vec![
        [[0.0, 0.0, 0.0], [4.0, 4.0, 2.0]],
        [[5.0, 0.0, 0.0], [9.0, 4.0, 2.0]],
        [[0.0, 4.0, 0.0], [9.0, 5.0, 2.0]],
    ];
    let door = |cell: u32, x: f64| AxialPortal {
        cells: [cell, 2],
        extent: [[x, 4.0, 0.0], [x + 1.0, 4.0, 2.0]],
        axis: 1,
        forward: true,
    };
    (cells, vec![door(0, 0.0), door(1, 8.0)])
}

fn network() -> AxialNetwork {
    let (cells, portals) = rooms();
    AxialNetwork::new(&cells, &portals).unwrap()
}

/// The face of the wall towards the first room; as high and as long as the rooms.
const WALL: Box3 = [[4.0, 0.0, 0.0], [4.0, 4.0, 2.0]];

/// A way beside the wall before it is entered (or after it is left) along an axis, and why no line takes it.
fn beside(axis: u8, before: bool) -> (Bypass, Branch) {
    let taken = (Claim::Taken { depth: 0, part: 0 }, 1.into());
    let reason = if before {
        Claim::Box { second: false, enter: axis, leave: 0 }
    } else {
        Claim::Box { second: true, enter: 0, leave: axis }
    };
    (Bypass::Beside { axis, before }, Branch::Empty(vec![taken, (reason, 1.into())]))
}

/// No line gets past the wall, in any octant.
fn past(blocker: u32) -> Branch {
    Branch::Past {
        blocker,
        ways: [(1, true), (1, false), (2, true), (2, false)].map(|(k, b)| beside(k, b)).to_vec(),
        rest: None,
    }
}

/// Octants towards larger x; the others lead away from the second room.
const OCTANTS: [u8; 4] = [1, 3, 5, 7];

fn boxes_of(network: &AxialNetwork) -> [Box3; 2] {
    let _ = network;
    let (cells, _) = rooms();
    [cells[0], cells[1]]
}

fn lines() -> [AxialLine; 2] {
    [
        AxialLine::through(2, [0.5, 4.5, 1.0], [0.625, 3.0, 1.125]),
        AxialLine::through(1, [8.5, 3.0, 1.0], [8.625, 4.5, 1.125]),
    ]
}

fn proofs() -> AxialProofs {
    let network = network();
    let walls = [WALL];
    let mut maker = AxialMaker::new(&network, &walls);
    assert!(lines().into_iter().all(|line| maker.take_line(line, 1)));
    assert!(!maker.take_line(lines()[0], 1), "it proves nothing new");
    let [first, second] = boxes_of(&network);
    assert!(maker.take_boxes([&first, &second], OCTANTS.map(|octant| (octant, past(0))).to_vec()));
    assert_eq!((maker.visible().len(), maker.hidden().len()), (2, 1));
    maker.finish()
}

#[test]
fn whole_tables_are_proven() {
    let proven = proofs().check(&network()).unwrap();
    assert_eq!(proven.hidden.iter().collect::<Vec<_>>(), [[0, 1]]);
    assert_eq!(proven.visible.iter().collect::<Vec<_>>(), [[0, 2], [1, 2]]);
    assert_eq!(proven.n_open(), 0);
    let bytes = proofs().to_bytes();
    assert_eq!(AxialProofs::from_bytes(&bytes), Ok(proofs()));
    assert_eq!(kind_of(&bytes), Ok(Kind::Axial));
    assert!((0..bytes.len()).all(|n| AxialProofs::from_bytes(&bytes[..n]).is_err()));
}

/// Objects: in the second room; against the wall, on its far face; in the corridor; on the near face of the wall; a segment.
const OBJECTS: [Box3; 5] = [
    [[6.0, 1.0, 0.0], [7.0, 2.0, 1.0]],
    [[5.0, 1.0, 0.0], [5.0, 2.0, 1.0]],
    [[2.0, 4.5, 0.0], [3.0, 4.75, 1.0]],
    [[4.0, 1.0, 0.0], [4.0, 2.0, 1.0]],
    [[6.0, 1.0, 0.0], [6.0, 1.0, 1.0]],
];

fn with_objects() -> (AxialNetwork, AxialProofs) {
    let network = network().with_objects(&OBJECTS);
    let walls = [WALL];
    let mut maker = AxialMaker::new(&network, &walls);
    let all = || OCTANTS.map(|octant| (octant, past(0))).to_vec();
    let [first, second] = boxes_of(&network);
    assert!((0..2).all(|object| maker.take_object(&first, object, all())));
    // The first room sees the corridor and the near face of its wall; a segment is seen by no open set of lines, and has no proofs; there
    // is no sixth object; the second room sees what is in it; and nothing is proven without branches.
    assert!((2..6).all(|object| !maker.take_object(&first, object, all())));
    assert!(!maker.take_object(&second, 0, all()) && !maker.take_object(&first, 0, Vec::new()));
    assert_eq!(maker.hidden_objects().len(), 2);
    let proofs = maker.finish();
    (network, proofs)
}

#[test]
fn objects_are_proven_hidden() {
    let (network, proofs) = with_objects();
    let proven = proofs.check(&network).unwrap();
    let pairs = (0..3).flat_map(|cell| (0..5).map(move |object| (cell, object)));
    let hidden: Vec<_> = pairs.filter(|&(cell, object)| proven.hidden_objects.has(cell, object)).collect();
    assert_eq!(hidden, [(0, 0), (0, 1)]);
    let bytes = proofs.to_bytes();
    assert_eq!((AxialProofs::from_bytes(&bytes), bytes[8]), (Ok(proofs.clone()), 2));
    assert!((0..bytes.len()).all(|n| AxialProofs::from_bytes(&bytes[..n]).is_err()));
    // Without proofs about objects, they are as they were before there were any; an empty list of them is refused, as is another version.
    let none = AxialProofs { objects: vec![], objects_checksum: 0, ..proofs };
    assert_eq!(none.to_bytes()[8], 1);
    let empty = with_body(&none.to_bytes(), |body| {
        body[8] = 2;
        body.extend([0; 5]);
    });
    assert!(AxialProofs::from_bytes(&empty).is_err());
    assert!(
        [0, 3].iter().all(|&version| AxialProofs::from_bytes(&with_body(&bytes, |body| body[8] = version)).is_err())
    );
    assert!(AxialProofs::from_bytes(&with_body(&bytes, |body| body[8] = 1)).is_err());
}

/// What one maker has checked or taken is taken again from its bytes, and checked again; not from bytes that are damaged, nor by a maker for something else.
#[test]
fn what_was_checked_is_checked_again() {
    let (network, walls) = (network().with_objects(&OBJECTS), [WALL]);
    let [first, second] = boxes_of(&network);
    let all = || OCTANTS.map(|octant| (octant, past(0))).to_vec();
    let mut maker = AxialMaker::new(&network, &walls);
    assert!(maker.check_boxes([&second, &first], all()).is_none() && maker.check_object(&first, 2, all()).is_none());
    let found = [maker.check_boxes([&first, &second], all()), maker.check_object(&first, 1, all())].map(Option::unwrap);
    let bytes = CheckedProof::all_to_bytes(&found);
    assert!(maker.hidden().is_empty(), "checked, and not taken");
    let mut other = AxialMaker::new(&network, &walls);
    let again = other.check_bytes(&bytes).unwrap();
    assert!(found.into_iter().all(|proof| maker.take(proof)) && again.into_iter().all(|proof| other.take(proof)));
    assert!(lines().into_iter().all(|line| maker.take_line(line, 1)));
    let lines = [maker.lines_since(0), maker.lines_since(1), maker.lines_since(9)];
    assert!(other.take_lines_again(&lines[0]) && other.take_lines_again(&lines[2]));
    assert!(!other.take_lines_again(&lines[1]), "a line that proves nothing new");
    assert!((0..lines[0].len()).all(|n| !AxialMaker::new(&network, &walls).take_lines_again(&lines[0][..n])));
    assert!((0..bytes.len()).all(|n| other.check_bytes(&bytes[..n]).is_none()));
    for (at, bit) in (0..bytes.len()).flat_map(|at| (0..8).map(move |bit| (at, bit))) {
        let mut changed = bytes.clone();
        changed[at] ^= 1 << bit;
        let mut maker = AxialMaker::new(&network, &walls);
        for proof in maker.check_bytes(&changed).into_iter().flatten() {
            maker.take(proof);
        }
        let proven = maker.finish().check(&network).expect("what is taken holds");
        assert!(proven.hidden.iter().all(|pair| pair == [0, 1]));
    }
    // The impostor: a proof that holds elsewhere. The wall is no wall for another maker, or of another list.
    let no_walls = [[[4.5, 0.0, 0.0], [4.5, 4.0, 2.0]]];
    assert!(AxialMaker::new(&network, &no_walls).check_bytes(&bytes).is_none());
    let (same, same_walls) = (network.clone(), [WALL]);
    for (network, walls) in [(&same, &walls), (&network, &same_walls)] {
        let proof = other.check_boxes([&first, &second], all()).unwrap();
        assert!(!AxialMaker::new(network, walls).take(proof));
    }
    assert_eq!(maker.finish(), other.finish());
}

/// Where all cells that an object touches are hidden, no line gets to it: that needs no proof of its own. One that touches the corridor, too, is not
/// out of reach; one that touches no cell is, from everywhere.
#[test]
fn objects_out_of_reach_are_proven_hidden() {
    let spanning = [[6.0, 3.0, 0.0], [7.0, 4.0, 1.0]];
    let buried = [[4.25, 1.0, 0.5], [4.75, 2.0, 1.0]];
    let objects = [OBJECTS[0], OBJECTS[1], OBJECTS[2], OBJECTS[3], OBJECTS[4], spanning, buried];
    let network = network().with_objects(&objects);
    let proven = proofs().check(&network).unwrap();
    let pairs = (0..3).flat_map(|cell| (0..7).map(move |object| (cell, object)));
    let hidden: Vec<_> = pairs.filter(|&(cell, object)| proven.hidden_objects.has(cell, object)).collect();
    assert_eq!(hidden, [(0, 0), (0, 1), (0, 4), (0, 6), (1, 3), (1, 6), (2, 6)]);
    let walls = [WALL];
    let mut maker = AxialMaker::new(&network, &walls);
    maker.add_out_of_reach();
    assert_eq!(maker.hidden_objects().len(), 3, "the buried one, before anything is proven");
    let [first, second] = boxes_of(&network);
    assert!(maker.take_boxes([&first, &second], OCTANTS.map(|octant| (octant, past(0))).to_vec()));
    maker.add_out_of_reach();
    assert_eq!(*maker.hidden_objects(), proven.hidden_objects);
}

#[test]
fn impostors_about_objects_are_refused() {
    let (network, proofs) = with_objects();
    let refused = |change: &dyn Fn(&mut AxialProofs)| {
        let mut proofs = proofs.clone();
        change(&mut proofs);
        proofs.check(&network).unwrap_err()
    };
    let wrong = |object| Refusal::Object { index: 0, object };
    for object in [2, 3, 4, 5] {
        assert_eq!(refused(&|p| p.objects[0].object = object), wrong(object));
    }
    let name = |b: Box3| network.name(&b).unwrap();
    assert_eq!(refused(&|p| p.objects[0].cells = name(boxes_of(&network)[1])), wrong(0));
    assert_eq!(refused(&|p| p.objects[0].cells = name([[0.0, 0.0, 0.0], [9.0, 5.0, 2.0]])), wrong(0));
    assert_eq!(refused(&|p| drop(p.objects[0].octants.remove(2))), wrong(0));
    assert_eq!(refused(&|p| p.objects_checksum ^= 1), Refusal::OtherObjects);
    // Another object in its place, elsewhere by a unit in the last place; and none.
    let mut moved = OBJECTS;
    moved[4][0][0] = moved[4][0][0].next_up();
    assert_eq!(proofs.check(&self::network().with_objects(&moved)), Err(Refusal::OtherObjects));
    assert_eq!(proofs.check(&self::network()), Err(Refusal::OtherObjects));
}

fn refused(change: impl FnOnce(&mut AxialProofs)) -> Refusal {
    let mut proofs = proofs();
    change(&mut proofs);
    proofs.check(&network()).unwrap_err()
}

/// The impostors, one for each thing that can be wrong.
/// A change of the ways past a blocker, or of a sum.
type Change<'a> = &'a dyn Fn(&mut Vec<(Bypass, Branch)>, &mut Option<Sum>);

#[test]
fn impostors_are_refused() {
    let through_a_wall = AxialLine::through(0, [1.0, 1.0, 1.0], [8.0, 2.0, 1.5]);
    assert_eq!(refused(|p| p.lines.push(through_a_wall)), Refusal::Line { index: 2, cell: 0 });
    assert_eq!(refused(|p| p.lines[0].cell = 7), Refusal::Line { index: 0, cell: 7 });
    assert_eq!(refused(|p| p.checksum ^= 1), Refusal::OtherTable);
    let name = |b: Box3| network().name(&b).unwrap();
    let blocker = |b: Box3| refused(|p| p.blockers[0] = name(b));
    let why = |why| Refusal::Blocker { index: 0, why };
    assert_eq!(blocker([[4.0, 0.0, 0.0], [4.0, 5.0, 2.0]]), why(NoWall::Cell(2)));
    assert_eq!(blocker([[0.0, 4.0, 0.0], [4.0, 4.0, 2.0]]), why(NoWall::Portal(0)));
    assert_eq!(blocker([[0.0, 0.0, 0.0], [4.0, 4.0, 2.0]]), why(NoWall::Shape));
    assert_eq!(blocker([[4.0, 0.0, 0.0], [4.0, 0.0, 2.0]]), why(NoWall::Shape));
    // A wall, but not one that is in the way; and none at all.
    let wrong = Refusal::Boxes { index: 0 };
    assert_eq!(blocker([[0.0, 0.0, 0.0], [0.0, 4.0, 2.0]]), wrong);
    assert_eq!(blocker([[9.0, 0.0, 0.0], [9.0, 4.0, 2.0]]), wrong);
    assert_eq!(refused(|p| p.blockers.clear()), wrong);
    // Other boxes: with the corridor there are lines.
    let both = name([[0.0, 0.0, 0.0], [9.0, 5.0, 2.0]]);
    assert_eq!(refused(|p| p.boxes[0].boxes[0] = both), wrong);
    assert_eq!(refused(|p| p.boxes[0].boxes.swap(0, 1)), wrong);
    for k in 0..4 {
        assert_eq!(refused(|p| drop(p.boxes[0].octants.remove(k))), wrong, "octant {k}");
        let ways = |p: &mut AxialProofs, change: Change<'_>| {
            if let Branch::Past { ways, rest, .. } = &mut p.boxes[0].octants[k].1 {
                change(ways, rest);
            }
        };
        for way in 0..4 {
            assert_eq!(refused(|p| ways(p, &|ways, _| drop(ways.remove(way)))), wrong);
            let sum = |p: &mut AxialProofs, change: &dyn Fn(&mut Sum)| {
                ways(p, &|ways, _| {
                    if let Branch::Empty(sum) = &mut ways[way].1 {
                        change(sum);
                    }
                });
            };
            for at in 0..2 {
                assert_eq!(refused(|p| sum(p, &|sum| sum[at].1 = 0.into())), wrong);
                assert_eq!(refused(|p| sum(p, &|sum| sum[at].1 = (-1).into())), wrong);
                assert_eq!(refused(|p| sum(p, &|sum| sum[at].1 = 2.into())), wrong);
                assert_eq!(refused(|p| sum(p, &|sum| drop(sum.remove(at)))), wrong);
            }
            assert_eq!(refused(|p| sum(p, &|sum| sum.clear())), wrong);
            assert_eq!(refused(|p| sum(p, &|sum| sum[0].0 = Claim::Taken { depth: 1, part: 0 })), wrong);
            assert_eq!(refused(|p| sum(p, &|sum| sum[0].0 = Claim::Taken { depth: 0, part: 1 })), wrong);
            assert_eq!(refused(|p| sum(p, &|sum| sum[1].0 = Claim::Box { second: true, enter: 0, leave: 0 })), wrong);
            // The reverse of a way that no earlier branch takes.
            let (other, _) = beside(1, true);
            assert_eq!(refused(|p| sum(p, &|sum| sum[0].0 = Claim::Reversed { depth: 0, way: other })), wrong);
        }
        // A rest needs a proof.
        assert_eq!(refused(|p| ways(p, &|_, rest| *rest = Some(Vec::new()))), wrong);
    }
}

#[test]
fn makers_take_nothing_wrong() {
    let network = network();
    let [first, second] = boxes_of(&network);
    let walls = [[[0.0, 4.0, 0.0], [4.0, 4.0, 2.0]], [[9.0, 0.0, 0.0], [9.0, 4.0, 2.0]], WALL];
    let mut maker = AxialMaker::new(&network, &walls);
    let all = |blocker| OCTANTS.map(|octant| (octant, past(blocker))).to_vec();
    assert!((0..2).all(|blocker| !maker.take_boxes([&first, &second], all(blocker))) && maker.hidden().is_empty());
    assert!(!maker.take_boxes([&second, &first], all(2)) && !maker.take_boxes([&first, &second], Vec::new()));
    assert!(maker.take_boxes([&first, &second], all(2)));
    assert_eq!(maker.finish().blockers.len(), 1);
}

type Ways = Vec<(Bypass, Branch)>;

/// The maker accepts only what comes back from bytes unchanged, true or not.
#[test]
fn makers_take_nothing_that_bytes_cannot_hold() {
    let network = network();
    let [first, second] = boxes_of(&network);
    let walls = [WALL];
    let all = || OCTANTS.map(|octant| (octant, past(0))).to_vec();
    let taken = |octants: Vec<(u8, Branch)>| {
        let mut maker = AxialMaker::new(&network, &walls);
        let taken = maker.take_boxes([&first, &second], octants);
        let proofs = maker.finish();
        assert_eq!(AxialProofs::from_bytes(&proofs.to_bytes()), Ok(proofs));
        taken
    };
    assert!(taken(all()));
    // Two branches for one octant, of which the second holds; an octant that does not exist.
    assert!(!taken([vec![(1, Branch::Empty(Vec::new()))], all()].concat()));
    assert!(!taken([vec![(8, past(0))], all()].concat()));
    // Too many ways, too many claims, too deep a tree.
    let with = |change: &dyn Fn(&mut Ways)| {
        let mut octants = all();
        if let Branch::Past { ways, .. } = &mut octants[0].1 {
            change(ways);
        }
        taken(octants)
    };
    assert!(
        with(&|ways| ways.extend(vec![ways[0].clone(); 96])) && !with(&|ways| ways.extend(vec![ways[0].clone(); 97]))
    );
    let longer = |n: usize| {
        with(&move |ways| {
            if let Branch::Empty(sum) = &mut ways[0].1 {
                *sum = (0..n).flat_map(|_| sum.clone()).collect();
            }
        })
    };
    assert!(longer(127) && !longer(128));
    let deep = |n: usize| {
        let one = |inner: Branch, depth: u32| {
            let mut outer = past_at(depth);
            if let Branch::Past { ways, .. } = &mut outer {
                ways.insert(0, (Bypass::InFirst, inner));
            }
            outer
        };
        let mut octants = all();
        octants[0].1 = (0..n as u32).rev().fold(past_at(n as u32), one);
        taken(octants)
    };
    assert!(deep(199) && !deep(200));
}

/// As [`past`], behind so many others.
fn past_at(depth: u32) -> Branch {
    let mut branch = past(0);
    if let Branch::Past { ways, .. } = &mut branch {
        for (_, branch) in ways {
            if let Branch::Empty(sum) = branch {
                sum[0].0 = Claim::Taken { depth, part: 0 };
            }
        }
    }
    branch
}

#[test]
fn networks_that_are_none_are_refused() {
    let with = |change: &dyn Fn(&mut Vec<Box3>, &mut Vec<AxialPortal>)| {
        let (mut cells, mut portals) = rooms();
        change(&mut cells, &mut portals);
        AxialNetwork::new(&cells, &portals).unwrap_err()
    };
    assert_eq!(with(&|c, _| c[1][1][2] = 0.0), AxialNetworkError::Cell(1));
    assert_eq!(with(&|c, _| c[1][0][2] = f64::NEG_INFINITY), AxialNetworkError::Cell(1));
    assert_eq!(with(&|_, p| p[0].cells = [2, 2]), AxialNetworkError::Cells(0));
    assert_eq!(with(&|_, p| p[0].cells = [0, 3]), AxialNetworkError::Cells(0));
    assert_eq!(with(&|_, p| p[0].axis = 0), AxialNetworkError::OffWall { portal: 0, cell: 0 });
    assert_eq!(with(&|_, p| p[0].axis = 7), AxialNetworkError::OffWall { portal: 0, cell: 0 });
    assert_eq!(with(&|_, p| p[0].forward = false), AxialNetworkError::OffWall { portal: 0, cell: 0 });
    assert_eq!(with(&|_, p| p[0].extent[1][2] = 2.5), AxialNetworkError::OffWall { portal: 0, cell: 0 });
    assert_eq!(with(&|_, p| p[0].cells[1] = 1), AxialNetworkError::OffWall { portal: 0, cell: 1 });
}

/// The same frame with a right checksum around another body.
fn with_body(bytes: &[u8], change: impl FnOnce(&mut Vec<u8>)) -> Vec<u8> {
    let mut other = bytes[..bytes.len() - 4].to_vec();
    change(&mut other);
    let checksum = crc32fast::hash(&other);
    other.extend(checksum.to_le_bytes());
    other
}

proptest! {
    /// Bytes that are changed, with a right checksum, are refused or prove only what is true.
    #[test]
    fn nothing_wrong_is_proven_by_changed_bytes(changes in prop::collection::vec((13usize..400, any::<u8>()), 1..4)) {
        let bytes = with_body(&proofs().to_bytes(), |body| {
            for &(at, byte) in &changes {
                if let Some(old) = body.get_mut(at) {
                    *old = byte;
                }
            }
        });
        if let Ok(proven) = AxialProofs::from_bytes(&bytes).map(|read| read.check(&network())) {
            let is_true = proven.is_ok_and(|p| !p.visible.has(0, 1) && p.hidden.iter().all(|pair| pair == [0, 1]));
            prop_assert!(is_true || AxialProofs::from_bytes(&bytes).is_ok_and(|read| read.check(&network()).is_err()));
        }
    }
}
