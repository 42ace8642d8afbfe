//! Journals and jobs, with bakes that are toys.

mod chains;
mod damage;
mod engines;
mod jobs;
mod journals;
mod toy;
mod workers;
