//! The smallest forces in a statically indeterminate chain of springs.

use qless_qr::{Error, Matrix, Options, least_squares, minimum_norm};

fn main() -> Result<(), Error> {
    // Node i lies between the springs i and i + 1: f_i - f_{i+1} = load_i. There is one more force than equations.
    let start: Vec<usize> = (0..=4).map(|i| 2 * i).collect();
    let index: Vec<u32> = (0..4).flat_map(|i| [i, i + 1]).collect();
    let values: Vec<f64> = (0..4).flat_map(|_| [1.0, -1.0]).collect();
    let loads = [1.0, 0.0, 0.0, 2.0];

    let a = Matrix::by_rows(4, 5, &start, &index, &values)?;
    let shortest = minimum_norm(&a, &loads, Options::new())?;
    let basic = least_squares(&a, &loads, Options::new())?;
    let norm = |x: &[f64]| x.iter().map(|v| v * v).sum::<f64>().sqrt();
    println!("shortest {:.3?}, norm {:.3}", shortest.x, norm(&shortest.x));
    println!("basic    {:.3?}, norm {:.3}", basic.x, norm(&basic.x));

    // For many loads, factor A^T once and keep Q.
    let factor = a.transposed().analyse()?.factor(a.values(), &[], Options::new().keep_q(true))?;
    println!("other loads {:.3?}", factor.solve_transposed(&[0.0, 1.0, 0.0, 0.0])?);
    Ok(())
}
