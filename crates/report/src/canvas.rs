//! Pixels with transparency on which rectangles, polygons and lines are drawn.

/// A picture of pixels, transparent at first.
pub(crate) struct Canvas {
    size: [usize; 2],
    /// Red, green, blue and the share that is covered, row by row from the upper left corner.
    bytes: Vec<u8>,
}

impl Canvas {
    pub(crate) fn new(size: [u32; 2]) -> Self {
        let [width, height] = size.map(|x| x as usize);
        Self { size: [width, height], bytes: vec![0; 4 * width * height] }
    }

    pub(crate) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Fills a rectangle, from whole pixel to whole pixel: rectangles with a common side leave no gap.
    pub(crate) fn fill(&mut self, [left, top, right, bottom]: [f64; 4], colour: [u8; 3]) {
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

    /// Fills a polygon as far as it covers pixels, in four rows of samples to a pixel; where it passes over itself, it is left open.
    ///
    /// * `opacity`: from 0 to 1
    pub(crate) fn fill_polygon(&mut self, corners: &[[f64; 2]], opacity: f64, colour: [u8; 3]) {
        const SAMPLES: usize = 4;
        let [width, height] = self.size;
        let (top, bottom) = corners.iter().fold((f64::INFINITY, 0.0f64), |(t, b), p| (t.min(p[1]), b.max(p[1])));
        let rows = top.clamp(0.0, height as f64).floor() as usize..bottom.clamp(0.0, height as f64).ceil() as usize;
        let mut cover = vec![0.0; width];
        let mut crossings = Vec::new();
        for row in rows {
            cover.fill(0.0);
            for sample in 0..SAMPLES {
                let y = row as f64 + (sample as f64 + 0.5) / SAMPLES as f64;
                crossings.clear();
                let ends = corners.iter().zip(corners.iter().cycle().skip(1));
                crossings.extend(ends.filter(|(a, b)| (a[1] <= y) != (b[1] <= y)).map(|(a, b)| {
                    let x = a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
                    x.clamp(0.0, width as f64)
                }));
                crossings.sort_unstable_by(f64::total_cmp);
                for span in crossings.chunks_exact(2) {
                    let columns = span[0].floor() as usize..span[1].ceil() as usize;
                    for (part, column) in cover[columns.clone()].iter_mut().zip(columns) {
                        let x = column as f64;
                        *part += (span[1].min(x + 1.0) - span[0].max(x)) / SAMPLES as f64;
                    }
                }
            }
            for (column, &part) in cover.iter().enumerate().filter(|(_, part)| **part > 0.0) {
                self.blend(column, row, part.min(1.0) * opacity, colour);
            }
        }
    }

    /// Draws a line with round ends.
    pub(crate) fn stroke(&mut self, [a, b]: [[f64; 2]; 2], width: f64, colour: [u8; 3]) {
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

/// A colour `#rrggbb`.
pub(crate) fn parsed(colour: &str) -> [u8; 3] {
    let part = |k: usize| u8::from_str_radix(&colour[2 * k + 1..2 * k + 3], 16).unwrap_or_default();
    std::array::from_fn(part)
}
