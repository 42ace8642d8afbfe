//! Proofs of maps written by hand: good ones are accepted, impostors are refused, and whatever is accepted is true.

use proptest::prelude::*;
use sightlines_certificates::convex::{
    ConvexBlock, ConvexCut, ConvexLine, ConvexNetwork, ConvexNetworkError, ConvexPlane, ConvexPortal, ConvexProofs,
    ConvexSums, ConvexTerm, ConvexTree, ConvexWalk, Point,
};
use sightlines_certificates::{Kind, ReadErrorKind, Refusal, kind_of};

/// A square door across the x axis, of size 1, its lowest corner at `y` and 0.
fn door(a: u32, y: f64) -> ConvexPortal {
    let x = 4.0 * f64::from(a + 1);
    ConvexPortal {
        cells: [a, a + 1],
        corners: [[0., 0.], [1., 0.], [1., 1.], [0., 1.]].map(|[u, z]| [x, y + u, z]).to_vec(),
    }
}

/// Four rooms in a row. Doors are left, right and left again, so only the first and the last do not see each other.
fn rooms() -> Vec<ConvexPortal> {
    vec![door(0, 0.0), door(1, 3.0), door(2, 0.0)]
}

fn network() -> ConvexNetwork {
    ConvexNetwork::new(4, &rooms(), 0.0).unwrap()
}

/// The plane through the near edge of the second door and the far one of the first.
fn plane() -> ConvexBlock {
    ConvexBlock::Plane(ConvexPlane { stops: [2, 1], edge: [1, 3], corner: [2, 1] })
}

fn term(gate: u32, edge: u32, times: f64) -> ConvexTerm {
    ConvexTerm { gate, edge, times }
}

/// Lines from the first door to the third have the near edge of the second on its outer side.
fn sums() -> ConvexBlock {
    ConvexBlock::Sums(ConvexSums { ends: [2, 0], tree: ConvexTree::Sum(vec![term(1, 3, 1.0)]) })
}

/// The same in two parts, by where lines leave the third door.
fn cut(later: bool) -> ConvexBlock {
    let part = |times| ConvexTree::Sum(vec![term(1, 3, times), term(1, 3, 0.1)]);
    let cut = ConvexCut { later, plane: [0.0, 3.0, 0.0, -1.0], parts: [part(1.0), part(2.5)] };
    ConvexBlock::Sums(ConvexSums { ends: [2, 0], tree: ConvexTree::Cut(Box::new(cut)) })
}

fn proofs(block: ConvexBlock) -> ConvexProofs {
    ConvexProofs {
        checksum: network().checksum(),
        lines: vec![
            ConvexLine::through(0, [4.0, 0.5, 0.5], [8.0, 3.5, 0.5]),
            ConvexLine::through(5, [12.0, 0.5, 0.1], [8.0, 3.5, 0.1]),
        ],
        unproven: Vec::new(),
        walks: vec![ConvexWalk::new(0, vec![], &[true, false], vec![block])],
    }
}

#[test]
fn whole_tables_are_proven() {
    for block in [plane(), sums(), cut(false), cut(true)] {
        let proofs = proofs(block);
        let proven = proofs.check(&network()).unwrap();
        assert_eq!(proven.hidden.iter().collect::<Vec<_>>(), [[0, 3]]);
        assert_eq!(proven.visible.iter().collect::<Vec<_>>(), [[0, 1], [0, 2], [1, 2], [1, 3], [2, 3]]);
        assert_eq!(proven.n_open(), 0);
        let bytes = proofs.to_bytes();
        assert_eq!(ConvexProofs::from_bytes(&bytes), Ok(proofs));
        assert_eq!(kind_of(&bytes), Ok(Kind::Convex));
    }
}

#[test]
fn what_is_not_proven_is_open() {
    let with = |change: &dyn Fn(&mut ConvexProofs)| {
        let mut proofs = proofs(plane());
        change(&mut proofs);
        proofs.check(&network()).unwrap().n_open()
    };
    assert_eq!(with(&|p| p.walks.clear()), 1);
    assert_eq!(with(&|p| p.walks[0] = ConvexWalk::new(0, vec![2], &[], vec![])), 1);
    assert_eq!(with(&|p| p.walks[0].targets = vec![2, 3]), 0);
    let left_open = |p: &mut ConvexProofs| {
        p.lines.pop();
        p.unproven = vec![[1, 3], [2, 3]];
    };
    assert_eq!(with(&left_open), 2);
}

