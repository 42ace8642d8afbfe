//! Which tiles are near each other.

use sightlines_geometry::{Aabb, BoxTree};

/// Where a tile is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TileBounds {
    /// Where eyes can be in it.
    pub viewers: Aabb<3>,
    /// Around all that it shows.
    pub extent: Aabb<3>,
}

/// For each tile those whose extent is at most `border` away from its viewers along each axis, ascending; not itself.
///
/// What is compared is rounded: a tile that is as far away as the border, to within rounding, may be near or not, and nothing is wrong with
/// either. O(n log n) for tiles that have few nearby.
pub fn near_tiles(tiles: &[TileBounds], border: f64) -> Vec<Vec<u32>> {
    let extents: Vec<Aabb<3>> = tiles.iter().map(|tile| tile.extent).collect();
    let tree = BoxTree::build(&extents, 4);
    let near = |(tile, bounds): (u32, &TileBounds)| {
        let meets = |other: &Aabb<3>| is_within(&bounds.viewers, other, border);
        let mut found = Vec::new();
        tree.visit(meets, |other| {
            if other != tile && meets(&extents[other as usize]) {
                found.push(other);
            }
        });
        found.sort_unstable();
        found
    };
    (0..).zip(tiles).map(near).collect()
}

/// Whether a box is at most so far away from another, along each axis.
pub(crate) fn is_within(viewers: &Aabb<3>, other: &Aabb<3>, distance: f64) -> bool {
    (0..3).all(|k| other.min[k] <= viewers.max[k] + distance && viewers.min[k] - distance <= other.max[k])
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn boxes() -> impl Strategy<Value = Vec<TileBounds>> {
        let one = ([0i32..20, 0i32..3, 0i32..20], [1i32..5, 1i32..3, 1i32..5], 0i32..3);
        let one = one.prop_map(|(min, size, more)| {
            let viewers = Aabb { min: min.map(f64::from), max: std::array::from_fn(|k| f64::from(min[k] + size[k])) };
            let extent = Aabb { min: viewers.min.map(|x| x - f64::from(more)), max: viewers.max };
            TileBounds { viewers, extent }
        });
        prop::collection::vec(one, 0..30)
    }

    proptest! {
        #[test]
        fn near_are_those_within_the_border(tiles in boxes(), border in 0i32..6) {
            let border = f64::from(border);
            let found = near_tiles(&tiles, border);
            let away = |a: &Aabb<3>, b: &Aabb<3>| {
                (0..3).map(|k| (b.min[k] - a.max[k]).max(a.min[k] - b.max[k]).max(0.0)).fold(0.0, f64::max)
            };
            for (k, near) in found.iter().enumerate() {
                let expected: Vec<u32> = (0..tiles.len() as u32)
                    .filter(|&o| o as usize != k && away(&tiles[k].viewers, &tiles[o as usize].extent) <= border)
                    .collect();
                prop_assert_eq!(near, &expected);
            }
        }
    }
}
