//! `lashloop tied`: replaces itself by another program that the system kills when the bench ends.

use std::ffi::OsString;
use std::io;
use std::os::unix::process::CommandExt;
use std::process::Command;

use clap::Args;
use lashloop_bench::verdict::Exit;
use rustix::process::{Signal, set_parent_process_death_signal};
use rustix::thread::{CpuSet, sched_setaffinity};

use super::error::{CliError, system};

#[derive(Args)]
pub(crate) struct Arguments {
    /// Core of the program, from 0
    #[arg(long)]
    core: Option<usize>,

    /// Program and its arguments
    #[arg(required = true, last = true)]
    program: Vec<OsString>,
}

impl Arguments {
    pub(crate) fn run(self) -> Result<Exit, CliError> {
        // A hung emulator ignores every other signal.
        set_parent_process_death_signal(Some(Signal::KILL)).map_err(system("tie a program to the bench"))?;
        if let Some(core) = self.core {
            let mut cores = CpuSet::new();
            cores.set(core);
            sched_setaffinity(None, &cores).map_err(system("keep to one core"))?;
        }
        let source = match self.program.split_first() {
            Some((program, arguments)) => Command::new(program).args(arguments).exec(),
            None => io::ErrorKind::InvalidInput.into(),
        };
        Err(CliError::System { what: "run the program", source })
    }
}
