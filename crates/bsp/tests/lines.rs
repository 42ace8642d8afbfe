//! Openings against lines that descend a tree in whole numbers.

use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use sightlines_bsp::{Child, Node, Opening, Plane, Region, Tree, openings};
use std::cell::Cell;

/// Half the side of the cube.
const SIZE: f64 = 64.0;

/// A plane of small integers.
type Row = [i64; 4];

/// A random tree: each plane cuts a region that is there.
fn tree_of(rows: &[Row], picks: &[usize]) -> (Tree, Vec<Row>) {
    let mut nodes: Vec<Node> = Vec::new();
    for (k, row) in rows.iter().enumerate() {
        let [x, y, z, d] = row.map(|x| x as f64);
        let node = Node {
            plane: Plane { normal: [x, y, z], distance: d },
            children: [Child::Leaf(2 * k as u32), Child::Leaf(2 * k as u32 + 1)],
        };
        if k > 0 {
            let open: Vec<(usize, usize)> = (0..nodes.len())
                .flat_map(|n| [(n, 0), (n, 1)])
                .filter(|&(n, side)| matches!(nodes[n].children[side], Child::Leaf(_)))
                .collect();
            let (n, side) = open[picks[k] % open.len()];
            nodes[n].children[side] = Child::Node(k as u32);
        }
        nodes.push(node);
    }
    (Tree::new(nodes).unwrap(), rows.to_vec())
}

/// A point as whole numbers over a positive one.
type Ratio = ([i128; 3], i128);

/// How far in front of a plane a point is, times its denominator.
fn height(row: &Row, (p, w): &Ratio) -> i128 {
    (0..3).map(|k| i128::from(row[k]) * p[k]).sum::<i128>() - i128::from(row[3]) * w
}

/// The region of a point; none for a point on a plane.
fn region_at(tree: &Tree, rows: &[Row], p: &Ratio) -> Option<Region> {
    let mut at = 0;
    loop {
        let height = height(&rows[at], p);
        if height == 0 {
            return None;
        }
        let side = usize::from(height < 0);
        match tree.nodes()[at].children[side] {
            Child::Leaf(leaf) => return Some(Region { node: at as u32, side: side as u8, leaf }),
            Child::Node(below) => at = below as usize,
        }
    }
}

/// Whether a point of an opening's plane is within its corners, seen along the axis that the plane faces most. `slack`: how far outside it may be.
fn is_within(opening: &Opening, row: &Row, p: [f64; 3], slack: f64) -> bool {
    let axis = (0..3).max_by_key(|&k| row[k].abs()).unwrap();
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let sign = if row[axis] > 0 { 1.0 } else { -1.0 };
    let n = opening.corners.len();
    (0..n).all(|k| {
        let (a, b) = (opening.corners[k], opening.corners[(k + 1) % n]);
        let cross = (b[u] - a[u]) * (p[v] - a[v]) - (b[v] - a[v]) * (p[u] - a[u]);
        cross * sign >= -slack * (b[u] - a[u]).hypot(b[v] - a[v])
    })
}

fn any_tree() -> impl Strategy<Value = (Vec<Row>, Vec<usize>)> {
    let row = prop_oneof![
        (0..3usize, -20i64..=20).prop_map(|(axis, d)| {
            let mut row = [0, 0, 0, d];
            row[axis] = 1;
            row
        }),
        (-3i64..=3, -3i64..=3, -3i64..=3, -30i64..=30).prop_map(|(x, y, z, d)| [x, y, z, d]),
    ];
    let row = row.prop_filter("a normal", |r| r[..3] != [0, 0, 0]);
    (proptest::collection::vec(row, 1..14), proptest::collection::vec(any::<usize>(), 14))
}

