//! Bytes of a glTF: the GLB container, and the buffers of a document wherever they are.

use super::json;
use crate::beside::Neighbours;
use crate::bytes::number_at;
use crate::error::{Malformed, malformed};
use base64::Engine as _;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use std::borrow::Cow;
use std::cell::OnceCell;
use std::collections::BTreeMap;
use std::path::{Component, PathBuf};

pub(crate) const MAGIC: &[u8] = b"glTF";

const HEADER: usize = 12;
const CHUNK_HEADER: usize = 8;

/// Splits a GLB into its text and its binary chunk; further chunks belong to extensions and are skipped.
///
/// Bytes behind the length that the header states are not part of the GLB.
pub(super) fn split_glb(file: &[u8]) -> Result<(&[u8], Option<&[u8]>), Malformed> {
    let len = file.len();
    let (Some(version), Some(stated)) = (number_at(file, 4), number_at(file, 8)) else {
        return Err(malformed!("not a GLB: {len} bytes are less than a header"));
    };
    if version != 2 {
        return Err(malformed!("GLB version {version} is not 2{}", upgrade(version == 1)));
    }
    let whole = usize::try_from(stated).ok().filter(|&stated| stated >= HEADER).and_then(|stated| file.get(..stated));
    let glb = whole.ok_or_else(|| malformed!("the header states {stated} bytes, the file has {len}"))?;
    let no_json = || malformed!("the first chunk is not JSON");
    let (mut json, mut binary) = (None, None);
    let mut offset = HEADER;
    while offset < glb.len() {
        let Some((kind, content)) = chunk(glb, offset) else {
            let len = glb.len();
            return Err(malformed!("the chunk at byte {offset} is not inside the {len} bytes of the file"));
        };
        match kind {
            b"JSON" if offset == HEADER => json = Some(content),
            _ if offset == HEADER => return Err(no_json()),
            b"BIN\0" if binary.is_none() => binary = Some(content),
            _ => {}
        }
        offset += CHUNK_HEADER + content.len();
    }
    Ok((json.ok_or_else(no_json)?, binary))
}

fn chunk(glb: &[u8], offset: usize) -> Option<(&[u8], &[u8])> {
    let length = usize::try_from(number_at(glb, offset)?).ok()?;
    let content = offset.checked_add(CHUNK_HEADER)?;
    Some((glb.get(offset + 4..content)?, glb.get(content..content.checked_add(length)?)?))
}

#[derive(Debug)]
pub(super) struct Buffers<'a> {
    buffers: &'a [json::Buffer],
    binary: Option<&'a [u8]>,
    beside: Option<&'a dyn Neighbours>,
    /// Index of the first buffer with the same URI, so that a file is read once however often it is named.
    first: Vec<usize>,
    loaded: Vec<OnceCell<Cow<'a, [u8]>>>,
}

impl<'a> Buffers<'a> {
    pub(super) fn new(
        buffers: &'a [json::Buffer],
        binary: Option<&'a [u8]>,
        beside: Option<&'a dyn Neighbours>,
    ) -> Self {
        let mut by_uri = BTreeMap::new();
        let mut first_of = |k, uri| *by_uri.entry(uri).or_insert(k);
        let first = |(k, b): (usize, &'a json::Buffer)| b.uri.as_deref().map_or(k, |uri| first_of(k, uri));
        let first = buffers.iter().enumerate().map(first).collect();
        Self { buffers, binary, beside, first, loaded: buffers.iter().map(|_| OnceCell::new()).collect() }
    }

    /// The same, with the contents of files and data URIs that were read before.
    pub(super) fn with_loaded(self, loaded: &'a [Option<Vec<u8>>]) -> Self {
        for (cell, bytes) in self.loaded.iter().zip(loaded) {
            if let Some(bytes) = bytes {
                // The cell is new, so it is empty.
                let _ = cell.set(Cow::Borrowed(bytes));
            }
        }
        self
    }

    pub(super) fn into_loaded(self) -> Vec<Option<Vec<u8>>> {
        let owned = |cell: OnceCell<Cow<'a, [u8]>>| match cell.into_inner() {
            Some(Cow::Owned(bytes)) => Some(bytes),
            _ => None,
        };
        self.loaded.into_iter().map(owned).collect()
    }

    /// The bytes of a buffer, as many as it states.
    pub(super) fn get(&self, buffer: usize) -> Result<&[u8], Malformed> {
        let Some(&first) = self.first.get(buffer) else { return Err(missing()) };
        let cell = &self.loaded[first];
        let bytes = match cell.get() {
            Some(bytes) => bytes,
            None => {
                let bytes = self.load(first)?;
                cell.get_or_init(|| bytes)
            }
        };
        let stated = self.buffers[buffer].byte_length;
        bytes.get(..stated).ok_or_else(|| malformed!("it states {stated} bytes, there are {}", bytes.len()))
    }

