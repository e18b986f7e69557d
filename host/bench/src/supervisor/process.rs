//! A child process.

use std::ffi::OsString;
use std::io;
use std::process::ExitStatus;
use std::sync::{Arc, Condvar, Mutex, PoisonError, mpsc};
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, kill_process, kill_process_group};
use tokio::io::{AsyncBufReadExt, AsyncRead, AsyncReadExt, BufReader};
use tokio::process::{Child, Command};
use tokio::sync::oneshot;

use lashloop_session::printable;

use super::activity::{Wait, Watch};

/// Longest line that is kept, in bytes.
const LONGEST_LINE: u64 = 512;
/// Time that standard error may take to end after its process.
const STDERR_LIMIT: Duration = Duration::from_millis(200);
/// Time that a killed child may take to end, on a busy machine.
const KILL_LIMIT: Duration = Duration::from_secs(2);
/// Time that a user's command may take to end by itself once its line is closed: it may have files to write.
const GRACE: Duration = Duration::from_millis(500);

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

/// Whose program a child is. It decides what is kept for an error message and how the child ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Author {
    /// Ours, or the emulator: one process. The first lines are kept, because a dump of registers or a stack follows the
    /// cause.
    Bench,
    /// A command of the user, with a guard as its parent: any number of processes. The last lines are kept, because most
    /// languages print the cause last.
    User,
}

impl Author {
    fn keep(self, lines: &mut Vec<String>, line: String) {
        match self {
            Self::Bench if lines.len() < 2 => lines.push(line),
            Self::Bench => {}
            Self::User => {
                lines.push(line);
                if lines.len() > 4 {
                    lines.remove(0);
                }
            }
        }
    }
}

/// A child process and its descendants. Dropping it ends them all.
pub struct Process {
    /// Its name in messages.
    pub name: &'static str,
    /// Its process number, which is also that of its group.
    pub id: u32,
    /// Shows what it is doing.
    pub watch: Watch,
    author: Author,
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
    pub(super) fn start(
        command: std::process::Command,
        name: &'static str,
        author: Author,
    ) -> io::Result<Self> {
        let mut child = Command::from(command).kill_on_drop(true).spawn()?;
        let id = child.id().unwrap_or_default();
        tracing::info!(program = name, process = id, "started");
        let end = Arc::new(End::default());
        let stderr = Arc::new(Mutex::new(Vec::new()));
        let (line_to, stdout) = mpsc::channel();
        let (kill, killed) = oneshot::channel();
        let kept = Arc::clone(&stderr);
        let keep = move |line: String| {
            if !line.is_empty() {
                author.keep(&mut kept.lock().unwrap_or_else(PoisonError::into_inner), line);
            }
        };
        if let Some(stdout) = child.stdout.take() {
            match author {
                Author::Bench => drop(tokio::spawn(each_line(stdout, move |line| drop(line_to.send(line))))),
                Author::User => drop(tokio::spawn(each_line(stdout, keep.clone()))),
            }
        }
        let reader = child.stderr.take().map(|stderr| tokio::spawn(each_line(stderr, keep)));
        let ended = Arc::clone(&end);
        tokio::spawn(async move {
            let status = wait_or_kill(child, id, killed).await;
            // An error message quotes standard error, so the end is published only after it.
            if let Some(reader) = reader {
                let _ = tokio::time::timeout(STDERR_LIMIT, reader).await;
            }
            let status = status.ok();
            *ended.status.lock().unwrap_or_else(PoisonError::into_inner) = status;
            ended.changed.notify_all();
            tracing::info!(program = name, process = id, ?status, "ended");
        });
        Ok(Self { name, id, watch: Watch::new(id), author, end, stderr, stdout, kill: Some(kill) })
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

    /// The next line of its standard output within `limit`, or later if the program was kept from printing it.
    #[must_use]
    pub fn first_line(&self, limit: Duration) -> Option<String> {
        let mut line = self.next_line(Instant::now() + limit);
        let mut wait = self.watch.wait();
        while line.is_none() && wait.is_excused() {
            line = self.next_line(Instant::now() + Wait::SLICE);
        }
        line
    }

    /// The lines of its standard error that matter most, joined by semicolons and escaped; empty if there are none.
    #[must_use]
    pub fn stderr(&self) -> String {
        printable(&self.stderr.lock().unwrap_or_else(PoisonError::into_inner).join("; "))
    }
}

impl Process {
    /// Stops or continues it and its descendants.
    pub fn set_suspended(&self, is_suspended: bool) {
        self.watch.suspended(is_suspended);
        signal_group(self.id, if is_suspended { Signal::STOP } else { Signal::CONT });
        // The guard has to notice the end of the bench meanwhile.
        if let (Author::User, true, Some(guard)) = (self.author, is_suspended, pid(self.id)) {
            let _ = kill_process(guard, Signal::CONT);
        }
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        if self.author == Author::User {
            let _ = self.ended_within(GRACE);
        }
        drop(self.kill.take());
        let _ = self.ended_within(KILL_LIMIT);
    }
}

fn pid(id: u32) -> Option<Pid> {
    Pid::from_raw(id.cast_signed())
}

/// Signals every process of a group. One that has ended can't be signalled; the link reports its end.
fn signal_group(id: u32, signal: Signal) {
    if let Some(group) = pid(id) {
        let _ = kill_process_group(group, signal);
    }
}

/// Waits for the end of a child, and kills it as soon as its [`Process`] is dropped. In both cases no descendant stays.
async fn wait_or_kill(mut child: Child, id: u32, killed: oneshot::Receiver<()>) -> io::Result<ExitStatus> {
    let ended = tokio::select! {
        status = child.wait() => Some(status),
        _ = killed => None,
    };
    signal_group(id, Signal::KILL);
    match ended {
        Some(status) => status,
        None => child.wait().await,
    }
}

/// Passes on each line without its end. A longer line than [`LONGEST_LINE`] comes in pieces.
async fn each_line(stream: impl AsyncRead + Unpin, mut take: impl FnMut(String)) {
    let mut stream = BufReader::new(stream);
    let mut line = Vec::new();
    while let Ok(1..) = (&mut stream).take(LONGEST_LINE).read_until(b'\n', &mut line).await {
        take(String::from_utf8_lossy(&line).trim_end().to_owned());
        line.clear();
    }
}
