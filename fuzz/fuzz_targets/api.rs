//! The library itself.
#![no_main]

#[path = "../src/api.rs"]
mod api;

libfuzzer_sys::fuzz_target!(|data: &[u8]| api::api(data));
