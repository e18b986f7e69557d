//! `lashloop device`: a drive on a pseudo-terminal, run as another shell would; and other drives that print their path.

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc;
use std::thread;

use rustix::process::Signal;

use crate::wait::SOON;
use crate::{processes, program};

/// A drive in a process of its own. Dropping it kills the process.
pub struct Twin {
    child: Child,
    path: PathBuf,
}

impl Twin {
    /// Starts a twin and waits for the path of its terminal.
    ///
    /// # Panics
    /// The drive does not come up.
    #[must_use]
    pub fn start() -> Self {
        let mut command = Command::new(program::lashloop());
        command.arg("device");
        Self::serving(command)
    }

    /// Starts a drive that prints the path of its terminal, as `lashloop device` does.
    ///
    /// # Panics
    /// The drive does not come up.
    #[must_use]
    pub fn serving(mut command: Command) -> Self {
        let mut child = command
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap_or_else(|error| panic!("{command:?} does not start: {error}"));
        let mut stdout = BufReader::new(child.stdout.take().expect("a pipe for standard output"));
        let (line_to, line) = mpsc::channel();
        thread::spawn(move || {
            let mut line = String::new();
            let _ = stdout.read_line(&mut line);
            let _ = line_to.send(line);
        });
        let line = line.recv_timeout(SOON).unwrap_or_default();
        let path = PathBuf::from(line.trim_end());
        if !path.exists() {
            let _ = child.kill();
            panic!("{command:?} printed {line:?}, not the path of a terminal");
        }
        Self { child, path }
    }

    /// Path of the terminal.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The terminal as `--device` takes it.
    #[must_use]
    pub fn device(&self) -> String {
        self.path.display().to_string()
    }

    /// Its process number.
    #[must_use]
    pub fn id(&self) -> u32 {
        self.child.id()
    }

    /// Sends a signal to the process.
    pub fn signal(&self, signal: Signal) {
        processes::signal(self.child.id(), signal);
    }
}

impl Drop for Twin {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
