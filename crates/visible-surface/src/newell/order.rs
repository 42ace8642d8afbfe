//! The list of fragments, and which of it comes next.

use super::item::{Item, NO_ITEM, State, TESTS, Tests};
use crate::counters::Counters;
use crate::fragment::Fragment;
use crate::method::RenderInput;
use sightlines_geometry::{Aabb, BoxTree};
use std::collections::BinaryHeap;

/// Depth sort of what one camera sees.
#[derive(Debug)]
pub(super) struct Order<'a> {
    tests: Tests<'a>,
    items: Vec<Item>,
    /// The bounds of the items that were there at the beginning.
    tree: BoxTree<3>,
    /// Items that are not drawn, the farthest first, and some that are gone.
    waiting: BinaryHeap<(u64, u32)>,
    /// Marked items, each of which has to come after the next.
    chain: Vec<u32>,
    drawn: Vec<Fragment>,
    splits: u64,
}

impl<'a> Order<'a> {
    pub(super) fn new(input: &'a RenderInput<'a>) -> Self {
        let items: Vec<Item> = input.mask.iter().filter_map(|f| Item::new(input, Fragment::whole(f))).collect();
        let bounds: Vec<Aabb<3>> = items
            .iter()
            .map(|item| {
                let ([across, down], depth) = (item.extents.pixels, item.extents.depth);
                Aabb { min: [across[0], down[0], depth[0]], max: [across[1], down[1], depth[1]] }
            })
            .collect();
        let waiting = (0..).zip(&items).map(|(k, item)| item.key(k)).collect();
        Self {
            tests: Tests { input, made: [0; 7], n_exact: Default::default() },
            tree: BoxTree::build(&bounds, 8),
            items,
            waiting,
            chain: Vec::new(),
            drawn: Vec::new(),
            splits: 0,
        }
    }

    /// All fragments, from back to front.
    pub(super) fn run(mut self, counters: &mut Counters) -> Vec<Fragment> {
        counters.polygons += self.items.len() as u64;
        while let Some(p) = self.next() {
            match self.obstacle(p) {
                None => self.draw(p),
                Some(q) if self.item(q).state == State::Marked => self.resolve(q),
                Some(q) => self.mark(q),
            }
        }
        for (name, made) in TESTS.into_iter().zip(self.tests.made) {
            counters.tested(name, made);
        }
        counters.splits += self.splits;
        counters.exact += self.tests.n_exact.get();
        self.drawn
    }

    fn item(&self, item: u32) -> &Item {
        &self.items[item as usize]
    }

    fn item_mut(&mut self, item: u32) -> &mut Item {
        &mut self.items[item as usize]
    }

    /// What was last moved to the end of the list, else the farthest item.
    fn next(&mut self) -> Option<u32> {
        if let Some(&last) = self.chain.last() {
            return Some(last);
        }
        while let Some(&(_, farthest)) = self.waiting.peek() {
            if !self.item(farthest).is_gone() {
                self.mark(farthest);
                return Some(farthest);
            }
            self.waiting.pop();
        }
        None
    }

    fn mark(&mut self, item: u32) {
        self.item_mut(item).state = State::Marked;
        self.chain.push(item);
    }

    fn draw(&mut self, p: u32) {
        self.chain.pop();
        let item = self.item_mut(p);
        item.state = State::Drawn;
        item.rest = None;
        let fragment = item.fragment.clone();
        self.drawn.push(fragment);
    }

    /// The first item that may not come after p, if there is one. Against all others that wait, p has passed a test.
    fn obstacle(&mut self, p: u32) -> Option<u32> {
        let mut rest = match self.item_mut(p).rest.take() {
            Some(rest) => rest,
            None => self.candidates(p),
        };
        let found = loop {
            let Some(&q) = rest.last() else { break None };
            match self.item(q).state {
                State::Drawn => {
                    rest.pop();
                }
                State::Split(parts) => {
                    rest.pop();
                    let bounds = self.item(p).extents;
                    for part in parts.into_iter().filter(|&part| part != NO_ITEM) {
                        // If it was split as well, these are bounds of its parts.
                        let extents = self.items[part as usize].extents;
                        if self.tests.overlap(&bounds, &extents) {
                            rest.push(part);
                        }
                    }
                }
                State::Waiting | State::Marked => {
                    let [p, q_item] = [p, q].map(|k| &self.items[k as usize]);
                    if !self.tests.may_precede(p, q_item) {
                        break Some(q);
                    }
                    rest.pop();
                }
            }
        };
        self.item_mut(p).rest = Some(rest);
        found
    }

