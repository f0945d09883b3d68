//! The constraint types.
//!
//! | folder or file | types |
//! | --- | --- |
//! | `dof_equations` | linear, driven and prescribed equations, equal DOFs |
//! | `ties` | nodes on elements and lines, h- and p-refinement, periodic and cyclic cells |
//! | `mortar` | meshes of lines or surfaces that do not match, tied by integrals |
//! | `couplings` | rigid bodies, averages, beams and shells on solids, fluids at walls |
//! | `joints` | joints and motors of multibody systems |
//! | `distance`, `on_line`, `on_plane`, `on_sphere`, `volume` | nonlinear conditions on points |
//!
//! Lengths are in the unit of the coordinates, angles in radians. The coordinates are those of the reference
//! configuration, in which all DOFs are zero.

// Each constraint type includes a picture and a text of the same name before its `# Example`. `examples/pictures` writes
// the picture to `docs/pictures`. The text is in `docs/types`; all texts have the same headings.

mod couplings;
mod distance;
mod dof_equations;
mod joints;
mod mortar;
mod on_line;
mod on_plane;
mod on_sphere;
mod ties;
mod volume;

pub use crate::geometry::node::{Node, PlanarPoint, Point};
pub use crate::geometry::pairs::{PairError, pairs};
pub use crate::geometry::polynomials::Polynomials;
pub use crate::geometry::search::{FaceSearch, Nearest, SearchError};
pub use crate::geometry::sector_rotation::{Turn, TurnError};
pub use crate::geometry::shape::Shape;
pub use crate::geometry::surface::{Face, Surface, SurfaceError};
pub use couplings::{
    Average, Axes, AxesError, BeamToSolid, Component, CouplingError, FluidNode, FluidNormal, FluidNormalError,
    FluidWall, FluidWallError, LineFault, Local, Node6, RigidBody, Section, ShellToSolid, SmallRigidBody,
    ThicknessLine,
};
pub use distance::{Distance, DistanceError};
pub use dof_equations::{
    Driven, DrivenError, Equal, EqualError, LinearEquation, LinearEquationError, Prescribed, PrescribedError,
};
pub use joints::{
    Body, BodyPoint, Cylindrical, Fixed, JointError, Parallel, Perpendicular, Planar, Prismatic, Revolute,
    RotationMotor, Spherical, TranslationMotor, Universal,
};
pub use mortar::{MortarError, MortarTie, Multipliers};
pub use on_line::{Line, OnLine, OnLineError};
pub use on_plane::{OnPlane, OnPlaneError, Plane};
pub use on_sphere::{OnSphere, OnSphereError};
pub use ties::{
    Cyclic, CyclicError, CyclicHarmonic, FaceOrderTie, FaceOrderTieError, FaceSide, HangingNode, HangingNodeError,
    LineTie, LineTieError, MacroStrain, NodeTie, NodeTieError, OrderTie, OrderTieError, Periodic, PeriodicError,
    TieSide, Turning,
};
pub use volume::{Volume, VolumeError};
