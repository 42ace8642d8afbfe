//! A viewer walks along a row of rooms: with everything in memory, and with sources that are late, fail, or are gone.

use sightlines_eye_to_cell::{CellSource, Method, MirrorPiece, PortalEdge, StabStep, StepBudget, TableCells, View};
use sightlines_geometry::Aabb;
use sightlines_pvs::{
    BitMatrix, CellId, CellRecord, DoorId, DoorRecord, Frame, Locator, MirrorId, MirrorRecord, ObjectId, ObjectRecord,
    PortalId, PortalRecord, Table, TableKind, TableParts,
};
use sightlines_walkthrough::{
    AnswerKind, MeasureError, Prefetcher, Prepare, WalkMeasure, WalkOptions, Walkthrough, usual_step,
};
use std::collections::BTreeSet;
use std::sync::{Arc, Condvar, Mutex};

/// `n` rooms of unit size in a row, each with an object, visible from at most two rooms away; doors in the middle.
fn rooms(n: u32) -> Arc<Table> {
    let record = |i: u32| {
        let x = f64::from(i);
        CellRecord { min: [x, 0.0, 0.0], max: [x + 1.0, 1.0, 0.0], group: None, polygon: vec![] }
    };
    let cells: Vec<CellRecord> = (0..n).map(record).collect();
    let bounds: Vec<_> = cells.iter().map(|c| (c.min, c.max)).collect();
    let mut rows = BitMatrix::identity(n as usize);
    for a in 0..n as usize {
        for b in a.saturating_sub(2)..(a + 3).min(n as usize) {
            rows.set(a, b, true);
        }
    }
    let door = |i: u32| {
        let x = f64::from(i) + 1.0;
        PortalRecord { cells: [CellId(i), CellId(i + 1)], sides: [0, 1], points: vec![[x, 0.75, 0.0], [x, 0.25, 0.0]] }
    };
    let object = |c: &CellRecord| {
        let middle = [c.min[0] + 0.5, 0.5, 0.0];
        ObjectRecord { name: String::new(), min: middle, max: middle }
    };
    let parts = TableParts {
        rows,
        portals: (0..n - 1).map(door).collect(),
        objects: cells.iter().map(object).collect(),
        cell_objects: (0..n).map(|i| vec![ObjectId(i)]).collect(),
        locator: Locator::build(&bounds, 2),
        cells,
        ..TableParts::empty(2, TableKind::Unspecified)
    };
    Arc::new(Table::new(parts).unwrap())
}

fn looking_right(x: f64) -> View {
    View::planar([x, 0.5], [1.0, 0.0], 0.5).unwrap()
}

/// A gate that is shut until it is opened.
#[derive(Default)]
struct Gate(Mutex<bool>, Condvar);

impl Gate {
    fn wait(&self) {
        let mut open = self.0.lock().unwrap();
        while !*open {
            open = self.1.wait(open).unwrap();
        }
    }

    fn open(&self) {
        *self.0.lock().unwrap() = true;
        self.1.notify_all();
    }
}

/// A source that waits at a gate before each cell, and fails on one.
struct Slow {
    table: TableCells<Arc<Table>>,
    gate: Arc<Gate>,
    broken: Option<CellId>,
}

impl CellSource for Slow {
    type Error = String;

    fn dimension(&self) -> u8 {
        CellSource::dimension(&self.table)
    }
    fn frame(&self) -> Option<Frame> {
        self.table.frame()
    }
    fn leaves_gaps(&self) -> bool {
        CellSource::leaves_gaps(&self.table)
    }

