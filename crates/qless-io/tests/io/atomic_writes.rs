//! A failed write changes nothing: no new file, no partial file, no temporary folder.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::Path;

use qless::{ConstraintSystem, SystemBuilder};
use qless_io::write::{Output, write_indices, write_matrix, write_numbers};
use qless_io::{Manifest, ManifestError, WriteError, read_case, write_case};

fn labelled(label: &str) -> ConstraintSystem {
    let mut builder = SystemBuilder::new(2);
    builder.labelled_equation(label, [(0, 1.0), (1, -1.0)], 0.5);
    builder.build().expect("valid")
}

/// Entries of a folder, with the text of files.
fn content(folder: &Path) -> BTreeMap<String, Option<String>> {
    let entries = fs::read_dir(folder).expect("a folder").flatten();
    entries
        .map(|entry| (entry.file_name().to_string_lossy().into_owned(), fs::read_to_string(entry.path()).ok()))
        .collect()
}

/// Runs `write` in a folder filled by `prepare`; it must fail and change nothing.
fn assert_unchanged(prepare: impl Fn(&Path), write: impl Fn(&Path) -> Result<(), WriteError>) -> String {
    let place = tempfile::tempdir().expect("a temporary folder");
    prepare(place.path());
    let before = content(place.path());
    let error = write(place.path()).expect_err("cannot be written").to_string();
    assert_eq!(content(place.path()), before, "{error}");
    error
}

#[test]
fn a_file_where_a_folder_should_be() {
    let prepare = |place: &Path| fs::write(place.join("taken"), "mine").expect("written");
    for inner in ["taken", "taken/case", "taken/deep/case"] {
        let error = assert_unchanged(prepare, |place| write_case(&place.join(inner), &labelled("tie")));
        assert!(error.contains("taken: is not a folder"), "{error}");
    }
    assert_unchanged(prepare, |place| write_numbers(&place.join("taken/g.txt"), &[1.0]));
    assert_unchanged(prepare, |place| write_matrix(&place.join("taken/T.mtx"), &qless::Csr::empty(1)));
}

#[test]
fn a_folder_where_a_file_should_be() {
    let prepare = |place: &Path| {
        fs::create_dir(place.join("b.txt")).expect("created");
        fs::write(place.join("C.mtx"), "old").expect("written");
    };
    let error = assert_unchanged(prepare, |place| write_case(place, &labelled("tie")));
    assert!(error.contains("b.txt: is not a regular file"), "{error}");
    assert_unchanged(prepare, |place| write_indices(&place.join("b.txt"), &[0]));
    assert_unchanged(|_| (), |place| write_indices(&place.join(".."), &[0]));
}

#[test]
fn a_failure_half_way() {
    let failing = |place: &Path| {
        let mut output = Output::new(place)?;
        output.numbers("a.txt", &[1.0])?;
        output.file("b.txt", |out| {
            out.write_all(b"half")?;
            Err(io::ErrorKind::StorageFull.into())
        })
    };
    let prepare = |place: &Path| fs::write(place.join("a.txt"), "old").expect("written");
    let error = assert_unchanged(prepare, failing);
    assert!(error.contains("b.txt: cannot be written"), "{error}");
    assert_unchanged(prepare, |place| failing(&place.join("new/inner")));
}

#[test]
fn a_label_of_two_lines() {
    let error = assert_unchanged(|_| (), |place| write_case(&place.join("case"), &labelled("one\ntwo")));
    assert!(error.contains("rows.txt: label 1 (\"one\\ntwo\") has a line break"), "{error}");
}

#[test]
fn a_way_up_out_of_a_folder_that_does_not_exist() {
    assert_unchanged(|_| (), |place| write_case(&place.join("none/../case"), &labelled("tie")));
}

