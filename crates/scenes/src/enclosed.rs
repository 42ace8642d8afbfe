//! Things with insides that nobody sees from outside, with the truth by construction: housings, cupboards, voids in voids.

use crate::error::{GenerateError, check_range};
use crate::rng::Rng;
use sightlines_cells::{Scene, SceneObject};
use std::collections::BTreeMap;

/// Whole numbers to a scene unit.
const UNIT: f64 = 64.0;

/// A scene, and what of it nobody sees who is outside of the box around it.
#[derive(Debug, Clone, PartialEq)]
pub struct Enclosed {
    /// The scene. Every object is closed and faces outwards.
    pub scene: Scene,
    /// The objects that are hidden from everywhere outside, ascending. All others are seen from somewhere outside.
    pub hidden: Vec<u32>,
}

/// Options for [`gearbox`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GearboxOptions {
    /// Seed of the sizes of gears and bolts.
    pub seed: u64,
    /// Gears, side by side in one housing, 1 to 20 000. There is a bolt and a nut for each.
    pub gears: u32,
}

impl Default for GearboxOptions {
    fn default() -> Self {
        Self { seed: 1, gears: 12 }
    }
}

/// A closed housing with gears on a shaft, and bolts through its lid: the heads are outside, the nuts inside. The shaft comes out at one end.
///
/// # Errors
/// [`GenerateError::OutOfRange`] for a number of gears that is not from 1 to 20 000.
pub fn gearbox(options: GearboxOptions) -> Result<Enclosed, GenerateError> {
    let n = check_range("gears", options.gears, 1, 20_000)?.cast_signed();
    let mut rng = Rng::new(options.seed, 11);
    let mut of = Builder::default();
    let (wall, pitch, width) = (16, 64, 512);
    let length = pitch * n + 2 * wall;
    let shell = |at: i32, from: i32, to: i32| at >= from + wall && at < to - wall;
    of.seen(
        "Housing",
        [&[0, wall, length - wall, length], &[0, wall, width - wall, width], &[0, wall, width - wall, width]],
        |[x, y, z]| !(shell(x, 0, length) && shell(y, 0, width) && shell(z, 0, width)),
    );
    let middle = width / 2;
    of.seen("Shaft", [&[-64, length - 2 * wall], &[middle - 8, middle + 8], &[middle - 8, middle + 8]], |_| true);
    for k in 0..n {
        let start = wall + k * pitch;
        // Teeth and gaps between them around a wheel; the hole has room for the shaft.
        let (tooth, half) = (8 * rng.between(1, 3), 8 * rng.between(12, 16));
        let ring = |from: i32, to: i32| [middle - to, middle - from, middle + from, middle + to];
        let outer = ring(half, half + tooth);
        let inner = ring(12, half / 2);
        let cuts = [outer[0], outer[1], inner[0], inner[1], inner[2], inner[3], outer[2], outer[3]];
        let thick = rng.between(16, 40);
        of.hidden(&format!("Gear {k}"), [&[start + 4, start + 4 + thick], &cuts, &cuts], |[_, y, z]| {
            let away = |at: i32| (at - middle).abs().max((at + 1 - middle).abs());
            let (y, z) = (away(y), away(z));
            let is_tooth = (y > half) != (z > half) && y.min(z) <= half / 2;
            y.max(z) > 12 && (y.max(z) <= half || is_tooth)
        });
        let (x, reach) = (start + 32, 4 * rng.between(2, 4));
        let (low, high) = ([x - reach, x + reach], [wall + 8, wall + 8 + 2 * reach]);
        of.seen(&format!("Bolt {k}"), [&low, &high, &[width, width + reach]], |_| true);
        of.hidden(&format!("Nut {k}"), [&low, &high, &[width - wall - 2 * reach, width - wall - 4]], |_| true);
    }
    Ok(of.finish())
}

