//! What was drawn.

use super::cull::Gone;
use super::method::{Drawn, Prepared};
use crate::error::Result;
use crate::output::{count, percent, seconds};
use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};
use sightlines::geometry::Point3;
use sightlines::visible_surface::{Comparison, Counters};
use std::fmt;
use std::time::Duration;

/// What was drawn, for people and as JSON.
#[derive(Debug)]
pub(super) struct Outcome {
    pub(super) scene: String,
    pub(super) n_objects: usize,
    pub(super) n_faces: usize,
    /// Faces that have an area and were not left out.
    pub(super) n_drawn: usize,
    pub(super) eye: Point3,
    pub(super) look_at: Point3,
    pub(super) up: Point3,
    /// In degrees.
    pub(super) fov: f64,
    pub(super) size: [u32; 2],
    /// In JSON `far` is null where there is no end.
    pub(super) depths: [f64; 2],
    pub(super) culled: Vec<Gone>,
    pub(super) compared: bool,
    pub(super) pictures: Vec<Row>,
    pub(super) file: String,
}

/// What one method drew.
#[derive(Debug)]
pub(super) struct Row {
    method: &'static str,
    /// Pixels that are not as the reference's, and those of which it does not matter; `None` without a reference.
    wrong: Option<(usize, u64)>,
    prepared: Prepared,
    time: Duration,
    counters: Counters,
}

impl Row {
    pub(super) fn new(drawn: &Drawn, comparison: Option<&Comparison>) -> Self {
        Self {
            method: drawn.method,
            wrong: comparison.map(|c| (c.wrong.len(), c.ties)),
            prepared: drawn.prepared,
            time: drawn.time,
            counters: drawn.counters.clone(),
        }
    }

    pub(super) fn method(&self) -> &'static str {
        self.method
    }

    /// Splits for the picture, and before.
    fn splits(&self) -> u64 {
        self.prepared.splits + self.counters.splits
    }
}

impl Serialize for Row {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let c = &self.counters;
        let mut s = serializer.serialize_struct("Row", 14)?;
        s.serialize_field("method", self.method)?;
        s.serialize_field("wrong", &self.wrong.map(|(wrong, _)| wrong))?;
        s.serialize_field("in_doubt", &self.wrong.map(|(_, in_doubt)| in_doubt))?;
        s.serialize_field("prepare_seconds", &self.prepared.time.as_secs_f64())?;
        s.serialize_field("prepare_splits", &self.prepared.splits)?;
        s.serialize_field("draw_seconds", &self.time.as_secs_f64())?;
        s.serialize_field("polygons", &c.polygons)?;
        s.serialize_field("fragments", &c.fragments)?;
        s.serialize_field("splits", &c.splits)?;
        s.serialize_field("written", &c.written)?;
        s.serialize_field("covered", &c.covered)?;
        s.serialize_field("overdraw", &c.overdraw())?;
        s.serialize_field("exact", &c.exact)?;
        s.serialize_field("tests", &c.tests)?;
        s.end()
    }
}

impl Serialize for Gone {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut s = serializer.serialize_struct("Gone", 3)?;
        s.serialize_field("by", self.by.name())?;
        s.serialize_field("n_faces", &self.n)?;
        s.serialize_field("seconds", &self.time.as_secs_f64())?;
        s.end()
    }
}

impl Serialize for Outcome {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut s = serializer.serialize_struct("Outcome", 14)?;
        s.serialize_field("scene", &self.scene)?;
        s.serialize_field("n_objects", &self.n_objects)?;
        s.serialize_field("n_faces", &self.n_faces)?;
        s.serialize_field("n_drawn", &self.n_drawn)?;
        s.serialize_field("eye", &self.eye)?;
        s.serialize_field("look_at", &self.look_at)?;
        s.serialize_field("up", &self.up)?;
        s.serialize_field("fov", &self.fov)?;
        s.serialize_field("size", &self.size)?;
        s.serialize_field("near", &self.depths[0])?;
        s.serialize_field("far", &Some(self.depths[1]).filter(|far| far.is_finite()))?;
        s.serialize_field("culled", &self.culled)?;
        s.serialize_field("pictures", &self.pictures)?;
        s.serialize_field("file", &self.file)?;
        s.end()
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let of = [count(self.n_faces as u64, "face"), count(self.n_objects as u64, "object")];
        let [width, height] = self.size;
        writeln!(f, "{}: {} of {}, {width} x {height} pixels", self.scene, of[0], of[1])?;
        for gone in &self.culled {
            let (n, by) = (count(gone.n, "face"), gone.by.name());
            writeln!(f, "left out       {n} by {by}, in {}", seconds(gone.time))?;
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
    /// The lines about the one picture.
    fn write_one(&self, f: &mut fmt::Formatter<'_>, row: &Row) -> fmt::Result {
        let c = &row.counters;
        let [polygons, fragments, splits] =
            [(c.polygons, "face"), (c.fragments, "fragment"), (row.splits(), "split")].map(|(n, noun)| count(n, noun));
        writeln!(f, "drawn          by {}: {polygons}, {fragments}, {splits}", row.method)?;
        if !c.tests.is_empty() {
            let tests: Vec<String> = c.tests.iter().map(|(name, n)| format!("{name} {n}")).collect();
            writeln!(f, "tests          {}", tests.join(", "))?;
        }
        let n_pixels = self.size.map(u64::from).iter().product::<u64>();
        let share = percent(c.covered as f64 / n_pixels as f64);
        writeln!(
            f,
            "pixels         {share} covered, each written {:.2} times; {} exact decisions",
            c.overdraw(),
            c.exact
        )?;
        writeln!(f, "time           {} to prepare, {} to draw", seconds(row.prepared.time), seconds(row.time))
    }

    /// A line for each method, with the number of its picture in the sheet.
    fn write_table(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names = ["wrong", "in doubt", "prepare", "draw", "faces", "fragments", "splits", "overdraw", "exact"];
        write!(f, "{:>3} {:<20}", "no", "method")?;
        names.iter().try_for_each(|name| write!(f, " {name:>9}"))?;
        writeln!(f, " {:>10}", "tests")?;
        for (no, row) in (1..).zip(&self.pictures) {
            let (c, (wrong, in_doubt)) = (&row.counters, row.wrong.unwrap_or_default());
            let [prepare, draw] = [row.prepared.time, row.time].map(seconds);
            let tests: u64 = c.tests.values().sum();
            writeln!(
                f,
                "{no:>3} {:<20} {wrong:>9} {in_doubt:>9} {prepare:>9} {draw:>9} {:>9} {:>9} {:>9} {:>9.2} {:>9} {tests:>10}",
                row.method,
                c.polygons,
                c.fragments,
                row.splits(),
                c.overdraw(),
                c.exact
            )?;
        }
        Ok(())
    }
}