/// The impostors, one for each thing that can be wrong.
#[test]
fn impostors_are_refused() {
    let refused = |change: &dyn Fn(&mut ConvexProofs)| {
        let mut proofs = proofs(plane());
        change(&mut proofs);
        proofs.check(&network()).unwrap_err()
    };
    let beside = ConvexLine::through(2, [4.0, 0.5, 0.5], [12.0, 0.5, 0.5]);
    assert_eq!(refused(&|p| p.lines.push(beside)), Refusal::Gate { index: 2, gate: 2 });
    assert_eq!(refused(&|p| p.lines[0].gate = 1), Refusal::Gate { index: 0, gate: 1 });
    assert_eq!(refused(&|p| p.lines[0].gate = 99), Refusal::Gate { index: 0, gate: 99 });
    assert_eq!(refused(&|p| p.lines[0].bits[1] = p.lines[0].bits[0]), Refusal::Gate { index: 0, gate: 0 });
    assert_eq!(refused(&|p| p.checksum ^= 1), Refusal::OtherTable);
    assert_eq!(refused(&|p| p.unproven = vec![[2, 2]]), Refusal::Pair { index: 0 });
    assert_eq!(refused(&|p| p.unproven = vec![[2, 4]]), Refusal::Pair { index: 0 });
    assert_eq!(refused(&|p| p.walks[0].source = 4), Refusal::Source { walk: 0, from: 4 });
    assert_eq!(refused(&|p| p.walks[0].targets = vec![4]), Refusal::Source { walk: 0, from: 0 });
    let walk = |open: &[bool], blocks| ConvexWalk::new(0, vec![], open, blocks);
    let entered = Refusal::Entered { walk: 0, from: 0, cell: 3 };
    assert_eq!(refused(&|p| p.walks[0] = walk(&[true, true], vec![])), entered);
    assert_eq!(refused(&|p| p.walks[0] = walk(&[true, false], vec![])), Refusal::Block { walk: 0, from: 0, block: 0 });
    assert_eq!(refused(&|p| p.walks[0] = walk(&[true], vec![plane()])), Refusal::Block { walk: 0, from: 0, block: 0 });
    assert_eq!(refused(&|p| p.walks[0].decisions.blocks.push(plane())), Refusal::Unused { walk: 0, from: 0 });
    assert_eq!(
        refused(&|p| p.walks[0] = walk(&[true, false, true], vec![plane()])),
        Refusal::Unused { walk: 0, from: 0 }
    );
    let planes =
        [([1, 2], [1, 3], [2, 1]), ([2, 2], [1, 3], [2, 1]), ([3, 1], [1, 3], [2, 1]), ([2, 0], [1, 3], [2, 1])];
    let edges =
        [([2, 1], [1, 1], [2, 1]), ([2, 1], [1, 4], [2, 1]), ([2, 1], [1, 3], [1, 0]), ([2, 1], [1, 3], [9, 1])];
    let sum =
        |ends, terms: &[ConvexTerm]| ConvexBlock::Sums(ConvexSums { ends, tree: ConvexTree::Sum(terms.to_vec()) });
    let (good, bad) = (term(1, 3, 1.0), term(1, 1, 1.0));
    let sums = [
        sum([2, 0], &[]),
        sum([0, 2], &[good]),
        sum([2, 1], &[good]),
        sum([2, 0], &[bad]),
        sum([2, 0], &[good, term(1, 1, 9.0)]),
        sum([2, 0], &[term(1, 3, 0.0)]),
        sum([2, 0], &[term(1, 3, -1.0)]),
        sum([2, 0], &[term(1, 3, f64::NAN)]),
        sum([2, 0], &[term(7, 3, 1.0)]),
        sum([2, 0], &[term(1, 4, 1.0)]),
    ];
    let planes = planes.into_iter().chain(edges);
    let planes = planes.map(|(stops, edge, corner)| ConvexBlock::Plane(ConvexPlane { stops, edge, corner }));
    for block in planes.chain(sums) {
        let refusal = refused(&|p| p.walks[0].decisions.blocks[0] = block.clone());
        assert_eq!(refusal, Refusal::Block { walk: 0, from: 0, block: 0 }, "{block:?}");
    }
    // One part of two is not enough, and neither is what is nested without an end.
    for k in 0..2 {
        let ConvexBlock::Sums(mut sums) = cut(true) else { panic!("sums") };
        let ConvexTree::Cut(parts) = &mut sums.tree else { panic!("a cut") };
        parts.parts[k] = ConvexTree::Sum(vec![bad]);
        let block = ConvexBlock::Sums(sums);
        assert!(matches!(refused(&|p| p.walks[0].decisions.blocks[0] = block.clone()), Refusal::Block { .. }));
    }
    let mut tree = ConvexTree::Sum(vec![good]);
    for _ in 0..40 {
        let part = ConvexTree::Sum(vec![good]);
        tree = ConvexTree::Cut(Box::new(ConvexCut { later: true, plane: [0.0, 1.0, 0.0, 9.0], parts: [tree, part] }));
    }
    let deep = proofs(ConvexBlock::Sums(ConvexSums { ends: [2, 0], tree }));
    assert!(matches!(deep.check(&network()), Err(Refusal::Block { .. })));
    assert_eq!(ConvexProofs::from_bytes(&deep.to_bytes()).unwrap_err().kind, ReadErrorKind::Depth);
}

