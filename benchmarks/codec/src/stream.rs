//! A long stream of samples, read in pieces of 4 KiB.

use std::hint::black_box;
use std::io;
use std::time::Instant;

use bytes::{Buf, BytesMut};
use cobs::CobsDecoder;
use crc::{CRC_16_MCRF4XX, Crc, Table};
use lashloop_protocol::message::EncoderSample;
use lashloop_protocol::{Decoder, EncoderCounts, HostMessage, Message};
use tokio_util::codec::Decoder as _;

use crate::codec::{CRC_32, Codec, ours::Ours};
use crate::cycle::Sample;
use crate::measure::median;

const PIECE: usize = 4096;
const ROUNDS: usize = 401;
/// Messages in the stream, 0.2 MB in our encoding. A round takes less than 1 ms, so that most rounds on a busy machine are not
/// interrupted.
const MESSAGES: usize = 8_192;

pub struct Figures {
    name: &'static str,
    pub ns_per_message: f64,
    bytes_per_message: f64,
}

impl Figures {
    pub fn mb_s(&self) -> f64 {
        self.bytes_per_message / self.ns_per_message * 1e3
    }
}

pub fn table(figures: &[Figures]) {
    println!("| stream in 4 KiB pieces | MB/s | ns per message | bytes per message |\n|---|---|---|---|");
    for side in figures {
        let Figures { name, ns_per_message, bytes_per_message } = side;
        println!("| {name} | {:.0} | {ns_per_message:.1} | {bytes_per_message:.1} |", side.mb_s());
    }
}

type Reader = fn(&[u8]) -> usize;

pub fn measure(samples: &[Sample]) -> Vec<Figures> {
    let (mut ours, mut mavlink_like) = (Vec::new(), Vec::new());
    for sample in samples.iter().cycle().take(MESSAGES) {
        Ours::default().encode(sample, |frame| ours.extend_from_slice(frame));
        put_mavlink_like(sample, &mut mavlink_like);
    }
    let sides: [(&'static str, &[u8], Reader); 4] = [
        ("lashloop", &ours, read_ours),
        ("cobs push decoder, CRC-32C, fields", &ours, read_cobs),
        (
            "tokio Decoder, MAVLink-like frames, CRC-16 with the crc crate's default table",
            &mavlink_like,
            |stream| read_mavlink_like(stream, |bytes| CRC_16.checksum(bytes)),
        ),
        ("the same with 16 tables", &mavlink_like, |stream| {
            read_mavlink_like(stream, |bytes| CRC_16_WIDE.checksum(bytes))
        }),
    ];
    let mut times = [const { Vec::new() }; 4];
    for _ in 0..ROUNDS {
        for ((name, stream, read), times) in sides.iter().zip(&mut times) {
            let started = Instant::now();
            assert_eq!(read(black_box(stream)), MESSAGES, "{name}");
            times.push(started.elapsed().as_nanos() as f64 / MESSAGES as f64);
        }
    }
    let figures = sides.iter().zip(times).map(|((name, stream, _), times)| Figures {
        name,
        ns_per_message: median(times),
        bytes_per_message: stream.len() as f64 / MESSAGES as f64,
    });
    figures.collect()
}

fn read_ours(stream: &[u8]) -> usize {
    let mut decoder = Decoder::new();
    let mut count = 0;
    for mut piece in stream.chunks(PIECE) {
        while let Some(Ok(message)) = decoder.next::<HostMessage>(&mut piece) {
            black_box(message);
            count += 1;
        }
    }
    count
}

/// The same frames, checks and fields, with the `cobs` crate for the framing.
fn read_cobs(stream: &[u8]) -> usize {
    let mut buffer = [0; 64];
    let mut decoder = CobsDecoder::new(&mut buffer);
    let mut count = 0;
    for mut piece in stream.chunks(PIECE) {
        while !piece.is_empty() {
            let Some(report) = decoder.push(piece).expect("good frames") else { break };
            piece = &piece[report.parsed_size()..];
            let (body, crc) = decoder.dest()[..report.frame_size()].split_last_chunk().expect("a CRC");
            if CRC_32.checksum(body) == u32::from_le_bytes(*crc) {
                black_box(HostMessage::decode_body(body).expect("a message"));
                count += 1;
            }
        }
    }
    count
}

const MAGIC: u8 = 0xfd;
/// Magic, length, two flag bytes, sequence, system, component, three bytes of message id.
const HEADER: usize = 10;
/// Fields in standard types: a count takes four bytes.
const PAYLOAD: usize = 14;
const CRC_LEN: usize = 2;

/// As in typical applications.
static CRC_16: Crc<u16> = Crc::<u16>::new(&CRC_16_MCRF4XX);
static CRC_16_WIDE: Crc<u16, Table<16>> = Crc::<u16, Table<16>>::new(&CRC_16_MCRF4XX);

fn put_mavlink_like(sample: &Sample, line: &mut Vec<u8>) {
    let start = line.len();
    line.extend_from_slice(&[MAGIC, PAYLOAD as u8, 0, 0, sample.sequence as u8, 1, 1, 0x10, 0, 0]);
    line.extend_from_slice(&sample.sequence.to_le_bytes());
    line.extend_from_slice(&sample.motor_counts.to_le_bytes());
    line.extend_from_slice(&sample.load_counts.to_le_bytes());
    line.extend_from_slice(&sample.reference_rad.to_le_bytes());
    let crc = CRC_16.checksum(&line[start + 1..]);
    line.extend_from_slice(&crc.to_le_bytes());
}

/// The framing of MAVLink (magic, length, CRC) as a typical tokio codec.
struct MavlinkLike<C> {
    checksum: C,
}

impl<C: Fn(&[u8]) -> u16> tokio_util::codec::Decoder for MavlinkLike<C> {
    type Item = EncoderSample;
    type Error = io::Error;

    fn decode(&mut self, src: &mut BytesMut) -> io::Result<Option<EncoderSample>> {
        loop {
            let Some(start) = src.iter().position(|&byte| byte == MAGIC) else {
                src.clear();
                return Ok(None);
            };
            src.advance(start);
            let Some(&len) = src.get(1) else { return Ok(None) };
            let end = HEADER + usize::from(len);
            if src.len() < end + CRC_LEN {
                return Ok(None);
            }
            let crc = u16::from_le_bytes([src[end], src[end + 1]]);
            if (self.checksum)(&src[1..end]) != crc || usize::from(len) != PAYLOAD {
                src.advance(1);
                continue;
            }
            let mut frame = src.split_to(end + CRC_LEN);
            frame.advance(HEADER);
            return Ok(Some(EncoderSample {
                sequence: frame.get_u16_le(),
                motor_counts: EncoderCounts::wrapping(frame.get_i32_le().into()),
                load_counts: EncoderCounts::wrapping(frame.get_i32_le().into()),
                reference_rad: frame.get_f32_le(),
            }));
        }
    }
}

fn read_mavlink_like(stream: &[u8], checksum: impl Fn(&[u8]) -> u16) -> usize {
    let mut decoder = MavlinkLike { checksum };
    let mut buffer = BytesMut::with_capacity(2 * PIECE);
    let mut count = 0;
    for piece in stream.chunks(PIECE) {
        buffer.extend_from_slice(piece);
        while let Some(message) = decoder.decode(&mut buffer).expect("no I/O here") {
            black_box(message);
            count += 1;
        }
    }
    count
}
