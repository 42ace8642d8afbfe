//! Proofs that `build --certify` wrote, checked against their table.

use crate::error::{ErrorAbout, Result, anyhow, bail};
use sightlines::certificates::Refusal;
use sightlines::pvs::Table;
use sightlines::verify::report::ProofOutcome;
use sightlines::verify::{
    ProofError, ProofViolation, Truth, WallFindings, can_be_proven, check_proofs, check_walls_in_space,
    check_walls_of_plan,
};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Which proofs are checked.
#[derive(Debug, Clone, Default, clap::Args)]
pub(super) struct ProofArgs {
    /// The proofs that `build --certify` wrote [default: the table's name with the extension .cert, if that file
    /// exists]
    #[arg(long, value_name = "FILE.cert")]
    proofs: Option<PathBuf>,
    /// With proofs, and for cells without portals, which have none: hidden pairs without a proof, of cells or of a cell and an object, are
    /// violations, and so are walls of cells that nothing in the scene covers
    #[arg(long)]
    strict: bool,
}

impl ProofArgs {
    /// Whether what has no proof is a violation.
    pub(super) fn is_strict(&self) -> bool {
        self.strict
    }

    pub(super) fn is_given(&self) -> bool {
        self.proofs.is_some() || self.strict
    }
}

/// Checks the proofs of a table; `None` if none are given and none are beside it.
///
/// # Errors
/// An error if `--strict` has nothing to be strict about, for files that cannot be read, and for proofs of another kind of table.
pub(super) fn check(args: &ProofArgs, path: &Path, table: &Table, truth: &Truth<'_>) -> Result<Option<ProofOutcome>> {
    let beside = path.with_extension("cert");
    let is_asked_for = args.proofs.is_some();
    let file = match &args.proofs {
        Some(file) => file.clone(),
        None if beside.is_file() => beside,
        // What has no proofs is counted, and that is all.
        None if !can_be_proven(table) => return Ok(None),
        None if args.strict => bail!(
            "{}: --strict is for tables with proofs, and there are none: no --proofs, and no {}",
            path.display(),
            beside.display()
        ),
        None => return Ok(None),
    };
    let content = std::fs::read(&file).in_file(&file)?;
    let start = Instant::now();
    let found = check_proofs(table, &content);
    let is_of_other = match &found {
        Ok(found) => found
            .violations
            .iter()
            .any(|violation| matches!(violation, ProofViolation::Refused(Refusal::OtherTable | Refusal::OtherObjects))),
        Err(error) => matches!(error, ProofError::Kind { .. }) || !can_be_proven(table),
    };
    // They were not named, only found beside the table: most likely it was built again without proofs.
    if is_of_other && !is_asked_for {
        return Ok(Some(ProofOutcome::stale((&file, content.len()), args.strict, start.elapsed())));
    }
    let found = found.map_err(|source| anyhow!("{}: {source} (the table is {})", file.display(), path.display()))?;
    let walls = match truth {
        Truth::Plan(plan) => check_walls_of_plan(table, plan),
        Truth::Scene(scene) => check_walls_in_space(table, scene),
        _ => WallFindings::default(),
    };
    Ok(Some(ProofOutcome::new((&file, content.len()), found, walls, args.strict, start.elapsed())))
}
