//! Triangles that hide from their fronts only, in each method, against segments that are decided triangle by triangle.

use proptest::prelude::*;
use sightlines::from_region::ViewShafts;
use sightlines::geometry::{Aabb, orient3d};
use sightlines::multifocal::mesh::{Mesh, PatchOptions, SheetMethod, Sheets, patches_of};
use sightlines::multifocal::{FromRegion, Layout, Measure, Multifocal, OccluderSelection, Volume};
use sightlines::multifocal_cpu::Fast;
use sightlines_testkit::draw;
use sightlines_testkit::fronts::{Mixed, corner, lattice, mixed, turn};
use sightlines_testkit::meshes::{Soup, boxes, bumpy, uneven};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The end of the scene and of all boxes.
const AROUND: Aabb<3> = Aabb { min: [-4.0; 3], max: [13.0; 3] };

/// Each method for a mesh.
fn methods(mesh: &Mesh) -> Vec<Box<dyn FromRegion>> {
    let patches = || patches_of(mesh, &PatchOptions::default());
    let buffers = |layout: Layout| -> Box<dyn FromRegion> {
        let chosen = Arc::new(OccluderSelection::new(patches(), 60));
        Box::new(Multifocal::new(Fast::new(), chosen, AROUND, layout))
    };
    let layout = Layout { planes: 3, texels: 32, ..Layout::default() };
    vec![
        buffers(layout),
        buffers(Layout { planes: 1, measure: Measure::Euclid, carry: false, ..layout }),
        Box::new(SheetMethod::shared(Arc::new(Sheets::of(mesh.clone())))),
        Box::new(ViewShafts::new(patches()).with_halvings(2)),
    ]
}

/// For each method its name, and which of the pairs it calls hidden.
fn hidden(mesh: &Mesh, pairs: &[[Aabb<3>; 2]]) -> Vec<(String, Vec<usize>)> {
    let of = |mut method: Box<dyn FromRegion>| {
        let mut hides = |[v, e]: &[Aabb<3>; 2]| {
            let volume = Volume::new(*v).expect("a box of small numbers");
            method.umbra(&volume).expect("the CPU does not fail").hides(e)
        };
        let found = (0..pairs.len()).filter(|&i| hides(&pairs[i])).collect();
        (method.name(), found)
    };
    methods(mesh).into_iter().map(of).collect()
}

fn welded(mixed: &Mixed) -> Mesh {
    Mesh::weld_with_fronts(&mixed.both_sides, &mixed.fronts)
}

/// The impostor: all triangles hide from both sides.
fn welded_as_both(mixed: &Mixed) -> Mesh {
    Mesh::weld(&[&mixed.both_sides[..], &mixed.fronts].concat())
}

/// A pair that is called hidden by a method, and a segment that joins it.
fn refuted(mixed: &Mixed, pairs: &[[Aabb<3>; 2]], seed: u64) -> Option<String> {
    let mut free = vec![None; pairs.len()];
    hidden(&welded(mixed), pairs).into_iter().find_map(|(name, found)| {
        found.into_iter().find_map(|i| {
            let [v, e] = &pairs[i];
            let segment = free[i].get_or_insert_with(|| mixed.free_segment(v, e, seed, 200));
            segment.map(|segment| format!("{name} hides {e:?} from {v:?}: {segment:?}"))
        })
    })
}