/// Wrong doors are no network; other doors have another checksum.
#[test]
fn networks_are_checked() {
    let error = |change: &dyn Fn(&mut Vec<ConvexPortal>)| {
        let mut portals = rooms();
        change(&mut portals);
        ConvexNetwork::new(4, &portals, 0.0).unwrap_err()
    };
    assert_eq!(error(&|p| p[1].cells = [2, 2]), ConvexNetworkError::Cells(1));
    assert_eq!(error(&|p| p[1].cells = [2, 4]), ConvexNetworkError::Cells(1));
    assert_eq!(error(&|p| p[2].corners[0][1] = f64::NAN), ConvexNetworkError::Coordinate(2));
    assert_eq!(error(&|p| p[0].corners.truncate(2)), ConvexNetworkError::NoPolygon(0));
    assert_eq!(error(&|p| p[0].corners = vec![]), ConvexNetworkError::NoPolygon(0));
    assert_eq!(error(&|p| p[0].corners = vec![[0.0; 3], [1.0; 3], [2.0; 3]]), ConvexNetworkError::NoPolygon(0));
    for flatness in [-1.0, f64::NAN, 0.5] {
        assert_eq!(ConvexNetwork::new(4, &rooms(), flatness).unwrap_err(), ConvexNetworkError::Flatness);
    }
    let others = [ConvexNetwork::new(4, &rooms(), ConvexNetwork::OF_FILES), ConvexNetwork::new(5, &rooms(), 0.0)];
    assert!(others.iter().all(|n| n.as_ref().unwrap().checksum() != network().checksum()));
}

/// What counts as on a plane is decided by signs, or by the given flatness.
#[test]
fn gates_follow_each_other_as_planes_tell() {
    // Both doors face each other; the second leans forward by a little, over the lower edge of which the first one reaches.
    let near = |off: f64, flatness: f64| {
        let first = door(0, 0.0).corners.into_iter().map(|[x, y, z]| [x, y, 2.0 * z - 1.0]);
        let second = door(0, 2.0).corners.into_iter().rev().map(|[x, y, z]| [x + off * z, y, z]);
        let portals = [
            ConvexPortal { cells: [0, 1], corners: first.collect() },
            ConvexPortal { cells: [1, 2], corners: second.collect() },
        ];
        ConvexNetwork::new(3, &portals, flatness).unwrap().may_follow(0, 2)
    };
    let tiny = 2f64.powi(-48);
    assert!(!near(0.0, 0.0) && near(tiny, 0.0) && !near(-tiny, 0.0));
    assert!(!near(tiny, ConvexNetwork::OF_FILES) && near(2f64.powi(-30), ConvexNetwork::OF_FILES));
    let network = network();
    assert!(network.may_follow(0, 2) && network.may_follow(0, 4) && network.may_follow(5, 3));
    assert!(!network.may_follow(2, 0) && !network.may_follow(0, 0) && !network.may_follow(0, 3));
}

