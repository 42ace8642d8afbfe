//! Asking all methods, and comparing their answers.

use sightlines::eye_to_cell::{
    Doors, Method, MirrorImage, Scratch, StepBudget, TableCells, View, VisibleSet, VisibleSubgraph, follow_reflections,
};
use sightlines::pvs::{CellId, Table};
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

/// Cells and objects, by id.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Answer {
    pub(crate) cells: BTreeSet<u32>,
    pub(crate) objects: BTreeSet<u32>,
}

/// What the methods say, in the order of [`Method::ALL`].
pub(crate) type Answers = [Answer; 5];

/// A table with a reusable workspace for queries.
pub(crate) struct Asker<'t> {
    cells: TableCells<&'t Table>,
    subgraphs: BTreeMap<CellId, Rc<VisibleSubgraph>>,
    scratch: Scratch,
    /// Answers of all methods that were asked for.
    n_asked: u64,
    /// The last bounded answer of the exact method.
    pub(crate) bounded: Answer,
    /// Bounded answers that are between the exact one and that of the incident portals.
    pub(crate) n_between: usize,
}

/// Work of bounded answers: some in the middle of the search, for scenes of all sizes.
const STEPS: [u64; 6] = [200, 500, 1000, 2000, 4000, 10_000];

impl<'t> Asker<'t> {
    pub(crate) fn new(table: &'t Table) -> Self {
        Self {
            cells: TableCells::new(table),
            subgraphs: BTreeMap::new(),
            scratch: Scratch::new(),
            n_asked: 0,
            bounded: Answer::default(),
            n_between: 0,
        }
    }

    /// What a method says of a viewer in the cells `roots`, as it says it: cells, objects, what is seen in mirrors.
    pub(crate) fn ask(&mut self, roots: &[CellId], view: &View, doors: &Doors, method: Method) -> VisibleSet {
        self.ask_within(StepBudget::UNLIMITED, roots, view, doors, method)
    }

    /// The same with a bound on the work.
    fn ask_within(
        &mut self,
        budget: StepBudget,
        roots: &[CellId],
        view: &View,
        doors: &Doors,
        method: Method,
    ) -> VisibleSet {
        self.scratch.allow(budget);
        let mut seen = VisibleSet::new();
        seen.clear(self.cells.table().n_cells(), self.cells.table().objects().len());
        for &root in roots {
            let subgraph = subgraph(&self.cells, &mut self.subgraphs, root);
            method.look(&subgraph, view, doors, &mut self.scratch, &mut seen);
        }
        seen
    }

    /// What all methods say, mirrors left out. Also asks the exact one with some bound on the work ([`Asker::bounded`]).
    ///
    /// # Panics
    /// If the bounded answer has something that the incident portals do not lead to.
    pub(crate) fn all(&mut self, roots: &[CellId], view: &View, doors: &Doors) -> Answers {
        let answers = Method::ALL.map(|method| answer(&self.ask(roots, view, doors, method)));
        let budget = StepBudget::steps(STEPS[self.n_asked as usize % STEPS.len()]);
        self.n_asked += 1;
        let bounded = answer(&self.ask_within(budget, roots, view, doors, Method::Exact));
        let [.., coarser, exact] = &answers;
        let is_within = bounded.cells.is_subset(&coarser.cells) && bounded.objects.is_subset(&coarser.objects);
        assert!(is_within, "within {budget:?}: {view:?} in {roots:?}: {bounded:?} is not within {coarser:?}");
        self.n_between += usize::from(bounded != *exact && bounded != *coarser);
        self.bounded = bounded;
        answers
    }

    /// What a method says of a viewer and of mirrors, of three in a row at most.
    pub(crate) fn images(&mut self, roots: &[CellId], view: &View, doors: &Doors, method: Method) -> Vec<MirrorImage> {
        self.images_within(StepBudget::UNLIMITED, roots, view, doors, method)
    }

    /// What the exact method says of mirrors with bounds on the work: one answer for each.
    pub(crate) fn bounded_images(&mut self, roots: &[CellId], view: &View, doors: &Doors) -> [Vec<MirrorImage>; 6] {
        STEPS.map(|steps| self.images_within(StepBudget::steps(steps), roots, view, doors, Method::Exact))
    }

