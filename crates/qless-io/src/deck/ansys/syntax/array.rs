//! Arrays of APDL parameters: numbers with up to three indices from 1. The first index varies fastest.

use crate::deck::expression::NoValue;

/// An array that `*DIM` defines.
#[derive(Clone, Debug, PartialEq)]
pub struct ApdlArray {
    pub sizes: [usize; 3],
    /// The elements; NaN for an unknown one.
    pub values: Vec<f64>,
    /// Whether the elements are known: false after a command has set an element whose index is unknown.
    pub is_known: bool,
}

impl ApdlArray {
    /// An array of zeros; `count` is the product of the sizes.
    pub fn zeros(sizes: [usize; 3], count: usize) -> Self {
        Self { sizes, values: vec![0.0; count], is_known: true }
    }

    /// Index of an element in `values`.
    pub fn index(&self, indices: &[f64]) -> Result<usize, NoValue> {
        let mut position = 0;
        let mut stride = 1;
        for (k, size) in self.sizes.iter().enumerate() {
            let index = indices.get(k).map_or(1.0, |index| index.round());
            if !(1.0..=*size as f64).contains(&index) {
                return Err(NoValue::Unknown);
            }
            position += (index as usize - 1) * stride;
            stride *= size;
        }
        Ok(position)
    }
}