/// Bytes that are cut or changed, even with a right checksum, are refused or prove only what is true.
#[test]
fn damaged_bytes_prove_nothing_wrong() {
    let mut n_read = 0;
    for block in [plane(), sums(), cut(true)] {
        let good = proofs(block).to_bytes();
        for at in 0..good.len() - 4 {
            assert!(ConvexProofs::from_bytes(&good[..at]).is_err());
            for bit in 0..8 {
                let mut bytes = good.clone();
                bytes[at] ^= 1 << bit;
                assert!(ConvexProofs::from_bytes(&bytes).is_err());
                let end = bytes.len() - 4;
                let checksum = crc32fast::hash(&bytes[..end]);
                bytes[end..].copy_from_slice(&checksum.to_le_bytes());
                let Ok(read) = ConvexProofs::from_bytes(&bytes) else { continue };
                assert_eq!(ConvexProofs::from_bytes(&read.to_bytes()), Ok(read.clone()));
                let Ok(proven) = read.check(&network()) else { continue };
                assert!(!proven.visible.has(0, 3) && proven.hidden.iter().all(|pair| pair == [0, 3]));
                n_read += 1;
            }
        }
    }
    assert!(n_read > 20, "{n_read}");
}

/// A corner in whole numbers.
type Whole = [i128; 3];

fn minus(a: Whole, b: Whole) -> Whole {
    [0, 1, 2].map(|k| a[k] - b[k])
}

fn cross(a: Whole, b: Whole) -> Whole {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: Whole, b: Whole) -> i128 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Triangles, one after the other roughly, that are crossed along the x axis.
fn triangles(n: usize) -> impl Strategy<Value = Vec<[Whole; 3]>> {
    let corner = (0i128..2, 0i128..6, 0i128..6);
    prop::collection::vec(prop::array::uniform3(corner), n).prop_map(|all| {
        let place = |(k, t): (usize, [(i128, i128, i128); 3])| t.map(|(x, y, z)| [x + 3 * k as i128, y, z]);
        let turned = |[a, b, c]: [Whole; 3]| if cross(minus(b, a), minus(c, a))[0] < 0 { [a, c, b] } else { [a, b, c] };
        all.into_iter().enumerate().map(place).map(turned).collect()
    })
}

fn network_of(triangles: &[[Whole; 3]]) -> Option<ConvexNetwork> {
    let portal = |(k, t): (u32, &[Whole; 3])| ConvexPortal {
        cells: [k, k + 1],
        corners: t.map(|p| p.map(|x| x as f64)).to_vec(),
    };
    let portals: Vec<ConvexPortal> = (0..).zip(triangles).map(portal).collect();
    ConvexNetwork::new(triangles.len() + 1, &portals, 0.0).ok()
}

/// The oracle: whether the line through points of two triangles passes all of them in order, in whole numbers.
fn passes(triangles: &[[Whole; 3]], [i, j]: [usize; 2], weights: [[i128; 3]; 2]) -> bool {
    const ALL: i128 = 16;
    let point = |t: &[Whole; 3], [u, v, w]: [i128; 3]| [0, 1, 2].map(|k| u * t[0][k] + v * t[1][k] + w * t[2][k]);
    let scaled = |p: Whole| p.map(|x| ALL * x);
    let q = point(&triangles[i], weights[0]);
    let way = minus(point(&triangles[j], weights[1]), q);
    let mut last: Option<(i128, i128)> = None;
    triangles.iter().all(|t| {
        let t = t.map(scaled);
        let inside = (0..3).all(|k| dot(way, cross(minus(t[k], q), minus(t[(k + 1) % 3], q))) > 0);
        let normal = cross(minus(t[1], t[0]), minus(t[2], t[0]));
        let (num, den) = (dot(normal, minus(t[0], q)), dot(normal, way));
        let is_later = last.is_none_or(|(n, d)| n * den < num * d);
        last = Some((num, den));
        inside && is_later
    })
}

