//! Runs `qless` in a temporary folder.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use tempfile::TempDir;

pub const HEADER: &str = "%%MatrixMarket matrix coordinate real general\n";

/// A temporary folder with files.
pub struct Place(TempDir);

/// The result of a run.
pub struct Run {
    pub code: i32,
    pub out: String,
    pub err: String,
}

impl Place {
    pub fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder"))
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Writes a file, and the folders above it.
    pub fn file(&self, name: &str, text: impl AsRef<[u8]>) -> &Self {
        let path = self.path(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("created");
        fs::write(path, text).expect("written");
        self
    }

    /// Writes C.mtx (entries with rows and columns from 1), b.txt and, if there are any, prescribed values.
    pub fn case(
        &self,
        folder: &str,
        [rows, columns]: [usize; 2],
        entries: &[(usize, usize, f64)],
        b: &[f64],
        prescribed: &[(usize, f64)],
    ) -> &Self {
        let text = lines(entries.iter().map(|(i, j, v)| format!("{i} {j} {v}\n")));
        let matrix = format!("{HEADER}{rows} {columns} {}\n{text}", entries.len());
        self.file(&format!("{folder}/C.mtx"), matrix);
        self.file(&format!("{folder}/b.txt"), lines(b.iter().map(|v| format!("{v}\n"))));
        if !prescribed.is_empty() {
            let text = lines(prescribed.iter().map(|(j, v)| format!("{j} {v}\n")));
            self.file(&format!("{folder}/prescribed.txt"), text);
        }
        self
    }

    /// Equations (12)-(14) of the paper, (13) with the sign that its (16) requires: (14) = (12) + (13) for `rhs` 1.
    pub fn paper(&self, folder: &str, rhs: f64) -> &Self {
        let rows = [[1.0, -1.0, 2.0], [1.0, 2.0, -1.0], [2.0, 1.0, 1.0]];
        let entries: Vec<_> = (0..9).map(|k| (k / 3 + 1, k % 3 + 1, rows[k / 3][k % 3])).collect();
        self.case(folder, [3, 3], &entries, &[1.0, 0.0, rhs], &[])
    }

    /// Runs `qless` with blank-separated arguments.
    pub fn run(&self, arguments: &str) -> Run {
        Self::ended(self.command(arguments).output().expect("the program starts"))
    }

    /// Runs `qless` with arguments that may contain blanks.
    pub fn run_words(&self, arguments: &[&str]) -> Run {
        Self::ended(self.command("").args(arguments).output().expect("the program starts"))
    }

    /// Runs `qless` with text on standard input.
    pub fn run_fed(&self, arguments: &str, input: &[u8]) -> Run {
        let mut command = self.command(arguments);
        let piped = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = piped.spawn().expect("the program starts");
        let mut pipe = child.stdin.take().expect("piped");
        // The program may close standard input before the end.
        let _ = pipe.write_all(input);
        drop(pipe);
        Self::ended(child.wait_with_output().expect("it ends"))
    }

    fn ended(output: Output) -> Run {
        let text = |bytes| String::from_utf8(bytes).expect("UTF-8");
        let code = output.status.code().expect("it ends by itself");
        Run { code, out: text(output.stdout), err: text(output.stderr) }
    }

    pub fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_qless"));
        command.args(arguments.split_whitespace()).current_dir(self.0.path()).stdin(Stdio::null());
        command
    }

    /// Every file below the folder, with its content.
    pub fn everything(&self) -> Vec<(PathBuf, Vec<u8>)> {
        let mut all = Vec::new();
        collect(self.0.path(), &mut all);
        all.sort();
        all
    }
}

/// The text of lines that end in line breaks.
pub fn lines(lines: impl Iterator<Item = String>) -> String {
    lines.collect::<Vec<_>>().concat()
}

fn collect(folder: &Path, all: &mut Vec<(PathBuf, Vec<u8>)>) {
    for entry in fs::read_dir(folder).expect("readable") {
        let path = entry.expect("readable").path();
        if path.is_dir() {
            all.push((path.clone(), Vec::new()));
            collect(&path, all);
        } else {
            all.push((path.clone(), fs::read(&path).expect("readable")));
        }
    }
}

impl Run {
    /// The JSON report, which follows the schema in the documentation.
    pub fn json(&self) -> serde_json::Value {
        let report =
            serde_json::from_str(&self.out).unwrap_or_else(|error| panic!("{error}: {}{}", self.out, self.err));
        assert_eq!(crate::schema::violations(&report), [""; 0], "{}", self.out);
        report
    }
}
