//! The page: one HTML file that carries all it needs.

use crate::figure::Figure;
use crate::payload::{harmless_json, hash_source, packed};
use crate::reasons::Reasons;
use serde::Serialize;
use sightlines_pvs::Table;
use std::fmt::Write as _;

/// The scripts, in the order in which they are read. Together they are one script. Those of `reader` are modules, which the package for
/// browsers has as well.
const SCRIPTS: [&str; 20] = [
    include_str!("../web/reader/bytes.js"),
    include_str!("../web/reader/geometry.js"),
    include_str!("../web/reader/rows.js"),
    include_str!("../web/reader/table.js"),
    include_str!("../web/reader/plain.js"),
    include_str!("../web/reader/soon.js"),
    include_str!("../web/reader/methods.js"),
    include_str!("../web/bytes.js"),
    include_str!("../web/figure.js"),
    include_str!("../web/colours.js"),
    include_str!("../web/change.js"),
    include_str!("../web/links.js"),
    concat!(include_str!("../web/soon.js"), "\n", include_str!("../web/model.js")),
    include_str!("../web/map.js"),
    include_str!("../web/camera.js"),
    concat!(include_str!("../web/why.js"), "\n", include_str!("../web/isovist.js")),
    include_str!("../web/space.js"),
    include_str!("../web/panel.js"),
    include_str!("../web/walk.js"),
    include_str!("../web/main.js"),
];
const SHELL: &str = include_str!("../web/shell.html");
const STYLE: &str = include_str!("../web/style.css");

/// What a page is made of.
#[derive(Debug, Clone)]
pub struct Page<'a> {
    /// The heading: plain text, whatever is in it.
    pub title: &'a str,
    /// The table's file, for the commands that the page names.
    pub table_name: &'a str,
    /// The table.
    pub table: &'a Table,
    /// What is drawn beside it; without, cells and boxes of objects are.
    pub figure: Option<&'a Figure>,
    /// An older table of the same cells, to compare with.
    pub against: Option<&'a Table>,
    /// Why cells see each other, and why they do not.
    pub reasons: Option<&'a Reasons>,
    /// A walk to replay; may be empty.
    pub walk: Vec<WalkerPose>,
    /// The most bytes of the page; the smallest triangles are left out above it.
    pub max_bytes: usize,
}

/// Where a walker is in a frame, and looks to; z is 0 in a plane.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct WalkerPose {
    /// The eye, in scene units.
    pub eye: [f64; 3],
    /// The direction, of any length.
    pub dir: [f64; 3],
}

/// A page, and what was left out of it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Written {
    /// The file.
    pub html: String,
    /// Triangles that are not on it.
    pub n_left_out: usize,
    /// Lines of sight on it: all that were given, or none if it would have become too large.
    pub n_lines: usize,
}

/// Why no page can be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PageError {
    /// The figure has another number of objects than the table.
    #[error("the scene has {scene} objects and the table {table}: it was made from another scene")]
    Objects {
        /// Objects of the figure.
        scene: usize,
        /// Objects of the table.
        table: usize,
    },
    /// A figure of the plane for a table of space, or the other way round.
    #[error("the table has {table} dimensions, and the scene does not")]
    Dimension {
        /// Of the table.
        table: u8,
    },
    /// The older table has other cells.
    #[error(
        "the tables have {now} and {before} cells, or cells at different places, so their pairs cannot be compared"
    )]
    Against {
        /// Cells of the table.
        now: usize,
        /// Cells of the older one.
        before: usize,
    },
    /// Even without triangles the page would be larger than it may be.
    #[error("the page would have {bytes} bytes without any triangle, and may have {max}")]
    TooLarge {
        /// Of the page.
        bytes: usize,
        /// The bound.
        max: usize,
    },
    /// Memory or a number failed while the page was written.
    #[error("the page could not be written: {0}")]
    Write(String),
}

/// What the page reads first.
#[derive(Serialize)]
struct Head<'a> {
    title: &'a str,
    table: &'a str,
    figure: Option<FigureHead>,
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    walk: &'a [WalkerPose],
    /// Visible pairs, and how many of them some line joins.
    joined: Option<[usize; 2]>,
}

