//! The thread that starts children and receives signals.

use std::io::{PipeReader, PipeWriter, Write as _};
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, mpsc};
use std::thread::JoinHandle;
use std::{io, thread};

use tokio::runtime::{Handle, Runtime};
use tokio::signal::unix::{SignalKind, signal};
use tokio::sync::oneshot;

use super::process::{Author, Process, Program};

/// Exit code of an interruption: that of INVALID, at every moment.
const INTERRUPTED: i32 = 3;

/// Supervisors that handle signals.
static HANDLERS: AtomicUsize = AtomicUsize::new(0);
/// Whether a signal has arrived in this process.
static REQUESTED: AtomicBool = AtomicBool::new(false);

#[derive(Default)]
struct Signals {
    /// The bench polls `requested` and ends by itself.
    guarded: AtomicBool,
    requested: AtomicBool,
}

impl Signals {
    /// Handles a signal. Without a guard, and at the second signal, the process ends; the kernel ends its children.
    fn arrived(&self) {
        REQUESTED.store(true, Ordering::Relaxed);
        if self.requested.swap(true, Ordering::Relaxed) || !self.guarded.load(Ordering::Relaxed) {
            end();
        }
    }
}

/// Ends the process. It has no result to keep.
fn end() -> ! {
    let called = std::env::args_os().next().unwrap_or_default();
    let name = Path::new(&called).file_name().unwrap_or("lashloop".as_ref()).display();
    // Nobody may read it.
    let _ = writeln!(io::stderr(), "{name}: INVALID: interrupted by the user before there was a result");
    std::process::exit(INTERRUPTED)
}

/// Whether SIGINT or SIGTERM has arrived in this process, for code without a [`Supervisor`] that handles signals.
#[must_use]
pub fn is_interrupted() -> bool {
    REQUESTED.load(Ordering::Relaxed)
}

/// A runtime on the thread that drives it.
fn runtime() -> io::Result<Runtime> {
    // Without these the runtime would panic where it makes its own.
    drop([UnixStream::pair()?, UnixStream::pair()?, UnixStream::pair()?]);
    tokio::runtime::Builder::new_current_thread().enable_all().build()
}

/// Ends the process at SIGINT and SIGTERM with the exit code of INVALID, whenever no [`Supervisor`] handles them. For the
/// start of a program: until then a signal would end it without a word.
///
/// # Errors
/// The system refused a thread, a runtime or the signal handlers.
pub fn end_at_signals() -> io::Result<()> {
    let runtime = runtime()?;
    receive_signals(&runtime, || {
        REQUESTED.store(true, Ordering::Relaxed);
        if HANDLERS.load(Ordering::Relaxed) == 0 {
            end();
        }
    })?;
    let forever = move || runtime.block_on(std::future::pending::<()>());
    thread::Builder::new().name("signals".to_owned()).spawn(forever)?;
    Ok(())
}

/// Calls `arrived` at each SIGINT and SIGTERM, on the thread of the runtime.
fn receive_signals(runtime: &Runtime, arrived: impl Fn() + Clone + Send + 'static) -> io::Result<()> {
    let _inside = runtime.enter();
    for kind in [SignalKind::interrupt(), SignalKind::terminate()] {
        let (mut source, arrived) = (signal(kind)?, arrived.clone());
        tokio::spawn(async move {
            while source.recv().await.is_some() {
                arrived();
            }
        });
    }
    Ok(())
}

/// A supervisor that handles signals, while it lives.
struct Handling;

impl Handling {
    fn begin() -> Self {
        HANDLERS.fetch_add(1, Ordering::Relaxed);
        Self
    }
}

impl Drop for Handling {
    fn drop(&mut self) {
        HANDLERS.fetch_sub(1, Ordering::Relaxed);
    }
}

/// Starts child processes and receives signals, on a thread with a tokio runtime. The thread ends with it.
pub struct Supervisor {
    /// The `lashloop` program; empty if there is none to tie children to.
    pub bench: PathBuf,
    runtime: Handle,
    /// Before the thread, which ends without it.
    _end: oneshot::Sender<()>,
    signals: Arc<Signals>,
    _thread: Joined,
    _handling: Option<Handling>,
}

/// A thread that has ended, with its open files, once this is dropped: a program that starts many runs, one after the other, must
/// not run out of files on a busy machine.
struct Joined(Option<JoinHandle<()>>);

impl Drop for Joined {
    fn drop(&mut self) {
        if let Some(thread) = self.0.take() {
            // After a panic there is nothing left to end.
            let _ = thread.join();
        }
    }
}

/// While it lives, a signal only sets [`Supervisor::interrupted`].
pub struct SignalGuard<'a>(&'a Signals);

impl Drop for SignalGuard<'_> {
    fn drop(&mut self) {
        self.0.guarded.store(false, Ordering::Relaxed);
    }
}

impl Supervisor {
    /// Starts the thread. `bench` is the `lashloop` program, whose hidden command `tied` runs a program that the kernel ends
    /// with the bench: a killed bench leaves no emulator behind.
    ///
    /// # Errors
    /// The system refused a thread, a runtime or the signal handlers.
    pub fn start(bench: PathBuf) -> io::Result<Self> {
        Self::start_thread(bench, true)
    }

    /// Starts the thread for the children of one part of a program that handles signals itself. Without a `bench`, children
    /// are not tied: a killed program leaves them to end by themselves once their standard input ends.
    ///
    /// # Errors
    /// The system refused a thread or a runtime.
    pub fn without_signals(bench: Option<PathBuf>) -> io::Result<Self> {
        Self::start_thread(bench.unwrap_or_default(), false)
    }

