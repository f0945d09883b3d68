//! With the feature `peers`: compiles the shims around Eigen's SparseQR and LAPACK's dgeqp3, which `qless bench` compares with, and where
//! it is installed a program around MUMPS.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    #[cfg(feature = "peers")]
    if let Err(missing) = peers::compile() {
        println!("cargo::error={}", missing.replace('\n', " "));
    }
}

#[cfg(feature = "peers")]
mod peers {
    use std::path::PathBuf;
    use std::process::Command;
    use std::{env, fs};

    const SOURCES: &str = "peers";
    const CALLS_LAPACK: &str = "void dgeqp3_(void);\nint main(void) { dgeqp3_(); return 0; }\n";

    /// Compiles the shims; the error says what is missing.
    pub fn compile() -> Result<(), String> {
        println!("cargo::rerun-if-changed={SOURCES}");
        let eigen = eigen()?;
        links_lapack()?;
        let mut build = cc::Build::new();
        // As fast as it gets: the comparison is to be fair in debug builds too.
        build.cpp(true).std("c++17").opt_level(3).define("NDEBUG", None).include(eigen).warnings(false);
        build.file(format!("{SOURCES}/eigen.cpp"));
        build.try_compile("qless_eigen").map_err(|error| format!("the shim around Eigen does not compile: {error}"))?;
        let mut build = cc::Build::new();
        build.opt_level(3).file(format!("{SOURCES}/lapack.c"));
        build
            .try_compile("qless_lapack")
            .map_err(|error| format!("the shim around LAPACK does not compile: {error}"))?;
        println!("cargo::rustc-link-lib=lapack");
        mumps()
    }

    /// Compiles the program around MUMPS, of which `QLESS_MUMPS` is the path; leaves it out where the library without MPI is missing.
    fn mumps() -> Result<(), String> {
        let program = out()?.join("qless_mumps");
        let mut command = cc::Build::new().opt_level(3).get_compiler().to_command();
        command.arg(format!("{SOURCES}/mumps.c")).arg("-o").arg(&program).arg("-ldmumps_seq");
        if runs(&mut command)? {
            println!("cargo::rustc-env=QLESS_MUMPS={}", program.display());
        }
        Ok(())
    }

    fn out() -> Result<PathBuf, String> {
        env::var_os("OUT_DIR").map(PathBuf::from).ok_or("OUT_DIR is not set: run this through cargo".into())
    }

    fn runs(compiler: &mut Command) -> Result<bool, String> {
        let output = compiler.output().map_err(|error| format!("the C compiler does not start: {error}"))?;
        Ok(output.status.success())
    }

    /// The folder of Eigen's headers: `EIGEN_INCLUDE_DIR`, or where packages have it.
    fn eigen() -> Result<PathBuf, String> {
        println!("cargo::rerun-if-env-changed=EIGEN_INCLUDE_DIR");
        let named = env::var_os("EIGEN_INCLUDE_DIR").map(PathBuf::from);
        let usual = ["/usr/include/eigen3", "/usr/local/include/eigen3"].map(PathBuf::from);
        named.into_iter().chain(usual).find(|folder| folder.join("Eigen/SparseQR").is_file()).ok_or_else(|| {
        "Eigen is missing: Eigen/SparseQR is not found; install it with `sudo apt-get install libeigen3-dev`, name its folder \
         in EIGEN_INCLUDE_DIR, or build without it by leaving out `--features peers`"
            .to_owned()
    })
    }

    /// Links a program of one call, so that the answer comes here and not from the linker at the end.
    fn links_lapack() -> Result<(), String> {
        let folder = out()?;
        let source = folder.join("calls_lapack.c");
        fs::write(&source, CALLS_LAPACK)
            .map_err(|error| format!("the test of the linker cannot be written: {error}"))?;
        let mut command = cc::Build::new().get_compiler().to_command();
        command.arg(&source).arg("-o").arg(folder.join("calls_lapack")).arg("-llapack");
        if runs(&mut command)? {
            return Ok(());
        }
        Err("LAPACK is missing: no library `lapack` with dgeqp3; install it with `sudo apt-get install libopenblas-pthread-dev` \
         (or liblapack-dev, which is slow), or build without it by leaving out `--features peers`"
        .into())
    }
}
