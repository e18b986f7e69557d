//! The codec on the drive's processor costs little of a control period.

use crate::codec_cost::count;

/// Most instructions for reading or writing a message. A control period of 1 ms is 168,000 cycles.
const LIMIT: u32 = 700;

pub(crate) fn every_message() {
    let image = tests::workspace().join("target/codec-cost.elf");
    let costs = count(&image);
    // Else what is counted is no instructions.
    assert!((2002..=2010).contains(&costs.known_loop), "{costs:?}");
    let names: Vec<_> = costs.messages.iter().map(|cost| (cost.message.as_str(), cost.frame_bytes)).collect();
    let want = [
        ("sample", 19),
        ("sample-zeros", 19),
        ("sample-no-zeros", 19),
        ("torque", 16),
        ("torque-zeros", 16),
        ("torque-no-zeros", 16),
    ];
    assert_eq!(names, want);
    for cost in &costs.messages {
        // Each byte is at least loaded, checked and stored.
        let fewest = 3 * cost.frame_bytes;
        assert!(
            (fewest..=LIMIT).contains(&cost.encode) && (fewest..=LIMIT).contains(&cost.decode),
            "{cost:?}"
        );
    }
    assert_eq!(count(&image), costs, "the same in every run");
}