/// A cupboard of boards that touch each other, with a shelf that touches all sides, a cup above it and a plate below. Through the keyhole, if there is one,
/// somebody sees the cup, and if it is wide enough for steep looks, the shelf.
///
/// * `keyhole`: its width in 64ths of a unit; 0 for none. At most 64
///
/// # Errors
/// [`GenerateError::OutOfRange`] for a wider keyhole.
pub fn cupboard(keyhole: u32) -> Result<Enclosed, GenerateError> {
    let hole = check_range("keyhole", keyhole, 0, 64)?.cast_signed();
    let mut of = Builder::default();
    let all = |_: [i32; 3]| true;
    let (board, w, h, d) = (8, 512, 1024, 320);
    of.seen("Left", [&[0, board], &[0, h], &[0, d]], all);
    of.seen("Right", [&[w - board, w], &[0, h], &[0, d]], all);
    of.seen("Bottom", [&[board, w - board], &[0, board], &[0, d]], all);
    of.seen("Top", [&[board, w - board], &[h - board, h], &[0, d]], all);
    of.seen("Back", [&[board, w - board], &[board, h - board], &[0, board]], all);
    let (x, y) = (w / 2, 3 * h / 4);
    let across = |at: i32| {
        let mut cuts = vec![at - 32, at + hole - 32];
        cuts.dedup();
        cuts
    };
    let door = |from: i32, at: i32, to: i32| [vec![from], across(at), vec![to]].concat();
    let is_hole = |x: i32, at: i32| x >= at - 32 && x < at + hole - 32;
    of.seen("Door", [&door(board, x, w - board), &door(board, y, h - board), &[d - board, d]], |[p, q, _]| {
        !(is_hole(p, x) && is_hole(q, y))
    });
    let middle = h / 2;
    let inside = [board, w - board];
    let (low, depth) = (y - 32 - middle - board, d - 2 * board);
    of.seen("Shelf", [&inside, &[middle, middle + board], &[board, d - board]], all);
    of.seen("Cup", [&[x - 64, x + 64], &[middle + 64, y + 64], &[96, 160]], all);
    // The steepest look passes the door from its upper outer edge to its lower inner one.
    if hole * depth <= board * low {
        of.hide("Shelf");
    }
    if hole == 0 {
        of.hide("Cup");
    }
    of.hidden("Plate", [&[x - 128, x + 128], &[board + 16, board + 32], &[64, 256]], all);
    Ok(of.finish())
}

/// A ball of boxes in a void, in a block, in a void, in a block; and another ball in the outer void. A straight pipe may lead into the inner void.
///
/// * `pipe`: from where
pub fn nested_voids(pipe: Pipe) -> Enclosed {
    let mut of = Builder::default();
    let ranges = [0, 64, 192, 256, 320, 384, 512, 576];
    let bore = [280, 296];
    let within = |p: [i32; 3], from: i32, to: i32| p.iter().all(|&x| x >= from && x < to);
    let is_bore = move |p: [i32; 3]| p[1] >= bore[0] && p[1] < bore[1] && p[2] >= bore[0] && p[2] < bore[1];
    let mut across = ranges.to_vec();
    across.extend(bore);
    across.sort_unstable();
    let is_through = pipe == Pipe::FromOutside;
    // The pipe crosses the outer void as a tube around its bore.
    of.seen("Block", [&ranges, &across, &across], |p| {
        let is_tube = is_through && p[0] >= 64 && p[0] < 192 && within([256, p[1], p[2]], 256, 320);
        let is_shell = !within(p, 64, 512) || is_tube;
        is_shell && !(is_through && p[0] < 288 && is_bore(p))
    });
    of.seen("Core", [&ranges, &across, &across], |p| {
        within(p, 192, 384) && !within(p, 256, 320) && !(pipe != Pipe::None && p[0] < 256 && is_bore(p))
    });
    let ball = [272, 304];
    of.seen("Inner ball", [&ball, &ball, &ball], |_| true);
    // A pipe from outside shows both.
    if !is_through {
        of.hide("Core");
        of.hide("Inner ball");
    }
    of.hidden("Outer ball", [&[420, 460], &[420, 460], &[420, 460]], |_| true);
    of.finish()
}

/// From where a pipe leads into the inner void of [`nested_voids`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Pipe {
    /// There is none.
    None,
    /// From the outer void, which is closed.
    FromOuterVoid,
    /// From outside, through the outer void.
    FromOutside,
}

/// Objects as they come.
#[derive(Debug, Default)]
struct Builder {
    objects: Vec<SceneObject>,
    hidden: Vec<u32>,
}

impl Builder {
    /// Adds a solid that is seen.
    fn seen(&mut self, name: &str, cuts: [&[i32]; 3], is_solid: impl Fn([i32; 3]) -> bool) {
        self.objects.push(solid(name, cuts, is_solid));
    }

    /// Adds one that is hidden.
    fn hidden(&mut self, name: &str, cuts: [&[i32]; 3], is_solid: impl Fn([i32; 3]) -> bool) {
        self.hidden.push(self.objects.len() as u32);
        self.seen(name, cuts, is_solid);
    }

