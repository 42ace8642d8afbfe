//! Numbers that are no places: an answer that is too large, or an error, and never a panic.

use crate::eye_to_cell::ask::{Asker, not_nested};
use crate::eye_to_cell::plan_families::bake;
use proptest::prelude::*;
use sightlines::bake::Subdivide;
use sightlines::eye_to_cell::{
    CellSource, Doors, Method, MirrorPiece, PortalEdge, Scratch, StabStep, View, ViewError, VisibleSet, VisibleSubgraph,
};
use sightlines::geometry::Aabb;
use sightlines::pvs::{CellId, Frame, MirrorId, ObjectId, PortalId};

/// What hand-made sources and viewers are made of.
const NUMBERS: [f64; 14] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    3.0,
    1e-300,
    1e300,
    -1e300,
    f64::MAX,
    f64::MIN_POSITIVE,
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
];

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![4 => -4.0..4.0f64, 3 => prop::sample::select(&NUMBERS[..])]
}

fn point() -> impl Strategy<Value = [f64; 3]> {
    prop::array::uniform3(number())
}

/// A piece of a portal or mirror: where it is, and its corners.
type Piece = (u32, u32, Vec<[f64; 3]>);

/// A source whose ids are right and whose numbers are anything.
#[derive(Debug, Clone)]
struct Garbage {
    dimension: u8,
    cells: Vec<[[f64; 3]; 2]>,
    portals: Vec<Piece>,
    mirrors: Vec<Piece>,
    objects: Vec<(u32, [[f64; 3]; 2])>,
}

fn garbage() -> impl Strategy<Value = Garbage> {
    let piece = || (0u32..5, 0u32..5, prop::collection::vec(point(), 0..30));
    (
        2u8..4,
        prop::collection::vec(prop::array::uniform2(point()), 5),
        prop::collection::vec(piece(), 0..12),
        prop::collection::vec(piece(), 0..4),
        prop::collection::vec((0u32..5, prop::array::uniform2(point())), 0..5),
    )
        .prop_map(|(dimension, cells, mut portals, mirrors, objects)| {
            portals.retain(|(a, b, _)| a != b);
            Garbage { dimension, cells, portals, mirrors, objects }
        })
}

fn aabb([min, max]: [[f64; 3]; 2]) -> Aabb<3> {
    Aabb { min, max }
}

impl CellSource for Garbage {
    type Error = std::convert::Infallible;

    fn dimension(&self) -> u8 {
        self.dimension
    }

    fn frame(&self) -> Option<Frame> {
        None
    }

    fn leaves_gaps(&self) -> bool {
        false
    }

    fn n_cells(&self) -> usize {
        self.cells.len()
    }

    fn n_objects(&self) -> usize {
        self.objects.len()
    }

    fn cell_box(&self, cell: CellId) -> Result<Aabb<3>, Self::Error> {
        Ok(aabb(self.cells[cell.idx()]))
    }

    fn visible(&self, _: CellId, out: &mut Vec<CellId>) -> Result<(), Self::Error> {
        out.clear();
        // All but one, so that some ways lead to where nothing is seen.
        out.extend((0..self.cells.len() as u32).filter(|&id| id != 3).map(CellId));
        Ok(())
    }

