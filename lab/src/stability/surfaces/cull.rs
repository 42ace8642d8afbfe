//! Culling before anything is drawn: faces that turn their backs, and what lies outside of the picture.

use crate::stability::plain::{self, Float, Kept, cross, dot, minus, rounded};
use crate::stability::predicates::cases::{self, Apart, Place};
use crate::stability::predicates::exact;
use crate::stability::predicates::powers_of_ten;
use crate::stability::{Answer, Decide, Kind, Sweep, SweepMethod};
use sightlines::geometry::{Point3, Random};
use sightlines::visible_surface::Camera;
use sightlines::visible_surface::cull::{Cover, Facing, Frustum, facing};

const EPSILON: f64 = 1e-9;

const fn naive(name: &'static str) -> SweepMethod {
    SweepMethod { name, kind: Kind::Naive }
}

fn answer(hidden: bool) -> Answer {
    if hidden { Answer::Hidden } else { Answer::Seen }
}

/// A face and an eye, as predicates have them.
fn four(case: &[Point3]) -> [Point3; 4] {
    *case.first_chunk().expect("a case has a face and an eye")
}

pub(super) type Face = Vec<Point3>;

fn back_exact(case: &Face) -> Answer {
    let [a, b, c, eye] = four(case);
    answer(facing(&[a, b, c], [eye]) == Facing::Back)
}

fn back_plain<F: Float>(case: &Face) -> Answer {
    answer(plain::side::<F>(four(case)) <= 0.0)
}

fn back_epsilon(case: &Face) -> Answer {
    answer(plain::side::<f64>(four(case)) <= EPSILON)
}

fn back_kept<F: Float>(case: &Face) -> Answer {
    let [a, b, c, eye] = four(case);
    answer(Kept::<F>::through([a, b, c]).at(rounded(eye)).wide() <= 0.0)
}

/// Whether the eye is in front of the face. Exact.
pub(super) fn is_front(case: &[Point3]) -> bool {
    exact::side(four(case)) > 0
}

/// Who culls backs.
pub(super) fn back_methods() -> Vec<Decide<Face>> {
    vec![
        (SweepMethod { name: "backface exact", kind: Kind::Shipped }, back_exact),
        (naive("backface f64"), back_plain::<f64>),
        (naive("backface f64 epsilon"), back_epsilon),
        (naive("backface f64 kept"), back_kept::<f64>),
        (naive("backface f32"), back_plain::<f32>),
        (naive("backface f32 kept"), back_kept::<f32>),
    ]
}