fn weights() -> impl Strategy<Value = [i128; 3]> {
    (1i128..15, 1i128..15)
        .prop_map(|(u, v)| if u + v < 16 { [u, v, 16 - u - v] } else { [16 - u.max(2), 1, u.max(2) - 1] })
}

fn any_sum() -> impl Strategy<Value = ConvexBlock> {
    let term = (0u32..3, 0u32..3, 1u32..5).prop_map(|(gate, edge, times)| term(gate, edge, f64::from(times)));
    (prop::sample::select(vec![[2, 0], [2, 1], [1, 0]]), prop::collection::vec(term, 1..4))
        .prop_map(|(ends, terms)| ConvexBlock::Sums(ConvexSums { ends, tree: ConvexTree::Sum(terms) }))
}

fn all_planes() -> impl Iterator<Item = ConvexBlock> {
    let each = || (0..3u32).flat_map(|gate| (0..3u32).map(move |k| [gate, k]));
    each()
        .flat_map(move |edge| each().map(move |corner| ConvexBlock::Plane(ConvexPlane { stops: [2, 1], edge, corner })))
}

/// Whether some reason is accepted, and whether some line passes.
fn try_all(triangles: &[[Whole; 3]], sums: &[ConvexBlock], lines: &[[[i128; 3]; 2]]) -> Option<[bool; 2]> {
    let network = network_of(triangles)?;
    let blocks = all_planes().chain(sums.iter().cloned());
    let is_blocked = blocks.filter(|block| block.holds(&network, &[0, 2], 4)).count() > 0;
    let is_behind = !network.may_follow(0, 2) || !network.may_follow(2, 4) || !network.may_follow(0, 4);
    let is_passed = lines.iter().any(|&w| [[0, 2], [0, 1], [1, 2]].into_iter().any(|ends| passes(triangles, ends, w)));
    assert!(!is_passed || !(is_blocked || is_behind), "{triangles:?}: a line passes what is blocked");
    Some([is_blocked || is_behind, is_passed])
}

proptest! {
    /// No line of many refutes a reason that is accepted.
    #[test]
    fn no_line_passes_what_is_blocked(
        triangles in triangles(3),
        sums in prop::collection::vec(any_sum(), 60),
        lines in prop::collection::vec(prop::array::uniform2(weights()), 60),
    ) {
        let _ = try_all(&triangles, &sums, &lines);
    }

    #[test]
    fn proofs_come_back(
        sums in prop::collection::vec(any_sum(), 0..4),
        times in prop::collection::vec(prop_oneof![Just(1.0), Just(0.1), Just(0.5), Just(70_000.0)], 1..4),
        targets in prop::collection::btree_set(0u32..9, 0..4),
        open in prop::collection::vec(any::<bool>(), 0..20),
        point in prop::array::uniform3(-1e3f64..1e3),
    ) {
        let terms = times.iter().map(|&times| term(3, 1, times)).collect();
        let other = ConvexBlock::Sums(ConvexSums { ends: [900, 2], tree: ConvexTree::Sum(terms) });
        let blocks = sums.into_iter().chain([other, plane(), cut(false)]).collect();
        let proofs = ConvexProofs {
            checksum: 77,
            lines: vec![ConvexLine::through(4, point, [1.0, 2.0, 3.0])],
            unproven: vec![[0, 1], [0, 5], [3, 4]],
            walks: vec![ConvexWalk::new(8, targets.into_iter().collect(), &open, blocks)],
        };
        prop_assert_eq!(ConvexProofs::from_bytes(&proofs.to_bytes()), Ok(proofs));
    }
}

/// The twin of the test above: some triangles are blocked, and lines pass some; for most triangles one of the two is
/// found.
#[test]
fn much_is_blocked_and_much_is_passed() {
    use proptest::strategy::ValueTree;
    use proptest::test_runner::TestRunner;
    let mut runner = TestRunner::deterministic();
    let input = (
        triangles(3),
        prop::collection::vec(any_sum(), 60),
        prop::collection::vec(prop::array::uniform2(weights()), 60),
    );
    let (mut n_blocked, mut n_passed, mut n_all) = (0, 0, 0);
    for _ in 0..200 {
        let (triangles, sums, lines) = input.new_tree(&mut runner).unwrap().current();
        let Some([is_blocked, is_passed]) = try_all(&triangles, &sums, &lines) else { continue };
        n_all += 1;
        n_blocked += usize::from(is_blocked);
        n_passed += usize::from(is_passed);
    }
    assert!(n_blocked > 20 && n_passed > 20 && n_blocked + n_passed > n_all * 3 / 4, "{n_blocked} {n_passed} {n_all}");
}

