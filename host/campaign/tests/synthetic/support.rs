//! A campaign with synthetic results.

use std::num::NonZeroUsize;
use std::path::Path;

use lashloop_bench::scenario::plant::standard;
use lashloop_bench::supervisor::Supervisor;
use lashloop_campaign::cell::{Cell, Missing};
use lashloop_campaign::engine::{Progress, ShardRun};
use lashloop_campaign::facts::{Facts, Program};
use lashloop_campaign::row::CaseResult;
use lashloop_campaign::shard::Shard;
use lashloop_campaign::shard_file::Start;
use lashloop_campaign::{Campaign, CampaignError, Selection, Source};
use lashloop_plant::metrics::Metric;

const SCENARIO: &str = include_str!("../../../../scenarios/shaft-pd.toml");

/// A campaign of two variants on 11 random points and a grid of 2 x 3.
pub(crate) const PARTS: &str = r#"
    [[part]]
    name = "random"
    method = "random"
    points = 11
    [[part.axis]]
    key = "plant.dead_zone_rad"
    min = 0.1
    max = 0.2
    [[part]]
    name = "grid"
    [[part.axis]]
    key = "plant.torque_delay_us"
    values = [0, 1000]
    [[part.axis]]
    key = "plant.dead_zone_rad"
    min = 0.1
    max = 0.2
    points = 3
"#;

pub(crate) const TWO_VARIANTS: &str =
    "[[variant]]\nname = \"pd\"\n[[variant]]\nname = \"stiff\"\nset = [\"plant.stiffness_nm_rad=2\"]\n";

pub(crate) fn read(parts: &str) -> Result<Campaign, CampaignError> {
    let text = format!(
        "title = \"synthetic\"\nscenario = \"pd.toml\"\nseed = 1\nset = [\"meant=mismatch\"]\n{parts}"
    );
    let source = |path: &str, text: String| Source { path: path.to_owned(), text };
    let sources = vec![source("c.toml", text), source("pd.toml", SCENARIO.to_owned())];
    Campaign::from_sources(sources, Selection::default(), &standard())
}

pub(crate) fn campaign() -> Campaign {
    read(&format!("{TWO_VARIANTS}{PARTS}")).expect("a campaign")
}

pub(crate) fn facts(campaign: &Campaign, shards: u32) -> Facts {
    let text = |text: &str| text.to_owned();
    let program =
        Program { lashloop: text("1"), sha256: text("aa"), device: text("inproc"), drive: text("bb") };
    Facts::new(campaign, program, shards)
}

/// The result of a case; every seventh fails, every fifth never settles.
pub(crate) fn result(case: u64) -> CaseResult {
    let cell = |metric: Metric| match metric {
        Metric::SettleTime if case.is_multiple_of(5) => Cell::Missing(Missing::Never),
        Metric::SettleTime | Metric::StaticError => {
            Cell::Value((case.wrapping_mul(7919) % 1009) as f64 / 1009.0 - 0.25)
        }
        _ => Cell::Missing(Missing::Unmeasured),
    };
    CaseResult {
        cells: Metric::ALL.iter().map(|metric| cell(*metric)).collect(),
        verdict: if case.is_multiple_of(7) { "FAIL" } else { "PASS" }.to_owned(),
        end: "complete, \"as planned\"".to_owned(),
        torque_sha256: format!("{case:064x}"),
    }
}

/// Runs a shard with synthetic results, each after `before`.
pub(crate) fn run(
    campaign: &Campaign,
    facts: &Facts,
    folder: &Path,
    shard: Shard,
    start: Start,
    before: impl Fn(u64) -> Result<(), CampaignError> + Sync,
) -> Result<Progress, CampaignError> {
    let supervisor = Supervisor::without_signals(None).expect("a supervisor");
    let jobs = NonZeroUsize::new(2).expect("a number");
    ShardRun { campaign, facts, folder, shard, start, jobs }.run(
        &supervisor,
        |number, _| {
            before(number)?;
            Ok(Some((campaign.case(number)?, result(number))))
        },
        |_| {},
    )
}

/// Runs all shards of a campaign.
pub(crate) fn run_all(campaign: &Campaign, folder: &Path, count: u32) {
    let facts = facts(campaign, count);
    for shard in (1..=count).filter_map(|number| Shard::new(number, count)) {
        run(campaign, &facts, folder, shard, Start::New, |_| Ok(())).expect("a shard");
    }
}
