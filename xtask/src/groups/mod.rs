//! The heavy parts of the gate, and which of them a change brings.
//!
//! Every change passes the core. A group runs beside it if a recent commit changed something that it depends on, the newest
//! change first, as long as there is time; and whatever was changed, when it is its turn: each has one in [`TURNS`] gates.

mod history;
mod layers;

use crate::programs::Program;
use crate::step::Failure;
use history::History;
use layers::{Layers, crate_of};
use std::collections::BTreeSet;
use std::fmt;
use std::path::Path;

/// In how many gates every group has a turn.
pub(crate) const TURNS: usize = 6;

/// What the groups of one gate may take together, in seconds on two quiet cores: what the core leaves of half an hour.
pub(crate) const SECONDS: u32 = 780;

/// A heavy part of the gate.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Group {
    pub(crate) name: &'static str,
    pub(crate) what: &'static str,
    /// The crates that it is about, by their names in `docs/layers.toml`. What these use counts too.
    crates: &'static [&'static str],
    /// Files and folders of its own.
    paths: &'static [&'static str],
    /// The gates in which it is run whatever was changed: those whose number leaves this rest.
    turn: usize,
    /// How long it takes on two quiet cores, when the core has run.
    pub(crate) seconds: u32,
    /// Packages of Debian that it needs beside a compiler and Chromium; without them its tests skip.
    packages: &'static [&'static str],
    pub(crate) work: Work,
}

/// What a group runs.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Work {
    /// Modules of test programs, which the core leaves out.
    Tests(&'static [Modules]),
    /// A step of its own.
    Step(Step),
}

/// Modules of one test program.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Modules {
    /// The name of the program, as `cargo test --test` takes it.
    pub(crate) program: &'static str,
    /// The folder of its sources.
    sources: &'static str,
    pub(crate) modules: &'static [&'static str],
}

impl Modules {
    /// Whether these are modules of `program`.
    pub(crate) fn is_of(&self, program: &Program) -> bool {
        program.is_integration && program.name == self.program && Path::new(&program.source).starts_with(self.sources)
    }
}

/// Steps that are no test programs of the workspace.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Step {
    Alone,
    Package,
    Program,
    Benches,
    Lab,
    Python,
    Bevy,
    Proofs,
    Wasm,
}

