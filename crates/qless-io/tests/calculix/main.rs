//! Constraints of CalculiX and Abaqus decks.

/// What Abaqus reads in another way than ccx.
mod abaqus;
/// Abaqus parts, instances and assemblies.
mod assembly;
/// `*RIGID BODY` and `*COUPLING`, in each solver's meaning.
mod bodies;
/// Comparison with runs of ccx.
mod ccx;
/// Cards that are left out, and the DOFs that they claim.
mod claims;
/// Helpers: decks from text, and models as text.
mod from_text;
/// Nodes and elements that cards of Abaqus generate.
mod generated;
/// Parameters of Abaqus.
mod parameters;
/// `*PRE-TENSION SECTION` of ccx.
mod pre_tension;
/// Decks that stop ccx when it reads them.
mod refused;
/// Masters that an equation names twice, in ccx.
mod repeated;
/// Prescribed values by step, and their time histories.
mod steps;
