//! `job status`: what is done.

use super::{absolute, open};
use crate::command::{Done, JsonArg, Verbosity};
use crate::error::Result;
use sightlines::checkpoint::report::Status;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(crate) struct StatusArgs {
    /// The folder of the job
    #[arg(value_name = "JOB")]
    job: PathBuf,
    #[command(flatten)]
    json: JsonArg,
}

pub(crate) fn run(args: &StatusArgs, _: Verbosity) -> Result<Done> {
    let job = open(&absolute(&args.job)?)?;
    Ok(Done::new(args.json, Status::of(&job, args.job.display().to_string())?))
}
