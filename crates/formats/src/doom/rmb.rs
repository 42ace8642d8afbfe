//! Option files of RMB, the classic builder of REJECT lumps: effects on what monsters see that no line of sight explains.
//!
//! One option a line, in letters of either case, shortened as long as it stays the only one; `#` begins a comment. A line with nothing
//! but the name of a map begins the options of that map; those before the first such line are for every map. A list of sectors stands in
//! brackets, or is a single number.
//!
//! Taken are `BLIND` and `SAFE` with the distances 0 (from and to every sector) and 1 (but the sector itself), `INCLUDE` and `EXCLUDE`.
//! `NOMAP`, `PERFECT`, `PREPROCESS` and `PROCESS` steer the work of RMB only and mean nothing here; as with `PERFECT`, an effect is on the
//! sectors that are named, and not on those inside them. All other options are refused.

use crate::bytes::text_lines;
use crate::error::{Malformed, Within, in_file, malformed};
use crate::wad::LumpName;
use crate::{ReadError, RejectTable};
use std::path::Path;

/// An option file that was read.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct RmbFile {
    effects: Vec<Effect>,
}

/// One option, on the map that it is for, or on every map.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Effect {
    line: usize,
    map: Option<String>,
    kind: EffectKind,
    /// The sectors it is on; of [`EffectKind::Include`] and [`EffectKind::Exclude`] those of the viewers.
    sectors: Vec<u32>,
    /// What the viewers see or do not see.
    targets: Vec<u32>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum EffectKind {
    /// Sees nothing, or only itself.
    Blind(bool),
    /// Is seen from nowhere, or only from itself.
    Safe(bool),
    Include,
    Exclude,
}

/// All options of RMB: a word is one of them, or the beginning of a single one.
#[rustfmt::skip]
const OPTIONS: [&str; 23] = [
    "BAND", "BLIND", "BLOCK", "DISTANCE", "DOOR", "EXCLUDE", "GROUP", "INCLUDE", "INVERT", "LEFT", "LENGTH", "LINE",
    "NODOOR", "NOMAP", "NOPROCESS", "ONE", "PERFECT", "PREPROCESS", "PROCESS", "REPORT", "RIGHT", "SAFE", "TRACE",
];

impl RmbFile {
    /// Reads the text of an option file. O(length).
    ///
    /// # Errors
    /// [`Malformed`] with the first line that is wrong, or that has an option that is not taken.
    pub fn parse(text: &[u8]) -> Result<Self, Malformed> {
        let mut map = None;
        let mut effects = Vec::new();
        for (line, content) in (1..).zip(text_lines(text)) {
            let content = String::from_utf8_lossy(content);
            let content = content.split('#').next().unwrap_or_default().trim().to_ascii_uppercase();
            let (word, rest) = content.split_once(|c: char| c.is_whitespace() || c == '(').unwrap_or((&content, ""));
            if word.is_empty() && rest.is_empty() {
                continue;
            }
            if rest.is_empty() && super::list::is_doom_map_name(word.as_bytes()) {
                map = Some(word.to_owned());
                continue;
            }
            let word = if word.is_empty() { content.as_str() } else { word };
            // The bracket that ended the word belongs to the rest.
            let found = effect(word, content[word.len()..].trim()).within(format_args!("line {line}"))?;
            let map = map.clone();
            effects.extend(found.map(|(kind, sectors, targets)| Effect { line, map, kind, sectors, targets }));
        }
        Ok(Self { effects })
    }

