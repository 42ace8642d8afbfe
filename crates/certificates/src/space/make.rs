//! Proofs of scenes in space, put together from what others find.

use super::branch::Branch;
use super::bytes::can_be_written;
use super::network::{Box3, BoxLine, BoxNetwork, is_within};
use super::{BoxProof, BoxProofs, are_hidden, no_wall};
use crate::pairs::Pairs;

/// Collects proofs: what does not hold is not taken.
#[derive(Debug)]
pub struct BoxMaker<'a> {
    network: &'a BoxNetwork,
    proofs: BoxProofs,
    visible: Pairs,
    hidden: Pairs,
    /// What may hide, by the numbers that proofs have when they come.
    blockers: &'a [Box3],
    /// The number of each of them among those that are used.
    number: Vec<Option<u32>>,
    /// Whether each was found to be a wall.
    is_wall: Vec<Option<bool>>,
}

impl<'a> BoxMaker<'a> {
    /// No proofs yet. `blockers`: rectangles that proofs will name by their indices; only those that are named have to be walls.
    pub fn new(network: &'a BoxNetwork, blockers: &'a [Box3]) -> Self {
        let n = network.n_cells();
        Self {
            network,
            proofs: BoxProofs { checksum: network.checksum(), ..BoxProofs::default() },
            visible: Pairs::none(n),
            hidden: Pairs::none(n),
            blockers,
            number: vec![None; blockers.len()],
            is_wall: vec![None; blockers.len()],
        }
    }

    /// The pairs that the lines taken so far prove to be visible.
    pub fn visible(&self) -> &Pairs {
        &self.visible
    }

    /// The pairs that are proven hidden so far.
    pub fn hidden(&self) -> &Pairs {
        &self.hidden
    }

    /// Takes a line if it proves at least so many pairs, one or more, that no other did; whether it does.
    pub fn take_line(&mut self, line: BoxLine, at_least: usize) -> bool {
        let cells = self.network.follow(&line);
        let pairs = cells.iter().enumerate().flat_map(|(i, &a)| cells[..i].iter().map(move |&b| [a, b]));
        let is_new = pairs.filter(|&[a, b]| !self.visible.has(a, b)).count() >= at_least.max(1);
        if is_new {
            self.visible.add_all(&cells);
            self.proofs.lines.push(line);
        }
        is_new
    }

    /// Takes a proof that one box is hidden from another, if it holds and bytes can hold it; whether it does.
    pub fn take_boxes(&mut self, boxes: [&Box3; 2], mut octants: Vec<(u8, Branch)>) -> bool {
        let [Some(first), Some(second)] = boxes.map(|b| self.network.name(b)) else { return false };
        if !can_be_written(&octants) || !are_hidden(boxes, &octants, self.blockers) {
            return false;
        }
        let mut used = Vec::new();
        octants.iter().for_each(|(_, branch)| named(branch, &mut used));
        if !used.iter().all(|&index| self.is_wall(index as usize)) {
            return false;
        }
        octants.iter_mut().for_each(|(_, branch)| self.renumber(branch));
        let within = |b: &Box3| -> Vec<u32> {
            (0u32..).zip(&self.network.cells).filter(|(_, cell)| is_within(cell, b)).map(|(id, _)| id).collect()
        };
        let (firsts, seconds) = (within(boxes[0]), within(boxes[1]));
        for &a in &firsts {
            seconds.iter().filter(|&&b| b != a).for_each(|&b| self.hidden.add(a, b));
        }
        self.proofs.boxes.push(BoxProof { boxes: [first, second], octants });
        true
    }

    fn is_wall(&mut self, index: usize) -> bool {
        let Some(rectangle) = self.blockers.get(index) else { return false };
        let network = self.network;
        *self.is_wall[index]
            .get_or_insert_with(|| network.name(rectangle).is_some() && no_wall(rectangle, network).is_none())
    }

    /// Names blockers by their numbers among those that are used; they are all walls.
    fn renumber(&mut self, branch: &mut Branch) {
        if let Branch::Past { blocker, ways, .. } = branch {
            let index = *blocker as usize;
            *blocker = match self.number[index] {
                Some(number) => number,
                None => {
                    let number = self.proofs.blockers.len() as u32;
                    self.proofs.blockers.extend(self.network.name(&self.blockers[index]));
                    self.number[index] = Some(number);
                    number
                }
            };
            ways.iter_mut().for_each(|(_, branch)| self.renumber(branch));
        }
    }

    /// The proofs.
    pub fn finish(self) -> BoxProofs {
        self.proofs
    }
}

/// The blockers that a branch names.
fn named(branch: &Branch, found: &mut Vec<u32>) {
    if let Branch::Past { blocker, ways, .. } = branch {
        found.push(*blocker);
        ways.iter().for_each(|(_, branch)| named(branch, found));
    }
}
