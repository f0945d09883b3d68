//! Random files with and without faults: ranks and a single reader return the same system or the same error message.

use std::fmt::Write;
use std::path::Path;

use qless::ConstraintSystem;
use qless_scenes::Rng;

use super::{Case, read_case};
use crate::ranks::on_threads;

/// Number of random cases; each is read by 1 to 8 ranks.
const FILES: u64 = 150;

#[test]
fn ranks_read_what_one_reader_reads() {
    let place = tempfile::tempdir().expect("a folder");
    let (mut read, mut refused) = (0, 0);
    for seed in 0..FILES {
        let folder = place.path().join(seed.to_string());
        std::fs::create_dir(&folder).expect("a folder");
        let mut rng = Rng::new(seed);
        write_files(&folder, &mut rng);
        let serial = qless_io::read_case(&folder, None, None).map_err(|error| error.to_string());
        for size in 1..=8 {
            let of_ranks = on_threads(size, |ranks| read_case(ranks, &folder, None, None));
            let texts: Vec<_> = of_ranks.iter().map(|found| found.as_ref().err()).collect();
            assert!(texts.iter().all(|text| *text == texts[0]), "seed {seed}, {size} ranks: {texts:?}");
            match &serial {
                Ok(system) => is_the_same(system, &of_ranks.into_iter().map(Result::unwrap).collect::<Vec<_>>()),
                Err(text) => assert_eq!(Some(text), texts[0].map(ToString::to_string).as_ref(), "seed {seed}, {size}"),
            }
        }
        if serial.is_ok() { read += 1 } else { refused += 1 }
    }
    assert!(read > FILES / 5 && refused > FILES / 5, "{read} read, {refused} refused");
}

fn is_the_same(system: &ConstraintSystem, cases: &[Case]) {
    let mut row = 0;
    let mut prescribed = Vec::new();
    for case in cases {
        let of_whole = [case.rows(), case.dofs(), case.coefficients(), case.prescribed()].map(|n| n as usize);
        let expected = [system.equations(), system.dofs(), system.matrix().nnz(), system.prescribed().len()];
        assert_eq!(of_whole, expected);
        let (share, rows) = (&case.share, &case.share.rows);
        for i in 0..rows.len() {
            assert_eq!(rows.numbers[i] as usize, row);
            let bits = |(dof, value): (u64, f64)| (dof as usize, value.to_bits());
            let own: Vec<_> = rows.row(i).map(bits).collect();
            let theirs: Vec<_> = system.matrix().row(row).map(|(j, value)| (j, value.to_bits())).collect();
            assert_eq!((own, rows.rhs[i].to_bits()), (theirs, system.rhs()[row].to_bits()), "row {row}");
            row += 1;
        }
        prescribed.extend(share.prescribed.iter().map(|&(dof, value)| (dof as usize, value)));
        assert!(share.prescribed.iter().all(|(dof, _)| share.owned.contains(dof)));
    }
    assert_eq!((row, prescribed), (system.equations(), system.prescribed().to_vec()));
}

fn write_files(folder: &Path, rng: &mut Rng) {
    let (m, n) = (rng.below(12), 1 + rng.below(12));
    let mut lines: Vec<String> = entries(m, n, rng);
    let promised = lines.len() + usize::from(rng.below(20) == 0) - usize::from(rng.below(20) == 0 && !lines.is_empty());
    spoil(&mut lines, rng);
    let kind = ["real", "real", "real", "integer", "INTEGER"][rng.below(5)];
    let symmetry = ["general", "general", "general", "general", "general", "General", "symmetric"][rng.below(7)];
    let head = format!("%%MatrixMarket matrix coordinate {kind} {symmetry}");
    let sizes = if rng.below(25) == 0 { "1 2".into() } else { format!("{m} {n} {promised}") };
    lines.splice(0..0, [head, sizes]);
    save(&folder.join("C.mtx"), lines, true, rng);
    if rng.below(2) == 0 {
        let mut lines: Vec<String> = (0..m).map(|_| number(rng)).collect();
        spoil(&mut lines, rng);
        let has_head = rng.below(3) == 0;
        if has_head {
            lines.splice(0..0, ["%%MatrixMarket matrix array real general".into(), format!("{m} 1")]);
        }
        save(&folder.join("b.txt"), lines, has_head, rng);
    }
    if rng.below(2) == 0 {
        let mut lines: Vec<String> =
            (0..rng.below(5)).map(|_| format!("{} {}", 1 + rng.below(n), rng.below(2))).collect();
        spoil(&mut lines, rng);
        save(&folder.join("prescribed.txt"), lines, false, rng);
    }
    for (name, count) in [("rows.txt", m), ("cols.txt", n)] {
        if rng.below(3) == 0 {
            let mut text: String =
                (0..count).map(|k| if k % 3 == 1 { "\n".into() } else { format!("label {k}\n") }).collect();
            text.push_str(["", "", "\n \n", "one more\n"][rng.below(4)]);
            std::fs::write(folder.join(name), text).expect("written");
        }
    }
}

