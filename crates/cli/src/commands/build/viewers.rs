//! Where viewers can be, as the file of a scene states it, or as far as what is around it is not where they are.

use crate::output::{JsonSchema, Serialize};
use sightlines::bake::StatedViewers;
use std::fmt;

/// Region of viewers that a file states.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
pub(super) struct Viewers {
    /// Objects with the role `view-volume`.
    n_volumes: usize,
    /// Lower corner of the box around them.
    min: [f64; 3],
    /// Upper corner.
    max: [f64; 3],
}

impl From<StatedViewers> for Viewers {
    fn from(StatedViewers { n_volumes, region }: StatedViewers) -> Self {
        Self { n_volumes, min: region.min, max: region.max }
    }
}

impl Viewers {
    const fn volumes(&self) -> &'static str {
        if self.n_volumes == 1 { "the view volume" } else { "the view volumes" }
    }

    /// What a report in few words says of cells.
    pub(super) fn brief(&self) -> String {
        format!(", in {} of the file", self.volumes())
    }
}

impl fmt::Display for Viewers {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { min: [x0, y0, z0], max: [x1, y1, z1], .. } = self;
        let volumes = self.volumes();
        writeln!(f, "viewers        in {volumes} of the file: ({x0}, {y0}, {z0}) to ({x1}, {y1}, {z1})")
    }
}

/// So many objects are named in a report.
const NAMED: usize = 3;

/// The names of objects around everything else in a scene, for people.
pub(super) struct Surroundings<'a>(pub(super) &'a [String]);

impl Surroundings<'_> {
    fn names(&self) -> String {
        let names: Vec<String> = self.0.iter().take(NAMED).map(|name| format!("{name:?}")).collect();
        let n_more = self.0.len() - names.len();
        names.join(", ") + &if n_more == 0 { String::new() } else { format!(" and {n_more} more") }
    }

    /// What a report in few words says of cells.
    pub(super) fn brief(&self) -> String {
        if self.0.is_empty() {
            String::new()
        } else {
            format!(", none between them and {}, which all see", self.names())
        }
    }
}

impl fmt::Display for Surroundings<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.is_empty() {
            return Ok(());
        }
        writeln!(f, "around it      {}: seen from every cell; the rest is baked without", self.names())
    }
}
