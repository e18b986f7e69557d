//! Everything that happens beside the loop: child processes that are watched, read and ended, and the signals that ask
//! the bench to stop. One thread with a tokio runtime does it, so the loop's thread never waits for any of it.

use std::ffi::OsString;
use std::path::PathBuf;
use std::process::{ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError, mpsc};
use std::time::{Duration, Instant};
use std::{io, thread};

use tokio::io::{AsyncBufReadExt, AsyncRead, BufReader};
use tokio::process::{Child, Command};
use tokio::signal::unix::{SignalKind, signal};
use tokio::sync::{mpsc as channel, oneshot};

/// Lines of a child's standard error that are kept for an error message. The first ones, because what follows the cause
/// is a dump of registers or a stack.
const KEPT_LINES: usize = 2;
/// What a shell reports of a program that Ctrl-C ended.
const KILLED: i32 = 130;
/// A killed child is gone at once; this is for a machine that is busy.
const KILL_LIMIT: Duration = Duration::from_secs(2);

/// A program to be run beside the bench.
#[derive(Debug, Clone)]
pub struct Program {
    /// What to call it in messages.
    pub name: &'static str,
    /// Path or name of the program.
    pub program: OsString,
    /// Its arguments.
    pub arguments: Vec<OsString>,
    /// The core it is to stay on, if it is to stay on one.
    pub core: Option<usize>,
}

/// The watcher of children and signals.
pub struct Supervisor {
    tie: PathBuf,
    orders: channel::UnboundedSender<Order>,
    signals: Arc<Signals>,
}

/// What is done with SIGINT and SIGTERM.
#[derive(Default)]
struct Signals {
    /// Whether somebody looks at `asked` and ends in good order.
    heeded: AtomicBool,
    asked: AtomicBool,
}

impl Signals {
    /// Where nobody looks, or not soon enough for the user, the process ends at once; the kernel takes its children.
    fn arrived(&self) {
        if self.asked.swap(true, Ordering::Relaxed) || !self.heeded.load(Ordering::Relaxed) {
            std::process::exit(KILLED);
        }
    }
}

/// As long as it lives, a signal is left to whoever asks [`Supervisor::interrupted`].
pub struct SignalGuard<'a>(&'a Supervisor);

impl Drop for SignalGuard<'_> {
    fn drop(&mut self) {
        self.0.signals.heeded.store(false, Ordering::Relaxed);
    }
}

struct Order {
    command: std::process::Command,
    name: &'static str,
    reply: mpsc::Sender<io::Result<Process>>,
}

impl Supervisor {
    /// Starts watching. `tie` is the `lashloop` program, whose hidden command `tied` runs a program that dies with the
    /// bench: a bench that is killed leaves no emulator behind.
    ///
    /// # Errors
    /// The system refused a thread, a runtime or the signal handlers.
    pub fn start(tie: PathBuf) -> io::Result<Self> {
        let signals = Arc::new(Signals::default());
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        let (orders, inbox) = channel::unbounded_channel();
        let (ready, started) = mpsc::channel();
        let shared = Arc::clone(&signals);
        thread::Builder::new()
            .name("supervisor".to_owned())
            .spawn(move || runtime.block_on(supervise(inbox, shared, ready)))?;
        started.recv().map_err(io::Error::other)??;
        Ok(Self { tie, orders, signals })
    }

    /// Promises to ask [`Self::interrupted`] often. Without the promise, and at the second signal, a signal ends the process.
    #[must_use]
    pub fn heed_signals(&self) -> SignalGuard<'_> {
        self.signals.heeded.store(true, Ordering::Relaxed);
        SignalGuard(self)
    }

    /// Whether the user asked the bench to stop (SIGINT or SIGTERM).
    #[must_use]
    pub fn interrupted(&self) -> bool {
        self.signals.asked.load(Ordering::Relaxed)
    }

    /// The `lashloop` program itself.
    #[must_use]
    pub fn bench(&self) -> OsString {
        self.tie.clone().into()
    }

    /// Runs a program until it ends by itself or its [`Process`] is dropped.
    ///
    /// # Errors
    /// It can't be started.
    pub fn spawn(&self, program: &Program) -> io::Result<Process> {
        use std::os::unix::process::CommandExt;
        let mut command = std::process::Command::new(&self.tie);
        command.arg("tied");
        if let Some(core) = program.core {
            command.arg("--core").arg(core.to_string());
        }
        command.arg("--").arg(&program.program).args(&program.arguments);
        // In a group of its own, so that Ctrl-C reaches the bench, which then ends the child in good order.
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).process_group(0);
        let (reply, answer) = mpsc::channel();
        let order = Order { command, name: program.name, reply };
        self.orders.send(order).map_err(io::Error::other)?;
        answer.recv().map_err(io::Error::other)?
    }
}

