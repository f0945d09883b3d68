//! Tells the program when and from what it was built.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let target = std::env::var("TARGET").unwrap_or_else(|_| "unknown".to_owned());
    println!("cargo::rustc-env=QLESS_TARGET={target}");
    // Read before main by OpenBLAS, of which the linker does not know (see the features of spqr-sys).
    #[cfg(feature = "spqr")]
    if std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|system| system == "linux") {
        println!("cargo::rustc-link-arg-bins=-Wl,--export-dynamic-symbol=openblas_num_threads_env");
    }
}
