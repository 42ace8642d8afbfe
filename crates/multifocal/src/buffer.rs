//! Multifocal buffers.

use crate::BufferPlane;

/// One value for each texel of a plane, row by row (`y * width + x`): 0 where nothing is known to block, otherwise 1
/// more than the [`Measure`](crate::Measure) from which on everything is certainly blocked, in units of the job,
/// rounded down.
///
/// So a texel that is blocked from height 0 on (value 1) differs from one that is not blocked (value 0).
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Buffer {
    texels: [u32; 2],
    values: Vec<u32>,
}

impl Buffer {
    /// A buffer for `plane`, in which nothing blocks.
    pub fn new(plane: &BufferPlane) -> Self {
        let mut buffer = Self::default();
        buffer.reset(plane.texels());
        buffer
    }

    /// Resets it to a buffer of `texels` in which nothing blocks. Allocates only if it has to grow.
    pub fn reset(&mut self, texels: [u32; 2]) {
        self.texels = texels;
        self.values.clear();
        self.values.resize(texels[0] as usize * texels[1] as usize, 0);
    }

    /// Number of texels along each axis.
    pub const fn texels(&self) -> [u32; 2] {
        self.texels
    }

    /// All values, row by row.
    pub fn values(&self) -> &[u32] {
        &self.values
    }

    /// All values, row by row.
    pub fn values_mut(&mut self) -> &mut [u32] {
        &mut self.values
    }

    /// One row.
    pub fn row(&self, y: u32) -> &[u32] {
        let w = self.texels[0] as usize;
        &self.values[y as usize * w..][..w]
    }

    /// Value of a texel.
    pub fn get(&self, x: u32, y: u32) -> u32 {
        self.row(y)[x as usize]
    }

    /// Number of blocked texels.
    pub fn n_blocked(&self) -> usize {
        self.values.iter().filter(|&&v| v > 0).count()
    }
}
