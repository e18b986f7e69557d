//! Damaged frames that the decoder accepts.
//!
//! CRC-32C promises that one in 2^32 randomly damaged frames passes the check, and none with up to seven flipped bits in a
//! sample or a torque, or with a burst of up to 32 bits. Such rates can't be counted. The decoder reports both check values
//! of a rejected frame, so we count how often half of their bits agree by chance: one in 65,536, the rate of a CRC-16.

use std::fmt;

use lashloop_protocol::enums::{State, TorqueFlags, TorqueStatus};
use lashloop_protocol::frame::FrameError;
use lashloop_protocol::message::{EncoderSample, TorqueAnswer};
use lashloop_protocol::{Decoder, DriveMessage, EncoderCounts, HostMessage, Message, Numbered, cobs, frame};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};

/// Damage of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Damage {
    /// One to seven flipped bits of body and CRC.
    FewBits,
    /// A burst of up to 32 bits of body and CRC, the first and the last of them wrong.
    Burst,
    /// Body and CRC replaced by random bytes, with the kind and correct stuffing.
    RandomBody,
    /// Every bit on the line wrong with a probability of 1 %, at least one.
    BitErrors,
    /// A burst of up to 64 bits on the line, each wrong or not.
    LineBurst,
    /// Random bytes on the line, as many as the frame has.
    RandomBytes,
    /// The beginning of one good frame and the end of another.
    Splice,
}

impl Damage {
    pub const ALL: [Self; 7] = [
        Self::FewBits,
        Self::Burst,
        Self::RandomBody,
        Self::BitErrors,
        Self::LineBurst,
        Self::RandomBytes,
        Self::Splice,
    ];
}

/// Results of the decoder for damaged frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Frames offered.
    pub frames: u64,
    /// Pieces decoded as a message that was sent: the damage cancelled or exchanged equal bytes.
    pub unharmed: u64,
    /// Pieces refused for their length or stuffing.
    pub framing: u64,
    /// Pieces refused by the CRC.
    pub crc: u64,
    /// Of these, pieces in whose check values the lower 16 bits agree.
    pub half_agrees: u64,
    /// Pieces with a right CRC and no message in them.
    pub refused: u64,
    /// Messages that were never sent.
    pub wrong: u64,
}

impl Tally {
    /// Damaged pieces that reach the CRC.
    pub fn up_to_the_crc(&self) -> u64 {
        self.crc + self.refused + self.wrong
    }

    fn note<M: Message>(&mut self, item: &Result<Numbered<M>, FrameError>, sent: &[&[u8]]) {
        *match item {
            Ok(it) if sent.contains(&&it.message.numbered_frame(it.number)[..]) => &mut self.unharmed,
            Ok(_) => &mut self.wrong,
            Err(FrameError::Crc { expected, found }) => {
                self.half_agrees += u64::from((expected ^ found).trailing_zeros() >= 16);
                &mut self.crc
            }
            Err(FrameError::Body(_)) => &mut self.refused,
            Err(_) => &mut self.framing,
        } += 1;
    }
}

/// The tallies as a table.
pub struct Table<'a>(pub &'a [(Damage, Tally)]);

impl fmt::Display for Table<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            out,
            "| damage | frames | unharmed | refused: length or stuffing | CRC | no message | wrong message | promised |\n\
             |---|---|---|---|---|---|---|---|"
        )?;
        for (damage, tally) in self.0 {
            let Tally { frames, unharmed, framing, crc, refused, wrong, .. } = tally;
            let promised = match damage {
                Damage::FewBits | Damage::Burst => 0.0,
                _ => tally.up_to_the_crc() as f64 / 2_f64.powi(32),
            };
            writeln!(
                out,
                "| {damage:?} | {frames} | {unharmed} | {framing} | {crc} | {refused} | {wrong} | {promised:.4} |"
            )?;
        }
        for (_, tally) in self.0.iter().filter(|(damage, _)| *damage == Damage::RandomBody) {
            let (found, expected) = (tally.half_agrees, tally.frames as f64 / 65_536.0);
            writeln!(
                out,
                "random bodies whose CRC is right in its lower half: {found}; chance has {expected:.0}"
            )?;
        }
        Ok(())
    }
}

/// Feeds about `frames` damaged frames to the decoder, equally many with each damage: half encoder samples, half torque
/// answers.
pub fn run(frames: u64, seed: u64) -> Vec<(Damage, Tally)> {
    let each = frames.div_ceil(2 * Damage::ALL.len() as u64);
    let mut line = Line { random: Pcg64Mcg::seed_from_u64(seed), bytes: Vec::with_capacity(256) };
    Damage::ALL
        .into_iter()
        .map(|damage| {
            let mut tally = Tally::default();
            line.offer(damage, each, &mut tally, |random| HostMessage::from(sample(random)));
            line.offer(damage, each, &mut tally, |random| DriveMessage::from(torque(random)));
            (damage, tally)
        })
        .collect()
}

