//! A thread that prepares what a viewer in a cell will need.
//!
//! Nothing here knows what is prepared: [`crate::Walkthrough`] prepares outlooks, and anything else that is made for
//! the viewers of a cell, such as a buffer of what hides what, can be prepared in the same way.

use crate::cache::Cache;
use sightlines_pvs::CellId;
use std::collections::{BTreeSet, VecDeque};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::thread;

/// Makes what the viewers of a cell need. May be slow: it is called on a thread of its own.
pub trait Prepare: Send + 'static {
    /// What is made.
    type Prepared: Send + Sync + 'static;
    /// Why it is not.
    type Error: Send + 'static;

    /// Makes it for the viewers of one cell.
    ///
    /// # Errors
    /// If it cannot be made. It is asked for again when a viewer still needs it.
    fn prepare(&mut self, cell: CellId) -> Result<Self::Prepared, Self::Error>;

    /// The memory that it takes, in bytes.
    fn n_bytes(prepared: &Self::Prepared) -> usize;
}

/// What was made for a cell, with its bytes.
type Made<P> = (CellId, Result<(<P as Prepare>::Prepared, usize), <P as Prepare>::Error>);

/// Things made for cells on another thread, and kept within a budget of bytes.
///
/// No method waits: not for the thread, not for a lock.
pub struct Prefetcher<P: Prepare> {
    cache: Cache<P::Prepared>,
    /// Lists of cells, the most urgent first; a list replaces the one before. `None` once the thread is gone.
    wishes: Option<Sender<Vec<CellId>>>,
    made: Receiver<Made<P>>,
    /// The last list, to send no list twice.
    last: Vec<CellId>,
    /// Cells of the last list that have not come yet.
    awaited: BTreeSet<CellId>,
    error: Option<(CellId, P::Error)>,
    n_made: u64,
}

impl<P: Prepare> Prefetcher<P> {
    /// Starts the thread. `budget` bounds the bytes of what is kept, besides the last thing
    /// made and what is pinned.
    ///
    /// The thread ends when this is dropped, after what it is about to make.
    pub fn new(maker: P, budget: usize) -> Self {
        let (wishes, wished) = channel();
        let (done, made) = channel();
        thread::spawn(move || work(maker, &wished, &done));
        Self {
            cache: Cache::new(budget),
            wishes: Some(wishes),
            made,
            last: Vec::new(),
            awaited: BTreeSet::new(),
            error: None,
            n_made: 0,
        }
    }

    /// Takes in what was made in the meantime.
    pub fn poll(&mut self) {
        loop {
            match self.made.try_recv() {
                Ok((cell, Ok((thing, n_bytes)))) => {
                    self.awaited.remove(&cell);
                    self.n_made += 1;
                    self.cache.add(cell, thing, n_bytes);
                }
                Ok((cell, Err(error))) => {
                    self.awaited.remove(&cell);
                    // It may be wished for again.
                    self.last.clear();
                    self.error = Some((cell, error));
                }
                Err(TryRecvError::Empty) => return,
                Err(TryRecvError::Disconnected) => {
                    self.wishes = None;
                    self.awaited.clear();
                    return;
                }
            }
        }
    }

    /// What was made for a cell, if it is there; it counts as used now.
    pub fn get(&mut self, cell: CellId) -> Option<Arc<P::Prepared>> {
        self.cache.get(cell).cloned()
    }

    /// Whether a cell's is there.
    pub fn has(&self, cell: CellId) -> bool {
        self.cache.has(cell)
    }

    /// From now on what was made for these cells stays whatever the budget says: those that are needed at the same time must not
    /// drop each other.
    pub fn pin(&mut self, cells: &[CellId]) {
        self.cache.pin(cells);
    }

    /// Says which cells will be needed, the most urgent first. Those that are not there are made in this order; what
    /// was wished for before and is not wished for now is forgotten.
    pub fn wish(&mut self, cells: &[CellId]) {
        let wanted = || cells.iter().copied().filter(|&cell| !self.cache.has(cell));
        // Nothing new since the last list: what is left of it is being made.
        if wanted().next().is_none() || wanted().eq(self.last.iter().copied().filter(|c| self.awaited.contains(c))) {
            return;
        }
        let list: Vec<CellId> = wanted().collect();
        self.last.clone_from(&list);
        self.awaited = list.iter().copied().collect();
        if self.wishes.as_ref().is_some_and(|wishes| wishes.send(list).is_err()) {
            self.wishes = None;
        }
    }

    /// Takes in what was made, and tells whether all that was wished for last is there.
    pub fn is_idle(&mut self) -> bool {
        self.poll();
        self.awaited.is_empty()
    }

    /// The last failure, and of which cell; asking takes it away.
    pub fn take_error(&mut self) -> Option<(CellId, P::Error)> {
        self.error.take()
    }

    /// Whether the thread is still there. It goes only if making something panics.
    pub fn is_working(&self) -> bool {
        self.wishes.is_some()
    }

    /// Bytes of what is kept.
    pub fn n_bytes(&self) -> usize {
        self.cache.n_bytes()
    }

    /// Number of things kept.
    pub fn n_kept(&self) -> usize {
        self.cache.len()
    }

    /// Things made so far.
    pub fn n_made(&self) -> u64 {
        self.n_made
    }

    /// Things dropped so far, to keep to the budget.
    pub fn n_dropped(&self) -> u64 {
        self.cache.n_dropped()
    }
}

/// The thread: makes what is on the newest list, until nobody listens.
fn work<P: Prepare>(mut maker: P, wished: &Receiver<Vec<CellId>>, done: &Sender<Made<P>>) {
    let mut list: VecDeque<CellId> = VecDeque::new();
    loop {
        // With nothing to do it waits for a list; else it only looks whether there is a newer one.
        let newer = match list.is_empty() {
            true => wished.recv().map_err(|_| TryRecvError::Disconnected),
            false => wished.try_recv(),
        };
        match newer {
            Ok(newer) => {
                list = newer.into();
                continue;
            }
            Err(TryRecvError::Disconnected) => return,
            Err(TryRecvError::Empty) => {}
        }
        let Some(cell) = list.pop_front() else { continue };
        let made = maker.prepare(cell).map(|thing| {
            let n_bytes = P::n_bytes(&thing);
            (thing, n_bytes)
        });
        if done.send((cell, made)).is_err() {
            return;
        }
    }
}
