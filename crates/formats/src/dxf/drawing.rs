//! The parts of a drawing: layers, blocks, and the entities of the model.

use super::entity::{Entity, Read, read_entity};
use super::error::{DxfError, DxfErrorKind};
use super::groups::{Group, Groups, refuse_binary};
use super::text::{decode, folded};
use std::collections::{BTreeMap, HashMap};

/// A drawing as its file has it.
#[derive(Debug, Default)]
pub(super) struct Drawing {
    pub(super) layers: Layers,
    pub(super) blocks: Vec<Block>,
    /// Blocks by name.
    pub(super) by_name: HashMap<String, usize>,
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

/// A layer.
#[derive(Debug, Clone)]
struct Layer {
    name: String,
    is_frozen: bool,
    is_off: bool,
}

/// All layers, in the order of the file.
#[derive(Debug, Default)]
pub(super) struct Layers {
    layers: Vec<Layer>,
    by_name: HashMap<String, u32>,
}

/// Which layers are read.
#[derive(Debug)]
pub(super) struct Chosen {
    /// Whether they were asked for by name.
    pub(super) by_name: bool,
    /// By layer: whether entities on it are.
    pub(super) is_read: Vec<bool>,
    /// By layer: whether inserts on it are left out with all that they insert.
    pub(super) is_frozen: Vec<bool>,
}

impl Layers {
    /// The layer with that name, which need not be in the table of layers.
    pub(super) fn id(&mut self, name: &[u8]) -> u32 {
        let name = decode(name);
        // There are at most as many layers as the file has bytes, and a file of four billion layers has more bytes than this counts.
        let next = self.layers.len() as u32;
        *self.by_name.entry(folded(&name)).or_insert_with(|| {
            self.layers.push(Layer { name, is_frozen: false, is_off: false });
            next
        })
    }

    pub(super) fn name(&self, id: u32) -> &str {
        &self.layers[id as usize].name
    }

    pub(super) fn into_names(self) -> Vec<String> {
        self.layers.into_iter().map(|layer| layer.name).collect()
    }

