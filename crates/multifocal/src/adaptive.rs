//! Volumes that are subdivided where it pays.
//!
//! What is hidden from both halves of a volume is hidden from it, and much more is hidden from a half. The price is two
//! more runs of the method; it is paid only where much is still in doubt: neither hidden nor hit by a ray.

use crate::{BackendError, FromRegion, Occludees, QueryCounts, RaySampler, Umbra, Volume};

/// When to subdivide a volume.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Split {
    /// How often a volume is halved at most; 0 for never.
    pub depth: u32,
    /// A volume is halved if the triangles of objects in doubt are at least this share of all.
    pub worth: f64,
    /// Rays from each volume, to find out what is in doubt.
    pub n_rays: u32,
}

impl Default for Split {
    /// Volumes stay whole; if they are subdivided, then for at least a fiftieth of the triangles.
    fn default() -> Self {
        Self { depth: 0, worth: 0.02, n_rays: 16_384 }
    }
}

/// The work done for a volume.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct WorkDone {
    /// Volumes that the method was run for.
    pub n_volumes: u64,
    /// Queries about boxes and triangles.
    pub queries: QueryCounts,
}

impl std::ops::Add for WorkDone {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { n_volumes: self.n_volumes + other.n_volumes, queries: self.queries + other.queries }
    }
}

/// Finds the objects that may be visible from a volume: clears `visible` for those that the method proves hidden, from
/// the whole volume or from all of its parts; objects that are not visible at the start are skipped.
///
/// * `also`: called once with the umbra of the whole volume, for additional queries
///
/// # Errors
/// [`BackendError`], from the method.
///
/// # Panics
/// If `visible` is shorter than the objects.
pub fn see(
    method: &mut dyn FromRegion,
    occludees: &Occludees,
    sampler: &RaySampler,
    volume: &Volume,
    split: &Split,
    visible: &mut [bool],
    also: &mut dyn FnMut(&mut dyn Umbra),
) -> Result<WorkDone, BackendError> {
    let mut seen = vec![false; occludees.len()];
    see_and_note(method, occludees, sampler, volume, split, visible, &mut seen, also)
}

/// The same as [`see`](fn@see), and records in `seen` the objects that rays hit: nothing can prove those hidden, so
/// they need no further test.
///
/// # Errors
/// [`BackendError`], from the method.
///
/// # Panics
/// If `visible` or `seen` is shorter than the objects.
#[expect(clippy::too_many_arguments, reason = "those of `see`, and one more")]
pub fn see_and_note(
    method: &mut dyn FromRegion,
    occludees: &Occludees,
    sampler: &RaySampler,
    volume: &Volume,
    split: &Split,
    visible: &mut [bool],
    seen: &mut [bool],
    also: &mut dyn FnMut(&mut dyn Umbra),
) -> Result<WorkDone, BackendError> {
    let mut effort = WorkDone { n_volumes: 1, ..WorkDone::default() };
    sampler.see(volume, split.n_rays, visible, seen);
    let mut umbra = method.umbra(volume)?;
    also(&mut *umbra);
    let mut search = Search { occludees, sampler, split, effort: &mut effort };
    search.ask(&mut *umbra, volume, seen, visible);
    drop(umbra);
    search.see_parts(method, volume, 0, seen, visible)?;
    Ok(effort)
}

struct Search<'a> {
    occludees: &'a Occludees,
    sampler: &'a RaySampler,
    split: &'a Split,
    effort: &'a mut WorkDone,
}

impl Search<'_> {
    /// Clears what an umbra hides, among objects that no ray hit.
    fn ask(&mut self, umbra: &mut dyn Umbra, volume: &Volume, seen: &[bool], visible: &mut [bool]) {
        let asked: Vec<bool> = visible.iter().zip(seen).map(|(visible, seen)| *visible && !seen).collect();
        let did = self.occludees.see(umbra, volume, &asked, visible);
        self.effort.queries = self.effort.queries + did;
    }

    /// Tests the halves of a volume that has been tested, if it is worth it.
    ///
    /// `seen`: the objects that rays hit, from this volume or a part of the original one; grows.
    fn see_parts(
        &mut self,
        method: &mut dyn FromRegion,
        volume: &Volume,
        depth: u32,
        seen: &mut [bool],
        visible: &mut [bool],
    ) -> Result<(), BackendError> {
        let Some(halves) = volume.halves().filter(|_| depth < self.split.depth) else { return Ok(()) };
        let n_triangles = |o: usize| self.occludees.triangles(o).len();
        let all: usize = (0..self.occludees.len()).map(n_triangles).sum();
        let doubt: usize = (0..self.occludees.len()).filter(|&o| visible[o] && !seen[o]).map(n_triangles).sum();
        if doubt == 0 || (doubt as f64) < self.split.worth * all as f64 {
            return Ok(());
        }
        let start: Vec<bool> = visible.to_vec();
        visible.iter_mut().zip(&*seen).for_each(|(visible, seen)| *visible &= seen);
        for half in &halves {
            // What the other half sees need not be tested again.
            let mut of_half: Vec<bool> = start.iter().zip(&*visible).map(|(start, known)| *start && !known).collect();
            self.sampler.see(half, self.split.n_rays, &of_half, seen);
            self.effort.n_volumes += 1;
            let mut umbra = method.umbra(half)?;
            self.ask(&mut *umbra, half, seen, &mut of_half);
            drop(umbra);
            self.see_parts(method, half, depth + 1, seen, &mut of_half)?;
            visible.iter_mut().zip(of_half).for_each(|(visible, of_half)| *visible |= of_half);
        }
        Ok(())
    }
}
