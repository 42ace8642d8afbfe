//! What a page calls. It reserves room for a question and the bytes that belong to it, writes them there, asks, and reads the answer from where it is told.

use crate::session::{PageAnswer, Session};
use sightlines_progress::{Observer, Progress};
use std::cell::RefCell;
use std::ops::ControlFlow;

#[derive(Default)]
struct Memory {
    session: Session,
    asked: Vec<u8>,
    json: Vec<u8>,
    bytes: Vec<u8>,
}

thread_local! {
    static MEMORY: RefCell<Memory> = RefCell::default();
}

#[link(wasm_import_module = "page")]
unsafe extern "C" {
    /// Told how far a bake is: the place and length of the name of the phase, and its share from 0 to 1.
    safe fn progress(phase: *const u8, length: usize, share: f64);
}

/// Tells the page. A page cancels by ending the worker.
struct Told;

impl Observer for Told {
    fn report(&self, Progress { phase, share, .. }: Progress) -> ControlFlow<()> {
        progress(phase.as_ptr(), phase.len(), share);
        ControlFlow::Continue(())
    }
}

/// Makes room for a question and its bytes, and says where. What was asked and answered before is dropped.
// SAFETY: no other symbol of the module has this name.
#[unsafe(no_mangle)]
extern "C" fn reserve(length: usize) -> *mut u8 {
    MEMORY.with_borrow_mut(|memory| {
        (memory.json, memory.bytes) = (Vec::new(), Vec::new());
        memory.asked.clear();
        memory.asked.resize(length, 0);
        memory.asked.as_mut_ptr()
    })
}

/// Answers what was written: a question of this length, and bytes after it.
// SAFETY: no other symbol of the module has this name.
#[unsafe(no_mangle)]
extern "C" fn answer(question: usize) {
    MEMORY.with_borrow_mut(|memory| {
        let asked = std::mem::take(&mut memory.asked);
        let (question, bytes) = asked.split_at(question.min(asked.len()));
        let PageAnswer { json, bytes } = memory.session.answer(question, bytes, &Told);
        (memory.json, memory.bytes) = (json.to_string().into_bytes(), bytes);
    });
}

/// Where the answer's JSON (0) or its bytes (1) are.
// SAFETY: no other symbol of the module has this name.
#[unsafe(no_mangle)]
extern "C" fn answer_place(part: u32) -> *const u8 {
    MEMORY.with_borrow(|memory| part_of(memory, part).as_ptr())
}

/// How long they are.
// SAFETY: no other symbol of the module has this name.
#[unsafe(no_mangle)]
extern "C" fn answer_length(part: u32) -> usize {
    MEMORY.with_borrow(|memory| part_of(memory, part).len())
}

fn part_of(memory: &Memory, part: u32) -> &[u8] {
    if part == 0 { &memory.json } else { &memory.bytes }
}
