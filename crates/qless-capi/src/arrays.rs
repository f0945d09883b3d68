//! Converts arrays and texts of C to slices, and indices of 32 or 64 bits that count from 0 or 1 to `usize`.

use std::ffi::{CStr, c_char, c_int};

use qless::elimination::Index;

use crate::status::CallFailure;

/// An index type of C.
pub trait CIndex: Index {
    /// Converts to a 64-bit number.
    fn wide(self) -> i64;
    /// Converts from a 64-bit number; `None` if it does not fit.
    fn narrow(value: i64) -> Option<Self>;
}

impl CIndex for i32 {
    fn wide(self) -> i64 {
        self.into()
    }
    fn narrow(value: i64) -> Option<Self> {
        value.try_into().ok()
    }
}

impl CIndex for i64 {
    fn wide(self) -> i64 {
        self
    }
    fn narrow(value: i64) -> Option<Self> {
        Some(value)
    }
}

/// Whether indices count from 0 or from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IndexBase(usize);

impl IndexBase {
    pub fn new(base: c_int) -> Result<Self, CallFailure> {
        match base {
            0 | 1 => Ok(Self(base as usize)),
            _ => Err(CallFailure::input(format!("the base is {base}; indices count from 0 or from 1"))),
        }
    }

    /// Returns true if indices count from 1.
    pub fn is_one(self) -> bool {
        self.0 == 1
    }

    /// Converts a 0-based index to the base of the caller.
    pub fn shown(self, index: usize) -> i64 {
        (index + self.0) as i64
    }

    /// Converts an index of the caller to one that counts from 0.
    pub fn read<I: CIndex>(self, index: I, what: &str) -> Result<usize, CallFailure> {
        let from_zero = index.wide().checked_sub(self.0 as i64).and_then(|index| usize::try_from(index).ok());
        from_zero.ok_or_else(|| CallFailure::input(format!("{what} is {}; it counts from {}", index.wide(), self.0)))
    }

    /// Converts a list of indices.
    pub fn read_all<I: CIndex>(self, list: &[I], what: &str) -> Result<Vec<usize>, CallFailure> {
        list.iter().map(|&index| self.read(index, what)).collect()
    }

    /// Converts the starts of compressed rows or columns, which ascend from the base.
    pub fn starts<I: CIndex>(self, starts: &[I]) -> Result<Vec<usize>, CallFailure> {
        let starts = self.read_all(starts, "a start")?;
        if starts[0] != 0 || starts.windows(2).any(|pair| pair[0] > pair[1]) {
            return Err(CallFailure::input("starts must begin at the base and never decrease"));
        }
        Ok(starts)
    }

    /// Converts 0-based indices to the base of the caller, and writes them into an array of the caller.
    pub fn write<I: CIndex>(
        self,
        list: impl ExactSizeIterator<Item = usize>,
        out: &mut [I],
    ) -> Result<(), CallFailure> {
        for (place, value) in out.iter_mut().zip(list) {
            let index = I::narrow(self.shown(value));
            *place = index.ok_or_else(|| {
                CallFailure::input("a number does not fit into 32 bits; call the function that ends in _64")
            })?;
        }
        Ok(())
    }
}

/// Refuses a negative length.
pub fn length(what: &str, given: i64) -> Result<usize, CallFailure> {
    usize::try_from(given).map_err(|_| CallFailure::input(format!("{what}: the length is {given}")))
}

/// Checks what a Rust slice requires of its address and length.
fn check<T>(what: &str, start: *const T, length: usize) -> Result<(), CallFailure> {
    if start.is_null() {
        return Err(CallFailure::input(format!("{what} is null, but {length} numbers are needed")));
    }
    if length > isize::MAX as usize / size_of::<T>() {
        return Err(CallFailure::input(format!("{what}: {length} numbers are more than any memory has")));
    }
    if start.is_aligned() {
        Ok(())
    } else {
        Err(CallFailure::input(format!("{what} does not start at the address of a number")))
    }
}

