//! Rigid elements, `u_m = A_m A_n^-1 u_n`: A_m and A_n hold the motion rows (six coefficients, see `body`) of the dependent components u_m
//! and of six independent components u_n. Rods of constant length, `n . (u_b - u_a) = 0`: n is the direction of the rod between a and b.
//!
//! `RBE2` has its six independent components at one grid point, `RBAR` at two, `RBE1` at up to six. If all six are at one point, A_n is
//! orthogonal and needs no factorization.

use super::body::{CouplingEquation, MotionRow, Pose, Poses, centre_and_size, clean, product};
use super::components::Components;
use super::dense::DenseFactor;
use super::vector::{Vector, minus, unit};
use crate::deck::{CardFault, Dof, Problem};

/// Grid points and their components, in the order of the card.
pub type NodeComponents = Vec<(u32, Components)>;

/// A rigid element.
#[derive(Clone, Debug, PartialEq)]
pub struct RigidElement {
    /// The independent components, six in all.
    pub independent: NodeComponents,
    pub dependent: NodeComponents,
}

impl RigidElement {
    /// A rigid element in which the components `set` of the dependent nodes follow all six components of one node.
    pub fn about(node: u32, dependent: impl IntoIterator<Item = u32>, set: Components) -> Self {
        let dependent = dependent.into_iter().map(|node| (node, set)).collect();
        Self { independent: vec![(node, Components::ALL)], dependent }
    }

    /// One equation for each dependent component, in the order of the card.
    pub fn equations(&self, poses: &impl Poses) -> Result<Vec<CouplingEquation>, Problem> {
        self.check()?;
        if let [(node, Components::ALL)] = self.independent[..] {
            let centre = poses.pose(node)?;
            return self.each_dependent(poses, |pose, component| {
                let row = pose.relative_to(&centre).row(component, [0.0; 3]);
                row.into_iter().zip(1..).map(|(value, component)| (Dof { node, component }, value)).collect()
            });
        }
        let body = IndependentBody::new(&self.independent, poses)?;
        self.each_dependent(poses, |pose, component| body.coefficients(pose, component))
    }

    fn check(&self) -> Result<(), Problem> {
        let found = self.independent.iter().map(|(_, set)| set.len()).sum();
        if found != 6 {
            return Err(CardFault::IndependentCount { found }.into());
        }
        let both = |&(node, set): &(u32, Components)| {
            let shared = |&&(m, other): &&(u32, Components)| m == node && !other.and(set).is_empty();
            self.independent.iter().find(shared).and_then(|(_, other)| other.and(set).iter().next().map(|c| (node, c)))
        };
        match self.dependent.iter().find_map(both) {
            Some((node, component)) => Err(CardFault::OnBothSides { node, component }.into()),
            None if self.dependent.is_empty() => Err(CardFault::NothingConnected.into()),
            None => Ok(()),
        }
    }

    /// One equation for each dependent component. The closure returns the coefficients of the independent ones.
    fn each_dependent(
        &self,
        poses: &impl Poses,
        coefficients: impl Fn(&Pose, u8) -> Vec<(Dof, f64)>,
    ) -> Result<Vec<CouplingEquation>, Problem> {
        let mut equations = Vec::with_capacity(self.dependent.iter().map(|(_, set)| set.len()).sum());
        for &(node, set) in &self.dependent {
            let pose = poses.pose(node)?;
            let equation = |component| CouplingEquation::new(Dof { node, component }, coefficients(&pose, component));
            equations.extend(set.iter().map(equation));
        }
        Ok(equations)
    }
}

/// The six independent components, with the factors of `A_n^T`: A_n holds their motion rows. `size` converts rotations to lengths.
struct IndependentBody {
    components: Vec<Dof>,
    origin: Vector,
    size: f64,
    factor: DenseFactor,
}

