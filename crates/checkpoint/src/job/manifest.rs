//! The manifest of a job, as JSON.

use crate::inputs::InputFile;
use crate::key::Key;
use serde::{Deserialize, Serialize};

/// What the field `format` says.
const FORMAT: &str = "sightlines-job";
const VERSION: u32 = 1;

/// Units of a phase that one process does.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ShardPlan {
    /// The first unit.
    pub begin: usize,
    /// Behind the last one.
    pub end: usize,
    /// The predicted cost of all of them.
    pub cost: f64,
}

/// A phase, and its shards.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PhasePlan {
    /// Its name.
    pub name: String,
    /// How many units it has.
    pub n_units: usize,
    /// Ranges of units, which follow each other.
    pub shards: Vec<ShardPlan>,
}

/// What a job is. Shards are numbered from 0 through all phases.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    format: String,
    version: u32,
    /// The version of the program that planned it.
    pub program: String,
    /// The key of its results.
    pub key: String,
    /// The command that makes the same output without a job: words of the command line behind the name of the program.
    pub command: Vec<String>,
    /// The folder that relative paths of the command start from.
    pub folder: String,
    /// The files that it reads.
    pub inputs: Vec<InputFile>,
    /// How many shards a phase is cut into, at most.
    pub max_shards: usize,
    /// The phases that are known.
    pub phases: Vec<PhasePlan>,
}

impl Manifest {
    /// A job whose phases are not known yet.
    pub fn new(program: &str, key: Key, command: Vec<String>, folder: String, max_shards: usize) -> Self {
        let (format, program, key) = (FORMAT.to_owned(), program.to_owned(), key.to_string());
        let (inputs, phases) = (Vec::new(), Vec::new());
        Self { format, version: VERSION, program, key, command, folder, inputs, max_shards, phases }
    }

    /// The manifest in a text, and its key; or what is wrong with it.
    pub(crate) fn parse(text: &[u8]) -> Result<(Self, Key), String> {
        /// What is read first.
        #[derive(Deserialize)]
        struct Form {
            format: Option<String>,
            version: Option<u32>,
        }
        let form: Form = serde_json::from_slice(text).map_err(|error| error.to_string())?;
        match (form.format.as_deref(), form.version) {
            (Some(FORMAT), Some(VERSION)) => {}
            (Some(FORMAT), Some(version)) => return Err(format!("version {version} of the manifest is not supported")),
            _ => return Err("this is no manifest of a job".to_owned()),
        }
        let manifest: Self = serde_json::from_slice(text).map_err(|error| error.to_string())?;
        let key = manifest.check()?;
        Ok((manifest, key))
    }

    pub(crate) fn to_text(&self) -> String {
        // Nothing in it can fail: texts and finite numbers.
        serde_json::to_string_pretty(self).map_or_else(|_| String::new(), |text| text + "\n")
    }

    /// Checks all that others rely on.
    pub(crate) fn check(&self) -> Result<Key, String> {
        for (k, PhasePlan { name, n_units, shards }) in self.phases.iter().enumerate() {
            let is_name = !name.is_empty() && name.bytes().all(|byte| byte.is_ascii_lowercase() || byte == b'-');
            if !is_name || name.len() > 100 || self.phases[..k].iter().any(|other| other.name == *name) {
                return Err(format!(
                    "phase {k}: the name is not of small letters and hyphens, or another phase has it"
                ));
            }
            let mut end = 0;
            for (shard, plan) in shards.iter().enumerate() {
                if plan.begin != end || plan.end < end || !plan.cost.is_finite() || plan.cost < 0.0 {
                    return Err(format!(
                        "phase {k}: shard {shard} does not begin where the one before it ends, or its cost is no number"
                    ));
                }
                end = plan.end;
            }
            if shards.is_empty() || end != *n_units {
                return Err(format!("phase {k}: the shards do not end with the last unit"));
            }
        }
        self.key.parse().map_err(|error| format!("key: {error}"))
    }

    /// How many shards all known phases have.
    pub fn n_shards(&self) -> usize {
        self.phases.iter().map(|phase| phase.shards.len()).sum()
    }

    /// The numbers of the shards of a phase.
    pub fn shards_of(&self, phase: usize) -> std::ops::Range<usize> {
        let n = |phase: &PhasePlan| phase.shards.len();
        let begin: usize = self.phases.iter().take(phase).map(n).sum();
        begin..begin + self.phases.get(phase).map_or(0, n)
    }

    /// The phase of a shard, by its place, and what the shard is.
    pub(crate) fn shard(&self, shard: usize) -> Option<(usize, &ShardPlan)> {
        let mut begin = 0;
        for (place, phase) in self.phases.iter().enumerate() {
            if let Some(plan) = phase.shards.get(shard.checked_sub(begin)?) {
                return Some((place, plan));
            }
            begin += phase.shards.len();
        }
        None
    }
}