    /// The layers with these names; without names all that are neither frozen nor off.
    pub(super) fn choose(&self, names: Option<&[String]>) -> Result<Chosen, DxfError> {
        let Some(names) = names else {
            let is_read = self.layers.iter().map(|layer| !layer.is_frozen && !layer.is_off).collect();
            return Ok(Chosen {
                by_name: false,
                is_read,
                is_frozen: self.layers.iter().map(|layer| layer.is_frozen).collect(),
            });
        };
        let mut is_read = vec![false; self.layers.len()];
        let mut unknown = Vec::new();
        for name in names {
            match self.by_name.get(&folded(name)) {
                Some(&id) => is_read[id as usize] = true,
                None => unknown.push(name.clone()),
            }
        }
        if !unknown.is_empty() {
            let names = self.layers.iter().map(|layer| layer.name.clone()).collect();
            return Err(DxfError::whole(DxfErrorKind::NoSuchLayer { unknown, names }));
        }
        Ok(Chosen { by_name: true, is_read, is_frozen: vec![false; self.layers.len()] })
    }
}

/// Counts of what is ignored, by kind.
pub(super) type Ignored = BTreeMap<String, usize>;

/// Reads all sections.
pub(super) fn read(text: &[u8]) -> Result<Drawing, DxfError> {
    refuse_binary(text)?;
    let mut groups = Groups::new(text);
    let mut drawing = Drawing::default();
    loop {
        let group = groups.next()?;
        if group.is(0, "EOF") {
            return Ok(drawing);
        }
        if !group.is(0, "SECTION") {
            return Err(DxfError::at(group.line, DxfErrorKind::Expected("SECTION or EOF")));
        }
        let name = groups.next()?;
        if name.code != 2 {
            return Err(DxfError::at(name.line, DxfErrorKind::Expected("the name of a section")));
        }
        match name.value {
            b"TABLES" => drawing.read_tables(&mut groups)?,
            b"BLOCKS" => drawing.read_blocks(&mut groups)?,
            b"ENTITIES" => {
                let end = read_entities(&mut groups, &mut drawing.layers, &mut drawing.entities)?;
                expect(&end, "ENDSEC")?;
            }
            _ => skip(&mut groups)?,
        }
    }
}

/// Skips the rest of a section.
fn skip(groups: &mut Groups<'_>) -> Result<(), DxfError> {
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
    /// Reads the table of layers, and skips the others.
    fn read_tables(&mut self, groups: &mut Groups<'_>) -> Result<(), DxfError> {
        let mut fields = Vec::new();
        loop {
            let record = next_record(groups, &mut fields)?;
            if record.is(0, "ENDSEC") {
                return Ok(());
            }
            let field = |code| fields.iter().find(|group: &&Group<'_>| group.code == code);
            if let (true, Some(name)) = (record.is(0, "LAYER"), field(2)) {
                let id = self.layers.id(name.value) as usize;
                let number = |code| field(code).map_or(Ok(0), Group::integer);
                let (flags, colour) = (number(70)?, number(62)?);
                (self.layers.layers[id].is_frozen, self.layers.layers[id].is_off) = (flags & 1 != 0, colour < 0);
            }
        }
    }

    fn read_blocks(&mut self, groups: &mut Groups<'_>) -> Result<(), DxfError> {
        let mut fields = Vec::new();
        loop {
            let record = next_record(groups, &mut fields)?;
            if record.is(0, "ENDSEC") {
                return Ok(());
            }
            expect(&record, "BLOCK")?;
            let field = |code| fields.iter().find(|group: &&Group<'_>| group.code == code);
            let name = field(2).ok_or(missing(&record, "name"))?;
            let number = |code| field(code).map_or(Ok(0.0), Group::number);
            let base = [number(10)?, number(20)?, number(30)?];
            /// Flags of a block that is an external reference, or overlays one.
            const EXTERNAL: i64 = 4 | 8;
            let is_external = field(70).map_or(Ok(0), Group::integer)? & EXTERNAL != 0;
            let mut block = Block { name: decode(name.value), base, is_external, entities: Vec::new() };
            let end = read_entities(groups, &mut self.layers, &mut block.entities)?;
            expect(&end, "ENDBLK")?;
            // Of blocks with one name the first counts.
            self.by_name.entry(folded(&block.name)).or_insert(self.blocks.len());
            self.blocks.push(block);
        }
    }
}

fn missing(record: &Group<'_>, what: &'static str) -> DxfError {
    DxfError::at(record.line, DxfErrorKind::Missing { entity: "BLOCK", what })
}

fn unended(end: &Group<'_>) -> DxfError {
    DxfError::at(end.line, DxfErrorKind::Expected("the end of the section before EOF"))
}

fn expect(record: &Group<'_>, what: &'static str) -> Result<(), DxfError> {
    if record.is(0, what) { Ok(()) } else { Err(DxfError::at(record.line, DxfErrorKind::Expected(what))) }
}

/// Reads entities up to the record that ends them, which it returns.
fn read_entities<'a>(
    groups: &mut Groups<'a>,
    layers: &mut Layers,
    entities: &mut Vec<Entity>,
) -> Result<Group<'a>, DxfError> {
    loop {
        match read_entity(groups, layers)? {
            Read::Entity(entity) => entities.push(entity),
            Read::Nothing => {}
            Read::End(record) => return Ok(record),
        }
    }
}

/// Reads the group that begins a record, and the groups of the record.
pub(super) fn next_record<'a>(groups: &mut Groups<'a>, fields: &mut Vec<Group<'a>>) -> Result<Group<'a>, DxfError> {
    fields.clear();
    let record = groups.next()?;
    if record.code != 0 {
        return Err(DxfError::at(record.line, DxfErrorKind::Expected("a group with the code 0")));
    }
    if record.value == b"EOF" {
        return Err(unended(&record));
    }
    // The end of a section has no groups, and what follows it is not looked at.
    if record.value != b"ENDSEC" {
        while groups.peek()?.code != 0 {
            fields.push(groups.next()?);
        }
    }
    Ok(record)
}
