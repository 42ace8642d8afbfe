//! Makes proofs of scenes in space from the pieces that a search finds.

use super::branch::Branch;
use super::bytes::can_be_written;
use super::network::{AxialLine, AxialNetwork, Box3};
use super::{
    AxialProofs, BoxProof, ObjectProof, add_hidden, add_hidden_object, add_out_of_reach, are_hidden, is_object_hidden,
    no_wall,
};
use crate::bytes::{Coded, ReadError, ReadErrorKind, Reader, Writer};
use crate::pairs::{ObjectPairs, Pairs};
use std::sync::OnceLock;

/// Collects proofs of a scene. What does not hold is not taken.
#[derive(Debug)]
pub struct AxialMaker<'a> {
    network: &'a AxialNetwork,
    proofs: AxialProofs,
    visible: Pairs,
    hidden: Pairs,
    hidden_objects: ObjectPairs,
    /// Rectangles by the indices that proofs name when they are offered.
    blockers: &'a [Box3],
    /// The index of each blocker among those that accepted proofs use.
    number: Vec<Option<u32>>,
    /// Whether each blocker is a wall, once that is checked.
    is_wall: Vec<OnceLock<bool>>,
}

/// A proof that a maker has checked, and not taken yet. It names blockers by their indices in the maker's list.
#[derive(Debug, Clone)]
pub struct CheckedProof<'a> {
    network: &'a AxialNetwork,
    blockers: &'a [Box3],
    statement: Statement,
}

/// What it proves, and how.
#[derive(Debug, Clone)]
enum Statement {
    Boxes(BoxProof),
    Object(ObjectProof),
}

impl CheckedProof<'_> {
    /// Proofs as bytes for [`AxialMaker::check_bytes`].
    pub fn all_to_bytes(proofs: &[Self]) -> Vec<u8> {
        let mut writer = Writer::default();
        writer.size(proofs.len());
        proofs.iter().for_each(|proof| proof.statement.write(&mut writer));
        writer.into_bytes()
    }
}

/// 0 and a proof about boxes, or 1 and one about an object.
impl Coded for Statement {
    const LEAST: usize = 9;

    fn write(&self, writer: &mut Writer) {
        match self {
            Self::Boxes(proof) => {
                writer.byte(0);
                proof.write(writer);
            }
            Self::Object(proof) => {
                writer.byte(1);
                proof.write(writer);
            }
        }
    }

    fn read(reader: &mut Reader<'_>) -> Result<Self, ReadError> {
        match reader.byte()? {
            0 => BoxProof::read(reader).map(Self::Boxes),
            1 => ObjectProof::read(reader).map(Self::Object),
            code => reader.fail(1, ReadErrorKind::Code(code)),
        }
    }
}

impl<'a> AxialMaker<'a> {
    /// A maker without proofs. Proofs name `blockers` by their indices; only rectangles that are named have to be walls.
    pub fn new(network: &'a AxialNetwork, blockers: &'a [Box3]) -> Self {
        let n = network.n_cells();
        Self {
            network,
            proofs: AxialProofs { checksum: network.checksum(), ..AxialProofs::default() },
            visible: Pairs::none(n),
            hidden: Pairs::none(n),
            hidden_objects: ObjectPairs::none(n, network.n_objects()),
            blockers,
            number: vec![None; blockers.len()],
            is_wall: vec![OnceLock::new(); blockers.len()],
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
    pub fn take_line(&mut self, line: AxialLine, at_least: usize) -> bool {
        let is_taken = self.visible.add_all_if_new(&self.network.follow(&line), at_least);
        if is_taken {
            self.proofs.lines.push(line);
        }
        is_taken
    }

    /// How many lines were taken.
    pub fn n_lines(&self) -> usize {
        self.proofs.lines.len()
    }

    /// The lines that were taken since there were so many, as bytes for [`Self::take_lines_again`].
    pub fn lines_since(&self, n_lines: usize) -> Vec<u8> {
        let mut writer = Writer::default();
        writer.list(self.proofs.lines.get(n_lines..).unwrap_or_default());
        writer.into_bytes()
    }

    /// Takes lines that another maker had taken, when this one has taken the same before them. Each is checked again, and has to prove
    /// something new. Returns whether all were taken; if not, some may be.
    pub fn take_lines_again(&mut self, bytes: &[u8]) -> bool {
        let mut reader = Reader::of(bytes);
        let Ok(lines) = reader.list::<AxialLine>() else { return false };
        reader.end().is_ok() && lines.into_iter().all(|line| self.take_line(line, 1))
    }

    /// A proof that one box is hidden from another, if it holds, rests on walls, and can be written as bytes. Threads may check proofs at
    /// the same time.
    pub fn check_boxes(&self, boxes: [&Box3; 2], octants: Vec<(u8, Branch)>) -> Option<CheckedProof<'a>> {
        let [first, second] = boxes.map(|b| self.network.name(b));
        let names = [first?, second?];
        let holds =
            can_be_written(&octants) && are_hidden(boxes, &octants, self.blockers) && self.rests_on_walls(&octants);
        holds.then(|| self.checked(Statement::Boxes(BoxProof { boxes: names, octants })))
    }

    /// The same for a proof that an object is hidden from all cells in a box.
    pub fn check_object(&self, cells: &Box3, object: u32, octants: Vec<(u8, Branch)>) -> Option<CheckedProof<'a>> {
        let (name, around) = (self.network.name(cells)?, self.network.object(object)?);
        let holds = can_be_written(&octants)
            && is_object_hidden([cells, around], &octants, self.blockers)
            && self.rests_on_walls(&octants);
        holds.then(|| self.checked(Statement::Object(ObjectProof { cells: name, object, octants })))
    }

