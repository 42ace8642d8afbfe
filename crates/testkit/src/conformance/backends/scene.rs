//! Scenes of all kinds, most of them degenerate.

use super::Random;
use super::shapes::{self, Shape};
use sightlines_geometry::{Aabb, Point3};
use sightlines_multifocal::{BufferJob, BufferPlane, Measure, Occluder, Volume};

/// Kinds of scenes.
pub(super) const FAMILIES: [Family; 17] = [
    ("triangles", |r| several(r, shapes::triangle)),
    ("sweep", sweep),
    ("uneven", |r| several(r, shapes::uneven)),
    ("parallel", |r| several(r, shapes::parallel)),
    ("tilted", |r| several(r, shapes::tilted)),
    ("bent", |r| several(r, shapes::bent)),
    ("non-convex", |r| several(r, shapes::non_convex)),
    ("slivers", |r| several(r, shapes::sliver)),
    ("through-volume", through_volume),
    ("through-plane", through_plane),
    ("edge-on", edge_on),
    ("tiny", |r| several(r, tiny)),
    ("huge", |r| several(r, huge)),
    ("far", far),
    ("touching", touching),
    ("slit", slit),
    ("elsewhere", elsewhere),
];

/// The name of a kind of scenes, and how they are drawn.
pub(super) type Family = (&'static str, fn(&mut Random) -> Sketch);

/// A scene as drawn, in the frame of [`shapes`].
#[derive(Debug, Clone)]
pub(super) struct Sketch {
    shapes: Vec<Shape>,
    eyes: Aabb<3>,
    /// Heights of the planes along z, ascending.
    planes: Vec<f64>,
    offset: Point3,
    scale: f64,
    /// Any grid, if `None`.
    grid: Option<Grid>,
    /// Whether planes are always carried over; otherwise in every other scene.
    sweeps: bool,
}

/// A scene: the input of a job without the measure.
#[derive(Debug, Clone)]
pub(super) struct Scene {
    pub(super) family: &'static str,
    pub(super) seed: u64,
    pub(super) round: u32,
    pub(super) volume: Volume,
    pub(super) planes: Vec<BufferPlane>,
    pub(super) occluders: Vec<Occluder>,
    carry: bool,
}

impl Scene {
    pub(super) fn draw((family, draw): Family, seed: u64, round: u32) -> Self {
        let name = family.bytes().fold(seed, |h, b| h.wrapping_mul(0x100_0000_01b3) ^ u64::from(b));
        let mut random = Random::new(name.wrapping_add(u64::from(round) << 32));
        let sketch = draw(&mut random);
        let frame = Frame::draw(&mut random, &sketch);
        let grid = sketch.grid.unwrap_or_else(|| Grid::draw(&mut random, round));
        let volume = Volume::new(frame.place_box(&sketch.eyes)).expect("eyes are in a box");
        let planes = sketch.planes.iter().map(|&z| frame.plane(z, grid)).collect();
        let carry = sketch.sweeps || round.is_multiple_of(2);
        let occluders = sketch.shapes.into_iter().filter_map(|mut shape| {
            if random.coin() {
                shape = shape.turned();
            }
            shape.map(|p| frame.place(p));
            // A shape without area is not a valid occluder, and may be drawn.
            Occluder::patch(shape.outline, &shape.triangles).ok()
        });
        let occluders = occluders.collect();
        Self { family, seed, round, volume, planes, occluders, carry }
    }

    /// The job of the whole scene; planes are carried over only if the measure allows it.
    pub(super) fn job(&self, measure: Measure) -> BufferJob<'_> {
        let carry = self.carry && measure.is_height();
        BufferJob::new(self.volume, self.planes.clone(), &self.occluders, measure, carry).expect("scenes make jobs")
    }
}

/// The position of the shapes' frame in space.
struct Frame {
    axis: usize,
    positive: bool,
    offset: Point3,
    scale: f64,
}

impl Frame {
    fn draw(random: &mut Random, sketch: &Sketch) -> Self {
        let axis = random.below(3);
        Self { axis, positive: random.coin(), offset: sketch.offset, scale: sketch.scale }
    }

    /// A mirror image, where it looks against the axis: outlines and triangles then turn the other way together.
    fn place(&self, p: Point3) -> Point3 {
        let mut q = self.offset;
        q[(self.axis + 1) % 3] += p[0] * self.scale;
        q[(self.axis + 2) % 3] += p[1] * self.scale;
        q[self.axis] += if self.positive { p[2] } else { -p[2] } * self.scale;
        q
    }

    fn place_box(&self, b: &Aabb<3>) -> Aabb<3> {
        Aabb::around([self.place(b.min), self.place(b.max)])
    }

