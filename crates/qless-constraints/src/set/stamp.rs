//! Which state of something is meant: an identity that is made when somebody asks, as most changes follow one another unseen.

use std::sync::OnceLock;

use qless::common::Identity;

/// Of the state since the last change.
#[derive(Default)]
pub(super) struct Stamp(OnceLock<Identity>);

impl Stamp {
    pub fn get(&self) -> Identity {
        *self.0.get_or_init(Identity::new)
    }

    /// After a change.
    pub fn renew(&mut self) {
        self.0.take();
    }
}
