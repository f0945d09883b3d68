//! Constraint sets as a user meets them.

/// Rigid bodies and averages of nodes with rotations, beams and shells on solids, walls of fluids.
mod couplings;
/// Methods that enforce constraints on a stiffness matrix, against one another.
mod enforcement;
/// Parts whose T would fill and that stay factors: the same results as with T.
mod factored;
/// Types that are linear: fields that they must let through, loads that they must carry.
mod linear_types;
/// Planar and spatial linkages, as sets.
mod linkages;
/// Known ranks of known mechanisms.
mod mechanisms;
/// Residuals of Newton's method.
mod newton;
/// Two blocks of solid elements under tension, tied at meshes that do not match.
mod patch;
/// Input that must be refused, and what is said.
mod refused;
/// The nearest face of a surface.
mod search;
mod steps;
/// Mortar ties of surfaces: identities of D and M.
mod surface_mortar;
