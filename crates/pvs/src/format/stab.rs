//! The section of the stab trees; the layout is in the documentation of [`super`].

use super::error::{DecodeError, DecodeErrorKind as Kind};
use super::reader::Reader;
use super::writer::Writer;
use crate::stab::{Bits, ends};
use crate::{CellId, PortalRecord, StabTrees};

/// A cell with more entries than this has a list of them instead of a mask.
const MASK: usize = 16;

/// The gates into each cell, ascending.
struct Entries {
    /// Where the gates of each cell begin; one entry more than cells.
    first: Vec<u32>,
    gates: Vec<u32>,
}

impl Entries {
    /// The cells of all portals must exist.
    fn of(portals: &[PortalRecord], n_cells: usize) -> Self {
        let gates = || 0..2 * portals.len() as u32;
        let mut first = vec![0u32; n_cells + 1];
        gates().for_each(|gate| first[ends(portals, gate)[1].idx() + 1] += 1);
        (0..n_cells).for_each(|i| first[i + 1] += first[i]);
        let (mut next, mut sorted) = (first.clone(), vec![0; 2 * portals.len()]);
        for gate in gates() {
            let place = &mut next[ends(portals, gate)[1].idx()];
            sorted[*place as usize] = gate;
            *place += 1;
        }
        Self { first, gates: sorted }
    }

    fn leading_into(&self, cell: usize) -> &[u32] {
        &self.gates[self.first[cell] as usize..self.first[cell + 1] as usize]
    }
}

/// The sort key of groups: the cell and whether anything may follow.
fn group_key(cell: CellId, open: bool) -> u64 {
    2 * u64::from(cell.0) + u64::from(open)
}

pub(super) fn write(out: &mut Writer, stab: &StabTrees, portals: &[PortalRecord]) {
    let n = stab.n_nodes();
    let entries = Entries::of(portals, stab.n_cells());
    let mut height = vec![0u32; stab.n_lists()];
    for list in 0..height.len() {
        let below = stab.list(list).iter().map(|&c| height[stab.after[c as usize] as usize] + 1);
        height[list] = below.max().unwrap_or(0);
    }
    // Position of each node among those out of the same cell, and their number below the level.
    let (mut place, mut leaving) = (vec![0u32; n], vec![0u32; stab.n_cells()]);
    let key = |node: usize| group_key(ends(portals, stab.gates[node])[1], stab.open.get(stab.after[node] as usize));
    let mut begin = 0;
    while begin < n {
        let level = height[stab.after[begin] as usize];
        let end = (begin..n).find(|&k| height[stab.after[k] as usize] != level).unwrap_or(n);
        let nodes: Vec<usize> = (begin..end).collect();
        let groups: Vec<&[usize]> = nodes.chunk_by(|&a, &b| key(a) == key(b)).collect();
        out.varint(groups.len() as u64);
        let mut next = 0;
        for group in groups {
            out.varint(key(group[0]) - next);
            next = key(group[0]) + 1;
            let cell = ends(portals, stab.gates[group[0]])[1].idx();
            let mut lists = group.chunk_by(|&a, &b| stab.after[a] == stab.after[b]).peekable();
            while let Some(same) = lists.next() {
                let children = stab.list(stab.after[same[0]] as usize);
                let gates: Vec<u32> = same.iter().map(|&node| stab.gates[node]).collect();
                let n_children = children.len() as u64 - u64::from(level > 0);
                header(out, entries.leading_into(cell), &gates, n_children, lists.peek().is_some());
                references(out, children, &place, leaving[cell]);
            }
        }
        for node in nodes {
            let from = &mut leaving[ends(portals, stab.gates[node])[0].idx()];
            place[node] = *from;
            *from += 1;
        }
        begin = end;
    }
    out.varint(0);
    for cell in (0..stab.n_cells() as u32).map(CellId) {
        let roots = stab.roots(cell);
        out.varint(2 * roots.len() as u64 + u64::from(stab.is_root_open(cell)));
        references(out, roots, &place, leaving[cell.idx()]);
    }
}

/// Number of children, the gates that have them, and whether there is another list in the group.
fn header(out: &mut Writer, entries: &[u32], gates: &[u32], n_children: u64, more: bool) {
    let places = gates.iter().map(|gate| entries.partition_point(|entry| entry < gate) as u64);
    if entries.len() <= MASK {
        let mask = places.fold(0, |mask, place| mask | 1 << place);
        out.varint(n_children << (entries.len() + 1) | mask << 1 | u64::from(more));
    } else {
        out.varint(2 * n_children + u64::from(more));
        out.varint(gates.len() as u64);
        let mut next = 0;
        for place in places {
            out.varint(place - next);
            next = place + 1;
        }
    }
}

/// Nodes out of a cell from the last to the first: the number skipped each time.
fn references(out: &mut Writer, nodes: &[u32], place: &[u32], n_leaving: u32) {
    let mut next = n_leaving;
    for &node in nodes.iter().rev() {
        let place = place[node as usize];
        out.varint(u64::from(next - 1 - place));
        next = place;
    }
}

