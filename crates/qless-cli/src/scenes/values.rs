//! What the options of scenes can be.

use clap::ValueEnum;
use qless_scenes::families::{Edges, Faces, Near, Surface};
use qless_scenes::fssi::Level;
use qless_scenes::paper::FloorInput;

#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum Coupling {
    /// Each node to the face beside it; 12 redundant equations per layer
    Tie,
    /// Mortar integrals; the numerical rank is ambiguous
    Mortar,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum Form {
    /// All with u1
    Star,
    /// Each with the one before
    Chain,
    /// All with u4
    Accepted,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum ColumnName {
    /// In a DOF that two of the three rows hold
    Own,
    /// In a DOF that all three hold
    Shared,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum FaceKind {
    /// Bilinear, of hexahedra
    Quads,
    /// Linear, of tetrahedra
    Triangles,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum ShapeName {
    /// Flat
    Plane,
    /// 106 degrees of a cylinder
    Cylinder,
    /// Part of a sphere
    Sphere,
    /// Hills and valleys
    Waves,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum Edging {
    /// Nodes at the same places
    Matching,
    /// Each edge has its own
    Own,
}

/// A number that is neither NaN nor infinite.
pub fn finite(text: &str) -> Result<f64, String> {
    let number = text.parse().map_err(|_| "not a number; write it as 0.001 or 1e-3".to_owned())?;
    if f64::is_finite(number) { Ok(number) } else { Err("the number must be finite".to_owned()) }
}

/// `110` or `110%`.
pub fn level(text: &str) -> Result<Level, String> {
    let percent = text.trim_end_matches('%').parse();
    let of = |percent: usize| Level::ALL.into_iter().find(|level| level.percent() == percent);
    percent.ok().and_then(of).ok_or_else(|| "the levels are 50, 60, 70, 80, 90, 100 and 110".to_owned())
}

impl From<Form> for FloorInput {
    fn from(form: Form) -> Self {
        match form {
            Form::Star => Self::Star,
            Form::Chain => Self::Chain,
            Form::Accepted => Self::Accepted,
        }
    }
}

impl From<ColumnName> for Near {
    fn from(column: ColumnName) -> Self {
        match column {
            ColumnName::Own => Self::Own,
            ColumnName::Shared => Self::Shared,
        }
    }
}

impl From<FaceKind> for Faces {
    fn from(kind: FaceKind) -> Self {
        match kind {
            FaceKind::Quads => Self::Quads,
            FaceKind::Triangles => Self::Triangles,
        }
    }
}

impl From<ShapeName> for Surface {
    fn from(shape: ShapeName) -> Self {
        match shape {
            ShapeName::Plane => Self::Plane,
            ShapeName::Cylinder => Self::Cylinder,
            ShapeName::Sphere => Self::Sphere,
            ShapeName::Waves => Self::Waves,
        }
    }
}

impl From<Edging> for Edges {
    fn from(edging: Edging) -> Self {
        match edging {
            Edging::Matching => Self::Matching,
            Edging::Own => Self::Own,
        }
    }
}
