//! Finds which equations are connected across ranks; no rank sees all equations.

mod connected;
mod directory;
mod labels;
mod layout;
mod touched;

pub(crate) use connected::{ConnectedComponent, ConnectedComponents, NONE};
pub(crate) use directory::{Directory, KnownDofs};
pub(crate) use layout::Layout;
pub(crate) use touched::TouchedDofs;
