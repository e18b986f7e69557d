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
        let present_s = search::cost_s(&law, Vec::new(), f64::INFINITY)?;
        println!(
            "# {name}: {present_s:.3} s with the constants of its scenario; {} evaluations",
            search::EVALUATIONS
        );
        if law.tuned.is_empty() {
            println!("# {name} has no ranges: its constants are not searched");
            continue;
        }
        let best =
            search::best(&law, |evaluation, point| println!("# {evaluation:4} {:8.3} s", point.cost_s))?;
        for (tuned, value) in law.tuned.iter().zip(&best.values) {
            let [low, high] = tuned.range;
            println!("{} = {value:?} # {low:?} to {high:?}", tuned.name);
        }
    }
    Ok(())
}
