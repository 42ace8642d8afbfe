//! What is noticed in tables, and what is not.

mod certify;
mod tables;
