//! Tables against rays: what clear lines join must be in the table, and how much more there is.
//!
//! Each line is one that [`RayScene`] calls clear: its neighbours see the same. All cells that it passes on
//! its clear stretch see each other, and see the objects at both ends. So one line says much about every
//! table of its scene, whatever its cells are.

use crate::bits::SharedBits;
use crate::shares::{mean_share, triangles_of};
use crate::targets::Targets;
use sightlines::cells::{Point3, Scene};
use sightlines::geometry::Aabb;
use sightlines::geometry::vector::sub;
use sightlines::pvs::{CellId, ObjectId, Table};
use sightlines_testkit::{CellIndex, Random, RayScene};
use std::collections::BTreeMap;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// Lines that at least begin in every cell, if there are lines enough.
const LEAST: u64 = 8;
/// Lines that a thread takes at a time.
const CHUNK: u64 = 1024;
/// Pairs that are missing are kept up to so many.
const MAX_MISSING: usize = 100_000;

/// How many lines, and which.
#[derive(Debug, Clone, Copy)]
pub struct RayOptions {
    /// Lines to follow, both ways.
    pub n_rays: u64,
    /// Where chance begins.
    pub seed: u64,
    /// Number of threads; 0 for one for each core. Changes nothing but the time.
    pub threads: usize,
}

/// Two that see each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Pair {
    /// A cell and an object.
    Object(u32, u32),
    /// Two cells, the lower first.
    Cells(u32, u32),
}

/// A pair that a line joins and a table does not.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Missing {
    /// The pair.
    pub pair: Pair,
    /// The first line that joins it.
    pub ray: u64,
    /// A point on the line, in the open air.
    pub origin: Point3,
    /// Where it goes, both ways.
    pub direction: Point3,
}

/// What the lines say about one table.
#[derive(Debug, Clone, PartialEq)]
pub struct Verdict {
    /// Pairs of a cell and an object that the table joins.
    pub n_objects_reported: u64,
    /// Those that a line joins.
    pub n_objects_witnessed: u64,
    /// Cells through which no clear line passed that ends on something: the insides of solid things, or too
    /// small to be met.
    pub n_dark_cells: u64,
    /// Pairs of such a cell and an object that the table joins.
    pub n_objects_from_dark: u64,
    /// Unordered pairs of different cells that the table joins.
    pub n_cells_reported: u64,
    /// Those that a line joins.
    pub n_cells_witnessed: u64,
    /// Share of triangles that a viewer's table set has, on average over the cells by volume.
    pub reported_share: f64,
    /// The same for what lines were seen to reach.
    pub witnessed_share: f64,
    /// What the table misses, by pairs; the first hundred thousand.
    pub missing: Vec<Missing>,
}

impl Verdict {
    /// Pairs of cells and objects reported for each one witnessed.
    pub fn over_estimation(&self) -> f64 {
        self.n_objects_reported as f64 / self.n_objects_witnessed as f64
    }

    /// The same without the cells that no line passed through.
    pub fn over_estimation_lit(&self) -> f64 {
        (self.n_objects_reported - self.n_objects_from_dark) as f64 / self.n_objects_witnessed as f64
    }
}

/// What the lines say about tables of one scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Verdicts {
    /// Lines that could be witnesses: their origin is in the open air.
    pub n_clear: u64,
    /// One for each table.
    pub tables: Vec<Verdict>,
}

/// Follows lines through a scene and holds tables of it against them.
///
/// Half of the lines begin in cells of all tables in turn, some in every cell and the others by volume; of
/// these one half goes anywhere, the other to random points of objects. The other half of the lines, in two
/// rounds, goes from a cell to an object that a table says it sees and no line has joined it with yet; the
/// last round leaves out cells that no line has passed through so far.
///
/// The same seed gives the same verdicts with any number of threads.
///
/// # Panics
/// If a table is not of this scene.
pub fn judge(scene: &Scene, tables: &[Table], options: &RayOptions) -> Verdicts {
    let rays = RayScene::new(scene);
    let judge = Judge::new(scene, &rays, tables, options);
    let n = options.n_rays;
    let mut n_clear = judge.cast(0..n / 2, &Aim::Around);
    for (round, dark) in [(n / 2..n / 2 + n / 4, true), (n / 2 + n / 4..n, false)] {
        n_clear += judge.cast(round.clone(), &judge.doubtful(round.end - round.start, dark));
    }
    Verdicts { n_clear, tables: judge.verdicts(scene, tables) }
}

