//! The solver whose behaviour counts: what a card means to it, and what it does where two cards claim one DOF.

mod abaqus;
mod ansys;
mod cascade;
pub(super) mod ccx;
pub(super) mod kind;
mod nastran;
mod outcome;
mod profile;

use std::str::FromStr;

use super::Format;
use super::clean::Fault;
use super::model::Model;

pub use outcome::Outcome;
pub(super) use profile::Profile;

/// A finite-element solver.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Solver {
    /// CalculiX.
    Ccx,
    /// Abaqus/Standard.
    Abaqus,
    /// MSC and Simcenter Nastran.
    Nastran,
    /// MYSTRAN.
    Mystran,
    /// OptiStruct.
    Optistruct,
    /// ANSYS Mechanical APDL.
    Ansys,
}

/// Not one of the names of [`Solver`].
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is no solver that is known here; take one of ccx, abaqus, nastran, mystran, optistruct, ansys")]
pub struct UnknownSolver(String);

impl Solver {
    /// All of them.
    pub const ALL: [Self; 6] = [Self::Ccx, Self::Abaqus, Self::Nastran, Self::Mystran, Self::Optistruct, Self::Ansys];

    /// Those that read a format.
    pub fn that_read(format: Format) -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().filter(move |solver| solver.format() == format)
    }

    /// The language that it reads.
    pub fn format(self) -> Format {
        match self {
            Self::Ccx | Self::Abaqus => Format::Calculix,
            Self::Nastran | Self::Mystran | Self::Optistruct => Format::Nastran,
            Self::Ansys => Format::Ansys,
        }
    }

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ccx => "ccx",
            Self::Abaqus => "abaqus",
            Self::Nastran => "nastran",
            Self::Mystran => "mystran",
            Self::Optistruct => "optistruct",
            Self::Ansys => "ansys",
        }
    }

    /// What it does with a fault of a deck. For the faults of a whole load case, [`clean::findings`](super::clean::findings) also
    /// knows which claims are left when others have been dropped.
    ///
    /// ```
    /// use qless_io::deck::{Outcome, Solver, clean, read};
    /// # let place = tempfile::tempdir()?;
    /// let path = place.path().join("tie.inp");
    /// std::fs::write(&path, "*BOUNDARY\n1,1\n*EQUATION\n2\n1,1,1.,2,1,-1.\n")?;
    /// let deck = read(&path)?;
    /// let fault = &clean::faults(deck.model())[0];
    /// assert_eq!(Solver::Ccx.outcome(fault, deck.model()), Outcome::Refused);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn outcome(self, fault: &Fault, model: &Model) -> Outcome {
        Profile::new(self, model).outcome(fault)
    }

    /// What it does with two values for one DOF in one step: the first claim is the first value.
    ///
    /// CalculiX takes the last one. The others are said to stop: Nastran and MYSTRAN do where the values differ, Abaqus where both
    /// cards are in one step; ANSYS takes the last.
    pub fn prescribed_twice(self) -> Outcome {
        match self {
            Self::Ccx | Self::Ansys => Outcome::IgnoresFirst,
            Self::Abaqus | Self::Nastran | Self::Mystran | Self::Optistruct => Outcome::Refused,
        }
    }
}

/// The solver that a format stands for where none is named.
impl From<Format> for Solver {
    fn from(format: Format) -> Self {
        match format {
            Format::Calculix => Self::Ccx,
            Format::Nastran => Self::Nastran,
            Format::Ansys => Self::Ansys,
        }
    }
}

impl FromStr for Solver {
    type Err = UnknownSolver;

    fn from_str(name: &str) -> Result<Self, UnknownSolver> {
        let same = |solver: &Self| solver.name().eq_ignore_ascii_case(name);
        Self::ALL.into_iter().find(same).ok_or_else(|| UnknownSolver(name.to_owned()))
    }
}

impl std::fmt::Display for Solver {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}