/// A line that passes portals in another order than its cells are in is no witness.
#[test]
fn lines_pass_portals_one_after_the_other() {
    let mut portals = rooms();
    portals[1] = door(1, 0.0);
    portals.iter_mut().for_each(|p| p.corners.iter_mut().for_each(|c: &mut Point| c[1] *= 2.0));
    let along = ConvexLine::through(0, [0.0, 1.0, 0.5], [20.0, 1.0, 0.5]);
    assert_eq!(ConvexNetwork::new(4, &portals, 0.0).unwrap().follow(&along), [0, 1, 2, 3]);
    // The second door behind the third.
    portals[1].corners.iter_mut().for_each(|c| c[0] = 16.0);
    assert_eq!(ConvexNetwork::new(4, &portals, 0.0).unwrap().follow(&along), [0, 1, 2]);
}

/// A square across the x axis.
fn square(x: f64, cells: [u32; 2], half: f64) -> ConvexPortal {
    let corners = vec![[x, -half, -half], [x, half, -half], [x, half, half], [x, -half, half]];
    ConvexPortal { cells, corners }
}

/// However long a portal is along its plane: what lies clearly behind it may follow it, and no walk leaves that out.
#[test]
fn long_portals_are_no_thicker() {
    for (x, half) in [(40.0, 2f64.powi(50)), (1e-7, 1e7)] {
        let portals = [square(0.0, [0, 1], half), square(x, [1, 2], 1.0)];
        let network = ConvexNetwork::new(3, &portals, ConvexNetwork::OF_FILES).unwrap();
        let line = ConvexLine::through(0, [-1.0, 0.1, 0.2], [x + 1.0, 0.2, 0.1]);
        let checksum = network.checksum();
        let seen = ConvexProofs { checksum, lines: vec![line], ..ConvexProofs::default() };
        assert!(seen.check(&network).unwrap().visible.has(0, 2));
        let walks = vec![ConvexWalk::new(0, vec![2], &[], vec![])];
        let hidden = ConvexProofs { checksum, walks, ..ConvexProofs::default() };
        assert!(hidden.check(&network).is_err(), "{x} {half}");
    }
    // What is assumed: 2^-50 of the coordinates is rounding.
    let portals = [square(1.0, [0, 1], 1.0), square(1.0 + 2f64.powi(-50), [1, 2], 1.0)];
    let network = ConvexNetwork::new(3, &portals, ConvexNetwork::OF_FILES).unwrap();
    assert!(!network.may_follow(0, 2) && ConvexNetwork::new(3, &portals, 0.0).unwrap().may_follow(0, 2));
}

/// An edge from a corner to itself has no side, so it would block everything.
#[test]
fn edges_have_lengths() {
    let mut portal = square(0.0, [0, 1], 1.0);
    portal.corners.insert(1, portal.corners[0]);
    assert_eq!(ConvexNetwork::new(2, &[portal], 0.0).unwrap_err(), ConvexNetworkError::NoPolygon(0));
}

