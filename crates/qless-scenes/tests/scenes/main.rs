//! Every scene keeps its word: its truth is checked by exact elimination, its shape by what it models.

/// Scales, order and additions leave the truth standing.
mod change;
/// The same bits on every machine.
mod digests;
/// Chains, bands and equations typed with few digits: near dependence, or a look of it.
mod doubtful;
/// Families at small sizes, several seeds.
mod families;
/// Table 1's counts, the tie and mortar twins.
mod fssi;
/// Nets of hinged bodies.
mod linkage;
/// Mortar ties of lines and rectangles.
mod mortar;
/// Mortar ties of curved surfaces.
mod mortar_surface;
/// The oracle against fraction-free elimination on small whole matrices.
mod oracle;
/// The paper's figures and equations.
mod paper;
/// Periodic cells whose faces do not match.
mod periodic_cell;
/// Checks shared by the modules above.
mod support;
