//! Tests of the border to C.

mod header;
