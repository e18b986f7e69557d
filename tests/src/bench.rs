//! One running `lashloop`, with what it says and a deadline.

use std::ffi::OsStr;
use std::io::Read;
use std::process::{Child, Command, Stdio};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use rustix::process::Signal;

use crate::{processes, program, wait, workspace};

/// Nothing the tests run takes a tenth of this on a machine of its own.
const LIMIT: Duration = Duration::from_secs(180);

/// A `lashloop` that is running. Dropping it kills it.
pub struct Bench {
    child: Child,
    said: Option<[JoinHandle<String>; 2]>,
}

/// A `lashloop` that has ended.
#[derive(Debug)]
pub struct Ended {
    /// Its exit code; `None` if a signal ended it.
    pub code: Option<i32>,
    /// All of its standard output.
    pub stdout: String,
    /// All of its standard error.
    pub stderr: String,
    /// When that was seen.
    pub at: Instant,
}

impl Bench {
    /// Starts `lashloop` in the workspace.
    ///
    /// # Panics
    /// It can't be started.
    pub fn start(arguments: impl IntoIterator<Item = impl AsRef<OsStr>>) -> Self {
        let mut child = Command::new(program::lashloop())
            .args(arguments)
            .current_dir(workspace())
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("lashloop starts");
        let stdout = child.stdout.take().map(read_to_end).expect("a pipe for standard output");
        let stderr = child.stderr.take().map(read_to_end).expect("a pipe for standard error");
        Self { child, said: Some([stdout, stderr]) }
    }

    /// Its process number.
    #[must_use]
    pub fn id(&self) -> u32 {
        self.child.id()
    }

    /// Sends it a signal.
    pub fn signal(&self, signal: Signal) {
        processes::signal(self.id(), signal);
    }

    /// Waits for its end.
    ///
    /// # Panics
    /// It does not end within the limit; the panic shows what it said.
    #[must_use]
    pub fn wait(mut self) -> Ended {
        let status = wait::look(LIMIT, || self.child.try_wait().expect("lashloop can be waited for"));
        let at = Instant::now();
        if status.is_none() {
            let _ = self.child.kill();
        }
        let [stdout, stderr] = self.said.take().expect("nobody has waited before").map(|reader| {
            reader.join().unwrap_or_else(|_| panic!("the pipe of process {} can't be read", self.id()))
        });
        let Some(status) = status else {
            panic!("lashloop did not end within {} s\n{stdout}\n{stderr}", LIMIT.as_secs());
        };
        Ended { code: status.code(), stdout, stderr, at }
    }
}

impl Drop for Bench {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Ended {
    /// Checks the exit code.
    ///
    /// # Panics
    /// It is another one; the panic shows what the program said.
    #[must_use]
    pub fn with_code(self, code: i32) -> Self {
        let Self { stdout, stderr, .. } = &self;
        assert_eq!(self.code, Some(code), "exit code\n-- stdout --\n{stdout}-- stderr --\n{stderr}");
        self
    }
}

/// Runs `lashloop` to its end.
pub fn run(arguments: impl IntoIterator<Item = impl AsRef<OsStr>>) -> Ended {
    Bench::start(arguments).wait()
}

fn read_to_end(mut pipe: impl Read + Send + 'static) -> JoinHandle<String> {
    thread::spawn(move || {
        let mut bytes = Vec::new();
        let _ = pipe.read_to_end(&mut bytes);
        String::from_utf8(bytes).expect("lashloop speaks UTF-8")
    })
}
