//! What engines look through: which lines of a map hide nothing.

use super::content::{Content, Game, LineDef, Numbering};
use std::collections::BTreeMap;

/// Things of Sonic Robo Blast 2 where polyobjects appear, in its versions; the bits above these twelve are not of the kind.
const SRB2_SPAWN_SPOTS: [i32; 2] = [761, 762];
const SRB2_KIND: i32 = 0xFFF;

impl Content {
    /// Specials of lines: the first line of a polyobject, behind whose end the others go on, and a line that is one by itself; for each engine.
    ///
    /// Source: those of Hexen, of the Eternity Engine (polyobj.h) and of Sonic Robo Blast 2 (p_polyobj.h). The last mean something else in Doom: in a map
    /// that does not say whose it is, they count if a polyobject appears in it.
    fn polyobject_specials(&self) -> &'static [[i32; 2]] {
        let appear = || self.things.iter().any(|thing| SRB2_SPAWN_SPOTS.contains(&(thing.kind & SRB2_KIND)));
        match self.numbering {
            Numbering::Hexen => &[[1, 5]],
            Numbering::Srb2 => &[[20, 21]],
            Numbering::Doom if appear() => &[[348, 349], [20, 21]],
            Numbering::Doom => &[[348, 349]],
        }
    }
}

/// Which lines belong to polyobjects. Those of one that has a first line are all that can be reached from its ends along sides, each
/// from its first vertex to its second: vertices at one place are one. Engines differ in the end where they begin, and in the way that they take where
/// several lines do.
/// O(n log n).
pub(super) fn in_polyobjects(content: &Content) -> Vec<bool> {
    let known = content.polyobject_specials();
    let mut found = vec![false; content.lines.len()];
    let mut todo = Vec::new();
    for (k, (line, &special)) in content.lines.iter().zip(&content.specials).enumerate() {
        found[k] = known.as_flattened().contains(&special);
        let is_start = known.iter().any(|[start, _]| *start == special);
        todo.extend([line.v1, line.v2].into_iter().filter(|_| is_start));
    }
    if todo.is_empty() {
        return found;
    }
    // Engines have numbers with 16 binary places.
    let place = |vertex: u32| content.vertices[vertex as usize].map(|x| (x * 65536.0).round() as i64);
    let mut from: BTreeMap<[i64; 2], Vec<(usize, u32)>> = BTreeMap::new();
    for (k, line) in content.lines.iter().enumerate() {
        from.entry(place(line.v1)).or_default().push((k, line.v2));
        if line.left.is_some() {
            from.entry(place(line.v2)).or_default().push((k, line.v1));
        }
    }
    // Each place is left once.
    while let Some(vertex) = todo.pop() {
        for (k, end) in from.remove(&place(vertex)).unwrap_or_default() {
            found[k] = true;
            todo.push(end);
        }
    }
    found
}

impl LineDef {
    /// Whether some engine of these looks through the line: all there are, unless it is known to be one of Doom.
    pub(super) fn is_seen_through(&self, game: Option<Game>) -> bool {
        self.is_two_sided() || self.left.is_some() && game != Some(Game::Doom)
    }
}
