//! A million damaged frames. `cargo run --release -p tests --example undetected_errors` tries more.

use crate::undetected_errors::{Damage, Table, run};

#[test]
fn no_damaged_frame_of_a_million_becomes_a_message() {
    let tallies = run(1_000_000, 1);
    for (damage, tally) in &tallies {
        assert_eq!(tally.wrong, 0, "{damage:?}\n{}", Table(&tallies));
        assert!(
            tally.framing + tally.up_to_the_crc() > tally.frames / 2,
            "{damage:?} does damage: {tally:?}"
        );
    }
    // In random bodies half of the CRC agrees by chance, within five standard deviations of the expected count.
    let (_, random) =
        tallies.iter().find(|(damage, _)| *damage == Damage::RandomBody).expect("a tally for each");
    assert_eq!(random.up_to_the_crc(), random.frames, "stuffed random bodies come up to the CRC");
    let expected = random.frames as f64 / 65_536.0;
    let deviation = (random.half_agrees as f64 - expected).abs();
    assert!(deviation < 5.0 * expected.sqrt(), "{} times, {expected:.2} expected", random.half_agrees);
}
