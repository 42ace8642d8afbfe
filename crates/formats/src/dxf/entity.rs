//! The entities of a drawing, in their own coordinates.

mod compound;

use super::affine::Insert;
use super::groups::{Group, Groups, extension, next_record};
use super::layers::Layers;
use super::spline::Spline;
use super::text::decode;
use crate::error::{Malformed, malformed};
use compound::{hatch, multiline, solid};

/// An entity, and what concerns all of them.
#[derive(Debug)]
pub(super) struct Entity {
    /// Line of the text at which it begins.
    pub(super) line: usize,
    pub(super) layer: u32,
    pub(super) normal: [f64; 3],
    pub(super) shown: Shown,
    pub(super) shape: Shape,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Shown {
    Model,
    /// On a sheet.
    Paper,
    /// Nowhere.
    Nowhere,
}

/// What an entity is. Coordinates are those of the block that it is in, or, where noted, its own.
#[derive(Debug)]
pub(super) enum Shape {
    Line([[f64; 3]; 2]),
    /// Vertices, each with the bulge of the step to the next.
    Path {
        vertices: Vec<([f64; 3], f64)>,
        is_closed: bool,
        /// Whether the coordinates are its own.
        is_own: bool,
    },
    /// Own coordinates, angles in degrees, counter-clockwise; a circle has none.
    Arc {
        center: [f64; 3],
        radius: f64,
        angles: Option<[f64; 2]>,
    },
    /// The minor axis is the major one turned about the extrusion direction and scaled by the ratio; parameters in radians.
    Ellipse {
        center: [f64; 3],
        major: [f64; 3],
        ratio: f64,
        parameters: [f64; 2],
    },
    Spline(Spline),
    /// Several that were made as one.
    Parts {
        parts: Vec<Shape>,
        /// Whether they are the border of a filled area, and walls only on a layer that was asked for.
        is_filling: bool,
    },
    /// Own coordinates.
    Insert(Insert),
    /// Not read: its kind.
    Other(Box<str>),
}

pub(super) enum Read<'a> {
    Entity(Entity),
    /// Something that is no entity of its own.
    Nothing,
    /// The record that ends a list of entities.
    End(Group<'a>),
}

pub(super) struct Fields<'f, 'a> {
    pub(super) kind: &'static str,
    pub(super) line: usize,
    pub(super) groups: &'f [Group<'a>],
}

impl<'a> Fields<'_, 'a> {
    pub(super) fn find(&self, code: i32) -> Option<&Group<'a>> {
        self.groups.iter().find(|group| group.code == code)
    }

    pub(super) fn number(&self, code: i32, default: f64) -> Result<f64, Malformed> {
        self.find(code).map_or(Ok(default), Group::number)
    }

    pub(super) fn integer(&self, code: i32) -> Result<i64, Malformed> {
        self.find(code).map_or(Ok(0), Group::integer)
    }

    fn needed(&self, code: i32, what: &str) -> Result<f64, Malformed> {
        self.find(code).ok_or_else(|| self.missing(what))?.number()
    }

    pub(super) fn missing(&self, what: &str) -> Malformed {
        malformed!("the {} has no {what}", self.kind).on_line(self.line)
    }

    /// The point whose x has this code; y and z follow in steps of ten. Without z it is at height 0.
    pub(super) fn point(&self, code: i32, what: &str) -> Result<[f64; 3], Malformed> {
        Ok([self.needed(code, what)?, self.needed(code + 10, what)?, self.number(code + 20, 0.0)?])
    }

    pub(super) fn normal(&self) -> Result<[f64; 3], Malformed> {
        Ok([self.number(210, 0.0)?, self.number(220, 0.0)?, self.number(230, 1.0)?])
    }

    pub(super) fn numbers(&self, code: i32) -> Result<Vec<f64>, Malformed> {
        self.groups.iter().filter(|group| group.code == code).map(Group::number).collect()
    }
}

pub(super) fn read_entity<'a>(groups: &mut Groups<'a>, layers: &mut Layers) -> Result<Read<'a>, Malformed> {
    let mut buffer = Vec::new();
    let record = next_record(groups, &mut buffer)?;
    let fields = |kind| Fields { kind, line: record.line, groups: &buffer };
    let shape = match record.value {
        b"ENDSEC" | b"ENDBLK" => return Ok(Read::End(record)),
        // The end of a list of attributes.
        b"SEQEND" => return Ok(Read::Nothing),
        b"LINE" => {
            let line = fields("LINE");
            Shape::Line([line.point(10, "start")?, line.point(11, "end")?])
        }
        b"LWPOLYLINE" => light_polyline(&fields("LWPOLYLINE"))?,
        b"POLYLINE" => polyline(&fields("POLYLINE"), groups)?,
        b"CIRCLE" => arc(&fields("CIRCLE"), false)?,
        b"ARC" => arc(&fields("ARC"), true)?,
        b"ELLIPSE" => ellipse(&fields("ELLIPSE"))?,
        b"SPLINE" => spline(&fields("SPLINE"))?,
        b"MLINE" => understood(multiline(&fields("MLINE"))?, "MLINE that is not understood"),
        b"SOLID" => solid(&fields("SOLID"))?,
        b"TRACE" => solid(&fields("TRACE"))?,
        b"HATCH" => understood(hatch(&fields("HATCH")), "HATCH"),
        b"INSERT" => Shape::Insert(insert(&fields("INSERT"))?),
        kind => Shape::Other(decode(kind).into()),
    };
    let about = fields("entity");
    let layer = layers.id(about.find(8).map_or(&b"0"[..], |group| group.value));
    let (is_paper, is_invisible) = (about.integer(67)? == 1, about.integer(60)? == 1);
    let shown = match (is_paper, is_invisible) {
        (true, _) => Shown::Paper,
        (_, true) => Shown::Nowhere,
        _ => Shown::Model,
    };
    let normal = about.normal()?;
    Ok(Read::Entity(Entity { line: record.line, layer, normal, shown, shape }))
}

