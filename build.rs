//! Tells the program when and from what it was built; with the feature `peers`, compiles what it is compared with.

#[cfg(feature = "peers")]
#[path = "build/peers.rs"]
mod peers;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let target = std::env::var("TARGET").unwrap_or_else(|_| "unknown".to_owned());
    println!("cargo::rustc-env=QLESS_TARGET={target}");
    #[cfg(feature = "peers")]
    if let Err(missing) = peers::compile() {
        println!("cargo::error={}", missing.replace('\n', " "));
    }
}
