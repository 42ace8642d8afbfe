//! What was measured of a walk, as fields for programs, text, CSV, and bars of a chart.

use crate::walk::WalkBar;
#[cfg(feature = "schemars")]
use schemars::JsonSchema;
use serde::Serialize;
use sightlines_eye_to_cell::StepBudget;
use sightlines_progress::words::{bytes, count, percent, share};
use sightlines_walkthrough::{LeftToDraw, LevelsDrawn, MethodSums, TableFacts, WalkMeasured, WalkOptions};
use std::fmt;
use std::fmt::Write;
use std::path::Path;
use std::time::Duration;

/// Averages are over the frames that every method answered in full.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schemars", derive(JsonSchema))]
pub struct WalkReport {
    /// The table.
    file: String,
    /// Its cells.
    n_cells: usize,
    /// Its objects.
    n_objects: usize,
    /// Polygons of its objects.
    n_polygons: u64,
    /// Angle of view in degrees.
    fov: f64,
    /// Distance from frame to frame; null for a walk from a file.
    step: Option<f64>,
    /// Frames.
    n_frames: usize,
    /// Frames that every method answered in full.
    n_full: usize,
    /// Frames with the eye outside every cell, where everything is drawn.
    n_outside: usize,
    /// Frames for which the budget was too small.
    n_starved: usize,
    /// Bytes allowed for prepared data.
    budget: usize,
    /// Steps allowed to the queries of a frame; null for no bound.
    steps: Option<u64>,
    /// The most bytes of prepared data in memory at once.
    most_bytes_kept: usize,
    /// Subgraphs that were prepared.
    n_prepared: u64,
    /// Subgraphs that were dropped again.
    n_dropped: u64,
    /// Of a packed table: bytes that stay in memory, and bytes of its blocks in memory at the end.
    packed_bytes: Option<[usize; 2]>,
    /// The methods.
    methods: Vec<MethodLine>,
    /// With `--levels`: triangles drawn with levels of detail.
    #[serde(skip_serializing_if = "Option::is_none")]
    levels: Option<WalkedLevels>,
}

/// Method on a walk: what it leaves to draw, and what it costs, on average.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schemars", derive(JsonSchema))]
struct MethodLine {
    /// Name of the method.
    method: &'static str,
    /// Cells to draw in a frame.
    cells: Kept,
    /// Objects to draw in a frame.
    objects: Kept,
    /// Polygons of these objects; an object counts as one if the table does not know.
    polygons: Kept,
    /// Images in mirrors in a frame.
    images: f64,
    /// Polygons of the objects in them, to be drawn in addition.
    image_polygons: f64,
    /// Mean time of a frame, in microseconds.
    mean_us: f64,
    /// Median time of a frame, in microseconds.
    median_us: f64,
    /// Time that 99 % of the frames stay within, in microseconds.
    p99_us: f64,
    /// Time of the longest frame, in microseconds.
    longest_us: f64,
    /// Frames that had more to do than the steps allow, or than is in proportion: exact near the eye only, and as `incident-portals` farther away.
    n_fell_back: u64,
    /// Frames that came before everything was prepared, in a walk that does not wait.
    n_late: u64,
}

/// How much is kept in a frame.
#[derive(Debug, Clone, Copy, Serialize)]
#[cfg_attr(feature = "schemars", derive(JsonSchema))]
struct Kept {
    /// Number in a frame, on average.
    mean: f64,
    /// The same by that of the method `cell-to-cell`.
    share_of_cell_to_cell: f64,
    /// The same by the number in the table.
    share_of_all: f64,
}

fn micros(time: Duration) -> f64 {
    time.as_secs_f64() * 1e6
}

/// The time that `q` of all frames, ascending, do not exceed.
fn quantile(times: &[Duration], q: f64) -> f64 {
    let last = times.len().saturating_sub(1);
    times.get((q * last as f64).ceil() as usize).map_or(0.0, |&time| micros(time))
}

