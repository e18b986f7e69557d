//! The document around the parts of a page.

use lashloop_bench::run::digest::sha256;
use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::assets::{CHARTS, REPORT, STYLE};
use super::data::Data;

/// A section that the head links to: its id and name.
pub(super) type Link = (&'static str, &'static str);

/// One self-contained document. It loads nothing: its policy permits its own style and its own scripts alone.
pub(super) fn document(title: &str, links: &[Link], data: Option<&Data>, content: &Markup) -> String {
    let data = data.map_or_else(|| "null".to_owned(), json);
    // Text of others is in the hashed part, so it can't contain the value that permits a script.
    let nonce = sha256(format!("{title}{data}{}", content.0).as_bytes());
    let policy = format!(
        "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'nonce-{nonce}'; base-uri 'none'; form-action 'none'"
    );
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta http-equiv="Content-Security-Policy" content=(policy);
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                meta name="generator" content=(concat!("lashloop ", env!("CARGO_PKG_VERSION")));
                title { (title) }
                link rel="icon" href="data:,";
                style { (PreEscaped(STYLE)) }
            }
            body {
                header.masthead {
                    p.brand { "Lashloop" }
                    nav aria-label="Sections" { @for (id, name) in links { a href={ "#" (id) } { (name) } } }
                    button.theme type="button" hidden { "Dark" }
                }
                main { (content) }
                footer { p { "Made by lashloop " (env!("CARGO_PKG_VERSION")) ". This file loads nothing from a network." } }
                script type="application/json" id="data" { (PreEscaped(data)) }
                script nonce=(nonce) { (PreEscaped(CHARTS)) (PreEscaped(REPORT)) }
            }
        }
    }
    .into_string()
}

/// JSON that a script element may contain.
fn json(data: &Data) -> String {
    let text = serde_json::to_string(data).unwrap_or_else(|_| "null".to_owned());
    text.replace('<', "\\u003c")
}
