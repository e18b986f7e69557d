//! A child process.

use std::ffi::OsString;
use std::io;
use std::process::ExitStatus;
use std::sync::{Arc, Condvar, Mutex, PoisonError, mpsc};
use std::time::{Duration, Instant};

use tokio::io::{AsyncBufReadExt, AsyncRead, BufReader};
use tokio::process::{Child, Command};
use tokio::sync::oneshot;

/// Lines of standard error that are kept for an error message. The first ones: a dump of registers or a stack follows the
/// cause.
const STDERR_LINES: usize = 2;
/// Time that standard error may take to end after its process.
const STDERR_LIMIT: Duration = Duration::from_millis(200);
/// Time that a killed child may take to end, on a busy machine.
const KILL_LIMIT: Duration = Duration::from_secs(2);

/// A program to be run as a child of the bench.
#[derive(Debug, Clone)]
pub struct Program {
    /// Its name in messages.
    pub name: &'static str,
    /// Path or name of the executable.
    pub program: OsString,
    /// Its arguments.
    pub arguments: Vec<OsString>,
    /// The core it is pinned to; `None` for any.
    pub core: Option<usize>,
}

/// A child process. Dropping it kills the child.
pub struct Process {
    /// Its name in messages.
    pub name: &'static str,
    /// Its process number.
    pub id: u32,
    end: Arc<End>,
    stderr: Arc<Mutex<Vec<String>>>,
    stdout: mpsc::Receiver<String>,
    kill: Option<oneshot::Sender<()>>,
}

/// How a process ended, once it has.
#[derive(Default)]
struct End {
    status: Mutex<Option<ExitStatus>>,
    changed: Condvar,
}

impl Process {
    /// Starts a child on the present tokio runtime.
    ///
    /// # Errors
    /// The system refused.
    pub(super) fn start(command: std::process::Command, name: &'static str) -> io::Result<Self> {
        let mut child = Command::from(command).kill_on_drop(true).spawn()?;
        let id = child.id().unwrap_or_default();
        let end = Arc::new(End::default());
        let stderr = Arc::new(Mutex::new(Vec::new()));
        let (line_to, stdout) = mpsc::channel();
        let (kill, killed) = oneshot::channel();
        if let Some(stdout) = child.stdout.take() {
            tokio::spawn(each_line(stdout, move |line| drop(line_to.send(line))));
        }
        let kept = Arc::clone(&stderr);
        let reader = child.stderr.take().map(|stderr| {
            tokio::spawn(each_line(stderr, move |line| {
                let mut kept = kept.lock().unwrap_or_else(PoisonError::into_inner);
                if kept.len() < STDERR_LINES && !line.is_empty() {
                    kept.push(line);
                }
            }))
        });
        let ended = Arc::clone(&end);
        tokio::spawn(async move {
            let status = wait_or_kill(child, killed).await;
            // An error message quotes standard error, so the end is published only after it.
            if let Some(reader) = reader {
                let _ = tokio::time::timeout(STDERR_LIMIT, reader).await;
            }
            *ended.status.lock().unwrap_or_else(PoisonError::into_inner) = status.ok();
            ended.changed.notify_all();
        });
        Ok(Self { name, id, end, stderr, stdout, kill: Some(kill) })
    }

    /// Waits for its end, `limit` at most; `None` if it still runs.
    #[must_use]
    pub fn ended_within(&self, limit: Duration) -> Option<ExitStatus> {
        let status = self.end.status.lock().unwrap_or_else(PoisonError::into_inner);
        *self
            .end
            .changed
            .wait_timeout_while(status, limit, |status| status.is_none())
            .unwrap_or_else(PoisonError::into_inner)
            .0
    }

    /// The next line of its standard output; `None` at the deadline and after its end.
    #[must_use]
    pub fn next_line(&self, deadline: Instant) -> Option<String> {
        self.stdout.recv_timeout(deadline.saturating_duration_since(Instant::now())).ok()
    }

    /// The first lines of its standard error, joined by semicolons; empty if there are none.
    #[must_use]
    pub fn stderr_head(&self) -> String {
        self.stderr.lock().unwrap_or_else(PoisonError::into_inner).join("; ")
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        drop(self.kill.take());
        let _ = self.ended_within(KILL_LIMIT);
    }
}

/// Waits for the end of a child, and kills it as soon as its [`Process`] is dropped.
async fn wait_or_kill(mut child: Child, killed: oneshot::Receiver<()>) -> io::Result<ExitStatus> {
    tokio::select! {
        status = child.wait() => return status,
        _ = killed => {}
    }
    child.start_kill()?;
    child.wait().await
}

async fn each_line(stream: impl AsyncRead + Unpin, mut take: impl FnMut(String)) {
    let mut lines = BufReader::new(stream).lines();
    while let Ok(Some(line)) = lines.next_line().await {
        take(line);
    }
}
