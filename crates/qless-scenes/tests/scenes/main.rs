//! The truth of every scene is checked by exact elimination, its geometry by the properties of the model.

/// The truth holds after changes of scale and order and after additions.
mod change;
/// Digests of scenes, which must be the same on every machine.
mod digests;
/// Chains, bands and equations typed with few digits, some of them near dependence.
mod doubtful;
/// Families at small sizes with several seeds.
mod families;
/// The tie and mortar twins and the sizes of Table 1.
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