    /// Says that an object is hidden.
    fn hide(&mut self, name: &str) {
        self.hidden.extend((0..).zip(&self.objects).filter(|(_, of)| of.name == name).map(|(k, _)| k));
        self.hidden.sort_unstable();
    }

    fn finish(self) -> Enclosed {
        let scene = Scene::new(self.objects).expect("whole numbers are coordinates");
        Enclosed { scene, hidden: self.hidden }
    }
}

/// The surface of some boxes of a grid, facing outwards.
///
/// * `cuts`: where the planes of the grid are, ascending
/// * `is_solid`: of the lower corner of a box
fn solid(name: &str, cuts: [&[i32]; 3], is_solid: impl Fn([i32; 3]) -> bool) -> SceneObject {
    let n = cuts.map(|cuts| cuts.len().saturating_sub(1));
    let has = |p: [usize; 3]| (0..3).all(|k| p[k] < n[k]) && is_solid([0, 1, 2].map(|k| cuts[k][p[k]]));
    let mut places: BTreeMap<[usize; 3], u32> = BTreeMap::new();
    let mut object = SceneObject { name: name.to_owned(), vertices: Vec::new(), triangles: Vec::new() };
    let all = (0..n[0]).flat_map(|x| (0..n[1]).flat_map(move |y| (0..n[2]).map(move |z| [x, y, z])));
    for p in all.filter(|&p| has(p)) {
        for (axis, is_high) in (0..3).flat_map(|axis| [(axis, false), (axis, true)]) {
            let mut beside = p;
            beside[axis] = if is_high { p[axis] + 1 } else { p[axis].wrapping_sub(1) };
            if has(beside) {
                continue;
            }
            let corner = |u: usize, v: usize| {
                let mut q = p;
                q[axis] += usize::from(is_high);
                q[(axis + 1) % 3] += u;
                q[(axis + 2) % 3] += v;
                q
            };
            let ring = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
            let [a, b, c, d] = ring.map(|q| {
                *places.entry(q).or_insert_with(|| {
                    object.vertices.push([0, 1, 2].map(|k| f64::from(cuts[k][q[k]]) / UNIT));
                    object.vertices.len() as u32 - 1
                })
            });
            let sides = if is_high { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] };
            object.triangles.extend(sides);
        }
    }
    object
}

#[cfg(test)]
mod tests {
    use super::*;
    use sightlines_geometry::Point3;

    /// Six times the volume.
    fn volume(object: &SceneObject) -> f64 {
        let det = |[a, b, c]: [Point3; 3]| {
            a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])
        };
        object.corners().map(det).sum()
    }

    /// Every edge is passed as often in one direction as in the other, and matter is behind the faces.
    #[test]
    fn all_objects_are_closed_and_face_outwards() {
        let pipes = [Pipe::None, Pipe::FromOuterVoid, Pipe::FromOutside].map(nested_voids);
        let more = [gearbox(GearboxOptions::default()), cupboard(0), cupboard(4)].map(Result::unwrap);
        let mut n = 0;
        for enclosed in pipes.iter().chain(&more) {
            for object in enclosed.scene.objects() {
                let mut edges: BTreeMap<[u32; 2], i32> = BTreeMap::new();
                for [a, b, c] in &object.triangles {
                    for [p, q] in [[a, b], [b, c], [c, a]] {
                        *edges.entry([*p.min(q), *p.max(q)]).or_default() += if p < q { 1 } else { -1 };
                    }
                }
                assert!(edges.values().all(|&sum| sum == 0) && volume(object) > 0.0, "{}", object.name);
                n += 1;
            }
            assert!(!enclosed.hidden.is_empty() && enclosed.hidden.is_sorted());
        }
        assert!(n > 60, "{n}");
    }

    #[test]
    fn sizes_scale_and_are_checked() {
        let of = |gears| gearbox(GearboxOptions { gears, ..GearboxOptions::default() });
        assert_eq!(of(40).unwrap().scene.objects().len(), 2 + 3 * 40);
        assert_eq!(of(40).unwrap(), of(40).unwrap());
        assert_eq!(of(0).unwrap_err().to_string(), "gears is 0, but must be from 1 to 20000");
        assert!(cupboard(65).is_err());
        // The hole is where the door has none.
        let door = |hole| volume(&cupboard(hole).unwrap().scene.objects()[5]);
        assert!(door(4) < door(0));
    }
}
