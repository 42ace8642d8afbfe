//! Proofs that are to be written beside a table.

use super::Error;
use crate::error::OutputError;
use crate::output::{self, bytes, seconds};
use crate::progress::Bar;
use serde::Serialize;
use sightlines::bake::Baked;
use sightlines::stabtree::CertifyOptions;
use std::fmt;
use std::path::{Path, PathBuf};

/// Whether proofs are written, and where.
#[derive(Debug, Clone, Default, clap::Args)]
pub(super) struct CertifyArgs {
    /// Also write proofs, to FILE or beside the table with the extension .cert: a line for each visible pair, a reason
    /// for each hidden one, for `verify` to check with independent code. May take ten times as long as the table, and
    /// much longer for large Quake maps, where pairs that take too long stay without a proof. In space only for
    /// --method sightlines
    #[arg(long, value_name = "FILE", num_args = 0..=1, require_equals = true)]
    certify: Option<Option<PathBuf>>,
}

impl CertifyArgs {
    /// Whether proofs are wanted.
    pub(super) fn is_given(&self) -> bool {
        self.certify.is_some()
    }

    /// Refuses a file of proofs that is the input or the table.
    pub(super) fn check(&self, input: &Path, table: &Path) -> Result<(), Error> {
        let Some(file) = self.file(table) else { return Ok(()) };
        output::check(&[input], &[&file])?;
        if file == table { Err(OutputError::SameFile(file).into()) } else { Ok(()) }
    }

    fn file(&self, table: &Path) -> Option<PathBuf> {
        let given = self.certify.as_ref()?;
        Some(given.clone().unwrap_or_else(|| table.with_extension("cert")))
    }

    /// Finds and writes proofs for what was baked from `path` and written to `out`, if they are wanted.
    pub(super) fn write(
        &self,
        path: &Path,
        out: &Path,
        baked: &Baked,
        threads: usize,
        show_progress: bool,
    ) -> Result<Option<Certified>, Error> {
        let Some(file) = self.file(out) else { return Ok(None) };
        let bar = Bar::new("proofs", show_progress);
        let made = baked.certify(&CertifyOptions { threads, progress: Some(&bar), ..CertifyOptions::default() });
        drop(bar);
        let made = made.map_err(|source| Error::Certify { path: path.to_owned(), source })?;
        let content = made.proofs.to_bytes();
        output::save(&file, &content)?;
        let n_bytes = content.len();
        Ok(Some(Certified {
            proofs: file.display().to_string(),
            n_proof_bytes: n_bytes,
            certify_seconds: made.time.as_secs_f64(),
        }))
    }
}

/// What was written.
#[derive(Debug, Serialize)]
pub(super) struct Certified {
    proofs: String,
    n_proof_bytes: usize,
    certify_seconds: f64,
}

impl fmt::Display for Certified {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let time = std::time::Duration::try_from_secs_f64(self.certify_seconds).unwrap_or_default();
        writeln!(f, "proofs         {}, {}, in {}", self.proofs, bytes(self.n_proof_bytes as u64), seconds(time))
    }
}