/// Repeated cuts through corners that are made by cuts, each of which nearly doubles the digits: a proof of a kilobyte
/// is refused before that takes long.
#[test]
fn corners_of_very_many_digits_are_refused() {
    let triangle = |x: f64, cells| ConvexPortal { cells, corners: vec![[x, 0.0, 0.0], [x, 1.0, 0.0], [x, 0.0, 1.0]] };
    let network = ConvexNetwork::new(3, &[triangle(0.0, [0, 1]), triangle(5.0, [1, 2])], 0.0).unwrap();
    let sum = || ConvexTree::Sum(vec![ConvexTerm { gate: 1, edge: 0, times: 1.0 }]);
    // The newest corner is cut off each time: a corner, and how often its digits were doubled.
    let mut corners: Vec<([f64; 2], u64)> = vec![([0.0, 0.0], 1), ([1.0, 0.0], 1), ([0.0, 1.0], 1)];
    let mut planes = Vec::new();
    for _ in 0..24 {
        corners.sort_by_key(|corner| corner.1);
        let [a, b, newest] = [0, 1, 2].map(|k| corners[k]);
        let half = |p: [f64; 2]| [0, 1].map(|k| (p[k] + newest.0[k]) / 2.0);
        let (m, n) = (half(a.0), half(b.0));
        let normal = [(m[1] - n[1]) * 1.0000000011, n[0] - m[0]];
        let offset = -(normal[0] * m[0] + normal[1] * m[1]);
        let is_ahead = normal[0] * newest.0[0] + normal[1] * newest.0[1] + offset > 0.0;
        let sign = if is_ahead { -0.7310585786300049 } else { 0.7310585786300049 };
        planes.push([0.0, normal[0] * sign, normal[1] * sign, offset * sign]);
        corners = vec![newest, (m, newest.1 + a.1), (n, newest.1 + b.1)];
    }
    let tree = |depth: usize| {
        planes[..depth].iter().rev().fold(sum(), |tree, &plane| {
            ConvexTree::Cut(Box::new(ConvexCut { later: false, plane, parts: [tree, sum()] }))
        })
    };
    // The sum proves nothing either; but with all cuts made exactly, this would take minutes to find out.
    let holds =
        |depth: usize| ConvexBlock::Sums(ConvexSums { ends: [1, 0], tree: tree(depth) }).holds(&network, &[0], 2);
    assert!(!holds(24));
}

/// Three doors that leave a slit of one unit in the last place, in which there is no double.
fn slit() -> ConvexNetwork {
    let below = 64.0f64.next_down();
    let door = |a: u32, y: [f64; 2]| {
        let x = 4.0 * f64::from(a + 1);
        let corners = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[k, z]| [x, y[k], f64::from(z as u8)]);
        ConvexPortal { cells: [a, a + 1], corners: corners.to_vec() }
    };
    ConvexNetwork::new(4, &[door(0, [0.0, 64.0]), door(1, [below, 100.0]), door(2, [0.0, 64.0])], 0.0).unwrap()
}

/// Lines of two doubles pass where none of doubles does, and are stored in the newest version only.
#[test]
fn lines_of_two_doubles_pass_slits_of_a_unit() {
    let network = slit();
    let half = 0.5 * (64.0f64.next_down() - 64.0);
    let with = |y: [f64; 2]| ConvexLine::through_sums(0, [4.0, 12.0].map(|x| [[x, 0.0], y, [0.5, 0.0]]));
    let proofs = |line| ConvexProofs { checksum: network.checksum(), lines: vec![line], ..ConvexProofs::default() };
    let fine = proofs(with([64.0, half]));
    assert_eq!(fine.check(&network).unwrap().visible.len(), 6);
    assert_eq!(network.follow(&with([64.0, half])), [0, 1, 2, 3]);
    // The impostors: both ends of the slit, and beyond.
    for rest in [0.0, 2.0 * half, 3.0 * half] {
        assert_ne!(network.follow(&with([64.0, rest])).len(), 4, "{rest:e}");
    }
    assert_eq!(proofs(with([64.0, 0.0])).check(&network).unwrap_err(), Refusal::Gate { index: 0, gate: 0 });
    assert!(proofs(with([64.0, f64::NAN])).check(&network).is_err());

    let bytes = fine.to_bytes();
    assert_eq!(ConvexProofs::from_bytes(&bytes), Ok(fine.clone()));
    assert_eq!((bytes[8], proofs(with([63.0, 0.0])).to_bytes()[8]), (2, 1));
    for n in 0..bytes.len() {
        assert!(ConvexProofs::from_bytes(&bytes[..n]).is_err(), "{n} bytes");
    }
    // The same bytes as of the first version, which has no such lines.
    let mut old = bytes;
    old[8] = 1;
    let end = old.len() - 4;
    let sum = crc32fast::hash(&old[..end]).to_le_bytes();
    old[end..].copy_from_slice(&sum);
    assert_eq!(ConvexProofs::from_bytes(&old).unwrap_err().kind, ReadErrorKind::Code(2));
}