fn backs(texts: [&'static str; 3], levels: Vec<f64>, n: usize, place: fn(f64) -> Place) -> Sweep {
    let methods = back_methods();
    let make = move |level: f64, random: &mut Random| {
        let case = cases::plane(place(level), random);
        let open = is_front(&case);
        Some((case, open))
    };
    Sweep::of_cases(texts, levels, n, methods, make)
}

/// A camera and a small face near the edge of its picture.
#[derive(Debug, Clone)]
pub(super) struct Edge {
    pub(super) camera: Camera,
    pub(super) face: [Point3; 3],
}

/// Rays through the corners of the picture, once around.
fn corner_rays(camera: &Camera) -> [Point3; 4] {
    let [w, h] = camera.size().map(f64::from);
    [[0.0, 0.0], [w, 0.0], [w, h], [0.0, h]].map(|[x, y]| camera.ray(x, y))
}

fn outside_exact(case: &Edge) -> Answer {
    answer(Frustum::of(&case.camera).of_hull(&case.face) == Cover::Outside)
}

/// Sides of the view volume through the eye, turned inwards.
fn sides<F: Float>(camera: &Camera) -> [[F; 3]; 4] {
    let rays = corner_rays(camera).map(rounded::<F>);
    let middle = rounded::<F>(camera.ray(f64::from(camera.size()[0]) / 2.0, f64::from(camera.size()[1]) / 2.0));
    std::array::from_fn(|k| {
        let n = cross(rays[k], rays[(k + 1) % 4]);
        if dot(n, middle) < F::of(0.0) { n.map(|x| -x) } else { n }
    })
}

fn outside_plain<F: Float>(case: &Edge) -> Answer {
    let eye = rounded::<F>(case.camera.eye());
    let is_out = |n: [F; 3]| case.face.iter().all(|&p| dot(n, minus(rounded(p), eye)) < F::of(0.0));
    answer(sides::<F>(&case.camera).into_iter().any(is_out))
}

/// Sides as planes kept for later.
fn outside_kept<F: Float>(case: &Edge) -> Answer {
    let eye = rounded::<F>(case.camera.eye());
    let is_out = |n: [F; 3]| {
        let length = dot(n, n).root();
        let normal = n.map(|x| x / length);
        let plane = Kept { normal, e: -dot(normal, eye) };
        case.face.iter().all(|&p| plane.at(rounded(p)) < F::of(0.0))
    };
    answer(sides::<F>(&case.camera).into_iter().any(is_out))
}

/// A face of which one corner lies near a side of the view volume, and the others outside of it.
fn edge(place: Place, random: &mut Random) -> Option<(Edge, bool)> {
    let away = [place.far, -0.71 * place.far, 0.43 * place.far].map(|x| x * place.scale);
    let way = [random.unit() - 0.5, random.unit() - 0.5, 1.0].map(|x| x * place.scale);
    let at = std::array::from_fn(|k| away[k] + way[k]);
    let camera = Camera::look_at(away, at, [0.0, 1.0, 0.0], 50.0, [32, 24]).ok()?;
    let rays = corner_rays(&camera);
    let k = random.below(4);
    let along = 0.1 + 0.8 * random.unit();
    let depth = (4.0 + random.unit()) * place.scale;
    let (r, s) = (rays[k], rays[(k + 1) % 4]);
    let on: Point3 = std::array::from_fn(|i| away[i] + depth * (r[i] + (s[i] - r[i]) * along));
    let inwards = sides::<f64>(&camera)[k];
    let length = inwards.iter().map(|x| x * x).sum::<f64>().sqrt();
    let inwards = inwards.map(|x| x / length);
    let moved = |p: Point3, part: f64| -> Point3 { std::array::from_fn(|i| p[i] + part * place.scale * inwards[i]) };
    let sign = if random.below(2) == 0 { 1.0 } else { -1.0 };
    let first = match place.apart {
        Apart::Part(part) => moved(on, sign * part),
        Apart::Ulps(n) => {
            let i = (1..3).fold(0, |best, i| if inwards[i].abs() > inwards[best].abs() { i } else { best });
            let mut p = on;
            let steps = if (p[i] > 0.0) == (sign * inwards[i] > 0.0) { n } else { -n };
            p[i] = f64::from_bits(p[i].to_bits().wrapping_add_signed(steps));
            p
        }
    };
    let aside: Point3 = std::array::from_fn(|i| on[i] + 0.05 * depth * (s[i] - r[i]));
    let face = [first, moved(on, -0.2), moved(aside, -0.2)];
    let open = is_open(&camera, &face)?;
    Some((Edge { camera, face }, open))
}

/// Whether a corner of a face is strictly inside the view volume, or else all are outside of one side of it; nothing if neither. Exact.
pub(super) fn is_open(camera: &Camera, face: &[Point3; 3]) -> Option<bool> {
    let [corner, across, down] = exact::whole(camera.rays());
    let [w, h] = camera.size();
    let rays = [[0, 0], [w, 0], [w, h], [0, h]]
        .map(|[x, y]| std::array::from_fn::<_, 3, _>(|k| &corner[k] + &across[k] * x + &down[k] * y));
    let middle: exact::Whole3 = std::array::from_fn(|k| &corner[k] * 2 + &across[k] * w + &down[k] * h);
    let points = exact::whole([camera.eye(), face[0], face[1], face[2]]);
    let ways: [exact::Whole3; 3] = std::array::from_fn(|i| std::array::from_fn(|k| &points[i + 1][k] - &points[0][k]));
    let signs: Vec<[i32; 3]> = (0..4)
        .map(|k| {
            let (r, s) = (&rays[k], &rays[(k + 1) % 4]);
            let inside = exact::product([r, s, &middle]);
            [0, 1, 2].map(|i| inside * exact::product([r, s, &ways[i]]))
        })
        .collect();
    if (0..3).any(|i| signs.iter().all(|s| s[i] > 0)) {
        Some(true)
    } else if signs.iter().any(|s| s.iter().all(|&s| s < 0)) {
        Some(false)
    } else {
        None
    }
}

/// Who culls what is outside of the picture.
pub(super) fn edge_methods() -> Vec<Decide<Edge>> {
    vec![
        (SweepMethod { name: "view volume", kind: Kind::Shipped }, outside_exact),
        (naive("view volume f64"), outside_plain::<f64>),
        (naive("view volume f64 kept"), outside_kept::<f64>),
        (naive("view volume f32"), outside_plain::<f32>),
        (naive("view volume f32 kept"), outside_kept::<f32>),
    ]
}

fn edges(texts: [&'static str; 3], levels: Vec<f64>, n: usize, place: fn(f64) -> Place) -> Sweep {
    Sweep::of_cases(texts, levels, n, edge_methods(), move |level, random| edge(place(level), random))
}

/// All sweeps of culling.
pub(super) fn sweeps(quick: bool) -> Vec<Sweep> {
    let (n, step) = if quick { (4000, 3) } else { (20_000, 1) };
    let ulps = || (0..=28).step_by(2 * step).map(|e| f64::from(1u32 << e)).collect::<Vec<f64>>();
    let far = |level: f64| Place { far: level, scale: 1.0, apart: Apart::Part(1e-3) };
    let near = |level: f64| Place { far: 0.0, scale: 1.0, apart: Apart::Ulps(level as i64) };
    vec![
        backs(
            [
                "surface-backface-distance",
                "A face and an eye a thousandth of the face's size in front of its plane or behind, far from the origin. Hidden is what is culled: \
                 a front that the eye sees is open. The truth is in whole numbers.",
                "distance from the origin (sizes)",
            ],
            powers_of_ten(0, 9, step),
            n,
            far,
        ),
        backs(
            [
                "surface-backface-ulps",
                "The same at the origin, with the eye some units in the last place from the plane.",
                "moved by (units in the last place)",
            ],
            ulps(),
            n,
            near,
        ),
        edges(
            [
                "surface-frustum-distance",
                "A face of which one corner lies a thousandth of a unit inside of a side of the view volume, or all of it outside, far from the \
                 origin. Hidden is what is culled. The truth is in whole numbers.",
                "distance from the origin (units)",
            ],
            powers_of_ten(0, 9, step),
            n,
            far,
        ),
        edges(
            [
                "surface-frustum-ulps",
                "The same at the origin, with that corner some units in the last place from the side.",
                "moved by (units in the last place)",
            ],
            ulps(),
            n,
            |level| Place { far: 0.37, scale: 1.0, apart: Apart::Ulps(level as i64) },
        ),
    ]
}
