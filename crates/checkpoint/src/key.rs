//! What tells the results of one bake from those of another.

use std::fmt;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;
use std::str::FromStr;
use xxhash_rust::xxh3::Xxh3;

/// A hash of everything that decides the results of units: the content of the input, the options, the version of the program. It guards against
/// mistakes, not against malice.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Key(pub [u8; 16]);

impl fmt::Display for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

/// Not 32 hexadecimal digits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("not 32 hexadecimal digits")]
pub struct ParseKeyError;

impl FromStr for Key {
    type Err = ParseKeyError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let is_hex = text.len() == 32 && text.bytes().all(|byte| byte.is_ascii_hexdigit());
        let number = u128::from_str_radix(text, 16).map_err(|_| ParseKeyError)?;
        if is_hex { Ok(Self(number.to_be_bytes())) } else { Err(ParseKeyError) }
    }
}

/// Makes a [`Key`] of named values. Their order matters.
#[derive(Clone)]
pub struct KeyHasher(Xxh3);

impl fmt::Debug for KeyHasher {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("KeyHasher").field(&self.0.digest()).finish()
    }
}

impl KeyHasher {
    /// For results of a version of a program.
    pub fn new(program: &str) -> Self {
        let mut hasher = Self(Xxh3::new());
        hasher.value("program", program.as_bytes());
        hasher
    }

    /// Adds a value.
    pub fn value(&mut self, name: &str, value: &[u8]) {
        for bytes in [name.as_bytes(), value] {
            self.0.update(&(bytes.len() as u64).to_le_bytes());
            self.0.update(bytes);
        }
    }

    /// Adds what a value looks like with [`fmt::Debug`], without making the text.
    pub fn debug(&mut self, name: &str, value: &dyn fmt::Debug) {
        /// Hashes what is written, and counts it.
        struct Sink<'a>(&'a mut Xxh3, u64);
        impl fmt::Write for Sink<'_> {
            fn write_str(&mut self, text: &str) -> fmt::Result {
                self.0.update(text.as_bytes());
                self.1 += text.len() as u64;
                Ok(())
            }
        }
        self.value(name, b"");
        let mut sink = Sink(&mut self.0, 0);
        // Only a value that fails by itself makes this fail; what it wrote until then is hashed.
        let _ = fmt::write(&mut sink, format_args!("{value:?}"));
        let n = sink.1;
        self.0.update(&n.to_le_bytes());
    }

    /// Adds the content of a file. Returns its length, and a key of the content alone.
    ///
    /// # Errors
    /// The error of the system.
    pub fn file(&mut self, name: &str, path: &Path) -> io::Result<(u64, Key)> {
        let mut file = File::open(path)?;
        let (mut content, mut n_bytes) = (Xxh3::new(), 0);
        let mut buffer = vec![0; 1 << 16];
        loop {
            match file.read(&mut buffer) {
                Ok(0) => break,
                Ok(n) => {
                    content.update(&buffer[..n]);
                    n_bytes += n as u64;
                }
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        let digest = content.digest128().to_be_bytes();
        self.value(name, &digest);
        Ok((n_bytes, Key(digest)))
    }

    /// The key of all values so far.
    pub fn finish(&self) -> Key {
        Key(self.0.digest128().to_be_bytes())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_differ_with_any_value_and_its_place() {
        let key = |values: &[(&str, &str)]| {
            let mut hasher = KeyHasher::new("1");
            values.iter().for_each(|(name, value)| hasher.value(name, value.as_bytes()));
            hasher.finish()
        };
        let all = [
            key(&[]),
            key(&[("a", "b")]),
            key(&[("ab", "")]),
            key(&[("", "ab")]),
            key(&[("a", ""), ("b", "")]),
            key(&[("b", ""), ("a", "")]),
            KeyHasher::new("2").finish(),
        ];
        for (k, one) in all.iter().enumerate() {
            assert!(all[..k].iter().all(|other| other != one), "{k}");
            assert_eq!(one.to_string().parse(), Ok(*one));
        }
        for text in ["", "0", "+0123456789abcdef0123456789abcde", "g0000000000000000000000000000000"] {
            assert_eq!(text.parse::<Key>(), Err(ParseKeyError), "{text}");
        }
    }

    #[test]
    fn files_and_debug_texts_are_values() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("in");
        let of = |content: &[u8]| {
            std::fs::write(&path, content).unwrap();
            let mut hasher = KeyHasher::new("1");
            let (n, _) = hasher.file("in", &path).unwrap();
            assert_eq!(n, content.len() as u64);
            hasher.finish()
        };
        assert!(of(b"a") != of(b"b") && of(b"") != of(&[0; 70_000]) && of(b"a") == of(b"a"));
        let of = |values: &[&dyn fmt::Debug]| {
            let mut hasher = KeyHasher::new("1");
            values.iter().for_each(|value| hasher.debug("options", *value));
            hasher.finish()
        };
        assert!(
            of(&[&0.1]) != of(&[&(0.1_f64.next_up())]) && of(&[&[1], &[2]]) != of(&[&[1, 2]]) && of(&[&1]) == of(&[&1])
        );
    }
}
