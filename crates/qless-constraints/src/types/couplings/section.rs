//! How a cross-section of a solid follows a beam or a shell.

/// What stays of the shape of the cross-section.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Section {
    /// It is rigid: `u_i = u_r + theta x r_i` at each node. Lateral contraction is held.
    Rigid,
    /// It stays plane and is free to contract: across it each node follows the rigid motion, within it their mean does.
    Plane,
    /// It is free to warp and to contract: the beam or shell moves as the mean of the face; a load on it is spread over the face.
    Mean,
}