/// An input array of the caller.
///
/// # Safety
/// `start` is null or points to `length` readable numbers that nobody changes while the slice lives.
pub unsafe fn read<'a, T>(what: &str, start: *const T, length: usize) -> Result<&'a [T], CallFailure> {
    if length == 0 {
        return Ok(&[]);
    }
    check(what, start, length)?;
    // SAFETY: checked, and the caller guarantees the length.
    Ok(unsafe { std::slice::from_raw_parts(start, length) })
}

/// An output array of the caller, which must have room for exactly `needed` numbers.
///
/// # Safety
/// `start` is null or points to `found` writable numbers that nobody else uses while the slice lives.
pub unsafe fn write<'a, T>(what: &str, start: *mut T, found: i64, needed: usize) -> Result<&'a mut [T], CallFailure> {
    let found = length(what, found)?;
    if found != needed {
        return Err(CallFailure::input(format!("{what} has room for {found} numbers; {needed} are needed")));
    }
    if needed == 0 {
        return Ok(&mut []);
    }
    check(what, start, needed)?;
    // SAFETY: checked, and the caller guarantees the length.
    Ok(unsafe { std::slice::from_raw_parts_mut(start, needed) })
}

/// Refuses the address null of an output value.
pub fn not_null<T>(what: &str, place: *mut T) -> Result<(), CallFailure> {
    if place.is_null() {
        return Err(CallFailure::input(format!("{what} is null; give the address of a variable")));
    }
    Ok(())
}

/// Writes an output value of the caller.
///
/// # Safety
/// `place` is null or points to a writable value that nobody else uses.
pub unsafe fn set<T>(what: &str, place: *mut T, value: T) -> Result<(), CallFailure> {
    not_null(what, place)?;
    // SAFETY: not null, and the caller guarantees that it may be written.
    unsafe { place.write(value) };
    Ok(())
}

/// An input text of the caller.
///
/// # Safety
/// `start` is null or a zero-terminated text that lives longer than the result.
pub unsafe fn text<'a>(what: &str, start: *const c_char) -> Result<&'a str, CallFailure> {
    if start.is_null() {
        return Err(CallFailure::input(format!("{what} is null")));
    }
    // SAFETY: not null, and the caller upholds the contract.
    let text = unsafe { CStr::from_ptr(start) };
    text.to_str().map_err(|_| CallFailure::input(format!("{what} is no UTF-8 text")))
}

/// Sets the size of a result whose size the caller does not know. Returns false if the caller, with room 0, asks only for the size.
///
/// # Safety
/// `size` is null or may be written.
pub unsafe fn has_room(needed: usize, room: i64, what: &str, size: *mut i64) -> Result<bool, CallFailure> {
    // SAFETY: the caller upholds the contract.
    unsafe { set(what, size, needed as i64) }?;
    if room != 0 && length("room", room)? < needed {
        return Err(CallFailure::input(format!("there is room for {room}; {needed} are needed")));
    }
    Ok(room != 0)
}

/// Writes a text with its closing zero, and sets `length` to the bytes of both.
///
/// # Safety
/// `out` is null or has room for `room` bytes, and `length` is null or may be written.
pub unsafe fn write_text(text: &str, out: *mut c_char, room: i64, length: *mut i64) -> Result<(), CallFailure> {
    let needed = text.len() + 1;
    // SAFETY: the caller upholds the contract, here and below.
    if unsafe { has_room(needed, room, "length", length) }? {
        let out = unsafe { write("text", out, needed as i64, needed) }?;
        // A zero would end the text early, so a space replaces it.
        let bytes = text.bytes().map(|byte| if byte == 0 { b' ' } else { byte });
        out.iter_mut().zip(bytes.chain([0])).for_each(|(out, byte)| *out = byte as c_char);
    }
    Ok(())
}
