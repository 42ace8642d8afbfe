//! What is seen of a cupboard: closed, with a keyhole, and closed by a gap.

use sightlines_scenes::cupboard;
use sightlines_strip::{Eyes, Fate, StripOptions, strip};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for (what, keyhole, gap) in [("closed", 0, 0.0), ("with a keyhole", 1, 0.0), ("by a gap", 1, 0.0625)] {
        let scene = cupboard(keyhole)?.scene;
        let found = strip(&scene, &Eyes::outside(), &StripOptions { gap, ..StripOptions::default() }, None)?;
        println!("{what}:");
        for (object, of) in scene.objects().iter().zip(&found.objects) {
            let fate = match of.fate {
                Fate::Seen([eye, _]) => format!("seen from {eye:.2?}"),
                Fate::Hidden(reason) => format!("hidden: {}", reason.name()),
                other => format!("{other:?}"),
            };
            println!("  {:<8}{fate}", object.name);
        }
    }
    Ok(())
}
