//! Whether a table of a scene is worth it: what it leaves to draw, and what else helps if that is much.

use crate::output::percent;
use sightlines::report::ViewerShare;

/// Up to this share of the polygons a table is worth it without any doubt.
const LITTLE: f64 = 0.25;
/// Above this share there is an advice.
const MUCH: f64 = 0.5;

/// The sentence; none where there are no polygons, or no cells.
///
/// * `is_auto`: whether the method was chosen for the scene, rather than by the user
pub(super) fn sentence(viewer: &ViewerShare, is_auto: bool) -> Option<String> {
    let ViewerShare { cells, polygons, .. } = *viewer;
    let [few, part] = [polygons, cells].map(percent);
    let still = format!("a viewer still has {few} of the polygons");
    if polygons.is_nan() || polygons <= 0.0 {
        return None;
    }
    Some(if polygons <= LITTLE {
        format!("yes: a viewer has to draw one polygon in {:.0}", 1.0 / polygons)
    } else if polygons <= MUCH {
        format!("in part: {still}")
    } else if cells <= 0.5 * polygons {
        format!(
            "hardly: {still}, but only {part} of the cells: objects are large and are seen as a whole; cut them into pieces"
        )
    } else if !is_auto {
        format!("hardly: {still}; --method auto may find more that hides, such as slanted and curved surfaces")
    } else {
        format!(
            "hardly: {still}: the scene is open, few walls hide anything; a table saves little here; smaller cells \
             (--eye-height with a --cell-size, or more --n-cells) may save more"
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sentence_says_whether_it_was_worth_it() {
        let of = |polygons, cells, is_auto| sentence(&ViewerShare { cells, objects: 0.5, polygons }, is_auto);
        let begins = |text: Option<String>, with: &str| {
            let text = text.expect("a sentence");
            assert!(text.starts_with(with), "{text}");
        };
        assert_eq!(of(0.067, 0.04, true).as_deref(), Some("yes: a viewer has to draw one polygon in 15"));
        assert_eq!(of(0.298, 0.177, true).as_deref(), Some("in part: a viewer still has 29.8 % of the polygons"));
        begins(
            of(0.9, 0.95, true),
            "hardly: a viewer still has 90.0 % of the polygons: the scene is open, few walls hide",
        );
        begins(of(0.9, 0.95, false), "hardly: a viewer still has 90.0 % of the polygons; --method auto ");
        begins(
            of(1.0, 0.3, true),
            "hardly: a viewer still has 100.0 % of the polygons, but only 30.0 % of the cells: obj",
        );
        assert_eq!([of(0.0, 0.0, true), of(f64::NAN, 0.0, true)], [None, None]);
        // The borders belong to the better side.
        begins(of(LITTLE, 0.2, true), "yes: a viewer has to draw one polygon in 4");
        begins(of(MUCH, 0.2, true), "in part: ");
    }
}
