//! Where space outside every cell is solid, so that nothing there is visible.

use super::locator::CellLocator;
use super::motion::{flat, is_within};
use super::options::MoverOptions;
use sightlines_geometry::Aabb;
use sightlines_pvs::Frame;

/// The boxes within which space outside every cell is solid.
pub(super) struct Solid {
    within: Aabb<3>,
    /// The box along the cells' axes, if these are not those of the scene.
    along: Option<(Frame, Aabb<3>)>,
}

impl Solid {
    /// What options state, or else the box around all cells; none if these may leave gaps.
    pub(super) fn new(options: &MoverOptions, places: &impl CellLocator) -> Self {
        let around = || if places.leaves_gaps() { Aabb::EMPTY } else { places.bounds() };
        let within = flat(options.solid_within.unwrap_or_else(around), places.dimension());
        let along = options.solid_within.is_none().then(|| places.along());
        Self { within, along: along.and_then(|(frame, within)| Some((frame?, within))) }
    }

    /// The box of the scene.
    pub(super) fn within(&self) -> Aabb<3> {
        self.within
    }

    /// Whether space outside every cell is solid all around a box.
    pub(super) fn encloses(&self, bounds: &Aabb<3>) -> bool {
        let along = self.along.as_ref().is_none_or(|(frame, within)| {
            let (min, max) = frame.around(bounds.min, bounds.max);
            is_within(&Aabb { min, max }, within)
        });
        along && is_within(bounds, &self.within)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::movers::Movers;
    use sightlines_pvs::CellId;

    /// One cell of 8 by 8 by 8 along these axes, and whether it leaves gaps.
    struct One(Option<Frame>, bool);

    impl CellLocator for One {
        fn dimension(&self) -> u8 {
            3
        }

        fn n_cells(&self) -> usize {
            1
        }

        fn leaves_gaps(&self) -> bool {
            self.1
        }

        fn bounds(&self) -> Aabb<3> {
            let (_, along) = self.along();
            self.0.map_or(along, |frame| {
                let (min, max) = frame.around_in_scene(along.min, along.max);
                Aabb { min, max }
            })
        }

        fn along(&self) -> (Option<Frame>, Aabb<3>) {
            (self.0, Aabb { min: [-4.0; 3], max: [4.0; 3] })
        }

        fn touching(&self, _: &Aabb<3>, _: &mut Vec<u32>, _: &mut dyn FnMut(CellId) -> bool) {}
    }

    /// The corners of the box around a turned box are beyond it: what moves there is in no wall.
    #[test]
    fn beside_a_turned_building_nothing_is_solid() {
        let r = 0.5f64.sqrt();
        let frame = Frame::new([[r, r, 0.0], [-r, r, 0.0], [0.0, 0.0, 1.0]], 1e-6).expect("a frame");
        let encloses = |frame, at: Point3, options: MoverOptions| {
            Solid::new(&options, &One(frame, false)).encloses(&Aabb { min: at, max: at.map(|x| x + 0.1) })
        };
        type Point3 = [f64; 3];
        let (corner, middle) = ([5.0, 5.0, 0.0], [0.0; 3]);
        let plain = MoverOptions::default;
        assert!(encloses(Some(frame), middle, plain()) && !encloses(Some(frame), corner, plain()));
        assert!(!encloses(None, corner, plain()), "without a frame that is beyond, too");
        let stated = MoverOptions { solid_within: Some(Aabb { min: [-9.0; 3], max: [9.0; 3] }), ..plain() };
        let gaps = |options| Solid::new(&options, &One(None, true)).encloses(&Aabb { min: middle, max: [0.1; 3] });
        assert!(gaps(stated) && !gaps(plain()), "what moves between cells that leave gaps may be in air");
        assert!(encloses(Some(frame), corner, stated), "who says where space is solid is believed");
    }
    /// Movers that come into a table whose cells leave gaps are in air there, as if they had been in it from the beginning.
    #[test]
    fn a_table_that_takes_the_place_of_another_has_its_own_gaps() {
        let bounds = |leaves_gaps: [bool; 2]| {
            let mut movers = Movers::new(One(None, leaves_gaps[0]), MoverOptions::default());
            movers.replace(One(None, leaves_gaps[1]));
            movers.bounds()
        };
        assert!(bounds([false, true]).is_empty() && bounds([true, true]).is_empty());
        let whole = Aabb { min: [-4.0; 3], max: [4.0; 3] };
        assert_eq!([bounds([true, false]), bounds([false, false])], [whole; 2]);
    }
}
