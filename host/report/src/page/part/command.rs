//! A command with a button that copies it.

use maud::{Markup, html};

pub(in super::super) fn copied(command: &str) -> Markup {
    html! {
        div.command { code { (command) } button type="button" data-copy=(command) { "Copy" } }
    }
}
