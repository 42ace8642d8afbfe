//! Sides, glass, motion and mirrors.
