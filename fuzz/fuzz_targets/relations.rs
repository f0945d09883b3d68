//! Named relations.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| qless_fuzz::relations(data));