/// All groups. Each turn has two, and the first four.
pub(crate) const GROUPS: [Group; 14] = [
    Group {
        name: "slurm",
        what: "builds that a cluster shares, by Slurm on the loopback device",
        crates: &["checkpoint"],
        paths: &["crates/cli/src/commands/job/", "crates/cli/src/kept.rs", "crates/cli/tests/cli/slurm.rs"],
        turn: 0,
        seconds: 40,
        packages: &["munge", "slurm-wlm"],
        work: Work::Tests(&[Modules { program: "cli", sources: "crates/cli/tests/cli", modules: &["slurm::"] }]),
    },
    Group {
        name: "engines",
        what: "maps in engines of Quake and Doom, and behind a node builder",
        crates: &["formats"],
        paths: &[
            "crates/bake/src/quake/",
            "crates/bake/src/reject/",
            "crates/cli/src/commands/vis/",
            "crates/cli/src/commands/reject/",
            "crates/cli/tests/cli/engine.rs",
            "crates/cli/tests/cli/node_builder.rs",
            "crates/cli/tests/cli/common/engine.rs",
            "docs/guides/udb/",
        ],
        turn: 1,
        seconds: 20,
        packages: &["darkplaces-server", "zdbsp", "dsda-doom"],
        work: Work::Tests(&[Modules {
            program: "cli",
            sources: "crates/cli/tests/cli",
            modules: &["engine::", "node_builder::"],
        }]),
    },
    Group {
        name: "sanitizers",
        what: "programs in C and C++ under sanitizers and valgrind",
        crates: &["capi"],
        paths: &["crates/capi/"],
        turn: 2,
        seconds: 60,
        packages: &["valgrind"],
        work: Work::Tests(&[Modules { program: "capi", sources: "crates/capi/tests/capi", modules: &["programs::"] }]),
    },
    Group {
        name: "browser",
        what: "pages in Chromium, the package for browsers in Node",
        crates: &["viewer"],
        paths: &[
            "crates/cli/src/commands/view/",
            "crates/cli/tests/cli/view.rs",
            "crates/cli/tests/cli/view_pictures.rs",
            "crates/testkit/src/browser.rs",
            "integrations/web/",
            "tests/tests/workspace/viewer.rs",
            "tests/tests/workspace/viewer_check.js",
            "tests/tests/workspace/viewer_isovist.rs",
            "tests/tests/workspace/viewer_isovist.js",
            "tests/tests/workspace/viewer_methods.rs",
            "tests/tests/workspace/web_package.rs",
        ],
        turn: 3,
        seconds: 120,
        packages: &["nodejs"],
        work: Work::Tests(&[
            Modules {
                program: "workspace",
                sources: "tests/tests/workspace",
                modules: &["viewer::", "viewer_isovist::", "viewer_methods::", "web_package::"],
            },
            Modules { program: "cli", sources: "crates/cli/tests/cli", modules: &["view_pictures::"] },
        ]),
    },
    Group {
        name: "stops",
        what: "work that is stopped, goes on, and is shared by processes",
        crates: &["checkpoint", "tiles"],
        paths: &[
            "crates/cli/src/commands/job/",
            "crates/bake/src/world/",
            "crates/cli/src/kept.rs",
            "crates/cli/src/memory.rs",
            "crates/progress/src/memory.rs",
            "crates/cli/src/interrupt.rs",
            "crates/cli/tests/cli/resume.rs",
            "crates/cli/tests/cli/jobs.rs",
            "crates/cli/tests/cli/workers.rs",
            "crates/cli/tests/cli/memory.rs",
        ],
        turn: 4,
        seconds: 60,
        packages: &[],
        work: Work::Tests(&[Modules {
            program: "cli",
            sources: "crates/cli/tests/cli",
            modules: &["resume::", "jobs::", "workers::", "memory::"],
        }]),
    },
    Group {
        name: "alone",
        what: "each published crate compiles without its neighbours' features",
        crates: &["cli", "capi"],
        paths: &["Cargo.toml", "Cargo.lock"],
        turn: 5,
        seconds: 100,
        packages: &[],
        work: Work::Step(Step::Alone),
    },
    Group {
        name: "package",
        what: "published crates compile from their packages alone",
        crates: &["cli", "capi"],
        paths: &["Cargo.toml", "Cargo.lock", "xtask/src/package.rs"],
        turn: 0,
        seconds: 45,
        packages: &[],
        work: Work::Step(Step::Package),
    },
    Group {
        name: "program",
        what: "tests of the program as it is installed by default, optimized",
        crates: &["cli"],
        paths: &["crates/cli/"],
        turn: 1,
        seconds: 200,
        packages: &[],
        work: Work::Step(Step::Program),
    },
    Group {
        name: "benches",
        what: "each bench once, for its checks",
        crates: &["sightlines"],
        paths: &["benches/"],
        turn: 2,
        seconds: 250,
        packages: &[],
        work: Work::Step(Step::Benches),
    },
    Group {
        name: "lab",
        what: "sweeps to where methods fail, and charts, in short",
        crates: &["sightlines"],
        paths: &["lab/"],
        turn: 3,
        seconds: 250,
        packages: &[],
        work: Work::Step(Step::Lab),
    },
    Group {
        name: "python",
        what: "the Python package: lints, wheel, types, tests",
        crates: &[
            "bake",
            "cells",
            "formats",
            "geometry",
            "isovist",
            "multifocal",
            "packed",
            "progress",
            "pvs",
            "relevance",
            "scenes",
            "strip",
            "visibility-graph",
        ],
        paths: &["python/", "xtask/src/python.rs"],
        turn: 4,
        seconds: 200,
        packages: &[],
        work: Work::Step(Step::Python),
    },
    Group {
        name: "bevy",
        what: "the plugin for Bevy: lints, tests, pictures",
        crates: &["eye-to-cell", "geometry", "packed", "pvs", "relevance", "walkthrough"],
        paths: &["integrations/bevy/", "xtask/src/bevy.rs"],
        turn: 5,
        seconds: 480,
        packages: &[],
        work: Work::Step(Step::Bevy),
    },
    Group {
        name: "proofs",
        what: "bounds on rounding, proven by Gappa",
        crates: &[
            "area-light",
            "bake",
            "bsp",
            "certificates",
            "eye-to-cell",
            "from-region",
            "frame",
            "isovist",
            "line-space",
            "multifocal-gpu",
            "relevance",
            "stabtree",
            "verify",
        ],
        paths: &["xtask/proofs/", "xtask/src/proofs/"],
        turn: 0,
        seconds: 40,
        packages: &["gappa"],
        work: Work::Step(Step::Proofs),
    },
    Group {
        name: "wasm",
        what: "the module of WebAssembly in Node and Chromium, against the program",
        crates: &["wasm"],
        paths: &[
            "integrations/web/playground/",
            "integrations/web/src/bake.js",
            "integrations/web/test/chromium.mjs",
            "integrations/web/test/module.test.mjs",
            "tests/tests/workspace/web_module.rs",
            "xtask/src/wasm.rs",
        ],
        turn: 0,
        seconds: 400,
        packages: &["nodejs"],
        work: Work::Step(Step::Wasm),
    },
];

