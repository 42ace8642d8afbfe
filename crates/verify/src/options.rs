//! How much to look at.

use sightlines_progress::Observer;

/// How much to look at, and with which rays.
#[derive(Clone, Copy)]
pub struct VerifyOptions<'a> {
    /// Rays in random directions from random places.
    pub rays: u64,
    /// Hidden pairs, of cells or of a cell and an object, that rays are aimed at; all of them if there are no more.
    pub pairs: u64,
    /// Rays that are aimed at each of these pairs; the most suspicious ones get eight times as many.
    pub tries: u32,
    /// Random segments between the two of each hidden pair next to visible ones; fewer if there are many pairs ([`Sampled`](crate::Sampled)). With the
    /// default, a pair of which one segment in a hundred is free is missed in one of a hundred runs: 0.99^459 < 0.01.
    pub segments: u32,
    /// For a table with parts of objects: the triangles of the file that the scene does not have, as the scene's reader lists them.
    pub left_out: &'a [[u32; 2]],
    /// What the random numbers begin with.
    pub seed: u64,
    /// Number of threads; 0 for one for each core. Changes nothing but the time.
    pub threads: usize,
    /// Receives reports on rays, and may cancel.
    pub progress: Option<&'a dyn Observer>,
}

impl VerifyOptions<'_> {
    /// Maximum number of listed violations of one kind; further ones are counted, and no more rays are shot.
    pub const MOST_VIOLATIONS: usize = 1000;
}

impl Default for VerifyOptions<'_> {
    fn default() -> Self {
        Self {
            rays: 100_000,
            pairs: 10_000,
            tries: 32,
            segments: 459,
            left_out: &[],
            seed: 1,
            threads: 0,
            progress: None,
        }
    }
}

impl std::fmt::Debug for VerifyOptions<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("VerifyOptions")
            .field("rays", &self.rays)
            .field("pairs", &self.pairs)
            .field("tries", &self.tries)
            .field("segments", &self.segments)
            .field("seed", &self.seed)
            .field("threads", &self.threads)
            .finish_non_exhaustive()
    }
}
