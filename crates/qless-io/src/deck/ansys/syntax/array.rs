//! Arrays of numbers, as `*DIM` makes them.

use super::expression::NoValue;

/// Numbers by up to three indices from 1; the first runs fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct Array {
    pub sizes: [usize; 3],
    /// Those that are not known are no numbers.
    pub values: Vec<f64>,
    /// False once an element was set of which nobody knows which.
    pub is_known: bool,
}

impl Array {
    /// All zero; `count` is the product of the sizes.
    pub fn zeros(sizes: [usize; 3], count: usize) -> Self {
        Self { sizes, values: vec![0.0; count], is_known: true }
    }

    /// The place of an element.
    pub fn place(&self, indices: &[f64]) -> Result<usize, NoValue> {
        let mut place = 0;
        let mut stride = 1;
        for (k, size) in self.sizes.iter().enumerate() {
            let index = indices.get(k).map_or(1.0, |index| index.round());
            if !(1.0..=*size as f64).contains(&index) {
                return Err(NoValue::Unknown);
            }
            place += (index as usize - 1) * stride;
            stride *= size;
        }
        Ok(place)
    }
}
