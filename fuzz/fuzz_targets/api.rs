//! The library itself.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| qless_fuzz::api(data));
