//! Which faces share edges.

use crate::faces::Faces;
use sightlines_geometry::Point3;
use std::collections::HashMap;

/// For each edge of each face the faces that have the same edge: the same two corners, number by number. The same for all eyes.
#[derive(Debug, Clone, Default)]
pub struct Neighbours {
    /// For each face and edge where its group begins. Edge k goes from corner k to the next.
    group: Vec<[u32; 3]>,
    /// Groups one after the other.
    shared: Vec<Shared>,
}

/// A face at an edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Shared {
    pub(super) face: u32,
    /// Whether the face goes along it from the lower corner to the higher, in some order of corners.
    pub(super) along: bool,
    /// Whether it is the last of its group.
    last: bool,
}

impl Neighbours {
    /// Of all faces that have an area. O(n log n).
    pub fn of(faces: &Faces) -> Self {
        // Corners by their bits; negative zeros are none.
        let mut known: HashMap<[u64; 3], u32> = HashMap::with_capacity(faces.len());
        let mut number = |p: &Point3| {
            let n = known.len() as u32;
            *known.entry(p.map(f64::to_bits)).or_insert(n)
        };
        let mut edges = Vec::with_capacity(3 * faces.len());
        for face in faces.ids() {
            let ids = faces.of(face).each_ref().map(&mut number);
            if faces.has_area(face) {
                edges.extend((0..3u8).map(|k| {
                    let (p, q) = (ids[usize::from(k)], ids[(usize::from(k) + 1) % 3]);
                    (p.min(q), p.max(q), face, k, p < q)
                }));
            }
        }
        edges.sort_unstable();
        let mut group = vec![[u32::MAX; 3]; faces.len()];
        let mut shared = Vec::with_capacity(edges.len());
        let mut start = 0;
        for (i, &(p, q, face, k, along)) in edges.iter().enumerate() {
            let last = edges.get(i + 1).is_none_or(|next| (next.0, next.1) != (p, q));
            group[face as usize][usize::from(k)] = start;
            shared.push(Shared { face, along, last });
            if last {
                start = i as u32 + 1;
            }
        }
        Self { group, shared }
    }

    /// The faces at an edge of a face, itself included; none of a face without an area, or one that it does not know.
    pub(super) fn at(&self, face: u32, edge: usize) -> &[Shared] {
        let Some(groups) = self.group.get(face as usize) else { return &[] };
        let from = self.shared.get(groups[edge] as usize..).unwrap_or(&[]);
        let n = from.iter().position(|s| s.last).map_or(0, |last| last + 1);
        &from[..n]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_are_found_whichever_way_they_go() {
        let [a, b, c, d] = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
        let line = [a, b, [2., 0., 0.]];
        let faces = Faces::new(vec![[a, b, c], [b, a, d], [a, b, d], line, [c, d, [5., 5., 5.]]]).unwrap();
        let neighbours = Neighbours::of(&faces);
        let at = |face, edge| neighbours.at(face, edge).iter().map(|s| (s.face, s.along)).collect::<Vec<_>>();
        assert_eq!(at(0, 0), [(0, true), (1, false), (2, true)]);
        assert_eq!(at(1, 0), at(0, 0));
        assert_eq!(at(0, 1), [(0, true)]);
        assert_eq!(at(4, 0), [(4, true)]);
        // What has no area has no edges, and what is not there neither.
        assert_eq!(at(3, 0), []);
        assert_eq!(at(9, 2), []);
    }
}
