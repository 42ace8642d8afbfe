//! Boxes of cells and pages of the locator as records, and the top of the locator.

use crate::blocks::BlockWriter;
use crate::bytes::Writer;
use crate::error::StreamError;
use crate::format::{self, NONE, PAGE_BYTES};
use sightlines_pvs::{CellId, Locator, LocatorNodeRef, TableParts};
use std::io::Write;

/// Bytes of a node.
const NODE: u64 = 16;

/// Writes `BOXS` and `PLAC`; returns the section `LOCT`. O(size), and 12 bytes of memory for each node.
pub(crate) fn write_pages<W: Write>(out: &mut BlockWriter<W>, parts: &TableParts) -> Result<Vec<u8>, StreamError> {
    let d = usize::from(parts.dimension);
    out.all(
        format::BOXES,
        parts.cells.iter().map(|cell| {
            let mut record = Writer::default();
            record.floats(&cell.min[..d]);
            record.floats(&cell.max[..d]);
            record.floats(cell.polygon.as_flattened());
            record.0
        }),
    )?;
    let store = out.store(format::PLACES);
    let locator = &parts.locator;
    let (sizes, ends) = subtrees(parts);
    let mut top = Writer::default();
    let (mut n_nodes, mut n_pages) = (0u32, 0u32);
    // The high children that are still to come: where their number goes, and their place in the locator.
    let mut highs: Vec<(usize, usize)> = Vec::new();
    let mut at = 0;
    while let Some(node) = locator.node(at) {
        if let Some(&(field, _)) = highs.last().filter(|&&(_, high)| high == at) {
            top.0[field..field + 4].copy_from_slice(&n_nodes.to_le_bytes());
            highs.pop();
        }
        n_nodes += 1;
        match node {
            LocatorNodeRef::Inner { axis, split, high } if sizes[at] > PAGE_BYTES as u64 => {
                top.u32(u32::from(axis));
                highs.push((top.0.len(), high as usize));
                top.u32(0);
                top.floats(&[split]);
                at += 1;
            }
            _ => {
                top.u32(NONE);
                top.u32(0);
                top.u64(u64::from(n_pages));
                n_pages += 1;
                out.push(store, &page(locator, at..ends[at] as usize, parts))?;
                at = ends[at] as usize;
            }
        }
    }
    out.flush(store)?;
    let mut section = Writer::default();
    section.u32(n_nodes);
    section.u32(n_pages);
    section.0.extend(top.0);
    Ok(section.0)
}

/// For each node the bytes that a page of its subtree takes at most, and the node behind the subtree.
fn subtrees(parts: &TableParts) -> (Vec<u64>, Vec<u32>) {
    let (locator, d) = (&parts.locator, u64::from(parts.dimension));
    let n = locator.n_nodes();
    let (mut sizes, mut ends) = (vec![0; n], vec![0; n]);
    for at in (0..n).rev() {
        (sizes[at], ends[at]) = match locator.node(at) {
            Some(LocatorNodeRef::Inner { high, .. }) => {
                let high = high as usize;
                (NODE + sizes[at + 1] + sizes[high], ends[high])
            }
            Some(LocatorNodeRef::Leaf { cells }) => {
                let corners = cells.iter().map(|cell| parts.cells[cell.idx()].polygon.len() as u64).sum::<u64>();
                (NODE + (12 + 16 * d) * cells.len() as u64 + 16 * corners, at as u32 + 1)
            }
            None => (0, at as u32 + 1),
        };
    }
    (sizes, ends)
}

/// The record of a page.
fn page(locator: &Locator, nodes: std::ops::Range<usize>, parts: &TableParts) -> Vec<u8> {
    let d = usize::from(parts.dimension);
    let leaves = || {
        nodes.clone().filter_map(|at| match locator.node(at)? {
            LocatorNodeRef::Leaf { cells } => Some(cells),
            LocatorNodeRef::Inner { .. } => None,
        })
    };
    let mut cells: Vec<CellId> = leaves().flatten().copied().collect();
    let n_entries = cells.len();
    cells.sort_unstable();
    cells.dedup();
    let records = || cells.iter().map(|cell| &parts.cells[cell.idx()]);
    let n_corners = records().map(|cell| cell.polygon.len()).sum::<usize>();
    let mut out = Writer::default();
    [nodes.len(), n_entries, cells.len(), n_corners].into_iter().for_each(|n| out.u32(n as u32));
    let mut listed = 0u64;
    for at in nodes.clone() {
        match locator.node(at) {
            Some(LocatorNodeRef::Inner { axis, split, high }) => {
                out.u32(u32::from(axis));
                out.u32(high - nodes.start as u32);
                out.floats(&[split]);
            }
            Some(LocatorNodeRef::Leaf { cells }) => {
                out.u32(NONE);
                out.u32(cells.len() as u32);
                out.u64(listed);
                listed += cells.len() as u64;
            }
            None => {}
        }
    }
    let position = |cell: &CellId| cells.binary_search(cell).expect("all cells of the page were collected");
    leaves().flatten().for_each(|cell| out.u32(position(cell) as u32));
    cells.iter().for_each(|cell| out.u32(cell.0));
    let mut before = 0;
    out.u32(0);
    records().for_each(|cell| {
        before += cell.polygon.len() as u32;
        out.u32(before);
    });
    for cell in records() {
        out.floats(&cell.min[..d]);
        out.floats(&cell.max[..d]);
    }
    records().for_each(|cell| out.floats(cell.polygon.as_flattened()));
    out.0
}
