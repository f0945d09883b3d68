//! Every kind of malformed input: messages name the file, the line, what was found and what to do.

use std::path::Path;

use qless_io::read_case;

const HEAD: &str = "%%MatrixMarket matrix coordinate real general\n";

/// The message of reading a folder with these files.
fn message(files: &[(&str, &str)]) -> String {
    let place = tempfile::tempdir().expect("a temporary folder");
    for (name, text) in files {
        std::fs::write(place.path().join(name), text).expect("written");
    }
    read_case(place.path(), None, None).expect_err("malformed").to_string()
}

fn assert_names(message: &str, parts: &[&str]) {
    for part in parts {
        assert!(message.contains(part), "no {part:?} in: {message}");
    }
}

#[test]
fn headers() {
    for (text, parts) in [
        ("", &["C.mtx: expected the header", "found nothing"][..]),
        ("1 1 1\n", &["C.mtx:1:", "found `1 1 1`", "make it the first line"]),
        ("% MatrixMarket matrix coordinate real general\n", &["C.mtx:1:", "expected the header"]),
        ("\n%%MatrixMarket matrix coordinate real\n", &["C.mtx:2:", "found `%%MatrixMarket matrix coordinate real`"]),
        ("\x1f\u{8b}\x08", &["C.mtx:1:", "expected the header", "\\u{1f}"]),
        ("%%MatrixMarket vector coordinate real general\n", &["C.mtx:1:", "`vector`: unknown"]),
        ("%%MatrixMarket matrix coordinate pattern general\n", &["`pattern`", "no coefficients", "write `real`"]),
        ("%%MatrixMarket matrix coordinate complex general\n", &["`complex`", "must be real"]),
        ("%%MatrixMarket matrix coordinate real hermitian\n", &["`hermitian`", "complex"]),
    ] {
        assert_names(&message(&[("C.mtx", text)]), parts);
    }
}

#[test]
fn symmetric_and_dense_matrices() {
    const MARKET: &str = "%%MatrixMarket matrix";
    for (text, parts) in [
        ("coordinate real symmetric\n2 3 1\n1 1 1\n", &["C.mtx:2:", "as many rows as columns", "2 and 3"][..]),
        ("coordinate real symmetric\n2 2 1\n1 2 1\n", &["C.mtx:3:", "row 1, column 2", "triangle", "`general`"]),
        ("coordinate real skew-symmetric\n2 2 1\n2 2 1\n", &["C.mtx:3:", "row 2, column 2", "below the diagonal"]),
        ("array real general\n2 2 4\n", &["C.mtx:2:", "`rows columns`", "found `2 2 4`"]),
        ("array real general\n2 2\n1\n1\n1\n", &["C.mtx:2:", "4 entries are promised", "ends after 3"]),
        ("array real symmetric\n2 2\n1\n1\n1\n1\n", &["C.mtx:6:", "one entry more than the 3"]),
        ("array real general\n2 1\n1 1 1\n", &["C.mtx:3:", "expected `value`"]),
        ("array real general\n2 1\n1\nnan\n", &["C.mtx:4:", "row 2, column 1"]),
        ("array real general\n4000000000 4000000000\n1\n", &["C.mtx:2:", "promised"]),
        ("array real general\n99999999999999999999 2\n1\n", &["C.mtx:2:", "`rows columns`"]),
    ] {
        assert_names(&message(&[("C.mtx", &format!("{MARKET} {text}"))]), parts);
    }
}

#[test]
fn sizes() {
    for (text, parts) in [
        ("", &["C.mtx:1:", "`rows columns entries`", "found nothing"][..]),
        ("2 2\n", &["C.mtx:2:", "found `2 2`"]),
        ("2 2 x\n", &["C.mtx:2:", "found `2 2 x`"]),
        ("2 -2 1\n", &["C.mtx:2:", "found `2 -2 1`"]),
        ("2.0 2 1\n", &["C.mtx:2:", "whole numbers", "found `2.0 2 1`"]),
        ("3 0 0\n", &["C.mtx:2:", "3 rows and no columns"]),
        ("4294967295 2 1\n", &["C.mtx:2:", "number of rows is `4294967295`", "at most 4294967294"]),
        ("2 99999999999999999999999 1\n", &["C.mtx:2:", "number of columns is `99999999999999999999999`"]),
        ("4294967294 2 1\n1 1 1\n", &["C.mtx:2:", "4294967294 rows for 1 entries", "correct the sizes"]),
        ("2 2 99999999999999999999999\n1 1 1\n", &["C.mtx:2:", "the file ends after 1"]),
        ("2 2 1000000000000\n1 1 1\n", &["C.mtx:2:", "1000000000000 entries are promised", "ends after 1"]),
    ] {
        assert_names(&message(&[("C.mtx", &format!("{HEAD}{text}"))]), parts);
    }
}

