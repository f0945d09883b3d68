//! Points, faces and rotations that the types share.

pub mod angle;
pub mod bounds;
pub mod carrier;
pub mod clip;
mod factors;
pub mod fold;
pub mod foot;
pub mod lanes;
pub mod node;
pub mod outline;
pub mod pairs;
pub mod polynomials;
pub mod project;
mod proof;
pub mod quaternion;
pub mod rotation;
pub mod search;
pub mod segment;
pub mod shape;
pub mod surface;
pub mod turn;
pub mod turned;
pub mod turns;
