//! Statuses, the message of the last failure, and the guard that stops panics.

use std::any::Any;
use std::cell::RefCell;
use std::ffi::{CString, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// What became of a call: `SL_OK`, or the reason why nothing was done. See `sl_last_error` for the reason in words.
pub type SlStatus = i32;

/// The call did what it is for.
pub const SL_OK: SlStatus = 0;
/// A pointer that is needed is null.
pub const SL_ERROR_NULL: SlStatus = 1;
/// A number is out of range, a text is not UTF-8, or a pointer is not aligned for its type.
pub const SL_ERROR_ARGUMENT: SlStatus = 2;
/// What was given is no handle of the kind that is needed.
pub const SL_ERROR_HANDLE: SlStatus = 3;
/// The buffer is too small. Its needed size was stored, and nothing was written to it.
pub const SL_ERROR_BUFFER: SlStatus = 4;
/// A file cannot be read or written.
pub const SL_ERROR_FILE: SlStatus = 5;
/// Bytes are no table: damaged, truncated, of another kind, or of a newer version.
pub const SL_ERROR_FORMAT: SlStatus = 6;
/// Geometry cannot be used: a coordinate that is no finite number or too large, an index without a vertex.
pub const SL_ERROR_GEOMETRY: SlStatus = 7;
/// A table cannot be made of this scene with these options.
pub const SL_ERROR_BAKE: SlStatus = 8;
/// The callback cancelled.
pub const SL_ERROR_CANCELLED: SlStatus = 9;
/// Numbers are no view: see `sl_view`.
pub const SL_ERROR_VIEW: SlStatus = 10;
/// Another thread is inside a call with the same handle.
pub const SL_ERROR_BUSY: SlStatus = 11;
/// The header and the library, or the size of a structure, are of versions that do not fit together.
pub const SL_ERROR_VERSION: SlStatus = 12;
/// There is nothing of that name or number.
pub const SL_ERROR_NOT_FOUND: SlStatus = 13;
/// The library was built without this part.
pub const SL_ERROR_UNSUPPORTED: SlStatus = 14;
/// A defect of the library: a panic was caught. Please report it.
pub const SL_ERROR_INTERNAL: SlStatus = 15;
/// A defect of the library struck an earlier call that used this handle. Only freeing it does anything.
pub const SL_ERROR_POISONED: SlStatus = 16;

/// No cell, object, portal, group or method: a number that none of them has.
pub const SL_NONE: u32 = u32::MAX;

/// The names of the statuses, by number.
const NAMES: [&std::ffi::CStr; 17] = [
    c"SL_OK",
    c"SL_ERROR_NULL",
    c"SL_ERROR_ARGUMENT",
    c"SL_ERROR_HANDLE",
    c"SL_ERROR_BUFFER",
    c"SL_ERROR_FILE",
    c"SL_ERROR_FORMAT",
    c"SL_ERROR_GEOMETRY",
    c"SL_ERROR_BAKE",
    c"SL_ERROR_CANCELLED",
    c"SL_ERROR_VIEW",
    c"SL_ERROR_BUSY",
    c"SL_ERROR_VERSION",
    c"SL_ERROR_NOT_FOUND",
    c"SL_ERROR_UNSUPPORTED",
    c"SL_ERROR_INTERNAL",
    c"SL_ERROR_POISONED",
];

/// Why a call does nothing.
#[derive(Debug)]
pub(crate) struct Failure {
    pub(crate) status: SlStatus,
    pub(crate) message: String,
}

impl Failure {
    pub(crate) fn new(status: SlStatus, message: impl Into<String>) -> Self {
        Self { status, message: message.into() }
    }

    pub(crate) fn argument(message: impl Into<String>) -> Self {
        Self::new(SL_ERROR_ARGUMENT, message)
    }
}

pub(crate) type Outcome = Result<(), Failure>;

thread_local! {
    static LAST: RefCell<CString> = RefCell::default();
}

fn remember(message: String) {
    let mut bytes = message.into_bytes();
    bytes.retain(|&byte| byte != 0);
    let message = CString::new(bytes).unwrap_or_default();
    // At the end of a thread there may be no place for it any more.
    let _ = LAST.try_with(|last| last.try_borrow_mut().map(|mut last| *last = message));
}

/// Runs the body of a function of the border: turns failures and panics into statuses, and keeps the message.
pub(crate) fn guard(body: impl FnOnce() -> Outcome) -> SlStatus {
    // What a body changes is behind a lock that a panic poisons, or a buffer of the caller, of which nothing is assumed.
    match catch_unwind(AssertUnwindSafe(body)) {
        Ok(Ok(())) => SL_OK,
        Ok(Err(failure)) => {
            remember(failure.message);
            failure.status
        }
        Err(panic) => {
            remember(format!("a defect of the library: {}", words_of(&*panic)));
            // Dropping what was thrown could throw again.
            std::mem::forget(panic);
            SL_ERROR_INTERNAL
        }
    }
}

fn words_of(panic: &(dyn Any + Send)) -> &str {
    let owned = panic.downcast_ref::<String>().map(String::as_str);
    owned.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("a panic without a message")
}

/// The reason in words why the last call on this thread that failed did so, in English, for developers.
///
/// @return A text that ends with a zero byte; empty if no call failed yet. It is valid until the next call that fails on the
///         same thread, and until that thread ends. Calls that succeed leave it as it is. Never null.
#[unsafe(no_mangle)]
pub extern "C" fn sl_last_error() -> *const c_char {
    let last = LAST.try_with(|last| last.try_borrow().map_or(c"".as_ptr(), |last| last.as_ptr()));
    last.unwrap_or(c"".as_ptr())
}

/// The name of a status, such as "SL_ERROR_BUFFER".
///
/// @param status  What a function returned.
/// @return A text that ends with a zero byte and is always valid; "unknown status" for other numbers.
#[unsafe(no_mangle)]
pub extern "C" fn sl_status_name(status: SlStatus) -> *const c_char {
    let name = usize::try_from(status).ok().and_then(|i| NAMES.get(i).copied());
    name.unwrap_or(c"unknown status").as_ptr()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::ffi::CStr;

    fn last() -> String {
        // SAFETY: the text is valid until the next failure on this thread.
        unsafe { CStr::from_ptr(sl_last_error()) }.to_string_lossy().into_owned()
    }

    #[test]
    fn failures_and_panics_become_statuses_with_messages() {
        assert_eq!((guard(|| Ok(())), last().as_str()), (SL_OK, ""));
        assert_eq!(guard(|| Err(Failure::argument("cell 9\0 of 3"))), SL_ERROR_ARGUMENT);
        assert_eq!(last(), "cell 9 of 3");
        assert_eq!((guard(|| Ok(())), last().as_str()), (SL_OK, "cell 9 of 3"));
        assert_eq!(guard(|| panic!("out of {}", "order")), SL_ERROR_INTERNAL);
        assert_eq!(last(), "a defect of the library: out of order");
        assert_eq!(guard(|| std::panic::panic_any(7)), SL_ERROR_INTERNAL);
        assert_eq!(last(), "a defect of the library: a panic without a message");
        std::thread::spawn(|| assert_eq!(last(), "")).join().expect("each thread has its own");
    }

    #[test]
    fn every_status_has_its_name() {
        // SAFETY: names are static.
        let name = |status| unsafe { CStr::from_ptr(sl_status_name(status)) };
        assert_eq!(name(SL_ERROR_BUFFER), c"SL_ERROR_BUFFER");
        assert_eq!(name(SL_ERROR_POISONED), c"SL_ERROR_POISONED");
        assert_eq!((name(-1), name(17)), (c"unknown status", c"unknown status"));
    }
}
