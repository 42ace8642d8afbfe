//! Newell, Newell and Sancha's depth sort: a list of fragments by their farthest depth, tests of the last one against
//! all others, and splits where no order is right.
//!
//! The last fragment of the list, P, is drawn if for each other fragment Q one of the tests says that P does not hide
//! any of it. They are, in this order, each made if those before it fail:
//!
//! 1. *depth*: all of Q is nearer than all of P;
//! 2. *across* and *down*: they lie beside or below each other in the picture;
//! 3. *behind plane of Q*: all of P is behind the plane of Q, seen from the eye, or on it;
//! 4. *in front of plane of P*: all of Q is in front of the plane of P, or on it;
//! 5. *projection*: what is seen of them does not overlap in the picture;
//! 6. *nearer in common part* (our own): where they overlap, P is nowhere nearer.
//!
//! If all fail for some Q, Q is moved to the end of the list and marked, and it is P's turn again after it. If Q is
//! marked already, then fragments wait for each other in a circle; one of them is split by the plane of another, its
//! parts take its place in the list, and the marks go from it and from what was marked after it. The published method
//! starts anew after each fragment that it draws, and takes all marks away; it is the same to go on with the last one
//! that is still marked, since what has passed a test passes it still, and so do its parts. It also splits P and Q at
//! once where the plane of each cuts the other; with the sixth test nothing is split unless fragments do hide each other
//! in a circle. Of the splits that are possible one is preferred that opens the circle.
//!
//! **Why the order is right.** Say that P *hides* Q if there is a direction, with all directions around it, in which
//! both are met, P before Q or in one plane with it and with the lower id. When P is drawn, one of the tests has said
//! of each Q that remains that P does not hide it. Tests 1 and 2 compare bounds that are rounded outwards, of what the
//! camera sees; 3 and 4 are exact relations of fragments to planes of the input, and for fragments in one plane say
//! which has the lower id; 5 and 6 cut the cones of directions in which P and Q are seen with each other, exactly. So
//! whatever P hides was drawn before it. For a pixel on the border of fragments the rule of left and upper edges is
//! that of a point beside it.
//!
//! **Why there is always something to split.** Fragments of which the plane of none cuts any other have an order
//! without splits, from any eye: take a plane of one; first what is behind it, then what is in it, higher ids first,
//! then what is in front; and the same again for what is behind and in front. No fragment hides an earlier one, so no
//! fragments hide each other in a circle. A circle that is found is one of fragments that do hide each other, since the
//! last two tests are exact and those before them only say more often that nothing is hidden; so among those in it the
//! plane of one cuts another.
//!
//! **Why it ends.** Each split makes two parts, with an inside each, of a fragment, by the plane of a face. The planes
//! of n faces divide a face into a finite number of pieces, at most (n² - n) / 2 + 1, and no more fragments of it than those
//! come about. Between two splits each step either draws a fragment or marks one that was not marked, and marks are
//! only taken away by drawing.
//!
//! Fragments in whose plane the eye is show nothing and are left out, as are those outside the picture and the depths
//! that the camera sees. Those that reach behind the eye need nothing special, since cones of directions do not know of
//! that.
//!
//! Source: Newell, Newell and Sancha, "A solution to the hidden surface problem", Proc. ACM Annual Conference, 1972;
//! exactness, the sixth test, and the tree of bounds from which candidates come are our own.

mod cone;
mod item;
mod order;

use crate::counters::Counters;
use crate::method::{RenderInput, RenderOutput, VisibleSurface};
use order::Order;

/// The depth sort with all its tests. See the module.
///
/// Counts how often each test was made, of pairs whose bounds in a tree of bounds meet. Cost: for n fragments, that of
/// sorting them, and of the tests of all pairs that overlap in the picture of which the farther one reaches as near as
/// the other; at worst n² for n faces, and n³ fragments. Large faces whose
/// planes all pass through one point are slow, since most of their corners are decided exactly: seconds for 60 of them.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Newell;

impl VisibleSurface for Newell {
    fn name(&self) -> &'static str {
        "newell"
    }

    fn see(&self, input: &RenderInput<'_>, counters: &mut Counters) -> RenderOutput {
        RenderOutput::BackToFront(Order::new(input).run(counters))
    }
}
