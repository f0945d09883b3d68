//! Solvers that find the rank of C on the way to a solution, each as a program that is started: MUMPS by the null pivots of the multiplier
//! system (`peers/mumps.c`), HiGHS by presolve and simplex (`peers/highs.py`).
//!
//! A program reads systems until its input ends. Each is the number of rows, of columns and of entries of C in its free DOFs, the start of
//! each column and the number of all entries (all 64 bits), the row of each entry (32 bits), and its value (a double), in the byte order of
//! the machine. For each it writes a line: `rank seconds`, or `failed` and the reason.

use std::io::{BufWriter, Read, Write};
use std::path::Path;
use std::process::{Command, Stdio};

use qless::ConstraintSystem;

use super::free_columns;

const HIGHS: &str = include_str!("../../peers/highs.py");

/// The rank of a system, and seconds; or why there is none.
pub type SolverAnswer = Result<(usize, f64), String>;

const NO_ANSWER: &str = "its program ended without an answer";

/// A solver in common use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Solver {
    Mumps,
    Highs,
}

impl Solver {
    pub const ALL: [Self; 2] = [Self::Mumps, Self::Highs];

    /// MUMPS is if `libmumps-seq-dev` was there at the build, HiGHS if `python3` has `highspy` and `numpy`.
    pub fn is_installed(self) -> bool {
        match self {
            Self::Mumps => option_env!("QLESS_MUMPS").is_some_and(|path| Path::new(path).exists()),
            Self::Highs => {
                let finds =
                    "import importlib.util as u, sys; sys.exit(not (u.find_spec('highspy') and u.find_spec('numpy')))";
                Command::new("python3").args(["-c", finds]).status().is_ok_and(|status| status.success())
            }
        }
    }

    pub fn name(self) -> &'static str {
        match self {
            Self::Mumps => "MUMPS null pivots",
            Self::Highs => "HiGHS",
        }
    }

    /// For each system the rank of C in its free DOFs, and seconds.
    pub fn ranks(self, systems: &[&ConstraintSystem]) -> Result<Vec<SolverAnswer>, String> {
        let failed = |error: std::io::Error| format!("its program does not run: {error}");
        let mut child = self.command().stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null()).spawn();
        let child = child.as_mut().map_err(|error| failed(std::io::Error::from(error.kind())))?;
        let (input, mut output) = (child.stdin.take(), child.stdout.take());
        let mut text = String::new();
        let read = std::thread::scope(|scope| {
            // A program that ends early breaks the pipe; its last line says why.
            scope.spawn(move || input.map(|input| write(systems, &mut BufWriter::new(input))));
            output.as_mut().map_or(Ok(0), |output| output.read_to_string(&mut text))
        });
        read.and_then(|_| child.wait()).map_err(failed)?;
        let mut answers: Vec<_> = text.lines().map(answer).collect();
        answers.resize(systems.len(), Err(NO_ANSWER.to_owned()));
        Ok(answers)
    }

    fn command(self) -> Command {
        match self {
            Self::Mumps => Command::new(option_env!("QLESS_MUMPS").unwrap_or_default()),
            Self::Highs => {
                let mut python = Command::new("python3");
                python.args(["-c", HIGHS]);
                python
            }
        }
    }
}

fn answer(line: &str) -> SolverAnswer {
    if let Some(reason) = line.strip_prefix("failed ") {
        return Err(reason.to_owned());
    }
    let found = line.split_once(' ').and_then(|(rank, seconds)| Some((rank.parse().ok()?, seconds.parse().ok()?)));
    found.ok_or_else(|| NO_ANSWER.to_owned())
}

fn write(systems: &[&ConstraintSystem], out: &mut impl Write) -> std::io::Result<()> {
    for system in systems {
        let free = free_columns(system);
        let sizes = [free.cols(), free.rows(), free.columns().len()];
        sizes.iter().chain(free.starts()).try_for_each(|&n| out.write_all(&(n as u64).to_ne_bytes()))?;
        free.columns().iter().try_for_each(|&i| out.write_all(&i.to_ne_bytes()))?;
        free.values().iter().try_for_each(|&v| out.write_all(&v.to_ne_bytes()))?;
    }
    out.flush()
}

#[cfg(test)]
mod tests {
    use super::{NO_ANSWER, answer};

    #[test]
    fn a_line_is_a_rank_or_the_reason_of_a_failure() {
        assert_eq!(answer("12 0.5"), Ok((12, 0.5)));
        assert_eq!(answer("failed INFOG(1) = -13"), Err("INFOG(1) = -13".to_owned()));
        assert_eq!(answer("12"), Err(NO_ANSWER.to_owned()));
    }
}
