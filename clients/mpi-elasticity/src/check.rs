//! Checks that all ranks agree on: a failure on one rank is a failure on all, so none waits for ever.

use std::error::Error;

use qless_mpi::{Message, Ranks};

use crate::constraints::Gradient;

/// Whether a difference is small on all ranks. Collective.
pub fn check(ranks: &dyn Ranks, what: &str, off: f64, most: f64) -> Result<(), Box<dyn Error>> {
    // The bits of positive doubles have the order of the numbers, with NaN as the largest.
    let mut worst = [off.abs().to_bits()];
    ranks.max(&mut worst);
    let off = f64::from_bits(worst[0]);
    if off <= most {
        if ranks.rank() == 0 {
            println!("  {what}: off by {off:.0e}");
        }
        return Ok(());
    }
    Err(format!("{what}: off by {off:e}, where {most:e} is allowed").into())
}

/// The largest difference.
pub fn largest(a: &Gradient, b: &Gradient) -> f64 {
    difference(a.as_flattened(), b.as_flattened())
}

/// The largest difference between u of all ranks, whose parts rank 0 puts together, and u of one rank. Collective; 0 on other ranks.
pub fn same_as_alone(ranks: &dyn Ranks, own: &[f64], alone: Option<&[f64]>) -> f64 {
    let words = own.iter().map(|value| value.to_bits()).collect();
    let parts = ranks.exchange(vec![Message { rank: 0, words }]);
    let all: Vec<f64> = parts.iter().flat_map(|part| &part.words).map(|&word| f64::from_bits(word)).collect();
    alone.map_or(0.0, |alone| difference(&all, alone))
}

/// NaN if lengths differ or a number is NaN, so that no check passes.
fn difference(a: &[f64], b: &[f64]) -> f64 {
    let worse = |most: f64, off: f64| if off > most || off.is_nan() { off } else { most };
    let offs = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    if a.len() == b.len() { offs.fold(0.0, worse) } else { f64::NAN }
}
