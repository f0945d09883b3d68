//! Lists of numbers that are kept between calls, so that a step allocates nothing but the first time.

use std::sync::{Mutex, PoisonError};

/// As many as were in use at a time.
#[derive(Debug, Default)]
pub(super) struct Spare(Mutex<Vec<Vec<f64>>>);

/// What is spare need not be copied.
impl Clone for Spare {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl Spare {
    /// `work` with a list of this length, whatever numbers are in it.
    pub fn with<R>(&self, length: usize, work: impl FnOnce(&mut [f64]) -> R) -> R {
        let taken = self.0.lock().unwrap_or_else(PoisonError::into_inner).pop();
        let mut list = taken.unwrap_or_default();
        list.resize(length.max(list.len()), 0.0);
        let result = work(&mut list[..length]);
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push(list);
        result
    }
}
