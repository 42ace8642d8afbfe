//! The lines about tables and scenes that several commands print.

use crate::output::{JsonSchema, Serialize, bytes, count, percent, seconds_of};
use sightlines::formats::scene::{Axis, LengthUnit, SceneFormat, SceneInfo};
use sightlines::pvs::{DoorRecord, Frame, GeometryDigest, ObjectSource, Table};
use sightlines::report::Summary;
use std::fmt;

/// Cells, portals, visible pairs, and what has to be drawn; a share of the floor that is not a number is unknown.
pub(crate) struct Facts<'a>(pub(crate) &'a Summary);

impl fmt::Display for Facts<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let s = self.0;
        let groups = if s.n_groups > 0 { format!(", in {}", count(s.n_groups as u64, "group")) } else { String::new() };
        let names = if s.has_cell_names { ", with names" } else { "" };
        writeln!(f, "cells          {}{groups}{names}", s.n_cells)?;
        writeln!(f, "portals        {}", s.n_portals)?;
        if s.n_objects > 0 {
            writeln!(f, "objects        {}", s.n_objects)?;
        }
        let all = s.n_cells as u64 * (s.n_cells as u64).saturating_sub(1) / 2;
        writeln!(f, "visible pairs  {} of {all}", s.n_visible_pairs)?;
        let [cells, floor] = [s.mean_cell_share, s.mean_floor_share].map(percent);
        if s.mean_floor_share.is_nan() {
            return writeln!(f, "to draw        {cells} of the cells on average");
        }
        let what = if s.dimension == 2 { "floor" } else { "volume" };
        writeln!(f, "to draw        {floor} of the {what} on average ({cells} of the cells)")
    }
}

/// Times to cut and to see.
pub(crate) fn times(cut_seconds: f64, what: &str, see_seconds: f64) -> String {
    let [cut, see] = [cut_seconds, see_seconds].map(seconds_of);
    format!("{cut} to cut the {what}, {see} to compute visibility")
}

/// Stab trees of a table.
#[derive(Debug, Clone, Copy, Default, Serialize, JsonSchema)]
pub(crate) struct StabFacts {
    /// Sequences of portals, of all cells together.
    n_sequences: u64,
    /// Stored nodes; equal subtrees are stored once.
    n_stab_nodes: usize,
    /// Stored edges.
    n_stab_edges: u64,
    /// Bytes of the table that the stab trees take.
    n_stab_bytes: usize,
}

impl StabFacts {
    /// Of a table that has stab trees. Writes the table to memory twice.
    pub(crate) fn of(table: &Table) -> Option<Self> {
        let trees = table.stab()?;
        let mut parts = table.parts().clone();
        parts.stab = None;
        let without = Table::new(parts).map_or(0, |table| table.to_bytes().len());
        Some(Self {
            n_sequences: u64::try_from(trees.n_sequences()).unwrap_or(u64::MAX),
            n_stab_nodes: trees.n_nodes(),
            n_stab_edges: trees.n_edges(),
            n_stab_bytes: table.to_bytes().len().saturating_sub(without),
        })
    }
}

impl fmt::Display for StabFacts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [nodes, edges] = [self.n_stab_nodes as u64, self.n_stab_edges];
        let each = self.n_stab_bytes as f64 / self.n_sequences.max(1) as f64;
        writeln!(f, "stab trees     {} sequences in {nodes} nodes with {edges} edges", self.n_sequences)?;
        writeln!(f, "               {}, {each:.3} bytes a sequence", bytes(self.n_stab_bytes as u64))
    }
}

/// The digests of a table, as hexadecimal numbers.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub(crate) struct DigestFacts {
    /// Of what hides.
    hiding: String,
    /// Of what can be seen.
    seen: String,
}

impl From<GeometryDigest> for DigestFacts {
    fn from(digest: GeometryDigest) -> Self {
        let [hiding, seen] = [digest.hiding, digest.seen].map(|number| format!("{number:032x}"));
        Self { hiding, seen }
    }
}

impl fmt::Display for DigestFacts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "digests        {} of what hides", self.hiding)?;
        writeln!(f, "               {} of what can be seen", self.seen)
    }
}

/// Where an object is in the file that a table was made of.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
pub(crate) struct Source {
    /// Index of its node in the `nodes` of the glTF that the table was made of; absent if it is not known.
    node: u32,
    /// Index of its primitive in the node's mesh; there if `node` is.
    primitive: u32,
}

impl From<ObjectSource> for Source {
    fn from(ObjectSource { node, primitive }: ObjectSource) -> Self {
        Self { node, primitive }
    }
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "node {} primitive {}", self.node, self.primitive)
    }
}

/// A door of a table.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub(crate) struct DoorFacts {
    /// Its name; names may repeat.
    name: String,
    /// The object that it is; null for a door that was given as a box.
    object: Option<u32>,
    /// The portals that it closes when it is shut; the table takes it to be open.
    portals: Vec<u32>,
}

