//! Journals and jobs, with bakes that are toys.

mod chains;
mod damage;
mod jobs;
mod journals;
mod toy;
mod workers;
