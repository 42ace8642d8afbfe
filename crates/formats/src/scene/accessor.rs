//! Accessors of a glTF: numbers in buffers, found only after their place has been checked.

use super::buffers::{Buffers, missing};
use super::json::{Accessor, Document, Sparse};
use crate::error::{Malformed, Within, malformed};
use sightlines_cells::Point3;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum AccessorRole {
    Positions,
    /// Indices into the corners.
    Indices,
    /// Anything else that corners have, or that a document keeps.
    Attribute,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn of(code: u32) -> Option<Self> {
        match code {
            5120 => Some(Self::I8),
            5121 => Some(Self::U8),
            5122 => Some(Self::I16),
            5123 => Some(Self::U16),
            5125 => Some(Self::U32),
            5126 => Some(Self::F32),
            _ => None,
        }
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    pub(super) fn is_float(self) -> bool {
        self == Self::F32
    }

    /// The value of the number in `b`, which has its size.
    fn value(self, b: &[u8]) -> f64 {
        match self {
            Self::I8 => f64::from(i8::from_le_bytes([b[0]])),
            Self::U8 => f64::from(b[0]),
            Self::I16 => f64::from(i16::from_le_bytes([b[0], b[1]])),
            Self::U16 => f64::from(u16::from_le_bytes([b[0], b[1]])),
            Self::U32 => f64::from(u32::from_le_bytes([b[0], b[1], b[2], b[3]])),
            Self::F32 => f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]])),
        }
    }

    fn normalized(self, value: f64) -> f64 {
        let most = match self {
            Self::I8 => 127.0,
            Self::U8 => 255.0,
            Self::I16 => 32767.0,
            Self::U16 => 65535.0,
            Self::U32 | Self::F32 => return value,
        };
        (value / most).max(-1.0)
    }

    /// The index in `b`, which has its size: a double holds every one.
    fn index(self, b: &[u8]) -> u32 {
        self.value(b) as u32
    }
}

/// Elements at equal distances; invariant: the last one is inside `bytes`.
#[derive(Debug, Clone, Copy)]
struct Strided<'a> {
    bytes: &'a [u8],
    stride: usize,
    size: usize,
}

impl<'a> Strided<'a> {
    fn get(&self, k: usize) -> &'a [u8] {
        &self.bytes[k * self.stride..][..self.size]
    }
}

/// Elements that replace others; invariant: their indices ascend and are in range.
#[derive(Debug, Clone, Copy)]
struct Replaced<'a> {
    count: usize,
    indices: Strided<'a>,
    index: Component,
    values: Strided<'a>,
}

impl<'a> Replaced<'a> {
    fn index_at(&self, k: usize) -> usize {
        self.index.index(self.indices.get(k)) as usize
    }

    /// What replaces element `k`, found by bisection.
    fn get(&self, k: usize) -> Option<&'a [u8]> {
        let (mut low, mut high) = (0, self.count);
        while low < high {
            let middle = low.midpoint(high);
            if self.index_at(middle) < k { low = middle + 1 } else { high = middle }
        }
        (low < self.count && self.index_at(low) == k).then(|| self.values.get(low))
    }
}

/// The elements of an accessor, all of them inside their buffers.
#[derive(Debug, Clone, Copy)]
pub(super) struct Elements<'a> {
    pub(super) count: usize,
    pub(super) size: usize,
    pub(super) component: Component,
    normalized: bool,
    /// `None` if all elements are zero but for those replaced.
    base: Option<Strided<'a>>,
    replaced: Option<Replaced<'a>>,
}

impl<'a> Elements<'a> {
    pub(super) fn new(
        document: &Document,
        buffers: &'a Buffers<'_>,
        accessor: usize,
        role: AccessorRole,
    ) -> Result<Self, Malformed> {
        let a = document.accessors.get(accessor).ok_or_else(missing)?;
        let wrong = || wrong_type(&a.kind, a.component_type);
        let component = Component::of(a.component_type).filter(|&c| fits(a, c, role)).ok_or_else(wrong)?;
        let size = element_size(&a.kind, component).ok_or_else(wrong)?;
        if a.count == 0 {
            return Err(malformed!("it has no elements"));
        }
        let views = Views { document, buffers };
        let base = a.buffer_view.map(|view| views.strided(view, a.byte_offset, a.count, size, true)).transpose()?;
        let replaced = a.sparse.as_deref().map(|s| views.replaced(s, a.count, size)).transpose()?;
        // Zeros out of nothing must not take more memory than the file did.
        if base.is_none() && a.count > a.sparse.as_deref().map_or(0, |s| views.n_bytes_around(s)) {
            return Err(malformed!("{} elements that are in no buffer", a.count));
        }
        Ok(Self { count: a.count, size, component, normalized: a.normalized, base, replaced })
    }

