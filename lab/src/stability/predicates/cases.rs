//! Cases that are nearly undecided: at any place, of any size, as near as one unit in the last place.

use sightlines::geometry::{Point2, Point3, Random, orient3d, polygon::is_convex_ccw};

/// The points that a predicate is tested with.
pub(crate) type Case = Vec<Point3>;

/// Where cases lie, and how near to undecided.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place {
    /// How far from the origin, in units of `scale`.
    pub(crate) far: f64,
    /// Size of a case.
    pub(crate) scale: f64,
    /// How far what decides is moved from where nothing would be decided.
    pub(crate) apart: Apart,
}

/// A distance.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Apart {
    /// Units in the last place of one coordinate.
    Ulps(i64),
    /// A part of the size of the case.
    Part(f64),
}

impl Place {
    /// A point of a case of size 1 around the origin, where it belongs. Rounded.
    fn put(&self, p: Point3) -> Point3 {
        // Away from the axes, so that no coordinate stays small.
        let away = [self.far, -0.71 * self.far, 0.43 * self.far];
        std::array::from_fn(|k| (p[k] + away[k]) * self.scale)
    }

    /// A point moved along a direction of length about 1, or against it.
    fn moved(&self, p: Point3, way: Point3, random: &mut Random) -> Point3 {
        let sign = if random.below(2) == 0 { 1.0 } else { -1.0 };
        match self.apart {
            Apart::Part(part) => std::array::from_fn(|k| p[k] + sign * part * self.scale * way[k]),
            Apart::Ulps(n) => {
                let k = (1..3).fold(0, |best, k| if way[k].abs() > way[best].abs() { k } else { best });
                let mut p = p;
                let up = sign * way[k] > 0.0;
                // Steps of the bits go away from 0.
                let steps = if (p[k] > 0.0) == up { n } else { -n };
                p[k] = f64::from_bits(p[k].to_bits().wrapping_add_signed(steps));
                p
            }
        }
    }
}

fn plus(a: Point3, b: Point3, t: f64) -> Point3 {
    std::array::from_fn(|k| a[k] + (b[k] - a[k]) * t)
}

fn unit(v: Point3) -> Point3 {
    let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    v.map(|x| x / length)
}

fn normal([a, b, c]: [Point3; 3]) -> Point3 {
    let [u, v] = [b, c].map(|p| [p[0] - a[0], p[1] - a[1], p[2] - a[2]]);
    unit([u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]])
}

/// The direction to the left of the line from `a` to `b`.
fn left(a: Point3, b: Point3) -> Point3 {
    unit([a[1] - b[1], b[0] - a[0], 0.0])
}

/// A random point of the plane of x and y.
fn flat(random: &mut Random) -> Point3 {
    [random.unit(), random.unit(), 0.0]
}

fn solid(random: &mut Random) -> Point3 {
    [random.unit(), random.unit(), random.unit()]
}

/// The plane is that of x and y.
fn dropped(p: Point3) -> Point3 {
    [p[0], p[1], 0.0]
}

/// Three points nearly on a line.
pub(crate) fn line(place: Place, random: &mut Random) -> Case {
    let [a, b] = [flat(random), flat(random)].map(|p| dropped(place.put(p)));
    let c = plus(a, b, 2.0 * random.unit() - 0.5);
    vec![a, b, place.moved(c, left(a, b), random)]
}

/// Four points nearly in a plane.
pub(crate) fn plane(place: Place, random: &mut Random) -> Case {
    let [a, b, c] = [solid(random), solid(random), solid(random)].map(|p| place.put(p));
    let d = plus(plus(a, b, 2.0 * random.unit() - 0.5), c, 2.0 * random.unit() - 0.5);
    vec![a, b, c, place.moved(d, normal([a, b, c]), random)]
}

/// The corners of a convex polygon, counter-clockwise, and a point near one of its sides.
pub(crate) fn polygon(place: Place, random: &mut Random) -> Case {
    const ROUND: [[f64; 2]; 6] = [[0.5, 0.0], [0.3, 0.4], [-0.2, 0.5], [-0.5, 0.0], [-0.3, -0.4], [0.2, -0.5]];
    loop {
        let mut out: Case = ROUND
            .iter()
            .map(|p| dropped(place.put([p[0] + 0.1 * random.unit(), p[1] + 0.1 * random.unit(), 0.0])))
            .collect();
        let corners: Vec<Point2> = out.iter().map(|p| Point2::new(p[0], p[1])).collect();
        if !is_convex_ccw(&corners) {
            continue;
        }
        let i = random.below(out.len());
        let (a, b) = (out[i], out[(i + 1) % out.len()]);
        let p = plus(a, b, 0.05 + 0.9 * random.unit());
        out.push(place.moved(p, left(a, b), random));
        return out;
    }
}

/// The ends of two segments, of which one nearly ends on the other, or nearly passes its end.
pub(crate) fn segments(place: Place, random: &mut Random) -> Case {
    let [a, b] = [flat(random), flat(random)].map(|p| dropped(place.put(p)));
    let across = left(a, b);
    let reach = place.scale * (0.2 + random.unit());
    let aslant = unit(std::array::from_fn(|k| (b[k] - a[k]) / place.scale));
    let way: Point3 = std::array::from_fn(|k| across[k] + 0.7 * (random.unit() - 0.5) * aslant[k]);
    let from = |p: Point3, t: f64| -> Point3 { std::array::from_fn(|k| p[k] + t * reach * way[k]) };
    if random.below(2) == 0 {
        let on = plus(a, b, 0.1 + 0.8 * random.unit());
        let c = place.moved(on, across, random);
        vec![a, b, c, from(on, 1.0)]
    } else {
        // The wall ends at b; the line of sight passes there.
        vec![a, place.moved(b, aslant, random), from(b, -0.6), from(b, 1.0)]
    }
}

/// The eight corners of a box.
pub(crate) fn corners(min: Point3, max: Point3) -> [Point3; 8] {
    std::array::from_fn(|i| std::array::from_fn(|k| if i >> k & 1 == 0 { min[k] } else { max[k] }))
}

/// The lower and the upper corner of a volume of eyes, the ends of an edge before it, and a point behind that nearly lies in the
/// plane through the edge and the corner that decides.
pub(crate) fn umbra(place: Place, random: &mut Random) -> Case {
    let half = [0; 3].map(|_| 0.02 + 0.2 * random.unit());
    let [min, max] = [half.map(|h| -h), half].map(|p| place.put(p));
    let mut at =
        |depth: f64| place.put([2.0 * random.unit() - 1.0, 2.0 * random.unit() - 1.0, depth + 0.3 * random.unit()]);
    let (a, b) = (at(2.0), at(2.0));
    let farthest = corners(min, max).into_iter().reduce(|v, other| {
        let outside = orient3d(v, a, b, other) > 0.0;
        if outside { other } else { v }
    });
    let eye = farthest.expect("a box has corners");
    let on = plus(a, b, 1.6 * random.unit() - 0.3);
    let t = plus(eye, on, 1.5 + random.unit());
    vec![min, max, a, b, place.moved(t, normal([eye, a, b]), random)]
}