/// The crossings of a line with planes, in order, with the regions between them. None if two crossings coincide.
fn walk(tree: &Tree, rows: &[Row], from: [i64; 3], to: [i64; 3]) -> Option<Vec<(Region, Region, Ratio)>> {
    // Crossing at t = h0 / (h0 - h1) for each plane with its ends on two sides.
    let at = |p: [i64; 3]| (p.map(i128::from), 1);
    let mut crossings: Vec<(i128, i128)> = Vec::new();
    let mut distinct: Vec<Row> = rows.to_vec();
    distinct.sort();
    distinct.dedup();
    for row in &distinct {
        let (h0, h1) = (height(row, &at(from)), height(row, &at(to)));
        if h0 == 0 || h1 == 0 {
            return None;
        }
        if (h0 > 0) != (h1 > 0) {
            crossings.push(if h0 > h1 { (h0, h0 - h1) } else { (-h0, h1 - h0) });
        }
    }
    crossings.sort_by(|a, b| (a.0 * b.1).cmp(&(b.0 * a.1)));
    // The same plane, given twice with other numbers, crosses twice at one place.
    if crossings.windows(2).any(|pair| pair[0].0 * pair[1].1 == pair[1].0 * pair[0].1) {
        return None;
    }
    let point = |(t, w): (i128, i128)| -> Ratio {
        (std::array::from_fn(|k| i128::from(from[k]) * w + (i128::from(to[k]) - i128::from(from[k])) * t), w)
    };
    let between = |a: (i128, i128), b: (i128, i128)| (a.0 * b.1 + b.0 * a.1, 2 * a.1 * b.1);
    let mut stops = vec![(0, 1)];
    stops.extend(&crossings);
    stops.push((1, 1));
    let regions: Option<Vec<Region>> =
        stops.windows(2).map(|p| region_at(tree, rows, &point(between(p[0], p[1])))).collect();
    let regions = regions?;
    let met = regions.windows(2).zip(&crossings).filter(|(pair, _)| pair[0] != pair[1]);
    Some(met.map(|(pair, &t)| (pair[0], pair[1], point(t))).collect())
}

/// Where a line goes from one region into another, they have an opening with that point; the twin: on both sides of the middle of every opening that is
/// no sliver are its regions. Returns how many points and middles were looked at.
fn check(tree: &Tree, rows: &[Row], found: &[Opening], lines: &[([i64; 3], [i64; 3])]) -> Result<[usize; 2], String> {
    let [mut n_points, mut n_middles] = [0; 2];
    for &(from, to) in lines {
        for (a, b, (p, w)) in walk(tree, rows, from, to).unwrap_or_default() {
            let q = p.map(|x| x as f64 / w as f64);
            let joins = |o: &&Opening| o.regions == [a, b] || o.regions == [b, a];
            let is_through = |o: &Opening| is_within(o, &rows[o.node as usize], q, 1e-9);
            if !found.iter().filter(joins).any(is_through) {
                return Err(format!("{a:?} to {b:?} at {q:?}: {found:?}"));
            }
            n_points += 1;
        }
    }
    for opening in found {
        let n = opening.corners.len() as f64;
        let row = rows[opening.node as usize];
        let middle: [f64; 3] = std::array::from_fn(|k| opening.corners.iter().map(|p| p[k]).sum::<f64>() / n);
        if !is_within(opening, &row, middle, -1e-3) {
            continue;
        }
        // A little off the plane, on a grid that whole numbers have.
        for side in [0, 1] {
            let off = if side == 0 { 1e-6 } else { -1e-6 };
            let p: [i128; 3] = std::array::from_fn(|k| ((middle[k] + off * row[k] as f64) * 1e9).round() as i128);
            if region_at(tree, rows, &(p, 1_000_000_000)) != Some(opening.regions[side]) {
                return Err(format!("not on both sides of its middle: {opening:?}"));
            }
        }
        n_middles += 1;
    }
    Ok([n_points, n_middles])
}

