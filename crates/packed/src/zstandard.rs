//! zstd. It is C, which is not compiled for WebAssembly: there packed tables are neither read nor written.

#[cfg(not(target_family = "wasm"))]
pub(crate) use zstd::bulk::{Compressor, Decompressor, compress, decompress};

#[cfg(target_family = "wasm")]
pub(crate) use absent::{Compressor, Decompressor, compress, decompress};

#[cfg(target_family = "wasm")]
mod absent {
    use std::io::{Error, ErrorKind, Result};
    use std::marker::PhantomData;

    pub(crate) struct Compressor<'a>(PhantomData<&'a ()>);

    #[derive(Debug)]
    pub(crate) struct Decompressor<'a>(PhantomData<&'a ()>);

    impl Compressor<'_> {
        pub(crate) fn new(_: i32) -> Result<Self> {
            Err(ErrorKind::Unsupported.into())
        }

        pub(crate) fn compress(&mut self, bytes: &[u8]) -> Result<Vec<u8>> {
            compress(bytes, 0)
        }
    }

    impl Decompressor<'_> {
        pub(crate) fn new() -> Result<Self> {
            Err(ErrorKind::Unsupported.into())
        }

        pub(crate) fn decompress(&mut self, bytes: &[u8], most: usize) -> Result<Vec<u8>> {
            decompress(bytes, most)
        }
    }

    pub(crate) fn compress(_: &[u8], _: i32) -> Result<Vec<u8>> {
        Err(Error::from(ErrorKind::Unsupported))
    }

    pub(crate) fn decompress(_: &[u8], _: usize) -> Result<Vec<u8>> {
        Err(Error::from(ErrorKind::Unsupported))
    }
}
