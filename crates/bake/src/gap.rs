//! How precise the coordinates of a plan or a scene are.

use sightlines_cells::{Plan, PlanError, Point3, Scene, SceneObject};
use sightlines_formats::SceneInfo;
use sightlines_formats::scene::SceneFormat;
use sightlines_frame::Areas;
use sightlines_geometry::Aabb;

/// How precise the coordinates of a plan or a scene are: openings narrower than this may count as closed, and things that
/// are thinner as hidden.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Gap {
    /// As precise as the format of the file is ([`Gap::of_file`]), where a frame makes walls of much that is none without it; else
    /// exactly as they are. Plans: as precise as [`Plan::precision`] tells, where that joins ends of walls with others.
    #[default]
    OfFile,
    /// As precise as single precision is, whatever file the scene comes from, where a frame makes walls of much that is none without it; for
    /// scenes that were built from numbers in single precision.
    OfSingle,
    /// This width, in units of the plan or the scene; 0 takes all coordinates exactly as they are.
    Width(f64),
}

impl Gap {
    /// The plan with its ends of walls joined to others within this gap ([`Plan::joined`]), for all that looks at plans. None if it is taken as it
    /// is: with a gap of 0, and without one that was named where there is nothing to join, or where the plan was joined before.
    ///
    /// # Errors
    /// [`PlanError::Gap`] for a width that cannot be had.
    pub fn join(self, plan: &Plan) -> Result<Option<Plan>, PlanError> {
        let (gap, is_named) = match self {
            Self::OfFile if plan.gap() > 0.0 => return Ok(None),
            Self::OfFile => (plan.precision(), false),
            Self::OfSingle => (plan.single_precision(), false),
            Self::Width(gap) => (gap, true),
        };
        let joined = plan.joined(gap)?;
        Ok(Some(joined).filter(|joined| is_named && joined.gap() != plan.gap() || !joined.joints().is_empty()))
    }

    /// The precision of a scene from a file, in scene units; 0 for what is in doubles or in decimals.
    ///
    /// glTF stores coordinates in single precision. Let M be the magnitude of coordinates and u = 2^-24, so that
    /// rounding a coordinate moves it by at most u M. Whoever turns a building in single precision has rounded the entries of
    /// the rotation (3 u M for a sum of three products with them), the products and their sums (3 u M more), and the place in the end
    /// (u M): below 7 u M along each axis of the file, and so below √3 × 7 u M < 13 u M along any other. Coordinates of one plane then
    /// differ by no more than 26 u M from each other; that is what half the gap has to hold in the worst case, but these bounds are
    /// far from what is met: errors are of either sign, and most programs turn in double precision and round once (√3 u M). Half the gap is
    /// therefore 8 u M, and the gap 16 u M = 2^-20 M: about 0.02 mm for a building of 30 m.
    ///
    /// M is twice the distance from the middle within which half of the corners lie, and never more than the largest coordinate, twice
    /// the extent of the largest object, or eight times the largest coordinate of the object in the middle by that. So neither a sky around a
    /// building, a site beside it, nor its place far from the origin or from other buildings,
    /// which nodes have in double precision, makes the gap wide. Where M is less
    /// than what was rounded, as far from the origin without nodes, fewer walls become flat, and nothing is wrongly closed: then a wider gap is
    /// tried, with the sizes of coordinates as the file stores them for M.
    pub fn of_file(scene: &Scene, file: &SceneInfo) -> f64 {
        if file.format == SceneFormat::Gltf { Self::of_single(scene) } else { 0.0 }
    }

    /// The precision of a scene whose coordinates were rounded to single precision, as [`Gap::of_file`] derives it.
    pub(crate) fn of_single(scene: &Scene) -> f64 {
        let corners: Vec<Point3> =
            scene.occluding_triangles().chain(scene.front_occluding_triangles()).flatten().collect();
        let middle = [0, 1, 2].map(|k| median(corners.iter().map(|p| p[k]).collect()));
        let far = |p: &Point3| (0..3).map(|k| (p[k] - middle[k]).abs()).fold(0.0, f64::max);
        let spread = median(corners.iter().map(far).collect());
        let largest = corners.iter().flatten().fold(0.0f64, |m, x| m.max(x.abs()));
        let extent = |b: Aabb<3>| (0..3).map(|k| b.max[k] - b.min[k]).fold(0.0, f64::max);
        let object = that_hide(scene).map(|(_, o)| extent(o.bounds())).fold(0.0, f64::max);
        let middle = 8.0 * lower_median(own_sizes(scene).filter(|size| *size > 0.0).collect());
        largest.min(2.0 * spread).min(2.0 * object).min(middle) / f64::from(1 << 20)
    }

    /// The widest gap that the rounding of single precision explains, where coordinates were not stored near the origin: 2^-20 M as for
    /// [`Gap::of_file`], with an M of the coordinates' own sizes.
    ///
    /// A coordinate is rounded by a part of its own size, so M is the largest magnitude of a coordinate of an object as it is stored, that of the
    /// object in the middle by it; of an even number the lower one. Half the gap is 8 u M, and rounding moves what was turned in double precision by √3 u M:
    /// it holds the rounding of objects whose coordinates are up to four times as large, and a site of ten kilometres does not widen the gap of a house.
    ///
    /// Never more than 1024 times the gap near the origin, 2^-10 of about the size of the building, a choice: beyond, precision leaves no walls.
    ///
    /// * `stored`: the size of each object as its file stores it; that of its coordinates for objects without one
    pub(crate) fn of_stored(scene: &Scene, stored: &[f64]) -> f64 {
        let sizes = that_hide(scene).zip(own_sizes(scene)).filter(|((_, o), _)| !o.triangles.is_empty());
        let sizes = sizes.map(|((object, _), size)| stored.get(object as usize).copied().unwrap_or(size));
        let explained = lower_median(sizes.collect()) / f64::from(1 << 20);
        explained.min(MOST_STORED * Self::of_single(scene))
    }

