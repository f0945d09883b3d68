//! Wrong input is refused with an exit code and a message with place and reason, and nothing is
//! written.

use std::process::Stdio;

use super::harness::{HEADER, Place};

/// Arguments, the exit code, and what the message must hold.
type Refused = (&'static str, i32, &'static [&'static str]);

const USAGE: &[Refused] = &[
    ("", 2, &["Usage: qless"]),
    ("chek case", 2, &["chek"]),
    ("check", 2, &["<INPUT>"]),
    ("check case --colour", 2, &["--colour"]),
    ("check case --tolerance 2", 2, &["--tolerance", "is 2", "between 0 and 1"]),
    ("check case --tolerance 0", 2, &["is 0", "between 0 and 1"]),
    ("check case --tolerance nan", 2, &["NaN", "between 0 and 1"]),
    ("check case --tolerance small", 2, &["small", "not a number"]),
    ("check case --tolerance 1e-6 --paper-tolerance", 2, &["--tolerance", "--paper-tolerance"]),
    ("check case --backend lapack", 2, &["lapack", "faer", "gauss"]),
    ("check case --threads 0", 2, &["--threads", "at least 1"]),
    ("check case --format xml", 2, &["xml", "json"]),
    ("check case --deny all", 2, &["all", "redundant"]),
    ("check case --effort maybe", 2, &["--effort", "maybe", "quick", "proved"]),
    ("check case --numbers maybe", 2, &["--numbers", "maybe", "stored"]),
    ("reduce case", 2, &["--output"]),
    ("reduce case -o out --growth 0.5", 2, &["--growth", "0.5", "at least 1"]),
    ("reduce case -o case", 2, &["case", "C.mtx", "overwritten", "another folder"]),
    ("reduce lone.mtx --prescribed out/prescribed.txt -o out", 2, &["out", "prescribed.txt", "part of the input"]),
    ("reduce lone.mtx --prescribed out/qless.json -o out", 2, &["out", "qless.json", "part of the input"]),
    ("reduce case -o out --form sparse", 2, &["sparse", "--form", "explicit", "factored", "auto"]),
    ("reduce case -o file", 3, &["file", "not a folder", "another place"]),
    ("reduce case -o file/below", 3, &["file", "not a folder"]),
    ("generate", 2, &["Usage: qless generate"]),
    ("generate nothing -o out", 2, &["nothing"]),
    ("generate fssi", 2, &["-o <DIR>"]),
    ("generate fssi --level 55 -o out", 2, &["55", "50, 60"]),
    ("generate cycle --nodes 2 -o out", 2, &["nodes is 2", "from 3"]),
    ("generate cycle --gap inf -o out", 2, &["inf", "finite"]),
    ("generate figure-8 -o file", 3, &["file", "not a folder"]),
];

const INPUT: &[Refused] = &[
    ("check missing.mtx", 2, &["missing.mtx", "No such file", "check the name"]),
    ("check empty", 2, &["empty", "no C.mtx"]),
    ("check model.xyz", 2, &["model.xyz", ".inp", ".mtx"]),
    ("check header.mtx", 2, &["header.mtx:1:", "`not a header`", "first line"]),
    ("check lone.mtx --rhs short.txt", 2, &["short.txt", "found 1 numbers, expected 2"]),
    ("check lone.mtx --rhs nan.txt", 2, &["nan.txt:2:", "row 2", "`nan`", "finite"]),
    ("check lone.mtx --rhs missing.txt", 2, &["missing.txt", "No such file"]),
    ("check lone.mtx --rhs empty", 2, &["empty", "name a file"]),
    ("check lone.mtx --prescribed twice.txt", 2, &["twice.txt:3:", "column 1", "as 2", "line 1 prescribes 0"]),
    ("check lone.mtx --prescribed range.txt", 2, &["range.txt:1:", "`9`", "3 columns"]),
    ("check coefficient.mtx", 2, &["coefficient.mtx:4:", "row 1, column 2", "`inf`"]),
    ("check index.mtx", 2, &["index.mtx:3:", "row `4`", "2 rows"]),
    ("check few.mtx", 2, &["few.mtx", "3 entries are promised", "after 1"]),
    ("check overflow --no-presolve", 2, &["overflow", "row 2", "rescale"]),
    ("check lone.mtx --rhs huge.txt --prescribed first.txt", 0, &[]),
    ("check value", 2, &["value", "column 1", "1e308", "rescale"]),
];

fn place() -> Place {
    let place = Place::new();
    let lone = format!("{HEADER}2 3 4\n1 1 1\n1 2 -1\n2 2 1\n2 3 -1\n");
    place
        .paper("case", 1.0)
        .file("lone.mtx", &lone)
        .file("out/prescribed.txt", "1 0\n")
        .file("out/qless.json", "1 0\n")
        .file("file", "in the way")
        .file("empty/readme", "")
        .file("model.xyz", "")
        .file("header.mtx", "not a header\n")
        .file("short.txt", "1\n")
        .file("nan.txt", "1\nnan\n")
        .file("huge.txt", "1e300\n-1e300\n")
        .file("first.txt", "1 0\n")
        .file("twice.txt", "1 0\n2 5\n1 2\n")
        .file("range.txt", "9 0\n")
        .file("coefficient.mtx", format!("{HEADER}1 2 2\n1 1 1\n1 2 inf\n"))
        .file("index.mtx", format!("{HEADER}2 2 1\n4 1 1\n"))
        .file("few.mtx", format!("{HEADER}2 2 3\n1 1 1\n"))
        .case("overflow", [2, 2], &[(1, 1, 1.0), (2, 1, 1e-200), (2, 2, 1e-200)], &[0.0, 1e200], &[])
        .case("value", [1, 1], &[(1, 1, 1e-200)], &[1e200], &[]);
    place
}

fn check(table: &[Refused]) {
    let place = place();
    let before = place.everything();
    for &(arguments, code, parts) in table {
        let run = place.run(arguments);
        assert_eq!(run.code, code, "`{arguments}`: {}{}", run.out, run.err);
        for part in parts {
            assert!(run.err.contains(part), "`{arguments}` does not say `{part}`: {}", run.err);
        }
        assert!(code == 0 || run.out.is_empty(), "`{arguments}` prints a report: {}", run.out);
        assert!(place.everything() == before, "`{arguments}` left something behind");
    }
}

#[test]
fn bad_usage_is_refused() {
    check(USAGE);
}

#[test]
fn bad_input_is_named_by_file_line_and_value() {
    check(INPUT);
}

#[cfg(not(feature = "spqr"))]
#[test]
fn a_backend_that_is_not_there_is_said_before_the_input_is_read() {
    let run = place().run("check missing.mtx --backend spqr");
    assert_eq!(run.code, 2);
    assert!(run.err.contains("no backend spqr") && run.err.contains("--features spqr"), "{}", run.err);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_an_error_and_a_closed_pipe_is_not_a_word() {
    let place = place();
    let full = std::fs::File::options().write(true).open("/dev/full").expect("a full device");
    let output = place.command("check case").stdout(full).output().expect("it starts");
    assert_eq!(output.status.code(), Some(3));
    assert!(String::from_utf8_lossy(&output.stderr).contains("No space left"), "{output:?}");

    // If the reader closes the pipe, as `head -1` does, the exit code is still that of the verdict.
    let denied = "error: found what --deny names: 1 redundant equation\n";
    for (arguments, code, error) in
        [("check case", 0, ""), ("check case --format html", 0, ""), ("check case --deny redundant", 1, denied)]
    {
        let (reader, writer) = std::io::pipe().expect("a pipe");
        drop(reader);
        let run = place.command(arguments).stdout(writer).stderr(Stdio::piped()).output().expect("it starts");
        let found = String::from_utf8_lossy(&run.stderr);
        assert_eq!((run.status.code(), found.as_ref()), (Some(code), error), "{arguments}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_folder_that_cannot_be_written_to_is_a_resource_failure() {
    let place = place();
    let before = place.everything();
    for command in ["reduce case -o /proc/qless", "generate figure-8 -o /proc/qless"] {
        let run = place.run(command);
        assert_eq!(run.code, 3, "{}", run.err);
        assert!(run.err.contains("/proc/qless") && run.err.contains("nothing was written"), "{}", run.err);
    }
    assert!(place.everything() == before);
}

/// Names of cards, sets, includes, labels and files, in every report and message.
#[test]
fn no_name_moves_the_cursor_or_turns_the_text() {
    let place = Place::new();
    let bad = "\u{1b}]0;x\u{7}\u{1b}[31m\u{9b}2J\u{202e}\u{2066}";
    let nodes = "*NODE\n1,0.,0.,0.\n2,1.,0.,0.\n3,0.,1.,0.\n";
    let tie = "*EQUATION\n2\n1,1,1.,2,1,-1.\n2\n1,1,1.,2,1,-1.\n";
    let names = [
        ("cards", format!("{nodes}*NOSUCH{bad}CARD\n1\n*MPC\nFOO{bad},1,2\n{tie}")),
        ("set", format!("{nodes}*BOUNDARY\nSET{bad},1\n{tie}")),
        ("include", format!("{nodes}*INCLUDE,INPUT=part{bad}.inc\n{tie}")),
        ("elset", format!("{nodes}*NSET,NSET=A{bad}\n1,2\n*RIGID BODY,NSET=A{bad},REF NODE=3\n{tie}{tie}")),
        ("amplitude", format!("{nodes}*BOUNDARY,AMPLITUDE=A{bad}\n1,1,1,.1\n{tie}")),
    ];
    for (name, text) in &names {
        place.file(&format!("{name}.inp"), text);
        place.file(&format!("{name}{bad}.inp"), text);
    }
    place.file("case/C.mtx", "%%MatrixMarket matrix coordinate real general\n2 2 4\n1 1 1\n1 2 -1\n2 1 1\n2 2 -1\n");
    place.file("case/rows.txt", format!("row{bad}\nother{bad}\n")).file("case/cols.txt", format!("a{bad}\nb{bad}\n"));
    let decks = names.iter().flat_map(|(name, _)| [format!("{name}.inp"), format!("{name}{bad}.inp")]);
    for input in decks.chain(["case".into(), format!("missing{bad}.inp")]) {
        for command in [
            format!("check {input}"),
            format!("check {input} --format json"),
            format!("check {input} --format html"),
            format!("reduce {input} -o out{bad}"),
            format!("clean {input} -o clean{bad}.inp"),
            format!("check {input} --keep {bad}"),
        ] {
            let run = place.run(&command);
            let is_harmful = |c: char| c.is_control() && c != '\n' || ('\u{202a}'..='\u{2069}').contains(&c);
            for text in [&run.out, &run.err] {
                let found = text.find(is_harmful).map(|at| text[at..].chars().take(20).collect::<String>());
                assert!(found.is_none(), "{command:?}: {found:?}");
            }
        }
    }
    let run = place.run("check case --format json");
    assert!(run.out.contains("\\u001b") && run.out.contains("\\u202e"), "JSON has the names as they are: {}", run.out);
}

#[test]
fn a_device_is_written_to() {
    let place = Place::new();
    place.paper("case", 1.0);
    assert_eq!(place.run("check case -o /dev/null").code, place.run("check case").code);
    assert!(std::path::Path::new("/dev/null").metadata().is_ok_and(|null| !null.is_file()));
}
