//! One invocation of `lashloop`, with its output and a deadline.

mod build;

use std::ffi::OsStr;
use std::io::Read;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use rustix::process::Signal;

use crate::{processes, wait, workspace};

pub use build::{example, lashloop};

/// Ten times the longest invocation of any test on an idle machine.
const LIMIT: Duration = Duration::from_secs(285);

/// A running `lashloop`. Dropping it kills the process.
pub struct Running {
    child: Child,
    output: Option<[JoinHandle<String>; 2]>,
}

/// A `lashloop` that has ended.
#[derive(Debug)]
pub struct Ended {
    /// Exit code; `None` after a signal.
    pub code: Option<i32>,
    /// All of standard output.
    pub stdout: String,
    /// All of standard error.
    pub stderr: String,
    /// Time at which the end was observed.
    pub at: Instant,
}

impl Running {
    /// Starts `lashloop` in the workspace.
    ///
    /// # Panics
    /// The process can't be started.
    pub fn start(arguments: impl IntoIterator<Item = impl AsRef<OsStr>>) -> Self {
        Self::start_program(lashloop(), arguments)
    }

    /// Starts another program of the workspace, there.
    ///
    /// # Panics
    /// The process can't be started.
    pub fn start_program(program: &Path, arguments: impl IntoIterator<Item = impl AsRef<OsStr>>) -> Self {
        let mut command = Command::new(program);
        command.args(arguments);
        Self::start_command(command)
    }

    /// Starts a command in the workspace.
    ///
    /// # Panics
    /// The process can't be started.
    #[must_use]
    pub fn start_command(mut command: Command) -> Self {
        let mut child = command
            .current_dir(workspace())
            .env_remove("RUST_LOG")
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap_or_else(|error| panic!("{command:?} does not start: {error}"));
        let stdout = child.stdout.take().map(read_to_end).expect("a pipe for standard output");
        let stderr = child.stderr.take().map(read_to_end).expect("a pipe for standard error");
        Self { child, output: Some([stdout, stderr]) }
    }

    /// Process number.
    #[must_use]
    pub fn id(&self) -> u32 {
        self.child.id()
    }

    /// Sends a signal to the process.
    pub fn signal(&self, signal: Signal) {
        processes::signal(self.id(), signal);
    }

    /// Whether the process has ended.
    ///
    /// # Panics
    /// The system doesn't know the process.
    pub fn has_ended(&mut self) -> bool {
        self.child.try_wait().expect("lashloop can be waited for").is_some()
    }

    /// Waits for the end of the process.
    ///
    /// # Panics
    /// The process exceeds the limit; the panic shows its output.
    #[must_use]
    pub fn wait(mut self) -> Ended {
        let status = wait::look(LIMIT, || self.child.try_wait().expect("lashloop can be waited for"));
        let at = Instant::now();
        if status.is_none() {
            let _ = self.child.kill();
        }
        let [stdout, stderr] = self.output.take().expect("the first wait").map(|reader| {
            reader.join().unwrap_or_else(|_| panic!("the pipe of process {} can't be read", self.id()))
        });
        let Some(status) = status else {
            panic!("lashloop did not end within {} s\n{stdout}\n{stderr}", LIMIT.as_secs());
        };
        Ended { code: status.code(), stdout, stderr, at }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Ended {
    /// Lines on standard error but those of the progress, which only a run of some seconds reports.
    pub fn messages(&self) -> Vec<&str> {
        self.stderr.lines().filter(|line| !line.starts_with("progress ")).collect()
    }

    /// Checks the exit code.
    ///
    /// # Panics
    /// The exit code differs; the panic shows the output.
    #[must_use]
    pub fn with_code(self, code: i32) -> Self {
        let Self { stdout, stderr, .. } = &self;
        assert_eq!(self.code, Some(code), "exit code\n-- stdout --\n{stdout}-- stderr --\n{stderr}");
        self
    }
}

/// Runs `lashloop` to its end.
pub fn run(arguments: impl IntoIterator<Item = impl AsRef<OsStr>>) -> Ended {
    Running::start(arguments).wait()
}

/// Runs the program of an example to its end: `own-law` or `own-plant`.
pub fn run_example(name: &str, arguments: impl IntoIterator<Item = impl AsRef<OsStr>>) -> Ended {
    Running::start_program(&example(name), arguments).wait()
}

fn read_to_end(mut pipe: impl Read + Send + 'static) -> JoinHandle<String> {
    thread::spawn(move || {
        let mut bytes = Vec::new();
        let _ = pipe.read_to_end(&mut bytes);
        String::from_utf8(bytes).expect("lashloop prints UTF-8")
    })
}
