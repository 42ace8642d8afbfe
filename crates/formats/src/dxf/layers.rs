//! The layers of a drawing, and which of them are read.

use super::text::{decode, folded, list};
use crate::error::{Malformed, malformed};
use std::collections::HashMap;

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

    pub(super) fn state(&mut self, id: u32, is_frozen: bool, is_off: bool) {
        let layer = &mut self.layers[id as usize];
        (layer.is_frozen, layer.is_off) = (is_frozen, is_off);
    }

    pub(super) fn name(&self, id: u32) -> &str {
        &self.layers[id as usize].name
    }

    pub(super) fn into_names(self) -> Vec<String> {
        self.layers.into_iter().map(|layer| layer.name).collect()
    }

    /// The layers with these names; without names all that are neither frozen nor off.
    pub(super) fn choose(&self, names: Option<&[String]>) -> Result<Chosen, Malformed> {
        let Some(names) = names else {
            let is_read = self.layers.iter().map(|layer| !layer.is_frozen && !layer.is_off).collect();
            let is_frozen = self.layers.iter().map(|layer| layer.is_frozen).collect();
            return Ok(Chosen { by_name: false, is_read, is_frozen });
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
            return Err(self.no_such(&unknown));
        }
        Ok(Chosen { by_name: true, is_read, is_frozen: vec![false; self.layers.len()] })
    }

    fn no_such(&self, unknown: &[String]) -> Malformed {
        const MOST: usize = 40;
        let names = list(self.layers.iter().map(|layer| layer.name.escape_debug().to_string()), MOST);
        let there = match self.layers.len() {
            0 => "are none".to_owned(),
            1 => format!("is {names}"),
            _ => format!("are {names}"),
        };
        let unknown = list(unknown.iter().map(|name| name.escape_debug().to_string()), MOST);
        malformed!("there is no layer {unknown}; there {there}")
    }
}
