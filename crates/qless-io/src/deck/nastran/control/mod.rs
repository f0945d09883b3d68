//! Case control: which sets hold in which subcase.

pub mod one_for_the_run;
pub mod selected;
pub mod subcases;
pub mod unions;
