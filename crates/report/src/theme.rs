//! Colours and stroke widths.

/// Behind everything.
pub(crate) const PAPER: &str = "#ffffff";
/// A cell whose visibility is not shown.
pub(crate) const CELL: &str = "#e8ecf1";
/// A cell that is not seen.
pub(crate) const HIDDEN: &str = "#eceef1";
/// A cell that is seen. Colour-blind eyes can distinguish blue from orange too.
pub(crate) const SEEN: &str = "#8fc4f5";
/// A cell that the viewer's cell sees, and the viewer does not.
pub(crate) const SEEN_BY_CELL: &str = "#cfe4fa";
/// What is seen from a point, in part transparent.
pub(crate) const AREA: &str = "#2f6fb3";
/// The cell looked from.
pub(crate) const FROM: &str = "#f0701a";
/// The cell looked for.
pub(crate) const TARGET: &str = "#8a5cd6";
/// Words and scale bars.
pub(crate) const INK: &str = "#1c2733";
/// What blocks sight.
pub(crate) const WALL: &str = "#1c2733";
/// Portals, where they are what the picture shows.
pub(crate) const PORTAL: &str = "#12a594";
/// Portals in the background.
pub(crate) const PORTAL_FAINT: &str = "#ffffff";
/// A line of sight and the doors that it passes.
pub(crate) const SIGHTLINE: &str = "#d6246e";
/// A surface of the scene that is not seen.
pub(crate) const SURFACE_HIDDEN: &str = "#9aa5b1";
/// A surface of the scene that hides nothing.
pub(crate) const SEE_THROUGH: &str = "#12a594";
/// A surface of the scene that lies in the plane of the picture.
pub(crate) const FLAT: &str = "#c3cad2";
/// An object that is visible, or whose visibility is not shown.
pub(crate) const OBJECT: &str = "#51616f";
/// An object that is not seen.
pub(crate) const OBJECT_HIDDEN: &str = "#c3cad2";

/// Light fills for the groups of cells, in turn.
pub(crate) const GROUPS: [&str; 8] =
    ["#dbe9f6", "#fbe6cf", "#dcefdc", "#eee0f2", "#fdf3c8", "#d7eef0", "#f8dfe0", "#e6e6e0"];

/// The top, the left and the right face of a box whose visibility is not shown.
pub(crate) const CELL_SHADES: [&str; 3] = ["#eef2f6", "#c9d3de", "#dbe2ea"];
/// The faces of a box that is seen.
pub(crate) const SEEN_SHADES: [&str; 3] = ["#b4d9fa", "#5b9fdc", "#8fc4f5"];
/// The faces of the box looked from.
pub(crate) const FROM_SHADES: [&str; 3] = ["#ff9a52", "#c2540c", "#f0701a"];
/// The faces of the box looked for.
pub(crate) const TARGET_SHADES: [&str; 3] = ["#b08ceb", "#6a3fb5", "#8a5cd6"];
/// The faces of a box that the viewer's cell sees, and the viewer does not.
pub(crate) const SEEN_BY_CELL_SHADES: [&str; 3] = ["#e1effc", "#a9c9e8", "#cfe4fa"];
/// The faces of a box that is not seen.
pub(crate) const HIDDEN_SHADES: [&str; 3] = ["#f3f4f6", "#d2d6db", "#e3e6ea"];
/// Surfaces in front of which no cell is.
pub(crate) const SURFACE_OUTSIDE: &str = "#f6f1e4";
/// The edges of boxes.
pub(crate) const EDGE_HIDDEN: &str = "#9aa5b1";

/// Stroke widths in pixels.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Strokes {
    /// Of walls.
    pub(crate) wall: f64,
    /// Of portals.
    pub(crate) portal: f64,
    /// Of a line of sight.
    pub(crate) line: f64,
    /// Of the border around the cells looked from and for; also the radius of small marks.
    pub(crate) mark: f64,
}

impl Strokes {
    /// Strokes that leave cells visible: `cell` is the side of a square as large as a mean cell, `size`
    /// the longer side of the picture, both in pixels.
    pub(crate) fn for_cells(cell: f64, size: f64) -> Self {
        let most = size / 500.0;
        let wall = (cell * 0.07).clamp(most * 0.3, most * 1.1).max(0.4);
        Self { wall, portal: wall * 0.6, line: (wall * 1.1).max(most * 0.7), mark: most * 1.6 }
    }
}
