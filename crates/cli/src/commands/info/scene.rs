//! What a scene in space holds.

use crate::error::Result;
use crate::facts::Stated;
use crate::input;
use crate::output::{JsonSchema, Serialize, coordinate, count, distance, point, unless_none};
use crate::surfaces::Surfaces;
use sightlines::cells::{MovingObject, Scene};
use sightlines::formats::scene::SceneReadOptions;
use sightlines::geometry::Aabb;
use std::fmt;
use std::path::Path;

/// The numbers of a scene.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct SceneInfo {
    /// The file.
    file: String,
    /// `scene`.
    kind: &'static str,
    #[serde(flatten)]
    stated: Stated,
    #[serde(flatten)]
    surfaces: Surfaces,
    /// Objects.
    n_objects: usize,
    /// Of these, objects without triangles.
    n_objects_without_triangles: usize,
    /// Triangles.
    n_triangles: usize,
    /// Triangles without area, which were left out.
    n_degenerate_triangles: usize,
    /// Lower corner of the scene.
    min: [f64; 3],
    /// Upper corner of the scene.
    max: [f64; 3],
    /// What moves, in the order of the objects; at run time each is a moving object that stays in its box.
    movers: Vec<Mover>,
    /// Where viewers can be, as the file states it (role `view-volume`).
    view_volumes: Vec<Volume>,
}

/// An object that moves.
#[derive(Debug, Serialize, JsonSchema)]
struct Mover {
    /// The object, counted from 0.
    object: u32,
    /// Its name.
    name: String,
    /// Lower corner of the box that it never leaves; null if it may be anywhere.
    min: Option<[f64; 3]>,
    /// Upper corner of that box; null if it may be anywhere.
    max: Option<[f64; 3]>,
}

/// A box where viewers can be.
#[derive(Debug, Serialize, JsonSchema)]
struct Volume {
    /// Lower corner of the box.
    min: [f64; 3],
    /// Upper corner.
    max: [f64; 3],
}

/// What moves in a scene, in the order of the objects.
fn movers(scene: &Scene) -> Vec<Mover> {
    let mover = |moving: &MovingObject| Mover {
        object: moving.object,
        name: scene.objects()[moving.object as usize].name.clone(),
        min: moving.within.map(|within| within.min),
        max: moving.within.map(|within| within.max),
    };
    scene.moving().iter().map(mover).collect()
}

impl SceneInfo {
    pub(super) fn read(path: &Path, options: &SceneReadOptions) -> Result<Self> {
        let file = input::scene(path, options)?;
        let bounds = file.scene.bounds();
        Ok(Self {
            file: path.display().to_string(),
            kind: "scene",
            stated: Stated::new(&file.info),
            surfaces: Surfaces::new(&file),
            n_objects: file.info.n_objects,
            n_objects_without_triangles: file.info.n_objects_without_triangles,
            n_triangles: file.info.n_triangles,
            n_degenerate_triangles: file.info.n_degenerate_triangles,
            min: bounds.min,
            max: bounds.max,
            movers: movers(&file.scene),
            view_volumes: file.info.view_volumes.iter().map(|&Aabb { min, max }| Volume { min, max }).collect(),
        })
    }
}

impl fmt::Display for SceneInfo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}: scene in space, {}", self.file, self.stated)?;
        let empty = unless_none(self.n_objects_without_triangles, |n| format!(", {n} of them without triangles"));
        writeln!(f, "objects        {}{empty}", self.n_objects)?;
        let degenerate = unless_none(self.n_degenerate_triangles, |n| format!(", besides {n} without area"));
        writeln!(f, "triangles      {}{degenerate}", self.n_triangles)?;
        write!(f, "{}", self.surfaces)?;
        if !self.movers.is_empty() {
            let n_bounded = self.movers.iter().filter(|mover| mover.min.is_some()).count();
            let anywhere = unless_none(self.movers.len() - n_bounded, |n| format!(", {n} anywhere"));
            let movers = count(self.movers.len() as u64, "object");
            writeln!(f, "moving         {movers}: {n_bounded} within a box{anywhere}")?;
        }
        writeln!(f, "extent         {} to {}", point(&self.min), point(&self.max))?;
        let size: [f64; 3] = std::array::from_fn(|k| self.max[k] - self.min[k]);
        let longest = size.into_iter().fold(0.0, f64::max);
        let unit = self.stated.unit_name();
        let [x, y, z] = [0, 1, 2].map(|k| distance(self.min[k], self.max[k]));
        writeln!(f, "size           {x} by {y} by {z} {unit}")?;
        let is_in_metres = self.stated.is_in_metres();
        if is_in_metres && longest > 5000.0 {
            let metres = coordinate(longest / 1000.0);
            writeln!(f, "               if it was modelled in millimetres, it is {metres} metres: scale it by 0.001")?;
        }
        let far = self.min.into_iter().chain(self.max).fold(0.0, |m: f64, x| m.max(x.abs()));
        // Single precision has 24 bits: from here on, a thousandth of the scene is not ten steps of it.
        if far > longest * f64::from(1 << 11) {
            let step = (far as f32).next_up() - far as f32;
            writeln!(
                f,
                "far away       {} {unit} from the origin, where single precision has steps of {step} {unit}",
                coordinate(far)
            )?;
        }
        Ok(())
    }
}
