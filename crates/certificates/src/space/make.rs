//! Makes proofs of scenes in space from the pieces that a search finds.

use super::branch::Branch;
use super::bytes::can_be_written;
use super::network::{Box3, BoxLine, BoxNetwork};
use super::{BoxProof, BoxProofs, add_hidden, are_hidden, no_wall};
use crate::pairs::Pairs;

/// Collects proofs of a scene. What does not hold is not taken.
#[derive(Debug)]
pub struct BoxMaker<'a> {
    network: &'a BoxNetwork,
    proofs: BoxProofs,
    visible: Pairs,
    hidden: Pairs,
    /// Rectangles by the indices that proofs name when they are offered.
    blockers: &'a [Box3],
    /// The index of each blocker among those that accepted proofs use.
    number: Vec<Option<u32>>,
    /// Whether each blocker is a wall; `None` if that is not checked yet.
    is_wall: Vec<Option<bool>>,
}

impl<'a> BoxMaker<'a> {
    /// A maker without proofs. Proofs name `blockers` by their indices; only rectangles that are named have to be walls.
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

    /// The pairs that the lines taken so far prove visible.
    pub fn visible(&self) -> &Pairs {
        &self.visible
    }

    /// The pairs proven hidden so far.
    pub fn hidden(&self) -> &Pairs {
        &self.hidden
    }

    /// Takes a line if it proves at least `at_least` pairs, and at least one, that no other line does. Returns whether it
    /// was taken.
    pub fn take_line(&mut self, line: BoxLine, at_least: usize) -> bool {
        let is_taken = self.visible.add_all_if_new(&self.network.follow(&line), at_least);
        if is_taken {
            self.proofs.lines.push(line);
        }
        is_taken
    }

    /// Takes a proof that one box is hidden from another if it holds and can be written as bytes. Returns whether it was taken.
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
        add_hidden(boxes, self.network, &mut self.hidden);
        self.proofs.boxes.push(BoxProof { boxes: [first, second], octants });
        true
    }

    fn is_wall(&mut self, index: usize) -> bool {
        let Some(rectangle) = self.blockers.get(index) else { return false };
        let network = self.network;
        *self.is_wall[index]
            .get_or_insert_with(|| network.name(rectangle).is_some() && no_wall(rectangle, network).is_none())
    }

    /// Replaces the indices of blockers, which are all walls, by their indices among those that are used.
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
