//! Drawings, written group by group.

use std::fmt::{Display, Write};

/// A drawing that is being written.
#[derive(Debug, Clone, Default)]
pub(crate) struct Dxf(String);

impl Dxf {
    /// Some groups.
    pub(crate) fn new() -> Self {
        Self::default()
    }

    /// Adds a group.
    pub(crate) fn put(mut self, code: i32, value: impl Display) -> Self {
        writeln!(self.0, "{code:>3}\n{value}").expect("a text");
        self
    }

    /// Adds other groups.
    pub(crate) fn add(mut self, other: &Self) -> Self {
        self.0.push_str(&other.0);
        self
    }

    /// Begins an entity on a layer.
    pub(crate) fn entity(self, kind: &str, layer: &str) -> Self {
        self.put(0, kind).put(8, layer)
    }

    /// Adds a point whose x has this code.
    pub(crate) fn at(self, code: i32, [x, y]: [f64; 2]) -> Self {
        self.put(code, x).put(code + 10, y)
    }

    /// Adds a line.
    pub(crate) fn line(self, layer: &str, a: [f64; 2], b: [f64; 2]) -> Self {
        self.entity("LINE", layer).at(10, a).at(11, b)
    }

    /// Adds a polyline of newer versions; each vertex has a bulge.
    pub(crate) fn path(self, closed: bool, vertices: &[([f64; 2], f64)]) -> Self {
        let begun = self.entity("LWPOLYLINE", "0").put(90, vertices.len()).put(70, u8::from(closed));
        vertices.iter().fold(begun, |dxf, &(p, bulge)| dxf.at(10, p).put(42, bulge))
    }

    /// Adds a polyline of any version.
    pub(crate) fn old_path(self, closed: bool, vertices: &[([f64; 2], f64)]) -> Self {
        let begun = self.entity("POLYLINE", "0").put(66, 1).at(10, [0.0, 0.0]).put(70, u8::from(closed));
        let all = vertices.iter().fold(begun, |dxf, &(p, bulge)| dxf.entity("VERTEX", "0").at(10, p).put(42, bulge));
        all.put(0, "SEQEND")
    }

    /// Adds an insert, to which more groups may be added.
    pub(crate) fn insert(self, block: &str, at: [f64; 2]) -> Self {
        self.entity("INSERT", "0").put(2, block).at(10, at)
    }

    /// These entities as a block.
    pub(crate) fn as_block(&self, name: &str, base: [f64; 2]) -> Self {
        Self::new().entity("BLOCK", "0").put(2, name).put(70, 0).at(10, base).add(self).put(0, "ENDBLK")
    }

    /// These groups as a section.
    pub(crate) fn as_section(&self, name: &str) -> Self {
        Self::new().put(0, "SECTION").put(2, name).add(self).put(0, "ENDSEC")
    }

    /// These sections as a file.
    pub(crate) fn as_file(&self) -> Vec<u8> {
        self.clone().put(0, "EOF").0.into_bytes()
    }

    /// A file with these blocks, and these as the entities of the model.
    pub(crate) fn model(&self, blocks: &Self) -> Vec<u8> {
        blocks.as_section("BLOCKS").add(&self.as_section("ENTITIES")).as_file()
    }

    /// A table of layers: name, flags and colour.
    pub(crate) fn layers(all: &[(&str, u8, i8)]) -> Self {
        let begun = Self::new().put(0, "TABLE").put(2, "LAYER").put(70, all.len());
        let add = |dxf: Self, &(name, flags, colour): &(&str, u8, i8)| {
            dxf.put(0, "LAYER").put(2, name).put(70, flags).put(62, colour).put(6, "CONTINUOUS")
        };
        all.iter().fold(begun, add).put(0, "ENDTAB").as_section("TABLES")
    }
}

/// All that is read, and something of what is not: layers, blocks in blocks, every kind of curve.
pub(crate) fn small_drawing() -> Vec<u8> {
    let header = Dxf::new().put(9, "$ACADVER").put(1, "AC1015").put(9, "$INSUNITS").put(70, 6).as_section("HEADER");
    let layers = Dxf::layers(&[("0", 0, 7), ("Walls", 0, 1), ("Old", 1, 2), ("Hidden", 0, -3)]);
    let leaf =
        Dxf::new().line("0", [0.0, 0.0], [1.0, 0.0]).line("Old", [0.0, 0.0], [0.0, 1.0]).as_block("leaf", [0.5, 0.0]);
    let twig = Dxf::new().insert("leaf", [1.0, 1.0]).put(50, 90).path(true, &[([0.0, 0.0], 0.5), ([2.0, 1.0], 0.0)]);
    let blocks = leaf.add(&twig.as_block("twig", [0.0, 0.0])).as_section("BLOCKS");
    let knots = [0, 0, 0, 0, 1, 1, 1, 1];
    let spline = Dxf::new().entity("SPLINE", "Walls").put(70, 8).put(71, 3).put(72, 8).put(73, 4);
    let spline = knots.iter().fold(spline, |dxf, knot| dxf.put(40, knot));
    let spline =
        [[0.0, 9.0], [1.0, 11.0], [2.0, 7.0], [3.0, 9.0]].iter().fold(spline, |dxf, &p| dxf.at(10, p).put(30, 0));
    let model = Dxf::new()
        .line("Walls", [0.0, 0.0], [12.5, 0.0])
        .line("Hidden", [0.0, 0.0], [12.5, 6.0])
        .old_path(true, &[([0.0, 0.0], 0.0), ([12.5, 6.0], -0.25), ([0.0, 6.0], 0.0)])
        .entity("CIRCLE", "Walls")
        .at(10, [4.0, 3.0])
        .put(40, 0.25)
        .entity("ARC", "Walls")
        .at(10, [6.0, 3.0])
        .put(40, 1.5)
        .put(50, 30)
        .put(51, 200)
        .put(230, -1)
        .entity("ELLIPSE", "Walls")
        .at(10, [9.0, 3.0])
        .at(11, [1.0, 0.5])
        .put(40, 0.5)
        .put(41, 0)
        .put(42, 3.5)
        .add(&spline)
        .insert("twig", [3.0, 4.0])
        .put(41, 2)
        .put(42, -0.5)
        .put(50, 15)
        .put(70, 2)
        .put(71, 2)
        .put(44, 3)
        .put(45, 1)
        .entity("TEXT", "Walls")
        .at(10, [1.0, 1.0])
        .put(40, 0.2)
        .put(1, "kitchen");
    header.add(&layers).add(&blocks).add(&model.as_section("ENTITIES")).as_file()
}
