//! The way into the boot loader in ROM, as far as the model goes: it has neither SYSCFG nor the ROM.

use std::time::Duration;

use lashloop_protocol::enums::{Outcome, State};
use lashloop_protocol::message::EnterLoader;

use crate::bench::image;
use crate::host::{Host, SESSION};

/// The register that maps the ROM to address 0.
const MEMORY_REMAP: &str = "0x40013800";

#[test]
fn a_request_resets_the_chip_and_the_next_start_maps_the_rom() {
    let mut host = Host::idle(&image(), &[]);
    assert_eq!(host.command(EnterLoader { session: SESSION }), (Outcome::Accepted, State::Idle));
    let (requested, limit) = (host.bench.now(), Duration::from_millis(40));
    let ended = host.bench.end(requested + limit);
    assert_eq!(ended.resets, 1);
    let report = ended.violations.to_string();
    assert!(report.to_lowercase().contains(MEMORY_REMAP), "{report}");
    let after = ended.device_time - requested;
    assert!((Duration::from_millis(10)..limit).contains(&after), "{after:?}");
}
