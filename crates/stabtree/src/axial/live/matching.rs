//! What is equal before and after.

use super::super::opaque::key;
use sightlines_geometry::Aabb;

/// A one-to-one matching of equal things.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Matching {
    /// For each new thing the old one.
    pub(super) old_of: Vec<Option<u32>>,
    /// For each old thing the new one.
    pub(super) new_of: Vec<Option<u32>>,
}

/// For each new box the first of the old ones that is equal to it. O(n log n).
pub(super) fn same_boxes(old: &[Aabb<3>], new: &[Aabb<3>]) -> Vec<Option<u32>> {
    let bits = |b: &Aabb<3>| (b.min.map(key), b.max.map(key));
    let mut sorted: Vec<_> = (0u32..).zip(old).map(|(i, b)| (bits(b), i)).collect();
    sorted.sort_unstable();
    let same = |b: &Aabb<3>| {
        let first = sorted.partition_point(|old| old.0 < bits(b));
        sorted.get(first).filter(|old| old.0 == bits(b)).map(|old| old.1)
    };
    new.iter().map(same).collect()
}

impl Matching {
    /// Builds a matching from the old thing that each new one equals. If several equal the same one, the first is
    /// matched and the others count as new.
    pub(super) fn of(same: &[Option<u32>], n_old: usize) -> Self {
        let mut new_of = vec![None; n_old];
        let old_of = (0u32..).zip(same).map(|(new, old)| {
            let free = old.filter(|&old| new_of[old as usize].is_none())?;
            new_of[free as usize] = Some(new);
            Some(free)
        });
        Self { old_of: old_of.collect(), new_of }
    }

    /// Without the unwanted pairs.
    pub(super) fn only(mut self, mut wanted: impl FnMut(u32, u32) -> bool) -> Self {
        for (new, old) in (0u32..).zip(&mut self.old_of) {
            if let Some(other) = old.filter(|&old| !wanted(old, new)) {
                self.new_of[other as usize] = None;
                *old = None;
            }
        }
        self
    }
}

/// For each old thing all new ones that equal it, from the old one that each new one equals.
pub(super) fn heirs(same: &[Option<u32>], n_old: usize) -> Vec<Vec<u32>> {
    let mut heirs = vec![Vec::new(); n_old];
    for (new, old) in (0u32..).zip(same) {
        old.iter().for_each(|&old| heirs[old as usize].push(new));
    }
    heirs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_boxes_are_found() {
        let cube = |x: f64| Aabb { min: [x; 3], max: [x + 1.0; 3] };
        let old = [cube(0.0), cube(1.0), cube(0.0)];
        let same = same_boxes(&old, &[cube(1.0), cube(-0.0), cube(3.0), cube(0.0)]);
        assert_eq!(same, [Some(1), Some(0), None, Some(0)]);
        let matching = Matching::of(&same, 3);
        assert_eq!(matching.old_of, [Some(1), Some(0), None, None]);
        assert_eq!(matching.new_of, [Some(1), Some(0), None]);
        assert_eq!(heirs(&same, 3), [vec![1, 3], vec![0], vec![]]);
        let one = matching.only(|old, _| old == 1);
        assert_eq!((one.old_of, one.new_of), (vec![Some(1), None, None, None], vec![None, Some(0), None]));
    }
}
