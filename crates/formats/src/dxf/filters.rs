//! Clipped inserts (XCLIP): which insert has which clip.
//!
//! The entry `ACAD_FILTER` of an insert's extension dictionary is a dictionary whose entry `SPATIAL` is the clip: a polygon, or two corners of
//! a box. One that is inverted is stored as a polygon too, that of the rest, with a slit to its border. Beside it, in a record that the entry
//! `ACAD_XREC_ROUNDTRIP` of the clip's own extension dictionary leads to, are the polygon that was inverted, and the one of the rest. Some programs store the
//! polygon that was inverted in both places: then all but what is inside is drawn. What is neither is not understood.

use super::affine::Affine;
use super::entity::Fields;
use super::groups::{Group, Groups, extension, handle, next_record};
use crate::error::Malformed;
use std::collections::HashMap;

/// The clips of a drawing, and the dictionaries that lead to them, by handle.
#[derive(Debug, Default)]
pub(super) struct Filters {
    dictionaries: HashMap<u64, Vec<NamedHandle>>,
    clips: HashMap<u64, Stored>,
    /// By record: the polygon that was inverted, and that of the rest.
    inverted: HashMap<u64, [Vec<[f64; 2]>; 2]>,
}

/// A clip as its object has it.
#[derive(Debug)]
struct Stored {
    clip: Clip,
    corners: Vec<[f64; 2]>,
    extension: Option<u64>,
}

type NamedHandle = (Vec<u8>, Option<u64>);

/// What is drawn of a block.
#[derive(Debug, Clone)]
pub(super) enum Clip {
    /// All of it.
    Off,
    /// What is inside of a polygon in the coordinates of the block's entities, or all the rest.
    Polygon { corners: Vec<[f64; 3]>, is_hole: bool },
    /// Some of it.
    NotUnderstood,
}

impl Filters {
    pub(super) fn read(groups: &mut Groups<'_>) -> Result<Self, Malformed> {
        let (mut found, mut fields) = (Self::default(), Vec::new());
        loop {
            let record = next_record(groups, &mut fields)?;
            if record.is(0, "ENDSEC") {
                return Ok(found);
            }
            let Some(own) = fields.iter().find(|group| group.code == 5).and_then(handle) else { continue };
            if record.is(0, "DICTIONARY") {
                let entries = fields.windows(2).filter(|pair| pair[0].code == 3);
                let entries = entries.map(|pair| (pair[0].value.to_vec(), handle(&pair[1])));
                found.dictionaries.insert(own, entries.collect());
            } else if record.is(0, "SPATIAL_FILTER") {
                let fields = Fields { kind: "SPATIAL_FILTER", line: record.line, groups: &fields };
                let clip = read_clip(&fields).ok().flatten().unwrap_or(Clip::NotUnderstood);
                let corners = corners(fields.groups).unwrap_or_default();
                found.clips.insert(own, Stored { clip, corners, extension: extension(fields.groups) });
            } else if record.is(0, "XRECORD") {
                let part = |name| {
                    let begin = fields.iter().position(|group| group.is(102, name))? + 1;
                    let n = fields[begin..].iter().position(|group| group.code == 102).unwrap_or(fields.len() - begin);
                    corners(&fields[begin..begin + n]).ok()
                };
                if let Some(inverted) = part("ACAD_INVERTEDCLIP_ROUNDTRIP") {
                    let rest = part("ACAD_INVERTEDCLIP_ROUNDTRIP_COMPARE").unwrap_or_default();
                    found.inverted.insert(own, [inverted, rest]);
                }
            }
        }
    }

    /// The clip to which an extension dictionary leads. One that is not in the file may lead to anything, and mostly leads to no clip.
    pub(super) fn of(&self, extension: Option<u64>) -> Clip {
        let Some(extension) = extension.and_then(|handle| self.dictionaries.get(&handle)) else { return Clip::Off };
        let Some(filters) = entry(extension, b"ACAD_FILTER") else { return Clip::Off };
        let Some(filters) = filters.and_then(|handle| self.dictionaries.get(&handle)) else {
            return Clip::NotUnderstood;
        };
        let Some(spatial) = entry(filters, b"SPATIAL") else { return Clip::Off };
        spatial.and_then(|handle| self.clips.get(&handle)).map_or(Clip::NotUnderstood, |stored| self.inverted(stored))
    }

    fn inverted(&self, stored: &Stored) -> Clip {
        let own = stored.extension.and_then(|handle| self.dictionaries.get(&handle));
        let record = own.and_then(|own| entry(own, b"ACAD_XREC_ROUNDTRIP")).flatten();
        match (record.and_then(|handle| self.inverted.get(&handle)), stored.clip.clone()) {
            (Some([hole, _]), Clip::Polygon { corners, .. }) if *hole == stored.corners => {
                Clip::Polygon { corners, is_hole: true }
            }
            (Some([_, rest]), Clip::Polygon { .. }) if *rest != stored.corners => Clip::NotUnderstood,
            (_, clip) => clip,
        }
    }
}

fn corners(groups: &[Group<'_>]) -> Result<Vec<[f64; 2]>, Malformed> {
    let of =
        |code| groups.iter().filter(move |group| group.code == code).map(Group::number).collect::<Result<Vec<_>, _>>();
    Ok(of(10)?.into_iter().zip(of(20)?).map(<[f64; 2]>::from).collect())
}

fn entry(dictionary: &[NamedHandle], name: &[u8]) -> Option<Option<u64>> {
    dictionary.iter().find(|(key, _)| key == name).map(|&(_, handle)| handle)
}

/// `None` if a part is missing, or if the clip has a depth or a plane of its own.
fn read_clip(fields: &Fields<'_, '_>) -> Result<Option<Clip>, Malformed> {
    if fields.find(71).is_some() && fields.integer(71)? == 0 {
        return Ok(Some(Clip::Off));
    }
    let has_depth = |code: i32| Ok::<_, Malformed>(fields.find(code).is_some() && fields.integer(code)? != 0);
    if has_depth(72)? || has_depth(73)? {
        return Ok(None);
    }
    let [x, y, numbers] = [fields.numbers(10)?, fields.numbers(20)?, fields.numbers(40)?];
    // A distance of the depth may come before the two maps: from the coordinates around the insert to the block's, and to the plane's.
    let maps = numbers.len().checked_sub(24).map(|start| numbers[start..].split_at(12));
    let Some((to_block, to_plane)) = maps else { return Ok(None) };
    let has_own_plane = fields.normal()? != [0.0, 0.0, 1.0] || Affine::of_rows(to_plane) != Affine::IDENTITY;
    if x.len() != y.len() || x.len() < 2 || has_own_plane {
        return Ok(None);
    }
    let corners = match (&x[..], &y[..]) {
        (&[x0, x1], &[y0, y1]) => vec![[x0, y0], [x1, y0], [x1, y1], [x0, y1]],
        _ => x.into_iter().zip(y).map(<[f64; 2]>::from).collect(),
    };
    let to_block = Affine::of_rows(to_block);
    if !to_block.keeps_above() {
        return Ok(None);
    }
    let corners = corners.into_iter().map(|[x, y]| to_block.point([x, y, 0.0])).collect();
    Ok(Some(Clip::Polygon { corners, is_hole: false }))
}
