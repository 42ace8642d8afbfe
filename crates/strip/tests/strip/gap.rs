//! Cracks, by a stated width.
