//! The source of the bytes of a packed table.

use std::io;
use std::sync::Arc;

/// Bytes that can be read at any position, by several threads at once.
///
/// A host that maps a file itself passes the map as `&'static [u8]`, or implements this for its map.
pub trait ByteSource: Send + Sync {
    /// Number of bytes.
    ///
    /// # Errors
    /// Any error of the medium.
    fn len(&self) -> io::Result<u64>;

    /// Whether there are no bytes.
    ///
    /// # Errors
    /// As [`ByteSource::len`].
    fn is_empty(&self) -> io::Result<bool> {
        Ok(self.len()? == 0)
    }

    /// Fills `buf` with the bytes from `offset` on.
    ///
    /// # Errors
    /// [`io::ErrorKind::UnexpectedEof`] if there are too few, or any error of the medium.
    fn read_at(&self, offset: u64, buf: &mut [u8]) -> io::Result<()>;
}

fn read_slice(bytes: &[u8], offset: u64, buf: &mut [u8]) -> io::Result<()> {
    let from = usize::try_from(offset).ok().and_then(|at| bytes.get(at..)).and_then(|rest| rest.get(..buf.len()));
    buf.copy_from_slice(from.ok_or(io::ErrorKind::UnexpectedEof)?);
    Ok(())
}

impl ByteSource for Vec<u8> {
    fn len(&self) -> io::Result<u64> {
        Ok(self.as_slice().len() as u64)
    }

    fn read_at(&self, offset: u64, buf: &mut [u8]) -> io::Result<()> {
        read_slice(self, offset, buf)
    }
}

impl ByteSource for Arc<[u8]> {
    fn len(&self) -> io::Result<u64> {
        Ok(self.as_ref().len() as u64)
    }

    fn read_at(&self, offset: u64, buf: &mut [u8]) -> io::Result<()> {
        read_slice(self, offset, buf)
    }
}

impl ByteSource for &'static [u8] {
    fn len(&self) -> io::Result<u64> {
        Ok((**self).len() as u64)
    }

    fn read_at(&self, offset: u64, buf: &mut [u8]) -> io::Result<()> {
        read_slice(self, offset, buf)
    }
}

/// A file that the host has opened. Its own position does not matter; on Windows it is moved. In WebAssembly there are none.
#[cfg(any(unix, windows, target_family = "wasm"))]
impl ByteSource for std::fs::File {
    fn len(&self) -> io::Result<u64> {
        Ok(self.metadata()?.len())
    }

    #[cfg(unix)]
    fn read_at(&self, offset: u64, buf: &mut [u8]) -> io::Result<()> {
        std::os::unix::fs::FileExt::read_exact_at(self, buf, offset)
    }

    #[cfg(target_family = "wasm")]
    fn read_at(&self, _: u64, _: &mut [u8]) -> io::Result<()> {
        Err(io::ErrorKind::Unsupported.into())
    }

    #[cfg(windows)]
    fn read_at(&self, mut offset: u64, mut buf: &mut [u8]) -> io::Result<()> {
        while !buf.is_empty() {
            match std::os::windows::fs::FileExt::seek_read(self, buf, offset) {
                Ok(0) => return Err(io::ErrorKind::UnexpectedEof.into()),
                Ok(n) => {
                    buf = &mut buf[n..];
                    offset += n as u64;
                }
                Err(e) if e.kind() == io::ErrorKind::Interrupted => {}
                Err(e) => return Err(e),
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sources_give_the_bytes_that_are_asked_for_or_an_error() {
        let sources: [&dyn ByteSource; 3] =
            [&vec![1u8, 2, 3, 4], &Arc::<[u8]>::from([1u8, 2, 3, 4]), &(&[1u8, 2, 3, 4] as &'static [u8])];
        for source in sources {
            let mut two = [0; 2];
            source.read_at(1, &mut two).expect("they are there");
            assert_eq!((two, source.len().expect("a length"), source.is_empty().expect("one")), ([2, 3], 4, false));
            source.read_at(4, &mut []).expect("nothing is there");
            for at in [3, 4, 5, u64::MAX] {
                let error = source.read_at(at, &mut two).expect_err("too few bytes");
                assert_eq!(error.kind(), io::ErrorKind::UnexpectedEof);
            }
        }
    }
}
