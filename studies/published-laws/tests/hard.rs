//! The harder battery: rows of its table are those of `docs/laws.md`.

use std::fs;
use std::path::Path;

use battery::campaign::Battery;
use published_laws::study::case::{figures_on, hard_plants};
use published_laws::study::laws::{LAWS, Law};
use published_laws::study::table::{HARD, Row, markdown};

/// The row of one law, whose runs are cheap: all ten take minutes. Marks need the rows of Lashloop's laws.
#[test]
fn row_of_a_scaled_law_is_that_of_the_document() {
    let law = Law::find("adaptive-inverse").expect("a law");
    let row = Row { figures: figures_on(&law, &hard_plants("random-all")).expect("runs"), law };
    let document = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/laws.md");
    let document = fs::read_to_string(document).expect("the document").replace('*', "");
    for line in markdown(HARD, &[row]).lines() {
        assert!(document.contains(&format!("{line}\n")), "docs/laws.md lacks\n{line}");
    }
}

#[test]
fn constants_are_in_the_searched_range() {
    for law in LAWS.iter().filter(|law| !law.ours && !law.tuned.is_empty()) {
        let searched = law.searched(Battery::Hard);
        assert_eq!(law.hard.len(), searched.len(), "{}", law.name);
        for (tuned, value) in searched.iter().zip(law.hard) {
            let [low, high] = tuned.range;
            assert!((low..=high).contains(value), "{}: {} = {value}", law.name, tuned.name);
        }
    }
}
