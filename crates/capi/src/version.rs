//! The version of header and library.

use crate::status::{Failure, SL_ERROR_VERSION, SlStatus, guard};

/// The version of this header: 1,000,000 times the major, 1,000 times the minor number, and the patch.
pub const SL_VERSION: u32 = 1_000;

/// The version of the library.
///
/// @return It, in the form of `SL_VERSION`.
#[unsafe(no_mangle)]
pub extern "C" fn sl_version() -> u32 {
    SL_VERSION
}

/// Whether the library can serve a program that was compiled with a header of some version. Call it once at the start, as
/// `sl_check_version(SL_VERSION)`.
///
/// A library serves headers of the same major number that are not newer than itself; while the major number is 0, of the same
/// minor number.
///
/// @param header_version  `SL_VERSION`, as the program's header has it.
/// @return `SL_OK`, or `SL_ERROR_VERSION`: then no other function may be relied on.
#[unsafe(no_mangle)]
pub extern "C" fn sl_check_version(header_version: u32) -> SlStatus {
    guard(|| match serves(SL_VERSION, header_version) {
        true => Ok(()),
        false => {
            let text = |v: u32| format!("{}.{}.{}", v / 1_000_000, v / 1_000 % 1_000, v % 1_000);
            let (library, header) = (text(SL_VERSION), text(header_version));
            Err(Failure::new(SL_ERROR_VERSION, format!("the library is {library}, the header {header}")))
        }
    })
}

fn serves(library: u32, header: u32) -> bool {
    let family = |v: u32| if v < 1_000_000 { v / 1_000 } else { v / 1_000_000 * 1_000 };
    family(library) == family(header) && header <= library
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_version_is_that_of_the_package() {
        let numbers: Vec<u32> = env!("CARGO_PKG_VERSION").split('.').map(|n| n.parse().expect("a number")).collect();
        assert_eq!(SL_VERSION, 1_000_000 * numbers[0] + 1_000 * numbers[1] + numbers[2]);
        assert_eq!(sl_check_version(sl_version()), 0);
        assert_eq!(sl_check_version(SL_VERSION + 1_000), SL_ERROR_VERSION);
    }

    #[test]
    fn libraries_serve_older_headers_of_their_family() {
        let served = [(1_002, 1_001), (1_002, 1_002), (3_004_000, 3_001_007)];
        let others = [(1_002, 1_003), (2_000, 1_000), (1_000, 2_000), (1_000_000, 1_000), (3_000_000, 2_000_000)];
        assert!(served.iter().all(|&(library, header)| serves(library, header)));
        assert!(!others.iter().any(|&(library, header)| serves(library, header)));
    }
}
