//! A level of the pyramid.

/// A level: each square stands for up to 2 by 2 of the level below. A pixel is a square of level 0.
#[derive(Debug, Clone, PartialEq)]
pub struct PyramidLevel {
    pub(super) size: [u32; 2],
    pub(super) nearness: Vec<f64>,
}

impl PyramidLevel {
    /// Squares to the right and down.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// For each square, row by row, one over a depth behind which everything in it is hidden; 0 where nothing is.
    pub fn nearness(&self) -> &[f64] {
        &self.nearness
    }

    pub(super) fn at(&self, x: u32, y: u32) -> f64 {
        self.nearness[y as usize * self.size[0] as usize + x as usize]
    }

    pub(super) fn row_mut(&mut self, y: u32) -> &mut [f64] {
        let width = self.size[0] as usize;
        &mut self.nearness[y as usize * width..][..width]
    }

    /// The level above. `farthest` chooses of two.
    pub(super) fn halved(&self, farthest: fn(f64, f64) -> f64) -> Self {
        let size = self.size.map(|n| n.div_ceil(2));
        let mut nearness = Vec::with_capacity(size[0] as usize * size[1] as usize);
        for y in 0..size[1] {
            // The last square of an odd number stands for one, asked twice.
            let rows = [2 * y, (2 * y + 1).min(self.size[1] - 1)];
            for x in 0..size[0] {
                let columns = [2 * x, (2 * x + 1).min(self.size[0] - 1)];
                let pair = |y: u32| farthest(self.at(columns[0], y), self.at(columns[1], y));
                nearness.push(farthest(pair(rows[0]), pair(rows[1])));
            }
        }
        Self { size, nearness }
    }
}
