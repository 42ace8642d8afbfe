//! Closed meshes on a grid of 64ths of a unit, for walls, slabs and furniture.
//!
//! Everything is built from lofts: horizontal polygons, one above the other, joined by triangles and closed at both
//! ends. Corners are integers until the last step, so nothing rounds.

use crate::stroke::Rect;
use sightlines_cells::SceneObject;

/// Mesh steps per unit.
const FINE: i32 = 64;
/// Mesh steps in a step of the layout's grid.
pub(super) const STEP: i32 = 8;
/// 64 times the cosines of 0, 22.5, 45, 67.5 and 90 degrees, rounded.
const COSINES: [i32; 5] = [64, 59, 45, 24, 0];

/// A corner: x and z are the plan's x and y, y is the height above the floor.
pub(super) type Corner = [i32; 3];

/// Triangles with corners in mesh steps, counter-clockwise as seen from outside.
#[derive(Debug, Clone, Default)]
pub(super) struct Mesh {
    corners: Vec<Corner>,
    triangles: Vec<[u32; 3]>,
    /// Whether the next quadrilateral is cut along its other diagonal.
    flip: bool,
}

impl Mesh {
    /// No triangles; `flip` chooses the diagonal of the first quadrilateral, and they alternate.
    pub(super) fn new(flip: bool) -> Self {
        Self { flip, ..Self::default() }
    }

    /// The object called `name`, with its floor lifted to `height` mesh steps.
    pub(super) fn object(self, name: String, height: i32) -> SceneObject {
        let unit = |x: i32| f64::from(x) / f64::from(FINE);
        let vertices = self.corners.iter().map(|&[x, y, z]| [unit(x), unit(y + height), unit(z)]).collect();
        SceneObject { name, vertices, triangles: self.triangles }
    }

    fn push(&mut self, corners: impl IntoIterator<Item = Corner>) -> u32 {
        let first = u32::try_from(self.corners.len()).expect("a mesh has fewer than 2^32 corners");
        self.corners.extend(corners);
        first
    }

    /// Two triangles with corners `[a, b, c, d]` in order.
    fn quad(&mut self, [a, b, c, d]: [u32; 4]) {
        self.triangles.extend(if self.flip { [[a, b, d], [b, c, d]] } else { [[a, b, c], [a, c, d]] });
        self.flip = !self.flip;
    }

    /// Joins polygons of equally many corners, lowest first. A polygon is convex and turns from x
    /// towards z.
    pub(super) fn loft(&mut self, rings: &[Vec<Corner>]) {
        let n = u32::try_from(rings[0].len()).expect("a polygon has few corners");
        debug_assert!(rings.iter().all(|r| r.len() == rings[0].len()), "polygons have equally many corners");
        let first = self.push(rings.iter().flatten().copied());
        let levels = u32::try_from(rings.len()).expect("a loft has few polygons");
        for level in 1..levels {
            let (low, high) = (first + (level - 1) * n, first + level * n);
            for i in 0..n {
                let j = (i + 1) % n;
                self.quad([low + i, high + i, high + j, low + j]);
            }
        }
        let (top, bottom) = (first + (levels - 1) * n, first);
        if n == 4 {
            self.quad([top, top + 3, top + 2, top + 1]);
            self.quad([bottom, bottom + 1, bottom + 2, bottom + 3]);
            return;
        }
        for i in 1..n - 1 {
            self.triangles.push([top, top + i + 1, top + i]);
            self.triangles.push([bottom, bottom + i, bottom + i + 1]);
        }
    }

    /// A box in mesh steps.
    pub(super) fn cuboid(&mut self, [x0, y0, z0]: Corner, [x1, y1, z1]: Corner) {
        self.loft(&[rectangle([x0, y0, z0], [x1, z1]), rectangle([x0, y1, z0], [x1, z1])]);
    }

    /// A box whose top is moved by `shift` along x and z: a slanted leg, a leaning back.
    pub(super) fn leaning(&mut self, [x0, y0, z0]: Corner, [x1, y1, z1]: Corner, [dx, dz]: [i32; 2]) {
        let top = rectangle([x0 + dx, y1, z0 + dz], [x1 + dx, z1 + dz]);
        self.loft(&[rectangle([x0, y0, z0], [x1, z1]), top]);
    }

