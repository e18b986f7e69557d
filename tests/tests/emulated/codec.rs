//! The codec takes a small part of a control period on the drive's processor.

use lashloop_hardware::flash::Image;
use lashloop_hardware::flash::image::ImageProblem;

use crate::codec_cost::count;

/// Largest number of instructions to encode or decode a message. A control period of 1 ms has 168,000 cycles.
const LIMIT: u32 = 700;

pub(crate) fn every_message() {
    let image = tests::workspace().join("target/codec-cost.elf");
    let costs = count(&image);
    // Otherwise the counter does not count instructions.
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
        // Each byte takes at least a load, a check and a store.
        let fewest = 3 * cost.frame_bytes;
        assert!(
            (fewest..=LIMIT).contains(&cost.encode) && (fewest..=LIMIT).contains(&cost.decode),
            "{cost:?}"
        );
    }
    assert_eq!(count(&image), costs, "the same in every run");
    let problem = Image::read(&image).expect_err("a program for measurements").problem;
    assert!(matches!(problem, ImageProblem::NoDrive), "{problem}");
}