#[test]
fn lines_go_through_openings() {
    let lines = proptest::collection::vec((prop::array::uniform3(-60i64..=60), prop::array::uniform3(-60i64..=60)), 12);
    let mut runner = TestRunner::new(Config { cases: 400, failure_persistence: None, ..Config::default() });
    let (counts, caught) = (Cell::new([0; 2]), Cell::new([0; 2]));
    let outcome = runner.run(&(any_tree(), lines), |((rows, picks), lines)| {
        let (tree, rows) = tree_of(&rows, &picks);
        let mut found = openings(&tree, SIZE, |_| true).expect("a small tree takes few cuts");
        let [points, middles] = check(&tree, &rows, &found, &lines).map_err(TestCaseError::fail)?;
        counts.set([counts.get()[0] + points, counts.get()[1] + middles]);
        // Impostors: an opening that is missing, and one between other regions.
        if points > 8 && middles > 2 {
            let [missing, wrong] = caught.get();
            let last = found.len() - 1;
            let is_missed = (0..=last).any(|k| {
                let rest: Vec<Opening> =
                    found.iter().enumerate().filter(|(j, _)| *j != k).map(|(_, o)| o.clone()).collect();
                check(&tree, &rows, &rest, &lines).is_err()
            });
            found.iter_mut().for_each(|opening| opening.regions.reverse());
            caught.set([
                missing + usize::from(is_missed),
                wrong + usize::from(check(&tree, &rows, &found, &lines).is_err()),
            ]);
        }
        Ok(())
    });
    outcome.unwrap_or_else(|error| panic!("{error}"));
    let ([points, middles], [missing, wrong]) = (counts.get(), caught.get());
    eprintln!("{points} points and {middles} middles; {missing} missing and {wrong} wrong openings were noticed");
    assert!(points > 2000 && middles > 1000 && missing > 50 && wrong > 50, "{points} {middles} {missing} {wrong}");
}

/// A plane again below itself, either way round: one side of it has no volume, and no opening.
#[test]
fn a_plane_below_itself_divides_nothing() {
    for again in [[1, 0, 0, 3], [-1, 0, 0, -3], [2, 0, 0, 6], [-2, 0, 0, -6]] {
        for pick in [0, 1] {
            let (tree, _) = tree_of(&[[1, 0, 0, 3], again], &[0, pick]);
            let found = openings(&tree, SIZE, |_| true).unwrap();
            assert_eq!(found.len(), 1, "{again:?} on side {pick}: {found:?}");
            // What is above the plane, and what is below it.
            let inner = Region { node: 1, side: u8::from((pick == 0) != (again[0] > 0)), leaf: 0 };
            let is_there = found[0].regions.iter().any(|r| (r.node, r.side) == (inner.node, inner.side));
            assert!(is_there, "{again:?} on side {pick}: {found:?}");
        }
    }
}

/// Strips along x in front of a plane and along y behind it: as many openings as there are pairs of strips.
fn strips(n: u32) -> Tree {
    let node = |normal: [f64; 3], distance: f64, front: Child, back: Child| Node {
        plane: Plane { normal, distance },
        children: [front, back],
    };
    let mut nodes = vec![node([0.0, 0.0, 1.0], 0.0, Child::Node(1), Child::Node(n + 1))];
    for (axis, first) in [(0, 1), (1, n + 1)] {
        for k in 0..n {
            let mut normal = [0.0; 3];
            normal[axis] = 1.0;
            let next = if k + 1 < n { Child::Node(first + k + 1) } else { Child::Leaf(n) };
            nodes.push(node(normal, f64::from(k) / 8.0, next, Child::Leaf(k)));
        }
    }
    Tree::new(nodes).unwrap()
}

#[test]
fn hostile_trees_are_given_up() {
    let n = 64;
    let found = openings(&strips(n), SIZE, |_| true).unwrap();
    // Between strips across each other, and between neighbours.
    assert_eq!(found.len() as u32, (n + 1) * (n + 1) + 2 * n);
    assert_eq!(openings(&strips(400), SIZE, |_| true), None);
    // What is not wanted costs no memory.
    assert_eq!(openings(&strips(400), SIZE, |_| false), Some(Vec::new()));
}
