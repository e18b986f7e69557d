//! Records as self-contained HTML: one run, a comparison of several, a suite, a campaign.
//!
//! A page is one file that loads nothing: style, scripts and all steps are inside. Text of others, such as a title, is escaped by
//! the templates, and the page's policy permits its own scripts alone.
//!
//! | stage | file | does |
//! |---|---|---|
//! | input | `input` | a record with its name |
//! | judgement | `margin`, `why` | pass, marginal, fail; the verdict in one sentence |
//! | charts | `run_charts`, `chosen_panels`, `annotations`, `data`, `codec` | which charts the signals permit and the user chooses; what is said of the curves; columns as short text |
//! | numbers | `typeset` | numbers and units as a book prints them |
//! | parts | `part`, `campaign` | one section of a page per file |
//! | pages | `run_page`, `comparison_page`, `suite_page`, `campaign_page`, `response_page` | the parts of a page, in their order |
//! | document | `shell`, `assets` | head, policy, style and scripts |

mod annotations;
pub mod assets;
mod campaign;
mod campaign_page;
mod chosen_panels;
mod codec;
mod comparison_page;
mod data;
mod input;
mod margin;
mod part;
mod response_page;
mod run_charts;
mod run_page;
mod shell;
mod suite_page;
#[cfg(test)]
mod tests;
mod typeset;
mod why;

pub use campaign::input::CampaignResults;
pub use campaign_page::campaign;
pub use chosen_panels::Panels;
pub use comparison_page::{comparison, diff};
pub use input::Run;
pub use margin::Margin;
pub use response_page::response;
pub use run_page::run;
pub use suite_page::{Suite, SuiteRow, suite};
