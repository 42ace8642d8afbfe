//! Broken scenes in space: thousands of damaged GLBs, glTF texts and OBJs, none of which may cause a panic
//! or a scene that is inconsistent in itself. Settings as in the mutations of other formats.

use crate::common::glb::{SMALL_OBJ, rich_doc, small_doc};
use crate::common::setting;
use sightlines_formats::Malformed;
use sightlines_formats::SceneFile;
use sightlines_formats::scene::{parse_glb, parse_glb_with_source, parse_obj, write_glb};
use sightlines_testkit::mutate::{SplitMix, flipped_bits, mutate};

/// Uses everything in a scene; returns its number of triangles.
fn check(read: Result<SceneFile, Malformed>) -> Option<usize> {
    let file = match read {
        Ok(file) => file,
        Err(error) => {
            assert!(!error.to_string().is_empty());
            return None;
        }
    };
    let (scene, info) = (&file.scene, &file.info);
    assert!(info.n_triangles > 0 && info.n_triangles == scene.n_triangles());
    assert_eq!(info.n_objects, scene.objects().len());
    for (k, object) in (0u32..).zip(scene.objects()) {
        assert!(!object.bounds().is_empty());
        // Corners of what moves may be at one place at rest.
        let moves = scene.moving().iter().any(|moving| moving.object == k);
        assert!(moves || object.corners().all(|[a, b, c]| a != b && b != c && c != a));
        assert!(object.triangles.iter().all(|[a, b, c]| a != b && b != c && c != a));
    }
    if let Ok(bytes) = write_glb(scene) {
        let again = parse_glb(&bytes, None).unwrap();
        assert_eq!((again.info.n_objects, again.info.n_triangles), (info.n_objects, info.n_triangles));
    }
    Some(info.n_triangles)
}

fn check_glb(bytes: &[u8]) -> Option<usize> {
    check_rewritten(bytes);
    check(parse_glb(bytes, None))
}

/// Takes every other triangle away, as far as the document can be written again; returns whether it could be.
fn check_rewritten(bytes: &[u8]) -> bool {
    let Ok((file, source)) = parse_glb_with_source(bytes.to_vec(), None) else { return false };
    assert_eq!(source.n_objects(), file.scene.objects().len());
    let every_other = |list: &[[u32; 3]]| -> Vec<[u32; 3]> {
        list.iter().enumerate().filter(|(k, _)| k % 2 == 0).map(|(_, t)| *t).collect()
    };
    let changes: Vec<_> = file.scene.objects().iter().map(|o| Some(every_other(&o.triangles))).collect();
    let kept = |k: usize| changes[k].as_deref().unwrap_or_default();
    let corners = |k: usize, t: &[u32; 3]| t.map(|v| file.scene.objects()[k].vertices[v as usize]);
    let expected: Vec<_> = (0..changes.len()).flat_map(|k| kept(k).iter().map(move |t| corners(k, t))).collect();
    match source.rewrite(&changes, None) {
        Ok(bytes) => {
            let again = parse_glb(&bytes, None).unwrap_or_else(|e| panic!("{e}"));
            let found: Vec<_> = again.scene.objects().iter().flat_map(|o| o.corners()).collect();
            assert_eq!(found, expected);
            true
        }
        Err(error) => {
            assert!(!error.to_string().is_empty());
            false
        }
    }
}

fn check_obj(bytes: &[u8]) -> Option<usize> {
    check(parse_obj(bytes))
}

/// Runs the mutations of `seed`; both what is accepted and what is refused must be well represented.
fn run(seed: &[u8], check: fn(&[u8]) -> Option<usize>) {
    assert!(check(seed).is_some_and(|n| n > 0), "the seed itself is read");
    let (rounds, first) = (setting("SIGHTLINES_FUZZ_ROUNDS", 5_000), setting("SIGHTLINES_FUZZ_SEED", 0));
    let mut accepted = 0;
    for number in first..first + rounds {
        let broken = mutate(seed, &mut SplitMix::new(number));
        let Ok(result) = std::panic::catch_unwind(|| check(&broken)) else {
            panic!("replay with SIGHTLINES_FUZZ_ROUNDS=1 SIGHTLINES_FUZZ_SEED={number}: {broken:?}")
        };
        accepted += u64::from(result.is_some());
    }
    let both = (rounds / 100..=rounds * 95 / 100).contains(&accepted);
    assert!(both || rounds < 1000, "{accepted} of {rounds} accepted");
}

/// The small document as text, with its buffer inside.
fn small_text() -> Vec<u8> {
    let mut doc = small_doc();
    let alphabet = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let bits: Vec<u8> = doc.binary.iter().flat_map(|b| (0..8).rev().map(move |k| b >> k & 1)).collect();
    let letter = |six: &[u8]| {
        let value = (0..6).fold(0, |v, k| v << 1 | usize::from(*six.get(k).unwrap_or(&0)));
        char::from(alphabet[value])
    };
    let coded: String = bits.chunks(6).map(letter).collect();
    doc.json["buffers"][0]["uri"] = format!("data:;base64,{coded}").into();
    doc.text().into_bytes()
}

#[test]
fn damaged_glbs_are_read_or_refused() {
    run(&small_doc().glb(), check_glb);
}

#[test]
fn damaged_glbs_are_written_again_or_refused() {
    assert!(check_rewritten(&small_doc().glb()) && check_rewritten(&rich_doc().glb()));
    run(&rich_doc().glb(), check_glb);
}

#[test]
fn damaged_gltf_texts_are_read_or_refused() {
    let text = small_text();
    assert_eq!(parse_glb(&text, None).unwrap(), parse_glb(&small_doc().glb(), None).unwrap());
    run(&text, check_glb);
}

#[test]
fn damaged_objs_are_read_or_refused() {
    run(SMALL_OBJ.as_bytes(), check_obj);
}

#[test]
fn every_prefix_is_refused_or_consistent() {
    let (glb, text) = (small_doc().glb(), small_text());
    assert!((0..glb.len()).all(|len| check_glb(&glb[..len]).is_none()));
    assert!((0..text.len()).all(|len| check_glb(&text[..len]).is_none()));
    // An OBJ may end anywhere: what is read then is the beginning.
    let n = (0..=SMALL_OBJ.len()).filter(|&len| check_obj(&SMALL_OBJ.as_bytes()[..len]).is_some()).count();
    assert!(n > 0 && n < SMALL_OBJ.len() / 2);
}

#[test]
fn every_flipped_bit_is_read_or_refused() {
    for bytes in flipped_bits(&small_doc().glb()) {
        check_glb(&bytes);
    }
    for text in flipped_bits(SMALL_OBJ.as_bytes()) {
        check_obj(&text);
    }
}
