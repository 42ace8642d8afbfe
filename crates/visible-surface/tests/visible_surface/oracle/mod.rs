//! What each pixel shows, by brute force: every ray against every face, in whole numbers of any size.
//!
//! Shares nothing with the methods but the meaning of a pixel, the rule of left and upper edges, and that the lower id is seen of faces at
//! one depth. Positions and rays are scaled by powers of two until they are whole numbers, so nothing is rounded.
use num_bigint::{BigInt, Sign};
use sightlines_geometry::Point3;
use sightlines_visible_surface::{
    Camera, Counters, FaceMask, Faces, Image, NOTHING, RenderInput, RenderOutput, VisibleSurface,
};

/// The impostor of a method that draws front to back: its order is taken for back to front.
#[derive(Debug)]
pub(crate) struct Swapped<M>(pub(crate) M);

impl<M: VisibleSurface> VisibleSurface for Swapped<M> {
    fn name(&self) -> &'static str {
        "swapped"
    }

    fn see(&self, input: &RenderInput<'_>, counters: &mut Counters) -> RenderOutput {
        match self.0.see(input, counters) {
            RenderOutput::FrontToBack(fragments) => RenderOutput::BackToFront(fragments),
            other => other,
        }
    }
}

/// What is seen, and where that is a matter of rules.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Truth {
    /// Pixels to the right and down.
    pub(crate) size: [u32; 2],
    /// For each pixel, row by row, the face that is seen.
    pub(crate) faces: Vec<Option<u32>>,
    /// Whether the ray meets the edge of a face, or a face just where the depths that are seen begin or end. `faces` holds there too, by the
    /// rule of left and upper edges.
    pub(crate) on_edge: Vec<bool>,
    /// Whether the nearest faces at the pixel are at one depth without lying in one plane there: the ray meets the line in which they
    /// pass through each other, or an edge that they share. Only there `faces` need not be what a method shows.
    pub(crate) crossing: Vec<bool>,
}

impl Truth {
    /// The pixels in which a picture is wrong: x, y, what is seen, what the picture shows.
    pub(crate) fn wrong(&self, image: &Image) -> Vec<([u32; 2], Option<u32>, Option<u32>)> {
        assert_eq!(self.size, image.size(), "only pictures of one size are compared");
        let shown = image.faces().iter().map(|&f| (f != NOTHING).then_some(f));
        let all = (0u32..).zip(self.faces.iter().zip(shown)).zip(&self.crossing);
        let wrong = all.filter(|((_, (truth, shown)), doubt)| **truth != *shown && !**doubt);
        wrong.map(|((i, (truth, shown)), _)| ([i % self.size[0], i / self.size[0]], *truth, shown)).collect()
    }

    /// How many pixels are left out of comparisons.
    pub(crate) fn n_in_doubt(&self) -> usize {
        self.crossing.iter().filter(|d| **d).count()
    }

    /// How many pixels show a face.
    pub(crate) fn n_covered(&self) -> usize {
        self.faces.iter().flatten().count()
    }
}

/// Methods show what is seen of all faces, and of those that are kept, and draw no others.
pub(crate) fn check(faces: &Faces, camera: &Camera, keep: impl FnMut(u32) -> bool, methods: &[&dyn VisibleSurface]) {
    let mut kept = FaceMask::all(faces);
    kept.retain(keep);
    for chosen in [FaceMask::all(faces), kept] {
        let truth = look(faces, camera, &chosen);
        let input = RenderInput { faces, camera, mask: &chosen };
        for method in methods {
            let (image, counters) = method.picture(&input);
            assert_eq!(truth.wrong(&image), [], "{} of {:?}", method.name(), faces);
            assert!(counters.polygons <= chosen.len() as u64, "{}", method.name());
        }
    }
}

