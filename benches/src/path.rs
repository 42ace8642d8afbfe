//! A walk through a tower: from room to room, by the doors, round the furniture.
//!
//! Found on a grid with rays over all triangles, so that it knows nothing of cells.

use sightlines::cells::{Point3, Scene};
use sightlines::scenes::{GenerateError, TowerOptions, TowerRoom, tower_rooms};
use sightlines_testkit::rays::RayScene;
use std::collections::VecDeque;

/// Between two points of the grid, in metres.
const STEP: f64 = 0.25;
/// The grid begins so far from the scene's corner, so that it lies on no wall.
const OFFSET: f64 = 0.0937;
/// Height of the eye above the floor.
const EYE: f64 = 1.61;
/// Height of a storey of [`sightlines::scenes::tower`].
const STOREY: f64 = 3.0;
/// The eye looks at where it will be after so many steps.
const LOOK: usize = 6;

/// An eye on its way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraPose {
    /// Where it is.
    pub eye: Point3,
    /// Where it looks.
    pub ahead: Point3,
}

/// `n` poses on walks through the lowest, the middle and the highest floor of a tower, evenly spread over
/// the way from room to room.
///
/// # Errors
/// If the options are wrong.
pub fn walk(scene: &Scene, options: TowerOptions, n: usize) -> Result<Vec<CameraPose>, GenerateError> {
    let (rooms, rays) = (tower_rooms(options)?, RayScene::new(scene));
    let mut floors = vec![0, options.floors / 2, options.floors - 1];
    floors.dedup();
    let ways: Vec<Vec<Point3>> = floors.iter().map(|&floor| way_on_floor(&rays, &rooms, floor)).collect();
    let share = |k: usize| n / ways.len() + usize::from(k < n % ways.len());
    Ok(ways.iter().enumerate().flat_map(|(k, way)| poses(way, share(k))).collect())
}

/// Points from room to room of a floor, a step apart.
fn way_on_floor(rays: &RayScene, rooms: &[TowerRoom], floor: u32) -> Vec<Point3> {
    let prefix = format!("floor{floor}/");
    let rooms: Vec<&TowerRoom> = rooms.iter().filter(|r| r.name.starts_with(&prefix)).collect();
    let grid = Grid::new(rays, STOREY * f64::from(floor) + EYE);
    let Some(start) = rooms.iter().find_map(|room| grid.nearest_to_middle(room, |i| grid.is_free(i))) else {
        return Vec::new();
    };
    let reachable = grid.search(start);
    let goals = rooms.iter().filter_map(|room| grid.nearest_to_middle(room, |i| reachable[i].is_some()));
    let (mut at, mut way) = (start, vec![grid.point(start)]);
    for goal in goals {
        let before = grid.search(goal);
        // Backwards from the goal, so the way runs forwards.
        while at != goal {
            let Some(next) = before[at] else { break };
            at = next;
            way.push(grid.point(at));
        }
    }
    way
}

/// Points of a floor at the height of the eye.
struct Grid<'a> {
    rays: &'a RayScene,
    origin: Point3,
    n: [usize; 2],
}

impl<'a> Grid<'a> {
    fn new(rays: &'a RayScene, height: f64) -> Self {
        let b = rays.bounds();
        let n = [0, 2].map(|k| ((b.max[k] - b.min[k] - OFFSET) / STEP) as usize + 1);
        Self { rays, origin: [b.min[0] + OFFSET, height, b.min[2] + OFFSET], n }
    }

    fn point(&self, i: usize) -> Point3 {
        let [x, y, z] = self.origin;
        [x + STEP * (i % self.n[0]) as f64, y, z + STEP * (i / self.n[0]) as f64]
    }

    /// Whether nothing is within half a step, and the point is in the open air.
    fn is_free(&self, i: usize) -> bool {
        let p = self.point(i);
        let ways = [[1., 0., 0.], [-1., 0., 0.], [0., 0., 1.], [0., 0., -1.]];
        ways.iter().all(|way| self.rays.first_hit(p, *way).is_none_or(|h| h.front_facing && h.t > STEP / 2.0))
    }

    /// Whether nothing is between two neighbours.
    fn is_clear(&self, a: usize, b: usize) -> bool {
        let (p, q) = (self.point(a), self.point(b));
        self.rays.first_hit(p, [q[0] - p[0], 0.0, q[2] - p[2]]).is_none_or(|h| h.t > 1.0) && self.is_free(b)
    }

