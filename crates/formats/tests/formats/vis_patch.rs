//! Visibility without its map (VisPatch): what is written is read, and what is damaged is refused.

use crate::common::quake::SmallBsp;
use sightlines_formats::quake::vis_patch::{VisPatch, parse_vis_patches, write_vis_patches};
use sightlines_formats::quake::{Bsp, BspFormat};

fn patches() -> Vec<VisPatch> {
    let mut bsp = SmallBsp::with_world(BspFormat::Bsp29);
    bsp.visibility = vec![1, 2, 3, 0, 5];
    let bsp = Bsp::parse(bsp.file(false)).unwrap();
    ["e1m1.bsp", "a_map_with_a_name_of_31_let.bsp"].map(|name| VisPatch::of_map(name, &bsp).unwrap()).to_vec()
}

#[test]
fn files_come_back_and_damaged_ones_do_not() {
    let patches = patches();
    let bytes = write_vis_patches(&patches).unwrap();
    assert_eq!(&bytes[..12], b"e1m1.bsp\0\0\0\0");
    assert_eq!(parse_vis_patches(&bytes), Ok(patches.clone()));
    let first = write_vis_patches(&patches[..1]).unwrap().len();
    let mut n_refused = 0;
    for end in (0..bytes.len()).filter(|&end| end != first) {
        assert!(parse_vis_patches(&bytes[..end]).is_err(), "{end}");
        n_refused += 1;
    }
    // Lengths that contradict each other, or claim more than there is.
    for at in [32, 36, first + 32, first + 36] {
        for change in [1, 0x80] {
            for byte in 0..4 {
                let mut bytes = bytes.clone();
                bytes[at + byte] ^= change;
                assert!(parse_vis_patches(&bytes).is_err(), "{at} {byte}");
                n_refused += 1;
            }
        }
    }
    assert!(n_refused > 400, "{n_refused}");
}

#[test]
fn names_and_formats_are_checked() {
    let bsp = |kind| {
        let mut bsp = SmallBsp::with_world(kind);
        bsp.visibility = vec![0; 9];
        Bsp::parse(bsp.file(false)).unwrap()
    };
    let quake = bsp(BspFormat::Bsp29);
    for name in ["", "größe.bsp", "a b.bsp", "a_map_with_a_name_of_32_lett.bsp"] {
        assert!(VisPatch::of_map(name, &quake).is_err(), "{name}");
    }
    let mut n_others = 0;
    for kind in BspFormat::ALL.into_iter().filter(|&kind| kind != BspFormat::Bsp29) {
        assert!(
            VisPatch::of_map("a.bsp", &bsp(kind)).is_err() && patches()[0].put_into(&bsp(kind)).is_err(),
            "{kind:?}"
        );
        n_others += 1;
    }
    assert!(n_others > 5);
    let mut none = SmallBsp::with_world(BspFormat::Bsp29);
    none.visibility = Vec::new();
    assert!(VisPatch::of_map("a.bsp", &Bsp::parse(none.file(false)).unwrap()).is_err());
    // Leafs may differ in their rows and loudness, and in nothing else.
    let patch = &patches()[0];
    let (mut n_fit, mut n_not) = (0, 0);
    for at in 0..28 {
        let mut other = patch.clone();
        other.leafs[28 + at] ^= 1;
        let fits = other.put_into(&quake).is_ok();
        assert_eq!(fits, (4..8).contains(&at) || at >= 24, "{at}");
        *if fits { &mut n_fit } else { &mut n_not } += 1;
    }
    assert_eq!((n_fit, n_not), (8, 20));
}
