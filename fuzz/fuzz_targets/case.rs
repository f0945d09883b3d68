//! Matrix Market, right-hand side, prescribed values and labels.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| qless_fuzz::case(data));
