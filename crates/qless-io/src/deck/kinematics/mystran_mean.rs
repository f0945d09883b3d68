//! `RBE3` as MYSTRAN understands it, after its source (`RBE3_PROC.f90`, `PARTITION_SS.f90`).
//!
//! In the axes of the reference, with arms d_k and with weights w_k[c] that are zero for components which the card does not name:
//!
//! ```text
//! translation i:  sum_k w_k[i] u_r[i] + (r_r x sum_k w_k d_k)[i] = sum_k sum_c w_k[c] T_k[i][c] u_k[c]
//! rotation a:     the moments of the points about axis a, with the weight w_k[a]
//! ```
//!
//! T_k turns the axes of point k into those of the reference. MYSTRAN differs from Nastran in three ways, which the results show too:
//!
//! - It uses only the translations of the connected points.
//! - The rows of rotations lack T_k: the components of a point count as if its axes were those of the reference.
//! - A row of a rotation may need a component of the reference that REFC lacks. MYSTRAN then drops this term and all that follow it in a list
//!   which a sort has mixed, so that the other cards of the deck decide what remains. Such an element is not understood here.

use super::body::{CouplingEquation, Pose, Poses, centre_and_size};
use super::components::Components;
use super::dense::solved_for;
use super::mean::MeanElement;
use crate::deck::{CardFault, Dof, Problem};

/// MYSTRAN omits coefficients up to this size, which is the machine precision.
pub const OMITTED: f64 = f64::EPSILON;

/// The two axes after each axis, in cyclic order.
const NEXT: [[usize; 2]; 3] = [[1, 2], [2, 0], [0, 1]];

/// A connected grid point in the axes of the reference, as often as the card names it.
struct ArmPoint {
    node: u32,
    components: Components,
    /// The weight of each translation.
    weights: [f64; 3],
    pose: Pose,
}

/// One equation for each component of the reference, solved for these components.
pub fn mystran_mean(element: &MeanElement, poses: &impl Poses) -> Result<Vec<CouplingEquation>, Problem> {
    element.weights()?;
    let nodes = element.nodes(poses)?;
    let (_, size) = centre_and_size(nodes.iter().map(|(_, pose)| pose.position));
    let points = points(element, poses)?;
    let row = |component: u8| terms(element, &points, component).map(|terms| CouplingEquation { terms });
    let rows: Vec<CouplingEquation> = element.components.iter().map(row).collect::<Result<_, _>>()?;
    let own: Vec<Dof> = element.components.iter().map(|c| Dof { node: element.reference, component: c }).collect();
    let undetermined = || CardFault::MeanUndetermined { node: element.reference, component: own[0].component };
    solved_for(&rows, &own, size).map_err(|_| undetermined().into())
}

fn points(element: &MeanElement, poses: &impl Poses) -> Result<Vec<ArmPoint>, Problem> {
    let reference = poses.pose(element.reference)?;
    let mut points = Vec::new();
    for group in &element.groups {
        let weights = [1, 2, 3].map(|c| if group.components.contains(c) { group.weight } else { 0.0 });
        for &node in &group.nodes {
            let pose = poses.pose(node)?.relative_to(&reference);
            points.push(ArmPoint { node, components: group.components, weights, pose });
        }
    }
    Ok(points)
}

/// The terms of a row. The first one belongs to the component of the row, even if its coefficient is zero.
fn terms(element: &MeanElement, points: &[ArmPoint], component: u8) -> Result<Vec<(Dof, f64)>, CardFault> {
    let axis = usize::from(component - 1) % 3;
    let (own, others) = if component > 3 {
        (rotation(points, axis), moments(points, axis))
    } else {
        (translation(element, points, axis), shares(points, axis))
    };
    let node = element.reference;
    let needed = own.iter().skip(1).filter(|(_, value)| value.abs() > OMITTED);
    if let Some(&(missing, _)) = needed.clone().find(|(needed, _)| !element.components.contains(*needed)) {
        return Err(CardFault::MeanCut { node, component, missing });
    }
    let own = own.first().into_iter().chain(needed).map(|&(component, value)| (Dof { node, component }, value));
    Ok(own.chain(others.into_iter().filter(|(_, value)| value.abs() > OMITTED)).collect())
}

fn sum(points: &[ArmPoint], value: impl Fn(&ArmPoint) -> f64) -> f64 {
    points.iter().map(value).sum()
}

/// `sum_k w_k[i] d_k[i]`.
fn moment(points: &[ArmPoint], i: usize) -> f64 {
    sum(points, |point| point.weights[i] * point.pose.position[i])
}

/// The coefficients of the reference in the row of a translation.
fn translation(element: &MeanElement, points: &[ArmPoint], i: usize) -> Vec<(u8, f64)> {
    let [j, k] = NEXT[i];
    let weight = sum(points, |point| point.weights[i]);
    let turns = [(j as u8 + 4, moment(points, k)), (k as u8 + 4, -moment(points, j))];
    let turns = turns.into_iter().filter(|&(component, _)| element.components.contains(component));
    std::iter::once((i as u8 + 1, weight)).chain(turns).collect()
}

/// The coefficients of the connected points in the row of a translation.
fn shares(points: &[ArmPoint], i: usize) -> Vec<(Dof, f64)> {
    let of_point = |point: &ArmPoint| {
        let share = |c: usize| (dof(point, c), -point.weights[c] * point.pose.axes[c][i]);
        [0, 1, 2].map(share)
    };
    points.iter().flat_map(of_point).collect()
}

/// The coefficients of the reference in the row of a rotation.
fn rotation(points: &[ArmPoint], axis: usize) -> Vec<(u8, f64)> {
    let [j, k] = NEXT[axis];
    let inertia = sum(points, |point| {
        let [d, e] = [j, k].map(|i| point.pose.position[i]);
        point.weights[k] * d * d + point.weights[j] * e * e
    });
    // The weight of a product of two arms is that of the third axis.
    let product = |other: usize| {
        let third = 3 - axis - other;
        sum(points, |point| point.weights[third] * point.pose.position[axis] * point.pose.position[other])
    };
    let turns = [j, k].map(|other| (other as u8 + 4, -product(other)));
    let shifts = [(j as u8 + 1, -moment(points, k)), (k as u8 + 1, moment(points, j))];
    let own = (axis as u8 + 4, if inertia.abs() > OMITTED { inertia } else { 1.0 });
    std::iter::once(own).chain(turns).chain(shifts).collect()
}

/// The coefficients of the connected points in the row of a rotation. All have the weight of the component with the number of the axis.
fn moments(points: &[ArmPoint], axis: usize) -> Vec<(Dof, f64)> {
    let [j, k] = NEXT[axis];
    let of_point = |point: &ArmPoint| {
        let (weight, arm) = (point.weights[axis], point.pose.position);
        let both = [(j, weight * arm[k]), (k, -weight * arm[j])];
        both.map(|(c, value)| (dof(point, c), if point.components.contains(c as u8 + 1) { value } else { 0.0 }))
    };
    points.iter().flat_map(of_point).collect()
}

fn dof(point: &ArmPoint, axis: usize) -> Dof {
    Dof { node: point.node, component: axis as u8 + 1 }
}
