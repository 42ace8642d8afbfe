//! How much was confirmed, sampled and left alone.

/// Of what the table shows, how much rays were seen to reach: a hint how tight it is. What no ray reached may be seen all the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Confirmed {
    /// Pairs that the table shows.
    pub visible: u64,
    /// Of these, pairs that a ray joined.
    pub confirmed: u64,
    /// Pairs that the table hides.
    pub hidden: u64,
    /// Of these, pairs that rays were aimed at.
    pub aimed: u64,
}

impl Confirmed {
    /// The share of the visible pairs that were confirmed; 1 if there are none.
    pub fn share(&self) -> f64 {
        if self.visible == 0 { 1.0 } else { self.confirmed as f64 / self.visible as f64 }
    }
}

/// Hidden pairs that as many random segments were shot at each, everywhere alike.
///
/// Where cells leave no gaps, a pair is a cell and a cell, or an object, of which each is next to something that is visible from the other, and its segments are those
/// that pass such neighbours: any free segment of a hidden pair is one of these, of this pair or of a nearer one. Where cells leave gaps, all hidden pairs; if there are very many,
/// some of them, chosen at random.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Sampled {
    /// Number of pairs.
    pub n_pairs: u64,
    /// Segments for each of them.
    pub n_each: u64,
}

impl Sampled {
    /// The share of free segments from which on one of the pairs is found in 99 of 100 runs, unless a nearer pair is wrong as well: with n segments each, 1 - 0.01^(1/n); 1 if none were shot.
    pub fn share_found(&self) -> f64 {
        if self.n_each == 0 { 1.0 } else { -(0.01f64.ln() / self.n_each as f64).exp_m1() }
    }
}

/// What is not tight, or was not looked at: nothing that a table must not have.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct Remarks {
    /// Portals of plans that an opaque line crosses or runs along, where more is listed than needed; no violation.
    #[cfg_attr(feature = "serde", serde(rename = "n_portals_in_walls"))]
    pub portals_in_walls: u64,
    /// Objects listed in a cell that they do not touch; no violation.
    #[cfg_attr(feature = "serde", serde(rename = "n_listed_apart"))]
    pub listed_apart: u64,
    /// Cells from which no ray was shot: too thin to contain a place, or without a portal where only portals are known.
    #[cfg_attr(feature = "serde", serde(rename = "n_cells_without_places"))]
    pub cells_without_places: u64,
    /// Of the doors, those that were not compared: given as boxes, which the table does not state, or objects of plans and maps; no violation.
    #[cfg_attr(feature = "serde", serde(rename = "n_doors_as_boxes"))]
    pub doors_as_boxes: u64,
    /// Pairs of a door and a portal that its leaf covers, and that the door does not close; no violation.
    #[cfg_attr(feature = "serde", serde(rename = "n_unlisted_door_portals"))]
    pub unlisted_door_portals: u64,
    /// Hidden pairs of a table with a frame that a ray joins in the scene as the file has it, and not in the scene along the frame: what they
    /// see of each other, they see through openings narrower than the gap or past things thinner than it, which the premise allows.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub cracks: u64,
    /// Triangles that have an area in the file and none along the frame: they are thinner than the gap.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub flattened: u64,
}
