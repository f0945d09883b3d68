//! Radioss decks.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| qless_fuzz::radioss(data));
