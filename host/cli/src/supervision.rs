//! The supervisor of child processes and signals.

use lashloop_bench::supervisor::Supervisor;

use super::error::{CliError, system};

pub(super) fn start_supervisor() -> Result<Supervisor, CliError> {
    std::env::current_exe().and_then(Supervisor::start).map_err(system("start the supervisor"))
}
