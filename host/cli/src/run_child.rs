//! `lashloop tied`: runs another program that ends with the bench, however the bench ends.
//!
//! A program of one process replaces this one, and the kernel kills it with the bench. A command of the user may start any
//! number of processes, and the kernel ties only one to its parent. So this process stays as their guard: it waits for the
//! end of the bench and of the command, and kills their process group. A process that leaves the group escapes.

use std::convert::Infallible;
use std::ffi::OsString;
use std::os::fd::AsFd;
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::process::{Command, ExitStatus};
use std::{fs, io, process};

use clap::Args;
use lashloop_bench::verdict::Exit;
use rustix::event::{PollFd, PollFlags, poll};
use rustix::process::{
    Pid, PidfdFlags, Resource, Rlimit, Signal, getpgrp, getpid, kill_process, kill_process_group, pidfd_open,
    set_parent_process_death_signal, setpgid, setrlimit,
};
use rustix::stdio::{dup2_stdin, dup2_stdout};
use rustix::thread::{CpuSet, sched_setaffinity};

use super::error::{CliError, system};

#[derive(Args)]
pub(crate) struct Arguments {
    /// Core of the program, from 0
    #[arg(long)]
    core: Option<usize>,

    /// Process number of the bench: stay as the guard of a program with descendants
    #[arg(long, value_name = "PID")]
    guard: Option<i32>,

    /// Program and its arguments
    #[arg(required = true, last = true)]
    program: Vec<OsString>,
}

impl Arguments {
    pub(crate) fn run(self) -> Result<Exit, CliError> {
        if let Some(core) = self.core {
            let mut cores = CpuSet::new();
            cores.set(core);
            sched_setaffinity(None, &cores).map_err(system("keep to one core"))?;
        }
        let (program, arguments) = self.program.split_first().expect("clap requires a program");
        let mut command = Command::new(program);
        command.args(arguments);
        let failed = |source| CliError::System { what: "run the program", source };
        match self.guard.map(Pid::from_raw) {
            Some(bench) => match guard(bench, &mut command).map_err(failed)? {},
            None => {
                // A hung emulator ignores every other signal.
                set_parent_process_death_signal(Some(Signal::KILL))
                    .map_err(system("tie a program to the bench"))?;
                Err(failed(command.exec()))
            }
        }
    }
}

/// Runs the program and ends as it ends. If the bench ends first, kills the process group, this process included.
fn guard(bench: Option<Pid>, command: &mut Command) -> io::Result<Infallible> {
    let bench = bench.ok_or(io::ErrorKind::InvalidInput)?;
    // Without a process of this number the bench has ended already.
    let bench = pidfd_open(bench, PidfdFlags::empty())?;
    let mut child = command.spawn()?;
    let child_fd = pidfd_open(Pid::from_child(&child), PidfdFlags::empty())?;
    // The ends of the line belong to the program alone: once it closes them, the bench sees the end of the line.
    let null = fs::File::options().read(true).write(true).open("/dev/null")?;
    dup2_stdin(&null)?;
    dup2_stdout(&null)?;
    let has_ended = |fd: &dyn AsFd| -> io::Result<bool> {
        let mut fds = [PollFd::from_borrowed_fd(fd.as_fd(), PollFlags::IN)];
        Ok(poll(&mut fds, Some(&Default::default()))? > 0)
    };
    loop {
        let mut fds = [PollFd::new(&bench, PollFlags::IN), PollFd::new(&child_fd, PollFlags::IN)];
        match poll(&mut fds, None) {
            Ok(_) | Err(rustix::io::Errno::INTR) => {}
            Err(error) => return Err(error.into()),
        }
        if has_ended(&bench)? {
            kill_process_group(getpgrp(), Signal::KILL)?;
        }
        if has_ended(&child_fd)? {
            let status = child.wait()?;
            // The rest of the group ends first. The bench may be ending too, so this can't be left to it. This process moves to
            // the group of a program that does nothing: that of the bench may lie outside a container, without a number here.
            // If it can't move, it ends with its own group.
            let group = getpgrp();
            let refuge = Command::new("/proc/self/exe").arg("--version").process_group(0).spawn();
            let _ = refuge.map(|refuge| setpgid(None, Some(Pid::from_child(&refuge))));
            kill_process_group(group, Signal::KILL).or_else(|error| match error {
                rustix::io::Errno::SRCH => Ok(()),
                other => Err(other),
            })?;
            end_as(status);
        }
    }
}

/// Ends this process with the exit code or by the signal of another one.
fn end_as(status: ExitStatus) -> ! {
    if let Some(signal) = status.signal().and_then(Signal::from_named_raw) {
        // The program has dumped its core; this one is of no interest.
        let _ = setrlimit(Resource::Core, Rlimit { current: Some(0), maximum: Some(0) });
        // Twice: the first one may meet a handler of the runtime, which removes itself.
        for _ in 0..2 {
            let _ = kill_process(getpid(), signal);
        }
    }
    process::exit(status.code().unwrap_or_else(|| 128 + status.signal().unwrap_or(0)))
}
