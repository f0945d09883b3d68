//! What each command that constrains does.

pub mod coupled;
pub mod elements;
pub mod equations;
pub mod numbering;
pub mod prescribed;
pub mod region;
pub mod selection;
pub mod unread;