/// A shape, or something that is ignored under a name.
fn understood(shape: Option<Shape>, name: &str) -> Shape {
    shape.unwrap_or_else(|| Shape::Other(name.into()))
}

fn light_polyline(fields: &Fields<'_, '_>) -> Result<Shape, Malformed> {
    let height = fields.number(38, 0.0)?;
    let mut vertices: Vec<([f64; 3], f64)> = Vec::new();
    let mut has_y = true;
    for group in fields.groups {
        match (group.code, vertices.last_mut()) {
            (10, _) if has_y => {
                vertices.push(([group.number()?, 0.0, height], 0.0));
                has_y = false;
            }
            (20, Some((point, _))) if !has_y => (point[1], has_y) = (group.number()?, true),
            (10 | 20, _) => return Err(fields.missing("x or y of a vertex")),
            (42, Some((_, bulge))) => *bulge = group.number()?,
            _ => {}
        }
    }
    if !has_y {
        return Err(fields.missing("y of a vertex"));
    }
    Ok(Shape::Path { vertices, is_closed: fields.integer(70)? & 1 != 0, is_own: true })
}

mod flag {
    pub(super) const CLOSED: i64 = 1;
    pub(super) const SMOOTH: i64 = 4;
    pub(super) const IN_SPACE: i64 = 8;
    pub(super) const MESH: i64 = 16 | 64;
    /// Of a vertex: a control point, which the curve need not pass.
    pub(super) const CONTROL: i64 = 16;
}

/// Reads the vertices too, up to SEQEND.
fn polyline(fields: &Fields<'_, '_>, groups: &mut Groups<'_>) -> Result<Shape, Malformed> {
    let flags = fields.integer(70)?;
    let is_own = flags & flag::IN_SPACE == 0;
    let height = fields.number(30, 0.0)?;
    let mut vertices = Vec::new();
    let mut buffer = Vec::new();
    loop {
        let record = next_record(groups, &mut buffer)?;
        match record.value {
            b"SEQEND" => break,
            b"VERTEX" => {}
            _ => return Err(record.expected("VERTEX or SEQEND")),
        }
        let vertex = Fields { kind: "VERTEX", line: record.line, groups: &buffer };
        if flags & flag::MESH != 0 || (flags & flag::SMOOTH != 0 && vertex.integer(70)? & flag::CONTROL != 0) {
            continue;
        }
        let [x, y, z] = vertex.point(10, "place")?;
        let bulge = if is_own { vertex.number(42, 0.0)? } else { 0.0 };
        vertices.push(([x, y, if is_own { height } else { z }], bulge));
    }
    if flags & flag::MESH != 0 {
        return Ok(Shape::Other("POLYLINE (mesh)".into()));
    }
    Ok(Shape::Path { vertices, is_closed: flags & flag::CLOSED != 0, is_own })
}

fn arc(fields: &Fields<'_, '_>, has_angles: bool) -> Result<Shape, Malformed> {
    let radius = fields.needed(40, "radius")?;
    if radius < 0.0 {
        return Err(malformed!("a radius is {radius}, which cannot be").on_line(fields.line));
    }
    let angles = [fields.number(50, 0.0)?, fields.number(51, 360.0)?];
    Ok(Shape::Arc { center: fields.point(10, "centre")?, radius, angles: has_angles.then_some(angles) })
}

fn ellipse(fields: &Fields<'_, '_>) -> Result<Shape, Malformed> {
    Ok(Shape::Ellipse {
        center: fields.point(10, "centre")?,
        major: fields.point(11, "major axis")?,
        ratio: fields.needed(40, "ratio of its axes")?,
        parameters: [fields.number(41, 0.0)?, fields.number(42, std::f64::consts::TAU)?],
    })
}

fn spline(fields: &Fields<'_, '_>) -> Result<Shape, Malformed> {
    let [x, y] = [fields.numbers(10)?, fields.numbers(20)?];
    // A plane curve may have no heights.
    let mut z = fields.numbers(30)?;
    z.resize(z.len().max(if z.is_empty() { x.len() } else { 0 }), 0.0);
    if x.is_empty() {
        // Which curve passes the points that it should pass is up to each program.
        return Ok(Shape::Other("SPLINE without control points".into()));
    }
    if x.len() != y.len() || x.len() != z.len() {
        return Err(fields.missing("coordinate of a control point"));
    }
    let points = x.into_iter().zip(y).zip(z).map(|((x, y), z)| [x, y, z]).collect();
    let (degree, is_closed) = (fields.integer(71)?, fields.integer(70)? & 1 != 0);
    let spline = Spline::new(degree, fields.numbers(40)?, points, fields.numbers(41)?, is_closed);
    spline.map(Shape::Spline).map_err(|what| malformed!("the spline is malformed: {what}").on_line(fields.line))
}

fn insert(fields: &Fields<'_, '_>) -> Result<Insert, Malformed> {
    let block = fields.find(2).ok_or_else(|| fields.missing("name of a block"))?;
    let count = |code| Ok::<u32, Malformed>(fields.integer(code)?.clamp(1, i64::from(u32::MAX)) as u32);
    Ok(Insert {
        block: decode(block.value),
        at: fields.point(10, "place")?,
        scale: [fields.number(41, 1.0)?, fields.number(42, 1.0)?, fields.number(43, 1.0)?],
        rotation: fields.number(50, 0.0)?,
        counts: [count(70)?, count(71)?],
        spacing: [fields.number(44, 0.0)?, fields.number(45, 0.0)?],
        extension: extension(fields.groups),
    })
}
