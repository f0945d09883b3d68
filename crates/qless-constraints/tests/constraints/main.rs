//! Constraint sets as a user meets them.

/// Nodes on lines and planes that turn.
mod beads;
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
/// Joints from far off, and what they leave free.
mod joints;
/// Types that are linear: fields that they must let through, loads that they must carry.
mod linear_types;
/// Planar and spatial linkages, as sets.
mod linkages;
/// Known ranks of known mechanisms.
mod mechanisms;
/// Mechanisms driven over many turns, against closed forms.
mod motors;
/// Residuals of Newton's method.
mod newton;
/// Rows of G that are rounding and nothing else.
mod noise;
/// Two blocks of solid elements under tension, tied at meshes that do not match.
mod patch;
/// Finite strain of a periodic cell of solid elements.
mod periodic_cell;
/// Poses of bodies, independent of the library.
mod poses;
/// Input that must be refused, and what is said.
mod refused;
/// The nearest face of a surface.
mod search;
mod steps;
/// Mortar ties of surfaces: identities of D and M.
mod surface_mortar;
/// Right-hand sides and parameters that are functions of time.
mod time;
/// Rotation vectors that are kept short.
mod turns;