#[test]
fn success_leaves_only_the_files() {
    let place = tempfile::tempdir().expect("a temporary folder");
    let folder = place.path().join("deep/./case");
    write_case(&folder, &labelled("tie")).expect("written");
    let unlabelled = qless::ConstraintSystem::from_triplets(1, 2, &[(0, 0, 1.0)], &[0.0], &[]).expect("valid");
    write_case(&folder, &unlabelled).expect("written over");
    fs::write(folder.join("notes.md"), "kept").expect("written");
    write_indices(&folder.join("slaves.txt"), &[1]).expect("written");
    let names: Vec<String> = content(&folder).into_keys().collect();
    assert_eq!(names, ["C.mtx", "b.txt", "notes.md", "qless.json", "slaves.txt"]);
    assert_eq!(content(place.path()).into_keys().collect::<Vec<_>>(), ["deep"]);
}

/// A killed writer leaves a manifest that says so, and hidden files; the next one needs no help.
#[test]
fn an_interrupted_set_is_told_and_the_next_writer_completes_its_own() {
    let place = tempfile::tempdir().expect("a temporary folder");
    let folder = place.path();
    let write = |names: &[&str], number: f64| {
        let mut output = Output::new(folder).expect("a folder").by("a test");
        names.iter().for_each(|name| output.numbers(name, &[number]).expect("written"));
        output.commit().expect("in place");
    };
    write(&["a.txt", "b.txt", "only_first.txt", "changed.txt"], 1.0);
    fs::write(folder.join("changed.txt"), "mine").expect("written");
    fs::write(folder.join("foreign.txt"), "mine").expect("written");
    // The state after a kill between two renames.
    let first = Manifest::read(folder).expect("readable").expect("there");
    let text = fs::read_to_string(folder.join(Manifest::NAME)).expect("there");
    let mut killed: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    killed["replaces"] = killed["files"].clone();
    killed["files"] = serde_json::json!([{ "name": "b.txt", "size": 4, "crc32": 0 }]);
    killed["complete"] = false.into();
    fs::write(folder.join(Manifest::NAME), killed.to_string()).expect("written");
    assert!(matches!(Manifest::check(folder), Err(ManifestError::Incomplete { .. })));

    write(&["a.txt", "b.txt"], 2.0);
    let second = Manifest::check(folder).expect("whole");
    assert_eq!((first.files.len(), second.files.len()), (4, 2));
    let names: Vec<String> = content(folder).into_keys().collect();
    assert_eq!(names, ["a.txt", "b.txt", "changed.txt", "foreign.txt", "qless.json"]);
    assert!(matches!(second.file(folder, "foreign.txt"), Err(ManifestError::NotListed { .. })));
}

#[test]
fn a_manifest_of_somebody_else_is_not_replaced() {
    let prepare = |place: &Path| fs::write(place.join("qless.json"), "{\"mine\": 1}").expect("written");
    let error = assert_unchanged(prepare, |place| write_case(place, &labelled("tie")));
    assert!(error.contains("qless.json: it is no manifest of qless"), "{error}");
}

#[test]
fn an_incomplete_case_is_not_read() {
    let place = tempfile::tempdir().expect("a temporary folder");
    write_case(place.path(), &labelled("tie")).expect("written");
    fs::write(place.path().join("b.txt"), "0.75\n").expect("changed by hand");
    assert!(read_case(place.path(), None, None).is_ok());
    let manifest = place.path().join("qless.json");
    let text = fs::read_to_string(&manifest).expect("there").replace("\"complete\": true", "\"complete\": false");
    fs::write(&manifest, text).expect("written");
    let error = read_case(place.path(), None, None).expect_err("refused").to_string();
    assert!(error.contains("qless.json: writing this case was interrupted"), "{error}");
}

#[cfg(unix)]
#[test]
fn a_folder_without_write_permission() {
    use std::os::unix::fs::PermissionsExt;
    let place = tempfile::tempdir().expect("a temporary folder");
    let locked = place.path().join("locked");
    fs::create_dir(&locked).expect("created");
    fs::set_permissions(&locked, fs::Permissions::from_mode(0o555)).expect("locked");
    if fs::write(locked.join("probe"), "").is_ok() {
        println!("this user may write anywhere: nothing was tested");
        return;
    }
    for target in [locked.clone(), locked.join("inner/case")] {
        let error = write_case(&target, &labelled("tie")).expect_err("cannot be written");
        assert!(matches!(error, WriteError::Io { path, .. } if path == target));
        assert!(content(&locked).is_empty());
    }
}