    fn plane(&self, z: f64, grid: Grid) -> BufferPlane {
        let [w, h] = grid.texels.map(f64::from);
        let place = |x: f64, y: f64| self.place([x * grid.step[0], y * grid.step[1], z]);
        let (low, high) = (place(-(w / 2.0).floor(), -(h / 2.0).floor()), place((w / 2.0).ceil(), (h / 2.0).ceil()));
        let across = |p: Point3| [p[(self.axis + 1) % 3], p[(self.axis + 2) % 3]];
        let plane = BufferPlane::new(self.axis, self.positive, low[self.axis], across(low), across(high), grid.texels);
        plane.expect("a window with texels")
    }
}

/// Texels of all planes: of sizes that double for grids that are exact.
#[derive(Debug, Clone, Copy)]
struct Grid {
    texels: [u32; 2],
    step: [f64; 2],
}

impl Grid {
    /// In one round of four wider than a block of 64, which is how many texels some backends do at once.
    fn draw(random: &mut Random, round: u32) -> Self {
        let step = [0, 1].map(|_| random.pick(&[0.25, 0.375, 0.5, 1.0, 2.0]));
        let texels = [0, 1].map(|_| 1 + random.below(14) as u32);
        Self { texels: if round % 4 == 3 { [60 + texels[0], texels[1]] } else { texels }, step }
    }
}

/// A box, a rectangle, a segment or a point around the origin.
fn eyes(random: &mut Random) -> Aabb<3> {
    let low = [0, 1, 2].map(|_| random.eighth(-1, 1));
    let size = [0, 1, 2].map(|_| random.pick(&[0.0, 0.125, 0.25, 0.5, 1.0]));
    Aabb { min: low, max: [0, 1, 2].map(|k| low[k] + size[k]) }
}

fn sketch(random: &mut Random, shapes: Vec<Shape>) -> Sketch {
    let n_planes = random.pick(&[1, 1, 2, 3]);
    let mut planes = vec![8.0];
    for k in 1..n_planes {
        planes.push(planes[k - 1] + random.pick(&[0.125, 1.0, 4.0, 5.5]));
    }
    let scale = random.pick(&[1.0, 1.0, 1.0 / 1024.0, 4096.0]);
    Sketch { shapes, eyes: eyes(random), planes, offset: [0.0; 3], scale, grid: None, sweeps: false }
}

fn several(random: &mut Random, shape: fn(&mut Random) -> Shape) -> Sketch {
    let n = random.pick(&[1, 2, 4]);
    let shapes = (0..n).map(|_| shape(random)).collect();
    sketch(random, shapes)
}

/// Shapes that cut, touch or contain the volume, and one that does not.
fn through_volume(random: &mut Random) -> Sketch {
    let z = random.eighth(-1, 1);
    let mut scene = several(random, shapes::parallel);
    let b = scene.eyes;
    let wall = |z: f64, tilt: f64| Shape::rectangle([-6.0, -6.0], [6.0, 6.0], z, [tilt, 0.0]);
    let through = [wall(z, 0.0), wall(b.max[2], 0.0), wall(b.min[2], 0.25), wall(b.max[2] + 0.125, 0.0)];
    scene.shapes.insert(0, through[random.below(4)].clone());
    scene
}

/// Shapes that cut the planes, lie in them, or touch them with an edge or a corner.
fn through_plane(random: &mut Random) -> Sketch {
    let mut scene = several(random, shapes::tilted);
    let (x, z) = (random.eighth(-2, 2), random.pick(&scene.planes));
    let shape = match random.below(4) {
        // Lies in it.
        0 => Shape::rectangle([-3.0, -3.0], [x + 3.0, 4.0], z, [0.0; 2]),
        // Ends on it.
        1 => Shape::rectangle([-5.0, -5.0], [5.0, 5.0], z - 2.5, [0.5, 0.0]),
        // Cuts it.
        2 => Shape::rectangle([x - 6.0, -6.0], [x + 6.0, 6.0], z, [0.25, random.eighth(-1, 1) / 4.0]),
        // Touches it with a corner.
        _ => Shape::fan(vec![[-6.0, -5.0, z - 2.0], [x, 6.0, z], [6.0, -5.0, z - 1.0]]),
    };
    scene.shapes.insert(0, shape);
    scene
}

/// Shapes whose planes contain eyes, or the direction of sight, or touch the volume from outside.
fn edge_on(random: &mut Random) -> Sketch {
    let mut scene = several(random, shapes::triangle);
    let b = scene.eyes;
    let x = random.pick(&[b.min[0], b.max[0], b.max[0] + 0.125, (b.min[0] + b.max[0]) / 2.0]);
    let upright = Shape::fan(vec![[x, -6.0, 2.0], [x, 6.0, 2.0], [x, 6.0, 9.0], [x, -6.0, 9.0]]);
    // A roof that falls away from the eyes, so that its plane goes through their upper edge or just past it.
    let steep = [b.max[0], b.max[0] + 1.0, b.max[0] + 1.0, b.max[0]];
    let fall = random.pick(&[0.0, 0.125]);
    let roof =
        steep.into_iter().zip([-6.0, -6.0, 6.0, 6.0]).map(|(x, y)| [x + fall, y, b.max[2] + 8.0 * (x - b.max[0])]);
    scene.shapes.insert(0, if random.coin() { upright } else { Shape::fan(roof.collect()) });
    scene
}

