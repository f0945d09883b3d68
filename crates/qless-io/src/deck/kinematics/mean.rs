//! `RBE3`: the reference moves as the weighted mean of grid points, `u_r = A_r S^-1 sum w_k a_k^T u_k` with `S = sum
//! w_k a_k^T a_k`.
//!
//! a_k is the motion row of connected component k (its six coefficients, see `body`), u_k its value and w_k its weight. A_r holds the
//! motion rows of the reference components. The weight of a rotation is multiplied by L^2, where L is the mean distance of the grid points
//! from the reference; this makes the result independent of the unit of length. If the card has a `UM` list, the equations are solved for
//! the components in it, which gives equivalent equations.

use rustc_hash::{FxHashMap, FxHashSet};

use super::body::{CouplingEquation, MotionRow, Pose, Poses, centre_and_size, clean, product};
use super::components::Components;
use super::dense::{DenseFactor, solved_for};
use super::rigid::NodeComponents;
use super::vector::{Vector, length, minus};
use crate::deck::{CardFault, Dof, Problem};

/// Components of some grid points, all with the same weight. `nodes` are node numbers, or ranges of them as on the card.
#[derive(Clone, Debug, PartialEq)]
pub struct WeightedNodes<N = u32> {
    pub weight: f64,
    pub components: Components,
    pub nodes: Vec<N>,
}

/// An `RBE3` as on its card.
#[derive(Clone, Debug, PartialEq)]
pub struct MeanElement<N = u32> {
    pub reference: u32,
    pub components: Components,
    pub groups: Vec<WeightedNodes<N>>,
    /// The components after `UM`, for which the equations are solved; may be empty.
    pub dependent: NodeComponents,
}

impl<N> MeanElement<N> {
    /// The same element, with node numbers in place of ranges.
    pub fn expand(&self, nodes: impl Fn(&[N]) -> Result<Vec<u32>, Problem>) -> Result<MeanElement, Problem> {
        let group = |group: &WeightedNodes<N>| {
            let (weight, components) = (group.weight, group.components);
            Ok(WeightedNodes { weight, components, nodes: nodes(&group.nodes)? })
        };
        let groups = self.groups.iter().map(group).collect::<Result<_, Problem>>()?;
        let (reference, components, dependent) = (self.reference, self.components, self.dependent.clone());
        Ok(MeanElement { reference, components, groups, dependent })
    }
}

impl MeanElement {
    /// One equation for each component of the reference. If there are `UM` components, the equations are solved for them.
    pub fn equations(&self, poses: &impl Poses) -> Result<Vec<CouplingEquation>, Problem> {
        let reference = poses.pose(self.reference)?;
        let body = ConnectedBody::new(self, &reference, poses)?;
        let equation = |component| {
            let dof = Dof { node: self.reference, component };
            let undetermined = CardFault::MeanUndetermined { node: dof.node, component };
            body.mean(&reference, component).map(|terms| CouplingEquation::new(dof, terms)).ok_or(undetermined)
        };
        let equations: Vec<CouplingEquation> = self.components.iter().map(equation).collect::<Result<_, _>>()?;
        if self.dependent.is_empty() {
            return Ok(equations);
        }
        let dofs = |&(node, set): &(u32, Components)| set.iter().map(move |component| Dof { node, component });
        let dependent: Vec<Dof> = self.dependent.iter().flat_map(dofs).collect();
        solved_for(&equations, &dependent, body.size)
    }
}

/// The connected components of an `RBE3`, each with its motion row about their centre and its weight. Rotations are converted to lengths.
/// Positions are measured from the reference, so that they keep their digits far from the origin.
struct ConnectedBody {
    dofs: Vec<(Dof, MotionRow, f64)>,
    centre: Vector,
    size: f64,
    normal: ScaledNormal,
}

impl ConnectedBody {
    fn new(element: &MeanElement, reference: &Pose, poses: &impl Poses) -> Result<Self, Problem> {
        let mut nodes = element.nodes(poses)?;
        nodes.iter_mut().for_each(|(_, pose)| pose.position = minus(pose.position, reference.position));
        let (centre, size) = centre_and_size(nodes.iter().map(|(_, pose)| pose.position));
        let distances = nodes.iter().map(|(_, pose)| length(pose.position));
        let mean_distance = distances.sum::<f64>() / nodes.len() as f64;
        let arm = if mean_distance > 0.0 { mean_distance } else { 1.0 };
        let mut body = Self { dofs: Vec::new(), centre, size, normal: ScaledNormal::new::<MotionRow>(0, &[]) };
        let poses: FxHashMap<u32, Pose> = nodes.into_iter().collect();
        for (dof, weight) in element.weights()? {
            let weight = if dof.component > 3 { weight * arm.powi(2) } else { weight };
            body.dofs.push((dof, body.row(&poses[&dof.node], dof.component), weight));
        }
        body.normal = ScaledNormal::new(6, &body.dofs);
        Ok(body)
    }

