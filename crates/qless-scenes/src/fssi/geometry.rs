//! Coordinates of the nodes: a box of 100 m x 100 m x 40 m with a tank of radius 30 m and height 20 m at its centre.

use super::Mesh;

pub(super) const WIDTH: f64 = 100.0;
const DEPTH: f64 = 40.0;
const INNER: f64 = 5.0;
const RADIUS: f64 = 30.0;
const HEIGHT: f64 = 20.0;

/// Cell sizes of the near-field side mesh, in metres.
pub(super) fn cell(mesh: &Mesh) -> (f64, f64) {
    (WIDTH / (mesh.columns - 1) as f64, DEPTH / (mesh.layers - 1) as f64)
}

/// Side node `at` in a ring of `4 (columns - 1)` nodes, counted around the box from its first corner.
pub(super) fn side(columns: usize, layers: usize, at: usize, layer: usize) -> [f64; 3] {
    let cells = columns - 1;
    let along = WIDTH * (at % cells) as f64 / cells as f64;
    let [x, y] = match at / cells {
        0 => [along, 0.0],
        1 => [WIDTH, along],
        2 => [WIDTH - along, WIDTH],
        _ => [0.0, WIDTH - along],
    };
    [x, y, -DEPTH * layer as f64 / (layers - 1) as f64]
}

/// Node (i, j) of the soil's surface.
pub(super) fn top(mesh: &Mesh, i: usize, j: usize) -> [f64; 3] {
    let cells = (mesh.columns - 1) as f64;
    [WIDTH * i as f64 / cells, WIDTH * j as f64 / cells, 0.0]
}

/// Node of the tank: rings 0..rings are the foundation from inside to outside, the others the wall from below.
pub(super) fn tank(mesh: &Mesh, ring: usize, sector: usize) -> [f64; 3] {
    let above = ring.saturating_sub(mesh.rings - 1);
    let share = (ring - above) as f64 / (mesh.rings - 1) as f64;
    let radius = INNER + (RADIUS - INNER) * share;
    let [nx, ny] = normal(mesh, sector);
    let height = if above == 0 { 0.0 } else { HEIGHT * above as f64 / (mesh.wall - 1) as f64 };
    [0.5 * WIDTH + radius * nx, 0.5 * WIDTH + radius * ny, height]
}

/// `(cos, sin)` of `2 pi sector / sectors`, exact on the axes and symmetric in the four quadrants.
///
/// Computed by Taylor series, because sine and cosine of platforms differ in the last bit.
pub(super) fn normal(mesh: &Mesh, sector: usize) -> [f64; 2] {
    let quarter = mesh.sectors / 4;
    let angle = |k: usize| std::f64::consts::FRAC_PI_2 * k as f64 / quarter as f64;
    let k = sector % quarter;
    let (cos, sin) = if k == 0 { (1.0, 0.0) } else { (sine(angle(quarter - k)), sine(angle(k))) };
    [[cos, sin], [-sin, cos], [-cos, -sin], [sin, -cos]][sector / quarter]
}

/// sin x for `0 <= x <= pi / 2`.
fn sine(x: f64) -> f64 {
    let mut sum = 0.0;
    for k in (0..12_u32).rev() {
        sum = 1.0 - sum * x * x / f64::from((2 * k + 2) * (2 * k + 3));
    }
    x * sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sine_is_the_sine() {
        for k in 0..=100 {
            let x = f64::from(k) * std::f64::consts::FRAC_PI_2 / 100.0;
            assert!((sine(x) - x.sin()).abs() < 4e-16, "at {x}");
        }
    }

    #[test]
    fn normals_have_length_one() {
        let mesh = super::super::Level::P70.mesh();
        for [x, y] in (0..mesh.sectors).map(|k| normal(&mesh, k)) {
            assert!((x * x + y * y - 1.0).abs() < 1e-15);
        }
    }
}