/// Why a group runs, or not.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Why {
    Asked,
    Turn,
    /// A file that it depends on was changed so many commits ago; 0 is a change that is not committed.
    Changed {
        ago: usize,
        file: String,
    },
    /// What was changed is not known.
    NoHistory,
    /// It would run, but the gate has no time left for it; its turn comes in so many gates.
    NoTime {
        ago: usize,
        file: String,
        turn_in: usize,
    },
    Unchanged {
        turn_in: usize,
    },
    /// It was to run, but the machine was too slow.
    Late,
}

impl Why {
    pub(crate) fn runs(&self) -> bool {
        matches!(self, Self::Asked | Self::Turn | Self::Changed { .. } | Self::NoHistory)
    }

    /// Whether the group runs however late it is.
    pub(crate) fn must(&self) -> bool {
        matches!(self, Self::Asked | Self::Turn)
    }
}

impl fmt::Display for Why {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ago = |ago: &usize| match ago {
            0 => "not committed yet".to_owned(),
            1 => "the last commit".to_owned(),
            n => format!("{n} commits ago"),
        };
        match self {
            Self::Asked => f.write_str("everything is asked for"),
            Self::Turn => f.write_str("it is its turn"),
            Self::Changed { ago: n, file } => write!(f, "{file} changed, {}", ago(n)),
            Self::NoHistory => f.write_str("git does not tell what was changed"),
            Self::NoTime { ago: n, file, turn_in } => {
                write!(f, "no time is left ({file} changed, {}); its turn is in {turn_in}", ago(n))
            }
            Self::Late => f.write_str("the machine was busy, and it got too late"),
            Self::Unchanged { turn_in } => {
                write!(f, "nothing it depends on changed in {} commits; its turn is in {turn_in}", history::WINDOW)
            }
        }
    }
}

/// What becomes of each group, in the order of the table.
pub(crate) fn plan(all: bool) -> Result<Vec<(Group, Why)>, Failure> {
    if all {
        return Ok(GROUPS.iter().map(|&group| (group, Why::Asked)).collect());
    }
    Ok(choose(&GROUPS, &Layers::read()?, History::read().as_ref(), history::turn()?, SECONDS))
}

/// The packages of Debian that the groups which run need.
pub(crate) fn packages(plan: &[(Group, Why)]) -> Vec<&'static str> {
    plan.iter().filter(|(_, why)| why.runs()).flat_map(|(group, _)| group.packages).copied().collect()
}

/// Chooses among `groups`: those whose turn it is, then those that a change brings, the newest change first, while the time lasts.
fn choose(
    groups: &[Group],
    layers: &Layers,
    history: Option<&History>,
    turn: usize,
    seconds: u32,
) -> Vec<(Group, Why)> {
    let turn_in = |group: &Group| (group.turn + TURNS - turn % TURNS) % TURNS;
    let of_turn = groups.iter().filter(|group| turn_in(group) == 0);
    let mut left = seconds.saturating_sub(of_turn.map(|group| group.seconds).sum());
    let mut chosen: Vec<(usize, Why)> = Vec::new();
    let mut changed = Vec::new();
    for (at, group) in groups.iter().enumerate() {
        let turn_in = turn_in(group);
        if turn_in == 0 {
            chosen.push((at, Why::Turn));
            continue;
        }
        let Some(history) = history else {
            chosen.push((at, Why::NoHistory));
            continue;
        };
        let below = layers.below(group.crates);
        match history.last(|file| group.depends_on(file, &below)) {
            Some((ago, file)) => changed.push((ago, turn_in, at, file.to_owned())),
            None => chosen.push((at, Why::Unchanged { turn_in })),
        }
    }
    // Of those that one commit brings, the one that waits longest for its turn.
    changed.sort_by_key(|&(ago, turn_in, at, _)| (ago, TURNS - turn_in, at));
    for (ago, turn_in, at, file) in changed {
        let fits = groups[at].seconds <= left;
        left -= if fits { groups[at].seconds } else { 0 };
        chosen.push((at, if fits { Why::Changed { ago, file } } else { Why::NoTime { ago, file, turn_in } }));
    }
    chosen.sort_by_key(|&(at, _)| at);
    chosen.into_iter().map(|(at, why)| (groups[at], why)).collect()
}

impl Group {
    /// Whether a change of `file` can change what this group finds.
    ///
    /// * `below`: its crates and all that they use
    fn depends_on(&self, file: &str, below: &BTreeSet<String>) -> bool {
        let is_own = self
            .paths
            .iter()
            .any(|path| file.strip_prefix(path).is_some_and(|rest| rest.is_empty() || path.ends_with('/')));
        is_own || crate_of(file).is_some_and(|name| below.contains(name))
    }

    /// The modules of test programs that it runs.
    pub(crate) fn modules(&self) -> &'static [Modules] {
        match self.work {
            Work::Tests(modules) => modules,
            Work::Step(_) => &[],
        }
    }
}

#[cfg(test)]
mod tests;
