//! Proofs that `build --certify` wrote, checked against their table.

use crate::error::{ErrorAbout, Result, anyhow, bail};
use crate::output::{JsonSchema, Serialize, bytes, count, seconds_of};
use sightlines::certificates::Refusal;
use sightlines::pvs::Table;
use sightlines::verify::{
    ProofError, ProofFindings, ProofViolation, Truth, WallFindings, can_be_proven, check_proofs, check_walls_in_space,
    check_walls_of_plan,
};
use std::fmt;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

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

    /// Whether proofs were requested.
    pub(super) fn is_given(&self) -> bool {
        self.proofs.is_some() || self.strict
    }
}

/// Pairs and violations that people are shown.
const SHOWN: usize = 5;
/// Pairs and violations that JSON lists.
const LISTED: usize = 1000;

/// Checked proofs.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct ProofOutcome {
    /// The file of proofs.
    file: String,
    /// Its size.
    n_bytes: usize,
    /// Whether the file was found beside the table but belongs to another one; then nothing of it was checked.
    pub(super) is_stale: bool,
    /// Whether nothing contradicts the table and, with `--strict`, everything hidden is proven.
    pub(super) is_true: bool,
    /// Pairs that the table lists as visible and that a line joins.
    n_visible: u64,
    /// Pairs that the table lists as hidden and that are proven.
    n_hidden: u64,
    /// Pairs listed as visible and proven to be hidden; only in tables of scenes in space, which show pairs that they do not decide.
    n_excess: u64,
    /// Pairs listed as visible without a proof.
    n_unproven_visible: u64,
    /// Pairs listed as hidden without a proof.
    n_unproven_hidden: u64,
    /// Of the pairs listed as hidden without a proof, those that a line through portals joins: only a from-region method hides them.
    n_hidden_past_portals: u64,
    /// Some of the pairs hidden without a proof, by their cells.
    unproven_hidden: Vec<[u32; 2]>,
    /// Pairs of a cell and an object listed as hidden, with a proof.
    n_hidden_objects: u64,
    /// Pairs of a cell and an object listed as hidden, without a proof.
    n_unproven_hidden_objects: u64,
    /// Violations.
    n_violations: u64,
    /// Some of the violations, a sentence each.
    violations: Vec<String>,
    /// Parts of borders of cells that are not portals: the proofs rely on them as walls.
    n_walls: u64,
    /// Of `n_walls`, parts that nothing in the scene covers exactly.
    n_bare_walls: u64,
    /// Some of the bare parts: the cell, and a point with three coordinates.
    bare_walls: Vec<(u32, [f64; 3])>,
    /// Seconds to check them.
    seconds: f64,
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
        let nothing = ProofOutcome::new(
            &file,
            content.len(),
            &ProofFindings::default(),
            &WallFindings::default(),
            args.strict,
            start.elapsed(),
        );
        return Ok(Some(ProofOutcome { is_stale: true, is_true: !args.strict, ..nothing }));
    }
    let found = found.map_err(|source| anyhow!("{}: {source} (the table is {})", file.display(), path.display()))?;
    let walls = match truth {
        Truth::Plan(plan) => check_walls_of_plan(table, plan),
        Truth::Scene(scene) => check_walls_in_space(table, scene),
        _ => WallFindings::default(),
    };
    Ok(Some(ProofOutcome::new(&file, content.len(), &found, &walls, args.strict, start.elapsed())))
}

impl ProofOutcome {
    fn new(
        file: &Path,
        n_bytes: usize,
        found: &ProofFindings,
        walls: &WallFindings,
        strict: bool,
        time: Duration,
    ) -> Self {
        let pairs = found.unproven_hidden.iter().take(LISTED);
        Self {
            file: file.display().to_string(),
            n_bytes,
            is_stale: false,
            is_true: found.is_true(strict) && !(strict && walls.n_bare > 0),
            n_visible: found.n_visible,
            n_hidden: found.n_hidden,
            n_excess: found.n_excess,
            n_hidden_objects: found.n_hidden_objects,
            n_unproven_hidden_objects: found.n_unproven_hidden_objects,
            n_unproven_visible: found.n_unproven_visible,
            n_unproven_hidden: found.n_unproven_hidden,
            n_hidden_past_portals: found.n_hidden_past_portals,
            unproven_hidden: pairs.map(|pair| pair.map(|cell| cell.0)).collect(),
            n_violations: found.n_violations,
            violations: found.violations.iter().take(LISTED).map(ToString::to_string).collect(),
            n_walls: walls.n_walls,
            n_bare_walls: walls.n_bare,
            bare_walls: walls.bare.iter().map(|(cell, point)| (cell.0, *point)).collect(),
            seconds: time.as_secs_f64(),
        }
    }
}

impl fmt::Display for ProofOutcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_stale {
            writeln!(
                f,
                "proofs         {} is stale: it is about other cells, portals or objects than the table has",
                self.file
            )?;
            return writeln!(f, "               not checked; build the table with --certify again, or remove the file");
        }
        let time = seconds_of(self.seconds);
        writeln!(f, "proofs         {}, {}, checked in {time}", self.file, bytes(self.n_bytes as u64))?;
        let [shown, hidden] =
            [(self.n_visible, "visible"), (self.n_hidden, "hidden")].map(|(n, what)| count(n, &format!("{what} pair")));
        writeln!(f, "               {shown} and {hidden} proven")?;
        if self.n_hidden_objects > 0 {
            let hidden = count(self.n_hidden_objects, "hidden pair");
            writeln!(f, "               {hidden} of a cell and an object proven")?;
        }
        if self.n_excess > 0 {
            let shown = count(self.n_excess, "visible pair");
            writeln!(f, "               {shown} proven to be hidden: the table shows more than is visible")?;
        }
        for (n, what) in [(self.n_unproven_visible, "visible"), (self.n_unproven_hidden, "hidden")] {
            if n > 0 {
                writeln!(f, "unproven       {}", count(n, &format!("{what} pair")))?;
            }
        }
        if self.n_hidden_past_portals > 0 {
            let n = self.n_hidden_past_portals;
            writeln!(f, "               {n} of these are joined through portals: a from-region method hides them")?;
        }
        let pairs = self.unproven_hidden.iter().take(SHOWN).map(|[a, b]| format!("{a} and {b}"));
        let pairs: Vec<String> = pairs.collect();
        if !pairs.is_empty() {
            writeln!(f, "               hidden without a proof: {}", pairs.join(", "))?;
        }
        if self.n_unproven_hidden_objects > 0 {
            let hidden = count(self.n_unproven_hidden_objects, "hidden pair");
            writeln!(f, "unproven       {hidden} of a cell and an object")?;
        }
        if self.n_walls > 0 {
            let backed = count(self.n_walls - self.n_bare_walls, "wall");
            writeln!(f, "walls          {backed} of {} covered by the scene", self.n_walls)?;
        }
        for (cell, [x, y, z]) in self.bare_walls.iter().take(SHOWN) {
            writeln!(f, "               not covered: of cell {cell}, at ({x}, {y}, {z})")?;
        }
        for text in self.violations.iter().take(SHOWN) {
            writeln!(f, "violation      {text}")?;
        }
        match self.n_violations {
            0 => writeln!(f, "proofs say     nothing that contradicts the table"),
            n => writeln!(f, "proofs say     {}", count(n, "violation")),
        }
    }
}
