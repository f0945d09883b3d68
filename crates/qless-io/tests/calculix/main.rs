//! CalculiX and Abaqus decks in, constraints out.

/// Parts, instances and assemblies.
mod assembly;
/// `*RIGID BODY` and `*COUPLING` as each solver has them.
mod bodies;
/// What ccx itself does with these decks.
mod ccx;
/// Cards that are left out by name, and the DOFs that they claim.
mod claims;
/// Decks from text, and what was read as text.
mod given;
/// What ccx stops at when it reads a deck.
mod refused;
/// Masters that an equation names twice, in ccx.
mod repeated;
/// Values, their courses, and what holds in each step.
mod steps;