    fn start_thread(bench: PathBuf, handles_signals: bool) -> io::Result<Self> {
        let signals = Arc::new(Signals::default());
        let runtime = runtime()?;
        if handles_signals {
            let shared = Arc::clone(&signals);
            receive_signals(&runtime, move || shared.arrived())?;
        }
        let (handle, (end, ended)) = (runtime.handle().clone(), oneshot::channel());
        let work = move || {
            let _ = runtime.block_on(ended);
        };
        let thread = thread::Builder::new().name("supervisor".to_owned()).spawn(work)?;
        tracing::debug!(thread = "supervisor", "started");
        let handling = handles_signals.then(Handling::begin);
        Ok(Self {
            bench,
            runtime: handle,
            _end: end,
            signals,
            _thread: Joined(Some(thread)),
            _handling: handling,
        })
    }

    /// Leaves signals to the caller, who must poll [`Self::interrupted`]. Without a guard, and at the second signal, a
    /// signal ends the process.
    #[must_use]
    pub fn guard_signals(&self) -> SignalGuard<'_> {
        self.signals.guarded.store(true, Ordering::Relaxed);
        SignalGuard(&self.signals)
    }

    /// Whether SIGINT or SIGTERM has arrived.
    #[must_use]
    pub fn interrupted(&self) -> bool {
        self.signals.requested.load(Ordering::Relaxed)
    }

    /// Runs a program of one process until it ends by itself or its [`Process`] is dropped. Its standard output is read
    /// line by line.
    ///
    /// # Errors
    /// The program can't be started.
    pub fn spawn(&self, program: &Program) -> io::Result<Process> {
        let mut command = self.command(program, Author::Bench);
        command.stdin(Stdio::null()).stdout(Stdio::piped());
        self.order(command, program.name, Author::Bench)
    }

    /// Runs a command of the user, of any number of processes, until it ends by itself or its [`Process`] is dropped. The
    /// bench writes its standard input and reads its standard output through the pipes.
    ///
    /// # Errors
    /// The command can't be started.
    pub fn spawn_piped(&self, program: &Program) -> io::Result<(Process, PipeWriter, PipeReader)> {
        self.spawn_piped_in(Path::new(""), program)
    }

    /// As [`Self::spawn_piped`], in a working folder; an empty path is that of the bench.
    ///
    /// # Errors
    /// The command can't be started.
    pub fn spawn_piped_in(
        &self,
        folder: &Path,
        program: &Program,
    ) -> io::Result<(Process, PipeWriter, PipeReader)> {
        let ((stdin, to_child), (from_child, stdout)) = (io::pipe()?, io::pipe()?);
        let mut command = self.command(program, Author::User);
        if !folder.as_os_str().is_empty() {
            command.current_dir(folder);
        }
        command.stdin(stdin).stdout(stdout);
        Ok((self.order(command, program.name, Author::User)?, to_child, from_child))
    }

    /// As [`Self::spawn_piped`], without a standard input. Its standard output is kept with its standard error.
    ///
    /// # Errors
    /// The command can't be started.
    pub fn spawn_logged(&self, program: &Program) -> io::Result<Process> {
        let mut command = self.command(program, Author::User);
        command.stdin(Stdio::null()).stdout(Stdio::piped());
        self.order(command, program.name, Author::User)
    }

    /// The command of a program of the user, for a caller that starts it and waits for it itself. The program and its
    /// descendants end with the bench.
    #[must_use]
    pub fn command_of_user(&self, program: &Program) -> Command {
        self.command(program, Author::User)
    }

    fn command(&self, program: &Program, author: Author) -> Command {
        let mut command = self.tied(program, author);
        if author == Author::Bench {
            // Its events would be the last lines of its standard error, which errors quote.
            command.env_remove("RUST_LOG");
        }
        command
    }

    fn tied(&self, program: &Program, author: Author) -> Command {
        use std::os::unix::process::CommandExt;
        let is_tied = !self.bench.as_os_str().is_empty();
        let mut command = Command::new(if is_tied { self.bench.as_os_str() } else { &program.program });
        if !is_tied {
            command.args(&program.arguments).stderr(Stdio::piped()).process_group(0);
            return command;
        }
        command.arg("tied");
        if author == Author::User {
            command.arg("--guard").arg(std::process::id().to_string());
        }
        if let Some(core) = program.core {
            command.arg("--core").arg(core.to_string());
        }
        command.arg("--").arg(&program.program).args(&program.arguments);
        // In a process group of its own: Ctrl-C reaches the bench alone, which then ends the child. Descendants share it.
        command.stderr(Stdio::piped()).process_group(0);
        command
    }

    fn order(&self, command: Command, name: &'static str, author: Author) -> io::Result<Process> {
        let (reply, answer) = mpsc::channel();
        // On the supervisor's thread: a child ends with the thread that has started it.
        self.runtime.spawn(async move { reply.send(Process::start(command, name, author)) });
        answer.recv().map_err(io::Error::other)?
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_thread_of_a_dropped_supervisor_has_ended() {
        let supervisor = Supervisor::start(PathBuf::new()).expect("a thread");
        let held_by_thread = Arc::clone(&supervisor.signals);
        drop(supervisor);
        assert_eq!(Arc::strong_count(&held_by_thread), 1);
    }
}
