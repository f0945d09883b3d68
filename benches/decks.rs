//! Reading a deck of a million equations against counting its lines with a buffered reader: `cargo bench --bench decks`
//! (`-- --test` for a small one, `-- bdf` for one format).
//!
//! Both run in turns in one process. Target: at most 3 times the time, and at most 3 times the bytes of the file at any moment.

mod timing;

use std::fmt::Write as _;
use std::hint::black_box;
use std::io::{BufRead, BufReader};
use std::path::Path;

use peak_alloc::PeakAlloc;
use qless_io::deck;

use timing::{median, seconds};

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

const ROUNDS: usize = 11;

/// Makes the text of a deck with a number of equations.
type Text = fn(usize) -> String;

fn main() {
    let short = std::env::args().any(|argument| argument == "--test");
    let equations = if short { 20_000 } else { 1_000_000 };
    let place = tempfile::tempdir().expect("a folder");
    let decks: [(&str, &str, Text); 6] = [
        ("inp: one card", "one.inp", |m| calculix(m, false, false)),
        ("inp: a card each", "each.inp", |m| calculix(m, true, false)),
        ("inp: nodes too", "nodes.inp", |m| calculix(m, false, true)),
        ("inp: 3 terms", "terms.inp", three_terms),
        ("bdf: MPC", "mpc.bdf", nastran),
        ("cdb: CE", "ce.cdb", ansys),
    ];
    println!(
        "{:<18} {:>9} {:>8} {:>11} {:>10} {:>6} {:>11}",
        "deck", "equations", "MB", "counting ms", "reading ms", "ratio", "peak / file"
    );
    let wanted: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with('-')).collect();
    let is_wanted = |name: &str| wanted.is_empty() || wanted.iter().any(|word| name.contains(word.as_str()));
    for (name, file, text) in decks.into_iter().filter(|(name, ..)| is_wanted(name)) {
        let path = place.path().join(file);
        std::fs::write(&path, text(equations)).expect("written");
        measure(name, &path, equations);
    }
}

/// Two-term equations with one card for all or one for each, and the cards of the nodes.
fn calculix(equations: usize, a_card_each: bool, nodes: bool) -> String {
    let mut text = String::new();
    if nodes {
        text += "*NODE\n";
        (1..=2 * equations)
            .for_each(|node| writeln!(text, "{node}, {:.6}, 0.25, 1.5", node as f64 * 0.001).expect("text"));
    }
    text += if a_card_each { "" } else { "*EQUATION\n" };
    for i in 1..=equations {
        text += if a_card_each { "*EQUATION\n" } else { "" };
        writeln!(text, "2\n{},1,1.0,{},1,-1.0", i + equations, i).expect("text");
    }
    text + "*STEP\n*STATIC\n*END STEP\n"
}

/// `MPC` cards in small field, with the grid points that they need.
fn nastran(equations: usize) -> String {
    let mut text = String::from("SOL 101\nCEND\nMPC = 1\nBEGIN BULK\n");
    for node in 1..=2 * equations {
        writeln!(text, "GRID    {node:<8}        {:<8.3}0.5     1.5", (node % 1000) as f64 * 0.5).expect("text");
    }
    for i in 1..=equations {
        writeln!(text, "MPC     1       {:<8}1       1.0     {i:<8}1       -1.0", i + equations).expect("text");
    }
    text + "ENDDATA\n"
}

/// `CE` blocks as archives have them.
fn ansys(equations: usize) -> String {
    let mut text = String::from("/PREP7\n");
    for i in 1..=equations {
        let other = i + equations;
        writeln!(text, "CE,R5.0,DEFI,       2,{i:8},  0.00000000    ").expect("text");
        writeln!(text, "CE,R5.0,NODE,{other:8},UX  ,  1.00000000    ,{i:8},UX  , -1.00000000").expect("text");
    }
    text + "FINISH\n"
}

/// Periodicity: the three components of two nodes and of a dummy node.
fn three_terms(equations: usize) -> String {
    let mut text = String::from("*EQUATION\n");
    for i in 0..equations {
        let (node, image, component) = (i / 3 + 1, i / 3 + 1 + equations, 1 + i % 3);
        let third = -0.100_001 - 1e-6 * (i % 899_000) as f64;
        writeln!(text, "3\n{image}, {component}, 1.0, {node}, {component}, -1.0, 9999999, {component}, {third:.6}")
            .expect("text");
    }
    text + "*STEP\n*STATIC\n*END STEP\n"
}

fn measure(name: &str, path: &Path, equations: usize) {
    let bytes = std::fs::metadata(path).expect("a file").len() as f64;
    let (mut counting, mut reading, mut peak) = (Vec::new(), Vec::new(), 0);
    for _ in 0..ROUNDS {
        counting.push(seconds(|| {
            black_box(BufReader::new(std::fs::File::open(path).expect("a file")).lines().count());
        }));
        MEMORY.reset_peak_usage();
        let before = MEMORY.current_usage();
        reading.push(seconds(|| {
            let deck = deck::read(path).expect("a deck");
            assert_eq!(deck.model().equations(), equations);
            peak = MEMORY.peak_usage() - before;
        }));
    }
    // In a short deck fixed costs dominate, so it is not compared.
    let is_within = peak as f64 <= 3.0 * bytes || equations < 1_000_000;
    assert!(is_within, "{name}: peak memory is {:.2} times the file", peak as f64 / bytes);
    let (counting, reading) = (median(counting), median(reading));
    println!(
        "{name:<18} {equations:>9} {:>8.1} {:>11.1} {:>10.1} {:>6.2} {:>11.2}",
        bytes / 1e6,
        1e3 * counting,
        1e3 * reading,
        reading / counting,
        peak as f64 / bytes
    );
}
