//! Compiles and runs programs against the shared library that this test was built with.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// A compiled program; its folder is removed with it.
pub struct Program {
    path: PathBuf,
    _folder: tempfile::TempDir,
}

const HERE: &str = env!("CARGO_MANIFEST_DIR");

/// The folder of the shared library: that of this test.
pub fn libraries() -> PathBuf {
    let test = std::env::current_exe().expect("a path");
    let folder = test.parent().expect("a folder").to_path_buf();
    assert!(folder.join("libqless_capi.so").is_file(), "no shared library in {}", folder.display());
    folder
}

/// A deck with three equations, of which the third follows from the others.
pub const DECK: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/corpus/decks/two_ties.inp");

/// Compiles `tests/c/<name>.c` with warnings as errors.
pub fn compile(name: &str, flags: &[&str]) -> Program {
    build("cc", &["-std=c11"], &format!("{HERE}/tests/c/{name}.c"), flags)
}

/// Compiles a source against the header and the shared library.
pub fn build(compiler: &str, standard: &[&str], source: &str, flags: &[&str]) -> Program {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("program");
    let libraries = libraries();
    let mut command = Command::new(compiler);
    command.args(standard).args(["-Wall", "-Wextra", "-Werror", "-g", "-O1", "-D_POSIX_C_SOURCE=200809L"]);
    command.arg(format!("-DDECK=\"{DECK}\"")).args(flags);
    command.arg(format!("-I{HERE}/include")).arg(source).arg("-o").arg(&path);
    // The linker takes from a library what the files before it need.
    command.args(flags.iter().filter(|flag| flag.starts_with("-l")));
    // The file by its name here; programs look for it by its number.
    let number = folder.path().join("libqless.so.0");
    std::os::unix::fs::symlink(libraries.join("libqless_capi.so"), number).expect("a link");
    command.arg(libraries.join("libqless_capi.so")).arg(format!("-Wl,-rpath,{}", folder.path().display())).arg("-lm");
    let built = command.output().unwrap_or_else(|error| panic!("{compiler}: {error}"));
    assert!(built.status.success(), "{source}: {}", String::from_utf8_lossy(&built.stderr));
    Program { path, _folder: folder }
}

/// Runs a program with this input and returns what it prints.
pub fn output(program: &Program, input: &str) -> String {
    run(Command::new(&program.path), &program.path, input)
}

/// Runs a program on MPI ranks behind a command such as `valgrind`, also as root and on fewer cores, as in containers.
#[allow(dead_code, reason = "not every test has ranks")]
pub fn on_ranks(command_before: &[&str], program: &Program, ranks: usize) -> String {
    let mut command = Command::new("mpirun");
    command.env("OMPI_ALLOW_RUN_AS_ROOT", "1").env("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1");
    command.env("OMPI_MCA_rmaps_base_oversubscribe", "1").env("OMPI_MCA_btl_vader_single_copy_mechanism", "none");
    command.env("OPENBLAS_NUM_THREADS", "1").args(["-n", &ranks.to_string()]);
    command.args(command_before).arg(&program.path);
    run(command, &program.path, "")
}

/// Runs a program under valgrind, which fails on leaks and on invalid access.
pub fn valgrind(program: &Program, input: &str) {
    let mut command = Command::new("valgrind");
    command.args(["--quiet", "--leak-check=full", "--show-leak-kinds=definite", "--errors-for-leak-kinds=definite"]);
    command.args(["--error-exitcode=9", "--track-origins=no"]).arg(&program.path);
    // A library that was built with every feature loads OpenBLAS, whose threads valgrind would report.
    command.env("OPENBLAS_NUM_THREADS", "1");
    run(command, &program.path, input);
}

fn run(mut command: Command, path: &Path, input: &str) -> String {
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap_or_else(|error| panic!("{command:?}: {error}"));
    let mut stdin = child.stdin.take().expect("a pipe");
    let input = input.to_owned();
    // The program may print before it has read everything.
    let writer = std::thread::spawn(move || stdin.write_all(input.as_bytes()));
    let output = child.wait_with_output().expect("an end");
    _ = writer.join();
    let (text, errors) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{}: {}\n{text}{errors}", path.display(), output.status);
    text.into_owned()
}
