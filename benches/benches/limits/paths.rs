//! The hot paths, each with the count of what cannot be left out.

use crate::rates::{Rates, least};
use sightlines::bake::{
    CellsFrom, PlanBakeOptions, RegionBakeOptions, SceneBakeOptions, bake_plan, bake_regions, bake_scene, see_groups,
};
use sightlines::cells::Scene;
use sightlines::eye_to_cell::{Doors, Method, Scratch, TableCells, View, VisibleSet, VisibleSubgraph};
use sightlines::formats::ViewCells;
use sightlines::formats::view_cells::ViewCell;
use sightlines::geometry::{Aabb, Adaptive, AxialDoor, Point3, Portal3};
use sightlines::multifocal::{BufferJob, BufferPlane, Measure, MultifocalBackend, Occluder, Volume};
use sightlines::multifocal_cpu::Fast;
use sightlines::packed::{PackOptions, Packed, pack};
use sightlines::pvs::{CellId, Table};
use sightlines::scenes::surfaces::{self, SurfaceOptions};
use sightlines::scenes::world::{QuakeLikeOptions, quake_like};
use sightlines::scenes::{OfficeOptions, TowerOptions, doom_like, office, tower, tower_rooms};
use sightlines::sightline::{AxialStabber, ConvexStabber, Funnel, StabLimits, Stabber, Verdict};
use sightlines::stabtree::{ConvexOptions, ConvexSearch, SearchOptions};
use sightlines::visible_surface::{
    Camera, DepthFormat, FaceMask, Faces, RayCaster, RenderInput, VisibleSurface, ZBuffer,
};
use sightlines::walkthrough::wander;
use sightlines_benches::{corridors, graph};
use std::hint::black_box;

/// One path, once, and what it takes at least, in seconds.
pub(crate) struct Path {
    pub(crate) name: &'static str,
    pub(crate) of: String,
    pub(crate) seconds: f64,
    pub(crate) bound: f64,
    pub(crate) counts: String,
}

type Measured = Box<dyn FnOnce(&Rates) -> Path>;

/// All paths, not yet measured.
pub(crate) fn all(short: bool) -> Vec<Measured> {
    let options = TowerOptions { floors: if short { 1 } else { 4 }, ..TowerOptions::default() };
    let scene = tower(options).expect("in range");
    let table = bake_scene(&scene, &SceneBakeOptions::default()).expect("a tower can be baked").table;
    let [a, b, c, d] = [(); 4].map(|()| table.clone());
    vec![
        Box::new(push),
        Box::new(push_axial),
        Box::new(push_convex),
        Box::new(move |rates| row(rates, &a)),
        Box::new(move |rates| packed_row(rates, &b)),
        Box::new(move |rates| read_table(rates, &c)),
        Box::new(move |rates| eye_to_cell(rates, &d)),
        Box::new(move |rates| buffer(rates, short)),
        Box::new(move |rates| zbuffer(rates, short)),
        Box::new(move |rates| raycaster(rates, short)),
        Box::new(move |rates| plan_table(rates, short)),
        Box::new(move |rates| reject(rates, short)),
        Box::new(move |rates| vis(rates, short)),
        Box::new(move |rates| given_cells(rates, &scene, options)),
    ]
}

/// A portal pushed onto a funnel: whether both of its ends keep a line is at least an orientation each.
fn push(rates: &Rates) -> Path {
    let plan = office(OfficeOptions::default()).expect("in range");
    let corridors = corridors(&graph(&plan), 4, 400);
    let n: usize = corridors.iter().map(|doors| doors.len() - 1).sum();
    let mut funnel = Funnel::new(Adaptive);
    let seconds = least(|| {
        for doors in &corridors {
            funnel.start(doors[0]);
            black_box(doors[1..].iter().all(|&door| funnel.push(black_box(door)).is_some()));
        }
    });
    Path {
        name: "a portal pushed, plane",
        of: format!("{n} pushes"),
        seconds: seconds / n as f64,
        bound: 2.0 * rates.orient2,
        counts: "2 orientations".to_owned(),
    }
}