/// The objects that engines show along a ray from the open air, of which some draw the backs of what hides from its front only and some
/// do not: all whose backs the ray meets, up to what stops it, and that. Not robust: fit for a lower bound of what is seen, and not to find fault.
pub fn met(rays: &RayScene, scene: &Scene, origin: Point3, direction: Point3) -> Vec<u32> {
    let (mut met, mut at) = (Vec::new(), origin);
    let length = direction.iter().map(|x| x * x).sum::<f64>().sqrt();
    while let Some(hit) = rays.first_hit(at, direction) {
        if hit.front_facing || scene.hides_from_front(hit.object) {
            met.push(hit.object);
        }
        if hit.front_facing || !scene.hides_from_front(hit.object) {
            break;
        }
        let past = hit.t + rays.shift() / length / 1024.0;
        at = std::array::from_fn(|k| at[k] + direction[k] * past);
    }
    met
}

/// Where lines go.
enum Aim {
    /// Anywhere, from anywhere.
    Around,
    /// From a cell of a partition to an object.
    Doubtful(Vec<(usize, u32, u32)>),
}

/// Tables with the same cells, and what lines have seen in these.
struct Partition {
    /// Indices of the tables.
    tables: Vec<usize>,
    boxes: Vec<Aabb<3>>,
    index: CellIndex,
    /// Volume of the cells up to each.
    volumes: Vec<f64>,
    /// What all of the tables join.
    reported: [SharedBits; 2],
    /// What lines join: cells with objects, lower cells with higher ones.
    witnessed: [SharedBits; 2],
}

struct Judge<'a> {
    scene: &'a Scene,
    rays: &'a RayScene,
    targets: Targets<'a>,
    partitions: Vec<Partition>,
    options: &'a RayOptions,
    /// By partition and pair: what at least one of its tables does not join.
    missing: Mutex<BTreeMap<(usize, Pair), Missing>>,
}

fn boxes_of(table: &Table) -> Vec<Aabb<3>> {
    table.cells().iter().map(|c| Aabb { min: c.min, max: c.max }).collect()
}

fn cells_of(table: &Table) -> impl Iterator<Item = CellId> {
    (0..table.n_cells() as u32).map(CellId)
}

fn bits_of(table: &Table) -> [SharedBits; 2] {
    let bits =
        [SharedBits::new(table.n_cells(), table.objects().len()), SharedBits::new(table.n_cells(), table.n_cells())];
    for cell in cells_of(table) {
        table.visible_objects(cell).into_iter().for_each(|o| bits[0].set(cell.0, o.0));
        table.visible(cell).for_each(|other| bits[1].set(cell.0, other.0));
    }
    bits
}

impl Partition {
    fn new(rays: &RayScene, id: usize, table: &Table) -> Self {
        let boxes = boxes_of(table);
        let volume = |b: &Aabb<3>| (0..3).map(|k| b.max[k] - b.min[k]).product::<f64>();
        let sum = |sum: &mut f64, b: &Aabb<3>| {
            *sum += volume(b);
            Some(*sum)
        };
        let (n_cells, n_objects) = (boxes.len(), table.objects().len());
        Self {
            tables: vec![id],
            index: rays.cell_index(&boxes),
            volumes: boxes.iter().scan(0.0, sum).collect(),
            boxes,
            reported: bits_of(table),
            witnessed: [SharedBits::new(n_cells, n_objects), SharedBits::new(n_cells, n_cells)],
        }
    }

    /// Whether no line that ends on something has passed through a cell.
    fn is_dark(&self, cell: u32) -> bool {
        self.witnessed[0].ones(cell).is_empty()
    }

    /// A cell, by volume.
    fn any_cell(&self, random: &mut Random) -> usize {
        let at = random.unit() * self.volumes.last().copied().unwrap_or(0.0);
        self.volumes.partition_point(|v| *v < at).min(self.boxes.len() - 1)
    }
}

impl<'a> Judge<'a> {
    fn new(scene: &'a Scene, rays: &'a RayScene, tables: &[Table], options: &'a RayOptions) -> Self {
        let mut partitions: Vec<Partition> = Vec::new();
        for (id, table) in tables.iter().enumerate() {
            assert_eq!(table.objects().len(), scene.objects().len(), "table {id} is of another scene");
            match partitions.iter_mut().find(|p| p.boxes == boxes_of(table)) {
                Some(same) => {
                    same.tables.push(id);
                    let bits = bits_of(table);
                    same.reported.iter_mut().zip(&bits).for_each(|(all, one)| all.intersect(one));
                }
                None => partitions.push(Partition::new(rays, id, table)),
            }
        }
        Self { scene, rays, targets: Targets::new(scene), partitions, options, missing: Mutex::default() }
    }

