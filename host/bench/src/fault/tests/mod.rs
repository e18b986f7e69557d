//! What each fault makes of what passes through it.

mod encoder;
mod motor;
mod plant;
mod schedule;

use crate::scenario::Scenario;

/// A scenario of a second on the bench plant, with these faults.
pub(crate) fn scenario(faults: &[&str]) -> Scenario {
    seeded(1, faults)
}

/// The same with another seed.
pub(crate) fn seeded(seed: u64, faults: &[&str]) -> Scenario {
    let mut text = format!(
        "title = \"faults\"\n[run]\nduration_s = 1.0\nseed = {seed}\n[plant]\nmodel = \"backlash-shaft\"\n\
         [controller]\nname = \"pd\"\n[reference]\nprofile = \"constant\"\nposition_rad = 0.0\n"
    );
    for fault in faults {
        text.push_str("[[fault]]\n");
        text.push_str(fault);
        text.push('\n');
    }
    Scenario::from_str("x.toml", &text, &[]).unwrap_or_else(|errors| panic!("{errors}"))
}