fn sample(random: &mut Pcg64Mcg) -> EncoderSample {
    EncoderSample {
        sequence: random.next_u32() as u16,
        motor_counts: EncoderCounts::wrapping((random.next_u32().cast_signed() >> 10).into()),
        load_counts: EncoderCounts::wrapping((random.next_u32().cast_signed() >> 10).into()),
        reference_rad: random.next_u32() as f32 / 2_f32.powi(32),
    }
}

fn torque(random: &mut Pcg64Mcg) -> TorqueAnswer {
    TorqueAnswer {
        sequence: random.next_u32() as u16,
        torque_nm: random.next_u32().cast_signed() as f32 / 2_f32.powi(26),
        status: TorqueStatus {
            state: State::ALL[below(random, State::ALL.len())],
            flags: TorqueFlags::from_bits_truncate(random.next_u32() as u8),
        },
        compute_tenths_us: (random.next_u32() >> 22) as u16,
    }
}

struct Line {
    random: Pcg64Mcg,
    bytes: Vec<u8>,
}

impl Line {
    fn offer<M: Message>(
        &mut self,
        damage: Damage,
        frames: u64,
        tally: &mut Tally,
        message: fn(&mut Pcg64Mcg) -> M,
    ) {
        let mut decoder = Decoder::new();
        for _ in 0..frames {
            let sent = [message(&mut self.random).frame(), message(&mut self.random).frame()];
            self.bytes.clear();
            self.damage(damage, &sent[0], &sent[1]);
            // The damage may have hit the delimiter; an extra one confines the damage to its frame.
            self.bytes.push(frame::DELIMITER);
            let mut bytes = &self.bytes[..];
            while let Some(item) = decoder.next::<M>(&mut bytes) {
                tally.note(&item, &[&sent[0], &sent[1]]);
            }
        }
        tally.frames += frames;
    }

    fn damage(&mut self, damage: Damage, frame: &[u8], other: &[u8]) {
        let bytes = &mut self.bytes;
        let random = &mut self.random;
        bytes.extend_from_slice(frame);
        let bits = bytes.len() * 8;
        match damage {
            Damage::FewBits => unstuffed(bytes, |inside| {
                let count = 1 + below(random, 7);
                for _ in 0..count {
                    flip(inside, below(random, inside.len() * 8));
                }
            }),
            Damage::Burst => unstuffed(bytes, |inside| {
                let bits = inside.len() * 8;
                let (len, pattern) = (1 + below(random, 32), random.next_u64());
                let first = below(random, bits - len + 1);
                let wrong = |i: usize| i == 0 || i == len - 1 || pattern >> i & 1 == 1;
                (0..len).filter(|&i| wrong(i)).for_each(|i| flip(inside, first + i));
            }),
            Damage::RandomBody => unstuffed(bytes, |inside| random.fill_bytes(&mut inside[1..])),
            Damage::BitErrors => {
                let mut at = below(random, bits);
                while at < bits {
                    flip(bytes, at);
                    // Distances between independent errors are geometric.
                    let uniform = (random.next_u32() as f64 + 0.5) / 2_f64.powi(32);
                    at += 1 + (uniform.ln() / 0.99_f64.ln()) as usize;
                }
            }
            Damage::LineBurst => {
                let (len, pattern) = (1 + below(random, 64), random.next_u64() | 1);
                let first = below(random, bits - len + 1);
                (0..len).filter(|&i| pattern >> i & 1 == 1).for_each(|i| flip(bytes, first + i));
            }
            Damage::RandomBytes => random.fill_bytes(bytes),
            Damage::Splice => {
                bytes.truncate(1 + below(random, frame.len() - 1));
                bytes.extend_from_slice(&other[1 + below(random, other.len() - 1)..]);
            }
        }
    }
}

/// Changes body and CRC of a frame, and stuffs the result.
fn unstuffed(frame: &mut [u8], change: impl FnOnce(&mut [u8])) {
    let end = frame.len() - 1;
    cobs::unstuff(&mut frame[..end]).expect("a good frame");
    change(&mut frame[1..end]);
    cobs::stuff(&mut frame[..end]);
}

fn flip(bytes: &mut [u8], bit: usize) {
    bytes[bit / 8] ^= 1 << (bit % 8);
}

fn below(random: &mut Pcg64Mcg, limit: usize) -> usize {
    ((u64::from(random.next_u32()) * limit as u64) >> 32) as usize
}