    /// What the tightest tables report and no line has shown: all of it, or evenly spread `limit` or fewer.
    ///
    /// * `dark`: whether cells count that no line has passed through.
    fn doubtful(&self, limit: u64, dark: bool) -> Aim {
        let unseen = |p: &Partition, cell: u32| {
            if dark || !p.is_dark(cell) { p.reported[0].without(&p.witnessed[0], cell) } else { Vec::new() }
        };
        let rows =
            || self.partitions.iter().enumerate().flat_map(|(i, p)| (0..p.boxes.len() as u32).map(move |c| (i, p, c)));
        let all: u64 = rows().map(|(_, p, cell)| unseen(p, cell).len() as u64).sum();
        let stride = (all / limit.max(1) + 1) as usize;
        let pairs = rows().flat_map(|(i, p, cell)| unseen(p, cell).into_iter().map(move |object| (i, cell, object)));
        Aim::Doubtful(pairs.step_by(stride).collect())
    }

    /// Follows the lines of a range of numbers; returns how many were clear.
    fn cast(&self, range: std::ops::Range<u64>, aim: &Aim) -> u64 {
        let possible = self.partitions.iter().all(|p| !p.boxes.is_empty()) && !self.partitions.is_empty();
        let idle = matches!(aim, Aim::Doubtful(pairs) if pairs.is_empty());
        if !possible || idle {
            return 0;
        }
        let (next, n_clear) = (AtomicU64::new(range.start), AtomicU64::new(0));
        let work = || {
            let mut passed = Vec::new();
            loop {
                let start = next.fetch_add(CHUNK, Relaxed);
                if start >= range.end {
                    return;
                }
                let chunk = start..(start + CHUNK).min(range.end);
                let clear = chunk.filter(|&ray| self.follow(ray, &range, aim, &mut passed)).count();
                n_clear.fetch_add(clear as u64, Relaxed);
            }
        };
        std::thread::scope(|scope| {
            let others: Vec<_> = (1..threads(self.options.threads)).map(|_| scope.spawn(work)).collect();
            work();
            others.into_iter().for_each(|t| t.join().expect("a thread that follows lines does not panic"));
        });
        n_clear.into_inner()
    }

    /// Follows one line; false if it is not clear.
    fn follow(&self, ray: u64, range: &std::ops::Range<u64>, aim: &Aim, passed: &mut Vec<u32>) -> bool {
        let mut random = Random::new(self.options.seed, ray);
        let nth = ray - range.start;
        let (origin, direction) = match aim {
            Aim::Around => {
                let n_partitions = self.partitions.len() as u64;
                let partition = &self.partitions[(nth % n_partitions) as usize];
                let (turn, n_cells) = (nth / n_partitions, partition.boxes.len() as u64);
                let in_turn = turn < (LEAST * n_cells).min((range.end - range.start) / n_partitions / 2);
                let cell = if in_turn { (turn % n_cells) as usize } else { partition.any_cell(&mut random) };
                let origin = random.point(&partition.boxes[cell]);
                let target = if random.below(2) == 0 { None } else { self.targets.any(&mut random) };
                (origin, target.map_or_else(|| random.direction(), |t| sub(t, origin)))
            }
            Aim::Doubtful(pairs) => {
                let (partition, cell, object) = pairs[(nth % pairs.len() as u64) as usize];
                let origin = random.point(&self.partitions[partition].boxes[cell as usize]);
                let target = self.targets.on(object, &mut random);
                let direction = target.map_or_else(|| random.direction(), |t| sub(t, origin));
                // What is seen past backs, or of backs, which clear lines do not show.
                if !self.scene.front_occluders().is_empty()
                    && met(self.rays, self.scene, origin, direction).contains(&object)
                {
                    self.partitions[partition].witnessed[0].set(cell, object);
                }
                (origin, direction)
            }
        };
        let Some(line) = self.rays.clear_line(origin, direction) else { return false };
        for (id, partition) in self.partitions.iter().enumerate() {
            partition.index.passed(&line, passed);
            let note = |kind: usize, pair: Pair, a: u32, b: u32| {
                partition.witnessed[kind].set(a, b);
                if !partition.reported[kind].get(a, b) {
                    self.miss(id, Missing { pair, ray, origin, direction: line.direction });
                }
            };
            for (k, &cell) in passed.iter().enumerate() {
                line.ends.into_iter().flatten().for_each(|o| note(0, Pair::Object(cell, o), cell, o));
                passed[k + 1..].iter().for_each(|&other| note(1, Pair::Cells(cell, other), cell, other));
            }
        }
        true
    }

    /// Keeps the first line that shows a pair; which that is does not depend on threads.
    fn miss(&self, partition: usize, missing: Missing) {
        let mut all = self.missing.lock().expect("a thread that follows lines does not panic");
        let room = all.len() < MAX_MISSING;
        match all.get_mut(&(partition, missing.pair)) {
            Some(known) if known.ray > missing.ray => *known = missing,
            None if room => drop(all.insert((partition, missing.pair), missing)),
            _ => {}
        }
    }

