//! Handles, lists and inputs that several tests use.

use sightlines_capi::*;
use sightlines_cells::{Plan, Scene};
use sightlines_pvs::{CellId, ObjectId};
use sightlines_scenes as scenes;
use std::ptr;

/// Chance.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb)
    }

    /// From 0 to 1.
    pub(crate) fn share(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.share()
    }
}

/// An owned handle of a table.
pub(crate) struct Handle(pub(crate) *mut SlTable);

impl Handle {
    pub(crate) fn of(bytes: &[u8]) -> Self {
        let mut handle = ptr::null_mut();
        // SAFETY: bytes and a place that live.
        assert_eq!(unsafe { sl_table_from_bytes(bytes.as_ptr(), bytes.len(), &mut handle) }, SL_OK);
        Self(handle)
    }
}

impl Drop for Handle {
    fn drop(&mut self) {
        // SAFETY: it is owned.
        unsafe { sl_table_free(self.0) };
    }
}

/// What a function of the border lists: the size first, then the items.
pub(crate) fn list<T: Clone + Default>(call: impl Fn(*mut T, usize, &mut usize) -> SlStatus) -> Vec<T> {
    let mut n = 0;
    assert_eq!(call(ptr::null_mut(), 0, &mut n), SL_OK);
    let mut items = vec![T::default(); n];
    assert_eq!(call(items.as_mut_ptr(), n, &mut n), SL_OK);
    assert_eq!(n, items.len());
    if n > 1 {
        assert_eq!(call(items.as_mut_ptr(), n - 1, &mut n), SL_ERROR_BUFFER);
    }
    items
}

pub(crate) fn text(call: impl Fn(*mut i8, usize, &mut usize) -> SlStatus) -> String {
    let mut n = 0;
    assert_eq!(call(ptr::null_mut(), 0, &mut n), SL_OK);
    let mut bytes = vec![1i8; n + 1];
    assert_eq!(call(bytes.as_mut_ptr(), n + 1, &mut n), SL_OK);
    assert_eq!(bytes.pop(), Some(0));
    String::from_utf8(bytes.into_iter().map(|b| b as u8).collect()).expect("UTF-8")
}

pub(crate) fn cell_ids(cells: impl IntoIterator<Item = CellId>) -> Vec<u32> {
    cells.into_iter().map(|cell| cell.0).collect()
}

pub(crate) fn object_ids(objects: impl IntoIterator<Item = ObjectId>) -> Vec<u32> {
    objects.into_iter().map(|object| object.0).collect()
}

/// Small plans, one of them with mirrors.
pub(crate) fn plans() -> Vec<Plan> {
    let mirrored = Plan::from_walls(
        [[0., 0., 8., 0.], [8., 0., 8., 4.], [8., 4., 0., 4.], [0., 4., 0., 0.], [4., 0., 4., 1.], [4., 2., 4., 4.]]
            .map(|[a, b, c, d]| (sightlines_geometry::Point2::new(a, b), sightlines_geometry::Point2::new(c, d))),
    )
    .expect("a plan")
    .with_mirrors(vec![sightlines_cells::LineId(0), sightlines_cells::LineId(2)])
    .expect("walls");
    let mut plans = vec![mirrored];
    plans.extend(scenes::maze(1, 4, 3));
    plans.extend(scenes::doom_like(1, 1));
    plans
}

/// Small towers.
pub(crate) fn towers() -> Vec<Scene> {
    let small = scenes::TowerOptions { floors: 1, rooms_x: 2, rooms_y: 1, furniture: 2, ..Default::default() };
    [small, scenes::TowerOptions { floors: 2, rooms_y: 2, ..small }]
        .map(|o| scenes::tower(o).expect("a tower"))
        .to_vec()
}
