//! Generated scenes whose truth is known by construction: exactly what is hidden goes, and what is kept has a segment that is free by the exact predicates of
//! `testkit`.

use sightlines_cells::Scene;
use sightlines_scenes::{Enclosed, GearboxOptions, Pipe, cupboard, gearbox, nested_voids};
use sightlines_strip::{Eyes, Fate, Grain, HiddenReason, StripOptions, Stripped, strip};
use sightlines_testkit::fronts::Mixed;

/// As if single-sided materials were drawn by any engine: what is not closed outwards hides from its front only.
pub(crate) fn one_sided(scene: &Scene) -> Scene {
    let all = (0..scene.objects().len() as u32).collect();
    let scene = scene.clone().with_backs_culled(all).expect("all are objects");
    // Both sides may be drawn.
    scene.with_single_sided(Vec::new()).expect("none is an object")
}

pub(crate) fn hidden(stripped: &Stripped) -> Vec<u32> {
    (0u32..).zip(&stripped.objects).filter(|(_, of)| of.fate.is_hidden()).map(|(k, _)| k).collect()
}

/// Every object has a fate that is proven: hidden, or seen along a segment that meets nothing but the object.
fn check(of: &Enclosed, scene: &Scene, options: &StripOptions) {
    let stripped = strip(scene, &Eyes::outside(), options, None).expect("no mirrors, no gap");
    let name = |k: &u32| scene.objects()[*k as usize].name.as_str();
    let (found, truth) = (hidden(&stripped), &of.hidden);
    let wrong: Vec<_> = found.iter().filter(|k| !truth.contains(k)).map(name).collect();
    let missed: Vec<_> = truth.iter().filter(|k| !found.contains(k)).map(name).collect();
    assert!(wrong.is_empty(), "hidden though seen: {wrong:?}");
    assert!(missed.is_empty(), "not found hidden: {missed:?}");
    let mut n_seen = 0;
    for (k, object) in (0u32..).zip(&stripped.objects) {
        let Fate::Seen([eye, end]) = object.fate else { continue };
        assert!(!scene.bounds().contains(eye), "{}: the eye is not outside", name(&k));
        let others = |all: &mut dyn Iterator<Item = (u32, &sightlines_cells::SceneObject)>| {
            all.filter(|(other, _)| *other != k).flat_map(|(_, object)| object.corners().collect::<Vec<_>>()).collect()
        };
        let walls = Mixed { both_sides: others(&mut scene.occluders()), fronts: others(&mut scene.fronts()) };
        assert!(walls.is_free([eye, end]), "{}: the segment is not free", name(&k));
        n_seen += 1;
    }
    assert_eq!(n_seen + truth.len(), scene.objects().len(), "undecided: {:?}", stripped.count_objects());
}

fn all() -> Vec<Enclosed> {
    let mut all: Vec<Enclosed> = [Pipe::None, Pipe::FromOuterVoid, Pipe::FromOutside].map(nested_voids).into();
    all.push(gearbox(GearboxOptions { gears: 4, seed: 3 }).expect("some gears"));
    all
}

#[test]
fn what_is_hidden_by_construction_goes_and_nothing_else() {
    for of in all() {
        check(&of, &of.scene, &StripOptions::default());
        check(&of, &one_sided(&of.scene), &StripOptions::default());
    }
}

/// A keyhole of a 64th of a unit shows the cup, and only from straight before it. The shelf touches all boards, so that no way leads to the plate below. To the shelf itself one
/// does through a keyhole: no line is found then, and no proof that there is none.
#[test]
fn a_narrow_keyhole_shows_what_is_behind_it() {
    for hole in [0, 1, 8, 48] {
        let of = cupboard(hole).expect("no wider than 64");
        let found = strip(&of.scene, &Eyes::outside(), &StripOptions::default(), None).expect("no mirrors");
        let fate = |name: &str| {
            let k = of.scene.objects().iter().position(|object| object.name == name).expect("it is there");
            found.objects[k].fate
        };
        assert_eq!(fate("Plate"), Fate::Hidden(HiddenReason::Enclosed), "{hole}");
        assert_eq!(matches!(fate("Cup"), Fate::Seen(_)), hole > 0, "{hole}");
        assert_eq!(fate("Cup").is_hidden(), hole == 0, "{hole}");
        assert!(
            fate("Shelf").is_hidden() == (hole == 0) && (hole < 48 || matches!(fate("Shelf"), Fate::Seen(_))),
            "{hole}"
        );
        let truth = &of.hidden;
        assert!(hidden(&found).iter().all(|k| truth.contains(k)));
    }
}

/// The same answer with any number of threads; triangles one by one hide at least what objects do.
#[test]
fn answers_do_not_depend_on_threads_and_triangles_are_parts_of_objects() {
    for of in all() {
        let with = |grain, threads| {
            let options = StripOptions { grain, threads, ..StripOptions::default() };
            strip(&of.scene, &Eyes::outside(), &options, None).expect("no mirrors")
        };
        let objects = with(Grain::Objects, 1);
        assert_eq!(objects, with(Grain::Objects, 3));
        let triangles = with(Grain::Triangles, 2);
        assert_eq!(triangles, with(Grain::Triangles, 1));
        let counts = [&objects, &triangles].map(|of_grain| of_grain.count_triangles(&of.scene));
        assert!(counts[1].n_hidden() > counts[0].n_hidden(), "{counts:?}");
        assert!(hidden(&triangles).iter().all(|k| of.hidden.contains(k)));
        let rest = triangles.rest_of(&of.scene).expect("the same scene");
        assert_eq!(rest.n_triangles(), counts[1].all - counts[1].n_hidden());
    }
}
