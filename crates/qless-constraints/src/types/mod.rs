//! The constraint types, one file each.
//!
//! Lengths are in the unit of the coordinates, angles in radians. All DOFs are zero in the reference configuration, that is
//! where the coordinates hold.

// A new type has a page: a picture in `examples/pictures`, which that example writes to `docs/pictures`, a text under the same name in
// `docs/types` with the headings of the others, and two lines before its `# Example` that put both there.

mod average;
mod couplings;
mod cyclic;
mod distance;
mod driven;
mod equal;
mod euler_norm;
mod face_order;
mod fluid;
mod hanging;
mod interpolation;
mod joints;
mod line_tie;
mod linear;
mod mortar;
mod node_tie;
mod on_line;
mod on_plane;
mod on_sphere;
mod order_tie;
mod periodic;
mod prescribed;
mod rigid_finite;
mod rigid_small;
mod volume;

pub use crate::geometry::carrier::Body;
pub use crate::geometry::node::{Node, PlanarPoint, Point};
pub use crate::geometry::pairs::{PairError, pairs};
pub use crate::geometry::polynomials::Polynomials;
pub use crate::geometry::search::{FaceSearch, Nearest, SearchError};
pub use crate::geometry::shape::Shape;
pub use crate::geometry::surface::{Face, Surface, SurfaceError};
pub use crate::geometry::turn::{Turn, TurnError};
pub use average::Average;
pub use couplings::{
    Axes, AxesError, BeamToSolid, Component, CouplingError, FluidNode, FluidWall, FluidWallError, LineFault, Local,
    Node6, Section, ShellToSolid, ThicknessLine,
};
pub use cyclic::{Cyclic, CyclicError, CyclicHarmonic, Turning};
pub use distance::{Distance, DistanceError};
pub use driven::{Driven, DrivenError};
pub use equal::{Equal, EqualError};
pub use euler_norm::EulerNorm;
pub use face_order::{FaceOrderTie, FaceOrderTieError, FaceSide, Side};
pub use fluid::{FluidNormal, FluidNormalError};
pub use hanging::{HangingNode, HangingNodeError};
pub use joints::{
    Cylindrical, Fixed, JointError, Parallel, Perpendicular, Planar, Prismatic, Revolute, RotationMotor, Spherical,
    TranslationMotor, Universal,
};
pub use line_tie::{LineTie, LineTieError};
pub use linear::{LinearEquation, LinearEquationError};
pub use mortar::{MortarError, MortarTie, Multipliers};
pub use node_tie::{NodeTie, NodeTieError};
pub use on_line::{Line, OnLine, OnLineError};
pub use on_plane::{OnPlane, OnPlaneError, Plane};
pub use on_sphere::{OnSphere, OnSphereError};
pub use order_tie::{OrderTie, OrderTieError};
pub use periodic::{MacroStrain, Periodic, PeriodicError};
pub use prescribed::{Prescribed, PrescribedError};
pub use rigid_finite::RigidBody;
pub use rigid_small::SmallRigidBody;
pub use volume::{Volume, VolumeError};
