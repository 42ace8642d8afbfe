//! Makes proofs of scenes in space from the pieces that a search finds.

use super::branch::Branch;
use super::bytes::can_be_written;
use super::network::{Box3, BoxLine, BoxNetwork};
use super::{
    BoxProof, BoxProofs, ObjectProof, add_hidden, add_hidden_object, add_out_of_reach, are_hidden, is_object_hidden,
    no_wall,
};
use crate::pairs::{ObjectPairs, Pairs};

/// Collects proofs of a scene. What does not hold is not taken.
#[derive(Debug)]
pub struct BoxMaker<'a> {
    network: &'a BoxNetwork,
    proofs: BoxProofs,
    visible: Pairs,
    hidden: Pairs,
    hidden_objects: ObjectPairs,
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
            hidden_objects: ObjectPairs::none(n, network.n_objects()),
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

    /// The pairs of a cell and an object proven hidden so far.
    pub fn hidden_objects(&self) -> &ObjectPairs {
        &self.hidden_objects
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
        if !self.rests_on_walls(&mut octants) {
            return false;
        }
        add_hidden(boxes, self.network, &mut self.hidden);
        self.proofs.boxes.push(BoxProof { boxes: [first, second], octants });
        true
    }

    /// Adds the objects that no line gets to, as every cell that they touch is proven hidden by now. They need no proofs of their own.
    pub fn add_out_of_reach(&mut self) {
        add_out_of_reach(self.network, &self.hidden, &mut self.hidden_objects);
    }

    /// Takes a proof that an object is hidden from all cells in a box if it holds and can be written as bytes. Returns whether it was
    /// taken.
    pub fn take_object(&mut self, cells: &Box3, object: u32, mut octants: Vec<(u8, Branch)>) -> bool {
        let (Some(name), Some(around)) = (self.network.name(cells), self.network.object(object)) else { return false };
        if !can_be_written(&octants) || !is_object_hidden([cells, around], &octants, self.blockers) {
            return false;
        }
        if !self.rests_on_walls(&mut octants) {
            return false;
        }
        add_hidden_object(cells, object, self.network, &mut self.hidden_objects);
        self.proofs.objects_checksum = self.network.objects_checksum();
        self.proofs.objects.push(ObjectProof { cells: name, object, octants });
        true
    }

    /// Whether all blockers that branches name are walls; then the branches name them as the proofs do.
    fn rests_on_walls(&mut self, octants: &mut [(u8, Branch)]) -> bool {
        let mut used = Vec::new();
        octants.iter().for_each(|(_, branch)| named(branch, &mut used));
        let all = used.iter().all(|&index| self.is_wall(index as usize));
        if all {
            octants.iter_mut().for_each(|(_, branch)| self.renumber(branch));
        }
        all
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