#[test]
fn entries() {
    for (text, parts) in [
        ("1 1\n", &["C.mtx:4:", "`row column value`", "found `1 1`"][..]),
        ("1 1 1 1\n", &["C.mtx:4:", "found `1 1 1 1`"]),
        ("-1 1 1\n", &["C.mtx:4:", "found `-1 1 1`"]),
        ("1.0 1 1\n", &["C.mtx:4:", "found `1.0 1 1`"]),
        ("0 1 1\n", &["C.mtx:4:", "row `0` is out of range", "2 rows, counted from 1"]),
        ("3 1 1\n", &["C.mtx:4:", "row `3` is out of range", "2 rows"]),
        ("1 0 1\n", &["C.mtx:4:", "column `0` is out of range", "3 columns"]),
        ("1 4 1\n", &["C.mtx:4:", "column `4` is out of range", "3 columns"]),
        ("1 18446744073709551617 1\n", &["C.mtx:4:", "column `18446744073709551617` is out of range"]),
        ("1 2 nan\n", &["C.mtx:4:", "coefficient in row 1, column 2 is `nan`", "must be finite"]),
        ("2 3 -Inf\n", &["C.mtx:4:", "coefficient in row 2, column 3 is `-Inf`", "must be finite"]),
        ("1 1 1e999\n", &["C.mtx:4:", "row 1, column 1 is `1e999`", "too large", "rescale"]),
        ("1 1 1e-999\n", &["C.mtx:4:", "row 1, column 1 is `1e-999`", "too small"]),
        ("1 1 1,5\n", &["C.mtx:4:", "row 1, column 1 is `1,5`", "not a number"]),
        ("1 1 1\n1 2 1\n2 3 1\n", &["C.mtx:6:", "more than the 2 promised"]),
        ("1 1 1\n% end\n", &["C.mtx:3:", "2 entries are promised", "ends after 1"]),
        ("1 1 1e308\n1 1 1e308\n", &["C.mtx:5:", "row 1, column 1 add up to inf", "in line 4"]),
    ] {
        assert_names(&message(&[("C.mtx", &format!("{HEAD}%\n2 3 2\n{text}"))]), parts);
    }
    let integer = "%%MatrixMarket matrix coordinate integer general\n1 1 1\n1 1 0.5\n";
    assert_names(&message(&[("C.mtx", integer)]), &["C.mtx:3:", "`0.5`", "not an integer"]);
}

#[test]
fn vectors() {
    let matrix = ("C.mtx", &*format!("{HEAD}2 3 1\n1 1 1\n"));
    for (name, text, parts) in [
        ("b.txt", "1\n", &["b.txt: found 1 numbers, expected 2", "each row"][..]),
        ("b.txt", "1\n2\n3\n", &["b.txt: found 3 numbers, expected 2"]),
        ("b.txt", "1 2\n", &["b.txt:1:", "`one number`", "found `1 2`"]),
        ("b.txt", "# b\n1\nnan\n", &["b.txt:3:", "right-hand side of row 2 is `nan`"]),
        ("b.txt", "1\nx\n", &["b.txt:2:", "row 2 is `x`: not a number"]),
        ("b.txt", "%%MatrixMarket matrix coordinate real general\n", &["b.txt:1:", "`coordinate`", "`array`"]),
        ("b.txt", "%%MatrixMarket matrix array real general\n", &["b.txt:1:", "`rows 1`", "found nothing"]),
        ("b.txt", "%%MatrixMarket matrix array real general\n2 2\n", &["b.txt:2:", "found `2 2`"]),
        ("b.txt", "%%MatrixMarket matrix array real general\n3 1\n", &["b.txt:2: found 3 numbers, expected 2"]),
        ("b.txt", "%%MatrixMarket matrix array integer general\n2 1\n1\n.5\n", &["b.txt:4:", "not an integer"]),
        ("prescribed.txt", "1\n", &["prescribed.txt:1:", "`column value`", "found `1`"]),
        ("prescribed.txt", "x 1\n", &["prescribed.txt:1:", "found `x 1`"]),
        ("prescribed.txt", "#\n0 1\n", &["prescribed.txt:2:", "column `0` is out of range"]),
        ("prescribed.txt", "4 1\n", &["prescribed.txt:1:", "column `4` is out of range", "3 columns"]),
        ("prescribed.txt", "2 inf\n", &["prescribed.txt:1:", "value of column 2 is `inf`", "finite"]),
        (
            "prescribed.txt",
            "2 1\n1 0\n2 3\n",
            &["prescribed.txt:3:", "column 2 is prescribed as 3", "line 1 prescribes 1"],
        ),
        ("rows.txt", "a\n", &["rows.txt: found 1 labels, expected 2", "each row"]),
        ("rows.txt", "a\nb\nc\n", &["rows.txt: found 3 labels, expected 2"]),
        ("cols.txt", "a\n", &["cols.txt: found 1 labels, expected 3", "each column"]),
    ] {
        assert_names(&message(&[matrix, (name, text)]), parts);
    }
}

#[test]
fn places() {
    let place = tempfile::tempdir().expect("a temporary folder");
    let refused = |path: &Path| read_case(path, None, None).expect_err("no case").to_string();
    assert_names(&refused(place.path()), &["holds no C.mtx"]);
    assert_names(&refused(&place.path().join("none.mtx")), &["none.mtx: cannot be read"]);
    for name in ["matrix", "matrix.csv", "deck.inp"] {
        std::fs::write(place.path().join(name), "").expect("written");
        assert_names(&refused(&place.path().join(name)), &[name, "cannot tell what this is"]);
    }
    let matrix = place.path().join("C.mtx");
    std::fs::write(&matrix, format!("{HEAD}1 1 0\n")).expect("written");
    let missing = place.path().join("gone.txt");
    let error = read_case(&matrix, Some(&missing), None).expect_err("no such file").to_string();
    assert_names(&error, &["gone.txt: cannot be read"]);
    let error = read_case(&matrix, None, Some(&missing)).expect_err("no such file").to_string();
    assert_names(&error, &["gone.txt: cannot be read"]);
    std::fs::create_dir(place.path().join("b.txt")).expect("created");
    assert_names(&refused(place.path()), &["b.txt: cannot be read"]);
}
