//! Writes the page and the JSON Schema of all keys of a scenario, `docs/scenarios.md` and `docs/scenario.schema.json`.

use std::fs;
use std::io;
use std::path::Path;

use lashloop_bench::scenario::Scenario;

fn main() -> io::Result<()> {
    let documents = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs");
    let keys = Scenario::keys();
    fs::write(documents.join("scenarios.md"), keys.to_markdown())?;
    fs::write(documents.join("scenario.schema.json"), format!("{:#}\n", keys.to_json_schema()))
}
