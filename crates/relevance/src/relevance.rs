//! Who may see whom, tick by tick.

use crate::body::{Player, PlayerRole};
use crate::distance::{lies_in, widened};
use crate::near::World;
use crate::pairs::Pairs;
use crate::reaches::Reaches;
use sightlines_geometry::Aabb;
use sightlines_pvs::Table;
use sightlines_pvs::bits::{ones, or_words};
use std::sync::Arc;

/// How [`Relevance`] answers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RelevanceOptions {
    /// For how many seconds somebody stays shown who may no longer be seen.
    pub hold: f64,
    /// How many bodies are placed exactly in a tick, those that have moved first in turn. The others count as anywhere in the cells that they are in,
    /// which shows them sooner, never later.
    pub looks: usize,
    /// How far a body may move until it is placed again, in scene units along each axis: more is less work, and shows bodies sooner.
    pub slack: f64,
    /// Up to which distance ways through portals count from the exact place of a body, for reaches of such ways: at most the largest reach that
    /// pays, in scene units. Memory grows with its square.
    pub walk: f64,
}

impl RelevanceOptions {
    /// What suits most games: a hold of half a second, 256 bodies a tick, a slack of a quarter of a metre, and walks of eight, as the
    /// [usual reaches](Reaches::usual_ladder) have metres.
    pub fn of(table: &Table) -> Self {
        let usual = Reaches::usual_ladder(table);
        Self { hold: 0.5, looks: 256, slack: usual[0], walk: 2.0 * usual[4] }
    }
}

/// What changed in a tick. Pairs are the one who is told and the one of whom, by their places in the list of players.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Changes {
    /// Pairs that are shown from now on.
    pub gained: Vec<[u32; 2]>,
    /// Pairs that are no longer shown.
    pub lost: Vec<[u32; 2]>,
    /// Bodies that were placed exactly in this tick.
    pub n_looks: usize,
    /// Bodies that had moved and were not, as no look was left; their answers are coarser.
    pub n_coarse: usize,
    /// Bodies of which nothing is known: outside of all cells, in part outside of cells that leave gaps, or without a valid box.
    pub n_outside: usize,
}

/// How well the place of a body is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Known {
    /// It was never placed, or it is not known.
    No,
    /// The cells that it is in.
    Cells,
    /// Those near it as well.
    Near,
}

/// Where a body is, and for how long that holds.
#[derive(Debug)]
struct Slot {
    known: Known,
    /// The boxes for which it holds: of the eyes and of what is seen.
    boxes: [Aabb<3>; 2],
    reaches: [f64; 2],
    /// Whether the camera follows the body: it goes on no ways.
    has_arm: bool,
    /// Whether all of the boxes are where cells are known, so that nobody within them is outside.
    is_inside: bool,
    role: PlayerRole,
    /// The cells that these touch.
    here: [Vec<u32>; 2],
    /// All that is seen from where the eyes may get, as bits.
    sees: Vec<u64>,
    /// Where what is seen of it may get: words of bits that are not 0.
    near: Vec<(u32, u64)>,
    /// Changed in this tick.
    is_new: bool,
}

/// Who may see whom of bodies that move through a scene.
///
/// A pair is shown in a tick if the first, within the reach of both, could have a line of sight to the second: within the cells of the table, whatever way
/// they take. So whoever comes to see somebody was shown them for as long as both took for their reach, if nobody was
/// faster than that. Somebody outside of all cells is shown to all, and all to them, from the tick in which they get there.
///
/// A tick allocates nothing once it is warm.
#[derive(Debug)]
pub struct Relevance {
    pub(crate) world: World,
    options: RelevanceOptions,
    slots: Vec<Slot>,
    pairs: Pairs,
    changes: Changes,
    /// Whose turn it is to be placed.
    next: usize,
    dirty: Vec<u32>,
    pub(crate) pending: Vec<u32>,
    pub(crate) found: Vec<u32>,
}

impl Relevance {
    /// Of a table and its reaches.
    ///
    /// # Panics
    /// If the reaches are not [those of the table](Reaches::are_of).
    pub fn new(table: impl Into<Arc<Table>>, reaches: Reaches, options: RelevanceOptions) -> Self {
        let table = table.into();
        assert!(reaches.are_of(&table), "reaches are those of the table");
        Self {
            world: World::new(table, reaches, options.walk),
            options,
            slots: Vec::new(),
            pairs: Pairs::default(),
            changes: Changes::default(),
            next: 0,
            dirty: Vec::new(),
            pending: Vec::new(),
            found: Vec::new(),
        }
    }

    /// The table.
    pub fn table(&self) -> &Arc<Table> {
        &self.world.table
    }