    /// Items whose bounds overlap, the farthest last.
    fn candidates(&mut self, p: u32) -> Vec<u32> {
        let bounds = self.item(p).extents;
        let Self { tree, tests, items, .. } = self;
        let mut found = Vec::new();
        let enter = |b: &Aabb<3>| {
            bounds.depth[0] <= b.max[2]
                && (0..2).all(|k| b.min[k] <= bounds.pixels[k][1] && bounds.pixels[k][0] <= b.max[k])
        };
        tree.visit(enter, |q| {
            let item = &items[q as usize];
            // What was split still has the bounds of all of its parts.
            if q != p && item.state != State::Drawn && tests.overlap(&bounds, &item.extents) {
                found.push(q);
            }
        });
        found.sort_unstable_by_key(|&q| self.item(q).key(q));
        found
    }

    /// The end of the chain cannot come before `q`, which is in the chain and for that reason may not come before what
    /// follows it there: splits one of those that wait for each other in a circle.
    fn resolve(&mut self, q: u32) {
        let start = self.chain.iter().rposition(|&k| k == q).expect("what is marked is in the chain");
        let circle = self.chain[start..].to_vec();
        let n = circle.len();
        // First P by the plane of Q, and Q by the plane of P, as is customary; then those who follow each other, then
        // all others. Of those who follow each other the first that opens the circle, which saves splits; else any.
        let pairs = (1..n).flat_map(|apart| (0..n).map(move |k| (apart, k)));
        let both = pairs.flat_map(|(apart, k)| [(apart, (k + n - apart) % n, k), (apart, k, (k + n - apart) % n)]);
        let mut found = None;
        for (apart, k, by) in both {
            if apart > 1 && found.is_some() {
                break;
            }
            let plane = self.item(circle[by]).plane;
            let Some(parts) = self.item(circle[k]).fragment.split(self.tests.input.faces, &plane).1 else { continue };
            let opens = self.opens(&parts, circle[(k + n - 1) % n], circle[(k + 1) % n]);
            if opens || found.is_none() {
                found = Some((circle[k], parts));
            }
            if opens {
                break;
            }
        }
        let (split, parts) =
            found.expect("of fragments that wait for each other in a circle, the plane of one cuts another");
        self.splits += 1;
        self.replace(split, parts);
    }

    /// Whether no part both hides `next` and is hidden by `last`, as the whole does.
    fn opens(&mut self, parts: &[Fragment; 2], last: u32, next: u32) -> bool {
        parts.iter().all(|part| {
            let Some(part) = Item::new(self.tests.input, part.clone()) else { return true };
            let [last, next] = [last, next].map(|k| &self.items[k as usize]);
            self.tests.may_precede(last, &part) || self.tests.may_precede(&part, next)
        })
    }

    /// Puts parts in the place of an item of the chain, and takes marks from it and from what follows it.
    fn replace(&mut self, item: u32, parts: [Fragment; 2]) {
        while let Some(last) = self.chain.pop() {
            self.item_mut(last).state = State::Waiting;
            if last == item {
                break;
            }
        }
        // What the whole has passed, its parts pass too.
        let rest = self.item_mut(item).rest.take().expect("what is in the chain has begun");
        let parts = parts.map(|fragment| {
            let Some(mut part) = Item::new(self.tests.input, fragment) else { return NO_ITEM };
            let index = self.items.len() as u32;
            self.waiting.push(part.key(index));
            let mut rest = rest.clone();
            rest.retain(|&q| self.tests.overlap(&part.extents, &self.items[q as usize].extents));
            part.rest = Some(rest);
            self.items.push(part);
            index
        });
        self.item_mut(item).state = State::Split(parts);
    }
}
