//! The state of a search as bytes, from which a later run resumes it.
//!
//! | bytes | what |
//! | --- | --- |
//! | 8 | [`MAGIC`] |
//! | u32 | [`VERSION`] |
//! | u32 | options that matter: 1 for a fast search, else 0 |
//! | u128 | hash of the portal file (XXH3) |
//! | u64 | length of the body |
//! | body | where the search stands |
//! | u128 | hash of everything before |
//!
//! The body: u32 cells, u32 stage, u64 done; u32 counters, each a length in a byte, its name, a u64; u32 pairs that
//! are undecided, two u32 each; the rows of what is visible, then those of what is possible beyond that, then those
//! of what may be seen through each portal, forwards and backwards, all coded as rows of maps are. All numbers are
//! little-endian.
//!
//! A state is only of use to the search that it came from. [`decode`] refuses what was made from other portals, with
//! other options or by another version, and what is damaged. It takes memory for the graph that the caller has,
//! whatever the bytes claim, and time in proportion to bytes and graph. A forged state with correct hashes
//! is accepted: hashes detect accidents, not intent.

mod body;

pub use body::named_counters;

use sightlines_cells::{CellGraph, Convex};
use sightlines_stabtree::ConvexState;
use xxhash_rust::xxh3::xxh3_128;

/// What a state begins with. The first byte is not text, and its line ends reveal changes by text tools.
pub const MAGIC: [u8; 8] = *b"\x8ESLVIS\r\n";

/// Changes with the layout, and whenever the stages of the search change their meaning.
pub const VERSION: u32 = 1;

/// Bytes of the hash behind a state.
pub const HASH_LEN: usize = 16;

const HEADER: usize = 40;

/// What a state belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StateKey {
    portals: u128,
    fast: bool,
}

impl StateKey {
    /// The bytes of the portal file, and whether the search is a fast one. The number of threads does not matter.
    pub fn new(portal_file: &[u8], fast: bool) -> Self {
        Self { portals: xxh3_128(portal_file), fast }
    }
}

/// Why bytes are not the state of this search.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum StateError {
    /// They begin differently.
    #[error("this is no state of a search")]
    Magic,
    /// Another version of the program wrote it.
    #[error("the state is of version {found}, this program continues version {VERSION}")]
    Version {
        /// The version that it states.
        found: u32,
    },
    /// There are more or fewer bytes than it states.
    #[error("the state has {found} bytes instead of {needed}: it is cut off or has something behind it")]
    Length {
        /// Bytes there are.
        found: usize,
        /// Bytes that it claims.
        needed: u64,
    },
    /// Bytes have changed.
    #[error("the state is damaged: its hash does not match")]
    Damaged,
    /// The portal file is another, or has been changed.
    #[error("the state is of another portal file, or the file has changed since")]
    OtherPortals,
    /// The search was fast and should not be, or the other way round.
    #[error("the state is of a {} search, which this is not", if *fast { "fast" } else { "full" })]
    OtherOptions {
        /// Whether the search was a fast one.
        fast: bool,
    },
    /// Something in the body cannot be.
    #[error("the state is not sound at byte {at}: {what}")]
    Unsound {
        /// Where in the bytes.
        at: usize,
        /// What is wrong there.
        what: &'static str,
    },
    /// The search rejects it.
    #[error("the state does not fit the portals")]
    Unfit,
}

/// The bytes of a state. The same state gives the same bytes.
///
/// # Panics
/// If it has more undecided pairs than 32 bits count, or 2³² cells.
pub fn encode(key: &StateKey, state: &ConvexState) -> Vec<u8> {
    let mut out = MAGIC.to_vec();
    out.extend(VERSION.to_le_bytes());
    out.extend(u32::from(key.fast).to_le_bytes());
    out.extend(key.portals.to_le_bytes());
    out.extend([0; 8]);
    body::append(state, &mut out);
    with_hash(&out)
}

/// The bytes of a state, which lack the hash behind them, with the length and the hash that are right for them. For
/// tests, which break what is inside.
pub fn with_hash(bytes: &[u8]) -> Vec<u8> {
    let mut out = bytes.to_vec();
    if let Some(len) = out.get_mut(HEADER - 8..HEADER) {
        len.copy_from_slice(&((bytes.len() - HEADER) as u64).to_le_bytes());
    }
    let hash = xxh3_128(&out);
    out.extend(hash.to_le_bytes());
    out
}

/// Reads the state of a search of a graph.
///
/// # Errors
/// [`StateError`], the first that applies in the order: no state, version, length, damage, portals, options, body.
pub fn decode(key: &StateKey, graph: &CellGraph<Convex>, bytes: &[u8]) -> Result<ConvexState, StateError> {
    if !is_state(bytes) {
        return Err(StateError::Magic);
    }
    let found = bytes.len();
    let short = StateError::Length { found, needed: (HEADER + HASH_LEN) as u64 };
    let number = |at: usize| bytes.get(at..at + 4).and_then(|b| b.first_chunk()).map(|b| u32::from_le_bytes(*b));
    // The version comes first, as all that follows depends on it.
    let version = number(8).ok_or(short.clone())?;
    if version != VERSION {
        return Err(StateError::Version { found: version });
    }
    let options = number(12).ok_or(short.clone())?;
    let portals =
        bytes.get(16..).and_then(|b| b.first_chunk()).map(|b| u128::from_le_bytes(*b)).ok_or(short.clone())?;
    let len = bytes.get(32..).and_then(|b| b.first_chunk()).map(|b| u64::from_le_bytes(*b)).ok_or(short)?;
    let needed = len.saturating_add((HEADER + HASH_LEN) as u64);
    if needed != found as u64 {
        return Err(StateError::Length { found, needed });
    }
    let (content, hash) = bytes.split_at(found - HASH_LEN);
    if hash != xxh3_128(content).to_le_bytes() {
        return Err(StateError::Damaged);
    }
    if portals != key.portals {
        return Err(StateError::OtherPortals);
    }
    match options {
        0 | 1 if (options == 1) == key.fast => {}
        0 | 1 => return Err(StateError::OtherOptions { fast: options == 1 }),
        _ => return Err(StateError::Unsound { at: 12, what: "there are no such options" }),
    }
    body::read(content, HEADER, graph.n_cells(), 2 * graph.portals().len())
}

/// Whether bytes begin as a state does.
pub fn is_state(bytes: &[u8]) -> bool {
    bytes.starts_with(&MAGIC)
}
