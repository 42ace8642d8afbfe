//! What a table states of itself, as fields for programs and as lines for people.

use crate::words::bytes;
use serde::Serialize;
use sightlines_pvs::{DoorRecord, GeometryDigest, ObjectSource, Table};
use std::fmt;

/// Stab trees of a table.
#[derive(Debug, Clone, Copy, Default, Serialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct StabFacts {
    /// Sequences of portals, of all cells together.
    pub n_sequences: u64,
    /// Stored nodes; equal subtrees are stored once.
    pub n_stab_nodes: usize,
    /// Stored edges.
    pub n_stab_edges: u64,
    /// Bytes of the table that the stab trees take.
    pub n_stab_bytes: usize,
}

impl StabFacts {
    /// Of a table that has stab trees. Writes the table to memory twice.
    pub fn of(table: &Table) -> Option<Self> {
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
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct DigestFacts {
    /// Of what hides.
    pub hiding: String,
    /// Of what can be seen.
    pub seen: String,
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
#[derive(Debug, Clone, Copy, Serialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct ObjectPlace {
    /// Index of its node in the `nodes` of the glTF that the table was made of; absent if it is not known.
    pub node: u32,
    /// Index of its primitive in the node's mesh; there if `node` is.
    pub primitive: u32,
}

impl From<ObjectSource> for ObjectPlace {
    fn from(ObjectSource { node, primitive }: ObjectSource) -> Self {
        Self { node, primitive }
    }
}

impl fmt::Display for ObjectPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "node {} primitive {}", self.node, self.primitive)
    }
}

/// A door of a table.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct DoorFacts {
    /// Its name; names may repeat.
    pub name: String,
    /// The object that it is; null for a door that was given as a box.
    pub object: Option<u32>,
    /// The portals that it closes when it is shut; the table takes it to be open.
    pub portals: Vec<u32>,
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

/// Writes the lines about the doors of a table; none without doors.
///
/// # Errors
/// Those of the writer.
pub fn write_doors(f: &mut fmt::Formatter<'_>, doors: &[DoorFacts]) -> fmt::Result {
    for (k, door) in doors.iter().enumerate() {
        writeln!(f, "{:<14} {door}", if k == 0 { "doors" } else { "" })?;
    }
    Ok(())
}

/// The keys and values that a table has for people, one object of texts in JSON.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct InfoFacts(
    #[cfg_attr(feature = "schemars", schemars(with = "std::collections::BTreeMap<String, String>"))]
    Vec<(String, String)>,
);

impl From<&[(String, String)]> for InfoFacts {
    fn from(info: &[(String, String)]) -> Self {
        Self(info.to_vec())
    }
}

impl Serialize for InfoFacts {
    fn serialize<S: serde::Serializer>(&self, out: S) -> Result<S::Ok, S::Error> {
        out.collect_map(self.0.iter().map(|(key, value)| (key, value)))
    }
}

impl fmt::Display for InfoFacts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|(key, value)| writeln!(f, "{key:<14} {value}"))
    }
}
