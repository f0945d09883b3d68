//! Tells the program when and from what it was built. Never fails the build.

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    let target = std::env::var("TARGET").unwrap_or_else(|_| "unknown".to_owned());
    println!("cargo:rustc-env=QLESS_TARGET={target}");
}
