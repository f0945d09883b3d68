//! Polynomials `p(x, y) = sum_m c_m P_i(x) P_j(y)` with Legendre's P_i, on a triangle or a square, and interpolation between given nodes.

use faer::Mat;
use faer::linalg::solvers::Solve;

use super::closest_point::complete_weights;
use super::shape::Shape;

/// A space of polynomials on a face, in the parameters of [`Shape`]. Below, p is the degree, at least one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Polynomials {
    /// On a triangle, all `xi^i eta^j` with `i + j <= p`; (p + 1)(p + 2) / 2 nodes.
    Triangle(usize),
    /// On a quadrilateral, all `xi^i eta^j` with `i <= p` and `j <= p`; (p + 1)^2 nodes.
    Quadrilateral(usize),
    /// On a quadrilateral, the serendipity space: all `xi^i eta^j` with `i + j <= p`, where an exponent of one counts as
    /// zero; 4, 8, 12, 17, ... nodes.
    Serendipity(usize),
}

/// Nodes do not determine a polynomial if the values of all products `P_i P_j` of Legendre polynomials at the nodes form a nearly singular
/// matrix: the ratio of its least to its largest singular value is below this.
const LEAST: f64 = 1e-10;

impl Polynomials {
    /// The degree p.
    pub fn degree(self) -> usize {
        let (Self::Triangle(p) | Self::Quadrilateral(p) | Self::Serendipity(p)) = self;
        p
    }

    /// Dimension of the space, equal to the number of nodes.
    pub fn dimension(self) -> usize {
        let more = |k: usize| self.degree().saturating_add(k);
        match self {
            Self::Triangle(_) => more(1).saturating_mul(more(2)) / 2,
            Self::Quadrilateral(_) => more(1).saturating_mul(more(1)),
            Self::Serendipity(p) if p < 2 => 4 * p,
            Self::Serendipity(p) => p.saturating_mul(more(3)).saturating_add(6) / 2,
        }
    }

    /// The space of an element shape; `None` for lines and solids.
    pub fn from_shape(shape: Shape) -> Option<Self> {
        match shape {
            Shape::Tri3 => Some(Self::Triangle(1)),
            Shape::Tri6 => Some(Self::Triangle(2)),
            Shape::Quad4 => Some(Self::Quadrilateral(1)),
            Shape::Quad8 => Some(Self::Serendipity(2)),
            Shape::Quad9 => Some(Self::Quadrilateral(2)),
            _ => None,
        }
    }

    /// Whether this space contains the other.
    pub fn contain(self, others: Self) -> bool {
        let (p, q) = (self.degree(), others.degree());
        match (self, others) {
            // In a serendipity space, `xi^q eta^q` with q > 1 counts 2 q towards the degree.
            (Self::Serendipity(_), Self::Quadrilateral(_)) => q <= if q > 1 { p / 2 } else { p },
            _ => self.face() == others.face() && q <= p,
        }
    }

    /// The linear element shape on the same range of parameters: a triangle or a quadrilateral.
    pub(crate) fn face(self) -> Shape {
        if matches!(self, Self::Triangle(_)) { Shape::Tri3 } else { Shape::Quad4 }
    }

    fn has(self, i: usize, j: usize) -> bool {
        let counted = |k: usize| if k > 1 { k } else { 0 };
        match self {
            Self::Triangle(p) => i + j <= p,
            Self::Quadrilateral(p) => i.max(j) <= p,
            Self::Serendipity(p) => i.max(j) <= p && counted(i) + counted(j) <= p,
        }
    }

    /// Exponents `(i, j)`. With each pair, the set contains all pairs with lower exponents, so that products of Legendre polynomials span
    /// the same space.
    fn exponents(self) -> impl Iterator<Item = (usize, usize)> {
        let p = self.degree();
        (0..=p).flat_map(move |j| (0..=p).map(move |i| (i, j))).filter(move |&(i, j)| self.has(i, j))
    }

    fn values(self, [x, y]: [f64; 2]) -> Vec<f64> {
        let centred = |s: f64| if matches!(self, Self::Triangle(_)) { 2.0 * s - 1.0 } else { s };
        let [along_x, along_y] = [x, y].map(|s| legendre(self.degree(), centred(s)));
        self.exponents().map(|(i, j)| along_x[i] * along_y[j]).collect()
    }

