//! What is seen from a point by a method: in a direction, with doors closed, in mirrors.

use super::{Object, Place, ids, named, write_seen};
use crate::error::{ErrorAbout, Result};
use crate::output::{JsonSchema, Serialize, count};
use crate::sight::{Sight, SightArgs, without_direction};
use crate::tables::Cells;
use crate::view::Methods;
use sightlines::eye_to_cell::{Method, StepBudget, View};
use sightlines::pvs::CellId;
use sightlines::walkthrough::Viewer;
use std::fmt;
use std::path::Path;
use std::time::{Duration, Instant};

/// A query is timed this many times, and the median is reported.
const RUNS: usize = 9;

/// The view, as arguments.
#[derive(Debug, clap::Args)]
pub(super) struct ViewerArgs {
    #[command(flatten)]
    sight: SightArgs,
    /// Also list what is visible in mirrors, up to this many reflections in a row
    #[arg(long, help_heading = "Method", value_name = "N", value_parser = crate::view::bounces)]
    bounces: Option<usize>,
}

impl ViewerArgs {
    pub(super) fn is_given(&self) -> bool {
        let Self { sight: SightArgs { dir, lens, method, closed }, bounces } = self;
        dir.is_some() || lens.is_given() || method.is_some() || !closed.is_empty() || bounces.is_some()
    }
}

/// Answers by the requested methods.
pub(super) fn look<C: Cells>(cells: &C, path: &Path, eye: &[f64], at: &[CellId], args: &ViewerArgs) -> Result<Seen> {
    let ViewerArgs { sight: args, bounces } = args;
    let Sight { view, looks } = args.sight(cells, path, eye)?;
    if looks.is_none() && args.lens.is_given() {
        return Err(without_direction("--fov, --aspect and --up"));
    }
    let mut viewer = Viewer::of(cells.clone());
    viewer.set_budget(StepBudget::UNLIMITED);
    viewer.set_memory(usize::MAX);
    *viewer.doors_mut() = args.doors(cells, path)?;
    let all = args.method == Some(Methods::All);
    let methods = args.method.unwrap_or(Methods::One(Method::Exact)).list();
    let answers = methods.into_iter().map(|method| answer(&mut viewer, method, &view, bounces.unwrap_or(0), at));
    let mut answers = answers.collect::<Result<Vec<_>, _>>().in_file(path)?;
    let one = if all { None } else { answers.pop() };
    let (dir, fov) = looks.unzip();
    let outside = at.is_empty();
    let place = Place::new(cells, eye, at).in_file(path)?;
    Ok(Seen { place, outside, dir, fov, one, methods: answers, all: cells.counts() })
}

fn answer<C: Cells>(
    viewer: &mut Viewer<C>,
    method: Method,
    view: &View,
    bounces: usize,
    at: &[CellId],
) -> Result<Answered> {
    viewer.set_method(method);
    // The first look is not warm.
    viewer.try_look(view)?;
    let mut times: Vec<Duration> = Vec::new();
    for _ in 0..RUNS {
        let start = Instant::now();
        viewer.try_look(view)?;
        times.push(start.elapsed());
    }
    times.sort_unstable();
    let images = viewer.try_follow_reflections(bounces)?.iter().map(|image| ImageSeen {
        mirrors: image.mirrors.iter().map(|mirror| mirror.0).collect(),
        cells: image.cells.iter().map(|cell| cell.0).collect(),
        objects: image.objects.iter().map(|object| object.0).collect(),
        complete: image.complete,
    });
    let (images, seen) = (images.collect(), viewer.seen());
    Ok(Answered {
        method: method.name(),
        visible: seen.cells().iter().map(|cell| cell.0).collect(),
        objects: named(&**viewer.cells(), seen.objects().iter().copied(), at)?,
        images,
        microseconds: times[RUNS / 2].as_secs_f64() * 1e6,
    })
}

/// With an option that describes the view: the answer of one method, or with `--method all` those of all.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct Seen {
    #[serde(flatten)]
    place: Place,
    /// Whether the eye is outside every cell, where everything may be visible.
    outside: bool,
    /// Direction of view; null for all directions.
    dir: Option<Vec<f64>>,
    /// Angle of view in degrees; null for all directions.
    fov: Option<f64>,
    /// The answer, if one method was requested.
    #[serde(flatten)]
    one: Option<Answered>,
    /// The answers, if all methods were.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    methods: Vec<Answered>,
    /// Number of cells and of objects of the table.
    #[serde(skip)]
    all: [usize; 2],
}

/// Answer of a method.
#[derive(Debug, Serialize, JsonSchema)]
struct Answered {
    /// The eye-to-cell method.
    method: &'static str,
    /// Cells that may be visible; all of them outside every cell.
    visible: Vec<u32>,
    /// Objects that may be visible; all of them outside every cell.
    objects: Vec<Object>,
    /// What may be visible in mirrors; needs `--bounces`.
    images: Vec<ImageSeen>,
    /// Median time of a query with everything prepared, in microseconds.
    microseconds: f64,
}

/// Objects seen by way of mirrors.
#[derive(Debug, Serialize, JsonSchema)]
struct ImageSeen {
    /// The mirrors, in the order in which a line from the eye meets them.
    mirrors: Vec<u32>,
    /// Cells that may be visible in them.
    cells: Vec<u32>,
    /// Objects that may be visible in them.
    objects: Vec<u32>,
    /// Whether the lists are known to be complete.
    complete: bool,
}

impl fmt::Display for ImageSeen {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [cells, objects] =
            [(&self.cells, "cell"), (&self.objects, "object")].map(|(l, s)| count(l.len() as u64, s));
        let rest = if self.complete { "" } else { ", and perhaps more" };
        write!(f, "in mirror {}: {cells} and {objects}{rest}", ids(&self.mirrors))
    }
}

impl fmt::Display for Seen {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [n_cells, n_objects] = self.all;
        if self.outside {
            let all = [count(n_cells as u64, "cell"), count(n_objects as u64, "object")];
            return writeln!(f, "{}, and sees everything: {} and {}", self.place, all[0], all[1]);
        }
        writeln!(f, "{}", self.place)?;
        for answer in &self.methods {
            let Answered { method, visible, objects, images, microseconds } = answer;
            let [cells, objects] = [visible.len(), objects.len()];
            writeln!(f, "{method:<20} {cells:>7} cells {objects:>7} objects {microseconds:>10.2} µs")?;
            images.iter().try_for_each(|image| writeln!(f, "  {image}"))?;
        }
        if let Some(answer) = &self.one {
            writeln!(f, "by {} in {:.2} µs", answer.method, answer.microseconds)?;
            write_seen(f, &answer.visible, &answer.objects, self.all)?;
            answer.images.iter().try_for_each(|image| writeln!(f, "{image}"))?;
        }
        Ok(())
    }
}