impl WalkReport {
    /// Of a walk through the table in a file.
    ///
    /// * `fov`: the angle of view in degrees
    /// * `step`: the distance from frame to frame, if it is always the same
    /// * `polygons`: of each object
    pub fn new(
        file: &Path,
        WalkOptions { budget, steps, .. }: WalkOptions,
        (fov, step): (f64, Option<f64>),
        cells: &impl TableFacts,
        polygons: &[u32],
        measured: &WalkMeasured,
        levels: Option<WalkedLevels>,
    ) -> Self {
        let (n_cells, n_objects) = (cells.n_cells(), cells.n_objects());
        let n_polygons = polygons.iter().map(|&n| u64::from(n)).sum();
        let WalkMeasured { methods, n_full, n_outside, n_starved, most_bytes, n_prepared, n_dropped } = measured;
        let mean = |sum: u64| share(sum as f64, *n_full as f64);
        let kept = |sums: &MethodSums, of: fn(&LeftToDraw) -> u64, all: u64| Kept {
            mean: mean(of(&sums.left)),
            share_of_cell_to_cell: share(of(&sums.left) as f64, of(&methods[0].left) as f64),
            share_of_all: share(mean(of(&sums.left)), all as f64),
        };
        let line = |sums: &MethodSums| MethodLine {
            method: sums.method.name(),
            cells: kept(sums, |s| s.cells, n_cells as u64),
            objects: kept(sums, |s| s.objects, n_objects as u64),
            polygons: kept(sums, |s| s.polygons, n_polygons),
            images: mean(sums.left.images),
            image_polygons: mean(sums.left.image_polygons),
            mean_us: share(micros(sums.times.iter().sum()), *n_full as f64),
            median_us: quantile(&sums.times, 0.5),
            p99_us: quantile(&sums.times, 0.99),
            longest_us: quantile(&sums.times, 1.0),
            n_fell_back: sums.n_fell_back,
            n_late: sums.n_late,
        };
        Self {
            file: file.display().to_string(),
            n_cells,
            n_objects,
            n_polygons,
            fov,
            step,
            n_frames: n_full + n_outside + n_starved,
            n_full: *n_full,
            n_outside: *n_outside,
            n_starved: *n_starved,
            budget,
            steps: (steps != StepBudget::UNLIMITED).then(|| steps.n_steps()),
            most_bytes_kept: *most_bytes,
            n_prepared: *n_prepared,
            n_dropped: *n_dropped,
            packed_bytes: cells.bytes_in_memory().map(|(resident, blocks)| [resident, blocks]),
            methods: methods.iter().map(line).collect(),
            levels,
        }
    }

    /// The title of the chart.
    pub fn title(&self) -> String {
        format!("{}: {}, {} degrees", self.file, count(self.n_full as u64, "frame"), self.fov)
    }

    /// The bars of the chart.
    pub fn bars(&self) -> Vec<WalkBar<'_>> {
        let bar = |line: &'_ MethodLine| WalkBar {
            name: line.method,
            shares: [&line.cells, &line.objects, &line.polygons].map(|kept| kept.share_of_all),
            median_us: line.median_us,
            p99_us: line.p99_us,
        };
        self.methods.iter().map(bar).collect()
    }

    /// A line for each method, behind one with names.
    pub fn csv(&self) -> String {
        let mut out = String::from(
            "file,fov,frames,method,cells,cells_of_cell_to_cell,cells_of_all,objects,objects_of_cell_to_cell,\
             objects_of_all,polygons,polygons_of_cell_to_cell,polygons_of_all,images,image_polygons,mean_us,median_us,\
             p99_us,longest_us,fell_back,late\n",
        );
        let file = self.file.replace('"', "\"\"");
        for line in &self.methods {
            let _ = write!(out, "\"{file}\",{},{},{}", self.fov, self.n_full, line.method);
            for kept in [&line.cells, &line.objects, &line.polygons] {
                let Kept { mean, share_of_cell_to_cell, share_of_all } = kept;
                let _ = write!(out, ",{mean:.2},{share_of_cell_to_cell:.6},{share_of_all:.6}");
            }
            let MethodLine { images, image_polygons, mean_us, median_us, p99_us, longest_us, .. } = line;
            let _ = write!(out, ",{images:.3},{image_polygons:.1},{mean_us:.3},{median_us:.3},{p99_us:.3}");
            let _ = writeln!(out, ",{longest_us:.3},{},{}", line.n_fell_back, line.n_late);
        }
        out
    }
}

/// In a column.
impl fmt::Display for Kept {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { mean, share_of_cell_to_cell, share_of_all } = *self;
        let digits = if share_of_all < 0.01 { 3 } else { 1 };
        write!(f, "{mean:>9.1} {:>6.1} {:>6.*}", 100.0 * share_of_cell_to_cell, digits, 100.0 * share_of_all)
    }
}

