//! Who may soon see whom, for servers.

use crate::border;
use crate::handle::{self, Handle, lock};
use crate::info::{SlBox, below};
use crate::query::put_ids;
use crate::status::{Failure, Outcome, SL_ERROR_FILE, SL_ERROR_FORMAT, SlStatus, guard};
use crate::table::{SlTable, table};
use sightlines_geometry::Aabb;
use sightlines_relevance::{Body, Changes, Player, PlayerRole, ReachOptions, Reaches, Relevance, RelevanceOptions};
use std::ffi::c_char;
use std::sync::{Arc, Mutex, MutexGuard};

/// What follows the bodies of a game from tick to tick: who may see whom before news of it can arrive. One call at a time.
pub struct SlRelevance {
    _opaque: [u8; 0],
}

/// A watch over bodies, and how many there were in the last tick.
pub(crate) struct Watch {
    relevance: Relevance,
    players: Vec<Player>,
}

impl Handle for SlRelevance {
    type State = Mutex<Watch>;
    const TAG: u64 = 0x51_6872_656c_6576;
    const NAME: &'static str = "relevance";
}

/// The watch behind a handle, for one call.
///
/// # Safety
/// As for [`handle::behind`].
unsafe fn watch<'a>(handle: *const SlRelevance) -> Result<MutexGuard<'a, Watch>, Failure> {
    // SAFETY: as for this function.
    lock(unsafe { handle::behind(handle)? }, SlRelevance::NAME)
}

/// Is told of others.
pub const SL_PLAYER_VIEWS: u32 = 1;
/// Others are told of it.
pub const SL_PLAYER_IS_SEEN: u32 = 2;

/// Somebody who sees and is seen, and how far they may get until the answer counts. All lengths are in scene units; in a table of the
/// plane z does not count. A box or a length that is none (NaN, negative) is somebody of whom nothing is known: everybody is told of
/// them, and they of everybody.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlPlayer {
    /// Where the eyes can be: where the game may put its camera now, but for `arm`.
    pub eyes: SlBox,
    /// All that can be seen of the body, with what it carries.
    pub seen: SlBox,
    /// How far any part of it may get: speed times (round trip + interpolation + tick).
    pub reach: f64,
    /// How far a camera that follows the body may be from the eyes; 0 for eyes in the head.
    pub arm: f64,
    /// The teams of which it is told wherever they are, as bits: bit t for team t, bit 0 for those without one.
    pub sees_always: u64,
    /// Its team, 1 to 63; 0 for none.
    pub team: u32,
    /// `SL_PLAYER_VIEWS`, `SL_PLAYER_IS_SEEN`, or both with `|`.
    pub flags: u32,
}

impl border::Plain for SlPlayer {}

impl SlPlayer {
    fn body(&self) -> Body {
        let [eyes, seen] = [&self.eyes, &self.seen].map(|b| Aabb { min: b.min, max: b.max });
        Body { eyes, seen, reach: self.reach, arm: self.arm }
    }

    fn player(&self, i: usize) -> Result<Player, Failure> {
        if self.flags & !(SL_PLAYER_VIEWS | SL_PLAYER_IS_SEEN) != 0 {
            return Err(Failure::argument(format!("player {i} has flags that are none: {}", self.flags)));
        }
        let role = PlayerRole {
            team: below(self.team, 64, "team")? as u8,
            sees_always: self.sees_always,
            views: self.flags & SL_PLAYER_VIEWS != 0,
            is_seen: self.flags & SL_PLAYER_IS_SEEN != 0,
        };
        Ok(Player { body: self.body(), role })
    }
}

/// How `sl_relevance_update` answers; `sl_relevance_default_options` fills it. Set `struct_size` to `sizeof(sl_relevance_options)`
/// before.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlRelevanceOptions {
    /// The size of this structure, in bytes.
    pub struct_size: usize,
    /// For how many seconds somebody stays shown who may no longer be seen.
    pub hold: f64,
    /// How far a body may move until it is placed again, in scene units along each axis: more is less work, and shows bodies sooner.
    pub slack: f64,
    /// Up to which distance ways through portals count from the exact place of a body, in scene units, for reaches of such ways.
    pub walk: f64,
    /// How many bodies are placed exactly in a tick; the others are shown sooner, never later.
    pub looks: u64,
}

impl border::Plain for SlRelevanceOptions {}

/// What changed in a tick.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SlChanges {
    /// Pairs that are shown from now on: `sl_relevance_gained`.
    pub gained_count: usize,
    /// Pairs that are no longer shown: `sl_relevance_lost`.
    pub lost_count: usize,
    /// Bodies that were placed exactly.
    pub look_count: usize,
    /// Bodies that had moved and were not, as no look was left; their answers are coarser.
    pub coarse_count: usize,
    /// Bodies of which nothing is known: outside of the cells, or without a valid box. They are shown to all.
    pub outside_count: usize,
}

