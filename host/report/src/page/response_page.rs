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
            pre.result { (result) }
        }
        section #plots {
            h2 { "Plots" }
            div.scroll.figure { (PreEscaped(svg)) }
        }
        section #origin {
            h2 { "Origin" }
            (command::copied(words))
        }
    };
    document(title, &LINKS, None, &content)
}

#[cfg(test)]
mod tests {
    use super::response;

    #[test]
    fn page_has_the_result_as_text_and_the_figure_as_a_figure() {
        let words = ["lashloop", "bode", "a b.toml"].map(str::to_owned);
        let page = response("a < b", "phase margin <20 deg", "<svg><path/></svg>", &words);
        for want in ["a &lt; b", "phase margin &lt;20 deg", "<svg><path/></svg>", "lashloop bode 'a b.toml'"]
        {
            assert!(page.contains(want), "{want} isn't in {page}");
        }
    }
}