    /// The motion row of a component, with rotations converted to lengths.
    fn row(&self, pose: &Pose, component: u8) -> MotionRow {
        let [a, b, c, d, e, f] = pose.row(component, self.centre);
        [a, b, c, d / self.size, e / self.size, f / self.size]
    }

    /// Coefficients of the connected components in the mean, for one component of the reference. `None` if the connected components do not
    /// determine it.
    fn mean(&self, reference: &Pose, component: u8) -> Option<Vec<(Dof, f64)>> {
        let scaled = |row: &MotionRow| -> MotionRow { std::array::from_fn(|i| row[i] * self.normal.scale[i]) };
        let reference = Pose { position: [0.0; 3], ..*reference };
        let mut motion = self.normal.factor.solve(&scaled(&self.row(&reference, component)))?;
        let largest = motion.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        motion.iter_mut().for_each(|x| *x = clean(*x, largest));
        Some(self.dofs.iter().map(|(dof, row, weight)| (*dof, weight * product(&scaled(row), &motion))).collect())
    }
}

impl MeanElement {
    /// The connected grid points with their poses, each once, in the order of the card.
    pub(super) fn nodes(&self, poses: &impl Poses) -> Result<Vec<(u32, Pose)>, Problem> {
        let mut seen = FxHashSet::default();
        let nodes = self.groups.iter().flat_map(|group| &group.nodes).filter(|node| seen.insert(**node));
        let nodes: Vec<_> = nodes.map(|&node| poses.pose(node).map(|pose| (node, pose))).collect::<Result<_, _>>()?;
        if nodes.is_empty() || self.components.is_empty() { Err(CardFault::NothingConnected.into()) } else { Ok(nodes) }
    }

    /// The weight of each connected component. If a component is repeated, its weights are added.
    pub(super) fn weights(&self) -> Result<Vec<(Dof, f64)>, Problem> {
        let mut places = FxHashMap::default();
        let mut weights: Vec<(Dof, f64)> = Vec::new();
        for group in &self.groups {
            for &node in &group.nodes {
                for component in group.components.iter() {
                    if node == self.reference && self.components.contains(component) {
                        return Err(CardFault::OnBothSides { node, component }.into());
                    }
                    let dof = Dof { node, component };
                    let place = *places.entry(dof).or_insert_with(|| {
                        weights.push((dof, 0.0));
                        weights.len() - 1
                    });
                    weights[place].1 += group.weight;
                }
            }
        }
        Ok(weights)
    }
}

/// The factors of `D S D`, where `S = sum w a^T a` over components with weight w and motion row a. D is a diagonal matrix that makes the
/// diagonal of the product ones. Without D, rotations might weigh far more than translations.
struct ScaledNormal {
    factor: DenseFactor,
    /// The diagonal of D.
    scale: Vec<f64>,
}

impl ScaledNormal {
    fn new<R: AsRef<[f64]>>(n: usize, connected: &[(Dof, R, f64)]) -> Self {
        let mut s = vec![0.0; n * n];
        for (_, row, weight) in connected {
            let row = row.as_ref();
            (0..n * n).for_each(|k| s[k] += weight * row[k / n] * row[k % n]);
        }
        let diagonal = (0..n).map(|i| s[(n + 1) * i]);
        let scale: Vec<f64> = diagonal.map(|x: f64| if x > 0.0 { 1.0 / x.sqrt() } else { 1.0 }).collect();
        let scaled = (0..n * n).map(|k| s[k] * scale[k / n] * scale[k % n]).collect();
        Self { factor: DenseFactor::new(n, scaled), scale }
    }
}

#[cfg(test)]
mod tests {
    use super::super::axes::BASIC_AXES;
    use super::super::body::samples::{Irregular, rigid_residual};
    use super::*;

    fn set(digits: &str) -> Components {
        Components::parse(digits.as_bytes()).expect("components")
    }

    fn mean(refc: &str, groups: &[(f64, &str, &[u32])]) -> MeanElement {
        let group = |&(weight, digits, nodes): &(f64, &str, &[u32])| WeightedNodes {
            weight,
            components: set(digits),
            nodes: nodes.to_vec(),
        };
        MeanElement {
            reference: 9,
            components: set(refc),
            groups: groups.iter().map(group).collect(),
            dependent: Vec::new(),
        }
    }

    /// Poses of nodes 1 to 4 at the corners of a square about node 9, with global axes.
    struct UnitSquare;

    impl Poses for UnitSquare {
        fn pose(&self, node: u32) -> Result<Pose, Problem> {
            let position = match node {
                1 => [1.0, 1.0, 0.0],
                2 => [-1.0, 1.0, 0.0],
                3 => [-1.0, -1.0, 0.0],
                4 => [1.0, -1.0, 0.0],
                _ => [0.0; 3],
            };
            Ok(Pose { position, axes: BASIC_AXES })
        }
    }

