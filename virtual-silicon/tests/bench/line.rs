//! Bytes that the serial port loses.

use std::time::Duration;

use lashloop_protocol::DriveMessage;
use lashloop_protocol::enums::State;
use lashloop_protocol::frame::DELIMITER;
use lashloop_protocol::message::{DescribeLaw, Stop};

use crate::bench::{OF_EACH_FAMILY, image_of};
use crate::failures::{failing, masking_interrupts, place};
use crate::host::{Host, SESSION};

/// The port drops a byte that arrived with other bits than it was sent with: among delimiters it would be a damaged frame.
#[test]
fn bytes_with_an_error_are_counted_and_not_taken() {
    for board in OF_EACH_FAMILY {
        let mut host = Host::at(&image_of(board), (0, 0));
        assert_eq!(host.shake_hands(SESSION).state, State::Idle, "{board}");
        host.bench.act(|chip, _| {
            chip.garble_line(true);
            chip.serial_line().send(&[DELIMITER; 40]);
        });
        host.bench.advance(Duration::from_millis(10));
        host.bench.act(|chip, _| {
            chip.garble_line(false);
            chip.serial_line().send(&[DELIMITER]);
        });
        let report = host.exchange(Stop {}, |message| match message {
            DriveMessage::LineReport(report) => Some(*report),
            _ => None,
        });
        assert_eq!((report.overruns, report.damaged), (40, 0), "{board}: {report:?}");
    }
}

#[test]
fn bytes_that_the_port_loses_are_counted_and_the_next_ones_arrive() {
    for board in OF_EACH_FAMILY {
        let mut host = Host::at(&failing(&image_of(board)), (0, 0));
        place(&mut host, &masking_interrupts());
        host.send(DescribeLaw { index: 0 });
        // Frames without a byte.
        host.bench.act(|chip, _| chip.serial_line().send(&[DELIMITER; 60]));
        host.bench.advance(Duration::from_millis(10));
        assert_eq!(host.shake_hands(SESSION).state, State::Idle, "{board}");
        let report = host.exchange(Stop {}, |message| match message {
            DriveMessage::LineReport(report) => Some(*report),
            _ => None,
        });
        assert!(report.overruns > 0 && report.damaged == 0, "{board}: {report:?}");
    }
}
