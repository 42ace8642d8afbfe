//! The lines about a table that several commands print.

use crate::output::{count, percent, seconds};
use sightlines::report::Summary;
use std::fmt;
use std::time::Duration;

/// Cells, portals, visible pairs, and what has to be drawn; a share of the floor that is no number is not known.
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
pub(super) fn times(cut_seconds: f64, what: &str, see_seconds: f64) -> String {
    let [cut, see] = [cut_seconds, see_seconds].map(|s| seconds(Duration::from_secs_f64(s)));
    format!("{cut} to cut the {what}, {see} to find out who sees whom")
}