fn tiny(random: &mut Random) -> Shape {
    let mut shape = shapes::triangle(random);
    let scale = random.pick(&[1.0 / 64.0, 1e-6, 2f64.powi(-100)]);
    let z = random.eighth(2, 7);
    shape.map(|p| [p[0] * scale, p[1] * scale, z + p[2] * scale]);
    shape
}

fn huge(random: &mut Random) -> Shape {
    let scale = random.pick(&[64.0, 1e6, 2f64.powi(60)]);
    let mut shape = Shape::rectangle([-6.0, -5.0], [7.0, 6.0], 0.0, [random.eighth(-1, 1) / scale, 0.0]);
    let z = random.eighth(3, 6);
    shape.map(|p| [p[0] * scale, p[1] * scale, z + p[2]]);
    shape
}

/// A million units from the origin, where doubles are 2^-32 apart.
fn far(random: &mut Random) -> Sketch {
    let shape = random.pick(&[shapes::uneven as fn(&mut Random) -> Shape, shapes::tilted, shapes::bent]);
    let mut scene = several(random, shape);
    scene.offset = [1e6, -1e6, random.pick(&[1e6, 1e6 + 0.1])];
    scene.scale = random.pick(&[1.0, 1.0 / 64.0]);
    scene
}

/// Rectangles that share edges, twice the same, and one on top of another.
fn touching(random: &mut Random) -> Sketch {
    let z = random.eighth(3, 6);
    let x = random.eighth(-1, 1);
    let left = Shape::rectangle([-6.0, -6.0], [x, 6.0], z, [0.0; 2]);
    let right = Shape::rectangle([x, -6.0], [6.0, 6.0], z, [0.0; 2]);
    let above = left.clone().moved([0.0, 0.0, random.pick(&[0.0, 0.125])]);
    sketch(random, vec![left, right, above])
}

/// Two walls with a slit between, through which some eyes see but no corner of the volume does: each corner has all of
/// the middle blocked, by one wall or by the other.
fn slit(random: &mut Random) -> Sketch {
    let half = random.pick(&[0.25, 0.125]);
    let z = random.eighth(3, 5);
    let left = Shape::rectangle([-20.0, -20.0], [-half, 20.0], z, [0.0; 2]);
    let right = Shape::rectangle([half, -20.0], [20.0, 20.0], z, [0.0; 2]);
    let mut scene = sketch(random, vec![left, right]);
    scene.eyes = Aabb { min: [-1.0, -0.5, -0.5], max: [1.0, 0.5, 0.5] };
    scene
}

/// Behind the eyes, beside them, behind the planes, and between the planes.
fn elsewhere(random: &mut Random) -> Sketch {
    let mut scene = several(random, shapes::tilted);
    let by = [random.pick(&[-10.0, 0.0, 2.0]), 0.0, random.pick(&[-10.0, 4.0, 6.0, 20.0])];
    scene.shapes = scene.shapes.into_iter().map(|s| s.moved(by)).collect();
    scene
}

/// Several planes, and walls that overlap: together they block texels that none blocks alone.
///
/// Let the walls overlap by `o`, eyes be `2 a` wide, texels `w`, and let a line to a plane cross a wall at a part `t` of its
/// way. By one wall or the other all texels are blocked if `o >= 2 a t + w (1 - t)`, which holds for the first plane (`t` at
/// most 1 / 7.5); in between, some are blocked by none if `o < 2 a t`, which holds for the last (`t` at least 5.5 / 13.5).
fn sweep(random: &mut Random) -> Sketch {
    let x = random.eighth(-1, 1);
    let left = Shape::rectangle([-20.0, -20.0], [x + 0.375, 20.0], 7.0, [0.0; 2]);
    let right = Shape::rectangle([x - 0.375, -20.0], [20.0, 20.0], random.pick(&[7.25, 7.5]), [0.0; 2]);
    let mut shapes = vec![left, right];
    shapes.extend((0..random.below(2)).map(|_| shapes::triangle(random)));
    let mut scene = sketch(random, shapes);
    scene.eyes = Aabb { min: [-1.0, -0.5, -0.5], max: [1.0, 0.5, 0.5] };
    scene.planes = vec![8.0, 8.0 + random.pick(&[0.25, 1.0]), 13.0];
    let texels = [12 + random.below(6) as u32, 4 + random.below(4) as u32];
    scene.grid = Some(Grid { texels, step: [0.5, random.pick(&[0.5, 0.75])] });
    scene.sweeps = true;
    scene
}
