//! Whether what a method finds is among what a coarser one finds.

use crate::walkthrough::DrawList;
use sightlines_eye_to_cell::MirrorImage;
use std::fmt;

/// Something that a method found: a cell, an object or an image, by way of some mirrors.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Found {
    mirrors: Vec<u32>,
    what: What,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum What {
    /// The mirrors themselves.
    Image,
    Cell(u32),
    Object(u32),
}

impl fmt::Display for Found {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.what {
            What::Image => f.write_str("an image")?,
            What::Cell(id) => write!(f, "cell {id}")?,
            What::Object(id) => write!(f, "object {id}")?,
        }
        if self.mirrors.is_empty() {
            return Ok(());
        }
        let mirrors: Vec<String> = self.mirrors.iter().map(u32::to_string).collect();
        write!(f, " in mirror {}", mirrors.join(" "))
    }
}

/// All that a frame shows: by way of no mirror, and of each sequence of mirrors.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Sets(Vec<Set>);

#[derive(Debug, Clone, PartialEq, Eq)]
struct Set {
    mirrors: Vec<u32>,
    cells: Vec<u32>,
    objects: Vec<u32>,
}

fn sorted(list: impl Iterator<Item = u32>) -> Vec<u32> {
    let mut list: Vec<u32> = list.collect();
    list.sort_unstable();
    list
}

fn first_missing(inner: &[u32], outer: &[u32]) -> Option<u32> {
    inner.iter().copied().find(|id| outer.binary_search(id).is_err())
}

impl Sets {
    /// Of a frame.
    pub(super) fn of(frame: &DrawList<'_>) -> Self {
        let direct = Set {
            mirrors: vec![],
            cells: sorted(frame.seen.cells().iter().map(|c| c.0)),
            objects: sorted(frame.seen.objects().iter().map(|o| o.0)),
        };
        let image = |image: &MirrorImage| Set {
            mirrors: image.mirrors.iter().map(|mirror| mirror.0).collect(),
            cells: image.cells.iter().map(|cell| cell.0).collect(),
            objects: image.objects.iter().map(|object| object.0).collect(),
        };
        Self(std::iter::once(direct).chain(frame.images.iter().map(image)).collect())
    }

    /// Something that is here and not in what a coarser method found; `None` if there is nothing.
    pub(super) fn beyond(&self, coarser: &Self) -> Option<Found> {
        self.0.iter().find_map(|set| {
            let found = |what| Some(Found { mirrors: set.mirrors.clone(), what });
            let Some(outer) = coarser.0.iter().find(|outer| outer.mirrors == set.mirrors) else {
                return found(What::Image);
            };
            let cell = first_missing(&set.cells, &outer.cells).map(What::Cell);
            cell.or_else(|| first_missing(&set.objects, &outer.objects).map(What::Object)).and_then(found)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every way in which nesting can fail is noticed.
    #[test]
    fn what_is_beyond_is_found() {
        let set = |mirrors: &[u32], cells: &[u32], objects: &[u32]| Set {
            mirrors: mirrors.to_vec(),
            cells: cells.to_vec(),
            objects: objects.to_vec(),
        };
        let outer = Sets(vec![set(&[], &[1, 2, 5], &[0, 3]), set(&[4], &[2], &[])]);
        let beyond = |sets: Vec<Set>| Sets(sets).beyond(&outer).map(|found| found.to_string());
        assert_eq!(outer.beyond(&outer), None);
        assert_eq!(beyond(vec![set(&[], &[2], &[3])]), None);
        assert_eq!(beyond(vec![set(&[], &[2, 3], &[])]).as_deref(), Some("cell 3"));
        assert_eq!(beyond(vec![set(&[], &[], &[0, 1])]).as_deref(), Some("object 1"));
        assert_eq!(beyond(vec![set(&[], &[], &[]), set(&[4], &[5], &[])]).as_deref(), Some("cell 5 in mirror 4"));
        assert_eq!(beyond(vec![set(&[4, 6], &[], &[])]).as_deref(), Some("an image in mirror 4 6"));
    }
}