/// What suits most games with this table.
///
/// @param options  Where they go.
/// @return `SL_OK`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_relevance_default_options(
    table: *const SlTable,
    options: *mut SlRelevanceOptions,
) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let RelevanceOptions { hold, looks, slack, walk } = RelevanceOptions::of(unsafe { self::table(table)? });
        let (struct_size, looks) = (size_of::<SlRelevanceOptions>(), looks as u64);
        // SAFETY: pointers are as the header demands.
        unsafe {
            let options_are = SlRelevanceOptions { struct_size, hold, slack, walk, looks };
            border::put_sized(options, options_are, "the place of the options")
        }
    })
}

/// Makes what follows bodies through a table.
///
/// @param table      The table, which may be freed before. It is copied.
/// @param reaches    The path of a file that `sightlines relevance` made of this table. Null: the usual reaches are found now, which takes
///                   seconds for thousands of cells.
/// @param options    Null for those of `sl_relevance_default_options`.
/// @param relevance  Where the handle goes; free it with `sl_relevance_free`. Null is stored there if the call fails.
/// @return `SL_OK`, `SL_ERROR_FILE`, `SL_ERROR_FORMAT` for a file that is damaged or of another table, or `SL_ERROR_ARGUMENT` for a table without
///         places.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_relevance_new(
    table: *const SlTable,
    reaches: *const c_char,
    options: *const SlRelevanceOptions,
    relevance: *mut *mut SlRelevance,
) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        unsafe { border::put(relevance, std::ptr::null_mut(), "the place of the relevance")? };
        // SAFETY: pointers are as the header demands.
        let table = unsafe { self::table(table)? };
        let options = if options.is_null() {
            RelevanceOptions::of(table)
        } else {
            // SAFETY: pointers are as the header demands.
            let given = unsafe { border::read_sized(options, "the options")? };
            let SlRelevanceOptions { hold, slack, walk, looks, .. } = *given;
            RelevanceOptions { hold, looks: usize::try_from(looks).unwrap_or(usize::MAX), slack, walk }
        };
        let reaches = if reaches.is_null() {
            let found = Reaches::of(table, &ReachOptions::default());
            found.map_err(|error| Failure::argument(error.to_string()))?
        } else {
            // SAFETY: pointers are as the header demands.
            let path = unsafe { border::text(reaches, "the path of the reaches")? };
            let failed = |status, error: &dyn std::fmt::Display| Failure::new(status, format!("{path}: {error}"));
            let bytes = std::fs::read(path).map_err(|error| failed(SL_ERROR_FILE, &error))?;
            Reaches::from_bytes(&bytes, table).map_err(|error| failed(SL_ERROR_FORMAT, &error))?
        };
        let relevance_of = Relevance::new(Arc::new(table.clone()), reaches, options);
        let made = handle::give::<SlRelevance>(Mutex::new(Watch { relevance: relevance_of, players: Vec::new() }));
        // SAFETY: pointers are as the header demands.
        unsafe { border::put(relevance, made, "the place of the relevance") }
    })
}

/// Frees it.
///
/// @param relevance  What no other thread is using, or null, for which nothing is done.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_relevance_free(relevance: *mut SlRelevance) {
    // SAFETY: pointers are as the header demands.
    guard(|| unsafe { handle::free(relevance) });
}

/// Finds who is shown to whom from now on. Somebody is told by the place in the list, from tick to tick. Call it at least once within the
/// tick that reaches were computed for.
///
/// Errs towards shown: whoever comes to see somebody was told of them as long before as both take for their reach.
///
/// @param now      Seconds, of any beginning, not descending.
/// @param players  All that move, and whoever watches.
/// @param count    Number of players.
/// @param changes  Where what changed goes; may be null.
/// @return `SL_OK`, or `SL_ERROR_ARGUMENT` for a team or flags that are none. After a failure the last answer stands.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_relevance_update(
    relevance: *mut SlRelevance,
    now: f64,
    players: *const SlPlayer,
    count: usize,
    changes: *mut SlChanges,
) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let (mut watch, given) = unsafe { (watch(relevance)?, border::slice(players, count, "the players")?) };
        if !changes.is_null() {
            border::place(changes, "the place of the changes")?;
        }
        given.iter().enumerate().try_for_each(|(i, player)| player.player(i).map(drop))?;
        let Watch { relevance, players } = &mut *watch;
        players.clear();
        for (i, player) in given.iter().enumerate() {
            players.push(player.player(i)?);
        }
        let Changes { gained, lost, n_looks, n_coarse, n_outside } = relevance.update(now, players);
        let found = SlChanges {
            gained_count: gained.len(),
            lost_count: lost.len(),
            look_count: *n_looks,
            coarse_count: *n_coarse,
            outside_count: *n_outside,
        };
        // SAFETY: pointers are as the header demands.
        if changes.is_null() { Ok(()) } else { unsafe { border::put(changes, found, "the place of the changes") } }
    })
}

