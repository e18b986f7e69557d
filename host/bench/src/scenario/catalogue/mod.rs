//! Every key of a scenario, found out from the reader itself, and printed as a page and as a JSON Schema.
//!
//! The reader declares a key where it reads it. We read probe documents that make every choice once, and compare which keys
//! each choice declares. A key is therefore listed with its unit, range, default and conditions as soon as it is read; this
//! holds for the keys of any registered plant too.
//!
//! | module | is |
//! |---|---|
//! | `collector` | probe documents, and the comparison of their keys |
//! | `page` | the keys as Markdown: `docs/scenarios.md` |
//! | `json_schema` | the keys as JSON Schema: `docs/scenario.schema.json` |

mod collector;
mod json_schema;
mod page;

pub(super) use collector::Catalogue;
