//! The files of `reduce` and `generate`, read back.

use std::fs;

use qless_io::Manifest;
use qless_io::matrix_market::{self, Triplets};

use super::harness::Place;

/// The files of a reduction; indices from 0.
struct Reduced {
    t: Triplets,
    g_matrix: Triplets,
    g: Vec<f64>,
    slaves: Vec<usize>,
    masters: Vec<usize>,
    prescribed: Vec<usize>,
}

impl Reduced {
    fn read(place: &Place, folder: &str) -> Self {
        Manifest::check(&place.path(folder)).expect("the files belong together");
        let path = |name: &str| place.path(folder).join(name);
        let text = |name: &str| fs::read_to_string(path(name)).unwrap_or_else(|error| panic!("{name}: {error}"));
        let indices = |name: &str| text(name).lines().map(|line| line.parse::<usize>().expect("whole") - 1).collect();
        Self {
            t: matrix_market::read(&path("T.mtx")).expect("T"),
            g_matrix: matrix_market::read(&path("G.mtx")).expect("G"),
            g: text("g.txt").lines().map(|line| line.parse().expect("a number")).collect(),
            slaves: indices("slaves.txt"),
            masters: indices("masters.txt"),
            prescribed: indices("prescribed.txt"),
        }
    }

    /// All DOFs, `u_s = T u_q + G u_p + g`; with `constant` 0 the homogeneous part `[T; I] u_q` and `G u_p`.
    fn expand(&self, u_q: &[f64], u_p: &[f64], constant: f64) -> Vec<f64> {
        let mut u = vec![0.0; self.slaves.len() + self.masters.len() + self.prescribed.len()];
        self.masters.iter().zip(u_q).for_each(|(&j, &v)| u[j] = v);
        self.prescribed.iter().zip(u_p).for_each(|(&j, &v)| u[j] = v);
        self.slaves.iter().zip(&self.g).for_each(|(&j, &v)| u[j] = constant * v);
        for (part, x) in [(&self.t, u_q), (&self.g_matrix, u_p)] {
            part.entries.iter().for_each(|&(i, j, v)| u[self.slaves[i]] += v * x[j]);
        }
        u
    }
}

/// `C u`.
fn times(c: &Triplets, u: &[f64]) -> Vec<f64> {
    let mut result = vec![0.0; c.rows];
    c.entries.iter().for_each(|&(i, j, v)| result[i] += v * u[j]);
    result
}

/// Several ties, one of them stated twice and one weighted, and two prescribed DOFs.
fn model(place: &Place) -> ([f64; 5], [f64; 2]) {
    let entries = [
        (1, 1, 1.0),
        (1, 2, -0.5),
        (1, 3, -0.5),
        (2, 2, 2.0),
        (2, 4, -2.0),
        (3, 3, 1.0),
        (3, 5, -1.0),
        (3, 6, 0.25),
        (4, 2, -4.0),
        (4, 4, 4.0),
        (5, 7, 3.0),
        (5, 8, -3.0),
        (5, 1, 1.0),
    ];
    let b = [0.25, 1.0, 0.0, -2.0, 0.125];
    place.case("model", [5, 9], &entries, &b, &[(6, 2.0), (8, -1.0)]);
    (b, [2.0, -1.0])
}

#[test]
fn the_files_of_reduce_solve_the_equations() {
    let place = Place::new();
    let (b, u_p) = model(&place);
    for options in ["", "--no-presolve", "--growth 1.5", "--backend gauss --no-presolve"] {
        let run = place.run(&format!("reduce model -o out --format json {options}"));
        assert_eq!(run.code, 0, "{}", run.err);
        let (c, reduced) = (matrix_market::read(&place.path("model/C.mtx")).expect("C"), Reduced::read(&place, "out"));
        assert_eq!((reduced.t.rows, reduced.t.columns), (reduced.slaves.len(), reduced.masters.len()));
        assert_eq!((reduced.slaves.len(), &reduced.prescribed[..]), (4, &[5, 7][..]));
        for k in 0..reduced.masters.len() {
            let mut unit = vec![0.0; reduced.masters.len()];
            unit[k] = 1.0;
            let u = reduced.expand(&unit, &[0.0; 2], 0.0);
            assert!(times(&c, &u).iter().all(|v| v.abs() < 1e-14), "C [T; I] = 0, {options}");
        }
        let u_q: Vec<f64> = (0..reduced.masters.len()).map(|k| 0.3 - k as f64).collect();
        let u = reduced.expand(&u_q, &u_p, 1.0);
        for (sum, b) in times(&c, &u).iter().zip(b) {
            assert!((sum - b).abs() < 1e-13, "C u = b, {options}: {sum} for {b}");
        }
        assert_report(&run.json(), &reduced);
    }
}

