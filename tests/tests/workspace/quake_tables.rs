//! Tables of Quake maps that know where their cells are: of generated worlds in every format, and of real maps. What
//! the tables say of points and faces is compared with descents that are written here, over the bytes of the map.

use sightlines::bake::from_table::{axial_graph, convex_graph};
use sightlines::bake::quake::bake_map;
use sightlines::bake::{BakedMap, PrtOptions};
use sightlines::formats::quake::{Bsp, BspFormat, Prt, graph_of_prt, read_prt};
use sightlines::geometry::Portal3;
use sightlines::pvs::{CellId, Locator, ObjectId, PlaneChild, PlaneTree, Table, TableParts};
use sightlines::scenes::world::{BspWorldOptions, QuakeLikeOptions, World, bsp_world, quake_like};
use sightlines::stabtree::ConvexOptions;
use sightlines_testkit::mutate::SplitMix;
use sightlines_tests::quake_bytes::RawMap;
use sightlines_tests::world_files::{bsp_bytes, prt_of_world};
use sightlines_tests::{data_folder, files};

type Point = [f64; 3];

/// A map, its portals, and the table that is made of both.
struct Case {
    name: String,
    bytes: Vec<u8>,
    prt: Prt,
    baked: BakedMap,
}

impl Case {
    fn new(name: String, bytes: Vec<u8>, prt: Prt) -> Self {
        let bsp = Bsp::parse(bytes.clone()).unwrap();
        // What sees what is the subject of other tests.
        let search = ConvexOptions { fast: true, threads: 2 };
        let baked = bake_map(&bsp, &prt, PrtOptions { search, ..PrtOptions::default() });
        let baked = baked.unwrap_or_else(|error| panic!("{name}: {error}"));
        Self { name, bytes, prt, baked }
    }

    /// The cluster of each leaf, as the map counts.
    fn clusters(&self, raw: &RawMap<'_>) -> Vec<Option<u32>> {
        if let Some(clusters) = raw.named_clusters() {
            return clusters;
        }
        let listed = self.prt.leaf_clusters();
        let visible = listed.cluster_of_leaf().iter().map(|&c| Some(c));
        std::iter::once(None).chain(visible).chain(std::iter::repeat(None)).take(raw.n_leafs()).collect()
    }
}

/// How much was looked at.
#[derive(Debug, Default, Clone, Copy)]
struct Counts {
    open: usize,
    solid: usize,
    near: usize,
    corners: usize,
    /// Points of portals that are beyond the leafs that the portal joins.
    beyond: usize,
    on_faces: usize,
    listed: usize,
}

