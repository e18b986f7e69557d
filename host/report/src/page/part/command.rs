//! A command with a button that copies it.

use maud::{Markup, html};

pub(in super::super) fn copied(words: &[impl AsRef<str>]) -> Markup {
    let command = joined(words);
    html! {
        div.command { code { (command) } button type="button" data-copy=(command) { "Copy" } }
    }
}

/// The words as a line of a shell.
pub(in super::super) fn joined(words: &[impl AsRef<str>]) -> String {
    let words: Vec<_> = words.iter().map(AsRef::as_ref).collect();
    // No argument of a process has the null character, which alone can't be quoted.
    shlex::try_join(words.iter().copied()).unwrap_or_else(|_| words.join(" "))
}
