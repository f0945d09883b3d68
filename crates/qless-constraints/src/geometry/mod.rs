//! Geometry that the constraint types share: elements, surfaces and rotations.
//!
//! | module | contents |
//! | --- | --- |
//! | [`node`], [`surface`], [`pairs`] | nodes, faces that share nodes, pairs of opposite nodes |
//! | [`shape`], [`bounds`], [`element_quality`] | shape functions of elements, bounding boxes, degenerate elements |
//! | [`closest_point`], [`search`] | the point of an element, and the element of a mesh, nearest to a point |
//! | [`outline`], [`polynomials`] | polygons with their quadrature, polynomials through the nodes of a face |
//! | [`rotation`], [`rodrigues`], [`rotation_derivatives`] | rotated vectors with first and second derivatives |
//! | [`quaternion`], [`angle`] | relative rotations and their angles |
//! | [`spin`] | angular velocities and moments in space |
//! | [`sector_rotation`] | the rotation from one sector of a cyclic model to the next |

pub mod angle;
pub mod bounds;
pub mod closest_point;
pub mod element_quality;
pub mod node;
pub mod outline;
pub mod pairs;
pub mod polynomials;
pub mod quaternion;
mod rodrigues;
pub mod rotation;
pub mod rotation_derivatives;
pub mod search;
pub mod sector_rotation;
pub mod shape;
pub mod spin;
pub mod surface;