/// A door pushed while the line before still passes: four comparisons, as dear as a product and a difference each.
fn push_axial(rates: &Rates) -> Path {
    let door = |x: f64| AxialDoor { axis: 0, forward: true, extent: Aabb { min: [x, 0.0, 0.0], max: [x, 1.0, 2.0] } };
    let mut stabber = AxialStabber::new();
    stabber.start(door(0.0));
    for x in 1..4 {
        stabber.push(door(f64::from(x))).expect("doors in a row are open");
    }
    let n = 1000;
    let seconds = least(|| {
        for _ in 0..n {
            let undo = stabber.push(black_box(door(4.0))).expect("and so is the last");
            stabber.undo(undo);
        }
    });
    Path {
        name: "a door pushed and taken back, space",
        of: format!("{n} pushes"),
        seconds: seconds / f64::from(n),
        bound: 4.0 * rates.orient2 / 2.0,
        counts: "4 comparisons of half an orientation".to_owned(),
    }
}

/// A sequence of convex portals decided: a line has to be on the right side of every edge.
fn push_convex(rates: &Rates) -> Path {
    let square = |k: usize| -> Portal3 {
        let (z, x) = (3.0 * k as f64, 0.2 * k as f64);
        let tilt = 0.1 * (k % 3) as f64;
        let corner = |a: f64, b: f64| -> Point3 { [x + a, b, z + tilt * a] };
        Portal3::around(&[corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)])
            .expect("a square")
    };
    let portals: Vec<Portal3> = (0..6).map(square).collect();
    let portals: Vec<&Portal3> = portals.iter().collect();
    let mut stabber = ConvexStabber::new(StabLimits::default());
    assert!(matches!(stabber.stab(&portals, None), Verdict::Visible(_)), "squares in a row are open");
    let seconds = least(|| {
        black_box(stabber.stab(black_box(&portals), None));
    });
    Path {
        name: "a sequence of 6 convex portals decided",
        of: "one with a line".to_owned(),
        seconds,
        bound: 24.0 * rates.orient3,
        counts: "24 orientations of the line found".to_owned(),
    }
}

/// All rows of a table, as lists of cells: the bits are read.
fn row(rates: &Rates, table: &Table) -> Path {
    let n = table.n_cells();
    let seconds = least(|| {
        for cell in 0..n as u32 {
            black_box(table.visible(CellId(cell)).fold(0u32, |sum, c| sum.wrapping_add(c.0)));
        }
    });
    let bytes = table.row(CellId(0)).len() * 8;
    Path {
        name: "what a cell sees",
        of: format!("rows of {bytes} bytes"),
        seconds: seconds / n as f64,
        bound: bytes as f64 / rates.cache,
        counts: "the bytes of a row, from the cache".to_owned(),
    }
}

/// The same of a packed table whose blocks are kept: a list of cells is written.
fn packed_row(rates: &Rates, table: &Table) -> Path {
    let bytes = pack(table, &PackOptions::default()).expect("a table can be packed");
    let packed = Packed::open(bytes, 1 << 30).expect("what was packed opens");
    let (n, mut out, mut n_seen) = (table.n_cells(), Vec::new(), 0);
    let seconds = least(|| {
        n_seen = 0;
        for cell in 0..n as u32 {
            packed.visible(CellId(cell), &mut out).expect("blocks are whole");
            n_seen += out.len();
        }
    });
    let bytes = n_seen as f64 * 4.0 / n as f64;
    Path {
        name: "the same of a packed table",
        of: format!("lists of {:.0} cells", bytes / 4.0),
        seconds: seconds / n as f64,
        bound: bytes / rates.cache,
        counts: "the bytes of the list, in the cache".to_owned(),
    }
}

/// A table read: its bytes are.
fn read_table(rates: &Rates, table: &Table) -> Path {
    let bytes = table.to_bytes();
    let seconds = least(|| drop(black_box(Table::from_bytes(black_box(&bytes)))));
    Path {
        name: "a table read and checked",
        of: format!("{:.1} MB", bytes.len() as f64 / 1e6),
        seconds,
        bound: bytes.len() as f64 / rates.memory,
        counts: "its bytes, from memory".to_owned(),
    }
}