/// Compares a table with descents over the bytes of its map: the first thing that is wrong.
fn check(case: &Case, table: &Table, n_points: usize, counts: &mut Counts) -> Result<(), String> {
    let raw = RawMap::new(&case.bytes);
    let (clusters, mut random) = (case.clusters(&raw), SplitMix::new(n_points as u64));
    let slack = table.planes().ok_or("no planes")?.slack();
    // Points around open leafs, on a grid of eighths.
    let open: Vec<usize> = (0..clusters.len()).filter(|&leaf| clusters[leaf].is_some()).collect();
    for _ in 0..n_points {
        let (low, high) = raw.leaf_box(open[random.below(open.len())]);
        let p: Point = std::array::from_fn(|k| {
            let n_eighths = ((high[k] - low[k] + 8.0) * 8.0) as usize;
            low[k].floor() - 4.0 + random.below(n_eighths) as f64 / 8.0
        });
        // Planes around the world are walls, and not all of them are cut along.
        let [low, high] = raw.bounds();
        if !(0..3).all(|k| low[k] <= p[k] && p[k] <= high[k]) {
            continue;
        }
        let (leaf, nearest) = raw.leaf_at(p);
        let found = table.in_dimension().unwrap().at(p).cells().to_vec();
        let wanted = clusters[leaf].map(CellId);
        if wanted.is_some_and(|cell| !found.contains(&cell)) {
            return Err(format!("{p:?} is in {wanted:?}, and not found there: {found:?}"));
        }
        if let Some(cell) = wanted {
            let record = &table.cells()[cell.idx()];
            if !(0..3).all(|k| record.min[k] <= p[k] && p[k] <= record.max[k]) {
                return Err(format!("{p:?} is in cell {cell}, but outside its box"));
            }
        }
        // The twin: nothing more is found away from planes.
        if nearest > 2.0 * slack {
            if found != wanted.into_iter().collect::<Vec<_>>() {
                return Err(format!("{p:?} is in {wanted:?}, but found in {found:?}"));
            }
            *(if wanted.is_some() { &mut counts.open } else { &mut counts.solid }) += 1;
        } else {
            counts.near += 1;
        }
    }
    // The middles of portals, and their corners drawn in a little, are in both clusters.
    for portal in table.portals() {
        let n = portal.points.len() as f64;
        let middle: Point = std::array::from_fn(|k| portal.points.iter().map(|p| p[k]).sum::<f64>() / n);
        let inner = portal.points.iter().map(|p| std::array::from_fn(|k| 0.95 * p[k] + 0.05 * middle[k]));
        // Details of a cluster are solid, and may lie in the way.
        let is_solid = |p: Point| raw.leafs_near(p, slack).iter().all(|&leaf| clusters[leaf].is_none());
        for p in inner.chain([middle]) {
            let found = table.in_dimension().unwrap().at(p).cells().to_vec();
            let sides = portal.cells.iter().filter(|cell| found.contains(cell)).count();
            let all = raw.leafs_near(p, slack);
            let has_detail = all.iter().any(|&leaf| clusters[leaf].is_none());
            if sides < 2 && !is_solid(p) && !has_detail {
                // Compilers drop parts of portals that are narrow, and what is left may not end where leafs do.
                let around: Vec<_> = raw.leafs_near(p, 0.25).into_iter().filter_map(|leaf| clusters[leaf]).collect();
                if is_sliver(&portal.points) || portal.cells.iter().all(|cell| around.contains(&cell.0)) {
                    counts.beyond += 1;
                    continue;
                }
                return Err(format!("{p:?} of the portal of {:?} is found in {found:?}", portal.cells));
            }
            counts.corners += usize::from(sides == 2);
        }
        for cell in portal.cells {
            let CellBox { min, max } = CellBox::of(table, cell);
            if !portal.points.iter().all(|p| (0..3).all(|k| min[k] <= p[k] && p[k] <= max[k])) {
                return Err(format!("a portal of cell {cell} is outside its box"));
            }
        }
    }
    check_faces(&raw, &clusters, table, slack, counts)
}

/// Whether a polygon is less than a unit wide, across its longest edge.
fn is_sliver(points: &[Point]) -> bool {
    let shape = Portal3::around(points).expect("portals of tables have an area");
    let length = |v: Point| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    let longest = shape.edges().map(|[a, b]| length(std::array::from_fn(|k| b[k] - a[k]))).fold(0.0, f64::max);
    length(shape.normal()) < 2.0 * longest
}

struct CellBox {
    min: Point,
    max: Point,
}

impl CellBox {
    fn of(table: &Table, cell: CellId) -> Self {
        let record = &table.cells()[cell.idx()];
        Self { min: record.min, max: record.max }
    }
}

/// What leafs list is in the lists of clusters; points of faces are in clusters that list the face; boxes are around
/// corners.
fn check_faces(
    raw: &RawMap<'_>,
    clusters: &[Option<u32>],
    table: &Table,
    slack: f64,
    counts: &mut Counts,
) -> Result<(), String> {
    let (first, n_faces) = raw.world_faces();
    let is_whole = |k: usize| table.polygons_of(ObjectId(k as u32)) as usize == raw.n_polygons(first + k);
    if table.objects().len() != n_faces || !(0..n_faces).all(is_whole) {
        return Err(format!("{} objects for {n_faces} faces, or of another number of polygons", table.objects().len()));
    }
    let lists = |cluster: u32, k: usize| table.objects_of(CellId(cluster)).binary_search(&ObjectId(k as u32)).is_ok();
    for (leaf, cluster) in clusters.iter().enumerate().filter_map(|(leaf, c)| Some((leaf, (*c)?))) {
        for face in raw.marks(leaf).into_iter().filter(|f| (first..first + n_faces).contains(f)) {
            if !lists(cluster, face - first) {
                return Err(format!("leaf {leaf} lists face {face}, its cluster {cluster} does not"));
            }
            counts.listed += 1;
        }
    }
    for k in 0..n_faces {
        let corners = raw.corners(first + k);
        let object = &table.objects()[k];
        if object.name != format!("face {}", first + k) {
            return Err(format!("face {} is called {}", first + k, object.name));
        }
        let is_inside = |p: &Point| (0..3).all(|j| object.min[j] <= p[j] && p[j] <= object.max[j]);
        if !corners.iter().all(is_inside) {
            return Err(format!("{} leaves its box", object.name));
        }
        let middle: Point = std::array::from_fn(|j| corners.iter().map(|p| p[j]).sum::<f64>() / corners.len() as f64);
        for t in [0.0, 0.5, 0.9] {
            let p: Point = std::array::from_fn(|j| (1.0 - t) * middle[j] + t * corners[0][j]);
            let Some(leafs) = raw.leafs_of_face_point(p, &corners, slack) else { continue };
            for cluster in leafs.into_iter().filter_map(|leaf| clusters[leaf]) {
                if !lists(cluster, k) {
                    return Err(format!("{p:?} of {} is in cluster {cluster}, which does not list it", object.name));
                }
                counts.on_faces += 1;
            }
        }
    }
    Ok(())
}

