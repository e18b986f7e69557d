//! The line: resynchronisation after damage, no answer to damaged frames, and their counters.

use lashloop_protocol::frame::DELIMITER;
use lashloop_protocol::message::{GetParameter, LineReport, Stop};
use lashloop_protocol::{DriveMessage, HostMessage, MAX_FRAME, Message};

use super::answers::line_report;
use super::assertion::{RuleResult, equal, expect, names};
use super::check::{Check, check};
use super::client::Client;

/// Longer than any frame, without a delimiter.
const OVERSIZED: [u8; 5 * MAX_FRAME] = [0x55; 5 * MAX_FRAME];

pub(super) fn checks() -> Vec<Check> {
    vec![
        check("R2", "garbage before a frame is discarded", |client| {
            let garbage = [b"noise\0more noise\0", &*request(0)].concat();
            answered(client, &garbage, &[0])?;
            // Without a delimiter the garbage corrupts the frame that follows, but not the next.
            answered(client, &[b"noise", &*request(0), &*request(1)].concat(), &[1])
        }),
        check("R2", "a frame with a flipped bit is not answered", flipped_bits),
        check("R2", "a truncated frame is not answered, and the next one is", |client| {
            let whole = request(0);
            (1..whole.len() - 1).try_for_each(|length| {
                answered(client, &[&whole[..length], &[DELIMITER], &*request(1)].concat(), &[1])
            })
        }),
        check("R2", "an oversized frame is discarded, and the next one is answered", |client| {
            answered(client, &[&OVERSIZED[..], &[DELIMITER], &*request(0)].concat(), &[0])
        }),
        check("R2", "a frame without its delimiter corrupts the next one and no other", |client| {
            let whole = request(0);
            let bytes = [&whole[..whole.len() - 1], &*request(1), &*request(2)].concat();
            answered(client, &bytes, &[2])
        }),
        check("R2", "frames in one write are answered in their order", |client| {
            answered(client, &[request(0), request(1), request(2)].concat(), &[0, 1, 2])
        }),
        check("R2", "a frame that arrives byte by byte is answered", |client| {
            for byte in request(0) {
                client.send_bytes(&[byte])?;
            }
            answered(client, &[], &[0])
        }),
        check("R2", "a good frame that is not a request is not answered", |client| {
            answered(client, &[no_request(), request(0)].concat(), &[0])
        }),
        check("R2", "Stop is answered with a LineReport before its result", |client| {
            client.running(&[])?;
            equal("answers", vec!["LineReport", "CommandResult"], names(&client.request(Stop {})?))
        }),
        check("R2", "the LineReport of a clean run counts no damage, with idle delimiters", |client| {
            client.running(&[])?;
            client.send_bytes(&[DELIMITER; 5])?;
            client.torque(0)?;
            // The marker after Start, the sample, the marker after the sample, and Stop.
            reported(client, LineReport { messages: 4, damaged: 0, refused: 0, overruns: 0 })
        }),
        check("R2", "the LineReport counts damaged and refused frames", |client| {
            client.running(&[])?;
            client.send_bytes(&damaged())?;
            reported(client, LineReport { messages: 2, damaged: 4, refused: 1, overruns: 0 })
        }),
        check("R2", "the LineReport counts each run from zero", |client| {
            client.running(&[])?;
            client.send_bytes(&damaged())?;
            client.request(Stop {})?;
            client.send_bytes(b"noise between runs\0")?;
            client.arm()?;
            client.start()?;
            reported(client, LineReport { messages: 2, damaged: 0, refused: 0, overruns: 0 })
        }),
        check("R2", "every frame from the drive was a good message", |client| {
            let counters = *client.line.decoder.counters();
            let got = (counters.damaged(), counters.refused);
            client.note = format!("{} messages", counters.messages);
            equal("damaged and refused frames of the drive", (0, 0), got)
        }),
    ]
}

fn request(index: u8) -> Vec<u8> {
    HostMessage::from(GetParameter { index }).frame().to_vec()
}

/// A good frame with a message of the drive, which is not a request.
fn no_request() -> Vec<u8> {
    let report = LineReport { messages: 0, damaged: 0, refused: 0, overruns: 0 };
    DriveMessage::from(report).frame().to_vec()
}

/// Four damaged frames, one of each kind, and a good one that is not a request.
fn damaged() -> Vec<u8> {
    let mut bad_crc = request(0);
    // The last byte before the delimiter; it must not become a delimiter.
    let last = bad_crc.len() - 2;
    bad_crc[last] ^= if bad_crc[last] == 1 { 2 } else { 1 };
    let truncated = [&request(0)[..4], &[DELIMITER]].concat();
    let too_short = vec![1, DELIMITER];
    [bad_crc, truncated, too_short, [&OVERSIZED[..], &[DELIMITER]].concat(), no_request()].concat()
}

/// Sends bytes and requires a report for each of these parameters, in order, and no other answer.
fn answered(client: &mut Client, bytes: &[u8], indices: &[u8]) -> RuleResult {
    let answers = client.request_bytes(bytes)?;
    let reported = answers.iter().map(|answer| match answer {
        DriveMessage::ParameterReport(report) => Some(report.index),
        _ => None,
    });
    let only_these = reported.eq(indices.iter().copied().map(Some));
    expect(only_these, format!("a ParameterReport for each of {indices:?} and nothing else"), answers)
}

/// Flips every bit of every byte except the delimiter, whose loss has its own check.
fn flipped_bits(client: &mut Client) -> RuleResult {
    let whole = request(0);
    for place in 0..whole.len() - 1 {
        for bit in 0..u8::BITS {
            let mut bytes = whole.clone();
            bytes[place] ^= 1 << bit;
            answered(client, &bytes, &[])?;
        }
    }
    Ok(())
}

fn reported(client: &mut Client, wanted: LineReport) -> RuleResult {
    equal("line report", wanted, line_report(&client.request(Stop {})?)?)
}