fn entries(m: usize, n: usize, rng: &mut Rng) -> Vec<String> {
    if m == 0 {
        return Vec::new();
    }
    let blanks = |rng: &mut Rng| [" ", "  ", "\t"][rng.below(3)];
    let count = rng.below(30);
    (0..count)
        .map(|_| {
            let (row, column) = (1 + rng.below(m), 1 + rng.below(n));
            format!("{}{row}{}{column} {}", ["", "", " "][rng.below(3)], blanks(rng), number(rng))
        })
        .collect()
}

fn number(rng: &mut Rng) -> String {
    const OTHERS: [&str; 6] = ["1.5D-3", "0", "-1e308", "1.7e308", "1.7976931348623157e308", ".1"];
    if rng.below(12) == 0 { OTHERS[rng.below(6)].into() } else { format!("{}", rng.below(9) as i64 - 4) }
}

/// Puts a fault into a random line of some files.
fn spoil(lines: &mut Vec<String>, rng: &mut Rng) {
    if lines.is_empty() || rng.below(4) > 0 {
        return;
    }
    let at = rng.below(lines.len());
    match rng.below(5) {
        0 => lines[at] = "0 1 2".into(),
        1 => lines[at] = "1 1 inf".into(),
        2 => lines[at] = "what?".into(),
        3 => lines.insert(at, "1 1 1".into()),
        _ => drop(lines.remove(at)),
    }
}

/// Writes a file with random comments, blank lines, line ends and long lines; the last line may lack its end.
fn save(path: &Path, lines: Vec<String>, keeps_first: bool, rng: &mut Rng) {
    let end = ["\n", "\r\n"][rng.below(2)];
    let mut text = String::from(["", "", "\u{feff}"][rng.below(3)]);
    for (k, line) in lines.into_iter().enumerate() {
        if k > 0 || !keeps_first {
            for _ in 0..rng.below(3) {
                let long = "long ".repeat(if rng.below(10) == 0 { 30_000 } else { 1 });
                let beside = ["", "  \t", "% x", "# 1 2 3", &format!("% {long}")][rng.below(5)].to_owned();
                write!(text, "{beside}{end}").expect("a string");
            }
        }
        let comment = if rng.below(8) == 0 && k > 0 { " % beside" } else { "" };
        write!(text, "{line}{comment}{end}").expect("a string");
    }
    if rng.below(2) == 0 {
        text.truncate(text.trim_end().len());
    }
    std::fs::write(path, text).expect("written");
}

#[test]
fn all_ranks_return_the_error_of_a_single_reader() {
    let place = tempfile::tempdir().expect("a folder");
    let none = place.path().join("none");
    let folder = place.path().join("folder");
    std::fs::create_dir_all(folder.join("C.mtx")).expect("a folder");
    let empty = place.path().join("empty.mtx");
    std::fs::write(&empty, "").expect("written");
    let deck = place.path().join("deck.inp");
    std::fs::write(&deck, "*NODE\n").expect("written");
    for path in [&none, &folder, &empty, &place.path().to_path_buf()] {
        let serial = qless_io::read_case(path, None, None).expect_err("no case").to_string();
        for size in [1, 3] {
            for error in on_threads(size, |ranks| read_case(ranks, path, None, None).map(drop)) {
                assert_eq!(error.expect_err("no case").to_string(), serial);
            }
        }
    }
    // Ranks read matrices only, so they report a deck as a matrix without its header.
    let refused = on_threads(3, |ranks| read_case(ranks, &deck, None, None).map(drop).unwrap_err());
    assert!(refused.iter().all(|error| error.to_string().contains("deck.inp:1: expected the header")), "{refused:?}");
    let device = on_threads(2, |ranks| read_case(ranks, Path::new("/dev/null"), None, None).map(drop).unwrap_err());
    assert!(device[1].to_string().contains("it has no size"), "{device:?}");
}
