//! Results of units of work as bytes.

use crate::simplified::{Counts, Simplified};
use sightlines_cells::{Scene, SceneObject};
use sightlines_progress::{Kept, kept_struct};

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

kept_struct!(Counts { before, without_area, hidden, deleted, collapsed, new, merged_away, merged, left });
kept_struct!(Simplified { counts, bound, deviation, shift, triangles, origin, hidden });

/// What is left of `scene`; `None` if it cannot be of that.
pub(crate) fn read_simplified(bytes: &[u8], scene: &Scene) -> Option<Simplified> {
    let of = Simplified::from_bytes(bytes)?;
    let objects = scene.objects();
    let n = [of.triangles.len(), of.origin.len(), of.hidden.len()];
    let fits = |(k, object): (usize, &SceneObject)| {
        let is_corner = |corner: &u32| (*corner as usize) < object.vertices.len();
        let is_one = |triangle: &u32| (*triangle as usize) < object.triangles.len();
        of.origin[k].len() == of.triangles[k].len()
            && of.triangles[k].iter().flatten().all(is_corner)
            && of.origin[k].iter().flatten().chain(&of.hidden[k]).all(is_one)
            && of.hidden[k].is_sorted_by(|a, b| a < b)
    };
    let is_it = n == [objects.len(); 3]
        && objects.iter().enumerate().all(fits)
        && of.counts.left == of.triangles.iter().map(Vec::len).sum::<usize>();
    is_it.then_some(of)
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let bytes = made.to_bytes();
        assert_eq!(read_simplified(&bytes, &scene), Some(made.clone()));
        assert_eq!(read_simplified(&bytes, &Scene::new(vec![object(3)]).unwrap()), None);
        assert_eq!(read_simplified(&bytes, &Scene::new(vec![object(2), object(1)]).unwrap()), None);
        for n in 0..bytes.len() {
            assert_eq!(read_simplified(&bytes[..n], &scene), None, "{n}");
        }
        let with = |change: fn(&mut Simplified)| {
            let mut made = made.clone();
            change(&mut made);
            read_simplified(&made.to_bytes(), &scene)
        };
        assert_eq!(with(|of| of.triangles[0][1] = [1, 2, 4]), None, "a corner");
        assert_eq!(with(|of| of.origin[0][0] = Some(3)), None, "an origin");
        assert_eq!(with(|of| of.hidden[0] = vec![1, 0]), None, "an order");
        assert_eq!(with(|of| of.hidden[1] = vec![1]), None, "a hidden triangle");
        assert_eq!(with(|of| of.origin[1] = vec![None]), None, "an origin of none");
        assert_eq!(with(|of| of.counts.left = 3), None, "a count");
        // Behind counts, measures and the number of objects: how many triangles there are.
        let mut changed = bytes.clone();
        changed[34] = 0xff;
        assert_eq!((bytes[33], bytes[34], read_simplified(&changed, &scene)), (2, 2, None));
        let flags: Vec<bool> = (0..19).map(|k| k % 3 == 0).collect();
        let mut out = Vec::new();
        write_flags(&flags, &mut out);
        let mut rest = &out[..];
        assert_eq!((read_flags(&mut rest, 19), rest.len()), (Some(flags), 0));
        assert_eq!(read_flags(&mut &out[..2], 19), None);
    }
}
