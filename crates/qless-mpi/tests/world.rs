//! Real MPI jobs: many random rounds, and ranks that fail. Needs `mpirun` of OpenMPI or MPICH.

mod rounds;

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus};
use std::thread::sleep;
use std::time::{Duration, Instant, SystemTime};

use qless_mpi::{Alone, World, WorldError, on_threads};
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
        if !["abort", "exit"].contains(&fault) {
            assert_eq!(ended.status.code(), Some(101), "{fault}: {ended:?}");
            assert!(ended.errors.contains("fails on purpose"), "{fault}: {ended:?}");
        }
    }
}

#[test]
#[cfg(target_os = "linux")]
fn who_waits_leaves_the_processor_to_others() {
    let said = mpirun(2, &["late"], 30).said();
    let hundredths: Vec<u64> = said.split(' ').map(|time| time.parse().expect("a time")).collect();
    assert!(hundredths.len() == 4 && hundredths.iter().all(|&time| time < 25), "of a second of waiting: {said}");
}

#[test]
fn without_mpi_there_is_no_part_of_a_job() {
    let world = mpi::topology::SimpleCommunicator::world();
    assert_eq!(World::of(&world).err(), Some(WorldError::NotRunning));
}

/// The result of the same rounds within this process.
fn in_process(size: usize, seed: u64, rounds: u64) -> String {
    if size == 1 {
        return play(&Alone, seed, rounds);
    }
    on_threads(size, |ranks| play(ranks, seed, rounds)).swap_remove(0)
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

/// Runs the example on `ranks` ranks, with a time limit in seconds.
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

/// Allows more ranks than cores, and the user root, which is the only one in containers.
fn launcher() -> Command {
    let version = Command::new("mpirun").arg("--version").output();
    let version =
        version.expect("these tests need mpirun: install openmpi-bin and libopenmpi-dev, or mpich and libmpich-dev");
    let mut command = Command::new("mpirun");
    if String::from_utf8_lossy(&version.stdout).contains("Open MPI") {
        command.arg("--oversubscribe").envs([
            ("OMPI_ALLOW_RUN_AS_ROOT", "1"),
            ("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1"),
            // Containers may forbid the system call by which OpenMPI reads the memory of other ranks.
            ("OMPI_MCA_btl_vader_single_copy_mechanism", "none"),
        ]);
    }
    command
}

/// Cargo builds examples before tests, but not for `--test` alone; an outdated example must not run.
fn example() -> PathBuf {
    const BUILD: &str = "cargo build -p qless-mpi --features mpi --example rounds";
    let test = std::env::current_exe().expect("this test");
    let example = test.parent().and_then(Path::parent).expect("a build folder").join("examples/rounds");
    let built = changed(&example).unwrap_or_else(|_| panic!("{} is missing: {BUILD}", example.display()));
    let crate_folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let sources = ["src", "tests/rounds"].map(|folder| newest(&crate_folder.join(folder)).expect("sources"));
    assert!(
        sources.into_iter().all(|source| source <= built),
        "{} is older than its sources: {BUILD}",
        example.display()
    );
    example
}

fn changed(path: &Path) -> io::Result<SystemTime> {
    path.metadata()?.modified()
}

/// Time of the last change below a folder.
fn newest(path: &Path) -> io::Result<SystemTime> {
    let mut last = changed(path)?;
    if path.is_dir() {
        last = SystemTime::UNIX_EPOCH;
        for entry in path.read_dir()? {
            last = last.max(newest(&entry?.path())?);
        }
    }
    Ok(last)
}
