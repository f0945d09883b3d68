//! `mpirun -n N qless check` gives the verdicts of a single process, one report and one exit code. Needs `mpirun` of OpenMPI or MPICH.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::Value;

const PROGRAM: &str = env!("CARGO_BIN_EXE_qless");

#[test]
fn ranks_say_what_one_process_says() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus/cases");
    let mut cases: Vec<PathBuf> =
        fs::read_dir(folder).expect("cases").map(|case| case.expect("a case").path()).collect();
    cases.sort();
    assert!(cases.len() > 20);
    for (k, case) in cases.iter().enumerate() {
        let arguments = ["check", "--format", "json"];
        let serial = Command::new(PROGRAM).args(arguments).arg(case).output().expect("the program runs");
        // Every case on every number of ranks would take minutes; tests of the library do that.
        let size = [2, 4, 7, 1][k % 4];
        let ranks = mpirun(size).args(arguments).arg(case).output().expect("mpirun runs");
        let what = format!("{} on {size}: {}", case.display(), String::from_utf8_lossy(&ranks.stderr));
        assert_eq!(ranks.status.code(), serial.status.code(), "{what}");
        compare(&json(&serial), &json(&ranks), &what);
    }
}

fn compare(serial: &Value, ranks: &Value, what: &str) {
    for key in ["schema", "input", "status", "rank", "counts"] {
        assert_eq!(serial[key], ranks[key], "{key}: {what}");
    }
    // Ranks explain by kept equations alone.
    let found = |report: &Value| -> Vec<[Value; 4]> {
        let all = report["dependent"].as_array().expect("a list");
        all.iter().map(|d| ["row", "label", "kind", "mismatch"].map(|key| d[key].clone())).collect()
    };
    assert_eq!(found(serial), found(ranks), "{what}");
    assert_eq!(serial["confidence"]["ambiguous"], ranks["confidence"]["ambiguous"], "{what}");
    let fixed = |report: &Value| -> Vec<(u64, f64)> {
        let all = report["generated_boundary_conditions"].as_array().expect("a list");
        all.iter().map(|c| (c["dof"].as_u64().expect("a DOF"), c["value"].as_f64().expect("a value"))).collect()
    };
    assert_eq!(fixed(serial), fixed(ranks), "{what}");
}