/// What a viewer sees, by the exact method: each cell that is entered is entered through a portal, of which a side at least is compared.
fn eye_to_cell(rates: &Rates, table: &Table) -> Path {
    let cells = TableCells::new(table);
    let subgraphs: Vec<VisibleSubgraph> = (0..table.n_cells() as u32)
        .map(|cell| VisibleSubgraph::prepare(&cells, CellId(cell)).expect("memory does not fail"))
        .collect();
    let stands = wander(&cells, 300, 0.1, 1).expect("memory does not fail");
    let (mut scratch, mut seen, mut n_seen) = (Scratch::new(), VisibleSet::new(), 0);
    let seconds = least(|| {
        n_seen = 0;
        for stand in &stands {
            let view =
                View::perspective_horizontal(stand.eye, stand.dir, [0.0, 1.0, 0.0], 75f64.to_radians(), 4.0 / 3.0)
                    .expect("a view");
            seen.clear(table.n_cells(), table.objects().len());
            for cell in table.in_dimension().expect("it is of space").at(stand.eye).cells().iter().copied() {
                Method::Exact.look(&subgraphs[cell.idx()], &view, &Doors::all_open(), &mut scratch, &mut seen);
            }
            n_seen += seen.cells().len();
        }
    });
    let mean = n_seen as f64 / stands.len() as f64;
    Path {
        name: "what a viewer sees, exact method",
        of: format!("{mean:.0} cells on average"),
        seconds: seconds / stands.len() as f64,
        bound: mean * rates.orient3,
        counts: "an orientation for each cell".to_owned(),
    }
}

/// A buffer drawn: its texels are written.
fn buffer(rates: &Rates, short: bool) -> Path {
    let texels = if short { 64 } else { 512 };
    let n = if short { 50 } else { 1000 };
    let occluders: Vec<Occluder> = (0..n)
        .map(|i| {
            let at = |k: u32| f64::from((i * 7919 + k * 104_729) % 1000) / 1000.0;
            let z = 3.0 + 12.0 * at(1);
            let (x, y) = (z * (2.0 * at(2) - 1.0), z * (2.0 * at(3) - 1.0));
            let corner = |a: f64, b: f64| -> Point3 { [x + a, y + b, z + 0.2 * a] };
            let [a, b, c, d] = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
            Occluder::patch(vec![a, b, c, d], &[[a, b, c], [a, c, d]]).expect("a square")
        })
        .collect();
    let volume = Volume::new(Aabb { min: [-0.5; 3], max: [0.5; 3] }).expect("a box");
    let plane = BufferPlane::new(2, true, 20.0, [-20.0; 2], [20.0; 2], [texels; 2]).expect("a plane");
    let job = BufferJob::new(volume, vec![plane], &occluders, Measure::VertexHeight, false).expect("a job");
    let (mut backend, mut out) = (Fast::new(), Vec::new());
    let seconds = least(|| backend.render(&job, &mut out).expect("the processor does not fail"));
    Path {
        name: "a multifocal buffer drawn",
        of: format!("{n} squares, {texels} x {texels} texels"),
        seconds,
        bound: f64::from(texels * texels) * 4.0 / rates.memory,
        counts: "its bytes".to_owned(),
    }
}

fn picture(short: bool) -> (Faces, Camera) {
    let options = SurfaceOptions { seed: 1, triangles: if short { 500 } else { 100_000 }, layers: 8 };
    let faces = Faces::of_scene(&surfaces::soup(options).expect("in range")).expect("faces");
    let size = if short { [64, 48] } else { [640, 480] };
    let camera = Camera::look_at(surfaces::EYE, surfaces::AT, surfaces::UP, surfaces::ANGLE, size).expect("a camera");
    (faces, camera)
}

/// A picture by the exact z-buffer: each fragment's pixels are compared and some written.
fn zbuffer(rates: &Rates, short: bool) -> Path {
    let (faces, camera) = picture(short);
    let chosen = FaceMask::all(&faces);
    let shot = RenderInput { faces: &faces, camera: &camera, mask: &chosen };
    let method = ZBuffer::new(DepthFormat::Exact);
    let (_, counters) = method.picture(&shot);
    let seconds = least(|| drop(black_box(method.picture(&shot))));
    let bytes = faces.len() as f64 * 72.0 + counters.written as f64 * 12.0;
    Path {
        name: "a picture by the exact z-buffer",
        of: format!("{} triangles, {} pixels written", faces.len(), counters.written),
        seconds,
        bound: bytes / rates.memory,
        counts: "72 bytes a triangle, 12 a pixel written".to_owned(),
    }
}