    fn portal_edges(&self, cell: CellId, show: &mut dyn FnMut(PortalEdge<'_>)) -> Result<(), Self::Error> {
        for (portal, (a, b, corners)) in (0..).zip(&self.portals) {
            if [*a, *b].contains(&cell.0) {
                let to = CellId(if *a == cell.0 { *b } else { *a });
                show(PortalEdge { portal: PortalId(portal), forward: *a == cell.0, to, corners });
            }
        }
        Ok(())
    }

    fn objects_of(&self, cell: CellId, out: &mut Vec<ObjectId>) -> Result<(), Self::Error> {
        out.clear();
        out.extend((0..).zip(&self.objects).filter(|(_, (at, _))| *at == cell.0).map(|(id, _)| ObjectId(id)));
        Ok(())
    }

    fn objects_seen(&self, _: CellId, out: &mut Vec<ObjectId>) -> Result<(), Self::Error> {
        out.clear();
        out.extend((0..self.objects.len() as u32).map(ObjectId));
        Ok(())
    }

    fn object_box(&self, object: ObjectId) -> Result<Aabb<3>, Self::Error> {
        Ok(aabb(self.objects[object.idx()].1))
    }

    fn mirrors(&self, cell: CellId, show: &mut dyn FnMut(MirrorPiece<'_>)) -> Result<(), Self::Error> {
        for (_, face, corners) in self.mirrors.iter().filter(|(at, ..)| *at == cell.0) {
            show(MirrorPiece { mirror: MirrorId(*face), corners });
        }
        Ok(())
    }

    fn stab_roots(&self, _: CellId, _: &mut Vec<u32>) -> Result<Option<bool>, Self::Error> {
        Ok(None)
    }

    fn stab_node(&self, _: u32, children: &mut Vec<u32>) -> Result<StabStep, Self::Error> {
        children.clear();
        Ok(StabStep { portal: PortalId(0), open: true })
    }
}

/// A view of strange but finite numbers, of the kind that the source has.
fn view(source: &Garbage, eye: [f64; 3], dir: [f64; 3], fov: f64) -> Result<View, ViewError> {
    match source.dimension {
        2 => View::planar([eye[0], eye[1]], [dir[0], dir[1]], fov),
        _ => View::perspective_horizontal(eye, dir, [0.0, 0.0, 1.0], fov, 1.5),
    }
}

proptest! {
    /// Invariant: whatever the numbers, a view is an error or every method answers, with the eye's own cell and nothing
    /// that this cell cannot see, and so do the mirrors.
    #[test]
    fn strange_numbers_make_no_panic(
        source in garbage(), eye in point(), dir in point(), fov in number(), root in 0u32..5
    ) {
        let fov = if fov > 0.0 && fov < 7.0 { fov.min(6.2) } else { 1.0 };
        let Ok(view) = view(&source, eye, dir, fov) else {
            let bad = eye.iter().chain(&dir).any(|x| !x.is_finite()) || dir[..2].iter().all(|x| *x == 0.0);
            prop_assert!(bad, "{eye:?} {dir:?}");
            return Ok(());
        };
        let (mut scratch, doors) = (Scratch::new(), Doors::all_open());
        let mut seen = VisibleSet::new();
        let mut pending = vec![(CellId(root), view)];
        for _ in 0..12 {
            let Some((root, view)) = pending.pop() else { break };
            let subgraph = VisibleSubgraph::prepare(&source, root).unwrap_or_else(|never| match never {});
            for method in Method::ALL {
                seen.clear(source.n_cells(), source.n_objects());
                method.look(&subgraph, &view, &doors, &mut scratch, &mut seen);
                prop_assert!(seen.has_cell(root), "{method}");
                prop_assert!(seen.cells().iter().all(|cell| subgraph.cells().contains(cell)), "{method}");
            }
            pending.extend(seen.reflections().iter().map(|r| (r.cell, r.view.clone())));
        }
    }
}

/// The property above looks at something: most sources are seen by someone, and mirrors with strange corners too.
#[test]
fn strange_sources_are_looked_at() {
    let sources = sightlines_testkit::draw(&garbage(), 300);
    let (mut n_cells, mut n_less, mut n_mirrors) = (0, 0, 0);
    for source in &sources {
        let view = view(source, [0.5, 0.25, 0.125], [1.0, 0.5, 0.1], 1.0).expect("numbers in their ranges");
        let subgraph = VisibleSubgraph::prepare(source, CellId(0)).unwrap_or_else(|never| match never {});
        let mut seen = VisibleSet::new();
        seen.clear(source.n_cells(), source.n_objects());
        Method::Exact.look(&subgraph, &view, &Doors::all_open(), &mut Scratch::new(), &mut seen);
        n_cells += seen.cells().len();
        n_less += subgraph.cells().len() - seen.cells().len();
        n_mirrors += seen.reflections().len();
    }
    assert!(n_cells > 400 && n_less > 200 && n_mirrors > 20, "{n_cells} {n_less} {n_mirrors}");
}

/// Eyes far away, and in cells that they are not in: the answers are nested, and the cell that was named is in all.
#[test]
fn eyes_that_are_elsewhere_get_an_answer() {
    let plan = sightlines::scenes::maze(5, 4, 4).expect("a small maze");
    let table = bake(&plan, Subdivide::Triangulation).expect("a plan on a grid");
    let mut asker = Asker::new(&table);
    let mut n = 0;
    for far in [1e-300, 0.5, 77.0, 1e9, 1e200, 1e300, f64::MAX, -f64::MAX] {
        for eye in [[far, 0.0], [0.0, far], [far, far], [far, -far]] {
            for root in (0..table.n_cells() as u32).step_by(5).map(CellId) {
                let views = [View::planar(eye, [1.0, 0.3], 1.0), View::planar(eye, [-far, -0.0], 4.0)];
                let views = views.map(|view| view.expect("finite numbers"));
                for view in views.into_iter().chain(View::all_round([eye[0], eye[1], 0.0])) {
                    let answers = asker.all(&[root], &view, &Doors::all_open());
                    assert_eq!(not_nested(&answers), None, "{eye:?} in {root}");
                    assert!(answers.iter().all(|answer| answer.cells.contains(&root.0)), "{eye:?} in {root}");
                    n += 1;
                }
            }
        }
    }
    let mut doors = Doors::all_open();
    assert!(
        doors.close(PortalId(1 << 20)) && !doors.is_open(PortalId(1 << 20)),
        "a portal that the table does not have"
    );
    let view = View::all_round([1.5, 1.5, 0.0]).expect("a finite eye");
    let open = asker.all(&[CellId(0)], &view, &Doors::all_open());
    assert_eq!(asker.all(&[CellId(0)], &view, &doors), open);
    assert!(n > 150, "{n}");
}