    fn images_within(
        &mut self,
        budget: StepBudget,
        roots: &[CellId],
        view: &View,
        doors: &Doors,
        method: Method,
    ) -> Vec<MirrorImage> {
        let first = self.ask_within(budget, roots, view, doors, method);
        let sizes = [self.cells.table().n_cells(), self.cells.table().objects().len()];
        let Self { cells, subgraphs, scratch, .. } = self;
        follow_reflections(method, &first, 3, doors, scratch, sizes, |cell| Some(subgraph(cells, subgraphs, cell)))
    }
}

fn subgraph(
    cells: &TableCells<&Table>,
    known: &mut BTreeMap<CellId, Rc<VisibleSubgraph>>,
    root: CellId,
) -> Rc<VisibleSubgraph> {
    let prepare = || Rc::new(VisibleSubgraph::prepare(cells, root).unwrap_or_else(|never| match never {}));
    known.entry(root).or_insert_with(prepare).clone()
}

/// What was seen, mirrors left out.
pub(crate) fn answer(seen: &VisibleSet) -> Answer {
    Answer { cells: seen.cells().iter().map(|c| c.0).collect(), objects: seen.objects().iter().map(|o| o.0).collect() }
}

/// What is wrong with the nesting of the answers, if anything is.
pub(crate) fn not_nested(answers: &Answers) -> Option<String> {
    let wrong = |k: &usize| {
        let [wide, narrow] = [&answers[k - 1], &answers[*k]];
        !narrow.cells.is_subset(&wide.cells) || !narrow.objects.is_subset(&wide.objects)
    };
    (1..answers.len()).find(wrong).map(|k| format!("{} is not within {}", Method::ALL[k], Method::ALL[k - 1]))
}

/// The first method that misses something that is seen, and what.
pub(crate) fn missed(answers: &Answers, seen: &Answer) -> Option<String> {
    Method::ALL.iter().zip(answers).find_map(|(method, answer)| {
        let cell = seen.cells.difference(&answer.cells).next();
        let object = seen.objects.difference(&answer.objects).next();
        let cell = cell.map(|cell| format!("{method} misses cell {cell}"));
        cell.or_else(|| object.map(|object| format!("{method} misses object {object}")))
    })
}

/// Something that is seen and that a bounded answer misses.
pub(crate) fn missed_within_bounds(bounded: &Answer, seen: &Answer) -> Option<String> {
    let cell = seen.cells.difference(&bounded.cells).next().map(|cell| format!("a bounded answer misses cell {cell}"));
    let object = || seen.objects.difference(&bounded.objects).next();
    cell.or_else(|| object().map(|object| format!("a bounded answer misses object {object}")))
}

/// Cells by the mirrors, one after the other, that show them.
pub(crate) type Shown = BTreeMap<Vec<u32>, BTreeSet<u32>>;

/// The first mirrors and cell that rays reach and the images do not show. Where the images of a row of mirrors are not
/// complete, anything may be seen in it and in all rows that begin with it.
pub(crate) fn missed_in_mirrors(images: &[MirrorImage], reached: &Shown) -> Option<String> {
    let image = |mirrors: &[u32]| {
        images.iter().find(|image| image.mirrors.iter().map(|mirror| mirror.0).eq(mirrors.iter().copied()))
    };
    reached.iter().filter(|(mirrors, _)| !mirrors.is_empty()).find_map(|(mirrors, cells)| {
        let open = (1..=mirrors.len()).any(|n| image(&mirrors[..n]).is_some_and(|image| !image.complete));
        let shown = |cell: &u32| image(mirrors).is_some_and(|image| image.cells.contains(&CellId(*cell)));
        let missed = cells.iter().find(|cell| !open && !shown(cell));
        missed.map(|cell| format!("mirrors {mirrors:?} do not show cell {cell}"))
    })
}

/// The numbers of the mirrors of an image, in the order in which a line from the eye meets them.
pub(crate) fn word_of(image: &MirrorImage) -> Vec<u32> {
    image.mirrors.iter().map(|mirror| mirror.0).collect()
}
