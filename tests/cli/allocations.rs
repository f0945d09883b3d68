//! Each allocation of the program fails in turn. The program ends with exit code 3 and states the memory needed and available, or its result is
//! right; the output is the old one or the new one, whole, nothing else is left behind, and the next run works.
//!
//! `QLESS_FAULTS=all` tests every allocation; by default the first fifty, and then steps of a fiftieth.

use super::harness::Place;

#[test]
fn every_allocation_of_reduce_may_fail() {
    each_allocation(["reduce a -o out -q --threads 1", "reduce b -o out -q --threads 1"]);
}

#[test]
fn every_allocation_of_clean_may_fail() {
    each_allocation(["clean a.inp -o out.inp -q --threads 1", "clean b.inp -o out.inp -q --threads 1"]);
}

#[test]
fn every_allocation_of_check_may_fail() {
    each_allocation(["check a -q -o out.txt --threads 1", "check b -q -o out.txt --threads 1"]);
}

#[test]
fn every_allocation_of_generate_may_fail() {
    each_allocation(["generate path -o out -q", "generate cycle --gap 1 -o out -q"]);
}

/// The run that makes the existing output, and the run that fails.
fn each_allocation([old, new]: [&str; 2]) {
    let all = std::env::var("QLESS_FAULTS").is_ok_and(|which| which == "all");
    let place = prepared();
    assert!(place.run(new).code < 2);
    let after = everything(&place);
    assert!(place.run(old).code < 2);
    let before = everything(&place);
    let (mut k, mut ended) = (0, [0, 0]);
    while let Some(code) = fails(&place, [old, new], k, [&before, &after]) {
        ended[usize::from(code == 3)] += 1;
        k += if all { 1 } else { 1 + k / 50 };
    }
    println!("{new}: {} of {} failures ended a run, the last before allocation {k}", ended[1], ended[0] + ended[1]);
    assert!(ended[1] > 100, "{new}: {ended:?}");
}

type Files = Vec<(std::path::PathBuf, Vec<u8>)>;

/// Every file, without times and memory in it.
fn everything(place: &Place) -> Files {
    let timeless = |text: Vec<u8>| {
        text.split(|&byte| byte == b'\n').filter(|line| !line.starts_with(b"Time: ")).collect::<Vec<_>>().concat()
    };
    place.everything().into_iter().map(|(path, text)| (path, timeless(text))).collect()
}

/// Result of a run whose `k`-th allocation failed; `None` if it makes fewer.
fn fails(place: &Place, [old, new]: [&str; 2], k: usize, [before, after]: [&Files; 2]) -> Option<i32> {
    let output = place.command(new).env("QLESS_FAIL_AT", k.to_string()).env("RUST_BACKTRACE", "0").output();
    let output = output.expect("the program starts");
    let text = String::from_utf8_lossy(&output.stderr);
    let what = format!("{new}, allocation {k}: {:?}: {text}", output.status);
    let code = output.status.code().unwrap_or_else(|| panic!("{what}"));
    if code == 3 {
        assert!(text.contains("error: ") && text.matches(" MiB").count() >= 2, "{what}");
    }
    assert!(code < 2 || code == 3, "{what}");
    let found = everything(place);
    assert!(found == *after || (code == 3 && found == *before), "{what}: neither the old output nor the new one");
    if found != *before {
        assert!(place.run(old).code < 2, "{what}");
    }
    text.contains("fails on purpose").then_some(code)
}

/// Two small models of each kind.
fn prepared() -> Place {
    let place = Place::new();
    for (name, seed) in [("a", 1), ("b", 2)] {
        let run = place.run(&format!("generate planted --rows 6 --dofs 9 --combos 1 --seed {seed} -o {name} -q"));
        assert_eq!(run.code, 0, "{}", run.err);
        let tie = format!("*EQUATION\n2\n1,1,1.,2,1,-{seed}.\n");
        place.file(&format!("{name}.inp"), format!("*NODE\n1,0.,0.,0.\n2,1.,0.,0.\n{tie}{tie}"));
    }
    place
}
