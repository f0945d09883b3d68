//! Solves models under constraints: linear equilibrium, mechanisms, nonlinear equilibrium.
//!
//! | module | solves |
//! | --- | --- |
//! | [`enforce`] | `K u = f` under `C u = b`, by transformation, multipliers, penalty, augmented Lagrange, or one method per equation |
//! | [`newton`] | `c(u) = 0` for mechanisms, by minimum-norm Newton steps; redundancies of one configuration and of all |
//! | [`equilibrium`] | `f_int(u) + G^T lambda = f_ext`, `c(u) = 0` for a nonlinear model of the user, by load steps |
//!
//! Constraints come from [`qless_constraints`]; rank, redundancy and reduction from [`qless`]. `newton` and `equilibrium` do not use
//! `enforce`; `equilibrium` uses `newton`.
//!
#![doc = include_str!("../README.md")]

mod common;
pub mod enforce;
pub mod equilibrium;
pub mod newton;