/// The pairs that are shown since the last tick: two numbers each, who is told and of whom.
///
/// @param numbers   Where the numbers go, or null to ask for how many there are.
/// @param capacity  How many numbers the buffer has room for; 0 if it is null.
/// @param count     Where their number goes: twice that of the pairs.
/// @return `SL_OK`, or `SL_ERROR_BUFFER`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_relevance_gained(
    relevance: *const SlRelevance,
    numbers: *mut u32,
    capacity: usize,
    count: *mut usize,
) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let watch = unsafe { watch(relevance)? };
        // SAFETY: pointers are as the header demands.
        unsafe { border::put_all(watch.relevance.changes().gained.as_flattened(), numbers, capacity, count) }
    })
}

/// The pairs that are no longer shown since the last tick: two numbers each, who is told and of whom.
///
/// @param numbers   Where the numbers go, or null to ask for how many there are.
/// @param capacity  How many numbers the buffer has room for; 0 if it is null.
/// @param count     Where their number goes: twice that of the pairs.
/// @return `SL_OK`, or `SL_ERROR_BUFFER`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_relevance_lost(
    relevance: *const SlRelevance,
    numbers: *mut u32,
    capacity: usize,
    count: *mut usize,
) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let watch = unsafe { watch(relevance)? };
        // SAFETY: pointers are as the header demands.
        unsafe { border::put_all(watch.relevance.changes().lost.as_flattened(), numbers, capacity, count) }
    })
}

/// Whether a pair was shown in the last tick: what a server asks before it transmits.
///
/// @param to     Who is told.
/// @param of     Of whom.
/// @param shown  Where 1 goes if so, else 0.
/// @return `SL_OK`, or `SL_ERROR_ARGUMENT` if there was no such player.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_relevance_is_shown(
    relevance: *const SlRelevance,
    to: u32,
    of: u32,
    shown: *mut u32,
) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let watch = unsafe { watch(relevance)? };
        let n = watch.players.len();
        below(to, n, "player")?;
        below(of, n, "player")?;
        // SAFETY: pointers are as the header demands.
        unsafe { border::put(shown, u32::from(watch.relevance.is_shown(to, of)), "the place of the answer") }
    })
}

/// Who was shown to somebody in the last tick, ascending.
///
/// @param to        Who is told.
/// @param players   Where their numbers go, or null to ask for how many there are.
/// @param capacity  Number of players that the buffer has room for; 0 if it is null.
/// @param count     Where their number goes.
/// @return `SL_OK`, `SL_ERROR_ARGUMENT` if there was no such player, or `SL_ERROR_BUFFER`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_relevance_shown_to(
    relevance: *const SlRelevance,
    to: u32,
    players: *mut u32,
    capacity: usize,
    count: *mut usize,
) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let watch = unsafe { watch(relevance)? };
        below(to, watch.players.len(), "player")?;
        let n = watch.relevance.shown_to(to).count();
        // SAFETY: pointers are as the header demands.
        unsafe { put_ids(watch.relevance.shown_to(to), n, players, capacity, count) }
    })
}

/// Two bodies of the caller.
///
/// # Safety
/// As for the module `border`.
unsafe fn bodies(a: *const SlPlayer, b: *const SlPlayer) -> Result<[Body; 2], Failure> {
    // SAFETY: as for this function.
    unsafe { Ok([border::read(a, "the first body")?.body(), border::read(b, "the second body")?.body()]) }
}

/// Whether a body, within the reach of both, may come to see another: with both placed exactly, whatever the last tick said. Teams and flags
/// do not count.
///
/// @param a    Who sees.
/// @param b    Who is seen.
/// @param may  Where 1 goes if so, else 0.
/// @return `SL_OK`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_relevance_may_see_within(
    relevance: *mut SlRelevance,
    a: *const SlPlayer,
    b: *const SlPlayer,
    may: *mut u32,
) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let (mut watch, [a, b]) = unsafe { (watch(relevance)?, bodies(a, b)?) };
        border::place(may, "the place of the answer")?;
        let found = watch.relevance.may_see_within(&a, &b);
        // SAFETY: pointers are as the header demands.
        unsafe { border::put(may, u32::from(found), "the place of the answer") }
    })
}

/// A lower bound of the time until a body may see another: 0 if it may at once, infinity if it never may.
///
/// @param a        Who sees; its reach does not count.
/// @param b        Who is seen; its reach does not count.
/// @param speeds   Two numbers: the top speeds of both, in scene units a second.
/// @param seconds  Where the time goes.
/// @return `SL_OK`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_relevance_time_to_sight(
    relevance: *mut SlRelevance,
    a: *const SlPlayer,
    b: *const SlPlayer,
    speeds: *const f64,
    seconds: *mut f64,
) -> SlStatus {
    guard(|| -> Outcome {
        // SAFETY: pointers are as the header demands.
        let (mut watch, [a, b]) = unsafe { (watch(relevance)?, bodies(a, b)?) };
        // SAFETY: pointers are as the header demands; an array has the alignment of what is in it.
        let speeds = *unsafe { border::read(speeds.cast::<[f64; 2]>(), "the speeds")? };
        border::place(seconds, "the place of the time")?;
        let found = watch.relevance.time_to_sight(&a, &b, speeds);
        // SAFETY: pointers are as the header demands.
        unsafe { border::put(seconds, found, "the place of the time") }
    })
}