    /// The reaches of pairs of cells.
    pub fn reaches(&self) -> &Reaches {
        &self.world.reaches
    }

    /// Who is shown to whom from now on. A body is told by its place in the list, from tick to tick; where somebody else takes a place, it is as if the
    /// former had jumped there. With fewer players than before, pairs with those that went are dropped and not listed in [`Changes::lost`].
    ///
    /// * `now`: seconds, of any beginning, not descending
    ///
    /// Cost: O(cells near it) for each body that has moved by more than the slack, O(n / 64) at worst for each pair with one that has, for n cells. Memory: a
    /// quarter of a byte for each who is told and each other; for each body the cells near it, and a bit for each cell if it is told of others.
    pub fn update(&mut self, now: f64, players: &[Player]) -> &Changes {
        self.resize(players);
        self.changes.gained.clear();
        self.changes.lost.clear();
        (self.changes.n_looks, self.changes.n_coarse, self.changes.n_outside) = (0, 0, 0);
        self.place(players);
        self.compare(now, players);
        self.pairs.release(now, &mut self.changes.lost);
        &self.changes
    }

    /// What changed in the last tick; nothing before the first.
    pub const fn changes(&self) -> &Changes {
        &self.changes
    }

    /// Whether a pair was shown in the last tick.
    pub fn is_shown(&self, to: u32, of: u32) -> bool {
        self.pairs.shown_to(to).get(of as usize / 64).is_some_and(|bits| bits >> (of % 64) & 1 == 1)
    }

    /// Who was shown to somebody in the last tick, ascending.
    pub fn shown_to(&self, to: u32) -> impl Iterator<Item = u32> + '_ {
        ones(self.pairs.shown_to(to)).map(|of| of as u32)
    }

    fn resize(&mut self, players: &[Player]) {
        let n = players.len();
        if n == self.slots.len() {
            return;
        }
        self.pairs.resize(n);
        self.slots.resize_with(n, || Slot {
            known: Known::No,
            boxes: [Aabb::EMPTY; 2],
            reaches: [0.0; 2],
            has_arm: false,
            is_inside: false,
            role: PlayerRole::THING,
            here: [Vec::new(), Vec::new()],
            sees: Vec::new(),
            near: Vec::new(),
            is_new: true,
        });
    }

    /// Finds where bodies are, of which that does not hold any more.
    fn place(&mut self, players: &[Player]) {
        let n = players.len();
        let mut left = self.options.looks;
        // A slack of which nothing can be said is none.
        let slack = self.options.slack;
        let slack = if slack >= 0.0 && slack.is_finite() { slack } else { 0.0 };
        self.dirty.clear();
        let start = if n == 0 { 0 } else { self.next % n };
        for i in (start..n).chain(0..start) {
            let player = &players[i];
            let slot = &mut self.slots[i];
            let was_new = std::mem::take(&mut slot.is_new);
            if !was_new && slot.holds(&self.world, player, slack, &mut self.pending, &mut self.found) {
                continue;
            }
            let was_unknown = !was_new && slot.known == Known::No && slot.role == player.role;
            slot.place(&self.world, player, slack, left > 0, &mut self.pending, &mut self.found);
            match slot.known {
                // It is shown to all, as before.
                Known::No if was_unknown => continue,
                Known::No => {}
                Known::Near => {
                    left -= 1;
                    self.changes.n_looks += 1;
                }
                Known::Cells => {
                    if self.changes.n_coarse == 0 {
                        self.next = i;
                    }
                    self.changes.n_coarse += 1;
                }
            }
            slot.is_new = true;
            self.dirty.push(i as u32);
        }
        self.changes.n_outside = self.slots.iter().filter(|s| s.known == Known::No).count();
        self.dirty.sort_unstable();
    }

    /// Compares the pairs of which one has changed.
    fn compare(&mut self, now: f64, players: &[Player]) {
        for (to, player) in players.iter().enumerate() {
            if player.role.views {
                self.pairs.open(to);
            } else if !self.pairs.has_row(to) {
                continue;
            }
            if self.slots[to].is_new {
                for of in 0..players.len() {
                    self.compare_pair(now, players, to, player, of);
                }
            } else if player.role.views {
                for d in 0..self.dirty.len() {
                    self.compare_pair(now, players, to, player, self.dirty[d] as usize);
                }
            }
        }
        for d in &self.dirty {
            self.slots[*d as usize].is_new = false;
        }
    }

    #[inline]
    fn compare_pair(&mut self, now: f64, players: &[Player], to: usize, player: &Player, of: usize) {
        let role = &players[of].role;
        let may = to != of && player.role.views && role.is_seen && {
            player.role.always_sees(role) || self.may_see(&self.slots[to], &self.slots[of])
        };
        let until = now + self.options.hold.max(0.0);
        self.pairs.set([to, of], may, until, &mut self.changes.gained);
    }

    fn may_see(&self, a: &Slot, b: &Slot) -> bool {
        if a.known == Known::No || b.known == Known::No {
            return true;
        }
        let are_near = a.known == Known::Near && b.known == Known::Near;
        if are_near && b.near.iter().all(|&(word, bits)| a.sees[word as usize] & bits == 0) {
            return false;
        }
        // Either way is right alone. That of cells knows ways from each place to each, and takes bodies to be anywhere in their cells.
        !self.world.are_hidden(&a.here[0], a.reaches[0], a.has_arm, &b.here[1], b.reaches[1])
    }
}

