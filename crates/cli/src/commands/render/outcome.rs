//! What was drawn.

use super::cull::Gone;
use crate::output::{JsonSchema, Serialize, count, percent, seconds_of};
use sightlines::geometry::Point3;
use sightlines::visible_surface::{Comparison, Image, PreparedMethod, RenderInput};
use std::collections::BTreeMap;
use std::fmt;
use std::time::Instant;

/// Pictures of a scene.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct Outcome {
    /// The scene.
    pub(super) scene: String,
    /// Its objects.
    pub(super) n_objects: usize,
    /// Its faces.
    pub(super) n_faces: usize,
    /// Faces that have an area and were not culled.
    pub(super) n_drawn: usize,
    /// The eye.
    pub(super) eye: Point3,
    /// The point in the middle of the picture.
    pub(super) look_at: Point3,
    /// The direction that points up in the picture.
    pub(super) up: Point3,
    /// Vertical angle of view in degrees.
    pub(super) fov: f64,
    /// Width and height in pixels.
    pub(super) size: [u32; 2],
    /// Smallest visible depth.
    pub(super) near: f64,
    /// Greatest visible depth; null without a far plane.
    pub(super) far: Option<f64>,
    /// What was culled, in this order.
    pub(super) culled: Vec<Gone>,
    /// The methods that drew.
    pub(super) pictures: Vec<Row>,
    /// The picture that was written.
    pub(super) file: String,
    #[serde(skip)]
    pub(super) compared: bool,
}

/// What one method drew
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Row {
    /// The method, with its depth format.
    pub(super) method: &'static str,
    /// With `--compare`: pixels that differ from the ray caster; null without.
    wrong: Option<usize>,
    /// With `--compare`: pixels where faces have the same depth, so that either is right; null without.
    in_doubt: Option<u64>,
    /// Seconds to prepare, independent of the eye.
    prepare_seconds: f64,
    /// Splits of faces in preparation.
    prepare_splits: u64,
    /// Seconds to draw.
    draw_seconds: f64,
    /// Faces of which at least a part was drawn or tried.
    polygons: u64,
    /// Pieces given to the rasteriser, those outside the picture included.
    fragments: u64,
    /// Splits of faces for this picture.
    splits: u64,
    /// Pixels written, each as often as it was.
    written: u64,
    /// Pixels that show a face.
    covered: u64,
    /// `written` by `covered`; 0 if nothing is covered.
    overdraw: f64,
    /// Decisions that needed exact numbers.
    exact: u64,
    /// How often each test was made, by its name.
    tests: BTreeMap<&'static str, u64>,
}

impl Row {
    /// Draws, and counts what that took.
    pub(super) fn draw(
        PreparedMethod { method, time, splits }: &PreparedMethod,
        shot: &RenderInput<'_>,
    ) -> (Image, Self) {
        let start = Instant::now();
        let (image, counters) = method.picture(shot);
        let row = Self {
            method: method.name(),
            wrong: None,
            in_doubt: None,
            prepare_seconds: time.as_secs_f64(),
            prepare_splits: *splits,
            draw_seconds: start.elapsed().as_secs_f64(),
            polygons: counters.polygons,
            fragments: counters.fragments,
            splits: counters.splits,
            written: counters.written,
            covered: counters.covered,
            overdraw: counters.overdraw(),
            exact: counters.exact,
            tests: counters.tests,
        };
        (image, row)
    }

    /// The same, compared with the ray caster.
    pub(super) fn compared(self, Comparison { wrong, ties, .. }: &Comparison) -> Self {
        Self { wrong: Some(wrong.len()), in_doubt: Some(*ties), ..self }
    }

    /// Splits for the picture, and before.
    const fn all_splits(&self) -> u64 {
        self.prepare_splits + self.splits
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let of = [count(self.n_faces as u64, "face"), count(self.n_objects as u64, "object")];
        let [width, height] = self.size;
        writeln!(f, "{}: {} of {}, {width} x {height} pixels", self.scene, of[0], of[1])?;
        for gone in &self.culled {
            let Gone { by, n_faces, seconds } = gone;
            writeln!(f, "left out       {} by {by}, in {}", count(*n_faces, "face"), seconds_of(*seconds))?;
        }
        writeln!(f, "to draw        {}", count(self.n_drawn as u64, "face"))?;
        if self.compared {
            self.write_table(f)?
        } else {
            self.pictures.iter().try_for_each(|row| self.write_one(f, row))?
        }
        writeln!(f, "wrote          {}", self.file)
    }
}

impl Outcome {
    fn write_one(&self, f: &mut fmt::Formatter<'_>, row: &Row) -> fmt::Result {
        let [polygons, fragments, splits] =
            [(row.polygons, "face"), (row.fragments, "fragment"), (row.all_splits(), "split")]
                .map(|(n, noun)| count(n, noun));
        writeln!(f, "drawn          by {}: {polygons}, {fragments}, {splits}", row.method)?;
        if !row.tests.is_empty() {
            let tests: Vec<String> = row.tests.iter().map(|(name, n)| format!("{name} {n}")).collect();
            writeln!(f, "tests          {}", tests.join(", "))?;
        }
        let n_pixels = self.size.map(u64::from).iter().product::<u64>();
        let share = percent(row.covered as f64 / n_pixels as f64);
        let Row { overdraw, exact, .. } = row;
        writeln!(f, "pixels         {share} covered, each written {overdraw:.2} times; {exact} exact decisions")?;
        let [prepare, draw] = [row.prepare_seconds, row.draw_seconds].map(seconds_of);
        writeln!(f, "time           {prepare} to prepare, {draw} to draw")
    }

    /// A line for each method, with the number of its picture in the sheet.
    fn write_table(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names = ["wrong", "in doubt", "prepare", "draw", "faces", "fragments", "splits", "overdraw", "exact"];
        write!(f, "{:>3} {:<20}", "no", "method")?;
        names.iter().try_for_each(|name| write!(f, " {name:>9}"))?;
        writeln!(f, " {:>10}", "tests")?;
        for (no, row) in (1..).zip(&self.pictures) {
            let (wrong, in_doubt) = (row.wrong.unwrap_or_default(), row.in_doubt.unwrap_or_default());
            let [prepare, draw] = [row.prepare_seconds, row.draw_seconds].map(seconds_of);
            let tests: u64 = row.tests.values().sum();
            writeln!(
                f,
                "{no:>3} {:<20} {wrong:>9} {in_doubt:>9} {prepare:>9} {draw:>9} {:>9} {:>9} {:>9} {:>9.2} {:>9} {tests:>10}",
                row.method,
                row.polygons,
                row.fragments,
                row.all_splits(),
                row.overdraw,
                row.exact
            )?;
        }
        Ok(())
    }
}
