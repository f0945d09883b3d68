//! Constraint sets as a user meets them.

/// Slider-cranks at and near their dead centres, rods of all lengths, in all units.
mod dead_centres;
/// Methods that enforce constraints on a stiffness matrix, against one another.
mod enforcement;
/// Nonlinear equilibrium: beams, chains and mechanisms against what is known of them.
mod equilibria;
/// Parts whose T would fill and that stay factors: the same results as with T.
mod factored;
/// Equilibria of mechanisms, and what is refused.
mod frames;
/// Types that are linear: fields that they must let through, loads that they must carry.
mod linear_types;
/// Planar and spatial linkages, as sets.
mod linkages;
/// Known ranks of known mechanisms.
mod mechanisms;
/// Residuals of Newton's method.
mod newton;
/// Rows of G that are rounding and nothing else.
mod noise;
/// Two blocks of solid elements under tension, tied at meshes that do not match.
mod patch;
/// Finite strain of a periodic cell of solid elements.
mod periodic_cell;
/// Input that must be refused, and what is said.
mod refused;
/// The nearest face of a surface.
mod search;
mod steps;
/// Mortar ties of surfaces: identities of D and M.
mod surface_mortar;
