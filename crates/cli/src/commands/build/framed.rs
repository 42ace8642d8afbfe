//! The frame in which a scene is baked, what it brought, and what became of cells that stand along other axes.

use crate::output::{JsonSchema, Serialize, percent};
use sightlines::bake::{Along, Framed, PreparedBake};
use sightlines::report::FrameFacts;
use std::fmt;

/// From when on it is told that boxes around given cells are larger than these.
const TOLD: f64 = 1.01;

/// How a scene and its cells stand in the table.
#[derive(Debug, Clone, Copy, Default, Serialize, JsonSchema)]
pub(super) struct Placed {
    /// The frame of a scene whose walls, or whose given cells, do not stand along the axes of its file.
    #[serde(skip_serializing_if = "Option::is_none")]
    frame: Option<Taken>,
    /// How many times the surface of the given cells the boxes around them have, where these stand along other axes.
    #[serde(skip_serializing_if = "Option::is_none")]
    cells_growth: Option<f64>,
}

impl Placed {
    /// How what was prepared stands.
    pub(super) fn of(prepared: &PreparedBake<'_>) -> Self {
        let growth = prepared.decisions().cells_growth;
        Self { frame: prepared.framed().map(Taken::new), cells_growth: (growth > TOLD).then_some(growth) }
    }

    /// What a report in few words says of cells.
    pub(super) fn brief(&self) -> String {
        let frame = self.frame.map_or(String::new(), |taken| format!(", {}", taken.frame));
        let growth = self.cells_growth.map_or(String::new(), |growth| {
            format!(", boxes around the given ones, which stand along other axes, of {growth:.2} times the surface")
        });
        frame + &growth
    }
}

impl fmt::Display for Placed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.frame.iter().try_for_each(|frame| write!(f, "{frame}"))?;
        let Some(growth) = self.cells_growth else { return Ok(()) };
        writeln!(f, "given cells    stand along other axes: boxes around them, of {growth:.2} times the surface")
    }
}

/// Frame of a scene, and what it brought.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
struct Taken {
    #[serde(flatten)]
    frame: FrameFacts,
    /// What stands along the axes of the frame: `walls`, or the given `cells` where that suits the walls no worse, or most of them stand along no
    /// axes.
    along: &'static str,
    /// The largest distance of a coordinate from that of the file, along the axes of the frame.
    largest_move: f64,
    /// Corners of triangles.
    n_corners: usize,
    /// Corners that were moved, beyond rounding, to where others are.
    n_snapped_corners: usize,
    /// Share of the area of what hides that was across an axis of the file.
    axial_before: f64,
    /// Share that is across an axis of the frame.
    axial_after: f64,
}

impl Taken {
    fn new(framed: &Framed) -> Self {
        let Framed { frame, along, moved, before, after, .. } = framed;
        Self {
            frame: frame.into(),
            along: match along {
                Along::Walls => "walls",
                Along::Cells => "cells",
            },
            largest_move: moved.most,
            n_corners: moved.n_corners,
            n_snapped_corners: moved.n_snapped,
            axial_before: before.axial_share(),
            axial_after: after.axial_share(),
        }
    }
}

impl fmt::Display for Taken {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "frame          {}", self.frame)?;
        if self.along == "cells" {
            writeln!(f, "               along the given cells")?;
        }
        let [before, after] = [self.axial_before, self.axial_after].map(percent);
        writeln!(f, "               {before} of the wall area was across an axis, {after} is")?;
        let (snapped, n) = (self.n_snapped_corners, self.n_corners);
        writeln!(f, "               {snapped} of {n} corners moved, by at most {:.2e} units", self.largest_move)
    }
}
