//! The receiver: which bytes are a frame, which frames are damaged or refused, and that neither is answered.
//!
//! Each check of damage is one run in one or a few writes: `Start` restarts the counts, the bytes follow, `Stop` returns
//! the counts. The counts show that every frame was found damaged, or refused, once.

use lashloop_protocol::crc;

use super::damage;
use crate::prelude::checks::*;

/// A pause in a frame. The page has no timeout for one.
const PAUSE: Duration = Duration::from_millis(60);

pub(super) fn checks() -> Vec<Check> {
    vec![
        check("R1.1 R1.3 R4.1", "frames in one write are answered in their order", |client| {
            let all: Vec<u8> = (0..12).flat_map(request).collect();
            answered(client, &all, &(0..12).collect::<Vec<_>>())
        }),
        check("R1.1", "a frame that arrives byte by byte is answered", |client| {
            for byte in request(0) {
                client.send_bytes(&[byte])?;
            }
            answered(client, &[], &[0])?;
            // The end of a frame and the start of the next one in the same write.
            let bytes = [request(0), request(1), request(2)].concat();
            for piece in bytes.chunks(5) {
                client.send_bytes(piece)?;
            }
            answered(client, &[], &[0, 1, 2])
        }),
        check("R1.1", "a pause in a frame doesn't end it", |client| {
            client.running(&[])?;
            let frame = HostMessage::from(sample(0)).frame();
            let (start, rest) = frame.split_at(7);
            client.send_bytes(start)?;
            // Time passes for a drive in process only while the bench waits.
            client.wait_for(PAUSE, |_| None::<()>)?;
            let answers = client.request_bytes(rest)?;
            equal("answers to a sample in two pieces", vec!["TorqueAnswer"], names(&answers))
        }),
        check("R2.2", "delimiters between frames are neither a frame nor an error", |client| {
            let bytes =
                [&[DELIMITER; 3][..], &request(0), &[DELIMITER; 70], &request(1), &[DELIMITER]].concat();
            answered(client, &bytes, &[0, 1])?;
            counts(client, &[&[DELIMITER; 200][..]], 0, 0)
        }),
        check("R2.4 R2.8", "garbage before a frame is discarded", |client| {
            let garbage = [b"noise\0more noise\0", &*request(0)].concat();
            answered(client, &garbage, &[0])?;
            // Without a delimiter the garbage corrupts the frame that follows, but not the next.
            answered(client, &[b"noise", &*request(0), &*request(1)].concat(), &[1])
        }),
        check("R2.4 R2.8", "a truncated frame is not answered, and the next one is", |client| {
            let whole = request(0);
            let cut = (1..whole.len() - 1).flat_map(|length| [&whole[..length], &[DELIMITER]].concat());
            let bytes: Vec<u8> = cut.chain(request(1)).collect();
            answered(client, &bytes, &[1])
        }),
        check("R2.8", "a frame without its delimiter corrupts the next one and no other", |client| {
            let whole = request(0);
            let bytes = [&whole[..whole.len() - 1], &*request(1), &*request(2)].concat();
            answered(client, &bytes, &[2])
        }),
        check("R2.4 R2.7", "a frame with a flipped bit is damaged", |client| {
            let requests = [HostMessage::from(GetParameter { index: 0 }), sample(0).into(), Stop {}.into()];
            requests.iter().try_for_each(|request| {
                let frames = damage::flipped_bits(&request.frame());
                counts(client, &frames, frames.len(), 0)
            })
        }),
        check("R2.4 R2.7", "a frame with another checksum is damaged", |client| {
            let frames = damage::checksums(&[GetParameter::LAYOUT.kind, 0, 0]);
            counts(client, &frames, frames.len(), 0)
        }),
        check("R2.4 R2.7", "a frame with bad stuffing, or of fewer than 6 bytes, is damaged", |client| {
            let frames = damage::stuffing(&request(0));
            counts(client, &frames, frames.len(), 0)
        }),
        check(
            "R2.3 R2.7 R2.8",
            "more than 63 bytes are damaged once, and a frame at their end is dropped",
            |client| {
                let lengths = [57, 58, 62, 63, 64, 65, 70, 120, 127, 128, 129, 192, 255, 256, 257, 1_000];
                let frames = lengths.map(|length| [vec![0x55; length], request(0)].concat());
                counts(client, &frames, frames.len(), 0)?;
                // The last bytes alone would be the longest frame.
                let longest = framed(&[vec![GetParameter::LAYOUT.kind], vec![0x11; MAX_BODY - 1]].concat());
                counts(client, &[[&[0x55; 10][..], &longest].concat()], 1, 0)?;
                // After any of them the next frame is decoded.
                let bytes: Vec<u8> =
                    frames.iter().flat_map(|frame| [&frame[..], &*request(3)].concat()).collect();
                answered(client, &bytes, &[3; 16])
            },
        ),
        check("R2.3 R2.5", "63 bytes are a frame, 64 are damaged", |client| {
            // Of a kind of the drive, so it is refused if it is whole.
            let body = |length: usize| [vec![ParameterReport::LAYOUT.kind], vec![0x11; length - 1]].concat();
            counts(client, &[framed(&body(MAX_BODY))], 0, 1)?;
            counts(client, &[framed(&body(MAX_BODY + 1)), framed(&body(MAX_BODY + 2))], 2, 0)?;
            // Whole up to its 63rd byte.
            let whole = framed(&body(MAX_BODY));
            counts(client, &[[&whole[..whole.len() - 1], &[0x11, DELIMITER]].concat()], 1, 0)
        }),
        check("R2.5 R2.7", "a frame of a kind that no host sends is refused", |client| {
            let frames = foreign();
            counts(client, &frames, 0, frames.len())?;
            // More than a byte counts.
            let frames = vec![framed(&[0x80]); client.repetitions(300)];
            counts(client, &frames, 0, frames.len())
        }),
        check("R2.5 R2.7", "a request that is too short is refused", |client| {
            let frames = too_short(client.session);
            counts(client, &frames, 0, frames.len())
        }),
        check("R2.5 R3.1 R5.1", "a value of type 0 is refused", |client| counts(client, &[no_type()], 0, 1)),
        check("R2.6", "no damaged or refused frame changes anything", no_effect),
    ]
}

