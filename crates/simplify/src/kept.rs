//! Results of units of work as bytes. Numbers are little-endian.

use crate::simplified::{Counts, Simplified};
use sightlines_cells::Scene;

/// Appends flags, eight in a byte.
pub(crate) fn write_flags(flags: &[bool], out: &mut Vec<u8>) {
    out.extend(flags.chunks(8).map(|of| of.iter().rev().fold(0_u8, |byte, flag| byte << 1 | u8::from(*flag))));
}

/// Takes `n` flags from the front of `bytes`.
pub(crate) fn read_flags(bytes: &mut &[u8], n: usize) -> Option<Vec<bool>> {
    let (of, rest) = bytes.split_at_checked(n.div_ceil(8))?;
    *bytes = rest;
    Some((0..n).map(|k| of[k / 8] >> (k % 8) & 1 == 1).collect())
}

/// Takes an array from the front of `bytes`.
fn take<const N: usize>(bytes: &mut &[u8]) -> Option<[u8; N]> {
    let (array, rest) = bytes.split_first_chunk()?;
    *bytes = rest;
    Some(*array)
}

fn take_number(bytes: &mut &[u8]) -> Option<u32> {
    take(bytes).map(u32::from_le_bytes)
}

/// Takes a length whose entries take `size` bytes each, if there are as many.
fn take_length(bytes: &mut &[u8], size: usize) -> Option<usize> {
    take_number(bytes).map(|n| n as usize).filter(|n| *n <= bytes.len() / size)
}

/// In place of the origin of a triangle that is new.
const NEW: u32 = u32::MAX;

/// What is left of a scene.
pub(crate) fn write_simplified(of: &Simplified) -> Vec<u8> {
    let Simplified { triangles, origin, hidden, bound, deviation, shift, counts } = of;
    let Counts { before, without_area, hidden: n_hidden, deleted, collapsed, new, merged_away, merged, left } = *counts;
    let mut out = Vec::new();
    for n in [before, without_area, n_hidden, deleted, collapsed, new, merged_away, merged, left] {
        out.extend((n as u64).to_le_bytes());
    }
    [bound, deviation, shift].iter().for_each(|x| out.extend(x.to_le_bytes()));
    for ((triangles, origin), hidden) in triangles.iter().zip(origin).zip(hidden) {
        out.extend((triangles.len() as u32).to_le_bytes());
        triangles.iter().flatten().for_each(|corner| out.extend(corner.to_le_bytes()));
        origin.iter().for_each(|of| out.extend(of.unwrap_or(NEW).to_le_bytes()));
        out.extend((hidden.len() as u32).to_le_bytes());
        hidden.iter().for_each(|triangle| out.extend(triangle.to_le_bytes()));
    }
    out
}

/// What is left of `scene`; `None` if it cannot be of that.
pub(crate) fn read_simplified(mut bytes: &[u8], scene: &Scene) -> Option<Simplified> {
    let bytes = &mut bytes;
    let mut count = || take(bytes).and_then(|n| usize::try_from(u64::from_le_bytes(n)).ok());
    let counts = Counts {
        before: count()?,
        without_area: count()?,
        hidden: count()?,
        deleted: count()?,
        collapsed: count()?,
        new: count()?,
        merged_away: count()?,
        merged: count()?,
        left: count()?,
    };
    let [bound, deviation, shift] = [take(bytes)?, take(bytes)?, take(bytes)?].map(f64::from_le_bytes);
    let (mut triangles, mut origin, mut hidden) = (Vec::new(), Vec::new(), Vec::new());
    for object in scene.objects() {
        let [n_vertices, n_triangles] = [object.vertices.len(), object.triangles.len()].map(|n| n as u64);
        let n = take_length(bytes, 16)?;
        let corner = |bytes: &mut &[u8]| take_number(bytes).filter(|corner| u64::from(*corner) < n_vertices);
        let triangle = |bytes: &mut &[u8]| Some([corner(bytes)?, corner(bytes)?, corner(bytes)?]);
        triangles.push((0..n).map(|_| triangle(bytes)).collect::<Option<Vec<[u32; 3]>>>()?);
        let is_one = |triangle: &u32| u64::from(*triangle) < n_triangles;
        let of = |bytes: &mut &[u8]| match take_number(bytes)? {
            NEW => Some(None),
            of => Some(Some(of)).filter(|_| is_one(&of)),
        };
        origin.push((0..n).map(|_| of(bytes)).collect::<Option<Vec<Option<u32>>>>()?);
        let n = take_length(bytes, 4)?;
        let of_object: Vec<u32> = (0..n).map(|_| take_number(bytes).filter(is_one)).collect::<Option<_>>()?;
        if !of_object.is_sorted_by(|a, b| a < b) {
            return None;
        }
        hidden.push(of_object);
    }
    let is_it = bytes.is_empty() && counts.left == triangles.iter().map(Vec::len).sum::<usize>();
    is_it.then_some(Simplified { triangles, origin, hidden, bound, deviation, shift, counts })
}

#[cfg(test)]
mod tests {
    use super::*;
    use sightlines_cells::SceneObject;

    #[test]
    fn results_come_back_and_others_are_refused() {
        let at = |x: f64| [x, 0.0, 1.0];
        let object = |n: u32| SceneObject {
            name: String::new(),
            vertices: vec![at(0.0), at(1.0), [0.0, 1.0, 0.0], at(2.0)],
            triangles: (0..n).map(|_| [0, 1, 2]).collect(),
        };
        let scene = Scene::new(vec![object(3), object(1)]).unwrap();
        let made = Simplified {
            triangles: vec![vec![[0, 1, 2], [1, 2, 3]], vec![]],
            origin: vec![vec![Some(2), None], vec![]],
            hidden: vec![vec![0, 1], vec![0]],
            bound: 0.25,
            deviation: f64::INFINITY,
            shift: 0.0,
            counts: Counts { before: 4, hidden: 3, new: 1, left: 2, ..Counts::default() },
        };
        let bytes = write_simplified(&made);
        assert_eq!(read_simplified(&bytes, &scene), Some(made));
        assert_eq!(read_simplified(&bytes, &Scene::new(vec![object(3)]).unwrap()), None);
        assert_eq!(read_simplified(&bytes, &Scene::new(vec![object(2), object(1)]).unwrap()), None);
        for n in 0..bytes.len() {
            assert_eq!(read_simplified(&bytes[..n], &scene), None, "{n}");
        }
        // Behind counts and measures: a length, a corner, an origin.
        for (at, to) in [(96, 0xff), (100, 4), (127, 1), (128, 3), (136, 3)] {
            let mut changed = bytes.clone();
            changed[at] = to;
            assert_eq!(read_simplified(&changed, &scene), None, "{at}");
        }
        let flags: Vec<bool> = (0..19).map(|k| k % 3 == 0).collect();
        let mut out = Vec::new();
        write_flags(&flags, &mut out);
        let mut rest = &out[..];
        assert_eq!((read_flags(&mut rest, 19), rest.len()), (Some(flags), 0));
        assert_eq!(read_flags(&mut &out[..2], 19), None);
    }
}
