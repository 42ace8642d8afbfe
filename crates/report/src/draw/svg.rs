//! Pieces of SVG that all pictures use.

use crate::frame::Px;
use crate::theme;
use sightlines_pvs::CellId;
use std::fmt::Write;

/// The beginning of a picture of so many pixels, up to its empty paper.
pub(super) fn open(title: &str, [width, height]: [u32; 2]) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\" stroke-linecap=\"round\" stroke-linejoin=\"round\">\n\
         <title>{title}</title>\n<rect width=\"100%\" height=\"100%\" fill=\"{}\"/>\n",
        theme::PAPER
    )
}

/// The end of a picture.
pub(super) const CLOSE: &str = "</svg>\n";

/// A title.
pub(super) fn seen_from_cell(cell: CellId) -> String {
    format!("What cell {} sees", cell.0)
}

/// A title: of the viewer's own set, or of that of the cell that they are in.
pub(super) fn seen_from_point(point: &[f64], is_narrowed: bool) -> String {
    let numbers: Vec<String> = point.iter().map(|&x| short(x)).collect();
    let who = if is_narrowed { "a viewer at" } else { "the cell of" };
    format!("What {who} ({}) sees", numbers.join(", "))
}

/// A coordinate as titles have it: six digits, which is what a reader wants of it.
pub(super) fn short(x: f64) -> String {
    format!("{x:.5e}").parse().map_or_else(|_| x.to_string(), |rounded: f64| rounded.to_string())
}

/// Adds a path that is filled, if there is any.
pub(super) fn fill(svg: &mut String, path: &str, colour: &str) {
    if !path.is_empty() {
        let _ = writeln!(svg, "<path d=\"{path}\" fill=\"{colour}\"/>");
    }
}

/// Adds a path that is drawn as a line, if there is any.
pub(super) fn stroke(svg: &mut String, path: &str, colour: &str, width: f64) {
    if !path.is_empty() {
        let _ = writeln!(svg, "<path d=\"{path}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{}\"/>", Px(width));
    }
}

/// Adds a dot with a light rim.
pub(super) fn dot(svg: &mut String, [x, y]: [f64; 2], radius: f64, colour: &str) {
    let _ = writeln!(
        svg,
        "<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"{colour}\" stroke=\"{}\" stroke-width=\"{}\"/>",
        Px(x),
        Px(y),
        Px(1.2 * radius),
        theme::PAPER,
        Px(0.4 * radius)
    );
}
