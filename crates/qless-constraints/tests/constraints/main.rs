//! Constraint sets as a user meets them.

/// Linearised equations of sets that change.
mod active;
/// Ties given numbers that are not finite, vanish or are huge.
mod bad_numbers;
/// Constraints that are added all at once: the same as one by one.
mod bulk;
/// Linearised sets, ranks and random numbers for the tests.
mod common;
/// Rigid bodies and averages of nodes with rotations, beams and shells on solids, walls of fluids.
mod couplings;
/// Dual multipliers of mortar ties: biorthogonal, local, and as exact as the others.
mod dual_mortar;
/// Nodes embedded in solids.
mod embedded;
/// Faces of p-refinement.
mod face_orders;
/// Nodes with any number of fields.
mod fields;
/// Hanging nodes of h- and p-refinement.
mod hanging;
/// Sets that change: the same as new ones.
mod incremental_updates;
/// Types that are linear: fields that they must let through, loads that they must carry.
mod linear_types;
/// Numbers and meshes that no equation may be made of, and noise that must not become one.
mod misuse;
/// Rows of G that are rounding and nothing else.
mod noise;
/// The page of each type.
mod pages;
/// Input that must be refused, and what is said.
mod refused;
/// Models in units of any size.
mod scales;
/// The nearest face of a surface.
mod search;
/// Mortar ties of surfaces: identities of D and M.
mod surface_mortar;
/// Right-hand sides and parameters that are functions of time.
mod time;
