//! Dependent columns: rank, basic and minimum-norm solution, tolerance.

use qless_qr::{Error, Matrix, Options, Tolerance, least_squares, minimum_norm};

fn main() -> Result<(), Error> {
    // Column 2 is the sum of the first two except for 1e-9.
    let columns = [[1.0, 1.0, 0.0, 2.0], [0.0, 1.0, 1.0, 1.0], [1.0, 2.0, 1.0, 3.0 + 1e-9]];
    let start = [0_usize, 4, 8, 12];
    let index: Vec<u32> = (0..12).map(|k| k % 4).collect();
    let a = Matrix::by_columns(4, 3, &start, &index, columns.as_flattened())?;
    let b = [1.0, 3.0, 1.0, 4.0];

    for (name, tolerance) in [("1e-13 of the largest column", Tolerance::Relative), ("1e-6", Tolerance::Absolute(1e-6))]
    {
        let options = Options::new().tolerance(tolerance);
        let factor = a.analyse()?.factor(a.values(), &b, options)?;
        let independent = &factor.order()[..factor.rank()];
        println!("tolerance about {name}: rank {}, independent columns {independent:?}", factor.rank());
        println!("  smallest singular value of R1 about {:.1e}", factor.smallest_singular_value());
        println!("  dropped {:.1e}, residual {:.3}", factor.dropped(), factor.rest()[0]);
        println!("  basic    {:.3?}", least_squares(&a, &b, options)?.x);
        println!("  shortest {:.3?}", minimum_norm(&a, &b, options)?.x);
    }
    Ok(())
}