    #[test]
    fn the_middle_of_a_square_moves_as_the_mean_of_its_corners() {
        let equations = mean("16", &[(2.0, "123", &[1, 2, 3, 4])]).equations(&UnitSquare).expect("equations");
        let terms = |i: usize| {
            equations[i].terms.iter().map(|&(dof, value)| (dof.node, dof.component, value)).collect::<Vec<_>>()
        };
        assert_eq!(terms(0), [(9, 1, 1.0), (1, 1, -0.25), (2, 1, -0.25), (3, 1, -0.25), (4, 1, -0.25)]);
        let turn = [(9, 6, 1.0), (1, 1, 0.125), (1, 2, -0.125), (2, 1, 0.125), (2, 2, 0.125)];
        assert_eq!(terms(1)[..5], turn);
    }

    #[test]
    fn rigid_motions_leave_no_residual() {
        let groups: [(f64, &str, &[u32]); 4] =
            [(2.3, "123", &[1, 2]), (12.0, "23", &[3]), (0.4, "456", &[4, 5]), (0.5, "136", &[1, 6])];
        let mut element = mean("123456", &groups);
        let equations = element.equations(&Irregular).expect("equations");
        assert_eq!(equations.len(), 6);
        assert!(rigid_residual(&equations, &Irregular) < 1e-12, "{}", rigid_residual(&equations, &Irregular));
        element.dependent = vec![(1, set("12")), (9, set("135")), (4, set("5"))];
        let equations = element.equations(&Irregular).expect("equations");
        assert!(rigid_residual(&equations, &Irregular) < 1e-12, "{}", rigid_residual(&equations, &Irregular));
        let slaves: Vec<_> = equations.iter().map(|equation| equation.terms[0]).collect();
        let slave = |node, component| (Dof { node, component }, 1.0);
        assert_eq!(slaves, [slave(1, 1), slave(1, 2), slave(9, 1), slave(9, 3), slave(9, 5), slave(4, 5)]);
        let others = equations.iter().flat_map(|equation| &equation.terms[1..]);
        assert_eq!(others.filter(|term| slaves.iter().any(|slave| slave.0 == term.0)).count(), 0);
    }

    /// Poses of nodes 1 and 2 on either side of node 9, each at the distance `L` in the field.
    struct Beam(f64);

    impl Poses for Beam {
        fn pose(&self, node: u32) -> Result<Pose, Problem> {
            let x = [(1, self.0), (2, -self.0)].into_iter().find_map(|(id, x)| (id == node).then_some(x));
            Ok(Pose { position: [x.unwrap_or(0.0), 0.0, 0.0], axes: BASIC_AXES })
        }
    }

    /// With `S = 2 (L^2 + L^2)`, a rotation has the coefficient 1/4 in any unit of length, and a deflection has `L / S`.
    #[test]
    fn rotations_weigh_the_same_in_every_unit_of_length() {
        for size in [1e-9, 1.0, 1000.0, 1e9] {
            let equations = mean("6", &[(3.0, "123456", &[1, 2])]).equations(&Beam(size)).expect("an equation");
            let expected = [(9, 6, 1.0), (1, 2, -0.25 / size), (1, 6, -0.25), (2, 2, 0.25 / size), (2, 6, -0.25)];
            assert_eq!(equations[0].terms.len(), expected.len());
            for (&(dof, value), (node, component, wanted)) in equations[0].terms.iter().zip(expected) {
                assert_eq!(dof, Dof { node, component });
                assert!((value - wanted).abs() < 1e-14 * wanted.abs(), "{dof}: {value} for {wanted}");
            }
        }
    }

    #[test]
    fn one_point_determines_no_rotation() {
        let undetermined = CardFault::MeanUndetermined { node: 9, component: 6 };
        assert_eq!(mean("16", &[(1.0, "123", &[5])]).equations(&UnitSquare), Err(undetermined.into()));
        assert_eq!(mean("123", &[(1.0, "123", &[5])]).equations(&UnitSquare).map(|equations| equations.len()), Ok(3));
        assert_eq!(mean("1", &[(1.0, "123", &[])]).equations(&UnitSquare), Err(CardFault::NothingConnected.into()));
        let twice = CardFault::OnBothSides { node: 9, component: 1 };
        assert_eq!(mean("1", &[(1.0, "123", &[9, 1])]).equations(&UnitSquare), Err(twice.into()));
    }

    #[test]
    fn um_has_to_be_solvable() {
        let mut element = mean("12", &[(1.0, "123", &[1, 2, 3, 4])]);
        element.dependent = vec![(1, set("3")), (2, set("1"))];
        assert_eq!(element.equations(&UnitSquare), Err(CardFault::UmSingular.into()));
        element.dependent = vec![(1, set("1"))];
        assert_eq!(element.equations(&UnitSquare), Err(CardFault::UmCount { found: 1, expected: 2 }.into()));
    }
}