impl IndependentBody {
    fn new(independent: &NodeComponents, poses: &impl Poses) -> Result<Self, Problem> {
        let placed: Vec<_> = independent
            .iter()
            .map(|&(node, set)| poses.pose(node).map(|pose| (node, set, pose)))
            .collect::<Result<_, _>>()?;
        let (origin, size) = centre_and_size(placed.iter().map(|(.., pose)| pose.position));
        let mut body = Self { components: Vec::new(), origin, size, factor: DenseFactor::new(0, Vec::new()) };
        let mut transposed = vec![0.0; 36];
        for (node, set, pose) in placed {
            for component in set.iter() {
                let column = body.components.len();
                let row = body.row(&pose, component);
                (0..6).for_each(|k| transposed[6 * k + column] = row[k]);
                body.components.push(Dof { node, component });
            }
        }
        body.factor = DenseFactor::new(6, transposed);
        if body.factor.is_regular() { Ok(body) } else { Err(CardFault::IndependentSingular.into()) }
    }

    /// The motion row of a component. The component and the rotations of the motion are converted to lengths.
    fn row(&self, pose: &Pose, component: u8) -> MotionRow {
        let [a, b, c, d, e, f] = pose.row(component, self.origin);
        [a, b, c, d / self.size, e / self.size, f / self.size].map(|x| x * self.unit(component))
    }

    /// The coefficients of the independent components in the equation of a dependent one.
    fn coefficients(&self, pose: &Pose, component: u8) -> Vec<(Dof, f64)> {
        // A solution exists for every right-hand side, because the factored matrix is nonsingular.
        let solution = self.factor.solve(&self.row(pose, component)).unwrap_or_default();
        let largest = solution.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        let value = |(&at, x): (&Dof, f64)| (at, clean(x, largest) * self.unit(at.component) / self.unit(component));
        self.components.iter().zip(solution).map(value).collect()
    }

    /// The factor that converts a component to a length.
    fn unit(&self, component: u8) -> f64 {
        if component > 3 { self.size } else { 1.0 }
    }
}

/// A rigid rod between two grid points (`RROD`); `dependent` is one of their translations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RigidRod {
    pub ends: [u32; 2],
    pub dependent: Dof,
}

impl RigidRod {
    /// The equation of the rod, divided by the coefficient of the dependent component.
    pub fn equation(&self, poses: &impl Poses) -> Result<CouplingEquation, Problem> {
        let [a, b] = self.ends;
        let (pose_a, pose_b) = (poses.pose(a)?, poses.pose(b)?);
        let along = unit(minus(pose_b.position, pose_a.position)).ok_or_else(|| no_length(a, b))?;
        let terms: Vec<(Dof, f64)> = [(a, pose_a, -1.0), (b, pose_b, 1.0)]
            .iter()
            .flat_map(|&(node, pose, sign)| {
                (1..=3)
                    .zip(pose.axes)
                    .map(move |(component, axis)| (Dof { node, component }, sign * product(&axis, &along)))
            })
            .collect();
        let Dof { node, component } = self.dependent;
        let pivot = terms.iter().find(|(at, _)| *at == self.dependent).map_or(0.0, |&(_, value)| value);
        if pivot == 0.0 {
            return Err(CardFault::AcrossRod { node, component }.into());
        }
        let others = terms.iter().filter(|(at, _)| *at != self.dependent);
        Ok(CouplingEquation::new(self.dependent, others.map(|&(at, value)| (at, -value / pivot))))
    }
}

fn no_length(a: u32, b: u32) -> Problem {
    Problem::Degenerate { what: format!("the ends {a} and {b} of the rod are at the same place") }
}

#[cfg(test)]
mod tests {
    use super::super::axes::BASIC_AXES;
    use super::super::body::samples::{Irregular, rigid_residual};
    use super::*;

    fn set(digits: &str) -> Components {
        Components::parse(digits.as_bytes()).expect("components")
    }

    fn side(parts: &[(u32, &str)]) -> NodeComponents {
        parts.iter().map(|&(node, digits)| (node, set(digits))).collect()
    }

    #[test]
    fn rigid_motions_leave_no_residual() {
        for independent in [
            side(&[(1, "123456")]),
            side(&[(1, "234"), (2, "123")]),
            side(&[(1, "123"), (2, "23"), (3, "3")]),
            side(&[(1, "12"), (2, "12"), (3, "56")]),
        ] {
            let element = RigidElement { independent, dependent: side(&[(4, "123456"), (5, "246"), (6, "1")]) };
            let equations = element.equations(&Irregular).expect("equations");
            assert_eq!(equations.len(), 10);
            assert!(rigid_residual(&equations, &Irregular) < 1e-12, "{}", rigid_residual(&equations, &Irregular));
            assert_eq!(equations[7].terms[0], (Dof { node: 5, component: 4 }, 1.0));
        }
    }