impl From<&DoorRecord> for DoorFacts {
    fn from(DoorRecord { name, object, portals }: &DoorRecord) -> Self {
        let portals = portals.iter().map(|portal| portal.0).collect();
        Self { name: name.clone(), object: object.map(|object| object.0), portals }
    }
}

impl fmt::Display for DoorFacts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // As a Rust string: a name may hold anything, and the door should stay one line.
        let Self { name, object, portals } = self;
        write!(f, "{name:?}, ")?;
        match object {
            Some(object) => write!(f, "object {object}, ")?,
            None => f.write_str("given as a box, ")?,
        }
        match &portals[..] {
            [] => f.write_str("closes no portal"),
            portals => {
                let ids: Vec<String> = portals.iter().map(u32::to_string).collect();
                write!(f, "closes {}", ids.join(" "))
            }
        }
    }
}

/// The lines about the doors of a table; none without doors.
pub(crate) fn write_doors(f: &mut fmt::Formatter<'_>, doors: &[DoorFacts]) -> fmt::Result {
    for (k, door) in doors.iter().enumerate() {
        writeln!(f, "{:<14} {door}", if k == 0 { "doors" } else { "" })?;
    }
    Ok(())
}

/// Frame of a table: the axes of its own that it has. Its cells, portals and objects are along these; points that queries take are not.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
pub(crate) struct FrameFacts {
    /// Each axis as a unit vector of the scene.
    axes: [[f64; 3]; 3],
    /// Openings narrower than this may count as closed, and things that are thinner as hidden; along a diagonal up to √3 times this.
    gap: f64,
}

impl From<&Frame> for FrameFacts {
    fn from(frame: &Frame) -> Self {
        Self { axes: frame.axes(), gap: frame.gap() }
    }
}

/// How it is turned, and what its gap means; the same words wherever a frame is reported.
impl fmt::Display for FrameFacts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match degrees(&self.axes) {
            Some(degrees) => write!(f, "turned by {degrees:.6} degrees")?,
            None => f.write_str(ALONG_THE_FILE)?,
        }
        write!(f, ", openings and things narrower than {:.2e} units may count as closed or hidden", self.gap)
    }
}

/// How a scene stands that has no frame, or one that is not turned.
pub(crate) const ALONG_THE_FILE: &str = "along the axes of the file";

/// By how much axes are turned; none if they are those of the file.
fn degrees(axes: &[[f64; 3]; 3]) -> Option<f64> {
    if (0..3).all(|k| axes[k][k] == 1.0) {
        return None;
    }
    // The angle of a turn from its trace.
    let cosine = (axes[0][0] + axes[1][1] + axes[2][2] - 1.0) / 2.0;
    // Near 1 the cosine tells nothing; the sine is in the differences across the diagonal.
    let [x, y, z] = [axes[1][2] - axes[2][1], axes[2][0] - axes[0][2], axes[0][1] - axes[1][0]];
    let sine = (x * x + y * y + z * z).sqrt() / 2.0;
    Some(sine.atan2(cosine).to_degrees())
}

/// The name of an axis.
pub(crate) fn axis(axis: Axis) -> &'static str {
    match axis {
        Axis::X => "x",
        Axis::Y => "y",
        Axis::Z => "z",
    }
}

/// What a file states about its scene, for people: format, axis, unit.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
pub(crate) struct Stated {
    /// Format of the file, such as `glTF` or `OBJ`.
    format: &'static str,
    /// The axis that points up.
    up: &'static str,
    /// Whether `up` is an assumption because the file does not state it.
    up_is_assumed: bool,
    /// Unit of length; null if the file does not state it.
    unit: Option<&'static str>,
}

impl Stated {
    pub(crate) fn new(info: &SceneInfo) -> Self {
        let format = match info.format {
            SceneFormat::Gltf => "glTF",
            SceneFormat::Obj => "OBJ",
            _ => "unknown",
        };
        let unit = (info.unit == LengthUnit::Metre).then_some("metre");
        Self { format, up: axis(info.up), up_is_assumed: info.up_is_assumed, unit }
    }

    /// Whether the file states lengths in metres.
    pub(crate) fn is_in_metres(&self) -> bool {
        self.unit.is_some()
    }

    /// What lengths are in.
    pub(crate) fn unit_name(&self) -> &'static str {
        if self.is_in_metres() { "metres" } else { "units" }
    }
}

impl fmt::Display for Stated {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let assumed = if self.up_is_assumed { " (assumed)" } else { "" };
        write!(f, "{} in 3D, {} up{assumed}, ", self.format, self.up)?;
        match self.unit {
            Some(unit) => write!(f, "in {unit}s"),
            None => f.write_str("unit unknown"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_told_in_the_same_words() {
        let text = |axes: [[f64; 3]; 3]| FrameFacts { axes, gap: 0.00025 }.to_string();
        let (plain, gap) =
            ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], "openings and things narrower than 2.50e-4 units");
        assert_eq!(text(plain), format!("along the axes of the file, {gap} may count as closed or hidden"));
        let turned = text([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]);
        assert_eq!(turned, format!("turned by 90.000000 degrees, {gap} may count as closed or hidden"));
    }
}
