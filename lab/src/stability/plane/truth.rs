//! What is true of a sequence of doors in the plane, and whether cells could have made it.

use sightlines::geometry::{Point2, Portal2, orient2d};
use sightlines_testkit::{Stab, stabbable_brute_force};

/// Whether an open set of lines passes all doors. Exact, by all lines through two ends.
pub fn is_open(doors: &[Portal2]) -> bool {
    let pairs: Vec<(Point2, Point2)> = doors.iter().map(|d| (d.left, d.right)).collect();
    // Near their first end the doors have small coordinates, if moving them there rounds nothing: that is much quicker.
    let pairs = moved_to_origin(&pairs).unwrap_or(pairs);
    stabbable_brute_force(&pairs) == Stab::Open
}

/// The doors less their first end; `None` if a difference is no double.
fn moved_to_origin(pairs: &[(Point2, Point2)]) -> Option<Vec<(Point2, Point2)>> {
    let origin = pairs.first()?.0;
    let exact = |x: f64, by: f64| {
        // Knuth's two-sum: the error of the difference, exactly.
        let difference = x - by;
        let part = difference - x;
        let error = (x - (difference - part)) + (-by - part);
        (error == 0.0).then_some(difference)
    };
    let point = |p: Point2| Some(Point2::new(exact(p.x, origin.x)?, exact(p.y, origin.y)?));
    pairs.iter().map(|&(l, r)| Some((point(l)?, point(r)?))).collect()
}

/// Whether each door leads into a convex cell that the next one leads out of, which is what the funnel may rely on.
/// This decides which sequences are tested, not what is true of them.
pub fn is_chain(doors: &[Portal2]) -> bool {
    let beyond = |door: Portal2, q: Point2| orient2d(door.left, door.right, q);
    doors.iter().all(|d| d.left != d.right)
        && doors.windows(2).all(|pair| {
            let after = [pair[1].left, pair[1].right].map(|q| beyond(pair[0], q));
            let before = [pair[0].left, pair[0].right].map(|q| beyond(pair[1], q));
            after.iter().all(|&x| x >= 0.0) && before.iter().all(|&x| x <= 0.0) && after.iter().any(|&x| x > 0.0)
        })
}