    fn checked(&self, statement: Statement) -> CheckedProof<'a> {
        CheckedProof { network: self.network, blockers: self.blockers, statement }
    }

    /// Proofs from the bytes of [`CheckedProof::all_to_bytes`], if all hold; each is checked again.
    pub fn check_bytes(&self, bytes: &[u8]) -> Option<Vec<CheckedProof<'a>>> {
        let mut reader = Reader::of(bytes);
        let statements = reader.list::<Statement>().ok()?;
        reader.end().ok()?;
        let check = |statement| match statement {
            Statement::Boxes(BoxProof { boxes: [first, second], octants }) => {
                self.check_boxes([&self.network.named(&first)?, &self.network.named(&second)?], octants)
            }
            Statement::Object(ObjectProof { cells, object, octants }) => {
                self.check_object(&self.network.named(&cells)?, object, octants)
            }
        };
        statements.into_iter().map(check).collect()
    }

    /// Takes a proof. Returns whether it was taken: not if it was checked by a maker for another network or with other blockers.
    pub fn take(&mut self, proof: CheckedProof<'_>) -> bool {
        let is_own = std::ptr::eq(proof.network, self.network) && std::ptr::eq(proof.blockers, self.blockers);
        if !is_own {
            return false;
        }
        match proof.statement {
            Statement::Boxes(mut proof) => {
                proof.octants.iter_mut().for_each(|(_, branch)| self.renumber(branch));
                if let [Some(first), Some(second)] = proof.boxes.map(|name| self.network.named(&name)) {
                    add_hidden([&first, &second], self.network, &mut self.hidden);
                }
                self.proofs.boxes.push(proof);
            }
            Statement::Object(mut proof) => {
                proof.octants.iter_mut().for_each(|(_, branch)| self.renumber(branch));
                if let Some(cells) = self.network.named(&proof.cells) {
                    add_hidden_object(&cells, proof.object, self.network, &mut self.hidden_objects);
                }
                self.proofs.objects_checksum = self.network.objects_checksum();
                self.proofs.objects.push(proof);
            }
        }
        true
    }

    /// Takes a proof that one box is hidden from another if [`Self::check_boxes`] accepts it. Returns whether it was taken.
    pub fn take_boxes(&mut self, boxes: [&Box3; 2], octants: Vec<(u8, Branch)>) -> bool {
        let checked = self.check_boxes(boxes, octants);
        checked.is_some_and(|proof| self.take(proof))
    }

    /// Adds the objects that no line gets to, as every cell that they touch is proven hidden by now. They need no proofs of their own.
    pub fn add_out_of_reach(&mut self) {
        add_out_of_reach(self.network, &self.hidden, &mut self.hidden_objects);
    }

    /// Takes a proof that an object is hidden from all cells in a box if [`Self::check_object`] accepts it. Returns whether it was taken.
    pub fn take_object(&mut self, cells: &Box3, object: u32, octants: Vec<(u8, Branch)>) -> bool {
        let checked = self.check_object(cells, object, octants);
        checked.is_some_and(|proof| self.take(proof))
    }

    /// Whether all blockers that branches name are walls.
    fn rests_on_walls(&self, octants: &[(u8, Branch)]) -> bool {
        let mut used = Vec::new();
        octants.iter().for_each(|(_, branch)| named(branch, &mut used));
        used.iter().all(|&index| self.is_wall(index as usize))
    }

    fn is_wall(&self, index: usize) -> bool {
        let (Some(rectangle), Some(known)) = (self.blockers.get(index), self.is_wall.get(index)) else { return false };
        let network = self.network;
        *known.get_or_init(|| network.name(rectangle).is_some() && no_wall(rectangle, network).is_none())
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
    pub fn finish(self) -> AxialProofs {
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
