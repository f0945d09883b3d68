//! The name under which programs load the shared library: its number changes if programs must be compiled again.

fn main() {
    if std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|os| os == "linux") {
        let major = std::env::var("CARGO_PKG_VERSION_MAJOR").unwrap_or_default();
        println!("cargo::rustc-cdylib-link-arg=-Wl,-soname,libqless.so.{major}");
    }
    println!("cargo::rerun-if-changed=build.rs");
}
