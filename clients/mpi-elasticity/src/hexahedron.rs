//! The stiffness of a hexahedron of eight nodes whose edges are along the axes.

/// DOFs of a hexahedron: three for each corner, x runs first.
pub const SIZE: usize = 24;
pub const POISSON: f64 = 0.3;

/// Lame's constants: lambda and mu.
pub fn lame(young: f64) -> [f64; 2] {
    [young * POISSON / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON)), young / (2.0 * (1.0 + POISSON))]
}

/// `lambda tr(E) I + mu (E + E^T)`, for a displacement gradient E.
pub fn stress(young: f64, e: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let ([lambda, mu], trace) = (lame(young), e[0][0] + e[1][1] + e[2][2]);
    let delta = |i: usize, j: usize| if i == j { lambda * trace } else { 0.0 };
    std::array::from_fn(|i| std::array::from_fn(|j| delta(i, j) + mu * (e[i][j] + e[j][i])))
}

/// `int B^T D B`, by rows, at 2 x 2 x 2 Gauss points.
pub fn stiffness(edges: [f64; 3], young: f64) -> Vec<f64> {
    let ([lambda, mu], volume) = (lame(young), edges.iter().product::<f64>());
    let mut k = vec![0.0; SIZE * SIZE];
    for point in 0..8_usize {
        let slopes: [[f64; 3]; 8] = std::array::from_fn(|corner| gradient(corner, point, edges));
        for row in 0..SIZE {
            for column in 0..SIZE {
                let ((a, i), (b, j)) = ((row / 3, row % 3), (column / 3, column % 3));
                let dot: f64 = (0..3).map(|axis| slopes[a][axis] * slopes[b][axis]).sum();
                let same = if i == j { mu * dot } else { 0.0 };
                let value = lambda * slopes[a][i] * slopes[b][j] + mu * slopes[a][j] * slopes[b][i] + same;
                k[row * SIZE + column] += volume / 8.0 * value;
            }
        }
    }
    k
}

/// The gradient of the shape function of a corner at a Gauss point.
fn gradient(corner: usize, point: usize, edges: [f64; 3]) -> [f64; 3] {
    let sign = |bits: usize, axis: usize| if bits >> axis & 1 == 1 { 1.0 } else { -1.0 };
    let xi = |axis: usize| sign(point, axis) / 3.0_f64.sqrt();
    let factor = |axis: usize| f64::midpoint(1.0, sign(corner, axis) * xi(axis));
    std::array::from_fn(|axis| {
        let others: f64 = (0..3).filter(|&other| other != axis).map(factor).product();
        sign(corner, axis) / edges[axis] * others
    })
}
