//! One rank.

use super::{Message, Ranks};

/// The only rank of a job.
#[derive(Clone, Copy, Debug, Default)]
pub struct Alone;

impl Ranks for Alone {
    fn rank(&self) -> usize {
        0
    }

    fn size(&self) -> usize {
        1
    }

    fn exchange(&self, messages: Vec<Message>) -> Vec<Message> {
        messages
    }

    fn overlap(&self, messages: Vec<Message>, _from: &[usize], work: &mut dyn FnMut()) -> Vec<Message> {
        work();
        messages
    }

    fn sum(&self, _numbers: &mut [u64]) {}

    fn max(&self, _numbers: &mut [u64]) {}

    fn gather(&self, numbers: &[u64]) -> Vec<u64> {
        numbers.to_vec()
    }
}
