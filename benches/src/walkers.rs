//! People who walk through a scene, a map or a plan at a bounded speed, and segments between them.

use sightlines::bake::BakeInput;
use sightlines::geometry::{Aabb, Point2, Random};
use sightlines::isovist::{Touch, WallMesh};
use sightlines::pvs::{CellId, PlaceBuffer, PlaneChild, Table};
use sightlines::relevance::Body;
use sightlines_testkit::RayScene;

/// What is solid, for segments.
enum Solid {
    Scene(RayScene),
    /// The planes of the table: what is in none of its cells.
    Map,
    Plan(WallMesh),
}

/// A table and what stands in its scene.
pub struct Ground<'a> {
    table: &'a Table,
    solid: Solid,
    /// The coordinate that points up; none in a plan.
    up: Option<usize>,
    /// Which cells bodies can be in.
    open: Vec<bool>,
    /// A metre, in scene units.
    pub metre: f64,
}

/// How high eyes are above floors, and how far bodies go up from there, in metres.
const EYE: f64 = 1.6;
const ABOVE: f64 = 0.2;
/// Half the width of a body, in metres.
const HALF: f64 = 0.3;

impl<'a> Ground<'a> {
    /// # Errors
    /// A text for what has no places, and for walls that make no plan.
    pub fn new(table: &'a Table, input: BakeInput<'_>) -> Result<Self, String> {
        let up = table.up().map(|axis| axis.idx());
        let is_doom = table.cells().iter().any(|cell| cell.group.is_some());
        let (solid, up, metre) = match input {
            BakeInput::Scene(scene, _) => (Solid::Scene(RayScene::new(scene)), Some(up.unwrap_or(1)), 1.0),
            BakeInput::Map(..) => (Solid::Map, Some(2), 32.0),
            BakeInput::Plan(plan) => {
                let mesh = WallMesh::new(plan).map_err(|error| error.to_string())?;
                (Solid::Plan(mesh), None, if is_doom { 32.0 } else { 1.0 })
            }
            BakeInput::Portals(_) => return Err("a portal file has no places".to_owned()),
        };
        Ok(Self { table, solid, up, open: main_part(table), metre })
    }

    /// Whether a segment meets nothing. Exact in scenes and plans; in maps up to rounding.
    pub fn is_free(&self, a: [f64; 3], b: [f64; 3]) -> bool {
        match &self.solid {
            Solid::Scene(rays) => rays.is_clear(a, b),
            Solid::Map => self.is_air(a, b),
            Solid::Plan(mesh) => {
                let [a, b] = [a, b].map(|p| Point2::new(p[0], p[1]));
                mesh.sees(a, b, Touch::Blocks).unwrap_or(false)
            }
        }
    }

    /// Whether a segment lies in cells of a map, with room on all sides of planes.
    fn is_air(&self, a: [f64; 3], b: [f64; 3]) -> bool {
        const ROOM: f64 = 1e-3;
        let Some(planes) = self.table.planes() else {
            return false;
        };
        let mut pending = vec![(0u32, a, b)];
        while let Some((node, a, b)) = pending.pop() {
            let node = &planes.nodes()[node as usize];
            let height = |p: [f64; 3]| (0..3).map(|k| node.normal[k] * p[k]).sum::<f64>() - node.offset;
            let (ha, hb) = (height(a), height(b));
            let on_line = |h: f64| {
                let t = ((ha - h) / (ha - hb)).clamp(0.0, 1.0);
                std::array::from_fn(|k| a[k] + (b[k] - a[k]) * t)
            };
            for (side, child) in node.children.iter().enumerate() {
                let sign = if side == 0 { 1.0 } else { -1.0 };
                if sign * ha < -ROOM && sign * hb < -ROOM {
                    continue;
                }
                match *child {
                    PlaneChild::Nothing => return false,
                    PlaneChild::Cell(_) => {}
                    PlaneChild::Node(n) => {
                        let clip = |p: [f64; 3], h: f64| if sign * h < -ROOM { on_line(-sign * ROOM) } else { p };
                        pending.push((n, clip(a, ha), clip(b, hb)));
                    }
                }
            }
        }
        true
    }

    /// The cells at a point.
    pub fn cells(&self, p: [f64; 3], place: &mut PlaceBuffer) -> Vec<CellId> {
        self.table.cells_at(p, place).inside().map_or_else(Vec::new, <[CellId]>::to_vec)
    }

    /// Whether somebody may get to a place: in cells from which most others can be got to through portals. Bodies do not get into the sky of a map, nor into water that
    /// hides.
    fn is_open(&self, p: [f64; 3], place: &mut PlaceBuffer) -> bool {
        let cells = self.cells(p, place);
        !cells.is_empty() && cells.iter().all(|cell| self.open[cell.idx()]) && self.has_room(p)
    }

    /// Whether a body with eyes at a point has room: as far as the corners of its box at the height of its eyes.
    fn has_room(&self, p: [f64; 3]) -> bool {
        let b = self.body(p).seen;
        let flat = |mut q: [f64; 3]| {
            if let Some(up) = self.up {
                q[up] = p[up];
            }
            q
        };
        b.corners().into_iter().map(flat).all(|q| self.is_free(p, q))
    }

    /// How far the floor is below a point, at most `most`; rounded.
    fn floor(&self, p: [f64; 3], most: f64) -> Option<f64> {
        let Some(up) = self.up else {
            return Some(EYE * self.metre);
        };
        let at = |far: f64| {
            let mut q = p;
            q[up] -= far;
            q
        };
        if self.is_free(p, at(most)) {
            return None;
        }
        let (mut free, mut blocked) = (0.0, most);
        while blocked - free > 0.01 * self.metre {
            let middle = (free + blocked) / 2.0;
            *(if self.is_free(p, at(middle)) { &mut free } else { &mut blocked }) = middle;
        }
        Some(blocked)
    }

