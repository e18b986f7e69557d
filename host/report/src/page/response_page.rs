//! The page of a frequency response.

use maud::{PreEscaped, html};

use super::part::command;
use super::shell::{Link, document};

const LINKS: [Link; 3] = [("result", "Result"), ("plots", "Plots"), ("origin", "Origin")];

/// A frequency response as a self-contained HTML document. `result` is what the command printed, `svg` the figure of the plot crate,
/// and `words` are the command that repeats the measurement.
#[must_use]
pub fn response(title: &str, result: &str, svg: &str, words: &[String]) -> String {
    let content = html! {
        section #result {
            h1 { (title) }
            pre { (result) }
        }
        section #plots {
            h2 { "Plots" }
            div.scroll { (PreEscaped(svg)) }
        }
        section #origin {
            h2 { "Origin" }
            (command::copied(words))
        }
    };
    document(title, &LINKS, None, &content)
}
