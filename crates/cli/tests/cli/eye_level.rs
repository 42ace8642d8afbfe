//! `build --eye-height`: cells above floors, and shadows that are propagated from cell to cell.

use crate::common::Folder;

#[test]
fn cells_at_the_height_of_eyes_hide_the_other_rooms_and_nothing_that_rays_reach() {
    let folder = Folder::new();
    let tower = ["generate", "tower", "--floors", "1", "--rooms-x", "2", "--rooms-y", "2", "-o", "t.glb"];
    folder.run(&tower).expect(0);
    let build = |out: &str, threads: &str| {
        let words = ["build", "t.glb", "--eye-height", "0,2.2", "--threads", threads, "-o", out, "--json"];
        folder.run(&words).expect(0).json()
    };
    let [one, two] = [build("1.pvs", "1"), build("2.pvs", "2")];
    assert_eq!(folder.read("1.pvs"), folder.read("2.pvs"), "the same bytes with any number of threads");
    assert_eq!((&one["subdivide"], &one["method"]), (&"eye-level".into(), &"line-space".into()), "{one}");
    assert_eq!((&one["eye_level"]["units_per_metre"], &two["eye_level"]), (&1.0.into(), &one["eye_level"]));
    let seen = one["n_objects_seen"].as_u64().expect("a number");
    let all = one["n_cells"].as_u64().expect("cells") * one["n_objects"].as_u64().expect("objects");
    assert!(seen * 10 < all * 9, "{seen} of {all}");
    folder.run(&["verify", "1.pvs", "t.glb", "--rays", "200000"]).expect(0);
    let text = folder.run(&["build", "t.glb", "--eye-height", "0,2.2", "-o", "1.pvs", "-v"]).expect(0).out;
    assert!(text.contains("cells at the height of eyes") && text.contains("1 units are a metre"), "{text}");
}

#[test]
fn heights_of_eyes_are_two_numbers_for_scenes() {
    let folder = Folder::with_tower();
    let refused = |words: &[&str]| folder.run(words).expect(2).err;
    let text = refused(&["build", "tower.glb", "--eye-height", "2,1", "-o", "a.pvs"]);
    assert!(text.contains("the lower one first"), "{text}");
    folder.write("plan.geojson", r#"{"type":"LineString","coordinates":[[0,0],[1,0],[1,1],[0,0]]}"#);
    let text = refused(&["build", "plan.geojson", "--eye-height", "0,2", "-o", "a.pvs"]);
    assert!(text.contains("eye-height is for scenes in space"), "{text}");
}