/// What else has to hold of a table.
fn check_whole(case: &Case) {
    let (table, name) = (&case.baked.table, &case.name);
    assert!(table.kind().is_quake(), "{name}");
    assert_eq!(convex_graph(table).as_ref(), Some(&graph_of_prt(&case.prt)), "{name}: to the bit");
    assert!(axial_graph(table).is_none(), "{name}");
    assert_eq!(Table::from_bytes(&table.to_bytes()).as_ref(), Ok(table), "{name}");
    let rows = &case.baked.report.clusters.seen.cells;
    assert!(
        (0..rows.n_rows()).all(|a| { table.visible(CellId(a as u32)).map(CellId::idx).eq(rows.iter_ones(a)) }),
        "{name}"
    );
}

fn world(seed: u64) -> World {
    bsp_world(BspWorldOptions { seed, leafs: 40, solid_percent: 40, tilted_percent: 30 }).unwrap()
}

fn of_world(name: String, world: &World, format: BspFormat) -> Case {
    Case::new(name, bsp_bytes(world, format), prt_of_world(world))
}

#[test]
fn tables_of_generated_maps_know_where_their_cells_are() {
    let mut counts = Counts::default();
    for format in BspFormat::ALL {
        for seed in 0..6 {
            let case = of_world(format!("{format:?} {seed}"), &world(seed), format);
            check_whole(&case);
            check(&case, &case.baked.table, 400, &mut counts).unwrap_or_else(|e| panic!("{}: {e}", case.name));
        }
        let quake = quake_like(QuakeLikeOptions { seed: 3, rooms_x: 3, rooms_y: 3, floors: 1 }).unwrap();
        let case = of_world(format!("{format:?} level"), &quake, format);
        check_whole(&case);
        check(&case, &case.baked.table, 1000, &mut counts).unwrap_or_else(|e| panic!("{}: {e}", case.name));
    }
    eprintln!("{counts:?}");
    assert!(counts.open > 3000 && counts.solid > 500 && counts.near > 30, "{counts:?}");
    assert!(counts.corners > 2000 && counts.on_faces > 1000 && counts.listed > 500, "{counts:?}");
    assert_eq!(counts.beyond, 0, "these maps have all their portals");
}

/// The worlds know the cell at a point themselves, from planes that were not rounded.
#[test]
fn tables_agree_with_the_worlds_that_maps_were_made_from() {
    let (mut n_points, mut random) = (0, SplitMix::new(11));
    for seed in 20..30 {
        let world = world(seed);
        let table = of_world(format!("{seed}"), &world, BspFormat::Bsp29).baked.table;
        let around = world.bounds();
        for _ in 0..300 {
            let p: Point = std::array::from_fn(|k| {
                let t = random.below(1 << 20) as f64 / f64::from(1 << 20);
                (1.0 - t) * around.min[k] + t * around.max[k]
            });
            if let Some(cell) = world.leafs[world.leaf_at(p)].cell {
                assert!(table.in_dimension().unwrap().at(p).cells().contains(&cell), "{seed}: {p:?} is in {cell}");
                n_points += 1;
            }
        }
    }
    assert!(n_points > 1000, "{n_points}");
}