/// What is seen of some faces. Cost: pixels times faces.
pub(crate) fn look(faces: &Faces, camera: &Camera, chosen: &FaceMask) -> Truth {
    let size = camera.size();
    let n = size[0] as usize * size[1] as usize;
    let scale = Scale::of(faces, camera);
    let all: Vec<Face> = chosen.iter().filter_map(|f| Face::new(faces, camera, &scale, f)).collect();
    let mut truth = Truth { size, faces: vec![None; n], on_edge: vec![false; n], crossing: vec![false; n] };
    for (i, (x, y)) in (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y))).enumerate() {
        let mut nearest: Vec<Hit<'_>> = Vec::new();
        for face in &all {
            let Some(hit) = face.meets(x, y, &mut truth.on_edge[i]) else { continue };
            // v / nd against v' / nd', all positive.
            let order = nearest.first().map(|best| (&hit.above * &best.below).cmp(&(&best.above * &hit.below)));
            match order {
                None | Some(std::cmp::Ordering::Less) => nearest = vec![hit],
                Some(std::cmp::Ordering::Equal) => nearest.push(hit),
                Some(std::cmp::Ordering::Greater) => {}
            }
        }
        truth.faces[i] = nearest.iter().map(|h| h.face.id).min();
        truth.crossing[i] = nearest.windows(2).any(|w| !w[0].face.is_coplanar(w[1].face));
    }
    truth
}

/// A place where a ray meets a face, at depth `above / below`.
struct Hit<'a> {
    face: &'a Face,
    above: BigInt,
    below: BigInt,
}

type Vector = [BigInt; 3];

/// A linear function of the pixel: `a (2x + 1) + b (2y + 1) + 2c`.
struct Line([BigInt; 3]);

impl Line {
    fn new(normal: &Vector, rays: &[Vector; 3]) -> Self {
        Self([&rays[1], &rays[2], &rays[0]].map(|v| dot(normal, v)))
    }

    fn at(&self, x: u32, y: u32) -> BigInt {
        let [a, b, c] = &self.0;
        a * (2 * x + 1) + b * (2 * y + 1) + c * 2
    }

    fn flipped(self) -> Self {
        Self(self.0.map(|v| -v))
    }

    /// Whether a pixel is inside; notes whether it is on the line itself.
    fn has(&self, x: u32, y: u32, on_line: &mut bool) -> bool {
        let value = self.at(x, y);
        *on_line |= value.sign() == Sign::NoSign;
        let first = [&value, &self.0[0], &self.0[1]].into_iter().find(|v| v.sign() != Sign::NoSign);
        first.is_some_and(|v| v.sign() == Sign::Plus)
    }
}

/// A face as the eye sees it: turned to it, the eye is the origin.
struct Face {
    id: u32,
    corners: [Vector; 3],
    normal: Vector,
    /// `normal · corner`, positive.
    value: BigInt,
    /// `normal · direction`, positive where the ray goes to the plane.
    towards: Line,
    edges: [Line; 3],
    depths: Vec<Line>,
}

impl Face {
    /// None if it is edge-on or has no area.
    fn new(faces: &Faces, camera: &Camera, scale: &Scale, id: u32) -> Option<Self> {
        let eye = scale.position(camera.eye());
        let corners = faces.of(id).map(|p| minus(&scale.position(p), &eye));
        let rays = camera.rays().map(|v| scale.ray(v));
        let [a, b, c] = &corners;
        let normal = cross(&minus(b, a), &minus(c, a));
        let value = dot(&normal, a);
        let sign = value.sign();
        if sign == Sign::NoSign {
            return None;
        }
        // Turned so that the normal points away from the eye.
        let turned = |line: Line| if sign == Sign::Minus { line.flipped() } else { line };
        let edges = [(a, b), (b, c), (c, a)].map(|(p, q)| turned(Line::new(&cross(p, q), &rays)));
        let towards = turned(Line::new(&normal, &rays));
        let (normal, value) = if sign == Sign::Minus { (normal.map(|x| -x), -value) } else { (normal, value) };
        // The depth, value / towards, is at least `near` where value - near * towards >= 0.
        let depth = |depth: f64| {
            let depth = scale.depth(depth);
            let [a, b, c] = &towards.0;
            Line([-(a * &depth.0), -(b * &depth.0), &value * &depth.1 - c * &depth.0])
        };
        let [near, far] = camera.depths();
        let mut depths = Vec::new();
        if near > 0.0 {
            depths.push(depth(near));
        }
        if far < f64::INFINITY {
            depths.push(depth(far).flipped());
        }
        Some(Self { id, corners: corners.clone(), normal, value, towards, edges, depths })
    }