    fn verdicts(self, scene: &Scene, tables: &[Table]) -> Vec<Verdict> {
        let triangles = triangles_of(scene);
        let missing = self.missing.into_inner().expect("a thread that follows lines does not panic");
        let verdict = |(id, table): (usize, &Table)| {
            let found = self.partitions.iter().position(|p| p.tables.contains(&id));
            let partition = found.expect("every table has its cells");
            let [objects, cells] = &self.partitions[partition].witnessed;
            let seen: u64 = cells_of(table).map(|c| table.visible(c).count() as u64).sum();
            let lacks = |pair: Pair| match pair {
                Pair::Object(cell, object) => {
                    table.visible_objects(CellId(cell)).binary_search(&ObjectId(object)).is_err()
                }
                Pair::Cells(a, b) => !table.sees(CellId(a), CellId(b)),
            };
            let dark: Vec<CellId> = cells_of(table).filter(|c| self.partitions[partition].is_dark(c.0)).collect();
            let reported = |c: CellId| table.visible_objects(c).len() as u64;
            let own = missing.iter().filter(|((p, pair), _)| *p == partition && lacks(*pair));
            Verdict {
                n_objects_reported: cells_of(table).map(reported).sum(),
                n_dark_cells: dark.len() as u64,
                n_objects_from_dark: dark.into_iter().map(reported).sum(),
                n_objects_witnessed: objects.count_ones(),
                n_cells_reported: (seen - table.n_cells() as u64) / 2,
                n_cells_witnessed: cells.count_ones(),
                reported_share: mean_share(table, &triangles, |c| table.visible_objects(c).into_iter().map(|o| o.0)),
                witnessed_share: mean_share(table, &triangles, |c| objects.ones(c.0)),
                missing: own.map(|(_, m)| *m).collect(),
            }
        };
        tables.iter().enumerate().map(verdict).collect()
    }
}

fn threads(asked: usize) -> usize {
    if asked > 0 { asked } else { std::thread::available_parallelism().map_or(1, usize::from) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sightlines::bake::{PortalMode, SceneBakeOptions, bake_scene};
    use sightlines::scenes::{TowerOptions, tower};

    fn rooms() -> (Scene, Vec<Table>) {
        let options = TowerOptions { floors: 1, rooms_x: 1, rooms_y: 1, furniture: 1, ..TowerOptions::default() };
        let scene = tower(options).unwrap();
        let table = |portals| {
            let options = SceneBakeOptions { portals, ..SceneBakeOptions::default() };
            bake_scene(&scene, &options).unwrap().table
        };
        let tables = [PortalMode::Bounding, PortalMode::Exact].map(table).to_vec();
        (scene, tables)
    }

    #[test]
    fn tables_hold_and_threads_change_nothing() {
        let (scene, tables) = rooms();
        let verdicts = |threads| judge(&scene, &tables, &RayOptions { n_rays: 6000, seed: 3, threads });
        let one = verdicts(1);
        assert_eq!(one, verdicts(3));
        assert!(one.n_clear > 1000, "{}", one.n_clear);
        for v in &one.tables {
            assert!(v.missing.is_empty(), "{:?}", v.missing);
            assert!(v.over_estimation_lit() >= 1.0 && v.over_estimation_lit() <= v.over_estimation());
            assert!(0 < v.n_objects_witnessed && v.n_objects_witnessed <= v.n_objects_reported);
            assert!(0 < v.n_cells_witnessed && v.n_cells_witnessed <= v.n_cells_reported);
            assert!(0.0 < v.witnessed_share && v.witnessed_share <= v.reported_share && v.reported_share <= 1.0);
        }
        assert!(one.tables[1].n_objects_reported <= one.tables[0].n_objects_reported);
    }

    /// The impostor: what is taken out of a table is missed, with a line that shows it.
    #[test]
    fn pairs_taken_out_are_missed() {
        let (scene, tables) = rooms();
        let options = RayOptions { n_rays: 4000, seed: 3, threads: 0 };
        let mut parts = tables[1].clone().into_parts();
        let seen = parts.objects_seen.as_mut().unwrap();
        // A cell sees what touches it, so objects that touch few cells are what can be taken out.
        let apart = |cell: usize, object: usize| !parts.cell_objects[cell].contains(&ObjectId(object as u32));
        for cell in 0..parts.cells.len() {
            for object in (0..parts.objects.len()).filter(|&o| apart(cell, o)) {
                seen.set(cell, object, false);
            }
        }
        let spoilt = [tables[0].clone(), Table::new(parts).unwrap()];
        let verdicts = judge(&scene, &spoilt, &options);
        assert!(verdicts.tables[0].missing.is_empty() && !verdicts.tables[1].missing.is_empty());
        for m in &verdicts.tables[1].missing {
            let line = RayScene::new(&scene).clear_line(m.origin, m.direction).unwrap();
            assert!(matches!(m.pair, Pair::Object(_, o) if line.ends.contains(&Some(o))), "{m:?}");
        }
    }
}
