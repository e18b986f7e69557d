//! The table of the drive's parameters.

use lashloop_firmware::drive::parameters::TABLE;

use crate::markdown::{section, table};

#[test]
fn the_parameter_table_matches_the_drive() {
    let rows = table(section("## 14. Parameters of the Lashloop drive"), "index");
    assert_eq!(rows.len(), TABLE.len());
    for (index, (row, entry)) in rows.iter().zip(TABLE).enumerate() {
        let want = [
            index.to_string(),
            entry.name.to_owned(),
            entry.unit.to_owned(),
            format!("{:?}", entry.default.ty()),
            entry.default.to_string(),
            entry.min.to_string(),
            entry.max.to_string(),
            if entry.live { "yes" } else { "" }.to_owned(),
        ];
        assert_eq!(row[..8], want);
        assert!(!row[8].is_empty(), "{} has a meaning", entry.name);
    }
}

#[test]
fn the_drive_has_every_parameter_that_the_bench_sets() {
    let text = section("## 9. Parameters");
    for name in [
        "controller",
        "period_us",
        "motor_counts_per_rev",
        "load_counts_per_rev",
        "telemetry_every",
        "watchdog_us",
    ] {
        assert!(text.contains(&format!("`{name}`")), "the document names {name}");
        assert!(TABLE.iter().any(|entry| entry.name == name), "the drive has {name}");
    }
}
