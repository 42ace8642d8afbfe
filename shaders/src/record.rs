//! Records that are the same for Rust and WGSL: types that know where their fields lie.

/// What the words of a field are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// `u32`
    Uint,
    /// `i32`
    Sint,
    /// `f32`
    Float,
}

/// A type that a record's field can have: some 32-bit words of one kind.
pub trait Field: Copy {
    /// Of its words.
    const KIND: Kind;
    /// How many words: 1 for a scalar, else those of a vector.
    const WORDS: u32;

    /// Appends its little-endian bytes.
    fn put(self, out: &mut Vec<u8>);
}

macro_rules! field {
    ($type:ty, $kind:ident) => {
        impl Field for $type {
            const KIND: Kind = Kind::$kind;
            const WORDS: u32 = 1;

            fn put(self, out: &mut Vec<u8>) {
                out.extend_from_slice(&self.to_le_bytes());
            }
        }

        impl<const N: usize> Field for [$type; N] {
            const KIND: Kind = Kind::$kind;
            const WORDS: u32 = N as u32;

            fn put(self, out: &mut Vec<u8>) {
                self.into_iter().for_each(|word| word.put(out));
            }
        }
    };
}

field!(u32, Uint);
field!(i32, Sint);
field!(f32, Float);

/// One field of a record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Member {
    /// Its name in Rust and in WGSL.
    pub name: &'static str,
    /// Of its words.
    pub kind: Kind,
    /// How many words.
    pub words: u32,
}

/// Where the fields of a record lie: one after the other, without gaps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Layout {
    /// Its name in WGSL.
    pub name: &'static str,
    /// Its fields, in order.
    pub members: &'static [Member],
}

impl Layout {
    /// Its size in bytes, and the distance from one to the next in an array.
    pub const fn size(&self) -> u32 {
        let (mut size, mut i) = (0, 0);
        while i < self.members.len() {
            size += 4 * self.members[i].words;
            i += 1;
        }
        size
    }
}

/// A type whose bytes a shader can read.
pub trait Record: Copy {
    /// Where its fields lie.
    const LAYOUT: Layout;

    /// Appends its bytes, as many as the layout says.
    fn put(&self, out: &mut Vec<u8>);
}

/// Declares a record: a struct, its layout, and its bytes, all in the order of the fields.
macro_rules! record {
    ($(#[$doc:meta])* $name:ident as $text_name:literal { $($(#[$field_doc:meta])* $field:ident: $type:ty,)+ }) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Default)]
        pub struct $name {
            $($(#[$field_doc])* pub $field: $type,)+
        }

        impl $crate::Record for $name {
            const LAYOUT: $crate::Layout = $crate::Layout {
                name: $text_name,
                members: &[$($crate::Member {
                    name: stringify!($field),
                    kind: <$type as $crate::Field>::KIND,
                    words: <$type as $crate::Field>::WORDS,
                },)+],
            };

            fn put(&self, out: &mut Vec<u8>) {
                $($crate::Field::put(self.$field, out);)+
            }
        }
    };
}
pub(crate) use record;

#[cfg(test)]
mod tests {
    use super::*;
    use sample::Sample;

    #[expect(unreachable_pub, reason = "records are public wherever they are declared for use")]
    mod sample {
        record! {
            /// For the test.
            Sample as "Sample" {
                /// Two.
                pair: [i32; 2],
                /// One.
                single: f32,
            }
        }
    }

    #[test]
    fn bytes_are_as_many_as_the_layout_says_and_in_order() {
        let mut bytes = Vec::new();
        Sample { pair: [1, -1], single: 1.0 }.put(&mut bytes);
        assert_eq!(bytes, [1, 0, 0, 0, 255, 255, 255, 255, 0, 0, 128, 63]);
        assert_eq!(Sample::LAYOUT.size() as usize, bytes.len());
        let names: Vec<_> = Sample::LAYOUT.members.iter().map(|m| (m.name, m.kind, m.words)).collect();
        assert_eq!(names, [("pair", Kind::Sint, 2), ("single", Kind::Float, 1)]);
    }
}
