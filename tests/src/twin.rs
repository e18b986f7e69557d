//! `lashloop device`: a drive on a pseudo-terminal, as another shell would run it. And whatever else is run that way.

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc;
use std::thread;

use rustix::process::Signal;

use crate::wait::SOON;
use crate::{processes, program};

/// A running twin. Dropping it kills it.
pub struct Twin {
    child: Child,
    path: PathBuf,
}

impl Twin {
    /// Starts a twin and waits for the path of its terminal.
    ///
    /// # Panics
    /// It does not come up.
    #[must_use]
    pub fn start() -> Self {
        let mut command = Command::new(program::lashloop());
        command.arg("device");
        Self::serving(command)
    }

    /// Starts a drive that prints the path of its terminal, as `lashloop device` does.
    ///
    /// # Panics
    /// It does not come up.
    #[must_use]
    pub fn serving(mut command: Command) -> Self {
        let mut child = command
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap_or_else(|error| panic!("{command:?} does not start: {error}"));
        let mut stdout = BufReader::new(child.stdout.take().expect("a pipe for standard output"));
        let (tell, told) = mpsc::channel();
        thread::spawn(move || {
            let mut line = String::new();
            let _ = stdout.read_line(&mut line);
            let _ = tell.send(line);
        });
        let line = told.recv_timeout(SOON).unwrap_or_default();
        let path = PathBuf::from(line.trim_end());
        if !path.exists() {
            let _ = child.kill();
            panic!("{command:?} said {line:?} in place of the path of a terminal");
        }
        Self { child, path }
    }

    /// The terminal.
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

    /// Sends the twin a signal.
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