#[test]
fn the_text_is_that_of_one_process() {
    let place = tempfile::tempdir().expect("a folder");
    let case = case(place.path());
    let serial = Command::new(PROGRAM).arg("check").arg(&case).output().expect("the program runs");
    let ranks = mpirun(3).arg("check").arg(&case).output().expect("mpirun runs");
    let of = |output: &Output| {
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        // Ranks explain by kept equations alone, without arithmetic and repairs.
        let others = ["Time:", "Presolve", "faer", "Analysed", "    ", "Next:"];
        let differ = |line: &&str| !others.iter().any(|first| line.starts_with(first));
        text.lines().filter(differ).map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(of(&serial), of(&ranks), "{}", String::from_utf8_lossy(&ranks.stderr));
    assert_eq!((serial.status.code(), ranks.status.code()), (Some(1), Some(1)));
    let text = String::from_utf8_lossy(&ranks.stdout);
    assert!(text.contains("\"tie 3\"") && text.contains("Analysed by 3 ranks"), "{text}");
}

#[test]
fn a_report_is_written_once_and_faults_are_told_once() {
    let place = tempfile::tempdir().expect("a folder");
    let case = case(place.path());
    let report = place.path().join("report.txt");
    let ended = mpirun(4).arg("check").arg(&case).arg("-o").arg(&report).output().expect("mpirun runs");
    assert_eq!(ended.status.code(), Some(1), "{ended:?}");
    assert!(fs::read_to_string(&report).expect("a report").ends_with(".\n"));
    fs::remove_file(&report).expect("a report");

    fs::write(case.join("b.txt"), "0\n0\nnan\n1\n").expect("written");
    let serial = Command::new(PROGRAM).arg("check").arg(&case).output().expect("the program runs");
    let ended = mpirun(4).arg("check").arg(&case).arg("-o").arg(&report).output().expect("mpirun runs");
    let (said, by_one) = (String::from_utf8_lossy(&ended.stderr), String::from_utf8_lossy(&serial.stderr));
    assert_eq!((ended.status.code(), serial.status.code()), (Some(2), Some(2)));
    assert!(said.contains("b.txt:3:") && said.matches(by_one.trim()).count() == 1, "{said}\n{by_one}");
    let refused: [(&[&str], &str); 4] = [
        (&["check", "deck.inp"], "read Matrix Market only"),
        (&["check", "--effort", "exact", "case"], "--effort exact runs in one process only"),
        (&["reduce", "case", "-o", "out"], "only `qless check` runs on more than one"),
        (&["check", "--no-such", "case"], "--no-such"),
    ];
    for (arguments, words) in refused {
        let ended = mpirun(2).current_dir(&place).args(arguments).output().expect("mpirun runs");
        assert_eq!(ended.status.code(), Some(2), "{arguments:?}: {ended:?}");
        assert!(String::from_utf8_lossy(&ended.stderr).contains(words), "{ended:?}");
    }
    let names = fs::read_dir(&place).expect("a folder").map(|entry| entry.expect("a file").file_name());
    assert_eq!(names.collect::<Vec<_>>(), ["case"], "nothing else is left");
}

/// One rank is killed while all are running.
#[test]
#[cfg(target_os = "linux")]
fn a_rank_that_is_killed_leaves_no_report() {
    let place = tempfile::tempdir().expect("a folder");
    // The run must be long enough for the kill.
    let (matrix, report) = (place.path().join("C.mtx"), place.path().join("report.json"));
    let count = 1_000_000;
    let entries: Vec<String> = (1..=count).map(|k| format!("{k} {k} 1\n{k} {} -1\n", k + 1)).collect();
    let head = format!("%%MatrixMarket matrix coordinate real general\n{count} {} {}\n", count + 1, 2 * count);
    fs::write(&matrix, head + &entries.concat()).expect("written");
    let mut job = mpirun(3);
    job.arg("check").arg(&matrix).arg("-o").arg(&report).stdout(Stdio::null()).stderr(Stdio::null());
    let mut job = job.spawn().expect("mpirun runs");
    // OpenMPI itself may wait for ever if a process is killed while the job starts.
    let victim = until(|| ranks_of(&matrix).into_iter().find(|&rank| ticks(rank) >= 40));
    Command::new("kill").args(["-KILL", &victim.to_string()]).status().expect("kill runs");
    let status = until(|| job.try_wait().expect("a job of this process"));
    assert!(!status.success() && !report.exists(), "{status:?}");
    until(|| ranks_of(&matrix).is_empty().then_some(()));
    assert_eq!(fs::read_dir(&place).expect("a folder").count(), 1, "the matrix alone is left");
}

/// Processes of the program that check this file.
#[cfg(target_os = "linux")]
fn ranks_of(input: &Path) -> Vec<u32> {
    let all = fs::read_dir("/proc").expect("Linux").filter_map(|entry| entry.ok()?.file_name().to_str()?.parse().ok());
    let is_rank = |process: &u32| {
        let line = fs::read(format!("/proc/{process}/cmdline")).unwrap_or_default();
        let mut words = line.split(|&byte| byte == 0);
        words.next() == Some(PROGRAM.as_bytes()) && words.any(|word| word == input.as_os_str().as_encoded_bytes())
    };
    let mut ranks: Vec<u32> = all.filter(is_rank).collect();
    ranks.sort_unstable();
    ranks
}

/// Processor time of a process, in hundredths of a second: the start of a job takes some 10 of them.
#[cfg(target_os = "linux")]
fn ticks(process: u32) -> u64 {
    let line = fs::read_to_string(format!("/proc/{process}/stat")).unwrap_or_default();
    let after_name = line.rsplit(')').next().unwrap_or_default().split_whitespace();
    after_name.skip(11).take(2).filter_map(|time| time.parse::<u64>().ok()).sum()
}

#[cfg(target_os = "linux")]
fn until<T>(mut there: impl FnMut() -> Option<T>) -> T {
    let start = Instant::now();
    loop {
        if let Some(found) = there() {
            return found;
        }
        assert!(start.elapsed() < Duration::from_secs(40), "it hangs");
        sleep(Duration::from_millis(1));
    }
}

/// Four ties, the third of which repeats the first, and the fourth of which contradicts it; one DOF is prescribed.
fn case(place: &Path) -> PathBuf {
    let folder = place.join("case");
    fs::create_dir(&folder).expect("a folder");
    let matrix = "%%MatrixMarket matrix coordinate real general\n4 4 8\n4 1 3\n4 2 -3\n1 1 1\n1 2 -1\n2 2 1\n2 3 -1\n3 1 2\n3 2 -2\n";
    let files = [
        ("C.mtx", matrix),
        ("b.txt", "0.5\n0\n1\n1\n"),
        ("prescribed.txt", "3 0.25\n"),
        ("rows.txt", "tie 1\ntie 2\ntie 3\n\n"),
        ("cols.txt", "a\nb\nc\nd\n"),
    ];
    files.iter().for_each(|(name, text)| fs::write(folder.join(name), text).expect("written"));
    folder
}

fn json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {output:?}"))
}

/// The program on several ranks. It allows more ranks than cores, and the user root, which is the only one in containers.
fn mpirun(size: usize) -> Command {
    let version = Command::new("mpirun").arg("--version").output();
    let version = version.expect("these tests need mpirun: install openmpi-bin, or mpich");
    let mut command = Command::new("mpirun");
    if String::from_utf8_lossy(&version.stdout).contains("Open MPI") {
        command.arg("--oversubscribe").envs([
            ("OMPI_ALLOW_RUN_AS_ROOT", "1"),
            ("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1"),
            // Containers may forbid the system call by which OpenMPI reads the memory of other ranks.
            ("OMPI_MCA_btl_vader_single_copy_mechanism", "none"),
        ]);
    }
    command.args(["-n", &size.to_string(), PROGRAM]);
    command
}
