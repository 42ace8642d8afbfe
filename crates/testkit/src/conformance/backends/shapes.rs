//! Shapes that hide, in a frame that looks along z: eyes around the origin, the nearest plane at z = 8.

use super::Random;
use sightlines_geometry::Point3;

/// An outline and the triangles within it, counter-clockwise as seen from below, where eyes are.
#[derive(Debug, Clone)]
pub(super) struct Shape {
    pub(super) outline: Vec<Point3>,
    pub(super) triangles: Vec<[Point3; 3]>,
}

impl Shape {
    /// A polygon that its first corner sees all of.
    pub(super) fn fan(outline: Vec<Point3>) -> Self {
        let triangles = outline[1..].windows(2).map(|pair| [outline[0], pair[0], pair[1]]).collect();
        Self { outline, triangles }
    }

    /// The rectangle between two corners, at height `z` of its middle, which rises by `a` and `b` along x and y.
    pub(super) fn rectangle([x0, y0]: [f64; 2], [x1, y1]: [f64; 2], z: f64, [a, b]: [f64; 2]) -> Self {
        let (cx, cy) = ((x0 + x1) / 2.0, (y0 + y1) / 2.0);
        let at = |x: f64, y: f64| [x, y, z + a * (x - cx) + b * (y - cy)];
        Self::fan(vec![at(x0, y0), at(x0, y1), at(x1, y1), at(x1, y0)])
    }

    /// A pyramid without its base, over the outline of a rectangle, with its top at `top`.
    pub(super) fn tent(base: &Self, top: Point3) -> Self {
        let next = base.outline.iter().cycle().skip(1);
        let triangles = base.outline.iter().zip(next).map(|(&p, &q)| [top, p, q]).collect();
        Self { outline: base.outline.clone(), triangles }
    }

    /// Seen from the other side.
    pub(super) fn turned(mut self) -> Self {
        self.outline.reverse();
        self.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        self
    }

    pub(super) fn moved(mut self, by: Point3) -> Self {
        self.map(|p| [p[0] + by[0], p[1] + by[1], p[2] + by[2]]);
        self
    }

    pub(super) fn map(&mut self, f: impl Fn(Point3) -> Point3) {
        self.outline.iter_mut().chain(self.triangles.iter_mut().flatten()).for_each(|p| *p = f(*p));
    }
}

/// Any triangle between eyes and plane.
pub(super) fn triangle(random: &mut Random) -> Shape {
    let wide = random.pick(&[3, 6, 12]);
    Shape::fan((0..3).map(|_| [random.eighth(-wide, wide), random.eighth(-wide, wide), random.eighth(2, 7)]).collect())
}

/// A triangle around the axis, with coordinates that use all bits.
pub(super) fn uneven(random: &mut Random) -> Shape {
    let mut at =
        |x: f64, y: f64| [x + random.between(-1.5, 1.5), y + random.between(-1.5, 1.5), random.between(2.0, 7.0)];
    Shape::fan(vec![at(-6.0, -4.0), at(0.0, 7.0), at(6.0, -4.0)])
}

/// A rectangle parallel to the plane.
pub(super) fn parallel(random: &mut Random) -> Shape {
    let z = random.eighth(2, 7);
    rectangle(random, z, [0.0; 2])
}

/// A rectangle that is tilted, or not.
pub(super) fn tilted(random: &mut Random) -> Shape {
    let tilt = [random.eighth(-1, 1) / 2.0, random.eighth(-1, 1) / 2.0];
    let z = random.eighth(4, 6);
    rectangle(random, z, tilt)
}

fn rectangle(random: &mut Random, z: f64, tilt: [f64; 2]) -> Shape {
    let low = [random.eighth(-5, 0), random.eighth(-5, 0)];
    let high = [low[0] + random.eighth(1, 6), low[1] + random.eighth(1, 6)];
    Shape::rectangle(low, high, z, tilt)
}

/// Four corners that are hardly ever in one plane, or a low tent with a corner inside.
pub(super) fn bent(random: &mut Random) -> Shape {
    let mut shape = parallel(random);
    if random.coin() {
        let [p, q] = [shape.outline[0], shape.outline[2]];
        let top = [(p[0] + q[0]) / 2.0, (p[1] + q[1]) / 2.0, p[2] + random.eighth(-1, 1) / 2.0];
        return Shape::tent(&shape, top);
    }
    shape.outline.iter_mut().for_each(|p| p[2] += random.eighth(-1, 1) / 2.0);
    Shape::fan(shape.outline)
}

/// Flat shapes with a corner that turns the other way.
pub(super) fn non_convex(random: &mut Random) -> Shape {
    let z = random.eighth(2, 6);
    let notch = random.eighth(1, 3);
    let rise = random.pick(&[0.0, 0.125, -0.25]);
    // From the corner that turns, which comes first, all of the shape is seen.
    let mut shape = Shape::fan(vec![[notch, notch, z], [-4.0, 5.0, z], [5.0, 5.0, z], [5.0, -4.0, z]]);
    shape.map(|p| [p[0], p[1], p[2] + rise * p[0]]);
    shape
}

/// All but without area.
pub(super) fn sliver(random: &mut Random) -> Shape {
    let width = random.pick(&[1e-3, 1e-9, f64::EPSILON]);
    let (x, y, z) = (random.eighth(-1, 1), random.eighth(-1, 1), random.eighth(2, 7));
    let shape = match random.below(3) {
        0 => vec![[x, -4.0, z], [x, 4.0, z], [x + width, 0.0, z]],
        1 => vec![[-5.0, y, z], [5.0, y + width, z], [5.0, y, z + 1.0]],
        _ => vec![[x, y, z], [x, y, z + 1.0], [x + 1.0, y, z]],
    };
    Shape::fan(shape)
}