impl Slot {
    /// Whether what is known holds for a body as it is now, and is no more than by about the slack too much.
    fn holds(&self, world: &World, player: &Player, slack: f64, pending: &mut Vec<u32>, found: &mut Vec<u32>) -> bool {
        let body = &player.body;
        let (Some(eyes), Some(seen)) = (world.valid(&body.eyes), world.valid(&body.seen)) else {
            return false;
        };
        // It holds within its boxes. From twice the slack on, and some more for rounding, it is found anew, as it shows too much; no answer depends on that. Comparisons
        // with NaN are false.
        let fits = |which: usize, b: &Aabb<3>, reach: f64| {
            lies_in(b, &self.boxes[which])
                && lies_in(&self.boxes[which], &widened(b, 3.0 * slack))
                && reach <= self.reaches[which]
                && self.reaches[which] <= reach + slack
        };
        let mut is_known = |b: &Aabb<3>| {
            world.touching(b, pending, found);
            world.is_known(b, found)
        };
        let views = player.role.views;
        self.known == Known::Near
            && self.role == player.role
            && (!views || fits(0, &eyes, body.eye_reach()) && self.has_arm == (body.arm != 0.0))
            && fits(1, &seen, body.reach)
            && (self.is_inside || (is_known(&seen) && (!views || is_known(&eyes))))
    }

    /// Places a body: with the cells near it, or without.
    fn place(
        &mut self,
        world: &World,
        player: &Player,
        slack: f64,
        exactly: bool,
        pending: &mut Vec<u32>,
        found: &mut Vec<u32>,
    ) {
        let body = &player.body;
        (self.known, self.role, self.has_arm) = (Known::No, player.role, body.arm != 0.0);
        self.reaches = [body.eye_reach(), body.reach];
        let (Some(eyes), Some(seen)) = (world.valid(&body.eyes), world.valid(&body.seen)) else {
            return;
        };
        if !body.has_lengths() {
            return;
        }
        let slack = if exactly { slack } else { 0.0 };
        self.boxes = [eyes, seen].map(|b| world.valid(&widened(&b, slack)).unwrap_or(b));
        let views = player.role.views;
        // Where the eyes are within what is seen, as usual, what is found for that serves them as well.
        let [wide_eyes, wide_seen] = self.boxes;
        let is_part = lies_in(&wide_eyes, &wide_seen);
        self.is_inside = true;
        for (which, b) in [(1, &seen), (0, &eyes)] {
            if which == 0 && !views {
                continue;
            }
            world.touching(&self.boxes[which], pending, &mut self.here[which]);
            if which == 0 && is_part {
                // Eyes in a wall are in no cell.
                if self.here[0].is_empty() {
                    return;
                }
                continue;
            }
            if world.is_known(&self.boxes[which], &self.here[which]) {
                continue;
            }
            self.is_inside = false;
            world.touching(b, pending, found);
            if !world.is_known(b, found) {
                return;
            }
        }
        self.known = if exactly { Known::Near } else { Known::Cells };
        if !exactly {
            return;
        }
        world.near(&wide_seen, Some(&self.here[1]), self.reaches[1], pending, found);
        self.near.clear();
        for &cell in found.iter() {
            let (word, bit) = (cell / 64, 1 << (cell % 64));
            match self.near.last_mut() {
                Some((last, bits)) if *last == word => *bits |= bit,
                _ => self.near.push((word, bit)),
            }
        }
        if !views {
            return;
        }
        if is_part && !self.has_arm {
            world.near_part(&wide_eyes, &self.here[0], self.reaches[0], found);
        } else {
            let here = (!self.has_arm).then_some(&self.here[0][..]);
            world.near(&wide_eyes, here, self.reaches[0], pending, found);
        }
        self.sees.clear();
        self.sees.resize(world.n_cells().div_ceil(64), 0);
        found.iter().for_each(|&cell| or_words(&mut self.sees, world.row(cell)));
    }
}