impl fmt::Display for WalkReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let all = [(self.n_cells, "cell"), (self.n_objects, "object")].map(|(n, noun)| count(n as u64, noun));
        let [frames, polygons] = [count(self.n_frames as u64, "frame"), count(self.n_polygons, "polygon")];
        writeln!(f, "{}: {}, {}, {polygons}", self.file, all[0], all[1])?;
        let step = self.step.map_or(String::new(), |step| format!(", a step of {step:.3} units"));
        writeln!(f, "{frames}, {} degrees{step}", self.fov)?;
        if self.n_outside > 0 {
            writeln!(f, "outside        {}, not counted below", count(self.n_outside as u64, "frame"))?;
        }
        if self.n_starved > 0 {
            let n = count(self.n_starved as u64, "frame");
            writeln!(f, "too large      {n} that need more than the budget, not counted below")?;
        }
        let [cells, objects, polygons, time] = ["cells", "objects", "polygons", "µs: mean, median, 99 %, all"];
        writeln!(
            f,
            "\n{:<20} {cells:>23} {objects:>23} {polygons:>23} {time:>37} {:>7} {:>6}",
            "left to draw", "coarser", "late"
        )?;
        for line in &self.methods {
            let MethodLine {
                method,
                cells,
                objects,
                polygons,
                mean_us,
                median_us,
                p99_us,
                longest_us,
                n_fell_back,
                n_late,
                ..
            } = line;
            writeln!(
                f,
                "{method:<20} {cells} {objects} {polygons} {mean_us:>9.2} {median_us:>8.2} {p99_us:>8.2} {longest_us:>9.2} \
                 {n_fell_back:>7} {n_late:>6}"
            )?;
            if line.images > 0.0 {
                writeln!(f, "  in mirrors: {:.2} images, {:.1} polygons", line.images, line.image_polygons)?;
            }
        }
        let [most, budget] = [self.most_bytes_kept, self.budget].map(|n| bytes(n as u64));
        writeln!(
            f,
            "\nkept           at most {most} of {budget}; {} subgraphs made, {} dropped",
            self.n_prepared, self.n_dropped
        )?;
        if let Some([resident, blocks]) = self.packed_bytes.map(|list| list.map(|n| bytes(n as u64))) {
            writeln!(f, "packed table   {resident} in memory, {blocks} of blocks kept")?;
        }
        if let Some(levels) = &self.levels {
            write!(f, "{levels}")?;
        }
        writeln!(f, "left to draw   on average; of it, % of the first line; of all, %")?;
        let steps = self.steps.map_or("is in proportion".to_owned(), |steps| count(steps, "step"));
        writeln!(
            f,
            "coarser        frames that had more to do than {steps}: exact near the eye only, farther away as incident-portals"
        )?;
        writeln!(
            f,
            "late           frames whose answer was not ready in time, so that they showed more; of a second walk that does not wait \
             for answers, at the pace of --fps"
        )
    }
}

/// Triangles that are drawn, on average over the frames with the eye in a cell.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schemars", derive(JsonSchema))]
pub struct WalkedLevels {
    /// The folder of levels.
    folder: String,
    /// Levels in it.
    n_levels: usize,
    /// Frames.
    n_frames: usize,
    /// Of these, frames in which all cells of the eye have the same level.
    n_with_level: usize,
    /// Triangles drawn in each frame without levels: all of the scene.
    without: u64,
    /// Triangles drawn in a frame with levels, on average.
    with_mean: f64,
    /// Triangles drawn in a frame with levels, at most.
    with_most: u64,
}

impl WalkedLevels {
    /// With so many levels in a folder, of a scene with `n_triangles`.
    pub fn new(folder: &Path, n_levels: usize, n_triangles: u64, drawn: &LevelsDrawn) -> Self {
        let LevelsDrawn { n_frames, n_with_level, n_triangles: with, most: with_most } = *drawn;
        let (folder, with_mean) = (folder.display().to_string(), share(with as f64, n_frames as f64));
        Self { folder, n_levels, n_frames, n_with_level, without: n_triangles, with_mean, with_most }
    }
}

impl fmt::Display for WalkedLevels {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [of_mean, of_most] =
            [self.with_mean, self.with_most as f64].map(|n| percent(share(n, self.without as f64)));
        let (mean, most) = (self.with_mean, self.with_most);
        let Self { folder, n_levels, n_frames, n_with_level, .. } = self;
        writeln!(f, "levels         {n_levels} of {folder}, in {n_with_level} of {n_frames} frames inside")?;
        writeln!(f, "triangles      {} a frame without levels", self.without)?;
        writeln!(f, "               {mean:.1} with levels on average, {of_mean}; at most {most}, {of_most}")
    }
}