    /// How many times what single precision explains ([`Gap::of_file`]) a gap in scene units is, if that is more than 16 times; `None` for
    /// others. For remarks only: such a gap was stated by someone, and rays tell nothing of what is narrower. The 16 is a choice, not derived.
    /// Far from the origin that is more where walls do not stand along the axes of the file. O(n) of triangles.
    pub fn times_too_wide(scene: &Scene, gap: f64) -> Option<f64> {
        // Where most corners are in one place, single precision explains nothing.
        let has_walls = Areas::of(scene).axial_share() > 1.0 - LEAST_GAIN;
        let of_stored = if has_walls { 0.0 } else { Self::of_stored(scene, &[]) };
        let explained = Self::of_single(scene).max(Self::of_rounding(scene)).max(of_stored);
        let times = if explained > 0.0 { gap / explained } else { 0.0 };
        (times > WIDE).then_some(times)
    }

    /// The least gap, in scene units, with which a scene can be taken along any frame: 2^-45 of the largest coordinate M.
    ///
    /// A coordinate along a frame is off by at most 2^-49 √3 M ([`Frame::rounding`](sightlines_pvs::Frame::rounding)), and is then moved by at
    /// most half the gap to where others are: together less than 2^-48 M + 2^-46 M.
    pub fn of_rounding(scene: &Scene) -> f64 {
        let b = scene.bounds();
        if b.is_empty() {
            return 0.0;
        }
        b.min.iter().chain(&b.max).fold(0.0f64, |m, x| m.max(x.abs())) / (1u64 << 45) as f64
    }
}

/// From how many times the precision of a file on a gap is remarked.
const WIDE: f64 = 16.0;

/// Without a stated gap, a frame has to bring at least this share of the area across an axis that was not, and so has a wider gap.
pub(crate) const LEAST_GAIN: f64 = 0.05;
/// How many times the gap near the origin one far from it may be.
const MOST_STORED: f64 = 1024.0;

/// The objects that hide, if only from one side.
fn that_hide(scene: &Scene) -> impl Iterator<Item = (u32, &SceneObject)> {
    scene.occluders().chain(scene.fronts())
}

/// The largest magnitude of a coordinate of each object that hides.
fn own_sizes(scene: &Scene) -> impl Iterator<Item = f64> {
    that_hide(scene).map(|(_, o)| o.corners().flatten().flatten().fold(0.0f64, |m, x| m.max(x.abs())))
}

/// The value in the middle, the lower of two; 0 of none.
fn lower_median(mut values: Vec<f64>) -> f64 {
    let Some(half) = values.len().checked_sub(1).map(|last| last / 2) else { return 0.0 };
    *values.select_nth_unstable_by(half, f64::total_cmp).1
}

/// The value in the middle; 0 of none.
fn median(mut values: Vec<f64>) -> f64 {
    let half = values.len() / 2;
    if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(half, f64::total_cmp).1 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sightlines_formats::SceneFile;
    use sightlines_formats::scene::{parse_glb, write_glb};

    /// Many small triangles around a place, and one large one around that.
    fn file(place: f64, sky: f64) -> SceneFile {
        let triangle = |at: f64, size: f64| SceneObject {
            name: String::new(),
            vertices: vec![[at, 0.0, 0.0], [at + size, 0.0, 0.0], [at, size, 0.0]],
            triangles: vec![[0, 1, 2]],
        };
        let mut objects: Vec<SceneObject> = (0..32).map(|k| triangle(place + f64::from(k), 16.0)).collect();
        objects.push(triangle(place - sky, 2.0 * sky));
        let scene = Scene::new(objects).expect("a scene");
        parse_glb(&write_glb(&scene).expect("single precision"), None).expect("a scene")
    }

    fn gap(place: f64, sky: f64) -> f64 {
        let file = file(place, sky);
        Gap::of_file(&file.scene, &file.info)
    }

    #[test]
    fn only_gaps_far_wider_than_that_of_the_file_are_remarked() {
        for (place, sky) in [(0.0, 1.0), (0.0, 65536.0), (4194304.0, 1.0)] {
            let SceneFile { scene, info } = file(place, sky);
            let gap = Gap::of_file(&scene, &info);
            let times = [0.0, 1.0, 15.9, 16.5, 1e6].map(|times| Gap::times_too_wide(&scene, times * gap));
            let [none @ .., some, many] = times;
            assert_eq!(none, [None; 3]);
            let near = |times: Option<f64>, n: f64| times.is_some_and(|times| (times - n).abs() < 1e-9 * n);
            assert!(near(some, 16.5) && near(many, 1e6), "{some:?} {many:?}");
        }
        assert_eq!(Gap::times_too_wide(&Scene::new(Vec::new()).expect("a scene"), 1.0), None);
    }

    #[test]
    fn neither_a_sky_nor_the_distance_from_the_origin_makes_the_gap_wide() {
        let here = gap(0.0, 1.0);
        assert!((8.0..33.0).contains(&(here * f64::from(1 << 20))), "{here}");
        for (place, sky) in [(0.0, 65536.0), (4194304.0, 1.0), (4194304.0, 1024.0)] {
            let there = gap(place, sky);
            assert!(there <= 1.2 * here && there >= 0.8 * here, "{place} {sky}: {there} {here}");
        }
        // The impostor: what takes the largest coordinate would have closed openings of 4 units.
        assert!(4194304.0 / f64::from(1 << 20) > 1e5 * here);
    }
}