    #[test]
    fn an_arm_along_an_axis_couples_few_components() {
        let element = RigidElement { independent: side(&[(1, "123456")]), dependent: side(&[(2, "123456")]) };
        let equations = element.equations(&Straight).expect("equations");
        let couples = |i: usize| equations[i].terms[1..].iter().map(|(at, a)| (at.component, *a)).collect::<Vec<_>>();
        assert_eq!(couples(0), [(1, -1.0)]);
        assert_eq!(couples(1), [(2, -1.0), (6, -2.0)]);
        assert_eq!(couples(2), [(3, -1.0), (5, 2.0)]);
        assert_eq!(couples(5), [(6, -1.0)]);
    }

    #[test]
    fn wrong_choices_of_independent_components_are_refused() {
        let refused = |independent: &[(u32, &str)], dependent: &[(u32, &str)]| {
            RigidElement { independent: side(independent), dependent: side(dependent) }
                .equations(&Straight)
                .expect_err("refused")
        };
        assert_eq!(refused(&[(1, "12345")], &[(2, "1")]), CardFault::IndependentCount { found: 5 }.into());
        assert_eq!(refused(&[(1, "123"), (2, "123")], &[(2, "4")]), CardFault::IndependentSingular.into());
        assert_eq!(refused(&[(1, "123456")], &[(1, "3")]), CardFault::OnBothSides { node: 1, component: 3 }.into());
        assert_eq!(refused(&[(1, "123456")], &[]), CardFault::NothingConnected.into());
    }

    /// Poses of nodes on a line: node k at x = 2 (k - 1), with global axes.
    struct Straight;

    impl Poses for Straight {
        fn pose(&self, node: u32) -> Result<Pose, Problem> {
            Ok(Pose { position: [f64::from(node - 1) * 2.0, 0.0, 0.0], axes: BASIC_AXES })
        }
    }

    struct RodPlane;

    impl Poses for RodPlane {
        fn pose(&self, node: u32) -> Result<Pose, Problem> {
            let position = if node == 1 { [0.0; 3] } else { [3.0, 4.0, 0.0] };
            Ok(Pose { position, axes: BASIC_AXES })
        }
    }

    #[test]
    fn a_rod_in_a_plane() {
        let equation = RigidRod { ends: [1, 2], dependent: Dof { node: 2, component: 1 } }
            .equation(&RodPlane)
            .expect("an equation");
        let terms: Vec<_> = equation.terms.iter().map(|&(at, value)| (at.node, at.component, value)).collect();
        for (found, expected) in terms.iter().zip([(2, 1, 1.0), (1, 1, -1.0), (1, 2, -4.0 / 3.0), (2, 2, 4.0 / 3.0)]) {
            assert_eq!((found.0, found.1), (expected.0, expected.1));
            assert!((found.2 - expected.2).abs() < 1e-15);
        }
        assert_eq!(terms.len(), 4);
    }

    #[test]
    fn rigid_motions_of_a_rod_leave_no_residual() {
        let rod = RigidRod { ends: [7, 8], dependent: Dof { node: 7, component: 2 } };
        let equation = rod.equation(&Irregular).expect("an equation");
        assert!(rigid_residual(&[equation], &Irregular) < 1e-12);
    }

    #[test]
    fn rods_that_cannot_be_solved_are_refused() {
        let rod =
            |a, b, component| RigidRod { ends: [a, b], dependent: Dof { node: b, component } }.equation(&RodPlane);
        assert_eq!(rod(2, 3, 1), Err(no_length(2, 3)));
        assert_eq!(rod(1, 2, 3), Err(CardFault::AcrossRod { node: 2, component: 3 }.into()));
        assert_eq!(rod(1, 2, 4), Err(CardFault::AcrossRod { node: 2, component: 4 }.into()));
    }
}