#[derive(Serialize)]
struct FigureHead {
    origin: [f64; 3],
    walls: usize,
    vertices: usize,
    triangles: usize,
    objects: usize,
    notice: Option<String>,
}

impl FigureHead {
    fn new(figure: &Figure, table: &Table) -> Self {
        let n = figure.n_left_out;
        let all = n + figure.n_triangles();
        let left_out = format!("The {n} smallest of {all} triangles are left out of this page to keep it small.");
        let backs = about_backs(table).filter(|_| figure.is_single_sided);
        let notices: Vec<&str> = (n > 0).then_some(&*left_out).into_iter().chain(backs).collect();
        Self {
            origin: figure.origin,
            walls: figure.walls.len(),
            vertices: figure.vertices.len(),
            triangles: figure.triangles.len(),
            objects: figure.n_objects(),
            notice: (!notices.is_empty()).then(|| notices.join(" ")),
        }
    }
}

/// How the table and this page, which draws both sides of all faces, go together in a scene with single-sided faces. Nothing, where the table is
/// right for every engine.
fn about_backs(table: &Table) -> Option<&'static str> {
    let (_, backs) = table.info().iter().find(|(key, _)| key == "backs")?;
    match &**backs {
        "drawn" => Some(
            "The table was built with --backs drawn, and the scene has single-sided faces: what is behind their backs counts as hidden. \
             This page draws these backs; in an engine that does not, what is seen through them may be missing.",
        ),
        "culled" => Some(
            "The table was built with --backs culled, and the scene has single-sided faces: from behind, these count as hidden. \
             This page draws the backs of what may be seen, and they cover what is seen through them.",
        ),
        _ => None,
    }
}

impl<'a> Page<'a> {
    /// The most bytes unless stated otherwise: 200 MB.
    pub const MAX_BYTES: usize = 200_000_000;

    /// A page of a table alone.
    pub fn new(title: &'a str, table_name: &'a str, table: &'a Table) -> Self {
        Self {
            title,
            table_name,
            table,
            figure: None,
            against: None,
            reasons: None,
            walk: Vec::new(),
            max_bytes: Self::MAX_BYTES,
        }
    }

    /// Writes the page. O(table + figure), some hundred megabytes a second.
    ///
    /// # Errors
    /// [`PageError`] for a figure or an older table that does not belong to the table, and for a table that is too large.
    pub fn html(&self) -> Result<Written, PageError> {
        self.check()?;
        let pack = |bytes: Option<Vec<u8>>| {
            bytes.map(|bytes| packed(&bytes)).transpose().map_err(|e| PageError::Write(e.to_string()))
        };
        let mut carried = [
            ("table", pack(Some(lookup_bytes(self.table)))?),
            ("against", pack(self.against.map(lookup_bytes))?),
            ("reasons", pack(self.reasons.map(Reasons::to_bytes))?),
        ];
        let mut without = self.assemble(&carried, None)?;
        let mut n_lines = self.reasons.map_or(0, |reasons| reasons.lines.len());
        if without.len() > self.max_bytes && n_lines > 0 {
            // What is seen matters more than why.
            (carried[2].1, n_lines) = (None, 0);
            without = self.assemble(&carried, None)?;
        }
        let Some(figure) = self.figure else { return self.bounded(without, 0, n_lines) };
        let mut most = figure.n_triangles();
        loop {
            let shown = figure.with_at_most(most);
            let page = self.assemble(&carried, Some(&shown))?;
            if page.len() <= self.max_bytes || most == 0 {
                return self.bounded(page, shown.n_left_out, n_lines);
            }
            // As many as should fit, and a tenth less each time that they do not.
            let (room, share) = (self.max_bytes.saturating_sub(without.len()), page.len() - without.len());
            let fitting = most as f64 * (room as f64 / share.max(1) as f64).min(1.0) * 0.9;
            most = (fitting as usize).min(most - 1);
        }
    }