    /// A solid of revolution about the vertical line through `[x, z]`, made of polygons of at most
    /// `sides` corners: `profile` holds radius and height, lowest first.
    pub(super) fn turned(&mut self, [x, z]: [i32; 2], sides: usize, profile: &[[i32; 2]]) {
        let thinnest = profile.iter().map(|p| p[0]).min().expect("a profile has points");
        let sides = round_sides(sides, thinnest);
        let rings: Vec<Vec<Corner>> = profile.iter().map(|&[r, y]| circle([x, y, z], r, sides)).collect();
        self.loft(&rings);
    }

    /// A wall without thickness from `a` to `b` in plan and between two heights: a pair of rectangles,
    /// one for each side.
    pub(super) fn sheet(&mut self, [ax, az]: [i32; 2], [bx, bz]: [i32; 2], [y0, y1]: [i32; 2]) {
        let first = self.push([[ax, y0, az], [bx, y0, bz], [bx, y1, bz], [ax, y1, az]]);
        self.quad([first, first + 1, first + 2, first + 3]);
        // The same triangles with the opposite orientation.
        let front = self.triangles[self.triangles.len() - 2..].to_vec();
        self.triangles.extend(front.iter().map(|&[a, b, c]| [a, c, b]));
    }

    /// The rectangle `outer` between two heights, without `holes`: they share one range of x, ascend in
    /// z, and stay apart from each other and from the border. Layout steps in plan.
    pub(super) fn plate(&mut self, outer: Rect, holes: &[Rect], [y0, y1]: [i32; 2]) {
        let mut xs = vec![outer.x0, outer.x1];
        xs.splice(1..1, holes.first().into_iter().flat_map(|h| [h.x0, h.x1]));
        let mut zs = vec![outer.y0, outer.y1];
        zs.splice(1..1, holes.iter().flat_map(|h| [h.y0, h.y1]));
        let (nx, nz) = (xs.len(), zs.len());
        let level = |y: i32| -> Vec<Corner> {
            zs.iter().flat_map(|&z| xs.iter().map(move |&x| [x * STEP, y, z * STEP])).collect()
        };
        let (low, high) = (self.push(level(y0)), self.push(level(y1)));
        // The second, fourth, ... tile in both directions is a hole; beyond the border nothing is solid.
        let solid = |i: usize, j: usize| (1..nx).contains(&i) && (1..nz).contains(&j) && (i % 2 == 1 || j % 2 == 1);
        let at = |i: usize, j: usize| u32::try_from(j * nx + i).expect("a plate has few corners");
        for j in 1..nz {
            for i in (1..nx).filter(|&i| solid(i, j)) {
                // The tile between the corners (i - 1, j - 1) and (i, j), turning from x towards z.
                let corners = [at(i - 1, j - 1), at(i, j - 1), at(i, j), at(i - 1, j)];
                let beside = [solid(i, j - 1), solid(i + 1, j), solid(i, j + 1), solid(i - 1, j)];
                self.quad(corners.map(|c| low + c));
                self.quad([corners[0], corners[3], corners[2], corners[1]].map(|c| high + c));
                for (k, _) in beside.iter().enumerate().filter(|&(_, &solid)| !solid) {
                    let (a, b) = (corners[k], corners[(k + 1) % 4]);
                    self.quad([low + a, high + a, high + b, low + b]);
                }
            }
        }
    }
}

/// A horizontal rectangle from its lower corner, turning from x towards z.
fn rectangle([x0, y, z0]: Corner, [x1, z1]: [i32; 2]) -> Vec<Corner> {
    vec![[x0, y, z0], [x1, y, z0], [x1, y, z1], [x0, y, z1]]
}

/// Number of sides that a polygon of radius `r` can have without three collinear corners.
fn round_sides(wanted: usize, r: i32) -> usize {
    wanted.min(if r < 3 {
        4
    } else if r < 10 {
        8
    } else {
        16
    })
}

/// A circle as a polygon of 4, 8 or 16 corners, turning from x towards z.
fn circle([x, y, z]: Corner, r: i32, sides: usize) -> Vec<Corner> {
    (0..sides).map(|i| direction(16 / sides * i, r)).map(|[dx, dz]| [x + dx, y, z + dz]).collect()
}

/// A vector of length `r` at `i` sixteenths of a turn from x towards z, rounded to integers.
pub(super) fn direction(i: usize, r: i32) -> [i32; 2] {
    // Symmetric, so that polygons are.
    let part = |i: usize| match i % 16 {
        i @ 0..=4 => (COSINES[i] * r + 32) / 64,
        i @ 5..=8 => -((COSINES[8 - i] * r + 32) / 64),
        i @ 9..=12 => -((COSINES[i - 8] * r + 32) / 64),
        i => (COSINES[16 - i] * r + 32) / 64,
    };
    [part(i), part(i + 12)]
}
