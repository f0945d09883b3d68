//! Public behaviour of enforcement, Newton's method and equilibrium.

/// Chains of bodies.
mod bodies;
/// Linkages with two branches, moved far.
mod branches;
/// Rods nearly along an axis in space.
mod chains;
/// Contact by an active set, compared with a quadratic program.
mod contact;
/// Steps of Newton's method near redundant loops, compared with dense Gauss-Newton.
mod convergence;
/// Slider-cranks at and near their dead centres, for rods of all lengths, in all units.
mod dead_centres;
/// Equilibria driven by motors.
mod driven;
/// Duplicate rods, whose rows of G differ by rounding.
mod duplicate_rods;
/// Methods of enforcement, compared with each other.
mod enforcement;
/// Nonlinear equilibrium of beams, chains and mechanisms with known solutions.
mod equilibria;
/// Components whose T would fill and is kept as factors: the same results as with T.
mod factored;
/// Equilibria of mechanisms, and refused input.
mod frames;
/// Joints assembled from far away, and their free motions.
mod joints;
/// Planar and spatial linkages, shared by the tests.
mod linkages;
/// Known ranks of mechanisms.
mod mechanisms;
/// Moments in space at rotation vectors and Euler parameters.
mod moments;
/// Mechanisms driven over many turns, compared with closed forms.
mod motors;
/// Convergence of Newton's method.
mod newton;
/// Nodes on moving lines and planes.
mod on_line_on_plane;
/// Independent elastic mechanisms: each reaches the equilibrium that it reaches alone.
mod parts_of_equilibria;
/// Independent mechanisms: each is solved as it is solved alone.
mod parts_of_newton;
/// Patch tests: blocks of solid elements under tension, with non-matching meshes.
mod patch;
/// Finite strain of a periodic cell of solid elements.
mod periodic_cell;
/// Platforms on more arms than they need.
mod platforms;
/// Poses of bodies, implemented independently of the library.
mod poses;
/// Random nets of rods and arms: redundancies compared with singular values.
mod redundancy_kinds;
/// No equation may be violated because the terms of another are large.
mod residuals;
/// Every method returns an accurate solution or refuses the model.
mod right_or_refused;
/// Stability of equilibria.
mod stability;
/// `Steps` with each solver and each storage of K.
mod steps;
/// Supports that are equations, and motions that only rounding resists.
mod supports;
/// Rotation vectors are kept short.
mod turns;
/// Enforcement of small models, compared with exact arithmetic.
mod whole_numbers;
/// Tangents that are not the slopes of their forces.
mod wrong_tangents;