    /// The weights `N_k(x)` at each point, so that `p(x) = sum_k N_k(x) p(x_k)` for every polynomial p of the space and the nodes `x_k`.
    /// Returns `None` if the nodes do not determine a polynomial.
    pub(crate) fn weights(self, nodes: &[[f64; 2]], points: &[[f64; 2]]) -> Option<Vec<Vec<f64>>> {
        let [at_nodes, at_points] = [nodes, points].map(|all| all.iter().map(|&x| self.values(x)).collect::<Vec<_>>());
        let n = nodes.len();
        let matrix = Mat::from_fn(n, n, |m, k| at_nodes[k][m]);
        let sizes = matrix.singular_values().ok()?;
        let condition = sizes[0] / sizes[n - 1];
        if condition > 1.0 / LEAST || condition.is_nan() {
            return None;
        }
        let right = Mat::from_fn(n, points.len(), |m, i| at_points[i][m]);
        let weights = matrix.partial_piv_lu().solve(&right);
        let column = |i: usize| complete_weights((0..n).map(|k| weights[(k, i)]).collect(), condition);
        Some((0..points.len()).map(column).collect())
    }
}

/// Legendre polynomials `P_0 .. P_p`: `(k + 1) P_(k+1) = (2 k + 1) x P_k - k P_(k-1)`.
fn legendre(p: usize, x: f64) -> Vec<f64> {
    let mut all = vec![1.0, x];
    for k in 1..p {
        let degree = k as f64;
        all.push(((2.0 * degree + 1.0) * x * all[k] - degree * all[k - 1]) / (degree + 1.0));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dimensions_are_counts() {
        for p in 1..9 {
            for all in [Polynomials::Triangle(p), Polynomials::Quadrilateral(p), Polynomials::Serendipity(p)] {
                assert_eq!(all.exponents().count(), all.dimension(), "{all:?}");
            }
        }
        assert_eq!(Polynomials::Quadrilateral(usize::MAX).dimension(), usize::MAX);
    }

    /// `contain` agrees with a comparison of all exponents, and works for any degree.
    #[test]
    fn those_among_others_are_contained() {
        let kinds = [Polynomials::Triangle, Polynomials::Quadrilateral, Polynomials::Serendipity];
        let all = || (0..9).flat_map(|p| kinds.map(|kind| kind(p)));
        for (these, others) in all().flat_map(|these| all().map(move |others| (these, others))) {
            let truth = these.face() == others.face() && others.exponents().all(|(i, j)| these.has(i, j));
            assert_eq!(these.contain(others), truth, "{these:?}, {others:?}");
        }
        for kind in kinds {
            assert!(kind(usize::MAX).contain(kind(usize::MAX)) && !kind(usize::MAX - 1).contain(kind(usize::MAX)));
        }
    }

    /// The weights agree with the shape functions of the elements.
    #[test]
    fn weights_are_those_of_the_shapes() {
        for shape in Shape::ALL {
            let Some(all) = Polynomials::from_shape(shape) else { continue };
            let flat = |x: &[f64; 3]| [x[0], x[1]];
            let nodes: Vec<[f64; 2]> = shape.places().iter().map(flat).collect();
            let points: Vec<[f64; 3]> = (0..20).map(|seed| super::super::shape::tests::inside(shape, seed)).collect();
            let found = all.weights(&nodes, &points.iter().map(flat).collect::<Vec<_>>()).expect("unisolvent");
            for (at, found) in points.iter().zip(found) {
                let off = shape.weights(*at).iter().zip(&found).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
                assert!(off < 1e-14, "{shape:?}: {off}");
            }
            let own = all.weights(&nodes, &nodes).expect("unisolvent");
            let unit = |k: usize, l: usize| f64::from(u8::from(k == l));
            assert!(
                own.iter().enumerate().all(|(k, n)| n.iter().enumerate().all(|(l, &n)| n == unit(k, l))),
                "{shape:?}"
            );
        }
    }
}
