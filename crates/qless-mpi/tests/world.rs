//! Real jobs of MPI: many random rounds, and ranks that fail. Needs `mpirun`, of OpenMPI or MPICH.

mod rounds;

use std::fs::File;
use std::io::Read;
use std::path::PathBuf;
use std::process::{Command, ExitStatus};
use std::thread::sleep;
use std::time::{Duration, Instant};

use qless_mpi::{Alone, World, WorldError, together};
use rounds::play::play;

const SIZES: [usize; 4] = [1, 2, 4, 7];

#[test]
fn random_rounds() {
    for size in SIZES {
        assert_eq!(mpirun(size, &["whole", "23", "2000"], 100).said(), in_process(size, 23, 2000));
    }
}

#[test]
fn long_messages_in_pieces() {
    assert_eq!(mpirun(3, &["pieces", "6", "300"], 60).said(), in_process(3, 6, 300));
}

#[test]
fn parts_of_a_job_by_themselves() {
    let (three, two) = (in_process(3, 9, 200), in_process(2, 9, 200));
    let said = mpirun(5, &["parts", "9", "200"], 60).said();
    let mut lines: Vec<&str> = said.lines().collect();
    lines.sort_unstable();
    assert_eq!(lines, [two, three]);
}

#[test]
fn a_rank_that_fails_ends_the_job() {
    for fault in ["panic", "work", "thread", "abort", "exit"] {
        let ended = mpirun(4, &["fault", fault], 30);
        assert!(!ended.status.success(), "{fault}: {ended:?}");
        let told = ["abort", "exit"].contains(&fault) || ended.errors.contains("fails on purpose");
        assert!(told, "{fault}: {ended:?}");
    }
}

#[test]
fn without_mpi_there_is_no_part_of_a_job() {
    let world = mpi::topology::SimpleCommunicator::world();
    assert_eq!(World::of(&world).err(), Some(WorldError::NotRunning));
}

/// What the same rounds say within this process.
fn in_process(size: usize, seed: u64, rounds: u64) -> String {
    if size == 1 {
        return play(&Alone, seed, rounds);
    }
    together(size, |ranks| play(ranks, seed, rounds)).swap_remove(0)
}

#[derive(Debug)]
struct Ended {
    status: ExitStatus,
    output: String,
    errors: String,
}

impl Ended {
    fn said(self) -> String {
        assert!(self.status.success(), "{self:?}");
        self.output.trim().to_owned()
    }
}

/// Runs the example on so many ranks, for at most so many seconds.
fn mpirun(size: usize, arguments: &[&str], seconds: u64) -> Ended {
    let folder = tempfile::tempdir().expect("a folder");
    let files = ["output", "errors"].map(|name| folder.path().join(name));
    let [output, errors] = files.each_ref().map(|path| File::create(path).expect("a file"));
    let mut command = launcher();
    command.args(["-n", &size.to_string()]).arg(example()).args(arguments).stdout(output).stderr(errors);
    let status = ended_within(command, Duration::from_secs(seconds));
    let [output, errors] = files.map(|path| {
        let mut text = Vec::new();
        File::open(path).and_then(|mut file| file.read_to_end(&mut text)).expect("a file");
        String::from_utf8_lossy(&text).into_owned()
    });
    let status = status.unwrap_or_else(|| panic!("{size} ranks, {arguments:?}: hangs\n{output}\n{errors}"));
    Ended { status, output, errors }
}

fn ended_within(mut command: Command, longest: Duration) -> Option<ExitStatus> {
    let start = Instant::now();
    let mut job = command.spawn().expect("mpirun was there");
    while start.elapsed() < longest {
        if let Some(status) = job.try_wait().expect("a job of this process") {
            return Some(status);
        }
        sleep(Duration::from_millis(10));
    }
    job.kill().and_then(|()| job.wait()).expect("a job of this process");
    None
}

/// With more ranks than cores, and as root: containers have no other user.
fn launcher() -> Command {
    let version = Command::new("mpirun").arg("--version").output();
    let version =
        version.expect("these tests need mpirun: install openmpi-bin and libopenmpi-dev, or mpich and libmpich-dev");
    let mut command = Command::new("mpirun");
    if String::from_utf8_lossy(&version.stdout).contains("Open MPI") {
        command.arg("--oversubscribe").envs([
            ("OMPI_ALLOW_RUN_AS_ROOT", "1"),
            ("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1"),
            // Containers may forbid what it wants to read memory of other ranks with.
            ("OMPI_MCA_btl_vader_single_copy_mechanism", "none"),
        ]);
    }
    command
}

fn example() -> PathBuf {
    let test = std::env::current_exe().expect("this test");
    let example = test.parent().and_then(|deps| deps.parent()).expect("a build folder").join("examples/rounds");
    assert!(example.exists(), "cargo test without --test builds examples first: {}", example.display());
    example
}
