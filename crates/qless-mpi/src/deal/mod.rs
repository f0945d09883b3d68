//! Which rank analyses which component, and the equations on their way there.

mod balance;
mod peel;
mod travel;

pub(crate) use balance::{Load, balance};
pub(crate) use peel::{Peel, Sizes, peel, sizes};
pub(crate) use travel::{Guests, travel};
