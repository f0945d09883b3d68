//! Several random equations `sum_{j in window} a_j u_j = b` per window of a grid, and combinations of neighbours.

use qless::SystemBuilder;

use super::MOST;
use crate::error::within;
use crate::{Rng, Scene, SceneError, Truth};

/// Wide systems of local equations, and combinations of them.
///
/// Windows of `window` nodes per side start at every `stride`-th node of an nx x ny x nz grid (nz = 1 for 2-D). Each has
/// `rows` equations with random whole coefficients on all of its DOFs, except that equation k of a window omits the first k
/// DOFs. The DOFs of the first `stride` nodes per side are in no later window, so these equations are independent. Each of
/// `combos` further equations combines two equations of consecutive windows.
///
/// Two sizes for benchmarks: 2-D 95,000 x 160,000 and 3-D 14,700 x 64,000:
///
/// ```
/// use qless_scenes::families::Windows;
/// let flat = Windows { extent: [400, 400, 1], d: 1, window: 4, stride: 2, rows: 2, combos: 15_000 };
/// let solid = Windows { extent: [40, 40, 40], d: 1, window: 4, stride: 3, rows: 6, combos: 1_500 };
/// assert_eq!((flat.equations(), flat.dofs()), (95_000, 160_000));
/// assert_eq!((solid.equations(), solid.dofs()), (14_682, 64_000));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Windows {
    /// Nodes per side of the grid.
    pub extent: [usize; 3],
    /// DOFs per node.
    pub d: usize,
    /// Nodes per side of a window; windows at the far end of the grid are smaller.
    pub window: usize,
    /// Nodes from the start of one window to the start of the next, at most `window`.
    pub stride: usize,
    /// Equations per window, at most the number of DOFs of its first `stride` nodes per side.
    pub rows: usize,
    /// Number of combinations.
    pub combos: usize,
}

fn product(sides: [usize; 3]) -> usize {
    sides.into_iter().fold(1, usize::saturating_mul)
}

type WindowsEquation = (Vec<(usize, f64)>, f64);

impl Windows {
    /// Number of windows along each axis; a window is omitted if its first `stride` nodes do not fit.
    fn windows(&self) -> [usize; 3] {
        self.extent.map(|n| n / self.stride.clamp(1, n.max(1)))
    }

    /// m, the number of equations.
    pub fn equations(&self) -> usize {
        product(self.windows()).saturating_mul(self.rows).saturating_add(self.combos)
    }

    /// n, the number of DOFs. DOFs of nodes outside all windows occur in no equation.
    pub fn dofs(&self) -> usize {
        product(self.extent).saturating_mul(self.d)
    }

    /// Builds the scene: equations window by window, then the combinations.
    ///
    /// # Errors
    /// [`SceneError::Size`] if a number is outside the limits above.
    pub fn scene(&self, seed: u64) -> Result<Scene, SceneError> {
        self.check()?;
        let mut rng = Rng::new(seed);
        let mut equations = Vec::with_capacity(self.equations());
        let [wx, wy, wz] = self.windows();
        for place in (0..wz).flat_map(|k| (0..wy).flat_map(move |j| (0..wx).map(move |i| [i, j, k]))) {
            let dofs = self.dofs_of(place);
            equations.extend((0..self.rows).map(|skip| equation(&dofs[skip..], &mut rng)));
        }
        let independent = equations.len();
        for _ in 0..self.combos {
            let first = rng.below(independent - self.rows);
            equations.push(sum(&equations[first], &equations[first + self.rows], &mut rng));
        }
        let mut builder = SystemBuilder::new(self.dofs());
        for (terms, rhs) in equations {
            builder.equation(terms, rhs);
        }
        Scene::bare(builder, Truth::rank(self.equations(), independent))
    }

    fn check(&self) -> Result<(), SceneError> {
        self.extent.into_iter().try_for_each(|n| within("a side of the grid", n, 1, 1 << 13))?;
        within("d", self.d, 1, 100)?;
        within("the number of DOFs", self.dofs(), 1, MOST)?;
        within("stride", self.stride, 1, self.window)?;
        let own: usize = self.extent.iter().map(|&n| self.stride.min(n)).product();
        within("rows", self.rows, 1, own * self.d)?;
        let neighbours = self.windows().iter().product::<usize>() - 1;
        within("combos", self.combos, 0, if neighbours == 0 { 0 } else { MOST })
    }

    /// DOFs of a window; first those of its first `stride` nodes per side, which are in no later window.
    fn dofs_of(&self, place: [usize; 3]) -> Vec<usize> {
        let [nx, ny, _] = self.extent;
        let stride = self.extent.map(|n| self.stride.min(n));
        let start = [0, 1, 2].map(|axis| place[axis] * stride[axis]);
        let range = |axis: usize| start[axis]..(start[axis] + self.window).min(self.extent[axis]);
        let nodes = range(2).flat_map(|k| range(1).flat_map(move |j| range(0).map(move |i| [i, j, k])));
        let mut nodes: Vec<_> = nodes.collect();
        nodes.sort_by_key(|node| (0..3).any(|axis| node[axis] >= start[axis] + stride[axis]));
        let number = |[i, j, k]: [usize; 3]| i + nx * (j + ny * k);
        nodes.into_iter().flat_map(|node| (0..self.d).map(move |c| number(node) * self.d + c)).collect()
    }
}

fn equation(dofs: &[usize], rng: &mut Rng) -> WindowsEquation {
    (dofs.iter().map(|&dof| (dof, rng.coefficient(9))).collect(), rng.below(7) as f64 - 3.0)
}

/// A random combination of two equations. Building the system adds up repeated DOFs, exactly.
fn sum(one: &WindowsEquation, other: &WindowsEquation, rng: &mut Rng) -> WindowsEquation {
    let (a, b) = (rng.coefficient(2), rng.coefficient(2));
    let scaled =
        |terms: &[(usize, f64)], factor| terms.iter().map(move |&(dof, v)| (dof, factor * v)).collect::<Vec<_>>();
    ([scaled(&one.0, a), scaled(&other.0, b)].concat(), a * one.1 + b * other.1)
}
