//! Proofs of the constants that bound rounding, by Gappa.
//!
//! The table in `xtask/proofs` has every line of the deciding code that looks like a bound on rounding, and what is known of it. Tests compare
//! it with the sources; this task runs the scripts, each with the code's own constant, and with one that is too small, which must fail.

mod constant;
mod table;
mod terms;

use crate::step::{self, Failure};
use std::io::{ErrorKind, Write};
use std::process::{Command, Stdio};
use std::time::Instant;
use table::{Claim, Entry};

/// Compares the table with the sources, and lets Gappa check all scripts. Without Gappa it says so and checks the rest.
pub(crate) fn check() -> Result<(), Failure> {
    let (start, entries) = (Instant::now(), table::read()?);
    let mut problems = table::problems(&entries)?;
    let n = if has_gappa()? {
        let mut n = 0;
        for entry in &entries {
            let Claim::Gappa(proof) = &entry.claim else { continue };
            problems.extend(tried(proof)?.into_iter().map(|problem| format!("{}: {problem}", entry.name)));
            n += 1;
        }
        Some(n)
    } else {
        None
    };
    problems.iter().for_each(|problem| eprintln!("{problem}"));
    if !problems.is_empty() {
        return Err(Failure::Found { what: "faults of proofs", n: problems.len() });
    }
    let counts = Counts::of(&entries);
    match n {
        Some(n) => eprintln!(
            "{counts}; {n} scripts hold, and none for a smaller constant, in {:.1} s",
            start.elapsed().as_secs_f64()
        ),
        None => eprintln!(
            "{counts}\nSKIPPED: no script was run, as there is no gappa here (Debian has it in the package gappa)"
        ),
    }
    Ok(())
}

/// What Gappa says other than it should: a constant that is not proven, an impostor that is.
fn tried(proof: &table::Proof) -> Result<Vec<String>, Failure> {
    let (good, bad) = match proof.trials() {
        Ok(trials) => trials,
        Err(problem) => return Ok(vec![problem]),
    };
    let mut problems = Vec::new();
    match proof.lemmas() {
        Ok(Some(script)) if !proves(&script)? => problems.push("a product of roundings is not proven".to_owned()),
        Ok(_) => {}
        Err(problem) => return Ok(vec![problem]),
    }
    for (constant, expected) in good.into_iter().map(|x| (x, true)).chain(bad.into_iter().map(|x| (x, false))) {
        match proof.script(constant) {
            Ok(script) if proves(&script)? == expected => {}
            Ok(_) if expected => problems.push(format!("{constant:e} is not proven")),
            Ok(_) => problems.push(format!("{constant:e} is proven, too")),
            Err(problem) => problems.push(problem),
        }
    }
    Ok(problems)
}

/// Prints how many times each constant is as large as the least one that is proven: what the table has as `spare`, for who changes it.
pub(crate) fn print_least() -> Result<(), Failure> {
    for entry in table::read()? {
        let Claim::Gappa(proof) = &entry.claim else { continue };
        let holds = |spare: f64| {
            let problem = |problem: String| Failure::Unavailable(format!("{}: {problem}", entry.name).into());
            let value = proof.value().map_err(problem)?;
            proves(&proof.script(proof.bolder(value, spare)).map_err(problem)?)
        };
        if !holds(1.0)? {
            println!("{}: NOT PROVEN", entry.name);
            continue;
        }
        // Between powers of two, then in a hundred steps.
        let mut low = 1.0;
        while low < 1e100 && holds(low * 2.0)? {
            low *= 2.0;
        }
        let mut high = low * 2.0;
        while high / low > 1.001 {
            let middle = 0.5 * (low + high);
            *(if holds(middle)? { &mut low } else { &mut high }) = middle;
        }
        println!("{}: {low:.6}", entry.name);
    }
    Ok(())
}

fn gappa() -> Command {
    let mut command = Command::new("gappa");
    // Bits of the bounds that it computes with.
    command.arg("-Eprecision=300");
    command
}

fn has_gappa() -> Result<bool, Failure> {
    let mut command = gappa();
    match command.arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status() {
        Ok(status) => Ok(status.success()),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(false),
        Err(error) => Err(step::start_failure(&command, error)),
    }
}

/// Whether Gappa proves a script.
fn proves(script: &str) -> Result<bool, Failure> {
    let mut command = gappa();
    command.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::null());
    let start = |error| step::start_failure(&gappa(), error);
    let mut child = command.spawn().map_err(start)?;
    let written = child.stdin.take().expect("standard input is piped").write_all(script.as_bytes());
    let status = child.wait().map_err(start)?;
    written.map_err(start)?;
    Ok(status.success())
}

/// How many constants there are of each kind.
#[derive(Debug, Default, Clone, PartialEq, Eq)]
struct Counts {
    gappa: usize,
    tight: usize,
    written: usize,
    free: usize,
    exact: usize,
    open: usize,
    lines: usize,
}

impl Counts {
    fn of(entries: &[Entry]) -> Self {
        let mut counts = Self::default();
        for entry in entries {
            counts.lines += entry.lines.len();
            match &entry.claim {
                Claim::Gappa(proof) => {
                    counts.gappa += 1;
                    counts.tight += usize::from(proof.spare.is_none());
                }
                Claim::Written { .. } => counts.written += 1,
                Claim::Free => counts.free += 1,
                Claim::Exact => counts.exact += 1,
                Claim::Open => counts.open += 1,
            }
        }
        counts
    }

    /// As `docs/PROOFS.md` has them.
    #[cfg(test)]
    fn table(&self) -> String {
        let Self { gappa, tight, written, free, exact, open, lines } = self;
        let others = gappa - tight;
        format!(
            "| what is known | entries |\n| --- | --- |\n| proven by Gappa, one bit less is not | {tight} |\n| proven by Gappa, larger than it has to be by a \
             factor that is recorded | {others} |\n| proven in writing, with a test against exact arithmetic | {written} |\n| decides nothing: proposes, chooses, or \
             is checked exactly afterwards | {free} |\n| no rounding: exact, or a limit of input | {exact} |\n| open: counted in the code, no script | {open} |\n| \
             all, with {lines} lines of sources | {} |\n",
            self.all()
        )
    }

    fn all(&self) -> usize {
        self.gappa + self.written + self.free + self.exact + self.open
    }
}

impl std::fmt::Display for Counts {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { gappa, tight, written, free, exact, open, lines } = self;
        write!(
            f,
            "{} entries with {lines} lines: {gappa} proven by Gappa, of which {tight} to the last bit, {written} in writing with a test, \
             {free} decide nothing, {exact} are exact, {open} are open",
            self.all()
        )
    }
}

#[cfg(test)]
mod tests;