fn assert_report(report: &serde_json::Value, reduced: &Reduced) {
    let reduction = &report["reduction"];
    assert_eq!(reduction["slaves"], reduced.slaves.len());
    assert_eq!(reduction["masters"], reduced.masters.len());
    assert_eq!(reduction["nnz"], reduced.t.entries.len() + reduced.g_matrix.entries.len());
    let growth = reduced.t.entries.iter().fold(0.0, |most: f64, &(_, _, v)| most.max(v.abs()));
    assert_eq!(reduction["growth"].as_f64(), Some(growth));
    assert!(reduction["residual"].as_f64().expect("a number") < 1e-14);
    assert!(reduction["exchanges"].is_u64());
}

#[test]
fn conflicting_equations_are_not_reduced() {
    let place = Place::new();
    place.paper("model", 0.0);
    let before = place.everything();
    for format in ["text", "json"] {
        let run = place.run(&format!("reduce model -o new/out --format {format}"));
        assert_eq!(run.code, 1);
        assert!(run.out.contains("onflict"), "the report says why: {}", run.out);
        assert!(run.err.contains("nothing was written to new/out"), "{}", run.err);
        assert!(place.everything() == before);
    }
}

#[test]
fn reduce_replaces_its_own_files_and_no_others() {
    let place = Place::new();
    model(&place);
    place.file("out/T.mtx", "old").file("out/notes.txt", "mine");
    assert_eq!(place.run("reduce model -o out").code, 0);
    assert_eq!(Reduced::read(&place, "out").slaves.len(), 4);
    assert_eq!(fs::read_to_string(place.path("out/notes.txt")).expect("left"), "mine");
}

#[test]
fn a_generated_scene_has_what_its_name_promises() {
    let place = Place::new();
    let cases = [
        ("fssi --level 50 --seed 3", 7580, 168, 0),
        ("fssi --level 50 --coupling tie", 7580, 168, 0),
        ("figure-8", 16, 2, 0),
        ("equations --rhs 0", 3, 0, 1),
        ("gradient --nx 4 --ny 4 --d 2", 48, 16, 0),
        ("windows --nx 12 --ny 12", 82, 10, 0),
        ("mortar-surface --slave 9 8 --sums 7 --surface waves", 277, 7, 0),
        ("mortar-surface --equations 300 --slave-faces triangles --master-faces quads", 300, 0, 0),
        ("periodic-cell --near 4 --far 6", 9 * (25 + 12 + 4), 42, 0),
        ("linkage --bodies 100", 5 * (95 + 25), 75, 0),
        ("linkage --rows 2 --columns 5 --pitch 4", 5 * 14, 3, 0),
    ];
    for (scene, rows, redundant, conflicting) in cases {
        let run = place.run(&format!("generate {scene} -o scene"));
        assert_eq!(run.code, 0, "{scene}: {}", run.err);
        assert!(run.out.starts_with(&format!("Wrote scene: {rows} equations")), "{}", run.out);
        let report = place.run("check scene --format json").json();
        assert_eq!(report["input"]["rows"], rows, "{scene}");
        let counts = &report["counts"];
        assert_eq!((&counts["redundant"], &counts["conflicting"]), (&redundant.into(), &conflicting.into()), "{scene}");
    }
}

#[test]
fn the_same_seed_gives_the_same_files() {
    let place = Place::new();
    for (seed, folder) in [(1, "a"), (1, "b"), (2, "c")] {
        assert_eq!(place.run(&format!("generate planted --rows 40 --dofs 80 --seed {seed} -o {folder}")).code, 0);
    }
    let matrix = |folder: &str| fs::read(place.path(folder).join("C.mtx")).expect("written");
    assert!(matrix("a") == matrix("b") && matrix("a") != matrix("c"));
}

