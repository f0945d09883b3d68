//! Formats of decks, and the solvers that read them.

use std::path::Path;
use std::str::FromStr;

use crate::bytes::without_gz;

/// The format of a deck.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// CalculiX and Abaqus, `.inp`.
    Calculix,
    /// ANSYS archives, `.cdb`.
    Ansys,
    /// Nastran, `.bdf`, `.dat`, `.nas`.
    Nastran,
    /// LS-DYNA keyword files, `.k`, `.key`, `.dyn`.
    LsDyna,
    /// Radioss starter files, `.rad`.
    Radioss,
}

impl Format {
    /// All formats.
    pub const ALL: [Self; 5] = [Self::Calculix, Self::Ansys, Self::Nastran, Self::LsDyna, Self::Radioss];

    /// The format that the ending of a path stands for; a final `.gz` is ignored.
    pub fn from_path(path: &Path) -> Option<Self> {
        if let Some(path) = without_gz(path) {
            return Self::from_path(path);
        }
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "inp" => Some(Self::Calculix),
            "cdb" => Some(Self::Ansys),
            "bdf" | "dat" | "nas" | "fem" => Some(Self::Nastran),
            "k" | "key" | "dyn" => Some(Self::LsDyna),
            "rad" => Some(Self::Radioss),
            _ => None,
        }
    }
}

impl std::fmt::Display for Format {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Calculix => "CalculiX or Abaqus",
            Self::Ansys => "ANSYS",
            Self::Nastran => "Nastran",
            Self::LsDyna => "LS-DYNA",
            Self::Radioss => "Radioss",
        })
    }
}

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
    /// LS-DYNA.
    LsDyna,
    /// Radioss and OpenRadioss.
    Radioss,
}

/// A solver name that is none of the known ones.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is not a known solver; use one of ccx, abaqus, nastran, mystran, optistruct, ansys, lsdyna, radioss")]
pub struct UnknownSolver(String);

impl Solver {
    /// All solvers.
    pub const ALL: [Self; 8] = [
        Self::Ccx,
        Self::Abaqus,
        Self::Nastran,
        Self::Mystran,
        Self::Optistruct,
        Self::Ansys,
        Self::LsDyna,
        Self::Radioss,
    ];

    /// The solvers that read a format.
    pub fn that_read(format: Format) -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().filter(move |solver| solver.format() == format)
    }

    /// The format that the solver reads.
    pub fn format(self) -> Format {
        match self {
            Self::Ccx | Self::Abaqus => Format::Calculix,
            Self::Nastran | Self::Mystran | Self::Optistruct => Format::Nastran,
            Self::Ansys => Format::Ansys,
            Self::LsDyna => Format::LsDyna,
            Self::Radioss => Format::Radioss,
        }
    }

    /// The name of the solver on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ccx => "ccx",
            Self::Abaqus => "abaqus",
            Self::Nastran => "nastran",
            Self::Mystran => "mystran",
            Self::Optistruct => "optistruct",
            Self::Ansys => "ansys",
            Self::LsDyna => "lsdyna",
            Self::Radioss => "radioss",
        }
    }
}

/// Gives the default solver of a format.
impl From<Format> for Solver {
    fn from(format: Format) -> Self {
        match format {
            Format::Calculix => Self::Ccx,
            Format::Nastran => Self::Nastran,
            Format::Ansys => Self::Ansys,
            Format::LsDyna => Self::LsDyna,
            Format::Radioss => Self::Radioss,
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
