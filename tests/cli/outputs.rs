//! The files that an output may replace, and the attributes that it keeps.

use std::fs;
use std::os::unix::fs::{MetadataExt, PermissionsExt, symlink};

use super::harness::Place;

/// Two equal equations; the first is in an included file.
fn deck(place: &Place) {
    place
        .file("deck.inp", "*NODE\n1,0.,0.,0.\n2,1.,0.,0.\n*INCLUDE,INPUT=ties.inp\n*EQUATION\n2\n1,1,2.,2,1,-2.\n")
        .file("ties.inp", "*EQUATION\n2\n1,1,1.,2,1,-1.\n");
}

#[test]
fn no_output_replaces_an_input() {
    let place = Place::new();
    deck(&place);
    place.paper("case", 1.0).file("lone.mtx", fs::read(place.path("case/C.mtx")).expect("there"));
    place.file("b", "1\n0\n1\n").file("p", "1 0\n").file("out/readme", "");
    fs::hard_link(place.path("lone.mtx"), place.path("same.mtx")).expect("linked");
    symlink("../lone.mtx", place.path("out/T.mtx")).expect("linked");
    symlink("b", place.path("link")).expect("linked");
    let before = place.everything();
    for arguments in [
        "check deck.inp -o deck.inp",
        "check deck.inp -o ties.inp",
        "check deck.inp --format vtu -o deck.inp",
        "clean deck.inp -o ties.inp",
        "check case -o case/C.mtx",
        "check case -o case/b.txt",
        // The file does not exist yet, but would become part of the case.
        "check case -o case/rows.txt",
        "check case --rhs b -o b",
        "check lone.mtx -o same.mtx",
        "check lone.mtx -o ./out/../lone.mtx",
        "check lone.mtx --rhs b --format json -o link",
        "check lone.mtx --prescribed p -o p",
        "reduce lone.mtx -o out",
        "reduce case --rhs b -o case",
    ] {
        let run = place.run(arguments);
        assert_eq!(run.code, 2, "`{arguments}`: {}{}", run.out, run.err);
        assert!(run.err.contains("would be overwritten; name another"), "`{arguments}`: {}", run.err);
        assert!(place.everything() == before, "`{arguments}` changed something");
    }
    assert_eq!(place.run("check case -o case/report.txt").code, 0);
}

/// Mode, owner and group are kept, and links are followed.
#[test]
fn a_deck_that_is_cleaned_in_place_stays_what_it_was() {
    let place = Place::new();
    deck(&place);
    let path = place.path("deck.inp");
    fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).expect("set");
    // Only root may give a file away.
    let _ = std::os::unix::fs::chown(&path, Some(4321), Some(4321));
    let owner = |path| fs::metadata(path).map(|file| (file.uid(), file.gid(), file.mode() & 0o7777)).expect("there");
    let before = owner(&path);
    fs::create_dir(place.path("links")).expect("created");
    symlink("../deck.inp", place.path("links/near.inp")).expect("linked");
    symlink("links/near.inp", place.path("far.inp")).expect("linked");
    let run = place.run("clean far.inp -o far.inp");
    assert_eq!(run.code, 0, "{}", run.err);
    assert!(place.path("far.inp").is_symlink() && place.path("links/near.inp").is_symlink());
    assert!(fs::read_to_string(&path).expect("a deck").contains("** qless"));
    assert_eq!(owner(&path), before);

    // A link whose target does not exist yet.
    symlink("new.inp", place.path("empty.inp")).expect("linked");
    assert_eq!(place.run("clean far.inp -o empty.inp").code, 0);
    assert!(place.path("empty.inp").is_symlink() && place.path("new.inp").is_file());
}

/// A new file would leave the old text under the other names, and overwriting in place could leave an incomplete file.
#[test]
fn a_file_with_several_names_is_refused() {
    let place = Place::new();
    deck(&place);
    fs::hard_link(place.path("deck.inp"), place.path("other.inp")).expect("linked");
    let before = place.everything();
    let run = place.run("clean deck.inp -o deck.inp");
    assert_eq!(run.code, 2, "{}", run.err);
    assert!(run.err.contains("has 2 names (hard links)") && run.err.contains("name another place"), "{}", run.err);
    assert!(place.everything() == before);
}

/// The folder and its other files do not change.
#[test]
fn a_set_of_files_changes_nothing_else_in_its_folder() {
    let place = Place::new();
    place.paper("case", 1.0).file("out/notes", "mine").file("out/deep/er/notes", "mine too");
    place.file("out/T.mtx", "old").file("out/block1_L.mtx", "of nobody known");
    symlink("notes", place.path("out/link")).expect("linked");
    let out = place.path("out");
    fs::set_permissions(out.join("T.mtx"), fs::Permissions::from_mode(0o600)).expect("set");
    fs::set_permissions(&out, fs::Permissions::from_mode(0o750)).expect("set");
    let number = |name: &str| fs::symlink_metadata(out.join(name)).map(|file| (file.ino(), file.nlink(), file.mode()));
    let numbers = || ["", "notes", "deep", "deep/er", "link"].map(|name| number(name).expect("there"));
    let before = numbers();
    let elsewhere = fs::canonicalize(&out).expect("there");
    let run = place.command("reduce ../case -o .").current_dir(&elsewhere).output().expect("it starts");
    assert_eq!(run.status.code(), Some(0), "{run:?}");
    assert_eq!(numbers(), before);
    assert_eq!(number("T.mtx").expect("written").2 & 0o7777, 0o600);
    assert!(fs::read_to_string(out.join("T.mtx")).expect("written").starts_with("%%MatrixMarket"));
    assert!(out.join("block1_L.mtx").exists());
    let manifest = qless_io::Manifest::check(&out).expect("a whole set");
    assert_eq!(manifest.command, "qless reduce ../case -o .");
    assert!(place.everything().iter().all(|(path, _)| !path.to_string_lossy().contains(".qless-")));
}

/// A missing folder is an error, and `-` is not a file name.
#[test]
fn a_deck_goes_into_a_folder_that_is_there() {
    let place = Place::new();
    deck(&place);
    let before = place.everything();
    for (command, code, words) in [
        ("clean deck.inp -o nowhere/x.inp", 3, "there is no such folder; make it first"),
        ("check deck.inp -o nowhere/x.txt", 3, "there is no such folder; make it first"),
        ("clean deck.inp -o -", 2, "a deck is not written to standard output; name a file"),
        ("check deck.inp -o -", 2, "the report is then written to standard output"),
    ] {
        let run = place.run(command);
        assert_eq!((run.code, run.out.as_str()), (code, ""), "{command}: {}", run.err);
        assert!(run.err.contains(words), "{command}: {}", run.err);
    }
    assert!(place.everything() == before);
}
