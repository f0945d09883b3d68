//! Status of a call, and the message of the last failure on this thread.

use std::any::Any;
use std::cell::RefCell;
use std::ffi::{CStr, CString, c_char, c_int};
use std::panic::{AssertUnwindSafe, catch_unwind};

use qless::backend::BackendError;
use qless::elimination::EliminationError;
use qless::{AnalysisError, ArgumentError, SystemError};
use qless_io::deck::clean::CleanError;
use qless_io::{ReadError, WriteError};
use qless_mpi::{CodedError, ErrorWords};

/// The call succeeded.
pub const OK: c_int = 0;
/// The call succeeded, but the verdict is ambiguous.
pub const AMBIGUOUS: c_int = 1;
/// The call succeeded, but constraints of the deck were left out.
pub const INCOMPLETE: c_int = 2;
/// An argument is not valid.
const INPUT: c_int = -1;
/// Equations conflict.
const CONFLICT: c_int = -2;
/// A block needs too much memory or could not be factored, or the equations are too nearly dependent.
const NUMERICAL: c_int = -3;
/// A bug of the library.
const INTERNAL: c_int = -4;
/// A file cannot be read or written, or a deck is malformed or cannot be cleaned.
const FILE: c_int = -5;
/// A function of the caller that passes messages between ranks failed.
const RANKS: c_int = -6;

/// A call that failed.
#[derive(Debug)]
pub struct CallFailure {
    status: c_int,
    message: String,
}

impl CallFailure {
    pub fn input(message: impl Into<String>) -> Self {
        Self { status: INPUT, message: message.into() }
    }

    /// A function of the caller could not pass messages.
    pub fn ranks(message: String) -> Self {
        Self { status: RANKS, message }
    }

    /// A failure on one rank, before all ranks learn of it.
    pub fn on_rank(self, rank: usize) -> Self {
        Self { message: format!("rank {rank}: {}", self.message), ..self }
    }

    /// A panic ended an earlier call while it changed the object of a handle.
    pub fn half_changed() -> Self {
        let found = "a bug of the library ended an earlier call on this handle and left its object half changed";
        Self { status: INTERNAL, message: format!("{found}; free the handle and make it again") }
    }
}

impl From<SystemError> for CallFailure {
    fn from(error: SystemError) -> Self {
        Self::input(error.to_string())
    }
}

impl From<ArgumentError> for CallFailure {
    fn from(error: ArgumentError) -> Self {
        Self::input(error.to_string())
    }
}

impl From<BackendError> for CallFailure {
    fn from(error: BackendError) -> Self {
        Self { status: NUMERICAL, message: error.to_string() }
    }
}

impl From<ReadError> for CallFailure {
    fn from(error: ReadError) -> Self {
        Self { status: FILE, message: error.to_string() }
    }
}

impl From<WriteError> for CallFailure {
    fn from(error: WriteError) -> Self {
        Self { status: FILE, message: error.to_string() }
    }
}

impl From<CleanError> for CallFailure {
    fn from(error: CleanError) -> Self {
        let status = match error {
            CleanError::Conflicting { .. } => CONFLICT,
            CleanError::Doubtful { .. } | CleanError::Analysis(_) | CleanError::Reduction(_) => NUMERICAL,
            CleanError::Unproven { .. } => INTERNAL,
            _ => FILE,
        };
        Self { status, message: error.to_string() }
    }
}

impl From<AnalysisError> for CallFailure {
    fn from(error: AnalysisError) -> Self {
        let status = if matches!(error, AnalysisError::Backend(_)) { NUMERICAL } else { INPUT };
        Self { status, message: error.to_string() }
    }
}

impl From<EliminationError> for CallFailure {
    fn from(error: EliminationError) -> Self {
        use qless::change::RefreshError;
        let status = match error {
            EliminationError::Conflicting { .. } => CONFLICT,
            EliminationError::Argument(_)
            | EliminationError::Matrix(_)
            | EliminationError::Refresh(RefreshError::Argument(_)) => INPUT,
            _ => NUMERICAL,
        };
        Self { status, message: error.to_string() }
    }
}

impl From<qless_mpi::Error> for CallFailure {
    fn from(error: qless_mpi::Error) -> Self {
        use qless_mpi::Error::{Conflicting, Option, Options, Share};
        let status = match error {
            Conflicting { .. } => CONFLICT,
            Option(_) | Options { .. } | Share(_) => INPUT,
            _ => NUMERICAL,
        };
        Self { status, message: error.to_string() }
    }
}

/// All ranks return the failure of one.
impl ErrorWords for CallFailure {
    fn to_words(&self) -> Vec<u64> {
        CodedError { code: self.status.unsigned_abs().into(), text: self.message.clone() }.to_words()
    }

    fn from_words(words: &[u64]) -> Self {
        let CodedError { code, text } = CodedError::from_words(words);
        Self { status: -(code as c_int), message: text }
    }
}

/// Ends the call with this failure where Rust code between cannot return one. It unwinds to [`guard`], through no function of C.
pub fn end_call(failure: CallFailure) -> ! {
    // Unlike `panic!` this prints nothing.
    std::panic::resume_unwind(Box::new(failure))
}

thread_local! {
    static MESSAGE: RefCell<CString> = RefCell::default();
}

fn internal(panic: &(dyn Any + Send)) -> CallFailure {
    let text = panic.downcast_ref::<String>().map(String::as_str).or_else(|| panic.downcast_ref().copied());
    let message = format!("internal error, please report it: {}", text.unwrap_or("no message"));
    CallFailure { status: INTERNAL, message }
}

/// Runs the work of a call; a failure or panic becomes a status with a message.
pub fn guard(work: impl FnOnce() -> Result<c_int, CallFailure>) -> c_int {
    // Unwind safety: a call that changes the object of a handle holds its lock exclusively, and a panic poisons the lock.
    let failure = match catch_unwind(AssertUnwindSafe(work)) {
        Ok(Ok(status)) => return status,
        Ok(Err(failure)) => failure,
        Err(panic) => panic.downcast().map_or_else(|panic| internal(&*panic), |failure| *failure),
    };
    let text = CString::new(failure.message.replace('\0', " ")).unwrap_or_default();
    MESSAGE.with(|message| _ = message.try_borrow_mut().map(|mut message| *message = text));
    failure.status
}

/// Message of the last call that failed on this thread, or an empty text. It is valid until the next call that fails on this thread.
#[unsafe(no_mangle)]
pub extern "C" fn qless_message() -> *const c_char {
    MESSAGE.with(|message| message.try_borrow().map_or(c"".as_ptr(), |message| message.as_ptr()))
}

/// Version of the library, such as "0.1.0"; valid for ever.
#[unsafe(no_mangle)]
pub extern "C" fn qless_version() -> *const c_char {
    const VERSION: &CStr = match CStr::from_bytes_with_nul(concat!(env!("CARGO_PKG_VERSION"), "\0").as_bytes()) {
        Ok(version) => version,
        Err(_) => c"",
    };
    VERSION.as_ptr()
}
