//! Rooms inside solid things.
//!
//! A closed piece of an object winds an integer number of times around each point off it: once around what it encloses
//! if its triangles face outwards, a negative number of times if they face inwards. A cell that contains no part of its
//! triangles is wholly inside or wholly outside. The number is found along a ray: it grows where the ray leaves through
//! a triangle's front and falls where it enters.

use crate::mesh::FlatTriangle;
use crate::rooms::Rooms;
use crate::scene_faces::Survey;
use crate::touch::{Meets, visit_cells};
use crate::tree::AxialTree;
use sightlines_cells::{Point3, Scene};
use sightlines_geometry::{Aabb, BoxTree, Point2, orient2d};

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

/// For each room, whether each of its cells is inside solid matter; see
/// [`subdivide_scene`](crate::subdivide_scene). Errs towards "no".
pub(crate) fn solid_rooms(scene: &Scene, survey: &Survey, tree: &AxialTree<3>, rooms: &Rooms) -> Vec<bool> {
    let mut shells = Shells::of(survey);
    let first: Vec<u32> = rooms.cells.iter().map(|cells| cells[0]).collect();
    let around = shells.around(tree, &first);
    let maybe: Vec<bool> = around.iter().map(|w| shells.is_matter(w)).collect();
    // Most rooms end here: their first cell is outside.
    let maybe_solid: Vec<u32> =
        (0..tree.cells().len() as u32).filter(|&c| maybe[rooms.of_cell[c as usize] as usize]).collect();
    let mut windings: Vec<Windings> = vec![Vec::new(); tree.cells().len()];
    for (&cell, w) in maybe_solid.iter().zip(shells.around(tree, &maybe_solid)) {
        windings[cell as usize] = w;
    }
    shells.forget_divided(scene, survey, tree, &mut windings);
    shells.find_containers(survey, tree, &windings);
    rooms.cells.iter().map(|cells| cells.iter().all(|&c| shells.is_matter(&windings[c as usize]))).collect()
}

/// All shells of a scene.
struct Shells {
    shells: Vec<Shell>,
    /// Shell by shell.
    sheets: Vec<Sheet>,
    /// For each shell where its sheets begin; and where the last ones end.
    first_sheet: Vec<u32>,
    /// Of the boxes around the shells.
    tree: BoxTree<3>,
    /// For each object the shell that each of its pieces is, if it is one.
    of_piece: Vec<Vec<Option<u32>>>,
}

impl Shells {
    fn of(survey: &Survey) -> Self {
        let (mut shells, mut of_piece): (Vec<Shell>, Vec<Vec<Option<u32>>>) = (Vec::new(), Vec::new());
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
        let mut sheets = Vec::new();
        for ((shape, mesh), shells) in survey.shapes.iter().zip(&survey.meshes).zip(&of_piece) {
            for (triangle, flat) in shape.flat.iter().filter(|(_, flat)| flat.axis == RAY) {
                // Objects that are detail have no pieces.
                let piece = mesh.piece_of.get(*triangle as usize);
                sheets.extend(piece.and_then(|&piece| shells[piece as usize]).map(|shell| Sheet::of(shell, flat)));
            }
        }
        sheets.sort_by_key(|sheet| sheet.shell);
        let first = |shell: usize| sheets.partition_point(|sheet| (sheet.shell as usize) < shell) as u32;
        let first_sheet = (0..=shells.len()).map(first).collect();
        let boxes: Vec<Aabb<3>> = shells.iter().map(|shell| shell.bounds).collect();
        Self { shells, sheets, first_sheet, tree: BoxTree::build(&boxes, 2), of_piece }
    }

    fn for_each_triangle(&self, scene: &Scene, survey: &Survey, mut f: impl FnMut(&[Point3; 3])) {
        for ((object, mesh), shells) in scene.objects().iter().zip(&survey.meshes).zip(&self.of_piece) {
            for (&piece, corners) in mesh.piece_of.iter().zip(object.corners()) {
                if shells[piece as usize].is_some() {
                    f(&corners);
                }
            }
        }
    }

    /// How often shells wind around the middle of each of `cells`. Nothing for a cell so thin, one unit in the last
    /// place, that no double is strictly inside.
    fn around(&self, tree: &AxialTree<3>, cells: &[u32]) -> Vec<Windings> {
        cells
            .iter()
            .map(|&c| middle(&tree.cells()[c as usize].bounds).map_or_else(Vec::new, |p| self.around_point(p)))
            .collect()
    }

