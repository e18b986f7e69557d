//! Colour on a terminal: the one place that decides.
//!
//! `NO_COLOR`, `CLICOLOR`, `CLICOLOR_FORCE` and `TERM` count, and so does whether the stream is a terminal.

use std::io;

use anstream::{AutoStream, ColorChoice};
use anstyle::{AnsiColor, Style};
use lashloop_bench::verdict::Verdict;

/// A stream of the program.
#[derive(Clone, Copy)]
pub(super) enum Stream {
    Output,
    Error,
}

/// A verdict, or a text that has its colour.
pub(super) fn of_verdict(verdict: Verdict, text: &str, stream: Stream) -> String {
    let choice = match stream {
        Stream::Output => AutoStream::choice(&io::stdout()),
        Stream::Error => AutoStream::choice(&io::stderr()),
    };
    if choice == ColorChoice::Never { text.to_owned() } else { coloured(verdict, text) }
}

fn coloured(verdict: Verdict, text: &str) -> String {
    let colour = match verdict {
        Verdict::Pass => AnsiColor::Green,
        Verdict::Fail => AnsiColor::Red,
        Verdict::Invalid => AnsiColor::Yellow,
    };
    let style = Style::new().bold().fg_color(Some(colour.into()));
    format!("{style}{text}{style:#}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_coloured_text_ends_with_a_reset() {
        assert_eq!(coloured(Verdict::Fail, "FAIL"), "\u{1b}[1m\u{1b}[31mFAIL\u{1b}[0m");
    }
}