    fn neighbours(&self, i: usize) -> impl Iterator<Item = usize> + '_ {
        let (x, z) = (i % self.n[0], i / self.n[0]);
        let near = [(x + 1, z), (x.wrapping_sub(1), z), (x, z + 1), (x, z.wrapping_sub(1))];
        near.into_iter().filter(|&(x, z)| x < self.n[0] && z < self.n[1]).map(|(x, z)| z * self.n[0] + x)
    }

    /// For each point that is joined with `goal` the next point on a shortest way to it; for `goal` itself.
    fn search(&self, goal: usize) -> Vec<Option<usize>> {
        let mut next = vec![None; self.n[0] * self.n[1]];
        next[goal] = Some(goal);
        let mut queue = VecDeque::from([goal]);
        while let Some(i) = queue.pop_front() {
            for j in self.neighbours(i) {
                if next[j].is_none() && self.is_clear(i, j) {
                    next[j] = Some(i);
                    queue.push_back(j);
                }
            }
        }
        next
    }

    /// The point of a room that fulfils `holds` and is nearest to the room's middle.
    fn nearest_to_middle(&self, room: &TowerRoom, holds: impl Fn(usize) -> bool) -> Option<usize> {
        let b = &room.bounds;
        let distance = |i: usize| {
            let p = self.point(i);
            [0, 2].map(|k| (p[k] - b.min[k].midpoint(b.max[k])).powi(2)).iter().sum::<f64>()
        };
        let inside = |i: &usize| [0, 2].iter().all(|&k| (b.min[k]..b.max[k]).contains(&self.point(*i)[k]));
        let found = (0..self.n[0] * self.n[1]).filter(inside).filter(|&i| holds(i));
        found.min_by(|&a, &b| distance(a).total_cmp(&distance(b)))
    }
}

/// `n` poses on a way, evenly spread.
fn poses(way: &[Point3], n: usize) -> Vec<CameraPose> {
    let Some(last) = way.len().checked_sub(1) else { return Vec::new() };
    let at = |s: f64| {
        let i = (s as usize).min(last);
        let (p, q) = (way[i], way[(i + 1).min(last)]);
        [0, 1, 2].map(|k| p[k] + (q[k] - p[k]) * (s - i as f64))
    };
    let pose = |k: usize| {
        let s = (k as f64 + 0.37) / n as f64 * last as f64;
        let eye = at(s);
        // Looks turn slowly; the tilt keeps walls from being parallel to the picture.
        let to = [0.5, 1.0, 1.5].map(|far| at((s + far * LOOK as f64).min(last as f64)));
        let tilt = 0.011 + 0.05 * ((k % 17) as f64 - 8.0) / 8.0;
        let mean = |axis: usize| to.iter().map(|p| p[axis] - eye[axis]).sum::<f64>();
        let [x, z] = [mean(0) + 0.0173, mean(2) + 0.0291];
        CameraPose { eye, ahead: [x, tilt * x.hypot(z), z] }
    };
    (0..n).map(pose).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use sightlines::scenes::tower;

    #[test]
    fn walks_lead_through_rooms_and_no_walls() {
        let options = TowerOptions { floors: 2, rooms_x: 3, rooms_y: 2, furniture: 1, ..TowerOptions::default() };
        let scene = tower(options).unwrap();
        let walk = walk(&scene, options, 240).unwrap();
        assert_eq!(walk.len(), 240);
        let rays = RayScene::new(&scene);
        for pair in walk.windows(2).filter(|p| p[0].eye[1] == p[1].eye[1]) {
            let way = [0, 1, 2].map(|k| pair[1].eye[k] - pair[0].eye[k]);
            // Steps are short, so only a corner could lie between.
            assert!(way[0].hypot(way[2]) < 2.0, "{pair:?}");
            assert!(rays.first_hit(pair[0].eye, pair[0].ahead).is_none_or(|h| h.front_facing), "{pair:?}");
        }
        let rooms = tower_rooms(options).unwrap();
        let visited = rooms.iter().filter(|r| walk.iter().any(|s| r.bounds.contains(s.eye))).count();
        assert!(visited * 2 >= rooms.len(), "{visited} of {} rooms", rooms.len());
        let outside = walk.iter().filter(|s| !rooms.iter().any(|r| r.bounds.contains(s.eye))).count();
        assert!(outside > 20, "{outside} poses in corridors and doors");
    }
}
