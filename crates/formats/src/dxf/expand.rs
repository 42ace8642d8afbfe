//! The entities of the model, with blocks where they are inserted: straight and curved pieces in the plane.

use super::affine::{Affine, Insert, checked_unit, cross};
use super::clip::Clips;
use super::curve::{Bezier, arc, bulged};
use super::drawing::Drawing;
use super::entity::{Entity, Shape, Shown};
use super::filters::Clip;
use super::layers::Chosen;
use super::text::{folded, list};
use super::{MAX_ELEMENTS, MAX_NESTING, too_many};
use crate::error::{Malformed, counted, malformed};
use sightlines_geometry::check_coordinate;
use std::collections::{BTreeMap, BTreeSet};

#[derive(Debug)]
pub(super) struct Drawn {
    pub(super) pieces: Vec<Bezier<2>>,
    pub(super) clip: Option<usize>,
}

/// What becomes lines.
#[derive(Debug, Default)]
pub(super) struct Expanded {
    pub(super) entities: Vec<Drawn>,
    pub(super) clips: Clips,
    ignored: BTreeMap<String, usize>,
    n_hidden: usize,
    hidden_layers: BTreeSet<u32>,
    /// Inserts whose clip is not understood, by block.
    not_clipped: BTreeMap<String, usize>,
    n_on_paper: usize,
    n_invisible: usize,
}

const MOST: usize = 12;

impl Expanded {
    pub(super) fn warnings(&self, drawing: &Drawing) -> Vec<String> {
        let mut warnings = Vec::new();
        if !self.ignored.is_empty() {
            let kinds = self.ignored.iter().map(|(kind, n)| format!("{n} {}", kind.escape_debug()));
            warnings.push(format!("ignored what is no line or curve: {}", list(kinds, MOST)));
        }
        let entities = |n| counted(n, "entity", "entities");
        if self.n_hidden > 0 {
            let names = self.hidden_layers.iter().map(|&id| drawing.layers.name(id).escape_debug().to_string());
            let what = entities(self.n_hidden);
            warnings.push(format!("left out {what} on layers that are frozen or off: {}", list(names, MOST)));
        }
        if !self.not_clipped.is_empty() {
            let blocks = self.not_clipped.iter().map(|(block, n)| format!("{n} of {}", block.escape_debug()));
            warnings.push(format!("left out inserts whose clip (XCLIP) is not understood: {}", list(blocks, MOST)));
        }
        if self.n_on_paper > 0 {
            warnings.push(format!("left out {} in paper space", entities(self.n_on_paper)));
        }
        if self.n_invisible > 0 {
            warnings.push(format!("left out {} marked as invisible", entities(self.n_invisible)));
        }
        warnings
    }
}

pub(super) fn expand(drawing: &Drawing, chosen: &Chosen) -> Result<Expanded, Malformed> {
    let mut walk = Walk { drawing, chosen, out: Expanded::default(), n_elements: 0, clip: None, open: Vec::new() };
    walk.entities(&drawing.entities, &Affine::IDENTITY, None)?;
    Ok(walk.out)
}

struct Walk<'d> {
    drawing: &'d Drawing,
    chosen: &'d Chosen,
    out: Expanded,
    n_elements: usize,
    clip: Option<usize>,
    /// The blocks that are being inserted, each in the one before it.
    open: Vec<usize>,
}

