//! Everything that the run time reads of a table, damaged in one place.

use crate::tables::common::{Case, Real, cases, changed, check, checked, quick, small_tower, with_mirrors, with_trees};
use sightlines_bake::{SceneBakeOptions, bake_scene};
use sightlines_cells::{Scene, SceneObject};
use sightlines_geometry::Random;
use sightlines_pvs::{CellId, StabParts, StabTrees, TableParts};
use sightlines_verify::{Findings, VerifyOptions};

/// How often each kind of damage is done to each table.
const TRIES: usize = 10;

/// A way to damage a table; `false` if this table has nothing of the kind at the place that the random numbers chose.
type Damage = fn(&mut TableParts, &mut Random) -> bool;

const OF_PORTALS: [(&str, Damage); 7] = [
    ("a portal is missing", |parts, random| {
        let k = random.below(parts.portals.len());
        parts.portals.remove(k);
        true
    }),
    ("a portal has lost its other half", |parts, random| {
        let k = random.below(parts.portals.len());
        shrink(&mut parts.portals[k].points, 0.5);
        true
    }),
    ("a portal has lost a hundredth", |parts, random| {
        let k = random.below(parts.portals.len());
        shrink(&mut parts.portals[k].points, 0.99);
        true
    }),
    ("a portal has moved along its border", |parts, random| {
        let k = random.below(parts.portals.len());
        let points = &mut parts.portals[k].points;
        let step: [f64; 3] = std::array::from_fn(|k| 0.25 * (points[1][k] - points[0][k]));
        points.iter_mut().for_each(|p| (0..3).for_each(|k| p[k] += step[k]));
        true
    }),
    ("a portal faces the wrong way", |parts, random| {
        let k = random.below(parts.portals.len());
        parts.portals[k].points.reverse();
        true
    }),
    ("a portal has lost a corner", |parts, random| {
        let k = random.below(parts.portals.len());
        parts.portals[k].points.pop();
        true
    }),
    ("a portal leads into another cell", |parts, random| {
        let [k, other] = [parts.portals.len(), parts.cells.len()].map(|n| random.below(n));
        let (cells, other) = (&mut parts.portals[k].cells, CellId(other as u32));
        let is_other = !cells.contains(&other);
        cells[1] = if is_other { other } else { cells[1] };
        is_other
    }),
];

/// Keeps a share of a portal, along its first edge.
fn shrink(points: &mut [[f64; 3]], share: f64) {
    let n = points.len();
    let kept = |from: [f64; 3], to: [f64; 3]| std::array::from_fn(|k| from[k] + share * (to[k] - from[k]));
    if n == 2 {
        points[1] = kept(points[0], points[1]);
    } else {
        // Of a rectangle two corners move; of another polygon one, which takes away a corner of it.
        points[1] = kept(points[0], points[1]);
        if n == 4 {
            points[2] = kept(points[3], points[2]);
        }
    }
}

/// The damaged table's findings; `None` if the format does not allow such a table, which then cannot be read.
fn found(case: &Case, damage: Damage, seed: u64) -> Option<Findings> {
    let mut random = Random::new(seed);
    let mut parts = case.table.parts().clone();
    (0..100).find(|_| damage(&mut parts, &mut random)).expect("a place for it");
    let table = sightlines_pvs::Table::new(parts).ok()?;
    // No ray that is aimed at a hidden pair tells of portals and mirrors.
    Some(check(&table, &case.real, &VerifyOptions { rays: 500, pairs: 0, ..quick() }))
}

#[test]
fn damaged_portals_are_found() {
    let (mut n_caught, mut n_refused) = (0, 0);
    for case in cases().filter(|case| !case.table.portals().is_empty()) {
        for (name, damage) in OF_PORTALS {
            for seed in 0..TRIES as u64 {
                match found(case, damage, seed) {
                    None => n_refused += 1,
                    Some(findings) if !findings.is_true() => n_caught += 1,
                    Some(_) => panic!("{}: {name}, try {seed}: not caught", case.name),
                }
            }
        }
    }
    println!("{n_caught} caught, {n_refused} refused by the format");
    assert_eq!(n_caught + n_refused, 8 * OF_PORTALS.len() * TRIES);
    assert!(n_refused <= 8 * TRIES, "{n_refused} refused: only what has too few corners is no table at all");
}

const OF_MIRRORS: [(&str, Damage); 5] = [
    ("a part of a mirror is missing", |parts, random| {
        let k = random.below(parts.mirrors.len());
        parts.mirrors.remove(k);
        true
    }),
    ("a part of a mirror has lost a hundredth", |parts, random| {
        let k = random.below(parts.mirrors.len());
        shrink(&mut parts.mirrors[k].points, 0.99);
        true
    }),
    ("a part of a mirror looks the other way", |parts, random| {
        let k = random.below(parts.mirrors.len());
        parts.mirrors[k].points.reverse();
        true
    }),
    ("a part of a mirror has lost a corner", |parts, random| {
        let k = random.below(parts.mirrors.len());
        parts.mirrors[k].points.pop();
        true
    }),
    ("a part of a mirror is in another cell", |parts, random| {
        let [k, other] = [parts.mirrors.len(), parts.cells.len()].map(|n| random.below(n));
        let other = CellId(other as u32);
        std::mem::replace(&mut parts.mirrors[k].cell, other) != other
    }),
];

