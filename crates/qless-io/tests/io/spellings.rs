//! Accepts the spellings of different programs.

use qless_io::read_case;

#[test]
fn comments_line_ends_tabs_and_fortran_exponents() {
    let place = tempfile::tempdir().expect("a temporary folder");
    let write = |name: &str, text: &str| std::fs::write(place.path().join(name), text).expect("written");
    write(
        "C.mtx",
        "\u{feff}%matrixmarket MATRIX Coordinate Integer GENERAL\r\n% by hand\r\n\r\n 2\t3  4 \r\n1\t1\t1\r\n\r\n\
         1 3 -1.0D+3 % inline\r\n2 2 +5E0\r\n% between\r\n2 2 1.\r\n% the end\r\n\r\n",
    );
    write("b.txt", "%%MatrixMarket matrix array real general\n% b\n2 1\n1.5d0\n# two\n-2");
    write("prescribed.txt", "# column value\n\n3 0.5 # fixed\n3 0.50\n");
    write("rows.txt", "# one\r\n\r\n\r\n");
    write("cols.txt", "7:1\n7:2\n7:3");
    let system = read_case(place.path(), None, None).expect("read");
    let rows: Vec<Vec<_>> = (0..2).map(|row| system.matrix().row(row).collect()).collect();
    assert_eq!(rows, [vec![(0, 1.0), (2, -1000.0)], vec![(1, 6.0)]]);
    assert_eq!((system.rhs(), system.prescribed()), (&[1.5, -2.0][..], &[(2, 0.5)][..]));
    assert_eq!((system.equation_label(0), system.equation_label(1)), ("# one".into(), "row 2".into()));
    assert_eq!(system.dof_label(2), "7:3");
}

/// SciPy writes a symmetric matrix as its lower triangle, and a dense one as an array, column after column.
#[test]
fn symmetric_and_dense_matrices_are_those_written_out() {
    let place = tempfile::tempdir().expect("a temporary folder");
    let path = place.path().join("C.mtx");
    let rows = |head: &str| {
        std::fs::write(&path, format!("%%MatrixMarket matrix {head}")).expect("written");
        let system = read_case(&path, None, None).expect(head);
        (0..system.matrix().rows()).map(|row| system.matrix().row(row).collect()).collect::<Vec<Vec<_>>>()
    };
    let general = rows("coordinate real general\n2 2 4\n1 1 1\n1 2 -3\n2 1 -3\n2 2 2\n");
    assert_eq!(rows("coordinate real symmetric\n%\n2 2 3\n1 1 1\n2 1 -3\n2 2 2\n"), general);
    assert_eq!(rows("array real symmetric\n2 2\n1\n-3\n2\n"), general);
    assert_eq!(rows("array integer general\n2 2\n1\n-3\n-3\n2\n"), general);
    let skew = rows("coordinate real general\n3 3 4\n1 2 -4\n2 1 4\n2 3 -5\n3 2 5\n");
    assert_eq!(rows("coordinate real skew-symmetric\n3 3 2\n2 1 4\n3 2 5\n"), skew);
    assert_eq!(rows("array real skew-symmetric\n3 3\n4\n0\n5\n"), skew);
    let wide = rows("coordinate real general\n2 3 4\n1 1 1\n1 2 -1\n2 2 1\n2 3 -1\n");
    assert_eq!(rows("array real general\n%\n2 3\n1\n0\n-1\n1\n0\n-1\n"), wide);
}

#[test]
fn files_named_explicitly_replace_those_of_the_folder() {
    let place = tempfile::tempdir().expect("a temporary folder");
    let file = |name: &str, text: &str| {
        let path = place.path().join(name);
        std::fs::write(&path, text).expect("written");
        path
    };
    let matrix = file("C.mtx", "%%MatrixMarket matrix coordinate real general\n1 1 1\n1 1 1\n");
    file("b.txt", "1");
    file("prescribed.txt", "1 1");
    let (b, prescribed) = (file("b2", "2"), file("p2", "1 2"));
    let folder = read_case(place.path(), Some(&b), Some(&prescribed)).expect("read");
    assert_eq!((folder.rhs(), folder.prescribed()), (&[2.0][..], &[(0, 2.0)][..]));
    let lone = read_case(&matrix, None, None).expect("read");
    assert_eq!((lone.rhs(), lone.prescribed()), (&[0.0][..], &[][..]));
}
