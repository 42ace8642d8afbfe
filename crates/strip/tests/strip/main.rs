//! What is stripped: against the truth of generated scenes, and against rays that are decided by other code.

mod gap;
mod pictures;
mod sides;
mod truth;
mod walk;
