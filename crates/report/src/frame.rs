//! From scene units to picture units: y grows upwards in a plan and downwards in a picture.

use sightlines_geometry::{Aabb, Point2, Segment2};
use std::fmt::Write;

/// Where a plan lies in a picture.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Frame {
    left: f64,
    top: f64,
    /// Pixels for a scene unit.
    pub(crate) scale: f64,
    margin: f64,
    /// Width of the picture in pixels.
    pub(crate) width: u32,
    /// Height of the picture in pixels.
    pub(crate) height: u32,
}

impl Frame {
    /// A picture whose longer side has `size` pixels and shows all of `bounds`, with a margin around.
    pub(crate) fn around(bounds: Aabb<2>, size: u32) -> Self {
        Self::within(bounds, [f64::from(size); 2], size)
    }

    /// A picture that is at most `room` pixels wide and high and shows all of `bounds`, with the margin of a picture whose longer side
    /// has `size` pixels.
    pub(crate) fn within(bounds: Aabb<2>, room: [f64; 2], size: u32) -> Self {
        let bounds = if bounds.is_empty() { Aabb { min: [0.0; 2], max: [1.0; 2] } } else { bounds };
        let [w, h] = [bounds.max[0] - bounds.min[0], bounds.max[1] - bounds.min[1]];
        let margin = (f64::from(size) / 50.0).max(1.0);
        let [across, down] = room.map(|room| (room - 2.0 * margin).max(1.0));
        let scale = if w.max(h) > 0.0 { (across / w).min(down / h) } else { 1.0 };
        // At most a size, so the cast is exact.
        let pixels = |x: f64, room: f64| (x * scale + 2.0 * margin).ceil().clamp(1.0, room.max(1.0)) as u32;
        let [width, height] = [pixels(w, room[0]), pixels(h, room[1])];
        Self { left: bounds.min[0], top: bounds.max[1], scale, margin, width, height }
    }

    /// A point of the plan, in pixels from the upper left corner.
    pub(crate) fn place(&self, p: Point2) -> [f64; 2] {
        [(p.x - self.left) * self.scale + self.margin, (self.top - p.y) * self.scale + self.margin]
    }

    /// The point of the plan that is so many pixels from the upper left corner.
    pub(crate) fn point(&self, [x, y]: [f64; 2]) -> Point2 {
        Point2::new((x - self.margin) / self.scale + self.left, self.top - (y - self.margin) / self.scale)
    }

    /// The area in square pixels of an area in square units.
    pub(crate) fn area(&self, units: f64) -> f64 {
        units * self.scale * self.scale
    }

    /// Lines as the data of a path, to the tenth of a pixel; those that are the same or a point there are left out.
    pub(crate) fn lines(&self, lines: impl Iterator<Item = Segment2>) -> String {
        let tenths = |p| self.place(p).map(|x| (x * 10.0).round() as i64);
        let ends = |line: Segment2| {
            let [a, b] = [tenths(line.a), tenths(line.b)];
            [a.min(b), a.max(b)]
        };
        let mut ends: Vec<[[i64; 2]; 2]> = lines.map(ends).filter(|[a, b]| a != b).collect();
        ends.sort_unstable();
        ends.dedup();
        let mut path = String::new();
        for line in ends {
            for (command, p) in ['M', 'L'].into_iter().zip(line) {
                let [x, y] = p.map(|x| Px(x as f64 / 10.0));
                let _ = write!(path, "{command}{x} {y}");
            }
        }
        path
    }

    /// Appends a closed polygon to the data of a path.
    pub(crate) fn polygon(&self, path: &mut String, corners: &[Point2]) {
        self.polyline(path, corners);
        path.push('Z');
    }

    /// Appends an open line to the data of a path.
    pub(crate) fn polyline(&self, path: &mut String, corners: &[Point2]) {
        for (i, &corner) in corners.iter().enumerate() {
            let [x, y] = self.place(corner);
            let _ = write!(path, "{}{} {}", if i == 0 { 'M' } else { 'L' }, Px(x), Px(y));
        }
    }
}

/// A length in pixels, to the hundredth, without superfluous zeros.
pub(crate) struct Px(pub(crate) f64);

impl std::fmt::Display for Px {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let hundredths = (self.0 * 100.0).round();
        write!(f, "{}", if hundredths == 0.0 { 0.0 } else { hundredths / 100.0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plans_keep_their_proportions_and_stand_upright() {
        let frame = Frame::around(Aabb { min: [-10.0, 0.0], max: [10.0, 5.0] }, 500);
        assert_eq!((frame.width, frame.height), (500, 140));
        assert_eq!(frame.place(Point2::new(-10.0, 5.0)), [10.0, 10.0]);
        assert_eq!(frame.place(Point2::new(10.0, 0.0)), [490.0, 130.0]);
        assert_eq!(frame.area(100.0), 480.0 * 120.0);
    }

    #[test]
    fn nothing_and_a_point_have_a_picture() {
        let frame = Frame::around(Aabb::EMPTY, 100);
        assert_eq!((frame.width, frame.height), (100, 100));
        let frame = Frame::around(Aabb { min: [3.0; 2], max: [3.0; 2] }, 100);
        assert!(frame.place(Point2::new(3.0, 3.0)).iter().all(|x| x.is_finite()));
    }

    #[test]
    fn pixels_are_short() {
        let show = |x| Px(x).to_string();
        assert_eq!([show(1.0), show(2.345_678), show(-0.001), show(0.5)], ["1", "2.35", "0", "0.5"]);
    }
}