#[test]
fn a_short_bench_writes_its_page_table_and_plots() {
    let place = Place::new();
    let run = place.run("bench --short -q --runs 1 --limit 0.5 -o trade");
    assert_eq!(run.code, 0, "{}", run.err);
    assert!(run.out.contains("tie 50 %: 7580 equations of rank 7412"), "{}", run.out);
    let text = |name: &str| fs::read_to_string(place.path("trade").join(name)).expect(name);
    let csv = text("trade.csv");
    let head: Vec<&str> = csv.lines().next().expect("a head").split(',').collect();
    for column in ["peak_bytes", "false_drops", "false_keeps", "error", "times_first"] {
        assert!(head.contains(&column), "{head:?}");
    }
    let default: Vec<String> = csv.lines().filter(|line| line.contains(",checked,")).map(String::from).collect();
    assert!(default.len() >= 9 && default.iter().all(|line| line.contains(",right,")), "{default:?}");
    assert!(text("trade.md").contains("![Certainty against time](trade.svg)"));
    for effort in ["checked", "proved", "exact"] {
        assert!(text("trade.md").contains(&format!("| {effort} | 0 |")), "never wrong without a word");
    }
    assert!(text("trade.md").contains("![Times of the bare factorizations](figure-15.svg)"));
    assert!(text("figure-15.csv").contains("tie,50 %,7580,7412,305,Gauss,C,"));
    assert!(text("figure-15.svg").contains("Gauss, C^T"));
    for plot in ["trade.svg", "growth.svg"] {
        assert!(text(plot).starts_with("<svg") && text(plot).contains("checked"), "{plot}");
    }
}

/// A process of its own measures memory; the lines of the table are those of the CSV file.
#[test]
fn a_bench_of_chosen_methods_compares_with_the_first_and_counts_memory() {
    let place = Place::new();
    let mut command = place.command("bench --short -q --runs 1 --memory -o trade");
    command.args(["--family", "planted", "--method", "checked", "--method", "proved"]);
    let output = command.output().expect("the program starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let csv = fs::read_to_string(place.path("trade/trade.csv")).expect("written");
    let lines: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(lines.len(), 3, "{csv}");
    let at = |name: &str| lines[0].iter().position(|head| *head == name).expect(name);
    for (line, method) in lines[1..].iter().zip(["checked", "proved"]) {
        assert_eq!((line[at("family")], line[at("method")], line[at("verdict")]), ("planted", method, "right"));
        assert_eq!((line[at("rank")], line[at("false_drops")], line[at("false_keeps")]), ("200", "0", "0"));
        let number = |name: &str| line[at(name)].parse::<f64>().expect(name);
        assert!(number("error") < 1e-12, "{line:?}");
        // Memory for 220 equations of up to 5 terms and their factors.
        assert!(!cfg!(target_os = "linux") || number("peak_bytes") < 2e8, "{line:?}");
    }
    assert_eq!(lines[1][at("times_first")], "1.000");
}

/// A factorization that takes seconds cannot be interrupted; it ends with its process.
#[cfg(feature = "peers")]
#[test]
fn other_libraries_are_stopped_at_the_limit() {
    let place = Place::new();
    let mut command = place.command("bench --short -q --runs 1 --family ring --limit 0.01 -o trade");
    command.args(["--method", "checked", "--method", "Eigen SparseQR", "--method", "LAPACK dgeqp3"]);
    let output = command.output().expect("the program starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let csv = fs::read_to_string(place.path("trade/trade.csv")).expect("written");
    for method in ["Eigen SparseQR", "LAPACK dgeqp3"] {
        let line = csv.lines().find(|line| line.contains(method)).expect(method);
        assert!(line.contains(",999,given up,"), "{line}");
    }
    let run = place.run("bench --short -q --runs 1 --family planted --limit 30 -o found");
    assert_eq!(run.code, 0, "{}", run.err);
    let csv = fs::read_to_string(place.path("found/trade.csv")).expect("written");
    for method in ["Eigen SparseQR", "LAPACK dgeqp3"] {
        let line = csv.lines().find(|line| line.contains(&format!(",{method},"))).expect(method);
        assert!(line.contains(",200,200,right,0,0,"), "{line}");
    }
}
