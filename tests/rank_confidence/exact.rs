//! Where floating point is sure, exact arithmetic says the same: rank, and whether there is a solution.
//!
//! Coefficients are whole numbers in units of powers of two, so that combinations of equations are exact.

use qless::{BackendChoice, ConstraintSystem, Kind, Options, SystemBuilder, analyse};
use qless_scenes::Rng;
use qless_scenes::oracle::{consistent, rank_free};
use rayon::prelude::*;

const COUNT: u64 = 5_000;
/// The part of the systems that may be in doubt.
const DOUBTS: f64 = 0.02;

/// Sparse equations of whole numbers, every third a combination of earlier ones, one in eight of these with another right-hand side.
pub fn system(rng: &mut Rng) -> ConstraintSystem {
    let (m, n) = (2 + rng.below(30), 2 + rng.below(30));
    let unit = |rng: &mut Rng| 2_f64.powi(rng.below(41) as i32 - 20);
    let dofs: Vec<f64> = (0..n).map(|_| unit(rng)).collect();
    let mut rows: Vec<(Vec<f64>, f64)> = Vec::new();
    for i in 0..m {
        let mut row = (vec![0.0; n], 0.0);
        if i > 2 && i % 3 == 2 {
            for _ in 0..=rng.below(3) {
                let (other, factor) = (&rows[rng.below(i)], rng.below(7) as f64 - 3.0);
                row.0.iter_mut().zip(&other.0).for_each(|(a, b)| *a += factor * b);
                row.1 += factor * other.1;
            }
            row.1 += f64::from(rng.below(8) == 0);
        } else {
            (0..=rng.below(4)).for_each(|_| row.0[rng.below(n)] = rng.below(19) as f64 - 9.0);
            row.1 = rng.below(9) as f64 - 4.0;
        }
        if row.0.iter().all(|&v| v == 0.0) {
            row.1 = 0.0;
        }
        rows.push(row);
    }
    let mut builder = SystemBuilder::new(n);
    for (row, b) in rows {
        let own = unit(rng);
        let terms = row.iter().zip(&dofs).enumerate().filter(|(_, (v, _))| **v != 0.0);
        builder.equation(terms.map(|(j, (v, unit))| (j, v * unit * own)), b * own);
    }
    (0..n).filter(|j| j % 5 == 4 && n > 6).for_each(|j| builder.prescribe(j, 0.0));
    builder.build().expect("valid")
}

fn of(seed: u64) -> Result<bool, String> {
    let system = system(&mut Rng::new(seed ^ 0x00e8_ac7a));
    let backends = [BackendChoice::Faer, BackendChoice::Sparse, BackendChoice::Gauss];
    let options =
        Options { backend: backends[seed as usize % 3], presolve: seed.is_multiple_of(2), ..Options::default() };
    let analysis = analyse(&system, &options).map_err(|error| format!("{seed}: {error}"))?;
    if analysis.confidence().ambiguous {
        return Ok(false);
    }
    let exact = (rank_free(&system).expect("small"), consistent(&system).expect("small"));
    let found = (analysis.rank(), !analysis.kinds().contains(&Kind::Conflicting));
    if found == exact { Ok(true) } else { Err(format!("{seed} [{options:?}]: {found:?}, exactly {exact:?}")) }
}

#[test]
fn what_is_sure_is_what_exact_arithmetic_says() {
    let found: Vec<Result<bool, String>> = (0..COUNT).into_par_iter().map(of).collect();
    let faults: Vec<&String> = found.iter().filter_map(|one| one.as_ref().err()).collect();
    assert!(faults.is_empty(), "{} faults: {faults:#?}", faults.len());
    let doubts = found.iter().filter(|one| **one == Ok(false)).count();
    assert!(doubts as f64 <= DOUBTS * COUNT as f64, "{doubts} of {COUNT} in doubt");
}