impl Walk<'_> {
    fn count(&mut self, n: usize) -> Result<(), Malformed> {
        self.n_elements = self.n_elements.saturating_add(n);
        if self.n_elements > MAX_ELEMENTS { Err(too_many()) } else { Ok(()) }
    }

    /// * `map`: from the coordinates of these entities to the world's
    /// * `layer`: what the layer `0` stands for
    fn entities(&mut self, entities: &[Entity], map: &Affine, layer: Option<u32>) -> Result<(), Malformed> {
        for entity in entities {
            let at = |what: Malformed| what.on_line(entity.line);
            self.count(1).map_err(at)?;
            match entity.shown {
                Shown::Paper => self.out.n_on_paper += 1,
                Shown::Nowhere => self.out.n_invisible += 1,
                Shown::Model => {
                    let own = entity.layer;
                    let on = layer.filter(|_| self.drawing.layers.name(own) == "0").unwrap_or(own);
                    match &entity.shape {
                        Shape::Insert(insert) => self.insert(entity, insert, map, on)?,
                        _ if !self.chosen.is_read[on as usize] => self.hide(on),
                        Shape::Other(kind) => self.ignore(kind),
                        Shape::Parts { is_filling: true, .. } if !self.chosen.by_name => self.ignore("HATCH"),
                        shape => self.curve(entity, shape, map).map_err(at)?,
                    }
                }
            }
        }
        Ok(())
    }

    /// Counts an entity that is not read.
    fn ignore(&mut self, kind: &str) {
        *self.out.ignored.entry(kind.to_owned()).or_default() += 1;
    }

    /// Counts an entity that is not drawn. Those on layers that were not asked for are not worth a word.
    fn hide(&mut self, layer: u32) {
        if !self.chosen.by_name {
            self.out.n_hidden += 1;
            self.out.hidden_layers.insert(layer);
        }
    }

    fn insert(&mut self, entity: &Entity, insert: &Insert, map: &Affine, on: u32) -> Result<(), Malformed> {
        let at = |what: Malformed| what.on_line(entity.line);
        if self.chosen.is_frozen[on as usize] {
            self.hide(on);
            return Ok(());
        }
        let drawing = self.drawing;
        let found = drawing.by_name.get(&folded(&insert.block));
        let &idx = found.ok_or_else(|| at(malformed!("there is no block \"{}\"", insert.block)))?;
        let block = &drawing.blocks[idx];
        if block.is_external {
            self.ignore("INSERT of another file");
            return Ok(());
        }
        if self.open.contains(&idx) {
            return Err(at(malformed!("the block \"{}\" contains itself", block.name)));
        }
        if self.open.len() == MAX_NESTING {
            return Err(at(malformed!("blocks are nested more than {MAX_NESTING} deep")));
        }
        let own = map.after(&Affine::of_extrusion(entity.normal).map_err(at)?);
        let [n_columns, n_rows] = insert.counts;
        let outer = self.clip;
        match drawing.filters.of(insert.extension) {
            Clip::Off => {}
            Clip::Polygon { corners, is_hole } if insert.counts == [1, 1] && own.keeps_above() => {
                self.count(corners.len()).map_err(at)?;
                let placed = own.after(&Affine::of_insert(insert, block.base, [0, 0]));
                let corners = corners.into_iter().map(|p| placed.point(p)).map(|[x, y, _]| [x, y]);
                self.clip = Some(self.out.clips.add(corners, is_hole, outer).map_err(at)?);
            }
            _ => {
                *self.out.not_clipped.entry(block.name.clone()).or_default() += 1;
                return Ok(());
            }
        }
        self.open.push(idx);
        for row in 0..n_rows {
            for column in 0..n_columns {
                self.count(1).map_err(at)?;
                let placed = own.after(&Affine::of_insert(insert, block.base, [column, row]));
                self.entities(&block.entities, &placed, Some(on))?;
            }
        }
        self.open.pop();
        self.clip = outer;
        Ok(())
    }

    fn curve(&mut self, entity: &Entity, shape: &Shape, map: &Affine) -> Result<(), Malformed> {
        let own = || Affine::of_extrusion(entity.normal).map(|own| map.after(&own));
        match shape {
            Shape::Line(ends) => self.add(&[straight(ends[0], ends[1])], map),
            Shape::Path { vertices, is_closed, is_own } => {
                let map = if *is_own { own()? } else { *map };
                let back = vertices.last().zip(vertices.first()).filter(|_| *is_closed);
                let steps = vertices.windows(2).map(|pair| (pair[0], pair[1]));
                let mut pieces = Vec::new();
                for ((a, bulge), (b, _)) in steps.chain(back.map(|(&last, &first)| (last, first))) {
                    bulged(a, b, bulge, &mut pieces);
                }
                if let ([(only, _)], false) = (&vertices[..], *is_closed) {
                    pieces.push(straight(*only, *only));
                }
                self.add(&pieces, &map)
            }
            &Shape::Arc { center, radius, angles } => {
                let (u, v) = ([radius, 0.0, 0.0], [0.0, radius, 0.0]);
                let [start, end] = angles.unwrap_or([0.0, 360.0]);
                self.add(&arc(center, u, v, start, sweep(start, end)), &own()?)
            }
            &Shape::Ellipse { center, major, ratio, parameters } => {
                /// Programs write a full turn with six digits or more behind the point: it is one within that many degrees.
                const ROUNDED: f64 = 1e-4;
                let minor = cross(checked_unit(entity.normal)?, major).map(|x| ratio * x);
                let [start, end] = parameters.map(|t| t * (180.0 / std::f64::consts::PI));
                let is_full = ((end - start).abs() - 360.0).abs() < ROUNDED;
                let turn = if is_full { 360.0 } else { sweep(start, end) };
                self.add(&arc(center, major, minor, start, turn), map)
            }
            Shape::Spline(spline) => {
                self.count(spline.n_corners())?;
                self.add(&spline.pieces(), map)
            }
            Shape::Parts { parts, .. } => parts.iter().try_for_each(|part| self.curve(entity, part, map)),
            Shape::Insert(_) | Shape::Other(_) => Ok(()),
        }
    }

    fn add(&mut self, pieces: &[Bezier<3>], map: &Affine) -> Result<(), Malformed> {
        self.count(pieces.iter().map(|piece| piece.corners.len()).sum())?;
        let mut flat: Vec<Bezier<2>> = pieces.iter().map(|piece| piece.seen_from_above(map)).collect();
        for x in flat.iter_mut().flat_map(|piece| &mut piece.corners).flat_map(|(corner, _)| corner) {
            *x = check_coordinate(*x)?;
        }
        self.out.entities.push(Drawn { pieces: flat, clip: self.clip });
        Ok(())
    }
}

fn straight(a: [f64; 3], b: [f64; 3]) -> Bezier<3> {
    Bezier { corners: vec![(a, 1.0), (b, 1.0)] }
}

/// The angle from `start` counter-clockwise to `end`, above 0 and at most 360: the same direction twice is a full turn.
fn sweep(start: f64, end: f64) -> f64 {
    let rest = (end - start) % 360.0;
    if rest > 0.0 { rest } else { rest + 360.0 }
}
