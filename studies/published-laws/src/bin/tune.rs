//! `tune [--hard] LAW...`: searches the constants of laws, with equal effort for each, and prints the improvements and the
//! result as lines of a scenario; with `--hard` for the harder battery, whose values are those of the nominal machine.

use anyhow::{Result, ensure};
use battery::campaign::Battery;
use published_laws::study::laws::Law;
use published_laws::study::search;

fn main() -> Result<()> {
    let (options, names): (Vec<_>, Vec<_>) = std::env::args().skip(1).partition(|word| word == "--hard");
    ensure!(!names.is_empty(), "usage: tune [--hard] LAW...");
    let battery = if options.is_empty() { Battery::Standard } else { Battery::Hard };
    for name in names {
        let law = Law::find(&name)?;
        let present_s = search::cost_s(&law, battery, None, f64::INFINITY)?;
        println!(
            "# {name}: {present_s:.3} s with its present constants; {} evaluations",
            search::EVALUATIONS
        );
        if law.tuned.is_empty() {
            println!("# {name} has no ranges: its constants are not searched");
            continue;
        }
        let best = search::best(&law, battery, |evaluation, point| {
            println!("# {evaluation:4} {:8.3} s", point.cost_s);
        })?;
        for (tuned, value) in law.searched(battery).iter().zip(&best.values) {
            let [low, high] = tuned.range;
            println!("{} = {value:?} # {low:?} to {high:?}", tuned.name);
        }
    }
    Ok(())
}
