//! What was run, and the commands that repeat it.

use maud::{Markup, html};

use super::super::part::command::copied;
use super::input::CampaignResults;

pub(in super::super) fn section(results: &CampaignResults<'_>) -> Markup {
    let facts = results.facts;
    html! {
        section #origin {
            h2 { "What was run" }
            dl.origin {
                @for (at, source) in facts.sources.iter().enumerate() {
                    dt { @if at == 0 { "campaign file" } @else { "scenario" } }
                    dd { code { (source.path) } br; code.hash { (source.sha256()) } }
                }
                dt { "seed" } dd { (facts.seed) }
                dt { "cases" } dd { (facts.cases) }
                dt { "selection" } dd { @let options = facts.selection.options();
                    @if options.is_empty() { "all of the file" } @else { code { (options.join(" ")) } } }
                dt { "device" } dd { code { (facts.device) } }
                dt { "drive" } dd { code.hash { (facts.drive) } }
                dt { "lashloop" } dd { (facts.lashloop) br; code.hash { (facts.program_sha256) } }
            }
        }
    }
}

pub(in super::super) fn repeat(results: &CampaignResults<'_>) -> Markup {
    let (facts, folder) = (results.facts, results.folder.display().to_string());
    let file = facts.sources.first().map_or("", |source| source.path.as_str());
    let words = |words: &[&str]| words.iter().map(|word| (*word).to_owned()).collect::<Vec<_>>();
    let mut run = words(&["lashloop", "campaign", "run", file, "--device", &facts.device]);
    run.extend(facts.selection.options());
    run.extend(words(&["--out", &format!("{folder}-again")]));
    html! {
        section #repeat {
            h2 { "Run it again" }
            h3 { "All cases" }
            (copied(&run))
            h3 { "One row, with a record" }
            (copied(&words(&["lashloop", "campaign", "rerun", &folder, "--case", "0", "--out", &format!("{folder}/case-0")])))
            p.note { "A case is a function of campaign file, seed and number: the torques of a row are compared with its digest in results.csv." }
        }
    }
}
