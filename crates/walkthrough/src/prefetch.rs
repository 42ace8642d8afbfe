//! Data for the viewers of a cell, prepared in advance: on another thread, or in that of the caller.
//!
//! The data can be of any kind: [`crate::Walkthrough`] prepares subgraphs, and other data for the viewers of a cell,
//! such as an occlusion buffer, can be prepared in the same way.

use crate::cache::Cache;
use sightlines_pvs::CellId;
use std::collections::{BTreeSet, VecDeque};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::thread;

/// Makes the data for the viewers of a cell. May be slow: by default it is called on another thread.
pub trait Prepare: Send + 'static {
    /// What is made.
    type Prepared: Send + Sync + 'static;
    /// Why it cannot be made.
    type Error: Send + 'static;

    /// Makes it for the viewers of one cell.
    ///
    /// # Errors
    /// If it cannot be made. It is requested again while it is needed.
    fn prepare(&mut self, cell: CellId) -> Result<Self::Prepared, Self::Error>;

    /// Its size in memory, in bytes.
    fn n_bytes(prepared: &Self::Prepared) -> usize;
}

/// The data of a cell, with its size in bytes.
type Made<P> = (CellId, Result<(<P as Prepare>::Prepared, usize), <P as Prepare>::Error>);

/// Where data is made.
enum Maker<P: Prepare> {
    /// On another thread.
    Thread {
        /// Lists of cells, the most urgent first; a list replaces the one before. `None` once the thread is gone.
        wishes: Option<Sender<Vec<CellId>>>,
        made: Receiver<Made<P>>,
    },
    /// On the thread that requests it.
    Caller(P),
}

/// Makes data for cells on another thread, and keeps it within a byte budget.
///
/// No method waits, neither for the thread nor for a lock, unless there is no thread ([`Prefetcher::without_thread`]).
pub struct Prefetcher<P: Prepare> {
    cache: Cache<P::Prepared>,
    maker: Maker<P>,
    /// The last list, so that no list is sent twice.
    last: Vec<CellId>,
    /// Cells of the last list that have not arrived yet.
    awaited: BTreeSet<CellId>,
    error: Option<(CellId, P::Error)>,
    n_made: u64,
}

impl<P: Prepare> Prefetcher<P> {
    /// Starts the thread. `budget` bounds the bytes in memory, except for the last item made and pinned items.
    ///
    /// The thread ends when this is dropped, after the item that it is making.
    pub fn new(maker: P, budget: usize) -> Self {
        let (wishes, wished) = channel();
        let (done, made) = channel();
        thread::spawn(move || work(maker, &wished, &done));
        Self::of(Maker::Thread { wishes: Some(wishes), made }, budget)
    }

    /// Makes data on the thread of the caller: [`Prefetcher::wish`] returns when all of it is made. For measurements that
    /// have to be repeatable, and for targets without threads.
    pub fn without_thread(maker: P, budget: usize) -> Self {
        Self::of(Maker::Caller(maker), budget)
    }

    fn of(maker: Maker<P>, budget: usize) -> Self {
        Self { cache: Cache::new(budget), maker, last: Vec::new(), awaited: BTreeSet::new(), error: None, n_made: 0 }
    }

    /// Receives what was made in the meantime.
    pub fn poll(&mut self) {
        while let Maker::Thread { wishes, made } = &mut self.maker {
            match made.try_recv() {
                Ok(made) => self.receive(made),
                Err(TryRecvError::Empty) => return,
                Err(TryRecvError::Disconnected) => {
                    *wishes = None;
                    self.awaited.clear();
                    return;
                }
            }
        }
    }

    fn receive(&mut self, (cell, made): Made<P>) {
        self.awaited.remove(&cell);
        match made {
            Ok((thing, n_bytes)) => {
                self.n_made += 1;
                self.cache.add(cell, thing, n_bytes);
            }
            Err(error) => {
                // It may be requested again.
                self.last.clear();
                self.error = Some((cell, error));
            }
        }
    }

    /// The data of a cell, if it is in memory; it counts as used now.
    pub fn get(&mut self, cell: CellId) -> Option<Arc<P::Prepared>> {
        self.cache.get(cell).cloned()
    }

    /// Whether the data of a cell is in memory.
    pub fn has(&self, cell: CellId) -> bool {
        self.cache.has(cell)
    }

    /// Pins the data of these cells regardless of the budget: items that are needed at the same time must not evict
    /// each other.
    pub fn pin(&mut self, cells: &[CellId]) {
        self.cache.pin(cells);
    }

    /// Requests data for cells, the most urgent first. Missing data is made in this order; earlier requests that are
    /// not repeated are dropped.
    pub fn wish(&mut self, cells: &[CellId]) {
        let wanted = || cells.iter().copied().filter(|&cell| !self.cache.has(cell));
        // Nothing new since the last list: the rest of it is being made.
        if wanted().next().is_none() || wanted().eq(self.last.iter().copied().filter(|c| self.awaited.contains(c))) {
            return;
        }
        let list: Vec<CellId> = wanted().collect();
        self.last.clone_from(&list);
        self.awaited = list.iter().copied().collect();
        if let Maker::Thread { wishes, .. } = &mut self.maker {
            if wishes.as_ref().is_some_and(|wishes| wishes.send(list).is_err()) {
                *wishes = None;
            }
            return;
        }
        for cell in list {
            if let Maker::Caller(maker) = &mut self.maker {
                let made = make(maker, cell);
                self.receive(made);
            }
        }
    }

    /// Receives what was made, and returns whether everything in the last request is in memory.
    pub fn is_idle(&mut self) -> bool {
        self.poll();
        self.awaited.is_empty()
    }

    /// Takes the last failure, with its cell.
    pub fn take_error(&mut self) -> Option<(CellId, P::Error)> {
        self.error.take()
    }

    /// Whether items can still be made. The thread ends early only if making an item panics.
    pub fn is_working(&self) -> bool {
        !matches!(self.maker, Maker::Thread { wishes: None, .. })
    }

    /// Bytes in memory.
    pub fn n_bytes(&self) -> usize {
        self.cache.n_bytes()
    }

    /// Number of items in memory.
    pub fn n_kept(&self) -> usize {
        self.cache.len()
    }

    /// Number of items made so far.
    pub fn n_made(&self) -> u64 {
        self.n_made
    }

    /// Number of items evicted so far to stay within the budget.
    pub fn n_dropped(&self) -> u64 {
        self.cache.n_dropped()
    }
}

/// The thread: makes the items of the newest list until the receiver is gone.
fn work<P: Prepare>(mut maker: P, wished: &Receiver<Vec<CellId>>, done: &Sender<Made<P>>) {
    let mut list: VecDeque<CellId> = VecDeque::new();
    loop {
        // If idle, it waits for a list; otherwise it only checks for a newer one.
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
        if done.send(make(&mut maker, cell)).is_err() {
            return;
        }
    }
}

fn make<P: Prepare>(maker: &mut P, cell: CellId) -> Made<P> {
    let made = maker.prepare(cell).map(|thing| {
        let n_bytes = P::n_bytes(&thing);
        (thing, n_bytes)
    });
    (cell, made)
}
