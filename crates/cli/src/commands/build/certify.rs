//! Proofs that are to be written beside a table.

use crate::error::{ErrorAbout, Result, anyhow};
use crate::kept::Kept;
use crate::output::{self, JsonSchema, Serialize, bytes, count, seconds_of};
use crate::progress::Bar;
use sightlines::bake::auto::own_cells;
use sightlines::bake::{BakeInput, BakeRequest, Baked, CellsFrom, Recipe};
use sightlines::stabtree::CertifyOptions;
use sightlines::verify::report::Unproven;
use sightlines::verify::{ProofError, ProofFindings, ProofViolation, can_be_proven, check_proofs};
use std::fmt;
use std::path::{Path, PathBuf};

/// Whether proofs are written, and where.
#[derive(Debug, Clone, Default, clap::Args)]
pub(super) struct CertifyArgs {
    /// Also write proofs about pairs of cells, and in space about objects that cells do not see, for `verify` to check with independent
    /// code: a line for each visible pair, a reason for each hidden one. They go to FILE, or without it beside the table with the extension .cert. May take ten times as long as the table, and much longer for
    /// large Quake maps. What has no proof is counted as unproven: pairs that take too long, what only a from-region method
    /// hides, and all pairs of cells without portals. Scenes have the cells of a k-d tree then, unless others are named, and walls that hide
    /// from their front only hide nothing from sightlines, but where two stand back to back [default: no proofs]
    #[arg(long, value_name = "FILE", num_args = 0..=1, require_equals = true)]
    certify: Option<Option<PathBuf>>,
}

impl CertifyArgs {
    pub(super) fn is_given(&self) -> bool {
        self.certify.is_some()
    }

    pub(super) fn check(&self, input: &Path, table: &Path) -> Result<()> {
        let Some(file) = self.file(table) else { return Ok(()) };
        output::check(&[input], &[&file])?;
        if file == table { Err(output::same_file(&file)) } else { Ok(()) }
    }

    pub(super) fn file(&self, table: &Path) -> Option<PathBuf> {
        let given = self.certify.as_ref()?;
        Some(given.clone().unwrap_or_else(|| table.with_extension("cert")))
    }

    /// Finds and writes proofs for what was baked from `path` and written to `out`, if they are wanted, and counts what has none. For cells without
    /// portals there is nothing to write.
    pub(super) fn write(
        &self,
        path: &Path,
        out: &Path,
        baked: &Baked,
        threads: usize,
        kept: &Kept<'_>,
        show_progress: bool,
    ) -> Result<Option<Certified>> {
        let Some(file) = self.file(out) else { return Ok(None) };
        if !can_be_proven(&baked.table) {
            tracing::warn!("{}: no proofs are written: there are none about cells without portals", path.display());
            let found = ProofFindings::without_proofs(&baked.table);
            return Ok(Some(Certified { file: None, unproven: Unproven::new(&baked.table, &found) }));
        }
        let bar = Bar::new("proofs", show_progress);
        let made = baked.certify(&CertifyOptions {
            threads,
            progress: Some(&bar),
            units: kept.units(),
            ..CertifyOptions::default()
        });
        drop(bar);
        let made = made.in_file(path)?;
        let content = made.proofs.to_bytes();
        let found = check_proofs(&baked.table, &content).map_err(|error| incomparable(path, &error))?;
        if let Some(first) = found.violations.first() {
            return Err(contradiction(path, first, found.n_violations));
        }
        kept.before_writing()?;
        output::save(&file, &content)?;
        let file = ProofFile {
            proofs: file.display().to_string(),
            n_proof_bytes: content.len(),
            certify_seconds: made.time.as_secs_f64(),
            n_excess: found.n_excess,
        };
        Ok(Some(Certified { file: Some(file), unproven: Unproven::new(&baked.table, &found) }))
    }
}