/// A picture by the ray caster: each pixel's face is met, which is three orientations.
fn raycaster(rates: &Rates, short: bool) -> Path {
    let (faces, camera) = picture(short);
    let chosen = FaceMask::all(&faces);
    let shot = RenderInput { faces: &faces, camera: &camera, mask: &chosen };
    let method = RayCaster::build(&faces);
    let (_, counters) = method.picture(&shot);
    let seconds = least(|| drop(black_box(method.picture(&shot))));
    Path {
        name: "a picture by the ray caster",
        of: format!("{} triangles, {} pixels covered", faces.len(), counters.covered),
        seconds,
        bound: counters.covered as f64 * 3.0 * rates.orient3,
        counts: "3 orientations a pixel covered".to_owned(),
    }
}

/// The table of a plan: each visible pair is a bit that some line has to set, and each cell has a border that is compared.
fn plan_table(rates: &Rates, short: bool) -> Path {
    let options = if short {
        OfficeOptions::default()
    } else {
        OfficeOptions { rooms_x: 12, rooms_y: 10, ..OfficeOptions::default() }
    };
    let plan = office(options).expect("in range");
    let options = PlanBakeOptions { threads: 1, ..PlanBakeOptions::default() };
    let baked = bake_plan(&plan, &options).expect("an office can be baked");
    let seconds = least(|| drop(black_box(bake_plan(&plan, &options))));
    let pairs = baked.report.n_visible_pairs;
    Path {
        name: "the table of a plan",
        of: format!("{} cells, {pairs} visible pairs", baked.report.n_cells),
        seconds,
        bound: pairs as f64 * rates.orient2,
        counts: "an orientation for each visible pair".to_owned(),
    }
}

/// The REJECT table of a map: as for a plan, of sectors.
fn reject(rates: &Rates, short: bool) -> Path {
    let plan = doom_like(1, if short { 4 } else { 16 }).expect("in range");
    let n = plan.n_groups();
    let options = SearchOptions { threads: 1, ..SearchOptions::default() };
    let (seen, _) = see_groups(&plan, n, &options).expect("a map can be baked");
    let seconds = least(|| drop(black_box(see_groups(&plan, n, &options))));
    let pairs = (seen.count_ones() - u64::from(n)) / 2;
    Path {
        name: "the REJECT table of a map",
        of: format!("{n} sectors, {pairs} visible pairs"),
        seconds,
        bound: pairs as f64 * rates.orient2,
        counts: "an orientation for each visible pair".to_owned(),
    }
}

/// What Quake's `vis` does: of each visible pair that is not of neighbours some line passes a portal, on the right side of three edges at least.
fn vis(rates: &Rates, short: bool) -> Path {
    let side = if short { 1 } else { 2 };
    let world = quake_like(QuakeLikeOptions { seed: 1, rooms_x: side, rooms_y: side, floors: 2 }).expect("few rooms");
    let search = |graph| {
        let mut search = ConvexSearch::new(graph, ConvexOptions { threads: 1, ..ConvexOptions::default() });
        while search.advance() {}
        search.finish()
    };
    let n = world.graph.n_cells();
    let pairs = (search(&world.graph).cells.count_ones() - n as u64) / 2;
    let seconds = least(|| drop(black_box(search(&world.graph))));
    Path {
        name: "the visibility of a Quake level",
        of: format!("{n} leafs, {} portals, {pairs} visible pairs", world.graph.portals().len()),
        seconds,
        bound: pairs as f64 * 3.0 * rates.orient3,
        counts: "3 orientations for each visible pair".to_owned(),
    }
}

/// What given rooms see: of each visible pair some line is free, so it is compared with a wall at least, along three axes.
fn given_cells(rates: &Rates, scene: &Scene, options: TowerOptions) -> Path {
    let rooms = tower_rooms(options).expect("in range");
    let cells = (0u32..).zip(&rooms).map(|(i, room)| ViewCell { id: i.to_string(), bounds: room.bounds }).collect();
    let cells = CellsFrom::Boxes(ViewCells { cells, axes: None });
    let options = RegionBakeOptions { threads: 1, ..RegionBakeOptions::new(&cells) };
    let baked = bake_regions(scene, &options).expect("a tower can be baked");
    let seconds = least(|| drop(black_box(bake_regions(scene, &options))));
    let pairs = baked.report.n_objects_seen + baked.report.n_visible_pairs;
    Path {
        name: "what given rooms see",
        of: format!("{} rooms, {} objects, {pairs} visible pairs", rooms.len(), scene.objects().len()),
        seconds,
        bound: pairs as f64 * 3.0 * rates.orient2 / 2.0,
        counts: "3 comparisons of half an orientation for each visible pair".to_owned(),
    }
}