    fn load(&self, buffer: usize) -> Result<Cow<'a, [u8]>, Malformed> {
        let Some(uri) = self.buffers[buffer].uri.as_deref() else {
            // Only the first buffer may be the binary chunk.
            let binary = self.binary.filter(|_| buffer == 0);
            let no_data = || malformed!("it has no URI and there is no binary chunk for it");
            return binary.map(Cow::Borrowed).ok_or_else(no_data);
        };
        match uri.get(..5) {
            Some(scheme) if scheme.eq_ignore_ascii_case("data:") => data_uri(&uri[5..]).map(Cow::Owned),
            _ => load_file(self.beside, uri).map(Cow::Owned),
        }
    }
}

pub(super) fn missing() -> Malformed {
    malformed!("it does not exist")
}

/// The file beside the document that a URI names, in the same folder or below.
pub(super) fn load_file(beside: Option<&dyn Neighbours>, uri: &str) -> Result<Vec<u8>, Malformed> {
    let refused = || malformed!("{uri:?} is not a file in the scene's folder");
    let (beside, path) = beside.zip(relative_path(uri)).ok_or_else(refused)?;
    let found = beside.read(&path).map_err(|error| malformed!("{uri:?} cannot be read: {error}"))?;
    found.ok_or_else(refused)
}

/// The path that a URI names, if it leads into or below the folder where one is: a scene must not
/// read files outside that folder.
fn relative_path(uri: &str) -> Option<PathBuf> {
    if uri.is_empty() || uri.contains(':') {
        return None;
    }
    let path = PathBuf::from(percent_decode(uri)?);
    path.components().all(|c| matches!(c, Component::Normal(_) | Component::CurDir)).then_some(path)
}

fn percent_decode(uri: &str) -> Option<String> {
    let mut decoded = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let Some((&byte, behind)) = rest.split_first() {
        if byte == b'%' {
            let digit = |k: usize| char::from(*behind.get(k)?).to_digit(16);
            decoded.push((digit(0)? * 16 + digit(1)?) as u8);
            rest = &behind[2..];
        } else {
            decoded.push(byte);
            rest = behind;
        }
    }
    // A path with a zero byte cannot be handed to the system.
    String::from_utf8(decoded).ok().filter(|path| !path.contains('\0'))
}

/// The bytes of a data URI, of which `rest` is what follows `data:`.
fn data_uri(rest: &str) -> Result<Vec<u8>, Malformed> {
    let (head, body) = rest.split_once(',').unwrap_or_default();
    let coding = head.rsplit(';').next().filter(|coding| coding.eq_ignore_ascii_case("base64"));
    coding.and_then(|_| base64(body)).ok_or_else(|| malformed!("its data URI is not base64"))
}

/// Decodes base64 with the usual alphabet, with or without its padding (RFC 4648, section 4).
fn base64(text: &str) -> Option<Vec<u8>> {
    let config = GeneralPurposeConfig::new()
        .with_decode_allow_trailing_bits(true)
        .with_decode_padding_mode(DecodePaddingMode::RequireNone);
    GeneralPurpose::new(&STANDARD, config).decode(text.trim_end_matches('=')).ok()
}

/// The command that makes version 2 of a file of version 1.
pub(super) fn upgrade(is_first: bool) -> &'static str {
    if is_first { "; `npx gltf-pipeline -i IN.gltf -o OUT.glb` makes version 2 of version 1" } else { "" }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_is_that_of_the_standard() {
        // The examples of RFC 4648, section 10.
        let examples =
            [("", ""), ("Zg==", "f"), ("Zm8=", "fo"), ("Zm9v", "foo"), ("Zm9vYg==", "foob"), ("Zm9vYmE", "fooba")];
        for (coded, plain) in examples {
            assert_eq!(base64(coded).as_deref(), Some(plain.as_bytes()), "{coded}");
        }
        assert_eq!(base64("+/+/"), Some(vec![0xFB, 0xFF, 0xBF]));
        for broken in ["Z", "Zm9vY", "Zm 9v", "Zm9v\n", "Zm-_", "=Zm9"] {
            assert_eq!(base64(broken), None, "{broken:?}");
        }
        assert_eq!(data_uri("application/octet-stream;base64,Zm8=").unwrap(), b"fo");
        assert!(data_uri("text/plain,fo").is_err() && data_uri("base64").is_err());
    }
}
