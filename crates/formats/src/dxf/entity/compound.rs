//! Entities that are made of others: multilines, filled quadrangles, and hatches.

use super::{Fields, Shape};
use crate::dxf::groups::Group;
use crate::error::Malformed;

/// A multiline: for each of its elements the lines along it, without the caps at its ends, which its style decides.
///
/// At each vertex an element begins at a distance along the miter of that vertex. Behind it stand the distances along the step at which the element begins to
/// be drawn, stops, and begins again. One that does not begin at its vertex is left out for that step, as programs differ in what they count from.
///
/// `None` if it is not what the format demands.
pub(super) fn multiline(fields: &Fields<'_, '_>) -> Result<Option<Shape>, Malformed> {
    let mut vertices: Vec<Vertex> = Vec::new();
    for group in fields.groups {
        let number = || group.number();
        match (group.code, vertices.last_mut()) {
            (11, _) => vertices.push(Vertex { at: [number()?, 0.0, 0.0], ..Vertex::default() }),
            (21 | 31, Some(vertex)) => vertex.at[axis(group)] = number()?,
            (13 | 23 | 33, Some(vertex)) => vertex.miter[axis(group)] = number()?,
            (74, Some(vertex)) => vertex.elements.push(Vec::new()),
            (41, Some(vertex)) => match vertex.elements.last_mut() {
                Some(element) => element.push(number()?),
                None => return Ok(None),
            },
            _ => {}
        }
    }
    let n_elements = vertices.first().map_or(0, |vertex| vertex.elements.len());
    let is_whole =
        |vertex: &Vertex| vertex.elements.len() == n_elements && vertex.elements.iter().all(|e| !e.is_empty());
    if vertices.len() < 2 || n_elements == 0 || !vertices.iter().all(is_whole) {
        return Ok(None);
    }
    let is_closed = fields.integer(71)? & 2 != 0;
    let back = is_closed.then(|| (&vertices[vertices.len() - 1], &vertices[0]));
    let steps = vertices.windows(2).map(|pair| (&pair[0], &pair[1])).chain(back);
    let mut lines = Vec::new();
    for (from, to) in steps {
        for element in 0..n_elements {
            let [a, b] = [from, to].map(|vertex| vertex.place(element));
            let length = (0..3).map(|k| (b[k] - a[k]).powi(2)).sum::<f64>().sqrt();
            let at = |distance: f64| match distance < length {
                true => std::array::from_fn(|k| a[k] + (b[k] - a[k]) * (distance / length)),
                false => b,
            };
            match &from.elements[element][1..] {
                [] => lines.push(Shape::Line([a, b])),
                [0.0, ends @ ..] => {
                    let stops: Vec<f64> = [0.0].into_iter().chain(ends.iter().copied()).chain([length]).collect();
                    let drawn = stops.chunks_exact(2).filter(|pair| 0.0 <= pair[0] && pair[0] < pair[1]);
                    lines.extend(
                        drawn.map(|pair| Shape::Line([if pair[0] == 0.0 { a } else { at(pair[0]) }, at(pair[1])])),
                    );
                }
                _ => {}
            }
        }
    }
    Ok(Some(Shape::Parts { parts: lines, is_filling: false }))
}

/// Which coordinate a group of a point is.
fn axis(group: &Group<'_>) -> usize {
    (group.code / 10 - 1).clamp(0, 2) as usize
}

#[derive(Default)]
struct Vertex {
    at: [f64; 3],
    miter: [f64; 3],
    /// By element: its distance along the miter, and where along the step it is drawn.
    elements: Vec<Vec<f64>>,
}

impl Vertex {
    fn place(&self, element: usize) -> [f64; 3] {
        std::array::from_fn(|k| self.at[k] + self.miter[k] * self.elements[element][0])
    }
}

/// The outline of a filled triangle or quadrangle, whose third and fourth corners are in the order of the first two, and not around it.
pub(super) fn solid(fields: &Fields<'_, '_>) -> Result<Shape, Malformed> {
    let [a, b, c] = [fields.point(10, "corner")?, fields.point(11, "corner")?, fields.point(12, "corner")?];
    let d = if fields.find(13).is_some() { fields.point(13, "corner")? } else { c };
    Ok(Shape::Path { vertices: [a, b, d, c].map(|corner| (corner, 0.0)).to_vec(), is_closed: true, is_own: true })
}

/// The borders of a filled hatch: polylines, lines and arcs. `None` if it is not filled but drawn with a pattern, if it has an edge of another kind, and
/// if it is not what the format demands.
pub(super) fn hatch(fields: &Fields<'_, '_>) -> Option<Shape> {
    if fields.integer(70).ok()? != 1 {
        return None;
    }
    let begin = fields.groups.iter().position(|group| group.code == 91)?;
    let mut rest = Rest(&fields.groups[begin..]);
    let mut parts = Vec::new();
    for _ in 0..rest.take(91)?? {
        rest.border(&mut parts)?;
    }
    Some(Shape::Parts { parts, is_filling: true })
}

/// The groups of a hatch that were not read yet.
struct Rest<'g, 'a>(&'g [Group<'a>]);

impl Rest<'_, '_> {
    /// Goes on if the next group has the code.
    fn next(&mut self, code: i32) -> Option<&Group<'_>> {
        let (first, rest) = self.0.split_first().filter(|(first, _)| first.code == code)?;
        self.0 = rest;
        Some(first)
    }

    /// `Some(None)` if the next group has another code; `None` if it is malformed.
    fn take(&mut self, code: i32) -> Option<Option<i64>> {
        self.next(code).map(Group::integer).transpose().ok()
    }

    fn number(&mut self, code: i32) -> Option<Option<f64>> {
        self.next(code).map(Group::number).transpose().ok()
    }

    fn point(&mut self, code: i32) -> Option<[f64; 3]> {
        Some([self.number(code)??, self.number(code + 10)??, 0.0])
    }

    /// Reads one border; `None` if it is not understood.
    fn border(&mut self, parts: &mut Vec<Shape>) -> Option<()> {
        const POLYLINE: i64 = 2;
        if self.take(92)?? & POLYLINE == 0 {
            for _ in 0..self.take(93)?? {
                parts.push(self.edge()?);
            }
        } else {
            let (_, is_closed) = (self.take(72)?, self.take(73)? != Some(0));
            let mut vertices = Vec::new();
            for _ in 0..self.take(93)?? {
                vertices.push((self.point(10)?, self.number(42)?.unwrap_or(0.0)));
            }
            parts.push(Shape::Path { vertices, is_closed, is_own: true });
        }
        // The entities that the border was made of.
        for _ in 0..self.take(97)?.unwrap_or(0) {
            self.next(330)?;
        }
        Some(())
    }

    /// Reads one edge; `None` if it is neither a line nor an arc.
    fn edge(&mut self) -> Option<Shape> {
        match self.take(72)?? {
            1 => {
                let vertices = vec![(self.point(10)?, 0.0), (self.point(11)?, 0.0)];
                Some(Shape::Path { vertices, is_closed: false, is_own: true })
            }
            2 => {
                let (center, radius) = (self.point(10)?, self.number(40)??);
                let (start, end) = (self.number(50)??, self.number(51)??);
                // Clockwise ones have their angles clockwise too.
                let angles = if self.take(73)? == Some(0) { [-end, -start] } else { [start, end] };
                (radius >= 0.0).then_some(Shape::Arc { center, radius, angles: Some(angles) })
            }
            _ => None,
        }
    }
}