/// Reads trees over portals whose cells exist. The result has the order of [`StabTrees`]; whether its portals fit
/// together is checked with the table.
pub(super) fn parse(r: &mut Reader<'_>, portals: &[PortalRecord], n_cells: usize) -> Result<StabTrees, DecodeError> {
    if portals.len() >= 1 << 31 {
        return Err(r.fail(0, Kind::Number)); // a gate is a portal and one bit
    }
    let stab = StabTrees { first_child: vec![0], first_root: vec![0], ..StabTrees::default() };
    let leaving = vec![Vec::new(); n_cells];
    let mut parser = Parser { stab, height: Vec::new(), used: Vec::new(), leaving, level: 0 };
    let entries = Entries::of(portals, n_cells);
    loop {
        let n_groups = r.varint()?;
        if n_groups == 0 {
            break;
        }
        let begin = parser.stab.n_nodes();
        let mut next = 0u64;
        for _ in 0..n_groups {
            let key = r.varint()?.checked_add(next).filter(|key| *key < 2 * n_cells as u64);
            let key = key.ok_or_else(|| r.fail(1, Kind::StabOrder))?;
            next = key + 1;
            parser.group(r, &entries, (key / 2) as usize, key % 2 == 1)?;
        }
        for node in begin..parser.stab.n_nodes() {
            let from = ends(portals, parser.stab.gates[node])[0];
            parser.leaving[from.idx()].push(node as u32);
        }
        parser.level += 1;
    }
    parser.roots(r)?;
    match parser.used.iter().all(|&used| used) {
        true => Ok(parser.stab),
        // Every written node is referenced.
        false => Err(r.fail(0, Kind::StabOrder)),
    }
}

/// Trees so far.
struct Parser {
    stab: StabTrees,
    /// Height of each list.
    height: Vec<u32>,
    /// Whether a node is referenced.
    used: Vec<bool>,
    /// The nodes out of each cell, of the levels below.
    leaving: Vec<Vec<u32>>,
    level: u32,
}

impl Parser {
    /// The lists of one cell on the current level.
    fn group(&mut self, r: &mut Reader<'_>, entries: &Entries, cell: usize, open: bool) -> Result<(), DecodeError> {
        let entries = entries.leading_into(cell);
        let mut before: Option<usize> = None;
        loop {
            let (n_children, more) = self.header(r, entries)?;
            let list = self.stab.open.len();
            let children = self.references(r, cell, n_children)?;
            let below = children.last().map(|&child| self.height[self.stab.after[child as usize] as usize] + 1);
            if below.unwrap_or(0) != self.level {
                return Err(r.fail(1, Kind::StabOrder));
            }
            if before.is_some_and(|before| self.stab.list(before) >= &children[..]) {
                return Err(r.fail(1, Kind::StabOrder));
            }
            self.stab.children.extend_from_slice(&children);
            let end = u32::try_from(self.stab.children.len()).map_err(|_| r.fail(1, Kind::Number))?;
            self.stab.first_child.push(end);
            self.stab.open.push(open);
            self.height.push(self.level);
            before = Some(list);
            if !more {
                return Ok(());
            }
        }
    }

    /// Reads a header and makes its nodes, which share the list that follows; returns the length of that list, and
    /// whether another one follows in the group.
    fn header(&mut self, r: &mut Reader<'_>, entries: &[u32]) -> Result<(u64, bool), DecodeError> {
        let list = u32::try_from(self.stab.open.len()).map_err(|_| r.fail(0, Kind::Number))?;
        let head = r.varint()?;
        let (least, begin) = (u64::from(self.level > 0), self.stab.n_nodes());
        let n_children = if entries.len() <= MASK {
            let chosen = |(i, _): &(usize, &u32)| head >> (i + 1) & 1 == 1;
            self.stab.gates.extend(entries.iter().enumerate().filter(chosen).map(|(_, gate)| gate));
            head >> (entries.len() + 1)
        } else {
            let mut next = 0u64;
            for _ in 0..r.varint()? {
                let place = r.varint()?.saturating_add(next);
                let gate = usize::try_from(place).ok().and_then(|place| entries.get(place));
                self.stab.gates.push(*gate.ok_or_else(|| r.fail(1, Kind::StabOrder))?);
                next = place + 1;
            }
            head >> 1
        };
        let end = self.stab.n_nodes();
        if end == begin || u32::try_from(end).is_err() {
            return Err(r.fail(1, Kind::StabOrder));
        }
        self.stab.after.resize(end, list);
        self.used.resize(end, false);
        // At most 2^63, so one more fits.
        Ok((n_children + least, head & 1 == 1))
    }

    /// Reads `n` nodes out of a cell; returns them ascending.
    fn references(&mut self, r: &mut Reader<'_>, cell: usize, n: u64) -> Result<Vec<u32>, DecodeError> {
        r.expect(n, 1)?;
        let mut nodes = Vec::with_capacity(n as usize);
        let mut next = self.leaving[cell].len() as u64;
        for _ in 0..n {
            let place = r.varint()?.checked_add(1).and_then(|passed| next.checked_sub(passed));
            next = place.ok_or_else(|| r.fail(1, Kind::NoNode))?;
            let node = self.leaving[cell][next as usize];
            self.used[node as usize] = true;
            nodes.push(node);
        }
        nodes.reverse();
        Ok(nodes)
    }

    fn roots(&mut self, r: &mut Reader<'_>) -> Result<(), DecodeError> {
        let mut open = Bits::default();
        for cell in 0..self.leaving.len() {
            let head = r.varint()?;
            let roots = self.references(r, cell, head / 2)?;
            self.stab.roots.extend_from_slice(&roots);
            let end = u32::try_from(self.stab.roots.len()).map_err(|_| r.fail(1, Kind::Number))?;
            self.stab.first_root.push(end);
            open.push(head % 2 == 1);
        }
        self.stab.root_open = open;
        Ok(())
    }
}