/// A tree that is turned, a box that is too small and a list that lacks a face are found out.
#[test]
fn wrong_tables_are_found_out() {
    let case = of_world("right".to_owned(), &world(4), BspFormat::Bsp2);
    let wrong = |change: &dyn Fn(&mut TableParts)| {
        let mut parts = case.baked.table.clone().into_parts();
        change(&mut parts);
        let mut counts = Counts::default();
        check(&case, &Table::new(parts).unwrap(), 400, &mut counts)?;
        if counts.beyond == 0 { Ok(()) } else { Err(format!("{counts:?}")) }
    };
    assert_eq!(wrong(&|_| {}), Ok(()));
    let tree = |parts: &TableParts| parts.planes.clone().unwrap();
    let turned = |parts: &mut TableParts| {
        let mut nodes = tree(parts).nodes().to_vec();
        nodes[0].children.reverse();
        parts.planes = Some(PlaneTree::new(nodes, tree(parts).slack()).unwrap());
    };
    assert!(wrong(&turned).is_err());
    let blind = |parts: &mut TableParts| {
        let mut nodes = tree(parts).nodes().to_vec();
        let children = nodes.iter_mut().flat_map(|node| &mut node.children);
        children.filter(|c| **c == PlaneChild::Cell(CellId(0))).for_each(|c| *c = PlaneChild::Nothing);
        parts.planes = Some(PlaneTree::new(nodes, tree(parts).slack()).unwrap());
    };
    assert!(wrong(&blind).is_err());
    let exact = |parts: &mut TableParts| {
        parts.planes = Some(PlaneTree::new(tree(parts).nodes().to_vec(), 0.0).unwrap());
    };
    // Planes that are rounded to floats, and taken as they are, have portals beside them.
    assert!(wrong(&exact).is_err());
    let forgetful = |parts: &mut TableParts| {
        parts.cell_objects.iter_mut().find(|list| !list.is_empty()).expect("a face").clear();
    };
    assert!(wrong(&forgetful).is_err());
    let small = |parts: &mut TableParts| {
        parts.cells.iter_mut().for_each(|cell| cell.max = cell.min);
        parts.locator = Locator::build(&parts.cell_bounds(), 3);
    };
    assert!(wrong(&small).is_err());
}

#[test]
fn portals_of_another_place_are_refused() {
    let world = world(7);
    let bytes = bsp_bytes(&world, BspFormat::Bsp2);
    let bsp = Bsp::parse(bytes).unwrap();
    let bake = |world: &World| bake_map(&bsp, &prt_of_world(world), PrtOptions::default());
    assert!(bake(&world).is_ok());
    let far = bake(&world.moved([900.0, 0.0, 0.0])).unwrap_err().to_string();
    assert!(far.contains("the portals are of another map"), "{far}");
    // By less than bounds of leafs tell, but more than rounding.
    let near = bake(&world.moved([0.5, 0.0, 0.0])).unwrap_err().to_string();
    assert!(near.contains("units away from every plane that divides clusters"), "{near}");
}

#[test]
fn tables_of_real_maps_know_where_their_cells_are() {
    let Some(data) = data_folder("SIGHTLINES_DATA") else { return };
    let mut n_maps = 0;
    for path in files(&data.join("quake"), "prt") {
        let prt = read_prt(&path).unwrap();
        if prt.n_clusters() > 2000 {
            // Its search takes long, and its tree is that of a map which is there in another form.
            continue;
        }
        let bytes = std::fs::read(path.with_extension("bsp")).unwrap();
        let case = Case::new(path.display().to_string(), bytes, prt);
        check_whole(&case);
        let mut counts = Counts::default();
        check(&case, &case.baked.table, 3000, &mut counts).unwrap_or_else(|e| panic!("{}: {e}", case.name));
        eprintln!("{}: {counts:?} {:?}", case.name, case.baked.report.world);
        assert!(counts.open > 500 && counts.solid > 300 && counts.listed > 1000, "{}: {counts:?}", case.name);
        assert!(counts.corners > 2000 && counts.on_faces > 2000, "{}: {counts:?}", case.name);
        assert!(1000 * counts.beyond < counts.corners, "{}: {counts:?}", case.name);
        n_maps += 1;
    }
    assert!(n_maps > 5, "{n_maps}");
}
