//! Enforcement, Newton's method and equilibrium as a user meets them.

/// Elastic mechanisms side by side: each comes to equilibrium as it does alone.
mod blocks_of_equilibria;
/// Mechanisms side by side: each goes as it goes alone.
mod blocks_of_newton;
/// Chains of bodies.
mod bodies;
/// Linkages with two branches, moved far.
mod branches;
/// Rods along axes in space.
mod chains;
/// Contact by an active set, against a quadratic program.
mod contact;
/// Slider-cranks at and near their dead centres, rods of all lengths, in all units.
mod dead_centres;
/// Equilibria that motors are driven through.
mod driven;
/// Rods said twice, whose rows of G differ by rounding.
mod duplicate_rods;
/// Methods that enforce constraints on a stiffness matrix, against one another.
mod enforcement;
/// Nonlinear equilibrium: beams, chains and mechanisms against what is known of them.
mod equilibria;
/// Parts whose T would fill and that stay factors: the same results as with T.
mod factored;
/// Equilibria of mechanisms, and what is refused.
mod frames;
/// Joints from far off, and what they leave free.
mod joints;
/// Planar and spatial linkages, as sets.
mod linkages;
/// Known ranks of known mechanisms.
mod mechanisms;
/// Mechanisms driven over many turns, against closed forms.
mod motors;
/// Residuals of Newton's method.
mod newton;
/// Nodes on lines and planes that turn.
mod on_line_on_plane;
/// Two blocks of solid elements under tension, tied at meshes that do not match.
mod patch;
/// Finite strain of a periodic cell of solid elements.
mod periodic_cell;
/// Platforms on more arms than they need.
mod platforms;
/// Poses of bodies, independent of the library.
mod poses;
/// Nets of rods and arms from far: redundancies against singular values.
mod redundancy_kinds;
/// No equation is let off because the terms of another are large.
mod residuals;
/// Solutions right to what they state, and refusals, by every method.
mod right_or_refused;
/// Stability of equilibria.
mod stability;
mod steps;
/// Supports of equilibria that are equations, and motions that only rounding resists.
mod supports;
/// Rotation vectors that are kept short.
mod turns;
/// Enforcement of small models against exact arithmetic.
mod whole_numbers;
