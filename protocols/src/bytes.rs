//! Numbers in byte slices, at named ranges, without panics.
//!
//! The views check their length once, so no range here is ever outside its slice; were one, it
//! would read as zeros and not be written.

use core::ops::Range;

/// A number with a fixed size on the wire.
pub(crate) trait Scalar: Copy + Default {
    /// Bytes on the wire.
    const SIZE: usize;
    /// Reads it least significant byte first.
    fn from_le(bytes: &[u8]) -> Self;
    /// Reads it most significant byte first.
    fn from_be(bytes: &[u8]) -> Self;
    /// Writes it least significant byte first.
    fn to_le(self, bytes: &mut [u8]);
    /// Writes it most significant byte first.
    fn to_be(self, bytes: &mut [u8]);
}

macro_rules! scalar {
    ($($kind:ty),*) => {$(
        impl Scalar for $kind {
            const SIZE: usize = size_of::<$kind>();
            #[inline(always)]
            fn from_le(bytes: &[u8]) -> Self {
                bytes.try_into().map_or_else(|_| Self::default(), Self::from_le_bytes)
            }
            #[inline(always)]
            fn from_be(bytes: &[u8]) -> Self {
                bytes.try_into().map_or_else(|_| Self::default(), Self::from_be_bytes)
            }
            #[inline(always)]
            fn to_le(self, bytes: &mut [u8]) {
                copy(&self.to_le_bytes(), bytes);
            }
            #[inline(always)]
            fn to_be(self, bytes: &mut [u8]) {
                copy(&self.to_be_bytes(), bytes);
            }
        }
    )*};
}
scalar!(u8, i8, u16, i16, u32, i32, u64, i64, f32, f64);

/// Copies as many bytes as both have.
#[inline(always)]
pub(crate) fn copy(from: &[u8], to: &mut [u8]) {
    for (to, from) in to.iter_mut().zip(from) {
        *to = *from;
    }
}

/// Reads a little-endian number.
#[inline(always)]
pub(crate) fn le<T: Scalar>(bytes: &[u8], at: Range<usize>) -> T {
    bytes.get(at).map_or_else(T::default, T::from_le)
}

/// Reads `N` little-endian numbers.
#[inline(always)]
pub(crate) fn les<T: Scalar, const N: usize>(bytes: &[u8], at: Range<usize>) -> [T; N] {
    core::array::from_fn(|i| le(bytes, element::<T>(&at, i)))
}

/// Reads a big-endian number.
#[inline(always)]
pub(crate) fn be<T: Scalar>(bytes: &[u8], at: Range<usize>) -> T {
    bytes.get(at).map_or_else(T::default, T::from_be)
}

/// Reads `N` big-endian numbers.
#[inline(always)]
pub(crate) fn bes<T: Scalar, const N: usize>(bytes: &[u8], at: Range<usize>) -> [T; N] {
    core::array::from_fn(|i| be(bytes, element::<T>(&at, i)))
}

/// Writes a little-endian number.
#[inline(always)]
pub(crate) fn put_le<T: Scalar>(bytes: &mut [u8], at: Range<usize>, value: T) {
    if let Some(place) = bytes.get_mut(at) {
        value.to_le(place);
    }
}

/// Writes little-endian numbers one after the other.
#[inline(always)]
pub(crate) fn put_les<T: Scalar, const N: usize>(bytes: &mut [u8], at: Range<usize>, values: [T; N]) {
    for (i, value) in values.into_iter().enumerate() {
        put_le(bytes, element::<T>(&at, i), value);
    }
}

/// Writes a big-endian number.
#[inline(always)]
pub(crate) fn put_be<T: Scalar>(bytes: &mut [u8], at: Range<usize>, value: T) {
    if let Some(place) = bytes.get_mut(at) {
        value.to_be(place);
    }
}

/// Writes big-endian numbers one after the other.
#[inline(always)]
pub(crate) fn put_bes<T: Scalar, const N: usize>(bytes: &mut [u8], at: Range<usize>, values: [T; N]) {
    for (i, value) in values.into_iter().enumerate() {
        put_be(bytes, element::<T>(&at, i), value);
    }
}

/// Where the `i`-th number of an array starting at `at` lies.
#[inline(always)]
fn element<T: Scalar>(at: &Range<usize>, i: usize) -> Range<usize> {
    let start = at.start + i * T::SIZE;
    start..start + T::SIZE
}

/// A field of a payload: a number, or numbers one after the other.
pub(crate) trait Field: Sized {
    /// Reads it at a place, least significant bytes first.
    fn from_le(bytes: &[u8], at: usize) -> Self;
    /// Reads it at a place, most significant bytes first.
    fn from_be(bytes: &[u8], at: usize) -> Self;
    /// Writes it at a place, least significant bytes first.
    fn to_le(self, bytes: &mut [u8], at: usize);
    /// Writes it at a place, most significant bytes first.
    fn to_be(self, bytes: &mut [u8], at: usize);
}

impl<T: Scalar> Field for T {
    #[inline(always)]
    fn from_le(bytes: &[u8], at: usize) -> Self {
        le(bytes, at..at + T::SIZE)
    }
    #[inline(always)]
    fn from_be(bytes: &[u8], at: usize) -> Self {
        be(bytes, at..at + T::SIZE)
    }
    #[inline(always)]
    fn to_le(self, bytes: &mut [u8], at: usize) {
        put_le(bytes, at..at + T::SIZE, self);
    }
    #[inline(always)]
    fn to_be(self, bytes: &mut [u8], at: usize) {
        put_be(bytes, at..at + T::SIZE, self);
    }
}

impl<T: Scalar, const N: usize> Field for [T; N] {
    #[inline(always)]
    fn from_le(bytes: &[u8], at: usize) -> Self {
        les(bytes, at..at + N * T::SIZE)
    }
    #[inline(always)]
    fn from_be(bytes: &[u8], at: usize) -> Self {
        bes(bytes, at..at + N * T::SIZE)
    }
    #[inline(always)]
    fn to_le(self, bytes: &mut [u8], at: usize) {
        put_les(bytes, at..at + N * T::SIZE, self);
    }
    #[inline(always)]
    fn to_be(self, bytes: &mut [u8], at: usize) {
        put_bes(bytes, at..at + N * T::SIZE, self);
    }
}
