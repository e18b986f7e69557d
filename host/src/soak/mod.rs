//! Runs over and over, with more and more going wrong: does the bench hold out, and does it judge rightly?
//!
//! | module | is |
//! |---|---|
//! | [`plan`] | the scenario of each run: faults that rise from level to level, drawn from the seed |
//! | [`judge`] | the verdict of each run, judged once more, and what nobody counted |
//! | [`growth`] | memory and descriptors of a process, and how much more they may become |
//! | [`tally`] | what came of all runs |

pub mod judge;
pub mod plan;
pub mod resource_usage;
pub mod tally;

/// A scenario of a second, with these faults.
#[cfg(test)]
fn scenario_with(faults: &[&str]) -> lashloop_bench::scenario::Scenario {
    let mut text =
        include_str!("../../../scenarios/shaft-pd.toml").replace("duration_s = 25.0", "duration_s = 1.0");
    for fault in faults {
        text += &format!("\n[[fault]]\n{fault}\n");
    }
    lashloop_bench::scenario::Scenario::from_str("x.toml", &text, &[])
        .unwrap_or_else(|errors| panic!("{errors}"))
}