    /// A shell winds around no point outside of its box, as it is closed.
    fn around_point(&self, p: Point3) -> Windings {
        let mut around = Vec::new();
        self.tree.visit(
            |b| b.contains(p),
            |shell| {
                let [first, end] = [shell, shell + 1].map(|i| self.first_sheet[i as usize] as usize);
                if self.shells[shell as usize].bounds.contains(p) {
                    let sheets = self.sheets[first..end].iter().filter(|s| s.at > p[RAY]);
                    around.push((shell, sheets.map(|s| s.winding(p)).sum()));
                }
            },
        );
        sums(around.into_iter())
    }

    /// Whether a point with these windings is inside an object: its shells add more than its hollows subtract. Shells
    /// that contain other things do not count.
    fn is_matter(&self, windings: &Windings) -> bool {
        let counted = windings.iter().filter(|w| !self.shells[w.0 as usize].contains);
        sums(counted.map(|&(shell, n)| (self.shells[shell as usize].object as u32, n))).iter().any(|&(_, n)| n > 0)
    }

    /// Forgets the windings of cells that a triangle of a shell is inside of.
    fn forget_divided(&self, scene: &Scene, survey: &Survey, tree: &AxialTree<3>, windings: &mut [Windings]) {
        self.for_each_triangle(scene, survey, |corners| {
            visit_cells(tree, &Aabb::around(*corners), [Meets::Inside; 3], |cell| {
                windings[cell.idx()].clear();
                true
            });
        });
    }

    /// Marks the shells that contain other things as a whole. Hollows do not count as things.
    fn find_containers(&mut self, survey: &Survey, tree: &AxialTree<3>, windings: &[Windings]) {
        for (object, mesh) in survey.meshes.iter().enumerate() {
            if survey.detail[object] {
                self.mark_around(None, &survey.shapes[object].bounds, tree, windings);
            }
            for (piece, p) in mesh.pieces.iter().enumerate().filter(|(_, p)| !(p.closed && p.inverted)) {
                self.mark_around(self.of_piece[object][piece], &p.bounds, tree, windings);
            }
        }
    }

    /// Marks the shells that contain a thing with this box: those around all cells that it meets. A copy of the thing
    /// in the same place does not contain it.
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

impl Sheet {
    fn of(shell: u32, flat: &FlatTriangle) -> Self {
        let span = |of: fn(&Point2) -> f64| {
            let [a, b, c] = flat.corners.each_ref().map(of);
            [a.min(b).min(c), a.max(b).max(c)]
        };
        Self { shell, at: flat.at, corners: flat.corners, u: span(|p| p.x), v: span(|p| p.y) }
    }

    /// How often the triangle's outline winds around a point, seen along the ray: once if the ray leaves through its
    /// front, minus once if it enters. A point on an edge always belongs to the triangle on the same side of that edge.
    fn winding(&self, p: Point3) -> i32 {
        if p[1] < self.u[0] || p[1] > self.u[1] || p[2] < self.v[0] || p[2] > self.v[1] {
            return 0;
        }
        winds(self.corners, Point2::new(p[1], p[2]))
    }
}

/// How often the outline of a flat triangle winds around a point, counter-clockwise. A point on an edge always belongs to the
/// triangle on the same side of that edge. Exact.
pub(crate) fn winds([a, b, c]: [Point2; 3], q: Point2) -> i32 {
    let cross = |a: Point2, b: Point2| match (a.y <= q.y, b.y <= q.y) {
        (true, false) => i32::from(orient2d(a, b, q) > 0.0),
        (false, true) => -i32::from(orient2d(b, a, q) > 0.0),
        _ => 0,
    };
    cross(a, b) + cross(b, c) + cross(c, a)
}

/// Adds up the values of each key; keys with the sum zero vanish.
pub(crate) fn sums(parts: impl Iterator<Item = (u32, i32)>) -> Windings {
    let mut parts: Windings = parts.filter(|p| p.1 != 0).collect();
    parts.sort_unstable();
    let sum = |same: &[(u32, i32)]| (same[0].0, same.iter().map(|p| p.1).sum());
    parts.chunk_by(|p, q| p.0 == q.0).map(sum).filter(|p| p.1 != 0).collect()
}

/// A point inside of a box, if there is a double for each of its coordinates.
pub(crate) fn middle(b: &Aabb<3>) -> Option<Point3> {
    let m = std::array::from_fn(|k| b.min[k].midpoint(b.max[k]));
    (0..3).all(|k| b.min[k] < m[k] && m[k] < b.max[k]).then_some(m)
}
