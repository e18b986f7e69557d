//! A C program: compiled once, then run round by round over pipes.

use std::error::Error;
use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use tempfile::TempDir;

use crate::round::Round;

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/c");
/// Flags of the plants.
pub const FOR_THIS_MACHINE: &[&str] = &["-std=c11", "-O3", "-march=native", "-fno-tree-vectorize"];
/// Flags of the loop.
pub const PLAIN: &[&str] = &["-std=c11", "-O2"];

/// The C program, waiting for a request.
pub struct CSide {
    child: Child,
    requests: ChildStdin,
    answers: BufReader<ChildStdout>,
    compiler: String,
    _directory: TempDir,
}

impl CSide {
    /// Compiles and starts a program of the folder `c`.
    pub fn build(name: &str, flags: &[&str]) -> Result<Self, Box<dyn Error>> {
        let directory = tempfile::tempdir()?;
        let (source, program) = (format!("{FOLDER}/{name}.c"), directory.path().join(name));
        let status =
            Command::new("cc").args(flags).arg(&source).arg("-o").arg(&program).arg("-lm").status()?;
        if !status.success() {
            return Err(format!("cc does not compile {source}: {status}").into());
        }
        let version = Command::new("cc").arg("--version").output()?.stdout;
        let version = String::from_utf8_lossy(&version).lines().next().unwrap_or("cc").to_owned();
        let mut child = Command::new(program).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn()?;
        let requests = child.stdin.take().ok_or("the C program has no input")?;
        let answers = BufReader::new(child.stdout.take().ok_or("the C program has no output")?);
        let compiler = format!("{version}, {}", flags.join(" "));
        Ok(Self { child, requests, answers, compiler, _directory: directory })
    }

    /// Compiler and flags.
    pub fn description(&self) -> &str {
        &self.compiler
    }

    /// Integrates one plant, or runs the loop, for a number of control periods.
    pub fn round(&mut self, name: &str, periods: u32) -> Result<Round, Box<dyn Error>> {
        writeln!(self.requests, "{name} {periods}")?;
        let mut line = String::new();
        self.answers.read_line(&mut line)?;
        let numbers = line.split_whitespace().map(str::parse).collect::<Result<Vec<f64>, _>>()?;
        let [ns, load_rad, motor_rad] = numbers[..] else {
            return Err(format!("the C program printed {line:?}, expected three numbers").into());
        };
        Ok(Round { ns, ends_rad: [load_rad, motor_rad] })
    }
}

impl Drop for CSide {
    fn drop(&mut self) {
        // The program exits at the end of its input; this covers a hung one.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
