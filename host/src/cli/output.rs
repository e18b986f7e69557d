//! Standard output and standard error.

use std::fmt::Arguments;
use std::io::{self, ErrorKind, Write};
use std::process;

use lashloop_bench::verdict::Exit;

/// Prints a formatted line on standard output.
macro_rules! outln {
    ($($text:tt)*) => {
        $crate::cli::output::line(format_args!($($text)*))
    };
}

pub(super) use outln;

/// Prints a line on standard output. A closed pipe (`| head`) does not fail a run. Any other write error ends the program
/// (`> /dev/full`), because the user relies on the output.
pub(super) fn line(text: Arguments<'_>) {
    if let Err(error) = writeln!(io::stdout(), "{text}")
        && error.kind() != ErrorKind::BrokenPipe
    {
        error_line(format_args!("lashloop: standard output can't be written: {error}"));
        process::exit(Exit::UsageOrScenario as i32);
    }
}

/// Prints a line on standard error. Its own write errors have no place to go and are ignored.
pub(super) fn error_line(text: Arguments<'_>) {
    let _ = writeln!(io::stderr(), "{text}");
}
