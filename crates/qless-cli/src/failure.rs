//! Errors that stop a command: a message on standard error and an exit code of [`exit_code`](crate::exit_code).

use std::borrow::Cow;
use std::fmt;
use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;

use qless::backend::BackendError;
use qless::{AnalysisError, ConstraintSystem, OptionError, ReductionError};
use qless_io::deck::Deck;
use qless_io::{ReadError, WriteError};

use crate::wording::{self, printable};
use crate::{exit_code, memory};

/// Why a command failed.
pub enum CliFailure {
    /// A failure that the user can correct.
    Input(String),
    /// The machine lacks memory, threads or disk space.
    Resource(String),
}

impl CliFailure {
    /// Writes the message to standard error and returns the exit code.
    pub fn tell(&self) -> ExitCode {
        say(format_args!("error: {}", self.message()));
        ExitCode::from(self.code())
    }

    /// The message, without a prefix.
    pub fn message(&self) -> &str {
        let (Self::Input(message) | Self::Resource(message)) = self;
        message
    }

    /// The exit code.
    pub fn code(&self) -> u8 {
        match self {
            Self::Input(_) => exit_code::INPUT,
            Self::Resource(_) => exit_code::RESOURCE,
        }
    }

    /// An error of the analysis; the message names the equation by its label and its row from 1.
    pub fn from_analysis(error: AnalysisError, input: &Path, system: Option<&ConstraintSystem>) -> Self {
        match error {
            AnalysisError::Range { row } => Self::Input(format!(
                "{}: {}: the right-hand side is too large for the coefficients (ratio beyond 1e308); \
                 rescale the equation",
                input.display(),
                system.map_or_else(|| format!("row {}", row + 1), |system| wording::equation(system, row))
            )),
            AnalysisError::Subnormal { row } => Self::Input(format!(
                "{}: {}: its coefficients are all below 2.2e-308, where numbers lose their digits; rescale the equation",
                input.display(),
                system.map_or_else(|| format!("row {}", row + 1), |system| wording::equation(system, row))
            )),
            AnalysisError::Option(OptionError::Preference { what, found, count }) => {
                let (input, number) = (input.display(), found + 1);
                let option = if what == "equation" { "--keep" } else { "--prefer-slaves or --avoid-slaves" };
                Self::Input(format!("{input}: {option} names {what} {number}, but there are only {count}; correct it"))
            }
            AnalysisError::Option(OptionError::Contradiction(dof)) => Self::Input(format!(
                "DOF {} is in --prefer-slaves and in --avoid-slaves; take it out of one of them",
                dof + 1
            )),
            AnalysisError::Option(error) => Self::Input(error.to_string()),
            AnalysisError::Backend(BackendError::NotCompiledIn { backend }) => Self::Input(format!(
                "this qless has no backend {backend}: leave out `--backend {backend}`, \
                 or rebuild with `cargo build --features {backend}`"
            )),
            AnalysisError::Backend(error) => Self::from_backend(&error, input),
            AnalysisError::Exact(error) => Self::Resource(format!(
                "{}: {error}; use another --effort, or allow more with --memory",
                input.display()
            )),
            error => Self::Input(format!("{}: {error}", input.display())),
        }
    }

    /// An error in a deck, or in the options for it.
    pub fn from_deck(deck: &Deck, error: &dyn fmt::Display) -> Self {
        Self::Input(format!("{}: {error}", deck.model().files()[0].display()))
    }

    fn from_backend(error: &BackendError, input: &Path) -> Self {
        let message = format!("{}: {error}", input.display());
        match error {
            BackendError::OutOfMemory { .. } => Self::from_memory(&message),
            _ => Self::Resource(message),
        }
    }

    /// Threads could not be started.
    #[expect(clippy::needless_pass_by_value, reason = "for map_err")]
    pub fn from_threads(error: rayon::ThreadPoolBuildError) -> Self {
        Self::Resource(format!("no threads can be started: {error}"))
    }

    /// Out of memory; adds the needed and the allowed bytes.
    pub fn from_memory(message: &str) -> Self {
        Self::Resource(format!("{message}: {}", memory::refusal()))
    }

    /// The equations cannot be solved for slaves.
    pub fn from_reduction(error: ReductionError, input: &Path, system: &ConstraintSystem) -> Self {
        match error {
            ReductionError::NotFinite { dof } => Self::from_overflow(input, dof, &system.dof_label(dof)),
            ReductionError::Residual { row, residual } => Self::Input(format!(
                "{}: {}: the reduced form would leave a relative residual of {residual:.1e}, but 1e-10 is allowed, so nothing was written; the \
                 equations are too nearly dependent: see the report of `qless check`, and remove equations that nearly repeat others",
                input.display(),
                wording::equation(system, row)
            )),
            ReductionError::Backend(error) => Self::from_backend(&error, input),
            error => Self::Input(format!("{}: {error}", input.display())),
        }
    }

    /// A DOF would get a value beyond the range of doubles.
    pub fn from_overflow(input: &Path, dof: usize, label: &str) -> Self {
        let (input, number, label) = (input.display(), dof + 1, wording::label(label));
        Self::Input(format!(
            "{input}: column {number} ({label}): the equations give it a value beyond 1e308; rescale them"
        ))
    }

    /// A file could not be read; `kind` is the system's error, or `None` if the content is malformed.
    pub fn from_reading(message: &str, kind: Option<io::ErrorKind>) -> Self {
        let advice = match kind {
            Some(io::ErrorKind::OutOfMemory) => return Self::from_memory(message),
            Some(io::ErrorKind::FileTooLarge) => return Self::Resource(message.to_owned()),
            Some(io::ErrorKind::NotFound) => "; check the name and the folder you are in",
            Some(io::ErrorKind::PermissionDenied) => "; check its permissions",
            Some(io::ErrorKind::IsADirectory) => "; name a file",
            _ => "",
        };
        Self::Input(format!("{message}{advice}"))
    }

    /// Standard output could not be written.
    pub fn from_stdout(error: &io::Error) -> Self {
        Self::Resource(format!("the report cannot be written to standard output: {error}"))
    }
}

impl From<ReadError> for CliFailure {
    fn from(error: ReadError) -> Self {
        let kind = match &error {
            ReadError::Io { source, .. } => Some(source.kind()),
            _ if error.is_resource() => Some(io::ErrorKind::FileTooLarge),
            _ => None,
        };
        Self::from_reading(&error.to_string(), kind)
    }
}

impl From<WriteError> for CliFailure {
    fn from(error: WriteError) -> Self {
        let message = match &error {
            WriteError::Incomplete { .. } => error.to_string(),
            _ => format!("{error} (nothing was written)"),
        };
        match &error {
            WriteError::IsInput { .. } | WriteError::Linked { .. } => Self::Input(message),
            WriteError::Io { source, .. } if source.kind() == io::ErrorKind::OutOfMemory => Self::from_memory(&message),
            _ => Self::Resource(message),
        }
    }
}

/// Writes a line to standard error. Ignores errors, which could not be reported anywhere.
pub fn say(message: fmt::Arguments) {
    let _ = writeln!(io::stderr(), "{}", printable::text(&message.to_string()));
}

/// Prints a usage error, the help or the version. A usage error repeats what the user typed, so unprintable characters are replaced.
/// Ignores errors, as [`say`] does.
pub fn say_usage(error: &clap::Error) {
    match printable::text(&error.render().to_string()) {
        Cow::Borrowed(_) => drop(error.print()),
        Cow::Owned(harmless) => say(format_args!("{}", harmless.trim_end())),
    }
}
