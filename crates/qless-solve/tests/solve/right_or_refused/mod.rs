//! Solutions that are right to what they state, and models that are refused with the motion that nothing holds.

mod blocks;
mod costs;
mod dense;
mod extremes;
mod half;
mod large;
mod methods;
mod models;
mod noise_of_t;
mod penalties;
pub mod random;
mod steps;
mod supported;
mod trees;
mod units;
mod unsupported;
