//! Cases whose settings permit no run.

use std::num::NonZeroUsize;

use lashloop_bench::device::DeviceChoice;
use lashloop_bench::device::kinds::in_process::InProcessDrive;
use lashloop_bench::supervisor::Supervisor;
use lashloop_campaign::engine::ShardRun;
use lashloop_campaign::evidence;
use lashloop_campaign::merge::{RESULTS, merge};
use lashloop_campaign::run::run_case;
use lashloop_campaign::shard::Shard;
use lashloop_campaign::shard_file::Start;
use lashloop_campaign::table::Table;
use lashloop_campaign::view::View;
use lashloop_firmware::Laws;
use tempfile::tempdir;

use crate::support::{facts, read};

/// Each value alone is right; 20 rad is a large angle only without gears.
const PARTS: &str = r#"
    [[variant]]
    name = "pd"
    set = ["run.duration_s=0.02", "expect=[]", "meant=[\"mismatch\", \"start\"]"]
    [[part]]
    name = "turned"
    [[part.axis]]
    key = "plant.initial.motor_position_rad"
    values = [0, 20]
    [[part.axis]]
    key = "plant.reduction_ratio"
    values = [5, 1]
    [[expect]]
    pass = 0.0
"#;

#[test]
fn combination_that_permits_no_run_is_an_invalid_row_with_its_reason() {
    let (campaign, folder) = (read(PARTS).expect("a campaign"), tempdir().expect("a folder"));
    let device: DeviceChoice = InProcessDrive::<Laws>::default().into();
    let supervisor = Supervisor::without_signals(None).expect("a supervisor");
    let (facts, shard, start, jobs) = (facts(&campaign, 1), Shard::WHOLE, Start::New, NonZeroUsize::MIN);
    let run = ShardRun { campaign: &campaign, facts: &facts, folder: folder.path(), shard, start, jobs };
    let done = run.run(&supervisor, |case, stop| run_case(&campaign, &device, case, stop), |_| {});
    assert_eq!(done.expect("a shard").rows, 4);
    merge(folder.path()).expect("a table");
    let path = folder.path().join(RESULTS);
    let table = Table::new(&campaign, &path);
    let report = View::new(&table).expect("a report").report;
    assert_eq!((report.groups[0].invalid, report.no_run.cases), (1, 1));
    let text = report.to_string();
    assert!(text.contains("1 case INVALID without a run; the first:\ncase 3: "), "{text}");
    assert!(text.contains("plant.initial.motor_position_rad"), "{text}");
    assert!(evidence::picks(&table).expect("picks").iter().all(|pick| pick.case != 3));
}