    fn bounded(&self, html: String, n_left_out: usize, n_lines: usize) -> Result<Written, PageError> {
        match html.len() <= self.max_bytes {
            true => Ok(Written { html, n_left_out, n_lines }),
            false => Err(PageError::TooLarge { bytes: html.len(), max: self.max_bytes }),
        }
    }

    fn check(&self) -> Result<(), PageError> {
        let dimension = self.table.dimension();
        if let Some(figure) = self.figure {
            let (scene, table) = (figure.n_objects(), self.table.objects().len());
            let is_flat = !figure.walls.is_empty();
            if is_flat && dimension == 3 || figure.n_triangles() > 0 && dimension == 2 {
                return Err(PageError::Dimension { table: dimension });
            }
            if dimension == 3 && scene != table {
                return Err(PageError::Objects { scene, table });
            }
        }
        match self.against {
            Some(old) if old.cells() != self.table.cells() || old.frame() != self.table.frame() => {
                Err(PageError::Against { now: self.table.n_cells(), before: old.n_cells() })
            }
            _ => Ok(()),
        }
    }

    fn assemble(&self, carried: &[(&str, Option<String>)], figure: Option<&Figure>) -> Result<String, PageError> {
        let failed = |error: &dyn std::fmt::Display| PageError::Write(error.to_string());
        let head = Head {
            title: self.title,
            table: self.table_name,
            figure: figure.map(|figure| FigureHead::new(figure, self.table)),
            walk: &self.walk,
            joined: self.reasons.map(|reasons| [reasons.n_pairs, reasons.n_joined]),
        };
        let head = harmless_json(&head).map_err(|e| failed(&e))?;
        let figure = figure.map(|figure| packed(&figure.to_bytes())).transpose().map_err(|e| failed(&e))?;
        let script = format!("\"use strict\";\n(() => {{\n{}\n}})();\n", SCRIPTS.map(without_modules).join("\n"));
        let policy = format!(
            "default-src 'none'; script-src {}; style-src {}; img-src blob: data:; base-uri 'none'; form-action 'none'",
            hash_source(&script),
            hash_source(STYLE)
        );
        let mut html = format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta http-equiv=\"Content-Security-Policy\" content=\"{policy}\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <title>sightlines</title>\n<style>{STYLE}</style>\n</head>\n<body>\n{SHELL}\
             <script type=\"application/json\" id=\"head\">{head}</script>\n"
        );
        let figure = ("figure", figure);
        for (id, bytes) in carried.iter().chain([&figure]) {
            if let Some(bytes) = bytes {
                writeln!(html, "<script type=\"application/octet-stream\" id=\"{id}\">{bytes}</script>")
                    .map_err(|e| failed(&e))?;
            }
        }
        html.push_str("<script>");
        html.push_str(&script);
        html.push_str("</script>\n</body>\n</html>\n");
        Ok(html)
    }
}

/// The bytes of what the page asks a table for: all but the stab trees, the mirrors, the doors and the parts of objects.
fn lookup_bytes(table: &Table) -> Vec<u8> {
    let mut less = table.parts().clone();
    (less.stab, less.object_parts) = (None, None);
    (less.mirrors, less.doors, less.object_sources) = (Vec::new(), Vec::new(), Vec::new());
    // A table stays one without these parts.
    Table::new(less).map_or_else(|_| table.to_bytes(), |less| less.to_bytes())
}

/// A module as a part of a larger script: lines that import are left out, and nothing is exported.
fn without_modules(module: &str) -> String {
    let lines = module.lines().filter(|line| !line.starts_with("import "));
    lines.map(|line| line.strip_prefix("export ").unwrap_or(line)).collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn modules_become_parts_of_a_script() {
        let module = "// A module.\nimport { a } from \"./a.js\";\nexport function b() {\n  return a;\n}\n";
        assert_eq!(without_modules(module), "// A module.\nfunction b() {\n  return a;\n}");
        let rest = SCRIPTS.map(without_modules).join("\n");
        let is_left =
            |line: &str| line.starts_with("import") || line.starts_with("export") || line.starts_with("} from");
        assert!(!rest.lines().any(is_left), "statements that import are on one line");
        assert!(SCRIPTS.iter().any(|script| script.lines().any(is_left)), "there are modules");
    }
}
