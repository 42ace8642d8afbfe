//! Rooms inside of solid things.
//!
//! A closed piece of an object winds around each point off it a whole number of times: once around what
//! it encloses, if its triangles look outwards; less than no times if they look inwards. A cell that none
//! of its triangles is inside of is as a whole inside or outside. The number is found on a ray: it grows
//! where the ray leaves through a triangle's front, and sinks where it enters.

use crate::matter::Rooms;
use crate::mesh::{TriangleKind, kind_of};
use crate::scene_faces::Survey;
use crate::touch::{Meets, visit_cells};
use crate::tree::AxialTree;
use sightlines_cells::{Point3, Scene};
use sightlines_geometry::{Aabb, Point2, orient2d};

/// The axis along which rays are sent.
const RAY: usize = 0;

/// A closed piece of an object, of axis-parallel triangles only.
struct Shell {
    object: usize,
    bounds: Aabb<3>,
    /// Whether something lies in it.
    contains: bool,
}

/// A triangle of a shell that rays may cross.
struct Sheet {
    shell: u32,
    at: f64,
    corners: [Point2; 3],
    u: [f64; 2],
    v: [f64; 2],
}

/// How often shells wind around a point, for those that do.
type Windings = Vec<(u32, i32)>;

/// For each room whether each of its cells is inside of solid matter; see
/// [`subdivide_scene`](crate::subdivide_scene). Errs towards "no".
pub(crate) fn solid_rooms(scene: &Scene, survey: &Survey, tree: &AxialTree<3>, rooms: &Rooms) -> Vec<bool> {
    let mut shells = Shells::of(scene, survey);
    let first: Vec<u32> = rooms.cells.iter().map(|cells| cells[0]).collect();
    let around = shells.around(tree, &first);
    let maybe: Vec<bool> = around.iter().map(|w| shells.is_matter(w)).collect();
    // Most rooms end here: their first cell is outside.
    let asked: Vec<u32> =
        (0..tree.cells().len() as u32).filter(|&c| maybe[rooms.of_cell[c as usize] as usize]).collect();
    let mut windings: Vec<Windings> = vec![Vec::new(); tree.cells().len()];
    for (&cell, w) in asked.iter().zip(shells.around(tree, &asked)) {
        windings[cell as usize] = w;
    }
    shells.forget_divided(scene, tree, &mut windings);
    shells.find_containers(scene, survey, tree, &windings);
    rooms.cells.iter().map(|cells| cells.iter().all(|&c| shells.is_matter(&windings[c as usize]))).collect()
}

/// All shells of a scene.
struct Shells {
    shells: Vec<Shell>,
    /// By the lower end along `u`.
    sheets: Vec<Sheet>,
    /// For each object the shell that each of its pieces is, if it is one.
    of_piece: Vec<Vec<Option<u32>>>,
    /// For each object the piece of each triangle.
    piece_of: Vec<Vec<u32>>,
}

impl Shells {
    fn of(scene: &Scene, survey: &Survey) -> Self {
        let (mut shells, mut of_piece) = (Vec::new(), Vec::new());
        for (object, mesh) in survey.meshes.iter().enumerate() {
            let shell = |(piece, p): (u32, &crate::mesh::MeshPiece)| {
                let is_shell = p.closed && p.axial && !survey.is_small_thing(object, piece);
                is_shell.then(|| {
                    shells.push(Shell { object, bounds: p.bounds, contains: false });
                    shells.len() as u32 - 1
                })
            };
            of_piece.push((0u32..).zip(&mesh.pieces).map(shell).collect());
        }
        let piece_of = survey.meshes.iter().map(|m| m.piece_of.clone()).collect();
        let mut out = Self { shells, sheets: Vec::new(), of_piece, piece_of };
        let mut sheets = Vec::new();
        out.for_each_triangle(scene, |shell, corners| sheets.extend(sheet(shell, corners)));
        sheets.sort_by(|a, b| a.u[0].total_cmp(&b.u[0]));
        out.sheets = sheets;
        out
    }

    fn for_each_triangle(&self, scene: &Scene, mut f: impl FnMut(u32, &[Point3; 3])) {
        for ((object, pieces), shells) in scene.objects().iter().zip(&self.piece_of).zip(&self.of_piece) {
            for (&piece, corners) in pieces.iter().zip(object.corners()) {
                if let Some(shell) = shells[piece as usize] {
                    f(shell, &corners);
                }
            }
        }
    }

    /// How often shells wind around the middle of each of `cells`. Nothing for a cell without a middle
    /// that is inside of it, one unit in the last place thin.
    fn around(&self, tree: &AxialTree<3>, cells: &[u32]) -> Vec<Windings> {
        let middles = cells.iter().map(|&c| middle(&tree.cells()[c as usize].bounds));
        let mut points: Vec<(Point3, usize)> = middles.zip(0..).filter_map(|(m, i)| Some((m?, i))).collect();
        points.sort_by(|a, b| a.0[1].total_cmp(&b.0[1]));
        let mut out = vec![Vec::new(); cells.len()];
        let mut coming = self.sheets.iter().peekable();
        let mut active: Vec<&Sheet> = Vec::new();
        for (p, i) in points {
            while let Some(sheet) = coming.next_if(|s| s.u[0] <= p[1]) {
                active.push(sheet);
            }
            active.retain(|s| s.u[1] >= p[1]);
            out[i] = sums(active.iter().filter(|s| s.at > p[RAY]).map(|s| (s.shell, s.winding(p))));
        }
        out
    }

