//! Where in a text the reader is, and what is wrong there.

use super::error::{GeoJsonError, GeoJsonErrorKind, GeoJsonPlace};
use serde::de::Error;
use serde_json::error::Category;

/// The place in the text's scene, and why reading failed or is about to fail there.
#[derive(Debug, Default)]
pub(super) struct Context {
    pub(super) place: GeoJsonPlace,
    failure: Option<GeoJsonErrorKind>,
    /// What is wrong if the next value is of another JSON type than it should be.
    mismatch: Option<GeoJsonErrorKind>,
}

impl Context {
    /// Sets what is wrong if the value that is read next is of another JSON type than expected.
    pub(super) fn expect(&mut self, otherwise: GeoJsonErrorKind) {
        self.mismatch = Some(otherwise);
    }

    /// Keeps the reason and makes the error that carries the position in the text.
    pub(super) fn fail<E: Error>(&mut self, kind: GeoJsonErrorKind) -> E {
        self.failure = Some(kind);
        E::custom("not a plan")
    }

    /// The error for what the JSON reader reports.
    pub(super) fn explain(&mut self, error: &serde_json::Error) -> GeoJsonError {
        let found = match error.classify() {
            Category::Eof => GeoJsonErrorKind::Truncated,
            Category::Data => self.mismatch.take().unwrap_or(GeoJsonErrorKind::Syntax),
            Category::Syntax | Category::Io => GeoJsonErrorKind::Syntax,
        };
        let kind = self.failure.take().unwrap_or(found);
        GeoJsonError { line: error.line(), column: error.column(), place: self.place, kind }
    }
}