    fn meets(&self, x: u32, y: u32, on_edge: &mut bool) -> Option<Hit<'_>> {
        let below = self.towards.at(x, y);
        if below.sign() != Sign::Plus {
            return None;
        }
        let mut on_line = false;
        let mut inside = true;
        // Beyond the first edge that the ray misses for sure it is on none.
        for line in self.edges.iter().chain(&self.depths) {
            let mut on = false;
            let has = line.has(x, y, &mut on);
            on_line |= on;
            inside &= has;
            if !has && !on {
                return None;
            }
        }
        *on_edge |= on_line;
        // `towards` is twice what it is of the ray, for every face alike.
        inside.then(|| Hit { face: self, above: self.value.clone(), below })
    }

    fn is_coplanar(&self, other: &Self) -> bool {
        other.corners.iter().all(|p| dot(&self.normal, p) == self.value)
    }
}

/// Powers of two that make whole numbers of all positions, and of all rays.
struct Scale {
    position: i32,
    ray: i32,
}

impl Scale {
    fn of(faces: &Faces, camera: &Camera) -> Self {
        let least =
            |all: &mut dyn Iterator<Item = f64>| all.filter(|x| *x != 0.0).map(|x| parts(x).1).min().unwrap_or(0);
        let eye = camera.eye();
        let mut positions = faces.corners().iter().flatten().flatten().chain(&eye).copied();
        let rays = camera.rays();
        let mut directions = rays.iter().flatten().copied();
        Self { position: least(&mut positions), ray: least(&mut directions) }
    }

    fn position(&self, p: Point3) -> Vector {
        p.map(|x| whole(x, self.position))
    }

    fn ray(&self, v: Point3) -> Vector {
        v.map(|x| whole(x, self.ray))
    }

    /// A depth as numerator and denominator, in units of scaled positions over scaled rays.
    fn depth(&self, depth: f64) -> (BigInt, BigInt) {
        let (mantissa, exponent) = parts(depth);
        let shift = exponent + self.ray - self.position;
        let up = BigInt::from(mantissa) << shift.max(0) as u32;
        (up, BigInt::from(1) << (-shift).max(0) as u32)
    }
}

/// Mantissa and exponent of a double, the mantissa odd or 0.
fn parts(x: f64) -> (i64, i32) {
    if x == 0.0 {
        return (0, 0);
    }
    let bits = x.to_bits();
    let exponent = ((bits >> 52) & 0x7ff) as i32;
    let fraction = (bits & ((1 << 52) - 1)) as i64;
    let (mantissa, exponent) = if exponent == 0 { (fraction, -1074) } else { (fraction | 1 << 52, exponent - 1075) };
    let zeros = mantissa.trailing_zeros();
    let mantissa = mantissa >> zeros;
    (if x < 0.0 { -mantissa } else { mantissa }, exponent + zeros as i32)
}

fn whole(x: f64, least: i32) -> BigInt {
    let (mantissa, exponent) = parts(x);
    if mantissa == 0 { BigInt::ZERO } else { BigInt::from(mantissa) << (exponent - least) as u32 }
}

fn minus(a: &Vector, b: &Vector) -> Vector {
    [0, 1, 2].map(|k| &a[k] - &b[k])
}

fn dot(a: &Vector, b: &Vector) -> BigInt {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

fn cross(a: &Vector, b: &Vector) -> Vector {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| &a[i] * &b[j] - &a[j] * &b[i])
}