    /// Whether a point with these windings is inside of an object: of its shells, more than that hollows
    /// take away. Shells that contain other things do not count.
    fn is_matter(&self, windings: &Windings) -> bool {
        let counted = windings.iter().filter(|w| !self.shells[w.0 as usize].contains);
        sums(counted.map(|&(shell, n)| (self.shells[shell as usize].object as u32, n))).iter().any(|&(_, n)| n > 0)
    }

    /// Forgets the windings of cells that a triangle of a shell is inside of.
    fn forget_divided(&self, scene: &Scene, tree: &AxialTree<3>, windings: &mut [Windings]) {
        self.for_each_triangle(scene, |_, corners| {
            visit_cells(tree, &Aabb::around(*corners), [Meets::Inside; 3], |cell| {
                windings[cell.idx()].clear();
                true
            });
        });
    }

    /// Finds the shells that other things lie in, whole. Hollows are no things.
    fn find_containers(&mut self, scene: &Scene, survey: &Survey, tree: &AxialTree<3>, windings: &[Windings]) {
        for (object, mesh) in survey.meshes.iter().enumerate() {
            if survey.detail[object] {
                self.mark_around(None, &scene.objects()[object].bounds(), tree, windings);
            }
            for (piece, p) in mesh.pieces.iter().enumerate().filter(|(_, p)| !(p.closed && p.inverted)) {
                self.mark_around(self.of_piece[object][piece], &p.bounds, tree, windings);
            }
        }
    }

    /// Marks the shells that a thing with this box lies in: those around all cells that it meets. A copy
    /// in the same place is not in it.
    fn mark_around(&mut self, own: Option<u32>, thing: &Aabb<3>, tree: &AxialTree<3>, windings: &[Windings]) {
        let mut around: Option<Vec<u32>> = None;
        visit_cells(tree, thing, [Meets::Inside; 3], |cell| {
            let here = windings[cell.idx()].iter().filter(|w| w.1 > 0).map(|w| w.0);
            let both = match around.take() {
                None => here.collect(),
                Some(before) => here.filter(|s| before.contains(s)).collect::<Vec<u32>>(),
            };
            let go_on = !both.is_empty();
            around = Some(both);
            go_on
        });
        for shell in around.into_iter().flatten().filter(|s| Some(*s) != own) {
            let s = &mut self.shells[shell as usize];
            s.contains |= s.bounds != *thing;
        }
    }
}

fn sheet(shell: u32, corners: &[Point3; 3]) -> Option<Sheet> {
    let TriangleKind::Flat(flat) = kind_of(corners) else { return None };
    let span = |of: fn(&Point2) -> f64| {
        let [a, b, c] = flat.corners.each_ref().map(of);
        [a.min(b).min(c), a.max(b).max(c)]
    };
    (flat.axis == RAY).then(|| Sheet { shell, at: flat.at, corners: flat.corners, u: span(|p| p.x), v: span(|p| p.y) })
}

impl Sheet {
    /// How often the triangle's outline winds around a point, seen along the ray: once if the ray leaves
    /// through its front, minus once if it enters. A point on an edge is counted to the triangle on one
    /// side of it, always the same.
    fn winding(&self, p: Point3) -> i32 {
        if p[2] < self.v[0] || p[2] > self.v[1] {
            return 0;
        }
        let q = Point2::new(p[1], p[2]);
        let cross = |a: Point2, b: Point2| match (a.y <= q.y, b.y <= q.y) {
            (true, false) => i32::from(orient2d(a, b, q) > 0.0),
            (false, true) => -i32::from(orient2d(b, a, q) > 0.0),
            _ => 0,
        };
        let [a, b, c] = self.corners;
        cross(a, b) + cross(b, c) + cross(c, a)
    }
}

/// Adds up what belongs to the same number; zeros vanish.
fn sums(parts: impl Iterator<Item = (u32, i32)>) -> Windings {
    let mut parts: Windings = parts.filter(|p| p.1 != 0).collect();
    parts.sort_unstable();
    let sum = |same: &[(u32, i32)]| (same[0].0, same.iter().map(|p| p.1).sum());
    parts.chunk_by(|p, q| p.0 == q.0).map(sum).filter(|p| p.1 != 0).collect()
}

/// A point inside of a box, if there is a double for each of its coordinates.
fn middle(b: &Aabb<3>) -> Option<Point3> {
    let m = std::array::from_fn(|k| b.min[k].midpoint(b.max[k]));
    (0..3).all(|k| b.min[k] < m[k] && m[k] < b.max[k]).then_some(m)
}
