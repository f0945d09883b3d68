//! What each card that constrains says, as equations and prescribed values.

pub mod boundary;
pub mod coupling;
pub mod cyclic;
pub mod equation;
pub mod geometric;
pub mod mpc;
pub mod old_coupling;
pub mod refused;
pub mod rigid;
pub mod tie;
pub mod unread;