    fn n_cells(&self) -> usize {
        CellSource::n_cells(&self.table)
    }
    fn n_objects(&self) -> usize {
        CellSource::n_objects(&self.table)
    }
    fn cell_box(&self, cell: CellId) -> Result<Aabb<3>, String> {
        self.table.cell_box(cell).map_err(|e| match e {})
    }
    fn visible(&self, cell: CellId, out: &mut Vec<CellId>) -> Result<(), String> {
        self.gate.wait();
        if self.broken == Some(cell) {
            return Err(format!("cell {cell} is broken"));
        }
        self.table.visible(cell, out).map_err(|e| match e {})
    }
    fn portal_edges(&self, cell: CellId, show: &mut dyn FnMut(PortalEdge<'_>)) -> Result<(), String> {
        self.table.portal_edges(cell, show).map_err(|e| match e {})
    }
    fn objects_of(&self, cell: CellId, out: &mut Vec<ObjectId>) -> Result<(), String> {
        self.table.objects_of(cell, out).map_err(|e| match e {})
    }
    fn objects_seen(&self, cell: CellId, out: &mut Vec<ObjectId>) -> Result<(), String> {
        self.table.objects_seen(cell, out).map_err(|e| match e {})
    }
    fn object_box(&self, object: ObjectId) -> Result<Aabb<3>, String> {
        self.table.object_box(object).map_err(|e| match e {})
    }
    fn mirrors(&self, cell: CellId, show: &mut dyn FnMut(MirrorPiece<'_>)) -> Result<(), String> {
        self.table.mirrors(cell, show).map_err(|e| match e {})
    }
    fn stab_roots(&self, cell: CellId, out: &mut Vec<u32>) -> Result<Option<bool>, String> {
        self.table.stab_roots(cell, out).map_err(|e| match e {})
    }
    fn stab_node(&self, node: u32, children: &mut Vec<u32>) -> Result<StabStep, String> {
        self.table.stab_node(node, children).map_err(|e| match e {})
    }
}

fn slow(table: &Arc<Table>, broken: Option<CellId>) -> (Slow, Arc<Gate>) {
    let gate = Arc::new(Gate::default());
    (Slow { table: TableCells::new(Arc::clone(table)), gate: Arc::clone(&gate), broken }, gate)
}

type Walk = Walkthrough<TableCells<Arc<Table>>, Slow>;

fn walk(table: &Arc<Table>, source: Slow, options: WalkOptions) -> Walk {
    Walkthrough::new(TableCells::new(Arc::clone(table)), source, options)
}

/// Repeats a frame until its answer is not late, and returns its cells and objects.
fn until_full(walk: &mut Walk, view: &View, method: Method) -> (BTreeSet<u32>, BTreeSet<u32>) {
    loop {
        let frame = walk.frame(view, method);
        if frame.answer == AnswerKind::Full {
            return (
                frame.seen.cells().iter().map(|c| c.0).collect(),
                frame.seen.objects().iter().map(|o| o.0).collect(),
            );
        }
        std::thread::yield_now();
    }
}

#[test]
fn frames_do_not_wait_for_a_source_that_never_comes() {
    let table = rooms(40);
    let (source, gate) = slow(&table, None);
    let mut walk = walk(&table, source, WalkOptions::default());
    let (full, full_gate) = slow(&table, None);
    full_gate.open();
    let mut twin = Walkthrough::new(TableCells::new(Arc::clone(&table)), full, WalkOptions::default());
    // The gate stays shut: if a frame waited, this would never end.
    let (mut n, mut n_seen, mut n_table) = (0, 0, 0);
    for k in 0..1000 {
        let view = looking_right(0.5 + 0.038 * f64::from(k));
        let (cells, objects) = until_full(&mut twin, &view, Method::Exact);
        let frame = walk.frame(&view, Method::Exact);
        assert_eq!(frame.answer, AnswerKind::Late);
        assert!(cells.iter().all(|&c| frame.seen.has_cell(CellId(c))), "late, and less");
        assert!(objects.iter().all(|&o| frame.seen.has_object(ObjectId(o))));
        n += 1;
        n_seen += frame.seen.objects().len();
        n_table += table.visible_objects(frame.at[0]).len();
    }
    assert_eq!((n, walk.counters().late), (1000, 1000));
    // What stands in the rooms behind the eye is out of view.
    assert!(5 * n_seen < 4 * n_table, "{n_seen} of {n_table}");
    // When it arrives, the answer is the method's.
    gate.open();
    let view = looking_right(0.5);
    assert_eq!(until_full(&mut walk, &view, Method::Exact), until_full(&mut twin, &view, Method::Exact));
}

#[test]
fn what_is_ahead_is_there_in_time() {
    let table = rooms(40);
    let (source, gate) = slow(&table, None);
    gate.open();
    let options = WalkOptions { frames_ahead: 200, ..WalkOptions::default() };
    let mut walk = walk(&table, source, options);
    let mut late = Vec::new();
    for k in 0..3000 {
        let view = looking_right(0.5 + 0.01 * f64::from(k));
        if walk.frame(&view, Method::IncidentPortals).answer == AnswerKind::Late {
            late.push(k);
        }
        // The rest of the frame takes as long as its requests.
        while !walk.is_idle() {
            std::thread::yield_now();
        }
    }
    // The first cell cannot be predicted; nothing else is late.
    assert_eq!(late, [0]);
    assert!(walk.prepared().0 >= 31, "{:?}", walk.prepared());
}

#[test]
fn frames_are_repeated_and_doors_are_heard() {
    let table = rooms(5);
    let (source, gate) = slow(&table, None);
    gate.open();
    let mut walk = walk(&table, source, WalkOptions::default());
    let view = looking_right(0.5);
    let (open, _) = until_full(&mut walk, &view, Method::Exact);
    assert_eq!(open, BTreeSet::from([0, 1, 2]));
    let before = walk.counters().repeated;
    walk.frame(&view, Method::Exact);
    assert_eq!(walk.counters().repeated, before + 1);
    // The door between rooms 1 and 2.
    assert!(walk.close(PortalId(1)) && !walk.close(PortalId(1)));
    assert_eq!(until_full(&mut walk, &view, Method::Exact).0, BTreeSet::from([0, 1]));
    assert_eq!(until_full(&mut walk, &view, Method::CellToCell).0, open, "the table knows no doors");
    assert!(walk.open(PortalId(1)));
    assert_eq!(until_full(&mut walk, &view, Method::Exact).0, open);
}

/// A frame hears of doors that are shut and opened by their ids; another table has other doors, so there they are open, and portals that were
/// closed by their numbers stay closed.
#[test]
fn doors_are_shut_until_the_table_changes() {
    let wings = [PortalId(0), PortalId(1)].map(|portal| DoorRecord {
        name: "wing".to_owned(),
        object: None,
        portals: if portal.0 == 0 { vec![portal, PortalId(1)] } else { vec![portal] },
    });
    let table = Arc::new(rooms(5).as_ref().clone().with_doors(wings.to_vec()).unwrap());
    let (source, gate) = slow(&table, None);
    gate.open();
    let mut walk = walk(&table, source, WalkOptions::default());
    let view = looking_right(0.5);
    let sees = |walk: &mut Walk| until_full(walk, &view, Method::Exact).0.len();
    assert_eq!(sees(&mut walk), 3);
    for door in table.door("wing") {
        assert!(walk.close_door(table.doors(), door) && !walk.close_door(table.doors(), door));
    }
    assert_eq!(sees(&mut walk), 1);
    assert!(walk.open_door(DoorId(0)) && !walk.open_door(DoorId(0)));
    assert_eq!(sees(&mut walk), 2, "the other door is shut");
    walk.close(PortalId(0));
    let (source, gate) = slow(&table, None);
    gate.open();
    walk.replace(TableCells::new(Arc::clone(&table)), source, Some);
    assert_eq!((sees(&mut walk), walk.doors().n_closed(), walk.doors().shut().count()), (1, 1, 0));
    walk.open(PortalId(0));
    assert_eq!(sees(&mut walk), 3);
}

#[test]
fn budget_is_kept_while_walking() {
    let table = rooms(60);
    let (source, gate) = slow(&table, None);
    gate.open();
    let budget = 6000;
    let mut walk = walk(&table, source, WalkOptions { budget, frames_ahead: 0, ..WalkOptions::default() });
    let mut most = 0;
    for k in 0..59 {
        until_full(&mut walk, &looking_right(0.5 + f64::from(k)), Method::Exact);
        most = most.max(walk.kept().0);
    }
    assert!(most <= budget && most > budget / 2, "{most}");
    assert!(walk.prepared().1 > 40, "{:?}", walk.prepared());
}

#[test]
fn outside_sees_everything() {
    let table = rooms(4);
    let (source, _gate) = slow(&table, None);
    let mut walk = walk(&table, source, WalkOptions::default());
    let view = View::planar([0.5, 7.0], [1.0, 0.0], 0.1).unwrap();
    let frame = walk.frame(&view, Method::Exact);
    assert_eq!(frame.answer, AnswerKind::Outside);
    assert_eq!((frame.seen.cells().len(), frame.seen.objects().len(), frame.at.len()), (4, 4, 0));
}

#[test]
fn failures_are_reported_and_frames_stay_right() {
    let table = rooms(4);
    let (source, gate) = slow(&table, Some(CellId(0)));
    gate.open();
    let mut walk = walk(&table, source, WalkOptions::default());
    let error = loop {
        let frame = walk.frame(&looking_right(0.5), Method::Exact);
        assert_eq!(frame.answer, AnswerKind::Late);
        assert_eq!(frame.seen.cells().len(), 3);
        if let Some(error) = walk.take_error() {
            break error;
        }
    };
    assert_eq!(error, (CellId(0), "cell 0 is broken".to_owned()));
    // The next cell is right again, and the broken one is requested each time.
    until_full(&mut walk, &looking_right(1.5), Method::Exact);
    while walk.take_error().is_none() {
        walk.frame(&looking_right(0.5), Method::Exact);
    }
}

/// A maker that panics: frames continue without it.
struct Panics;

impl Prepare for Panics {
    type Prepared = ();
    type Error = ();

    fn prepare(&mut self, _: CellId) -> Result<(), ()> {
        panic!("a maker that fails on purpose")
    }

    fn n_bytes(_: &()) -> usize {
        1
    }
}

#[test]
fn a_maker_that_panics_stops_nobody() {
    let mut prefetcher = Prefetcher::new(Panics, 10);
    while prefetcher.is_working() {
        prefetcher.wish(&[CellId(1)]);
        prefetcher.poll();
    }
    prefetcher.wish(&[CellId(2)]);
    assert!(prefetcher.get(CellId(1)).is_none() && !prefetcher.has(CellId(2)));
}

#[test]
fn wanderers_stay_inside() {
    let table = rooms(12);
    let cells = TableCells::new(Arc::clone(&table));
    let walk = sightlines_walkthrough::wander(&cells, 5000, 0.05, 3).unwrap();
    assert_eq!(walk.len(), 5000);
    let mut visited = BTreeSet::new();
    for stand in &walk {
        let at = table.place_at(stand.eye);
        assert!(!at.is_outside(), "{stand:?}");
        visited.extend(at.cells().to_vec());
        View::planar([stand.eye[0], stand.eye[1]], [stand.dir[0], stand.dir[1]], 1.0).unwrap();
    }
    assert_eq!(visited.len(), 12);
    assert_eq!(walk, sightlines_walkthrough::wander(&cells, 5000, 0.05, 3).unwrap());
    assert_ne!(walk, sightlines_walkthrough::wander(&cells, 5000, 0.05, 4).unwrap());
    let alone = Arc::new(Table::new(TableParts::empty(2, TableKind::Unspecified)).unwrap());
    assert!(sightlines_walkthrough::wander(&TableCells::new(alone), 10, 0.05, 3).unwrap().is_empty());
}

/// Boxes without portals: two that touch on a face, one that touches these on an edge only, and one apart.
#[test]
fn wanderers_without_portals_go_where_boxes_touch() {
    let corners = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [4.0, 2.0, 0.0], [9.0, 9.0, 9.0]];
    let cell = |min: [f64; 3]| CellRecord { min, max: min.map(|x| x + 2.0), polygon: Vec::new(), group: None };
    let n = corners.len();
    let mut rows = BitMatrix::new(n, n);
    (0..n * n).for_each(|k| rows.set(k / n, k % n, true));
    let parts = TableParts {
        cells: corners.map(cell).to_vec(),
        rows,
        cell_objects: vec![Vec::new(); n],
        locator: Locator::build(&corners.map(cell).map(|cell| (cell.min, cell.max)), 2),
        ..TableParts::empty(3, TableKind::Unspecified)
    };
    let table = Arc::new(Table::new(parts).unwrap());
    let walk = sightlines_walkthrough::wander(&TableCells::new(Arc::clone(&table)), 4000, 0.1, 3).unwrap();
    assert_eq!(walk.len(), 4000);
    let at: Vec<Vec<u32>> =
        walk.iter().map(|stand| table.place_at(stand.eye).cells().iter().map(|cell| cell.0).collect()).collect();
    assert!(at.iter().all(|cells| !cells.is_empty()), "a frame is outside of all cells");
    let visited: BTreeSet<u32> = at.iter().flatten().copied().collect();
    assert_eq!(visited, BTreeSet::from([0, 1, 2, 3]));
    // From frame to frame the walk crosses the face; elsewhere it begins anew, after forty cells.
    let crosses = |from: u32, to: u32| at.windows(2).filter(|w| w[0] == [from] && w[1].contains(&to)).count();
    assert!(crosses(0, 1) > 20 && crosses(1, 0) > 20, "{} {}", crosses(0, 1), crosses(1, 0));
    assert!(crosses(1, 2) + crosses(2, 1) < 20, "an edge is no way");
}

/// One room with mirrors on its upper and lower wall.
pub(crate) fn hall_of_mirrors() -> Arc<Table> {
    let mut parts = Arc::unwrap_or_clone(rooms(2)).into_parts();
    let mirror = |cell: u32, face: u32, left: [f64; 2], right: [f64; 2]| MirrorRecord {
        cell: CellId(cell),
        mirror: MirrorId(face),
        points: vec![[left[0], left[1], 0.0], [right[0], right[1], 0.0]],
    };
    // Left end first, as seen from inside the room.
    parts.mirrors = vec![mirror(0, 7, [0.0, 1.0], [1.0, 1.0]), mirror(1, 8, [2.0, 0.0], [1.0, 0.0])];
    Arc::new(Table::new(parts).unwrap())
}

#[test]
fn mirrors_in_mirrors_come_in_time() {
    let table = hall_of_mirrors();
    let (source, gate) = slow(&table, None);
    let mut walk = walk(&table, source, WalkOptions { bounces: 2, ..WalkOptions::default() });
    // Up and to the right: by the mirror of the first room, through the door, to the mirror of the second.
    let view = View::planar([0.5, 0.5], [1.0, 1.0], 0.5).unwrap();
    assert_eq!(walk.frame(&view, Method::Exact).answer, AnswerKind::Late);
    gate.open();
    until_full(&mut walk, &view, Method::Exact);
    let frame = walk.frame(&view, Method::Exact);
    let words: Vec<_> = frame.images.iter().map(|image| (image.mirrors.clone(), image.complete)).collect();
    assert_eq!(words, [(vec![MirrorId(7)], true), (vec![MirrorId(7), MirrorId(8)], true)]);
    assert_eq!(frame.images[0].cells, [CellId(0), CellId(1)]);
}

#[test]
fn cells_on_a_border_do_not_drop_each_other() {
    let table = rooms(6);
    let (source, gate) = slow(&table, None);
    gate.open();
    let mut walk = walk(&table, source, WalkOptions { budget: 1, ..WalkOptions::default() });
    let (cells, _) = until_full(&mut walk, &looking_right(3.0), Method::CellToCell);
    assert_eq!(cells, BTreeSet::from([0, 1, 2, 3, 4, 5]));
}

/// Without a thread, only a frame in a cell that nothing predicted is late, the answers are those with a thread, and a
/// walk repeats exactly.
#[test]
fn frames_without_a_thread_prepare_what_they_request() {
    let table = rooms(12);
    let options = WalkOptions { has_thread: false, ..WalkOptions::default() };
    let run = || {
        let (source, gate) = slow(&table, Some(CellId(9)));
        gate.open();
        let mut walk = walk(&table, source, options);
        let mut answers = Vec::new();
        for k in 0..100 {
            let view = looking_right(0.5 + 0.08 * f64::from(k));
            let frame = walk.frame(&view, Method::Exact);
            let cells: Vec<u32> = frame.seen.cells().iter().map(|c| c.0).collect();
            answers.push((frame.answer, cells));
            assert!(walk.is_idle(), "frame {k}");
        }
        let error = walk.take_error().map(|(cell, _)| cell);
        (answers, walk.counters(), walk.prepared(), error)
    };
    let (answers, counters, prepared, error) = run();
    assert_eq!((answers.clone(), counters, prepared, error), run());
    assert_eq!((error, answers[0].0), (Some(CellId(9)), AnswerKind::Late));
    let (source, gate) = slow(&table, None);
    gate.open();
    let mut twin = walk(&table, source, WalkOptions::default());
    for (k, (answer, cells)) in (0..100).zip(&answers).skip(1).take_while(|(k, _)| 0.5 + 0.08 * f64::from(*k) < 9.0) {
        assert_eq!(*answer, AnswerKind::Full, "frame {k}");
        let full = until_full(&mut twin, &looking_right(0.5 + 0.08 * f64::from(k)), Method::Exact);
        assert_eq!(cells.iter().copied().collect::<BTreeSet<u32>>(), full.0, "frame {k}");
    }
}

/// A frame that is too much work says so, is counted, and shows no less; with all the work there is, it is the method's.
#[test]
fn frames_fall_back_and_say_so() {
    let table = rooms(12);
    let frames = |steps: StepBudget, method: Method| {
        let (source, gate) = slow(&table, None);
        gate.open();
        let options = WalkOptions { has_thread: false, steps, ..WalkOptions::default() };
        let mut walk = walk(&table, source, options);
        let mut all = Vec::new();
        for k in 0..40 {
            // Each view twice: the second time the answer is repeated.
            let view = looking_right(0.5 + 0.16 * f64::from(k / 2));
            let frame = walk.frame(&view, method);
            if frame.answer == AnswerKind::Full {
                all.push((k, frame.method, frame.seen.cells().iter().map(|c| c.0).collect::<BTreeSet<u32>>()));
            }
        }
        (all, walk.counters())
    };
    let (exact, counters) = frames(StepBudget::UNLIMITED, Method::Exact);
    assert!(exact.len() > 30 && exact.iter().all(|frame| frame.1 == Method::Exact) && counters.fell_back == 0);
    assert_eq!(frames(StepBudget::FRAME, Method::Exact), (exact.clone(), counters));
    let (coarser, counters) = frames(StepBudget::steps(0), Method::Exact);
    assert!(coarser.iter().all(|frame| frame.1 == Method::IncidentPortals));
    assert_eq!(counters.fell_back, coarser.len() as u64);
    assert!(counters.repeated >= 10, "{counters:?}");
    let cells = |list: &[(i32, Method, BTreeSet<u32>)]| list.iter().map(|f| (f.0, f.2.clone())).collect::<Vec<_>>();
    let (incident, counters) = frames(StepBudget::steps(0), Method::IncidentPortals);
    assert_eq!((cells(&coarser), counters.fell_back), (cells(&incident), 0));
    for ((_, _, fine), (_, _, wide)) in exact.iter().zip(&coarser) {
        assert!(fine.is_subset(wide));
    }
}

/// What is left to draw is counted on the frames inside, and methods in the wrong order are found out.
#[test]
fn walks_are_measured() {
    let cells = TableCells::new(rooms(8));
    let views: Vec<View> = (0..20).map(|k| looking_right(-0.7 + 0.4 * f64::from(k))).collect();
    let walk =
        WalkMeasure { cells: &cells, views: &views, polygons: &[2; 8], options: WalkOptions::default(), fps: None };
    let measured = walk.run(&[Method::CellToCell, Method::Exact], &|_, _| {}).unwrap();
    assert_eq!((measured.n_full, measured.n_outside, measured.n_starved), (18, 2, 0));
    let [all, exact] = &measured.methods[..] else { panic!("{measured:?}") };
    assert!(exact.left.cells < all.left.cells && exact.times.len() == 18 && measured.most_bytes > 0);
    assert_eq!(all.left.polygons, 2 * all.left.objects);
    let reversed = walk.run(&[Method::Exact, Method::CellToCell], &|_, _| {});
    assert!(matches!(reversed, Err(MeasureError::NotNested { coarser: Method::Exact, .. })));
    assert_eq!(usual_step(&cells), Ok(65f64.sqrt() / 400.0));
}
