//! `lashloop device`: the native twin, for a bench in another shell.

use std::io::{self, IsTerminal, Write};

use clap::Args;
use lashloop::Bench;
use lashloop_bench::device::twin::Twin;
use lashloop_bench::verdict::Exit;

use super::error::{CliError, system};

/// Run a drive on a pseudo-terminal until killed.
///
/// Prints the terminal's path on standard output. Reach it from another shell with
/// `lashloop run SCENARIO --device PATH`.
#[derive(Args)]
pub(crate) struct Arguments {}

impl Arguments {
    pub(crate) fn run(self, bench: &Bench) -> Result<Exit, CliError> {
        let twin = Twin::open().map_err(system("open a pseudo-terminal"))?;
        let path = twin.terminal.path.display();
        let mut stdout = io::stdout();
        // Flushed, because the parent process waits for the line.
        writeln!(stdout, "{path}").and_then(|()| stdout.flush()).map_err(system("print the path"))?;
        if io::stderr().is_terminal() {
            let hint =
                "The drive serves this terminal. In another shell: lashloop run SCENARIO.toml --device";
            super::output::error_line(format_args!("{hint} {path}"));
        }
        twin.end_at_panics().map_err(system("share the pseudo-terminal"))?;
        bench.serve(&twin).map_err(system("serve the drive any longer"))?;
        Ok(Exit::Pass)
    }
}
