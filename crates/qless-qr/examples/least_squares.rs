//! Fits a plane to scattered heights by least squares; then other heights at the same places, and other places with the same pattern.

use qless_qr::{Error, Matrix, Options, least_squares};

fn main() -> Result<(), Error> {
    // Row i of A is (1, x_i, y_i); the heights are 2 + 3 x - y with errors of 0.1.
    let places = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0), (2.0, 1.0), (1.0, 2.0)];
    let heights: Vec<f64> =
        places.iter().zip([0.1, -0.1].iter().cycle()).map(|((x, y), error)| 2.0 + 3.0 * x - y + error).collect();
    let start: Vec<i32> = (0..=6).map(|i| 3 * i).collect();
    let index: Vec<i32> = (0..18).map(|k| k % 3).collect();
    let values: Vec<f64> = places.iter().flat_map(|&(x, y)| [1.0, x, y]).collect();

    let a = Matrix::by_rows(6, 3, &start, &index, &values)?;
    let plane = least_squares(&a, &heights, Options::new())?;
    println!("plane {:.3?}, residual {:.3}, rank {}", plane.x, plane.residuals[0], plane.rank);

    // For more heights at the same places, keep Q.
    let symbolic = a.analyse()?;
    let factor = symbolic.factor(a.values(), &[], Options::new().keep_q(true))?;
    for lift in [1.0, 2.0] {
        let lifted: Vec<f64> = heights.iter().map(|height| height + lift).collect();
        println!("lifted by {lift}: {:.3?}, condition about {:.1}", factor.solve(&lifted)?, factor.condition());
    }

    // Other places have the same pattern, so the analysis can be reused.
    let farther: Vec<f64> = values.iter().map(|v| if *v == 1.0 { 1.0 } else { 2.0 * v }).collect();
    let factor = symbolic.factor(&farther, &heights, Options::new())?;
    println!("farther apart: {:.3?}", factor.basic()?);
    Ok(())
}
