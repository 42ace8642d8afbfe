//! Tables by line space.

use crate::limit::building;
use sightlines_bake::methods::OcclusionMethod;
use sightlines_bake::{BakeRequest, CellsFrom, Runtime, SceneMethod};

/// What a search remembers ends with its view cell, so it does not matter which thread has which cells.
#[test]
fn threads_change_nothing() {
    let scene = building(true);
    let bytes = |threads: usize| {
        let method = Some(SceneMethod::FromRegion(OcclusionMethod::LineSpace));
        let request = BakeRequest { cells: Some(CellsFrom::Grid([3, 2, 1])), method, ..BakeRequest::default() };
        let table = Runtime { threads, ..Runtime::default() }.bake(&scene, &request).expect("a table").table;
        let seen = table.parts().objects_seen.as_ref().expect("objects are seen");
        let hidden = (seen.n_rows() * seen.n_cols()) as u64 - seen.count_ones();
        (table.to_bytes(), hidden)
    };
    let (one, hidden) = bytes(1);
    assert!(hidden > 0, "nothing is hidden: the comparison says nothing");
    assert!((2..5).all(|threads| bytes(threads).0 == one));
}
