//! Integers that other libraries use as indices.

/// An index or an offset of a compressed matrix. It is not meant to be implemented elsewhere.
pub trait Index: Copy + Send + Sync + sealed::Sealed {
    /// The index as a position; `usize::MAX`, which no array has, for a negative one.
    fn position(self) -> usize;
}

mod sealed {
    pub trait Sealed {}
}

macro_rules! index {
    ($($integer:ty)*) => {$(
        impl sealed::Sealed for $integer {}
        impl Index for $integer {
            #[inline]
            fn position(self) -> usize {
                usize::try_from(self).unwrap_or(usize::MAX)
            }
        }
    )*};
}

index!(u32 u64 usize i32 i64 isize);