    /// Reads an option file.
    ///
    /// # Errors
    /// [`ReadError`] with the file and what is wrong.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, ReadError> {
        let path = path.as_ref();
        in_file(path, || Ok(Self::parse(&std::fs::read(path)?)?))
    }

    /// Whether there are effects on a map.
    pub fn is_for(&self, map: LumpName) -> bool {
        self.effects_on(map).next().is_some()
    }

    fn effects_on(&self, map: LumpName) -> impl Iterator<Item = &Effect> {
        self.effects.iter().filter(move |e| e.map.as_ref().is_none_or(|name| map.is(name)))
    }

    /// Makes the effects on a map in its table; returns how many entries have changed.
    ///
    /// `EXCLUDE` counts more than `INCLUDE`, and that more than all others. Of two `BLIND`, or two `SAFE`, on one sector the later
    /// counts. Costs O(n) for each sector named, and O(n²) once.
    ///
    /// # Errors
    /// [`Malformed`] for a sector that the map does not have; then the table is as it was.
    pub fn apply(&self, map: LumpName, table: &mut RejectTable) -> Result<u64, Malformed> {
        let n = table.n_sectors();
        for effect in self.effects_on(map) {
            if let Some(&sector) = effect.sectors.iter().chain(&effect.targets).find(|&&s| s >= n) {
                let what = malformed!("sector {sector} is not among the {n} of map {map}");
                return Err(what.on_line(effect.line));
            }
        }
        let before = table.clone();
        let (mut blind, mut safe) = (vec![None; n as usize], vec![None; n as usize]);
        for effect in self.effects_on(map) {
            let (list, own) = match effect.kind {
                EffectKind::Blind(own) => (&mut blind, own),
                EffectKind::Safe(own) => (&mut safe, own),
                EffectKind::Include | EffectKind::Exclude => continue,
            };
            effect.sectors.iter().for_each(|&s| list[s as usize] = Some(own));
        }
        for (list, is_blind) in [(blind, true), (safe, false)] {
            for (sector, own) in (0..n).zip(list).filter_map(|(sector, own)| Some((sector, own?))) {
                for other in (0..n).filter(|&other| !own || other != sector) {
                    let (viewer, target) = if is_blind { (sector, other) } else { (other, sector) };
                    table.set(viewer, target, true);
                }
            }
        }
        for (kind, rejected) in [(EffectKind::Include, false), (EffectKind::Exclude, true)] {
            for effect in self.effects_on(map).filter(|e| e.kind == kind) {
                for &viewer in &effect.sectors {
                    effect.targets.iter().for_each(|&target| table.set(viewer, target, rejected));
                }
            }
        }
        let changed = before.as_bytes().iter().zip(table.as_bytes()).map(|(a, b)| u64::from((a ^ b).count_ones()));
        Ok(changed.sum())
    }
}

type Found = (EffectKind, Vec<u32>, Vec<u32>);

/// The effect of an option and what stands behind it; `None` for one that means nothing here.
fn effect(word: &str, rest: &str) -> Result<Option<Found>, Malformed> {
    let option = option(word)?;
    let argument = |expected: &str| malformed!("{option} takes {expected}");
    match option {
        "NOMAP" | "PERFECT" | "PREPROCESS" | "PROCESS" => Ok(None),
        "INCLUDE" | "EXCLUDE" => {
            let lists = sectors(rest).and_then(|(viewers, rest)| Some((viewers, sectors(rest)?)));
            let Some((viewers, (targets, ""))) = lists else { return Err(argument("two lists of sectors")) };
            let kind = if option == "INCLUDE" { EffectKind::Include } else { EffectKind::Exclude };
            Ok(Some((kind, viewers, targets)))
        }
        "BLIND" | "SAFE" => {
            let wrong = || argument("a distance and a list of sectors");
            let (distance, rest) = number(rest).ok_or_else(wrong)?;
            let Some((sectors, "")) = sectors(rest) else { return Err(wrong()) };
            let own = match distance {
                0 => false,
                1 => true,
                _ => return Err(malformed!("the distance {distance} is not supported, only 0 and 1 are")),
            };
            let kind = if option == "BLIND" { EffectKind::Blind(own) } else { EffectKind::Safe(own) };
            Ok(Some((kind, sectors, Vec::new())))
        }
        _ => Err(malformed!("the option {option} is not supported")),
    }
}

fn option(word: &str) -> Result<&'static str, Malformed> {
    let mut found = OPTIONS.iter().filter(|option| option.starts_with(word));
    // A whole word is never the beginning of another option.
    match (found.next(), found.next()) {
        (Some(option), None) => Ok(option),
        _ => {
            let word: String = word.chars().take(24).collect();
            Err(malformed!("{} is not an option of RMB", word.escape_debug()))
        }
    }
}

/// The number at the beginning of a text, and what stands behind it.
fn number(text: &str) -> Option<(u32, &str)> {
    let end = text.find(|c: char| !c.is_ascii_digit()).unwrap_or(text.len());
    Some((text[..end].parse().ok()?, text[end..].trim_start()))
}

/// The list of sectors at the beginning of a text, and what stands behind it.
fn sectors(text: &str) -> Option<(Vec<u32>, &str)> {
    let Some(list) = text.strip_prefix('(') else {
        let (sector, rest) = number(text)?;
        return Some((vec![sector], rest));
    };
    let (list, rest) = list.split_once(')')?;
    let sectors: Option<Vec<u32>> = list.split_whitespace().map(|s| s.parse().ok()).collect();
    Some((sectors.filter(|s| !s.is_empty())?, rest.trim_start()))
}
