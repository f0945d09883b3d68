//! Householder reflections of one front.

mod block;
mod reflect;
mod staircase;

pub(crate) use reflect::Reflect;
pub(crate) use staircase::{Dense, PANEL, Work, scaled_norm};
