//! The triangles that hide: which of them are floors, and whether somebody can stand at a point.

use super::grid::Grid;
use sightlines_cells::Scene;
use sightlines_geometry::vector::{dot, normal};
use sightlines_geometry::{Aabb, Point3, Random, ray_triangle};
use sightlines_kdtree::Matter;
use sightlines_multifocal::RaySampler;
use std::sync::OnceLock;

/// The square of the cosine of the steepest slope on which somebody stands: 50 degrees.
const STEEPEST: f64 = 0.413;

/// Rays that find out whether a scene shows mostly backs.
const N_RAYS: u32 = 1024;

/// Rays from somebody who may be inside of something.
const RAYS_OF_A_VIEWER: usize = 64;

/// So many of them have to hit backs, and so many times as many as fronts, before they show that it is the inside of something that is seen from both
/// sides.
const ENOUGH: usize = 48;
const FEW: usize = 16;

/// Whether somebody can stand at a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Standing {
    Free,
    NoRoom,
    Behind,
}

/// Numbers of rays by what they hit first.
#[derive(Debug, Clone, Copy, Default)]
struct Seen {
    fronts: usize,
    backs: usize,
    /// Of rays upwards: all, and those to backs that nobody is meant to see.
    above: usize,
    forbidden_above: usize,
}

/// The triangles that hide.
pub(super) struct Surfaces<'a> {
    scene: &'a Scene,
    pub(super) up: usize,
    rays: RaySampler,
    /// For each triangle whether nobody sees its back.
    single_sided: Vec<bool>,
    /// Triangles on which somebody may stand.
    pub(super) floors: Vec<u32>,
    /// What is solid; found when it is first asked, which takes a while.
    matter: OnceLock<Matter>,
}

impl<'a> Surfaces<'a> {
    pub(super) fn of(scene: &'a Scene, up: usize, region: &Aabb<3>) -> Self {
        let (mut triangles, mut single_sided) = (Vec::new(), Vec::new());
        for (id, object) in scene.occluders().chain(scene.fronts()) {
            triangles.extend(object.corners());
            single_sided.resize(triangles.len(), scene.is_single_sided(id) || scene.hides_from_front(id));
        }
        let rays = RaySampler::of(triangles);
        let mut surfaces = Self { scene, up, rays, single_sided, floors: Vec::new(), matter: OnceLock::new() };
        if surfaces.shows_backs(region) {
            // Their sides say nothing.
            surfaces.single_sided.fill(false);
        }
        surfaces.floors = (0..surfaces.triangles().len() as u32).filter(|&i| surfaces.is_floor(i)).collect();
        surfaces
    }

    pub(super) fn triangles(&self) -> &[[Point3; 3]] {
        self.rays.triangles()
    }

    /// Whether a triangle's front faces upwards.
    pub(super) fn faces_up(&self, triangle: u32) -> bool {
        normal(self.triangles()[triangle as usize])[self.up] > 0.0
    }

    /// Whether a triangle is not steep, whichever way it faces.
    pub(super) fn is_level(&self, triangle: u32) -> bool {
        let n = normal(self.triangles()[triangle as usize]);
        n[self.up] * n[self.up] >= STEEPEST * dot(n, n) && n[self.up] != 0.0
    }

    fn is_floor(&self, triangle: u32) -> bool {
        self.is_level(triangle) && (!self.single_sided[triangle as usize] || self.faces_up(triangle))
    }

    /// Whether rays from anywhere show mostly the backs of a scene.
    fn shows_backs(&self, region: &Aabb<3>) -> bool {
        if !self.single_sided.contains(&true) {
            return false;
        }
        let all = Aabb::around(self.triangles().iter().flatten().copied());
        let mut b = *region;
        (b.min[self.up], b.max[self.up]) = (b.min[self.up].max(all.min[self.up]), b.max[self.up].min(all.max[self.up]));
        if b.is_empty() {
            return false;
        }
        let mut random = Random::new(0);
        let hits: Vec<_> = (0..N_RAYS).filter_map(|_| self.hit(random.point(&b), random.direction())).collect();
        4 * hits.iter().filter(|(_, is_back)| !is_back).count() < hits.len()
    }

    /// What a ray hits first, and whether it shows its back.
    fn hit(&self, origin: Point3, way: Point3) -> Option<(u32, bool)> {
        let i = self.rays.first_triangle(origin, way)?;
        Some((i, dot(normal(self.triangles()[i as usize]), way) >= 0.0))
    }

    /// What is first above a point, and how far.
    pub(super) fn above(&self, p: Point3) -> Option<(u32, f64)> {
        let mut way = [0.0; 3];
        way[self.up] = 1.0;
        let hit = self.rays.first_triangle(p, way)?;
        Some((hit, ray_triangle(&self.triangles()[hit as usize], p, way)[2]))
    }

    /// Whether somebody can stand at a point of a floor. Nobody stands where they see hardly anything but backs, as inside of what is solid, or mostly
    /// backs of single-sided faces above them, as below the ground.
    ///
    /// * `step`: what lies on the floor to that height is a part of it
    /// * `room`: how far above the floor nothing else may be
    pub(super) fn standing(&self, p: Point3, step: f64, room: f64) -> Standing {
        let mut eye = p;
        eye[self.up] += step;
        let Some((above, distance)) = self.above(eye) else { return Standing::Free };
        if distance < room - step {
            return Standing::NoRoom;
        }
        // Who is inside of something sees its back above.
        if !self.faces_up(above) {
            return Standing::Free;
        }
        eye[self.up] += 0.5 * distance.min(room);
        let seen = self.seen(eye);
        let only_backs = FEW * seen.fronts <= seen.backs && seen.backs >= ENOUGH;
        if only_backs || 2 * seen.forbidden_above > seen.above {
            return Standing::Behind;
        }
        // A solid thing that stands on ground: rays downwards end at its lower side or at the ground, and others at its backs or at a
        // neighbour's front in the same place.
        let near = Aabb { min: eye.map(|x| x - step / 64.0), max: eye.map(|x| x + step / 64.0) };
        let may_be_solid = !self.single_sided[above as usize];
        let is_solid = may_be_solid && self.matter.get_or_init(|| Matter::of(self.scene)).holds(&near);
        if is_solid { Standing::Behind } else { Standing::Free }
    }

    /// What somebody sees, by rays in all directions.
    fn seen(&self, eye: Point3) -> Seen {
        let mut random = Random::new(eye.iter().fold(0, |seed: u64, x| seed.rotate_left(11) ^ x.to_bits()));
        let mut seen = Seen::default();
        for way in [0; RAYS_OF_A_VIEWER].map(|_| random.direction()) {
            let is_above = way[self.up] > 0.0;
            seen.above += usize::from(is_above);
            let Some((i, is_back)) = self.hit(eye, way) else { continue };
            *if is_back { &mut seen.backs } else { &mut seen.fronts } += 1;
            seen.forbidden_above += usize::from(is_above && is_back && self.single_sided[i as usize]);
        }
        seen
    }

    /// At most so many parts of floors are in columns.
    pub(super) fn n_pieces(&self, grid: &Grid) -> usize {
        let floors = self.floors.iter().map(|&i| Aabb::around(self.triangles()[i as usize]));
        floors
            .map(|b| [0, 1].map(|k| grid.meeting(k, b.min[grid.axes[k]], b.max[grid.axes[k]]).len()))
            .fold(0, |sum: usize, [m, n]| sum.saturating_add(m * n))
    }
}
