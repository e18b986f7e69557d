//! Standard output and standard error, whatever they are connected to.

use std::fmt::Arguments;
use std::io::{self, ErrorKind, Write};
use std::process;

use lashloop_bench::verdict::Exit;

/// Prints a line on standard output. A reader that has gone away (`| head`) is no reason to fail a run; an output that
/// can't be written otherwise is (`> /dev/full`), for the user believes that it was.
pub(super) fn line(text: Arguments<'_>) {
    if let Err(error) = writeln!(io::stdout(), "{text}")
        && error.kind() != ErrorKind::BrokenPipe
    {
        error_line(format_args!("lashloop: standard output can't be written: {error}"));
        process::exit(Exit::UsageOrScenario as i32);
    }
}

/// Prints a line on standard error; where that is gone too there is nobody left to tell.
pub(super) fn error_line(text: Arguments<'_>) {
    let _ = writeln!(io::stderr(), "{text}");
}
