//! Case folders by their meaning: read, analysed, reduced.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| qless_fuzz::folder(data));
