//! Case control: which sets hold in which subcase.

pub mod selected;
pub mod subcases;
