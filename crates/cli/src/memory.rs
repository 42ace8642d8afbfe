//! How much memory the program may use.

use crate::error::{Result, anyhow};
use crate::interrupt;
use crate::output::bytes;
use sightlines::progress::memory::{MemoryBudget, MemorySize, Needs, TooLarge, n_threads};
use std::io::ErrorKind;

/// The memory that a command may use.
#[derive(Debug, Clone, Copy, Default, clap::Args)]
pub(crate) struct MemoryArgs {
    /// Memory that the program may use, such as 2GiB or 800MB. What is known to need more is refused before the work, or done with fewer threads; if more is
    /// used after all, the work is stopped so that --resume can go on with more memory or fewer threads; exit code 4
    #[arg(long, help_heading = "Method", value_name = "SIZE")]
    memory: Option<MemorySize>,
}

impl MemoryArgs {
    /// A budget of so much.
    pub(crate) fn of(memory: Option<MemorySize>) -> Self {
        Self { memory }
    }

    /// This budget, or another if it is none.
    #[must_use]
    pub(crate) fn or(self, other: Self) -> Self {
        Self { memory: self.memory.or(other.memory) }
    }

    fn budget(self) -> MemoryBudget {
        MemoryBudget(self.memory.map(|MemorySize(limit)| limit))
    }

    /// Looks at the memory in use from here on, again and again, and ends the work under way if it is too much.
    pub(crate) fn watch(self) {
        if let Err(error) = self.budget().watch(interrupt::request_for_memory) {
            let about =
                if error.kind() == ErrorKind::Unsupported { "" } else { "the memory in use cannot be looked at: " };
            tracing::warn!("--memory: {about}{error}");
        }
    }

    /// As many of the threads as there is room for: 0 stands for one for each core.
    pub(crate) fn threads(self, threads: usize, needs: Needs) -> Result<usize> {
        let n = self.budget().threads(threads, needs).map_err(|TooLarge { needed, limit }| {
            interrupt::forget_memory();
            anyhow!("--memory {}: with one thread this needs about {} at least", bytes(limit), bytes(needed))
        })?;
        if let Some(MemorySize(limit)) = self.memory.filter(|_| n != threads) {
            let (all, limit) = (n_threads(threads), bytes(limit));
            tracing::warn!("--memory: {n} of {all} threads, for which there is room in {limit}");
        }
        Ok(n)
    }

    /// Whether there is room for that with one thread.
    pub(crate) fn has_room(self, needs: Needs) -> bool {
        self.budget().has_room(needs)
    }
}
