//! `tune LAW...`: searches the constants of laws, with equal effort for each, and prints the improvements and the result as
//! lines of a scenario.

use anyhow::{Result, ensure};
use published_laws::study::laws::Law;
use published_laws::study::search;

fn main() -> Result<()> {
    let names: Vec<String> = std::env::args().skip(1).collect();
    ensure!(!names.is_empty(), "usage: tune LAW...");
    for name in names {
        let law = Law::find(&name)?;
        ensure!(!law.tuned.is_empty(), "{name} has no ranges: its constants are not searched");
        println!("# {name}: {} evaluations", search::EVALUATIONS);
        let best =
            search::best(&law, |evaluation, point| println!("# {evaluation:4} {:8.3} s", point.cost_s))?;
        for (tuned, value) in law.tuned.iter().zip(&best.values) {
            let [low, high] = tuned.range;
            println!("{} = {value:?} # {low:?} to {high:?}", tuned.name);
        }
    }
    Ok(())
}
