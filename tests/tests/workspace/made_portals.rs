//! Portals that are made from the tree of a Quake map, compared with those of generated worlds and with those that compilers wrote, with
//! witnessed pairs, and with lines that descend the tree of the map's bytes.

use sightlines::bake::quake::{MapPortals, portals_of_map};
use sightlines::formats::quake::{Bsp, BspFormat, Prt, graph_of_prt, read_bsp, read_prt};
use sightlines::geometry::Portal3;
use sightlines::pvs::BitMatrix;
use sightlines::scenes::world::{BspWorldOptions, QuakeLikeOptions, World, bsp_world, quake_like};
use sightlines::stabtree::{ConvexOptions, ConvexSearch};
use sightlines_testkit::mutate::SplitMix;
use sightlines_tests::data_folder;
use sightlines_tests::quake_bytes::RawMap;
use sightlines_tests::world_files::{bsp_bytes, prt_of_world};
use std::collections::BTreeMap;
use std::path::Path;

/// What is visible through portals, exactly.
fn seen(prt: &Prt) -> BitMatrix {
    let graph = graph_of_prt(prt);
    let mut search = ConvexSearch::new(&graph, ConvexOptions { fast: false, threads: 2 });
    search.run(None).expect("nobody cancels");
    search.finish().cells
}

fn area(points: &[[f64; 3]]) -> f64 {
    Portal3::around(points).map_or(0.0, |shape| shape.normal().iter().map(|x| x * x).sum::<f64>().sqrt() / 2.0)
}

/// For each pair of clusters the area of the portals between them. `cluster` names the cluster of each of a file; portals of none are left out.
fn areas(prt: &Prt, cluster: impl Fn(u32) -> Option<u32>) -> BTreeMap<[u32; 2], f64> {
    let mut areas = BTreeMap::new();
    for portal in prt.portals() {
        let [Some(a), Some(b)] = portal.clusters.map(&cluster) else { continue };
        if a != b {
            *areas.entry([a.min(b), a.max(b)]).or_default() += area(portal.points);
        }
    }
    areas
}

/// The same portals but those that `drops` names by their clusters.
fn without(prt: &Prt, drops: impl Fn([u32; 2]) -> bool) -> Prt {
    let mut rest = Prt::new(prt.n_clusters()).expect("as many clusters");
    for portal in prt.portals().filter(|portal| !drops(portal.clusters)) {
        rest.push_portal(portal.clusters, portal.points).expect("a sound portal");
    }
    rest
}

/// Generated worlds with the portals that their generator knows. What is made has the same between cells, and more only where the tree goes
/// on beyond the walls around the world, which it does not have.
#[test]
fn portals_of_generated_maps_are_those_of_their_worlds() {
    let worlds: Vec<World> = (0..8)
        .map(|seed| bsp_world(BspWorldOptions { seed, ..BspWorldOptions::default() }).unwrap())
        .chain((0..3).map(|seed| quake_like(QuakeLikeOptions { seed, rooms_x: 3, rooms_y: 2, floors: 1 }).unwrap()))
        .collect();
    let (mut n_equal, mut n_larger, mut n_only) = (0, 0, 0);
    for (k, world) in worlds.iter().enumerate() {
        let prt = prt_of_world(world);
        let bytes = bsp_bytes(world, BspFormat::ALL[k % BspFormat::ALL.len()]);
        let MapPortals { prt: made, .. } = portals_of_map(&Bsp::parse(bytes.clone()).unwrap()).unwrap();
        let n = prt.n_clusters();
        let is_cell = |cluster: u32| (cluster < n).then_some(cluster);
        let [low, high] = RawMap::new(&bytes).bounds();
        let beyond: Vec<[u32; 2]> = made
            .portals()
            .filter(|portal| portal.points.iter().any(|p| (0..3).any(|k| p[k] < low[k] - 0.5 || p[k] > high[k] + 0.5)))
            .map(|portal| [portal.clusters[0].min(portal.clusters[1]), portal.clusters[0].max(portal.clusters[1])])
            .collect();
        let (known, found) = (areas(&prt, is_cell), areas(&made, is_cell));
        for (pair, &wanted) in &known {
            let got = found.get(pair).copied().unwrap_or(0.0);
            // Planes of the file are floats.
            let rounding = 1e-3 * wanted + 0.05;
            assert!(got >= wanted - rounding, "world {k}: {got} of {wanted} between {pair:?}");
            if beyond.contains(pair) {
                n_larger += 1;
            } else {
                assert!(got <= wanted + rounding, "world {k}: {got} for {wanted} between {pair:?}");
                n_equal += 1;
            }
        }
        for (pair, got) in found.iter().filter(|(pair, _)| !known.contains_key(*pair) && !beyond.contains(pair)) {
            assert!(*got < 1.0, "world {k}: {got} between {pair:?}, which the world does not join");
            n_only += 1;
        }
        let (true_rows, rows) = (seen(&prt), seen(&made));
        for a in 0..n as usize {
            let lost = true_rows.iter_ones(a).find(|&b| !rows.get(a, b));
            assert_eq!(lost, None, "world {k}: not seen from {a}");
        }
    }
    eprintln!("{n_equal} pairs of cells with equal openings, {n_larger} larger, {n_only} with slivers only");
    assert!(n_equal > 300 && n_only < n_equal / 20, "{n_equal} equal, {n_only} only made");
}

