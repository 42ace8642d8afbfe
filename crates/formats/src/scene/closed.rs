//! Closed things: what hides from both sides though only its fronts are drawn.

pub(super) use sightlines_cells::closed::is_closed_outwards;
