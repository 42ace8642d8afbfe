//! What is seen in mirrors, and in mirrors in mirrors.
//!
//! A mirror is a portal into reflected space. Instead of reflecting the space, the eye is reflected: from behind the
//! mirror it looks through the mirror's frame into the cells as they are. So the table, the portals and the methods
//! are used as they are, and only the eye's place may be rounded; mirrors along an axis round it hardly ever.
//! A line goes on in the cell that the mirror is in, so what it may meet there is what that cell may see.

use crate::doors::Doors;
use crate::method::{Method, Scratch};
use crate::subgraph::VisibleSubgraph;
use crate::visible_set::{Reflection, VisibleSet};
use sightlines_pvs::{CellId, MirrorId, ObjectId};
use std::borrow::Borrow;
use std::collections::{BTreeMap, BTreeSet};

/// The most views in mirrors that are followed for one frame; mirrors that face each other show many.
const MOST_VIEWS: usize = 1024;

/// What is seen by way of one mirror after another.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct MirrorImage {
    /// The mirrors, in the order in which a line from the eye meets them.
    pub mirrors: Vec<MirrorId>,
    /// The cells, ascending.
    pub cells: Vec<CellId>,
    /// The objects, ascending.
    pub objects: Vec<ObjectId>,
    /// Whether a view in these mirrors had more to do than [`Scratch::allow`] lets it, so that a coarser method answered there.
    pub fell_back: bool,
    /// Whether that is all. If not, a subgraph was missing or there were too many views: anything may be seen by way of
    /// these mirrors, and of any others after them, which are not listed then.
    pub complete: bool,
}

/// Follows reflections, of `bounces` mirrors at most: the first are what [`Method::look`] left in `seen`.
///
/// `subgraph` gives the subgraph of a cell, or none if it is not there; what is seen in that mirror is then not
/// complete. Images come by ascending mirrors. Allocates.
pub fn follow_reflections<O: Borrow<VisibleSubgraph>>(
    method: Method,
    first: &VisibleSet,
    bounces: usize,
    doors: &Doors,
    scratch: &mut Scratch,
    [n_cells, n_objects]: [usize; 2],
    mut subgraph: impl FnMut(CellId) -> Option<O>,
) -> Vec<MirrorImage> {
    let mut images: BTreeMap<Vec<MirrorId>, Sets> = BTreeMap::new();
    let step = |mirrors: &[MirrorId], next: &Reflection| ([mirrors, &[next.mirror]].concat(), next.clone());
    let mut pending: Vec<(Vec<MirrorId>, Reflection)> = match bounces {
        0 => Vec::new(),
        _ => first.reflections.iter().map(|r| step(&[], r)).collect(),
    };
    let mut seen = VisibleSet::new();
    let mut n_views = 0;
    while let Some((mirrors, reflection)) = pending.pop() {
        let image = images.entry(mirrors.clone()).or_default();
        n_views += 1;
        let there = subgraph(reflection.cell).filter(|_| n_views <= MOST_VIEWS);
        let Some(there) = there else {
            image.misses = true;
            continue;
        };
        seen.clear(n_cells, n_objects);
        image.fell_back |= method.look(there.borrow(), &reflection.view, doors, scratch, &mut seen) < method;
        image.cells.extend(seen.cells());
        image.objects.extend(seen.objects());
        if mirrors.len() < bounces {
            pending.extend(seen.reflections.iter().map(|r| step(&mirrors, r)));
        }
    }
    let image = |(mirrors, Sets { cells, objects, misses, fell_back }): (Vec<MirrorId>, Sets)| MirrorImage {
        mirrors,
        cells: cells.into_iter().collect(),
        objects: objects.into_iter().collect(),
        complete: !misses,
        fell_back,
    };
    images.into_iter().map(image).collect()
}

/// What becomes an image.
#[derive(Default)]
struct Sets {
    cells: BTreeSet<CellId>,
    objects: BTreeSet<ObjectId>,
    misses: bool,
    fell_back: bool,
}