/// A map of the data folder with what compilers wrote for it.
struct Case {
    bytes: Vec<u8>,
    prt: Prt,
    made: Prt,
    /// Rows of leafs, or in Quake II of clusters.
    rows: BitMatrix,
}

impl Case {
    fn read(path: &Path) -> Self {
        let bytes = std::fs::read(path).unwrap();
        let (bsp, prt) = (read_bsp(path).unwrap(), read_prt(path.with_extension("prt")).unwrap());
        let made = portals_of_map(&bsp).unwrap().prt;
        let rows = seen(&made);
        Self { bytes, prt, made, rows }
    }

    /// The compiler's cluster of one of the clusters that were made; none for passages.
    fn cluster(&self, made: u32) -> Option<u32> {
        let leafs = self.prt.leaf_clusters();
        leafs.cluster_of_leaf().get(made as usize).copied()
    }

    /// Rows of the compiler's clusters: what any of their leafs sees any leaf of.
    fn cluster_rows(&self, rows: &BitMatrix) -> BitMatrix {
        let n = self.prt.n_clusters() as usize;
        let leafs = self.prt.leaf_clusters();
        let mut of_clusters = BitMatrix::new(n, n);
        for (leaf, &a) in leafs.cluster_of_leaf().iter().enumerate() {
            let others = rows.iter_ones(leaf).filter_map(|b| leafs.cluster_of_leaf().get(b));
            others.for_each(|&b| of_clusters.set(a as usize, b as usize, true));
        }
        of_clusters
    }
}

fn pairs_only_in(a: &BitMatrix, b: &BitMatrix) -> usize {
    (0..a.n_rows()).map(|row| a.iter_ones(row).filter(|&column| !b.get(row, column)).count()).sum()
}

/// On real maps: whatever the compiler's portals show without those that the tree contradicts, is seen; so is every witnessed pair on maps whose
/// portals the tree confirms. What more is seen is seen through slivers that the compiler dropped.
#[test]
fn portals_of_real_maps_are_those_of_their_compilers() {
    let Some(data) = data_folder("SIGHTLINES_DATA") else { return };
    let (mut n_confirmed, mut n_rays) = (0, 0);
    for name in ["e1m7", "dm3", "dm6", "e1m1", "start", "e2m1"] {
        let path = data.join("quake").join(name).with_extension("bsp");
        let case = Case::read(&path);
        let theirs = seen(&case.prt);
        let ours = case.cluster_rows(&case.rows);
        let n_leafs = case.prt.leaf_clusters().n_leafs() as u32;
        let (known, found) =
            (areas(&case.prt, Some), areas(&case.made, |c| if c < n_leafs { case.cluster(c) } else { None }));
        let get = |areas: &BTreeMap<[u32; 2], f64>, pair: [u32; 2]| areas.get(&pair).copied().unwrap_or(0.0);
        let sorted = |[a, b]: [u32; 2]| [a.min(b), a.max(b)];
        let is_less = |pair: [u32; 2]| get(&found, sorted(pair)) < get(&known, sorted(pair)) * 0.99 - 0.5;
        let n_less = known.keys().filter(|pair| is_less(**pair)).count();
        let confirmed = seen(&without(&case.prt, is_less));
        let n_lost = pairs_only_in(&confirmed, &ours);
        let [only_theirs, only_ours] = [pairs_only_in(&theirs, &ours), pairs_only_in(&ours, &theirs)];
        // Without the openings that only the tree has, and which are slivers.
        let is_new = |pair: [u32; 2]| {
            let [Some(a), Some(b)] = pair.map(|c| case.cluster(c)) else { return true };
            a != b && !known.contains_key(&sorted([a, b]))
        };
        let n_new = found.keys().filter(|pair| !known.contains_key(*pair)).count();
        let largest_new =
            found.iter().filter(|(pair, _)| !known.contains_key(*pair)).map(|(_, a)| *a).fold(0.0, f64::max);
        let unexplained = pairs_only_in(&case.cluster_rows(&seen(&without(&case.made, is_new))), &theirs);
        let witnessed = witnessed(&path, theirs.n_rows());
        let n_missing = pairs_only_in(&witnessed, &ours);
        eprintln!(
            "{name}: {} portals of the compiler, {} made; {n_less} contradicted, {n_new} slivers of {largest_new:.3} units² at most; \
             {only_theirs} pairs only theirs ({n_lost} of them with confirmed portals), {only_ours} only ours ({unexplained} without slivers), \
             {n_missing} witnessed ones missing",
            case.prt.n_portals(),
            case.made.n_portals()
        );
        assert!(largest_new < 1.0, "{name}");
        // What lines through confirmed portals witnessed is seen, on all maps.
        for a in 0..ours.n_rows() {
            let lost = witnessed.iter_ones(a).find(|&b| !ours.get(a, b) && confirmed.get(a, b));
            assert_eq!(lost, None, "{name}: not seen from {a}");
        }
        n_confirmed += usize::from(n_less == 0 && n_missing == 0);
        // Compilers round corners of portals, and clip with a tolerance: pairs that see each other by that are few.
        let n_theirs = pairs_only_in(&theirs, &BitMatrix::new(theirs.n_rows(), theirs.n_rows()));
        assert!(2000 * n_lost <= 3 * n_theirs && 100 * only_ours <= n_theirs, "{name}: of {n_theirs} pairs");
        n_rays += descend(&case).unwrap_or_else(|error| panic!("{name}: {error}"));
        // The twin can fail: a leaf that counts as hidden from all others.
        let mut wrong = Case { rows: case.rows.clone(), ..case };
        let busiest = (0..wrong.rows.n_rows()).max_by_key(|&row| wrong.rows.iter_ones(row).count()).unwrap();
        (0..wrong.rows.n_rows()).filter(|&b| b != busiest).for_each(|b| wrong.rows.set(b, busiest, false));
        assert!(descend(&wrong).is_err(), "{name}: nobody missed leaf {busiest}");
    }
    eprintln!("{n_rays} leafs met by lines through the trees of the maps");
    assert!(
        n_confirmed >= 5 && n_rays > 20_000,
        "{n_confirmed} maps whose portals the tree confirms, {n_rays} leafs met"
    );
}

