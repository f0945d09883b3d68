//! Public behaviour of constraint sets and types.

/// Linearised equations of sets that change.
mod active;
/// Ties with numbers that are not finite, vanish or are huge.
mod bad_numbers;
/// Constraints added in bulk equal those added one by one.
mod body_points;
mod bulk;
/// Linearised sets, ranks and random numbers for the tests.
mod common;
/// Rigid bodies and averages of nodes with rotations, beams and shells on solids, walls of fluids.
mod couplings;
/// Dual multipliers of mortar ties: biorthogonal, local, and as accurate as standard ones.
mod dual_mortar;
/// Nodes embedded in solids.
mod embedded;
/// Faces of p-refinement.
mod face_orders;
/// Nodes with any number of fields.
mod fields;
/// Hanging nodes of h- and p-refinement.
mod hanging;
/// A set that changes equals a new set.
mod incremental_updates;
/// Linear types: fields that pass, loads that are carried.
mod linear_types;
/// Numbers and meshes that are refused, and noise that must not become an equation.
mod misuse;
/// Rows of G that are rounding and nothing else.
mod noise;
mod one_body;
/// The page of each type.
mod pages;
/// Refused input and its messages.
mod refused;
mod resting;
/// Models in units of any size.
mod scales;
/// The nearest face of a surface.
mod search;
/// Mortar ties of surfaces: identities of D and M.
mod surface_mortar;
/// Right-hand sides and parameters that are functions of time.
mod time;