/// The requests whose effect would show.
fn effective(session: u32) -> [HostMessage; 5] {
    [Stop {}.into(), EmergencyStop {}.into(), Reset {}.into(), hello(session ^ 1).into(), sample(0).into()]
}

/// Every request of [`effective`] with a bad checksum, too short by a byte, and as of the drive, each before the next sample of a
/// run.
fn no_effect(client: &mut Client) -> RuleResult {
    client.running(&[])?;
    for (sequence, message) in (0..).zip(effective(client.session)) {
        let body = damage::body(&message.frame());
        let of_drive = [&[body[0] | 0x80], &body[1..]].concat();
        let mut bytes = damage::checksums(&body).concat();
        bytes.extend([framed(&body[..body.len() - 1]), framed(&of_drive)].concat());
        let answers =
            client.request_bytes(&[&bytes, &*HostMessage::from(sample(sequence)).frame()].concat())?;
        let after = format!(
            "after damaged and refused copies of {}, answers to sample {sequence}",
            message.layout().name
        );
        let flags =
            torque(&of_kinds(&after, &["TorqueAnswer"], answers)?)?.status.flags - TorqueFlags::SATURATED;
        equal(&after, NONE, flags)?;
        equal(&after, Running, client.state)?;
    }
    Ok(())
}

pub(super) fn request(index: u8) -> Vec<u8> {
    HostMessage::from(GetParameter { index }).frame().to_vec()
}

/// A frame around any body.
pub(super) fn framed(body: &[u8]) -> Vec<u8> {
    damage::stuffed(&[body, &crc::checksum(body).to_le_bytes()].concat())
}

