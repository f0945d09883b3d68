//! Constraint sets as a user meets them.

/// Linearised equations of sets that change.
mod active;
/// Ties given numbers that are not finite, vanish or are huge.
mod bad_numbers;
/// Nodes on lines and planes that turn.
mod beads;
/// Elastic mechanisms side by side: each comes to equilibrium as it does alone.
mod blocks_of_equilibria;
/// Mechanisms side by side: each goes as it goes alone.
mod blocks_of_newton;
/// Chains of bodies.
mod bodies;
/// Linkages with two branches, moved far.
mod branches;
/// Constraints that are added all at once: the same as one by one.
mod bulk;
/// Rods along axes in space.
mod chains;
/// Contact by an active set, against a quadratic program.
mod contact;
/// Rigid bodies and averages of nodes with rotations, beams and shells on solids, walls of fluids.
mod couplings;
/// Slider-cranks at and near their dead centres, rods of all lengths, in all units.
mod dead_centres;
/// Equilibria that motors are driven through.
mod driven;
/// Dual multipliers of mortar ties: biorthogonal, local, and as exact as the others.
mod dual_mortar;
/// Nodes embedded in solids.
mod embedded;
/// Methods that enforce constraints on a stiffness matrix, against one another.
mod enforcement;
/// Nonlinear equilibrium: beams, chains and mechanisms against what is known of them.
mod equilibria;
/// Faces of p-refinement.
mod face_orders;
/// Parts whose T would fill and that stay factors: the same results as with T.
mod factored;
/// Nodes with any number of fields.
mod fields;
/// Equilibria of mechanisms, and what is refused.
mod frames;
/// Hanging nodes of h- and p-refinement.
mod hanging;
/// No equation is let off because the terms of another are large.
mod holds;
/// Joints from far off, and what they leave free.
mod joints;
/// Types that are linear: fields that they must let through, loads that they must carry.
mod linear_types;
/// Planar and spatial linkages, as sets.
mod linkages;
/// Sets that change: the same as new ones.
mod living;
/// Known ranks of known mechanisms.
mod mechanisms;
/// Numbers and meshes that no equation may be made of, and noise that must not become one.
mod misuse;
/// Mechanisms driven over many turns, against closed forms.
mod motors;
/// Nets of rods and arms from far: redundancies against singular values.
mod nets;
/// Residuals of Newton's method.
mod newton;
/// Rows of G that are rounding and nothing else.
mod noise;
/// The page of each type.
mod pages;
/// Two blocks of solid elements under tension, tied at meshes that do not match.
mod patch;
/// Finite strain of a periodic cell of solid elements.
mod periodic_cell;
/// Platforms on more arms than they need.
mod platforms;
/// Poses of bodies, independent of the library.
mod poses;
/// Input that must be refused, and what is said.
mod refused;
/// Solutions right to what they state, and refusals, by every method.
mod right_or_refused;
/// Models in units of any size.
mod scales;
/// The nearest face of a surface.
mod search;
/// Stability of equilibria.
mod stability;
mod steps;
/// Supports of equilibria that are equations, and motions that only rounding resists.
mod supports;
/// Mortar ties of surfaces: identities of D and M.
mod surface_mortar;
/// Right-hand sides and parameters that are functions of time.
mod time;
/// Rotation vectors that are kept short.
mod turns;
/// Rods said twice, whose rows of G differ by rounding.
mod twins;
/// Enforcement of small models against exact arithmetic.
mod whole_numbers;
