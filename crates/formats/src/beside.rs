//! What lies beside a file.

use std::fmt;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Reads files that lie beside another one, which names them: a folder, an archive, a network.
pub trait Neighbours: fmt::Debug {
    /// The bytes of a file; `None` if what has that name is no regular file, such as a pipe that never ends.
    ///
    /// * `path`: relative, without `..`, checked by the caller.
    ///
    /// # Errors
    /// What the system says, [`io::ErrorKind::NotFound`] if there is no such file.
    fn read(&self, path: &Path) -> io::Result<Option<Vec<u8>>>;
}

/// A folder of the file system.
#[derive(Debug, Clone)]
pub struct Folder(pub PathBuf);

impl Folder {
    /// The folder of a file. A bare file name has the empty path as parent, which is the current folder.
    pub fn of(file: &Path) -> Self {
        Self(file.parent().unwrap_or(Path::new("")).to_owned())
    }
}

impl Neighbours for Folder {
    fn read(&self, path: &Path) -> io::Result<Option<Vec<u8>>> {
        let path = self.0.join(path);
        // A device or pipe may never end.
        if fs::metadata(&path)?.is_file() { fs::read(&path).map(Some) } else { Ok(None) }
    }
}
