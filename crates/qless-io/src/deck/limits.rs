//! Limits on the time and memory that a few bytes of a deck can demand. A deck that exceeds a limit is refused with
//! [`Problem::Limit`](super::Problem).
//!
//! | what multiplies the text | limit | bounds |
//! | --- | --- | --- |
//! | includes | [`INCLUDE_DEPTH`], [`INCLUDES`] | time |
//! | copies of Nastran cards | [`COPIES`], of all lines together | memory: about 120 bytes each |
//! | `THRU` of Nastran | [`POINTS`] of a list | memory: 8 bytes each |
//! | `GENERATE` of CalculiX and Abaqus, groups in groups of Radioss | [`MEMBERS`] of a set | memory: 4 bytes each |
//! | `*DO` of ANSYS | [`REREAD`], with [`ITERATION`] for each iteration | time |
//! | arrays of ANSYS | [`ELEMENTS`] | memory: 8 bytes each |
//! | ranges of nodes of ANSYS | [`VALUES`] of all commands, [`HELD`] in all load steps | time, memory |
//!
//! [`HELD`] allows the most memory, up to 32 bytes for each value; the other limits allow about 30 MB to 160 MB.

/// Deepest nesting of includes.
pub const INCLUDE_DEPTH: usize = 20;
/// Largest number of includes, over all passes through a deck.
pub const INCLUDES: usize = 10_000;
/// Largest number of copies of Nastran cards in a deck.
pub const COPIES: usize = 1_000_000;
/// Largest number of points that a list of Nastran expands to.
pub const POINTS: usize = 20_000_000;
/// Largest number of members of a set.
pub const MEMBERS: usize = 40_000_000;
/// Largest number of bytes that the loops of ANSYS read again.
pub const REREAD: usize = 1 << 24;
/// Each iteration of an ANSYS loop counts as this many bytes towards [`REREAD`], besides its text: executing a command takes about as long
/// as reading this many bytes.
pub const ITERATION: usize = 64;
/// Largest number of elements of all arrays of ANSYS together.
pub const ELEMENTS: usize = 4_000_000;
/// Largest number of values that all commands of ANSYS set together.
pub const VALUES: usize = 50_000_000;
/// Largest number of values and loads of all load cases of ANSYS together.
pub const HELD: usize = 20_000_000;
