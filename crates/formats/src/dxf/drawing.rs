//! The parts of a drawing: layers, blocks, and the entities of the model.

use super::entity::{Entity, Fields, Read, read_entity};
use super::filters::Filters;
use super::groups::{Group, Groups, next_record, refuse_binary, unended};
use super::layers::Layers;
use super::text::{decode, folded};
use crate::error::Malformed;
use std::collections::HashMap;

#[derive(Debug, Default)]
pub(super) struct Drawing {
    pub(super) layers: Layers,
    pub(super) blocks: Vec<Block>,
    /// Blocks by name.
    pub(super) by_name: HashMap<String, usize>,
    pub(super) filters: Filters,
    /// Those of the model.
    pub(super) entities: Vec<Entity>,
}

/// A block: entities that are inserted together.
#[derive(Debug)]
pub(super) struct Block {
    pub(super) name: String,
    pub(super) base: [f64; 3],
    /// Whether its entities are in another file.
    pub(super) is_external: bool,
    pub(super) entities: Vec<Entity>,
}

pub(super) fn read(text: &[u8]) -> Result<Drawing, Malformed> {
    refuse_binary(text)?;
    let mut groups = Groups::new(text);
    let mut drawing = Drawing::default();
    loop {
        let group = groups.next()?;
        if group.is(0, "EOF") {
            return Ok(drawing);
        }
        if !group.is(0, "SECTION") {
            return Err(group.expected("SECTION or EOF"));
        }
        let name = groups.next()?;
        if name.code != 2 {
            return Err(name.expected("the name of a section"));
        }
        match name.value {
            b"TABLES" => drawing.read_tables(&mut groups)?,
            b"BLOCKS" => drawing.read_blocks(&mut groups)?,
            b"OBJECTS" => drawing.filters = Filters::read(&mut groups)?,
            b"ENTITIES" => {
                let end = read_entities(&mut groups, &mut drawing.layers, &mut drawing.entities)?;
                expect(&end, "ENDSEC")?;
            }
            _ => skip(&mut groups)?,
        }
    }
}

fn skip(groups: &mut Groups<'_>) -> Result<(), Malformed> {
    loop {
        let group = groups.next()?;
        match (group.code, group.value) {
            (0, b"ENDSEC") => return Ok(()),
            (0, b"EOF") => return Err(unended(&group)),
            _ => {}
        }
    }
}

impl Drawing {
    fn read_tables(&mut self, groups: &mut Groups<'_>) -> Result<(), Malformed> {
        let mut fields = Vec::new();
        loop {
            let record = next_record(groups, &mut fields)?;
            if record.is(0, "ENDSEC") {
                return Ok(());
            }
            let fields = Fields { kind: "LAYER", line: record.line, groups: &fields };
            if let (true, Some(name)) = (record.is(0, "LAYER"), fields.find(2)) {
                let id = self.layers.id(name.value);
                self.layers.state(id, fields.integer(70)? & 1 != 0, fields.integer(62)? < 0);
            }
        }
    }

    fn read_blocks(&mut self, groups: &mut Groups<'_>) -> Result<(), Malformed> {
        let mut fields = Vec::new();
        loop {
            let record = next_record(groups, &mut fields)?;
            if record.is(0, "ENDSEC") {
                return Ok(());
            }
            expect(&record, "BLOCK")?;
            let fields = Fields { kind: "BLOCK", line: record.line, groups: &fields };
            let name = fields.find(2).ok_or_else(|| fields.missing("name"))?;
            let base = [fields.number(10, 0.0)?, fields.number(20, 0.0)?, fields.number(30, 0.0)?];
            /// Flags of a block that is an external reference, or overlays one.
            const EXTERNAL: i64 = 4 | 8;
            let is_external = fields.integer(70)? & EXTERNAL != 0;
            let mut block = Block { name: decode(name.value), base, is_external, entities: Vec::new() };
            let end = read_entities(groups, &mut self.layers, &mut block.entities)?;
            expect(&end, "ENDBLK")?;
            // Of blocks with one name the first counts.
            self.by_name.entry(folded(&block.name)).or_insert(self.blocks.len());
            self.blocks.push(block);
        }
    }
}

fn expect(record: &Group<'_>, what: &str) -> Result<(), Malformed> {
    if record.is(0, what) { Ok(()) } else { Err(record.expected(what)) }
}

/// Reads entities up to the record that ends them, which it returns.
fn read_entities<'a>(
    groups: &mut Groups<'a>,
    layers: &mut Layers,
    entities: &mut Vec<Entity>,
) -> Result<Group<'a>, Malformed> {
    loop {
        match read_entity(groups, layers)? {
            Read::Entity(entity) => entities.push(entity),
            Read::Nothing => {}
            Read::End(record) => return Ok(record),
        }
    }
}
