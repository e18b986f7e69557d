//! `table [LAW...]`: the comparison of the laws, in Markdown: the nominal plant, and 200 random plants of each test seed. No
//! constant of any law was chosen by these seeds.

use anyhow::Result;
use published_laws::study::case::{Plant, figures_on};
use published_laws::study::laws::{LAWS, Law};
use published_laws::study::table::{Row, markdown};

const TEST_SEEDS: [u64; 3] = [11, 12, 13];
const PLANTS: u32 = 200;

fn main() -> Result<()> {
    let names: Vec<String> = std::env::args().skip(1).collect();
    let laws: Vec<Law> = names.iter().map(|name| Law::find(name)).collect::<Result<_>>()?;
    let laws = if laws.is_empty() { LAWS.to_vec() } else { laws };
    println!("Nominal plant\n\n{}", table(&laws, &[Plant::Nominal])?);
    for seed in TEST_SEEDS {
        let plants: Vec<_> = (0..PLANTS).map(|index| Plant::Random { seed, index }).collect();
        println!("{PLANTS} plants of seed {seed}: 95 % quantile / maximum\n\n{}", table(&laws, &plants)?);
    }
    Ok(())
}

fn table(laws: &[Law], plants: &[Plant]) -> Result<String> {
    let row = |law: &Law| Ok(Row { law: *law, figures: figures_on(law, plants, &[])? });
    Ok(markdown(&laws.iter().map(row).collect::<Result<Vec<_>>>()?))
}