/// Whole frames of kinds that no host sends: those of the drive, those without a message too, and the two that nobody sends.
pub(super) fn foreign() -> Vec<Vec<u8>> {
    let of_drive = DriveMessage::LAYOUTS.iter().map(|layout| {
        let mut body = vec![1; layout.shortest_body_len()];
        body[0] = layout.kind;
        framed(&body)
    });
    let unknown = [0x00, 0x80, 0x8c, 0x9e, 0xff].into_iter().flat_map(|kind| {
        // As the kind alone, as long as `Arm`, and as the longest body.
        [1, 6, MAX_BODY].map(|length| framed(&[vec![kind], vec![1; length - 1]].concat()))
    });
    // As long as the request whose kind differs in the highest bit only.
    let mirrored = HostMessage::LAYOUTS.iter().map(|layout| {
        let mut body = vec![1; layout.body_len];
        body[0] = layout.kind | 0x80;
        framed(&body)
    });
    of_drive.chain(unknown).chain(mirrored).collect()
}

/// Frames of every kind of damage, each without a good frame's effect.
pub(super) fn damaged() -> Vec<Vec<u8>> {
    let body = damage::body(&request(0));
    let oversized = [57, 64, 128].map(|length| [vec![0x55; length], request(0)].concat());
    let longest = framed(&[vec![GetParameter::LAYOUT.kind], vec![0x11; MAX_BODY]].concat());
    let mut frames = [damage::checksums(&body), damage::stuffing(&request(0)), oversized.to_vec()].concat();
    // A whole frame of 63 bytes, and then more.
    let whole = framed(&[vec![GetParameter::LAYOUT.kind], vec![0x11; MAX_BODY - 1]].concat());
    frames.push([&whole[..whole.len() - 1], &[0x11; 9], &[DELIMITER]].concat());
    frames.push(longest);
    frames
}

/// Whole frames of every kind that isn't a request.
pub(super) fn refused(session: u32) -> Vec<Vec<u8>> {
    [foreign(), too_short(session), vec![no_type()]].concat()
}

/// `SetParameter` of a value of no type.
fn no_type() -> Vec<u8> {
    framed(&[SetParameter::LAYOUT.kind, 0, 0, 0, 0, 0, 0, 0])
}

/// Requests of each kind that every drive has, with fewer bytes: the kind alone, with a number, and but for the last byte.
fn too_short(session: u32) -> Vec<Vec<u8>> {
    let mut frames = Vec::new();
    for layout in HostMessage::LAYOUTS {
        let is_of_bench = [Reference::LAYOUT.kind, EnterLoader::LAYOUT.kind].contains(&layout.kind);
        if is_of_bench || layout.kind >= StoreParameters::LAYOUT.kind {
            continue;
        }
        let mut body = [&[layout.kind, 0][..], &session.to_le_bytes(), &[0; MAX_BODY]].concat();
        body.truncate(layout.body_len - 1);
        frames.extend(
            [1, 2].into_iter().filter(|length| *length < body.len()).map(|length| framed(&body[..length])),
        );
        frames.push(framed(&body));
    }
    frames
}

/// Sends bytes and requires a report for each of these parameters, in order, and no other answer.
fn answered(client: &mut Client, bytes: &[u8], indices: &[u8]) -> RuleResult {
    let answers = client.request_bytes(bytes)?;
    let reported = answers.iter().map(|it| Some(of::<ParameterReport>(it)?.index));
    if reported.eq(indices.iter().copied().map(Some)) {
        return Ok(());
    }
    let indices = indices.words();
    Err(broken(format!("a ParameterReport for each of {indices}, and nothing else"), answers.words()))
}

/// Sends frames in a run of their own, and requires no answer and these counts in the report.
fn counts<F: AsRef<[u8]>>(client: &mut Client, frames: &[F], damaged: usize, refused: usize) -> RuleResult {
    client.running(&[])?;
    let bytes: Vec<u8> = frames.iter().flat_map(|frame| frame.as_ref().to_vec()).collect();
    client.send_bytes(&bytes)?;
    let kinds = ["LineReport", "CommandResult"];
    let answers = of_kinds("answers to these frames and to Stop", &kinds, client.request(Stop {})?)?;
    // The marker after Start, and Stop.
    let [damaged, refused] = [damaged, refused].map(|count| count as u32);
    equal("report", counted(2, damaged, refused), line_report(&answers)?)
}