    /// Somebody who stands somewhere: where their eyes are.
    pub fn standing(&self, random: &mut Random) -> [f64; 3] {
        let mut place = PlaceBuffer::new();
        loop {
            let cell = &self.table.cells()[random.below(self.table.n_cells())];
            let mut p = random.point(&Aabb { min: cell.min, max: cell.max });
            if let Some(frame) = self.table.frame() {
                p = frame.to_scene(p);
            }
            let Some(far) = self.floor(p, 8.0 * self.metre) else {
                continue;
            };
            if let Some(up) = self.up {
                p[up] += EYE * self.metre - far;
            }
            if self.is_open(p, &mut place) && self.floor(p, 2.0 * self.metre).is_some() {
                return p;
            }
        }
    }

    /// Somebody with eyes at a point.
    pub fn body(&self, p: [f64; 3]) -> Body {
        let wide = |down: f64, up: f64, half: f64| {
            let around = |k: usize, sign: f64| match self.up {
                Some(axis) if axis == k => self.metre * if sign < 0.0 { -down } else { up },
                None if k == 2 => 0.0,
                _ => sign * half * self.metre,
            };
            Aabb {
                min: std::array::from_fn(|k| p[k] + around(k, -1.0)),
                max: std::array::from_fn(|k| p[k] + around(k, 1.0)),
            }
        };
        Body::new(Aabb { min: p, max: p }, wide(EYE, ABOVE, HALF))
    }

    /// A point of a body that is in the open: one that its eyes see.
    pub fn part_of(&self, p: [f64; 3], random: &mut Random) -> [f64; 3] {
        let b = self.body(p).seen;
        let mut place = PlaceBuffer::new();
        let tries = (0..4).map(|_| random.point(&b)).collect::<Vec<_>>();
        tries.into_iter().find(|&q| self.is_free(p, q) && !self.cells(q, &mut place).is_empty()).unwrap_or(p)
    }

    /// A place that somebody gets to within a distance: straight on, and then another way.
    pub fn within(&self, p: [f64; 3], far: f64, random: &mut Random) -> [f64; 3] {
        let mut place = PlaceBuffer::new();
        let (mut at, mut left) = (p, far);
        for _ in 0..4 {
            let (mut way, reach) = (random.direction(), left * random.unit().sqrt());
            way[self.up.unwrap_or(2)] *= if self.up.is_some() { 0.1 } else { 0.0 };
            let to = std::array::from_fn(|k| at[k] + way[k] * reach);
            if self.is_free(at, to) && self.is_open(to, &mut place) {
                (at, left) = (to, left - reach);
            }
        }
        at
    }
}

/// The cells of the largest part of a table that hangs together by portals; all if it has none.
fn main_part(table: &Table) -> Vec<bool> {
    if table.portals().is_empty() {
        return vec![true; table.n_cells()];
    }
    let mut part: Vec<usize> = (0..table.n_cells()).collect();
    let root = |part: &mut Vec<usize>, mut i: usize| {
        while part[i] != i {
            part[i] = part[part[i]];
            i = part[i];
        }
        i
    };
    for portal in table.portals() {
        let [a, b] = portal.cells.map(|cell| root(&mut part, cell.idx()));
        part[a.max(b)] = a.min(b);
    }
    let roots: Vec<usize> = (0..part.len()).map(|i| root(&mut part, i)).collect();
    let size = |r: usize| roots.iter().filter(|&&of| of == r).count();
    let largest = (0..roots.len()).max_by_key(|&r| if roots[r] == r { size(r) } else { 0 });
    roots.iter().map(|&r| Some(r) == largest).collect()
}

/// People on foot.
pub struct Walkers {
    /// Where their eyes are.
    pub at: Vec<[f64; 3]>,
    headings: Vec<[f64; 3]>,
    random: Random,
}

impl Walkers {
    /// So many, anywhere.
    pub fn new(ground: &Ground<'_>, n: usize, seed: u64) -> Self {
        let mut random = Random::new(seed);
        let at = (0..n).map(|_| ground.standing(&mut random)).collect();
        let headings = (0..n).map(|_| random.direction()).collect();
        Self { at, headings, random }
    }

    /// All of them go on for at most a distance, in cells and through nothing; who cannot looks for another way.
    pub fn step(&mut self, ground: &Ground<'_>, far: f64, place: &mut PlaceBuffer) {
        for (at, heading) in self.at.iter_mut().zip(&mut self.headings) {
            let random = &mut self.random;
            let mut to = *at;
            let flat = |k: usize| Some(k) != ground.up && (ground.up.is_some() || k < 2);
            let length = (0..3).filter(|&k| flat(k)).map(|k| heading[k] * heading[k]).sum::<f64>().sqrt().max(1e-9);
            // Up and down by at most 0.4 of it, so that all in all nobody goes farther than `far`.
            (0..3).filter(|&k| flat(k)).for_each(|k| to[k] += heading[k] / length * far * 0.9);
            let Some(up) = ground.up else {
                if ground.is_free(*at, to) && ground.is_open(to, place) {
                    *at = to;
                } else {
                    *heading = random.direction();
                }
                continue;
            };
            let floor = ground.floor(to, 2.4 * ground.metre);
            let can = floor.is_some_and(|far| far > 0.8 * ground.metre);
            if let (true, Some(below)) = (can, floor) {
                to[up] += (EYE * ground.metre - below).clamp(-0.4 * far, 0.4 * far);
            }
            if can && ground.is_free(*at, to) && ground.is_open(to, place) {
                *at = to;
                if random.below(200) == 0 {
                    *heading = random.direction();
                }
            } else {
                *heading = random.direction();
            }
        }
    }
}
