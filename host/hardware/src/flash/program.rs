//! A program of another project: run with a limit of time, its output kept for an error message and never printed raw.

use std::ffi::OsString;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::process::{Child, ExitStatus, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use lashloop_bench::supervisor::{Program, Supervisor, find_program};
use lashloop_session::printable;
use rustix::process::{Pid, Signal, kill_process_group};

use lashloop::rig::way::Way;

/// Time between two looks at a running program.
const INTERVAL: Duration = Duration::from_millis(10);
/// Bytes of output that are kept, from the end.
const KEPT: u64 = 1 << 16;
/// Lines of output in an error message, from the end.
const QUOTED_LINES: usize = 3;

/// Why a program has no result.
#[derive(Debug, thiserror::Error)]
pub enum ProgramError {
    #[error("{} is not installed: install {}", way.program(), way.package())]
    NotInstalled { way: Way },
    #[error("{program} can't be started: {source}")]
    Start { program: &'static str, source: io::Error },
    #[error("{program} failed, {status}{}", quoted(output))]
    Failed { program: &'static str, status: ExitStatus, output: String },
    #[error("{program} took more than {} s and was stopped{}", limit.as_secs(), quoted(output))]
    TimedOut { program: &'static str, limit: Duration, output: String },
    #[error("{program} was stopped, because this program was interrupted")]
    Interrupted { program: &'static str },
}

fn quoted(output: &str) -> String {
    let lines: Vec<_> = output.split(['\n', '\r']).map(str::trim).filter(|line| !line.is_empty()).collect();
    let last = &lines[lines.len().saturating_sub(QUOTED_LINES)..];
    if last.is_empty() { String::new() } else { format!(", output \"{}\"", printable(&last.join("; "))) }
}

/// Runs the programs of the ways.
pub struct Runner<'a> {
    /// Ends a running program with this one, however this one ends: nothing writes the flash then, and another call may.
    pub supervisor: &'a Supervisor,
}

impl Runner<'_> {
    /// Runs the program of a way to its end and returns its output.
    ///
    /// # Errors
    /// The program is missing, fails, exceeds the limit or is interrupted; it no longer runs then.
    pub fn run(
        &self,
        way: Way,
        arguments: impl IntoIterator<Item = impl Into<OsString>>,
        limit: Duration,
    ) -> Result<String, ProgramError> {
        let program = way.program();
        let path = find_program(program).map_err(|_| ProgramError::NotInstalled { way })?;
        let arguments = arguments.into_iter().map(Into::into).collect();
        let of_user = Program { name: program, program: path.into(), arguments, core: None };
        let start = |source| ProgramError::Start { program, source };
        let mut transcript = tempfile::tempfile().map_err(start)?;
        let mut command = self.supervisor.command_of_user(&of_user);
        command.stdin(Stdio::null());
        command.stdout(transcript.try_clone().map_err(start)?).stderr(transcript.try_clone().map_err(start)?);
        // Plain text. Its group is its own: Ctrl-C reaches this program alone, which then stops the group.
        let mut child = command.env("NO_COLOR", "1").env("TERM", "dumb").spawn().map_err(start)?;
        let deadline = Instant::now() + limit;
        loop {
            if let Some(status) = child.try_wait().map_err(start)? {
                let output = read(&mut transcript).map_err(start)?;
                return if status.success() {
                    Ok(output)
                } else {
                    Err(ProgramError::Failed { program, status, output })
                };
            }
            if self.supervisor.interrupted() {
                stop(&mut child);
                return Err(ProgramError::Interrupted { program });
            }
            if Instant::now() >= deadline {
                stop(&mut child);
                let output = read(&mut transcript).unwrap_or_default();
                return Err(ProgramError::TimedOut { program, limit, output });
            }
            thread::sleep(INTERVAL);
        }
    }
}

fn read(transcript: &mut File) -> io::Result<String> {
    let length = transcript.metadata()?.len();
    transcript.seek(SeekFrom::Start(length.saturating_sub(KEPT)))?;
    let mut bytes = Vec::new();
    transcript.read_to_end(&mut bytes)?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// Stops a program and its descendants.
fn stop(child: &mut Child) {
    let group = i32::try_from(child.id()).ok().and_then(Pid::from_raw);
    if let Some(group) = group {
        // Fails only for a group that has ended.
        let _ = kill_process_group(group, Signal::KILL);
    }
    let _ = child.wait();
}