    /// The bytes of element `k`, below `count`; `None` stands for zeros.
    pub(super) fn get(&self, k: usize) -> Option<&'a [u8]> {
        let replaced = self.replaced.and_then(|r| r.get(k));
        replaced.or_else(|| self.base.map(|base| base.get(k)))
    }

    pub(super) fn position(&self, k: usize) -> Point3 {
        let Some(bytes) = self.get(k) else { return [0.0; 3] };
        let size = self.component.size();
        [0, 1, 2].map(|axis| {
            let value = self.component.value(&bytes[axis * size..]);
            if self.normalized { self.component.normalized(value) } else { value }
        })
    }

    /// The numbers of element `k`, below `count`, as they are stored. Not for matrices, which may have gaps.
    pub(super) fn numbers(&self, k: usize) -> Vec<f64> {
        let size = self.component.size();
        match self.get(k) {
            Some(bytes) => bytes.chunks_exact(size).map(|b| self.component.value(b)).collect(),
            None => vec![0.0; self.size / size],
        }
    }

    /// The same, as what they stand for.
    pub(super) fn normalized_numbers(&self, k: usize) -> Vec<f64> {
        let numbers = self.numbers(k).into_iter();
        if self.normalized { numbers.map(|x| self.component.normalized(x)).collect() } else { numbers.collect() }
    }

    pub(super) fn index(&self, k: usize) -> u32 {
        self.get(k).map_or(0, |bytes| self.component.index(bytes))
    }
}

pub(super) fn no_view(view: usize) -> Malformed {
    malformed!("there is no buffer view {view}")
}

fn wrong_type(kind: &str, component: u32) -> Malformed {
    malformed!("elements of type {kind:?} with components {component} cannot be that")
}

/// Whether the components can be what `role` needs. Positions of small integers are those of quantised meshes.
fn fits(a: &Accessor, component: Component, role: AccessorRole) -> bool {
    match role {
        AccessorRole::Positions => a.kind == "VEC3" && component != Component::U32,
        AccessorRole::Indices => a.kind == "SCALAR" && is_index(component),
        AccessorRole::Attribute => true,
    }
}

fn is_index(component: Component) -> bool {
    matches!(component, Component::U8 | Component::U16 | Component::U32)
}

/// Bytes of an element; columns of matrices begin at multiples of four (section 3.6.2.4 of the specification).
fn element_size(kind: &str, component: Component) -> Option<usize> {
    let size = component.size();
    let n = usize::from(kind.bytes().last()?.wrapping_sub(b'0'));
    match kind {
        "SCALAR" => Some(size),
        "VEC2" | "VEC3" | "VEC4" => Some(n * size),
        "MAT2" | "MAT3" | "MAT4" => Some(n * (n * size).next_multiple_of(4)),
        _ => None,
    }
}

/// A document and its bytes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Views<'a, 'b, 'd> {
    pub(super) document: &'d Document,
    pub(super) buffers: &'a Buffers<'b>,
}

impl<'a> Views<'a, '_, '_> {
    pub(super) fn bytes(&self, view: usize) -> Result<&'a [u8], Malformed> {
        let v = self.document.buffer_views.get(view).ok_or_else(|| no_view(view))?;
        let buffer = v.buffer;
        let whole = self.buffers.get(buffer).within(format_args!("buffer {buffer}"))?;
        let end = v.byte_offset.checked_add(v.byte_length);
        let bytes = end.and_then(|end| whole.get(v.byte_offset..end));
        bytes.ok_or_else(|| malformed!("buffer view {view} is not inside the {} bytes of buffer {buffer}", whole.len()))
    }

    /// `count` elements of `size` bytes, from `offset` in a view; only vertices may be `spaced` by a stride.
    fn strided(
        &self,
        view: usize,
        offset: usize,
        count: usize,
        size: usize,
        spaced: bool,
    ) -> Result<Strided<'a>, Malformed> {
        let bytes = self.bytes(view)?;
        let stride = self.document.buffer_views[view].byte_stride.filter(|_| spaced).unwrap_or(size);
        if stride < size {
            let what = malformed!("stride {stride} is less than {size} bytes of an element");
            return Err(what.within(format_args!("buffer view {view}")));
        }
        let end =
            count.saturating_sub(1).checked_mul(stride).and_then(|last| last.checked_add(size)?.checked_add(offset));
        let elements = end.filter(|&end| end <= bytes.len()).and_then(|_| bytes.get(offset..));
        let outside = || malformed!("{count} elements are not inside the {} bytes of buffer view {view}", bytes.len());
        Ok(Strided { bytes: elements.ok_or_else(outside)?, stride, size })
    }

    fn replaced(&self, sparse: &Sparse, count: usize, size: usize) -> Result<Replaced<'a>, Malformed> {
        let code = sparse.indices.component_type;
        let index = Component::of(code).filter(|&c| is_index(c));
        let index = index.ok_or_else(|| wrong_type("SCALAR", code))?;
        let (at, values) = (&sparse.indices, &sparse.values);
        let indices = self.strided(at.buffer_view, at.byte_offset, sparse.count, index.size(), false)?;
        let values = self.strided(values.buffer_view, values.byte_offset, sparse.count, size, false)?;
        let replaced = Replaced { count: sparse.count, indices, index, values };
        let mut next = 0;
        for position in 0..sparse.count {
            let k = replaced.index_at(position);
            if k < next || k >= count {
                return Err(malformed!("sparse index {position} does not ascend or is not below {count}"));
            }
            next = k + 1;
        }
        Ok(replaced)
    }

    /// Bytes of the buffer that holds the values of `sparse`.
    fn n_bytes_around(&self, sparse: &Sparse) -> usize {
        let view = self.document.buffer_views.get(sparse.values.buffer_view);
        view.and_then(|v| self.buffers.get(v.buffer).ok()).map_or(0, <[u8]>::len)
    }
}
