//! Pointers of the caller: what is read from them and written to them.
//!
//! Every function here takes pointers that are null, or that point to as many things as stated. Null, misaligned and overlong ones are
//! refused; that the others point to live memory is up to the caller, as the header states.

use crate::status::{Failure, Outcome, SL_ERROR_BUFFER, SL_ERROR_NULL, SL_ERROR_VERSION};
use std::ffi::{CStr, c_char};

fn null(what: &str) -> Failure {
    Failure::new(SL_ERROR_NULL, format!("{what} is null"))
}

fn check<T>(pointer: *const T, what: &str) -> Outcome {
    if pointer.is_null() {
        return Err(null(what));
    }
    if !pointer.is_aligned() {
        return Err(Failure::argument(format!("{what} is not aligned to {} bytes", align_of::<T>())));
    }
    Ok(())
}

/// `n` things of type `T`, of which every pattern of bits is a value.
///
/// # Safety
/// As for the module; nobody writes to them while the slice lives.
pub(crate) unsafe fn slice<'a, T: Plain>(pointer: *const T, n: usize, what: &str) -> Result<&'a [T], Failure> {
    if n == 0 {
        return Ok(&[]);
    }
    check(pointer, what)?;
    if n > isize::MAX as usize / size_of::<T>().max(1) {
        return Err(Failure::argument(format!("{what} cannot hold {n} items")));
    }
    // SAFETY: neither null nor misaligned nor too long; every pattern of bits is a `T`; the caller vouches for the memory.
    Ok(unsafe { std::slice::from_raw_parts(pointer, n) })
}

/// A structure of which every pattern of bits is a value.
///
/// # Safety
/// As for [`slice`].
pub(crate) unsafe fn read<'a, T: Plain>(pointer: *const T, what: &str) -> Result<&'a T, Failure> {
    check(pointer, what)?;
    // SAFETY: neither null nor misaligned; every pattern of bits is a `T`; the caller vouches for the memory.
    Ok(unsafe { &*pointer })
}

/// Types of which every pattern of bits is a value.
pub(crate) trait Plain: Copy {}
impl Plain for u8 {}
impl Plain for u32 {}
impl Plain for u64 {}
impl Plain for f32 {}
impl Plain for f64 {}
impl<T: Plain, const N: usize> Plain for [T; N] {}

/// A text that ends with a zero byte.
///
/// # Safety
/// As for the module; the text ends somewhere, and nobody writes to it while it is read.
pub(crate) unsafe fn text<'a>(pointer: *const c_char, what: &str) -> Result<&'a str, Failure> {
    check(pointer, what)?;
    // SAFETY: not null; the caller vouches for the memory and the zero byte.
    let text = unsafe { CStr::from_ptr(pointer) };
    text.to_str().map_err(|_| Failure::argument(format!("{what} is not UTF-8")))
}

/// Stores one value.
///
/// # Safety
/// As for the module.
pub(crate) unsafe fn put<T>(to: *mut T, value: T, what: &str) -> Outcome {
    check(to, what)?;
    // SAFETY: neither null nor misaligned; the caller vouches for the memory. What was there is not dropped: C has no destructors.
    unsafe { to.write(value) };
    Ok(())
}

/// A place for one value, checked before the work whose result goes there.
pub(crate) fn place<T>(to: *mut T, what: &str) -> Outcome {
    check(to, what)
}

/// Checks a structure whose first field is its size, as the caller knows it.
///
/// # Safety
/// As for the module.
pub(crate) unsafe fn check_sized<T>(at: *const T, what: &str) -> Outcome {
    check(at, what)?;
    // SAFETY: neither null nor misaligned; the first field of every such structure is its size.
    let (stated, needed) = (unsafe { at.cast::<usize>().read() }, size_of::<T>());
    if stated == needed {
        return Ok(());
    }
    let message =
        format!("struct_size of {what} is {stated} instead of {needed}: set it to sizeof, or versions differ");
    Err(Failure::new(SL_ERROR_VERSION, message))
}

/// Stores such a structure.
///
/// # Safety
/// As for the module.
pub(crate) unsafe fn put_sized<T>(to: *mut T, value: T, what: &str) -> Outcome {
    // SAFETY: as for this function.
    unsafe {
        check_sized(to, what)?;
        put(to, value, what)
    }
}

/// Reads such a structure.
///
/// # Safety
/// As for [`slice`].
pub(crate) unsafe fn read_sized<'a, T: Plain>(from: *const T, what: &str) -> Result<&'a T, Failure> {
    // SAFETY: as for this function.
    unsafe {
        check_sized(from, what)?;
        read(from, what)
    }
}

