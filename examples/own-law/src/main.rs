//! The native twin with the laws of this crate: a drive on a pseudo-terminal, for `lashloop run --device PATH`.

use std::io::{self, Write};

use lashloop_bench::device::twin::Twin;
use own_law::OwnLaws;

fn main() -> io::Result<()> {
    let twin = Twin::open()?;
    let mut stdout = io::stdout();
    // Flushed, because a parent process may wait for the line.
    writeln!(stdout, "{}", twin.terminal.path.display())?;
    stdout.flush()?;
    twin.serve_laws::<OwnLaws>()
}
