//! Status of a call, and the message of the last failure on this thread.

use std::cell::RefCell;
use std::ffi::{CStr, CString, c_char, c_int};
use std::panic::{AssertUnwindSafe, catch_unwind};

use qless::elimination::EliminationError;
use qless::{AnalysisError, ArgumentError, SystemError};

/// The call succeeded.
pub const OK: c_int = 0;
/// The call succeeded, but the verdict is ambiguous.
pub const AMBIGUOUS: c_int = 1;
/// An argument is not valid.
const INPUT: c_int = -1;
/// Equations conflict.
const CONFLICT: c_int = -2;
/// A block needs too much memory or could not be factored, or the equations are too nearly dependent.
const NUMERICAL: c_int = -3;
/// A bug of the library.
const INTERNAL: c_int = -4;

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

thread_local! {
    static MESSAGE: RefCell<CString> = RefCell::default();
}

/// Runs the work of a call; a failure or panic becomes a status with a message.
pub fn guard(work: impl FnOnce() -> Result<c_int, CallFailure>) -> c_int {
    // Unwind safety: except for `qless_refresh`, no call changes an object that later calls can see before its work is done.
    let failure = match catch_unwind(AssertUnwindSafe(work)) {
        Ok(Ok(status)) => return status,
        Ok(Err(failure)) => failure,
        Err(panic) => {
            let text = panic.downcast_ref::<String>().map(String::as_str).or_else(|| panic.downcast_ref().copied());
            let message = format!("internal error, please report it: {}", text.unwrap_or("no message"));
            CallFailure { status: INTERNAL, message }
        }
    };
    let text = CString::new(failure.message.replace('\0', " ")).unwrap_or_default();
    MESSAGE.with(|message| _ = message.try_borrow_mut().map(|mut message| *message = text));
    failure.status
}

/// Message of the last call that failed on this thread, or an empty text; valid until the next call that fails on it.
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
