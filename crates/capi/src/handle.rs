//! Handles: what is behind the pointers that callers hold.

use crate::status::{Failure, SL_ERROR_BUSY, SL_ERROR_HANDLE, SL_ERROR_NULL, SL_ERROR_POISONED};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, TryLockError};

/// What a handle of that opaque type stands for.
pub(crate) trait Handle: Sized {
    /// What is behind it.
    type State: Send + Sync;
    /// What begins its memory, to be told from others.
    const TAG: u64;
    /// What it is called.
    const NAME: &'static str;
}

/// What begins the memory of a handle that was freed, as long as nobody else uses it.
const FREED: u64 = 0x05ee_dead_0ff4_ee00;

#[repr(C)]
struct Tagged<S> {
    tag: AtomicU64,
    state: S,
}

/// A new handle.
pub(crate) fn give<H: Handle>(state: H::State) -> *mut H {
    Box::into_raw(Box::new(Tagged { tag: AtomicU64::new(H::TAG), state })).cast()
}

/// What is behind a handle.
///
/// # Safety
/// Null, or a handle of any kind that is not freed while the reference lives.
pub(crate) unsafe fn behind<'a, H: Handle>(handle: *const H) -> Result<&'a H::State, Failure> {
    let name = H::NAME;
    if handle.is_null() {
        return Err(Failure::new(SL_ERROR_NULL, format!("the {name} is null")));
    }
    let tagged = handle.cast::<Tagged<H::State>>();
    if tagged.is_aligned() {
        // SAFETY: aligned, and every handle begins with a tag.
        let tag = unsafe { &*tagged.cast::<AtomicU64>() };
        if tag.load(Ordering::Relaxed) == H::TAG {
            // SAFETY: the tag states the type; the caller vouches that it lives.
            return Ok(unsafe { &(*tagged).state });
        }
    }
    Err(Failure::new(SL_ERROR_HANDLE, format!("this is no handle of a {name}, or it was freed")))
}

/// Frees a handle; null is nothing to free.
///
/// # Safety
/// Null, or a handle of any kind that is not freed and that nobody is using.
pub(crate) unsafe fn free<H: Handle>(handle: *mut H) -> Result<(), Failure> {
    if handle.is_null() {
        return Ok(());
    }
    // SAFETY: as for this function. Checks that it is of this kind.
    unsafe { behind::<H>(handle)? };
    let tagged = handle.cast::<Tagged<H::State>>();
    // SAFETY: it was given by `give`, as its tag states, and the caller vouches that nobody uses it.
    let owned = unsafe { Box::from_raw(tagged) };
    owned.tag.store(FREED, Ordering::Relaxed);
    Ok(())
}

/// The state of a handle that calls change: one call at a time.
pub(crate) fn lock<'a, S>(state: &'a Mutex<S>, name: &str) -> Result<MutexGuard<'a, S>, Failure> {
    state.try_lock().map_err(|error| match error {
        TryLockError::WouldBlock => Failure::new(
            SL_ERROR_BUSY,
            format!("the {name} is in use by another thread, or by this one, in a callback"),
        ),
        TryLockError::Poisoned(_) => {
            Failure::new(SL_ERROR_POISONED, format!("a defect struck an earlier call that changed the {name}: free it"))
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::status::{SL_ERROR_INTERNAL, guard};
    use std::ptr;

    struct Apple;
    struct Pear;

    impl Handle for Apple {
        type State = Mutex<u32>;
        const TAG: u64 = 1;
        const NAME: &'static str = "apple";
    }

    impl Handle for Pear {
        type State = Mutex<u32>;
        const TAG: u64 = 2;
        const NAME: &'static str = "pear";
    }

    #[test]
    fn handles_of_another_kind_are_refused() {
        let apple = give::<Apple>(Mutex::new(7));
        // SAFETY: a live handle, null, or an unaligned address that is not read.
        unsafe {
            assert_eq!(*behind(apple).expect("an apple").lock().expect("unused"), 7);
            assert_eq!(behind::<Pear>(apple.cast()).map(|_| ()).expect_err("no pear").status, SL_ERROR_HANDLE);
            assert_eq!(
                behind::<Pear>(ptr::without_provenance(13)).map(|_| ()).expect_err("no").status,
                SL_ERROR_HANDLE
            );
            assert_eq!(behind::<Apple>(ptr::null()).map(|_| ()).expect_err("nothing").status, SL_ERROR_NULL);
            assert!(free::<Pear>(apple.cast()).is_err() && free::<Pear>(ptr::null_mut()).is_ok());
            assert!(free(apple).is_ok());
        }
    }

    #[test]
    fn what_a_panic_left_is_not_used() {
        let state = Mutex::new(7);
        let taken = lock(&state, "thing").expect("unused");
        assert_eq!(lock(&state, "thing").map(drop).expect_err("in use").status, SL_ERROR_BUSY);
        drop(taken);
        let status = guard(|| {
            let _held = lock(&state, "thing")?;
            panic!("in the middle")
        });
        assert_eq!(status, SL_ERROR_INTERNAL);
        assert_eq!(lock(&state, "thing").map(drop).expect_err("poisoned").status, SL_ERROR_POISONED);
    }
}