#[test]
fn damaged_mirrors_are_found() {
    let (mut n_caught, mut n_refused) = (0, 0);
    for case in with_mirrors() {
        let whole = check(&case.table, &case.real, &quick());
        assert_eq!(whole.violations, [], "{}", case.name);
        assert!(case.table.mirrors().len() >= 10, "{}: {} parts", case.name, case.table.mirrors().len());
        for (name, damage) in OF_MIRRORS {
            for seed in 0..TRIES as u64 {
                match found(&case, damage, seed) {
                    None => n_refused += 1,
                    Some(findings) if findings.by_kind.contains_key("missing-mirror") => n_caught += 1,
                    Some(_) => panic!("{}: {name}, try {seed}: not caught", case.name),
                }
            }
        }
    }
    println!("{n_caught} caught, {n_refused} refused by the format");
    assert_eq!(n_caught + n_refused, 3 * OF_MIRRORS.len() * TRIES);
    assert!(n_refused <= 2 * TRIES, "{n_refused} refused: a part in a plane has two ends");
}

/// A mirror whose middle is a rectangle of two triangles, and whose outline has no side along an axis: tables have no part of it, and are true.
#[test]
fn mirrors_that_are_no_rectangles_are_left_alone() {
    let tower = small_tower();
    let bounds = tower.bounds();
    let middle: [f64; 3] = std::array::from_fn(|k| 0.5 * (bounds.min[k] + bounds.max[k]));
    let (r, h) = (0.5, 0.375);
    let outline = [[r, 0.0], [h, h], [0.0, r], [-h, h], [-r, 0.0], [-h, -h], [0.0, -r], [h, -h]];
    let mirror = SceneObject {
        name: "mirror".to_owned(),
        vertices: outline.map(|[x, y]| [middle[0] + x, middle[1] + y, middle[2]]).to_vec(),
        triangles: vec![[1, 2, 3], [3, 4, 5], [5, 6, 7], [7, 0, 1], [1, 3, 5], [1, 5, 7]],
    };
    let objects: Vec<SceneObject> = tower.objects().iter().cloned().chain([mirror]).collect();
    let last = objects.len() as u32 - 1;
    let scene = Scene::new(objects).expect("a tower with a mirror").with_mirrors(vec![last]).expect("a mirror");
    let table = bake_scene(&scene, &SceneBakeOptions::default()).expect("a scene").table;
    let findings = check(&table, &Real::Scene(scene), &quick());
    assert_eq!(findings.violations, []);
}

/// Stab trees with one gate less: a child of a node, or a root of a cell.
fn without_one(trees: &StabTrees, random: &mut Random) -> Option<StabParts> {
    let n_cells = trees.n_cells() as u32;
    let from_cell = random.below(2) == 0;
    let chosen = random.below(if from_cell { trees.n_cells() } else { trees.n_nodes() }) as u32;
    let list = |is_chosen: bool, nodes: &[u32], random: &mut Random| {
        let mut nodes = nodes.to_vec();
        if is_chosen && !nodes.is_empty() {
            nodes.remove(random.below(nodes.len()));
        }
        nodes
    };
    let mut parts = StabParts::default();
    for node in 0..trees.n_nodes() as u32 {
        let children = list(!from_cell && node == chosen, trees.children(node), random);
        let (portal, forward) = trees.gate(node);
        parts.push_node(portal, forward, &children, trees.is_open(node));
    }
    for cell in (0..n_cells).map(CellId) {
        let roots = list(from_cell && cell.0 == chosen, trees.roots(cell), random);
        parts.push_cell(&roots, trees.is_root_open(cell));
    }
    let is_open = if from_cell { trees.is_root_open(CellId(chosen)) } else { trees.is_open(chosen) };
    let is_empty = if from_cell { trees.roots(CellId(chosen)).is_empty() } else { trees.children(chosen).is_empty() };
    (!is_open && !is_empty).then_some(parts)
}

/// Invariant: a gate that a free line passes and that is missing is found in small trees. In space trees have so many sequences that not all are
/// aimed at, and of what they have not, walls and furniture hide much.
#[test]
fn cut_stab_trees_are_found() {
    for ((name, baked, real), least) in with_trees().into_iter().zip([TRIES, 3, 8]) {
        let mut n_caught = 0;
        let case = Case { name, table: baked, real, least_caught: [1.0; 2] };
        // Sixteen sequences for each pair: of those that the tower's trees have not, the most suspicious twentieth.
        let options = VerifyOptions { pairs: 500, ..quick() };
        let whole = check(&case.table, &case.real, &options);
        assert_eq!(whole.violations, [], "{name}");
        assert!(whole.n_followed > 1_000, "{name}: {} followed", whole.n_followed);
        let trees = case.table.stab().expect("made before");
        let mut random = Random::new(5);
        for _ in 0..TRIES {
            let parts = (0..100).find_map(|_| without_one(trees, &mut random)).expect("a tree");
            let cut = StabTrees::new(parts, case.table.portals(), case.table.n_cells()).expect("the format allows it");
            assert_ne!(&cut, trees);
            let wrong = changed(&case.table, |parts| parts.stab = Some(cut));
            let findings = check(&wrong, &case.real, &options);
            assert!(findings.violations.iter().all(|v| v.kind() == "missing-sequence"), "{name}: {findings:?}");
            n_caught += usize::from(!findings.is_true());
        }
        println!("{name}: {n_caught} of {TRIES}");
        assert!(n_caught >= least, "{name}: {n_caught} of {TRIES}");
    }
}

/// Without walls a border has no portal if there is no cell behind it: nothing of a true table is reported.
#[test]
fn ways_of_true_tables_lead_to_their_ends() {
    for (case, findings) in checked().iter().filter(|(case, _)| !case.table.portals().is_empty()) {
        assert_eq!(findings.violations, [], "{}", case.name);
        println!("{}: {} followed", case.name, findings.n_followed);
        assert!(findings.n_followed > 2_000, "{}: {} followed", case.name, findings.n_followed);
    }
}
