//! `table [--hard] [LAW...]`: the comparison of the laws, in Markdown: the nominal plant, and 200 random plants of each test
//! seed; with `--hard` 100 random plants of each of two parts of the harder battery. No constant of any law was chosen by
//! these seeds.

use anyhow::Result;
use published_laws::study::case::{HARD_PARTS, Plant, figures_on, hard_plants};
use published_laws::study::laws::{LAWS, Law};
use published_laws::study::table::{Column, HARD, ORDINARY, Row, markdown};

const TEST_SEEDS: [u64; 3] = [11, 12, 13];
const PLANTS: u32 = 200;

fn main() -> Result<()> {
    let (options, names): (Vec<_>, Vec<_>) = std::env::args().skip(1).partition(|word| word == "--hard");
    let laws: Vec<Law> = names.iter().map(|name| Law::find(name)).collect::<Result<_>>()?;
    let laws = if laws.is_empty() { LAWS.to_vec() } else { laws };
    if options.is_empty() {
        println!("Nominal plant\n\n{}", table(ORDINARY, &laws, &[Plant::Nominal])?);
        for seed in TEST_SEEDS {
            let plants: Vec<_> = (0..PLANTS).map(|index| Plant::Random { seed, index }).collect();
            let table = table(ORDINARY, &laws, &plants)?;
            println!("{PLANTS} plants of seed {seed}: 95 % quantile / maximum\n\n{table}");
        }
    } else {
        for part in HARD_PARTS {
            let table = table(HARD, &laws, &hard_plants(part))?;
            println!("Part {part}: 95 % quantile / maximum\n\n{table}");
        }
    }
    Ok(())
}

fn table(columns: &[Column], laws: &[Law], plants: &[Plant]) -> Result<String> {
    let row = |law: &Law| Ok(Row { law: *law, figures: figures_on(law, plants)? });
    Ok(markdown(columns, &laws.iter().map(row).collect::<Result<Vec<_>>>()?))
}