/// A watched child process. Dropping it kills the child.
pub struct Process {
    name: &'static str,
    id: u32,
    fate: Arc<(Mutex<Option<ExitStatus>>, Condvar)>,
    errors: Arc<Mutex<Vec<String>>>,
    lines: mpsc::Receiver<String>,
    kill: Option<oneshot::Sender<()>>,
}

impl Process {
    /// What it is called in messages.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// Its process number.
    #[must_use]
    pub fn id(&self) -> u32 {
        self.id
    }

    /// How it ended, if it has, waiting for at most `limit`.
    #[must_use]
    pub fn ended_within(&self, limit: Duration) -> Option<ExitStatus> {
        let (fate, changed) = &*self.fate;
        let fate = fate.lock().unwrap_or_else(PoisonError::into_inner);
        *changed
            .wait_timeout_while(fate, limit, |fate| fate.is_none())
            .unwrap_or_else(PoisonError::into_inner)
            .0
    }

    /// The next line it writes to standard output, or `None` at the deadline or when it has ended.
    #[must_use]
    pub fn next_line(&self, deadline: Instant) -> Option<String> {
        self.lines.recv_timeout(deadline.saturating_duration_since(Instant::now())).ok()
    }

    /// The first lines it wrote to standard error, as one.
    #[must_use]
    pub fn said(&self) -> String {
        self.errors.lock().unwrap_or_else(PoisonError::into_inner).join("; ")
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        drop(self.kill.take());
        let _ = self.ended_within(KILL_LIMIT);
    }
}

async fn supervise(
    mut orders: channel::UnboundedReceiver<Order>,
    shared: Arc<Signals>,
    ready: mpsc::Sender<io::Result<()>>,
) {
    let signals = signal(SignalKind::interrupt()).and_then(|i| Ok((i, signal(SignalKind::terminate())?)));
    let (mut interrupt, mut terminate) = match signals {
        Ok(signals) => {
            let _ = ready.send(Ok(()));
            signals
        }
        Err(error) => {
            let _ = ready.send(Err(error));
            return;
        }
    };
    loop {
        tokio::select! {
            _ = interrupt.recv() => shared.arrived(),
            _ = terminate.recv() => shared.arrived(),
            order = orders.recv() => match order {
                Some(order) => { let _ = order.reply.send(start(order.command, order.name)); }
                None => return,
            },
        }
    }
}

fn start(command: std::process::Command, name: &'static str) -> io::Result<Process> {
    let mut child = Command::from(command).kill_on_drop(true).spawn()?;
    let id = child.id().unwrap_or_default();
    let fate = Arc::new((Mutex::new(None), Condvar::new()));
    let errors = Arc::new(Mutex::new(Vec::new()));
    let (line_to, lines) = mpsc::channel();
    let (kill, killed) = oneshot::channel();
    if let Some(stdout) = child.stdout.take() {
        tokio::spawn(each_line(stdout, move |line| drop(line_to.send(line))));
    }
    let kept = Arc::clone(&errors);
    let stderr = child.stderr.take().map(|stderr| {
        tokio::spawn(each_line(stderr, move |line| {
            let mut kept = kept.lock().unwrap_or_else(PoisonError::into_inner);
            if kept.len() < KEPT_LINES && !line.is_empty() {
                kept.push(line);
            }
        }))
    });
    let told = Arc::clone(&fate);
    tokio::spawn(async move {
        let status = watch(child, killed).await;
        // Standard error ends with the process; what it said belongs to how it ended.
        if let Some(reader) = stderr {
            let _ = tokio::time::timeout(Duration::from_millis(200), reader).await;
        }
        *told.0.lock().unwrap_or_else(PoisonError::into_inner) = status.ok();
        told.1.notify_all();
    });
    Ok(Process { name, id, fate, errors, lines, kill: Some(kill) })
}

/// Waits for the child, and kills it as soon as its [`Process`] is dropped.
async fn watch(mut child: Child, killed: oneshot::Receiver<()>) -> io::Result<ExitStatus> {
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