/// Stores the number of items, and the items if there is room for all of them. With a null buffer of capacity 0 only the number.
///
/// # Safety
/// As for the module.
pub(crate) unsafe fn put_each<T>(
    n: usize,
    items: impl Iterator<Item = T>,
    to: *mut T,
    capacity: usize,
    count: *mut usize,
) -> Outcome {
    // SAFETY: as for this function.
    unsafe { put(count, n, "the place of the count")? };
    if to.is_null() && capacity == 0 {
        return Ok(());
    }
    check(to, "the buffer")?;
    if n > capacity {
        let message = format!("the buffer has room for {capacity} items, and {n} are needed");
        return Err(Failure::new(SL_ERROR_BUFFER, message));
    }
    for (i, item) in items.take(n).enumerate() {
        // SAFETY: below the capacity, for which the caller vouches.
        unsafe { to.add(i).write(item) };
    }
    Ok(())
}

/// Stores a slice as [`put_each`] does.
///
/// # Safety
/// As for the module.
pub(crate) unsafe fn put_all<T: Copy>(items: &[T], to: *mut T, capacity: usize, count: *mut usize) -> Outcome {
    // SAFETY: as for this function.
    unsafe { put_each(items.len(), items.iter().copied(), to, capacity, count) }
}

/// Stores the length of a text in bytes, and the text with a zero byte behind it if there is room for both.
///
/// # Safety
/// As for the module.
pub(crate) unsafe fn put_text(text: &str, to: *mut c_char, capacity: usize, length: *mut usize) -> Outcome {
    // SAFETY: as for this function.
    unsafe { put(length, text.len(), "the place of the length")? };
    if to.is_null() && capacity == 0 {
        return Ok(());
    }
    check(to, "the buffer")?;
    let needed = text.len() + 1;
    if needed > capacity {
        let message = format!("the buffer has room for {capacity} bytes, and {needed} are needed");
        return Err(Failure::new(SL_ERROR_BUFFER, message));
    }
    for (i, byte) in text.bytes().chain([0]).enumerate() {
        // SAFETY: below the capacity, for which the caller vouches.
        unsafe { to.add(i).write(byte as c_char) };
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::status::{SL_ERROR_ARGUMENT, SL_OK};
    use std::ptr;

    fn status(outcome: Outcome) -> i32 {
        outcome.map_or_else(|failure| failure.status, |()| SL_OK)
    }

    #[test]
    fn buffers_are_written_whole_or_not_at_all() {
        let (mut buffer, mut n) = ([7u32; 4], 0usize);
        // SAFETY: all pointers are to live memory of the stated size.
        let mut put = |items: &[u32], to: *mut u32, capacity| unsafe { status(put_all(items, to, capacity, &mut n)) };
        let at = buffer.as_mut_ptr();
        assert_eq!(put(&[1, 2, 3], ptr::null_mut(), 0), SL_OK);
        assert_eq!(put(&[1, 2, 3], ptr::null_mut(), 3), SL_ERROR_NULL);
        assert_eq!(put(&[1, 2, 3], at, 2), SL_ERROR_BUFFER);
        assert_eq!(put(&[1, 2, 3], at.wrapping_byte_add(1), 3), SL_ERROR_ARGUMENT);
        assert_eq!((n, buffer), (3, [7; 4]));
        // SAFETY: as above.
        assert_eq!(unsafe { status(put_all(&[1, 2, 3], at, 3, &mut n)) }, SL_OK);
        assert_eq!((n, buffer), (3, [1, 2, 3, 7]));
        // SAFETY: as above.
        assert_eq!(unsafe { status(put_all(&[1], at, 3, ptr::null_mut())) }, SL_ERROR_NULL);
    }

    #[test]
    fn texts_end_with_a_zero() {
        let (mut buffer, mut n) = ([1 as c_char; 4], 0usize);
        // SAFETY: all pointers are to live memory of the stated size.
        assert_eq!(unsafe { status(put_text("abc", buffer.as_mut_ptr(), 3, &mut n)) }, SL_ERROR_BUFFER);
        assert_eq!((n, buffer), (3, [1; 4]));
        // SAFETY: as above.
        assert_eq!(unsafe { status(put_text("abc", buffer.as_mut_ptr(), 4, &mut n)) }, SL_OK);
        // SAFETY: as above, and it ends with a zero.
        assert_eq!(unsafe { text(buffer.as_ptr(), "it") }.ok(), Some("abc"));
        // SAFETY: null is refused.
        assert!(unsafe { text(ptr::null(), "it") }.is_err());
    }

    #[test]
    fn slices_are_checked() {
        let numbers = [1.0f64, 2.0];
        // SAFETY: all pointers are null, refused, or to live memory of the stated size.
        unsafe {
            assert_eq!(slice(numbers.as_ptr(), 2, "they").ok(), Some(&numbers[..]));
            assert_eq!(slice::<f64>(ptr::null(), 0, "they").ok(), Some(&[][..]));
            assert!(slice::<f64>(ptr::null(), 1, "they").is_err());
            assert!(slice(numbers.as_ptr(), usize::MAX, "they").is_err());
            assert!(slice(numbers.as_ptr().wrapping_byte_add(4), 1, "they").is_err());
        }
    }
}
