//! Systems distributed to ranks within this process, against the serial library.

mod common;
mod edges;
mod exact;
mod faults;
mod identical;
mod map;
