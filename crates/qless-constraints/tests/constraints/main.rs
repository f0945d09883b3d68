//! Constraint sets as a user meets them.

/// Types that are linear: fields that they must let through, loads that they must carry.
mod linear_types;
/// Planar and spatial linkages, as sets.
mod linkages;
/// Known ranks of known mechanisms.
mod mechanisms;
/// Residuals of Newton's method.
mod newton;
/// Input that must be refused, and what is said.
mod refused;
