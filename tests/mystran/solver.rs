//! Runs MYSTRAN, and reads what it prints.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

use qless_io::deck::Dof;

/// The solver in the folder of `scripts/mystran`, if it is installed.
pub fn program() -> Option<PathBuf> {
    let program = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/mystran/mystran");
    if program.exists() {
        return Some(program);
    }
    assert!(std::env::var_os("QLESS_MYSTRAN").is_none(), "run scripts/mystran");
    eprintln!("SKIPPED: MYSTRAN is not there; scripts/mystran fetches it");
    None
}

/// A run of MYSTRAN: whether it completes (its exit code does not tell), and what it prints.
pub struct SolverRun {
    pub completes: bool,
    printed: String,
}

impl SolverRun {
    pub fn of(program: &Path, text: &[u8]) -> Self {
        let place = tempfile::tempdir().expect("a folder");
        std::fs::write(place.path().join("deck.bdf"), text).expect("written");
        let run = Command::new(program).arg("deck.bdf").current_dir(place.path()).output().expect("MYSTRAN runs");
        let printed = std::fs::read(place.path().join("deck.F06")).unwrap_or_default();
        Self {
            completes: String::from_utf8_lossy(&run.stdout).contains("terminated normally"),
            printed: String::from_utf8_lossy(&printed).into_owned(),
        }
    }

    /// The numbers of its errors, in their order.
    pub fn errors(&self) -> Vec<u32> {
        let after = self.printed.split("*ERROR").skip(1);
        after.filter_map(|text| text.split(':').next()?.trim().parse().ok()).collect()
    }

    /// The displacements, along the axes of each grid point.
    pub fn displacements(&self) -> BTreeMap<Dof, f64> {
        self.table("D I S P L A C E M E N T S")
    }

    /// The forces by which single-point and multipoint constraints act on each component.
    pub fn reactions(&self) -> BTreeMap<Dof, f64> {
        let mut sum = self.table("S P C   F O R C E S");
        for (dof, force) in self.table("M P C   F O R C E S") {
            *sum.entry(dof).or_insert(0.0) += force;
        }
        sum
    }

    /// A table of six components for each grid point. Lines without eight numbers are headings.
    fn table(&self, title: &str) -> BTreeMap<Dof, f64> {
        let Some((_, after)) = self.printed.split_once(title) else { return BTreeMap::new() };
        let lines = after.lines().skip(1).take_while(|line| !line.contains("----") && !line.contains("OUTPUT FOR"));
        lines.filter_map(row).flatten().collect()
    }
}

fn row(line: &str) -> Option<[(Dof, f64); 6]> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let node = words.first()?.parse().ok()?;
    let values: Vec<f64> = words.get(2..8)?.iter().map(|word| word.parse()).collect::<Result<_, _>>().ok()?;
    Some(std::array::from_fn(|k| (Dof { node, component: k as u8 + 1 }, values[k])))
}
