//! Pixels with transparency on which rectangles and lines are drawn.

/// A picture of pixels, transparent at first.
pub(super) struct Canvas {
    size: [usize; 2],
    /// Red, green, blue and the share that is covered, row by row from the upper left corner.
    bytes: Vec<u8>,
}

impl Canvas {
    pub(super) fn new(size: [u32; 2]) -> Self {
        let [width, height] = size.map(|x| x as usize);
        Self { size: [width, height], bytes: vec![0; 4 * width * height] }
    }

    pub(super) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Fills a rectangle, from whole pixel to whole pixel: rectangles with a common side leave no gap.
    pub(super) fn fill(&mut self, [left, top, right, bottom]: [f64; 4], colour: [u8; 3]) {
        let [columns, rows] = [(left, right, 0), (top, bottom, 1)].map(|(from, to, k)| {
            let place = |x: f64| x.round().clamp(0.0, self.size[k] as f64) as usize;
            place(from)..place(to)
        });
        for row in rows {
            for column in columns.clone() {
                self.blend(column, row, 1.0, colour);
            }
        }
    }

    /// Draws a line with round ends.
    pub(super) fn stroke(&mut self, [a, b]: [[f64; 2]; 2], width: f64, colour: [u8; 3]) {
        let [dx, dy] = [b[0] - a[0], b[1] - a[1]];
        let square = dx * dx + dy * dy;
        let reach = 0.5 * width + 1.0;
        let size = self.size;
        let range = |k: usize, low: f64, high: f64| {
            let place = |x: f64| x.clamp(0.0, size[k] as f64) as usize;
            place((low - reach).floor())..place((high + reach).ceil())
        };
        for row in range(1, a[1].min(b[1]), a[1].max(b[1])) {
            let y = row as f64 + 0.5;
            // Only the pixels near the line in this row.
            let [mut left, mut right] = [a[0].min(b[0]), a[0].max(b[0])];
            if dy != 0.0 {
                let at = |y: f64| a[0] + ((y - a[1]) / dy).clamp(0.0, 1.0) * dx;
                let [s, t] = [at(y - reach), at(y + reach)];
                (left, right) = (left.max(s.min(t)), right.min(s.max(t)));
            }
            for column in range(0, left, right) {
                let x = column as f64 + 0.5;
                let along = if square > 0.0 { ((x - a[0]) * dx + (y - a[1]) * dy) / square } else { 0.0 };
                let along = along.clamp(0.0, 1.0);
                let [u, v] = [x - a[0] - along * dx, y - a[1] - along * dy];
                let cover = 0.5 + 0.5 * width - (u * u + v * v).sqrt();
                self.blend(column, row, cover.clamp(0.0, width.min(1.0)), colour);
            }
        }
    }

    /// Lays a colour over a pixel.
    fn blend(&mut self, column: usize, row: usize, cover: f64, colour: [u8; 3]) {
        let at = 4 * (row * self.size[0] + column);
        let pixel = &mut self.bytes[at..at + 4];
        let below = f64::from(pixel[3]) / 255.0 * (1.0 - cover);
        let all = cover + below;
        if all > 0.0 {
            for (part, new) in pixel.iter_mut().zip(colour) {
                *part = ((f64::from(new) * cover + f64::from(*part) * below) / all).round() as u8;
            }
            pixel[3] = (all * 255.0).round() as u8;
        }
    }
}