/// Warns if the cells of a scene are those of a k-d tree because of `request`, and others would be cut without proofs and stab trees.
pub(super) fn warn_of_large_cells(path: &Path, request: &BakeRequest, input: BakeInput<'_>) {
    let BakeRequest { cells, cell_size, method, for_proofs, .. } = request;
    let is_asked = *for_proofs && method.is_none() && cells.is_none() && cell_size.is_none();
    if let BakeInput::Scene(scene, _) = input
        && is_asked
        && !matches!(own_cells(scene, true), CellsFrom::KdTree)
    {
        tracing::warn!(
            "{}: few walls are axis-aligned, and only along these are cells cut that have portals, which --certify and --stab-trees need: the cells \
             are large, and little is hidden. Without these options `build` cuts smaller cells, and any surface may hide",
            path.display()
        );
    }
}

/// Warns of walls of the input that hide nothing because proofs or stab trees are to be made.
pub(super) fn warn_of_one_sided_walls(path: &Path, recipe: &Recipe, input: BakeInput<'_>) {
    if let BakeInput::Scene(scene, _) = input
        && recipe.cut.only_both_sides
        && !scene.front_occluders().is_empty()
    {
        tracing::warn!(
            "{}: with --certify and --stab-trees, walls that hide from their front only hide nothing from sightlines, but where two stand back to \
             back: portals have no sides",
            path.display()
        );
    }
}

/// What was written, and what has no proof.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Certified {
    /// None for cells without portals.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    file: Option<ProofFile>,
    /// What none of the proofs speaks of.
    unproven: Unproven,
}

#[derive(Debug, Serialize, JsonSchema)]
struct ProofFile {
    /// The file of proofs that was written.
    proofs: String,
    /// Size of the file of proofs.
    n_proof_bytes: usize,
    /// Seconds to find the proofs.
    certify_seconds: f64,
    /// Pairs listed as visible and proven to be hidden; only in tables of scenes in space. This, `proofs`, `n_proof_bytes` and `certify_seconds`
    /// are absent for cells without portals, about which there are no proofs.
    n_excess: u64,
}

impl fmt::Display for Certified {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.file {
            Some(ProofFile { proofs, n_proof_bytes, certify_seconds, n_excess }) => {
                let (size, time) = (bytes(*n_proof_bytes as u64), seconds_of(*certify_seconds));
                writeln!(f, "proofs         {proofs}, {size}, in {time}")?;
                if *n_excess > 0 {
                    writeln!(f, "               {} are proven to be hidden", count(*n_excess, "visible pair"))?;
                }
            }
            None => writeln!(f, "proofs         none: there are none about cells without portals")?,
        }
        write!(f, "{}", self.unproven)
    }
}

/// Proofs that were made are none of the table: our bug.
fn incomparable(path: &Path, error: &ProofError) -> anyhow::Error {
    anyhow!(
        "{}: the proofs that were made cannot be compared with the table: {error}; nothing was written",
        path.display()
    )
}

/// What is proven is not what the table states: our bug.
fn contradiction(path: &Path, first: &ProofViolation, n_violations: u64) -> anyhow::Error {
    let more = if n_violations > 1 { format!("; and {} more", n_violations - 1) } else { String::new() };
    anyhow!("{}: the proofs contradict the table: {first}{more}; nothing was written", path.display())
}

#[cfg(test)]
mod tests {
    use super::*;
    use sightlines::pvs::CellId;

    #[test]
    fn proofs_that_contradict_are_named() {
        let first = ProofViolation::Joined([CellId(1), CellId(2)]);
        let error = |n_violations: u64| contradiction(Path::new("a.glb"), &first, n_violations).to_string();
        let text = "a.glb: the proofs contradict the table: cells 1 and 2 are hidden from each other, but a proven line joins them";
        assert_eq!(
            [1, 3].map(error),
            [format!("{text}; nothing was written"), format!("{text}; and 2 more; nothing was written")]
        );
        let other = incomparable(Path::new("a.glb"), &ProofError::Portal(3)).to_string();
        let text = "cannot be compared with the table: portal 3 of the table is no rectangle across an axis; nothing was written";
        assert_eq!(other, format!("a.glb: the proofs that were made {text}"));
    }
}
