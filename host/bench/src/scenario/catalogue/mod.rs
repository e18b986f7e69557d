//! Every key of a file of settings, printed as a page and as a JSON Schema.
//!
//! | module | is |
//! |---|---|
//! | `page` | the keys as Markdown: `docs/scenarios.md` |
//! | `json_schema` | the keys as JSON Schema: `docs/scenario.schema.json` |

mod json_schema;
mod page;