/// Follows random lines through the tree of the map's bytes, from leafs on until they are in something solid or in the sky: every leaf on the way is
/// seen from the first. Returns how many were met.
fn descend(case: &Case) -> Result<usize, String> {
    let raw = RawMap::new(&case.bytes);
    let bsp = Bsp::parse(case.bytes.clone()).unwrap();
    let (mut random, mut n_met) = (SplitMix::new(7), 0);
    let n = case.prt.leaf_clusters().n_leafs();
    let is_air = |leaf: usize| (1..=n).contains(&leaf) && ![-2, -6].contains(&bsp.leafs()[leaf].contents);
    for _ in 0..20_000 {
        let (low, high) = raw.leaf_box(1 + random.below(n));
        let within = |k: usize, at: f64| low[k] + (high[k] - low[k]) * at;
        let from: [f64; 3] = std::array::from_fn(|k| within(k, (random.below(1000) as f64 + 0.5) / 1000.0));
        let way: [f64; 3] = std::array::from_fn(|_| random.below(2001) as f64 - 1000.0);
        let to = std::array::from_fn(|k| from[k] + 8.0 * way[k]);
        let met = raw.leafs_along(from, to);
        let Some(&(first, _)) = met.first() else { continue };
        for (leaf, length) in met.into_iter().take_while(|&(leaf, length)| is_air(leaf) || length < 1e-9) {
            // What is met for a thousandth of a unit may be met by rounding.
            if length < 1e-3 || leaf == first {
                continue;
            }
            n_met += 1;
            if !case.rows.get(first - 1, leaf - 1) {
                return Err(format!(
                    "leaf {leaf} is met from {from:?} in leaf {first} towards {to:?}, and counts as hidden"
                ));
            }
        }
    }
    Ok(n_met)
}

/// Pairs that lines were found for.
fn witnessed(path: &Path, n: usize) -> BitMatrix {
    let bytes = std::fs::read(path.with_extension("seen.bin")).expect("a witness table");
    let words: Vec<u64> = bytes.chunks_exact(8).map(|b| u64::from_le_bytes(b.try_into().expect("8 bytes"))).collect();
    assert_eq!((words[0] as usize, words.len()), (n, 1 + n * n.div_ceil(64)));
    let mut seen = BitMatrix::new(n, n);
    words[1..].chunks_exact(n.div_ceil(64)).enumerate().for_each(|(row, w)| seen.row_mut(row).copy_from_slice(w));
    seen
}