proptest! {
    /// Invariant: no segment that passes triangles with one side from behind only joins what a method calls hidden.
    #[test]
    fn no_method_hides_what_is_seen_past_backs(
        mixed in mixed(), pairs in prop::collection::vec(boxes(), 8), seed in any::<u64>(),
    ) {
        let wrong = refuted(&mixed, &pairs, seed);
        prop_assert!(wrong.is_none(), "{wrong:?}");
    }

    /// Invariant: the same where many faces meet.
    #[test]
    fn no_method_hides_what_is_seen_past_backs_of_a_lattice(
        mixed in lattice(), pairs in prop::collection::vec((corner(), corner()), 8), seed in any::<u64>(),
    ) {
        let unit = |p: [f64; 3]| Aabb { min: p, max: p.map(|x| x + 0.8) };
        let pairs: Vec<[Aabb<3>; 2]> = pairs.into_iter().map(|(v, e)| [unit(v), unit(e)]).collect();
        let wrong = refuted(&mixed, &pairs, seed);
        prop_assert!(wrong.is_none(), "{wrong:?}");
    }

    /// Invariant: two triangles at one place with opposite fronts hide as one that hides from both sides.
    #[test]
    fn opposite_fronts_hide_from_both_sides(mixed in mixed(), pairs in prop::collection::vec(boxes(), 6)) {
        let all = [&mixed.both_sides[..], &mixed.fronts].concat();
        let twice: Soup = all.iter().copied().chain(all.iter().copied().map(turn)).collect();
        prop_assert_eq!(hidden(&Mesh::weld_with_fronts(&[], &twice), &pairs), hidden(&Mesh::weld(&all), &pairs));
    }

    /// The tightness twin: walls hide as much from volumes in front of all their triangles as walls that hide from both sides, and nothing
    /// from volumes behind all of them.
    #[test]
    fn walls_hide_from_their_front_as_from_both_sides(wall in wall(), pairs in prop::collection::vec(boxes(), 12)) {
        let behind: Soup = wall.iter().copied().map(turn).collect();
        let [wall, behind] = [wall, behind].map(|fronts| Mixed { both_sides: Vec::new(), fronts });
        let pairs = before(&wall, &pairs);
        prop_assert_eq!(hidden(&welded(&wall), &pairs), hidden(&welded_as_both(&wall), &pairs));
        prop_assert!(hidden(&welded(&behind), &pairs).iter().all(|(_, found)| found.is_empty()));
    }
}

/// A wall across x, all of whose triangles have their fronts towards lower x.
fn wall() -> impl Strategy<Value = Soup> {
    let bumps = (2i32..11, prop::collection::vec(any::<u8>(), 7)).prop_map(|(n, b)| bumpy(n, &b));
    let flat = prop::collection::vec(any::<u8>(), 0..12).prop_map(|cuts| uneven(&cuts));
    prop_oneof![bumps, flat].prop_map(|wall| {
        let is_in_front = |&[a, b, c]: &[[f64; 3]; 3]| orient3d(a, b, c, [-1e6, 0.0, 0.0]) > 0.0;
        wall.into_iter().map(|t| if is_in_front(&t) { t } else { turn(t) }).collect()
    })
}

/// The pairs whose volume is in front of all triangles with one side.
fn before(wall: &Mixed, pairs: &[[Aabb<3>; 2]]) -> Vec<[Aabb<3>; 2]> {
    let is_in_front = |v: &Aabb<3>| {
        let mut sides = wall.fronts.iter().flat_map(|&[a, b, c]| v.corners().map(|eye| orient3d(a, b, c, eye)));
        sides.all(|side| side > 0.0)
    };
    pairs.iter().copied().filter(|[v, _]| is_in_front(v)).collect()
}

/// Each of the properties above looked at something: every method hides some pairs, in soups, lattices and behind walls; and the impostor is caught
/// in every method.
#[test]
fn all_methods_hide_from_fronts_and_impostors_are_caught() {
    let mut counts: BTreeMap<String, [usize; 4]> = BTreeMap::new();
    let mut count = |found: &[(String, Vec<usize>)], of: usize, counted: &dyn Fn(usize) -> bool| {
        for (name, found) in found {
            counts.entry(name.clone()).or_default()[of] += found.iter().filter(|&&i| counted(i)).count();
        }
    };
    for (seed, (mixed, pairs)) in (0..).zip(draw(&(mixed(), prop::collection::vec(boxes(), 12)), 200)) {
        let both_sides = Mesh::weld(&mixed.both_sides);
        let [none, some, all] =
            [&both_sides, &welded(&mixed), &welded_as_both(&mixed)].map(|mesh| hidden(mesh, &pairs));
        count(&none, 0, &|_| true);
        count(&some, 1, &|_| true);
        count(&all, 2, &|i| mixed.free_segment(&pairs[i][0], &pairs[i][1], seed, 200).is_some());
    }
    for (wall, pairs) in draw(&(wall(), prop::collection::vec(boxes(), 12)), 100) {
        let wall = Mixed { both_sides: Vec::new(), fronts: wall };
        count(&hidden(&welded(&wall), &before(&wall, &pairs)), 3, &|_| true);
    }
    eprintln!("{counts:?}");
    assert_eq!(counts.len(), 4);
    for (name, [n_without, n_with, n_wrong, n_behind_walls]) in counts {
        assert!(n_with > n_without * 3 / 2 && n_wrong > 20 && n_behind_walls > 50, "{name}");
    }
}
