//! One way of the line: frames go in, some are hit, and come out when it is time.

use std::collections::VecDeque;
use std::ops::Deref;
use std::time::{Duration, Instant};

use lashloop_protocol::MAX_FRAME;
use lashloop_protocol::frame::DELIMITER;
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::Rng;

use super::LinkFaults;
use crate::fault::{Schedule, at_place, draw, draw_below, random_stream};
use crate::scenario::Scenario;
use crate::scenario::fault::{FaultKind, Place, Way};

/// Frames that may be held at a time.
const ROOM: usize = 1024;

/// A frame on its way, or a piece of what is none.
#[derive(Clone, Copy)]
pub(super) struct Piece {
    bytes: [u8; MAX_FRAME],
    len: usize,
}

impl Deref for Piece {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        &self.bytes[..self.len]
    }
}

impl Piece {
    const EMPTY: Self = Self { bytes: [0; MAX_FRAME], len: 0 };

    fn push(&mut self, byte: u8) {
        self.bytes[self.len] = byte;
        self.len += 1;
    }

    fn remove(&mut self, at: usize) {
        self.bytes.copy_within(at + 1..self.len, at);
        self.len -= 1;
    }

    fn is_whole(&self) -> bool {
        self.len == MAX_FRAME || self.last() == Some(&DELIMITER)
    }
}

struct Held {
    piece: Piece,
    /// When it may pass; `None` as long as the line stalls.
    release: Option<Instant>,
}

struct PassageFault {
    number: usize,
    schedule: Schedule,
    kind: FaultKind,
    random: Pcg64Mcg,
}

/// One way of the line.
pub(super) struct Impairment {
    faults: Vec<PassageFault>,
    partial: Piece,
    /// Whatever the delay, frames of one line keep their order: only the first is looked at.
    held: VecDeque<Held>,
    /// A frame that waits to be overtaken.
    overtaken: Option<Held>,
}

impl Impairment {
    pub(super) fn new(scenario: &Scenario, to_drive: bool) -> Self {
        let faults = at_place(scenario, Place::Link).filter(|(_, _, kind)| {
            way_of(kind).is_some_and(|way| if to_drive { way.is_to_drive() } else { way.is_to_bench() })
        });
        let faults = faults.map(|(number, schedule, kind)| PassageFault {
            number,
            schedule,
            kind,
            random: random_stream(scenario, number, u64::from(to_drive)),
        });
        Self {
            faults: faults.collect(),
            partial: Piece::EMPTY,
            held: VecDeque::with_capacity(ROOM),
            overtaken: None,
        }
    }

    pub(super) fn clear(&mut self) {
        self.partial = Piece::EMPTY;
        self.held.clear();
        self.overtaken = None;
    }

    #[cfg(test)]
    pub(super) fn is_empty(&self) -> bool {
        self.held.is_empty()
    }

    /// Takes bytes from the near side at a time.
    pub(super) fn admit(&mut self, bytes: &[u8], shared: &LinkFaults, now: Instant) {
        for byte in bytes {
            self.partial.push(*byte);
            if self.partial.is_whole() {
                let piece = std::mem::replace(&mut self.partial, Piece::EMPTY);
                self.admit_piece(piece, shared, now);
            }
        }
    }

    fn admit_piece(&mut self, mut piece: Piece, shared: &LinkFaults, now: Instant) {
        let (mut release, mut stalls, mut doubled, mut overtaken) = (now, false, false, false);
        let step = shared.step();
        for fault in &mut self.faults {
            if !step.is_some_and(|step| fault.schedule.contains(step)) {
                continue;
            }
            let random = &mut fault.random;
            let hit = match fault.kind {
                FaultKind::LinkDelay { delay_ms, jitter_ms, .. } => {
                    release += Duration::from_secs_f64((delay_ms + jitter_ms * draw(random)) / 1e3);
                    true
                }
                FaultKind::LinkStall { .. } => {
                    stalls = true;
                    true
                }
                // A frame can't be overtaken by one that waits for the same.
                FaultKind::LinkReorder { share, .. } => {
                    draw(random) < share && self.overtaken.is_none() && !overtaken
                }
                kind => share_of(&kind).is_some_and(|share| draw(random) < share),
            };
            if !hit || piece.is_empty() {
                continue;
            }
            shared.count(fault.number);
            match fault.kind {
                FaultKind::LinkByteLoss { .. } => {
                    let at = draw_below(random, piece.len);
                    piece.remove(at);
                }
                FaultKind::LinkBitFlip { .. } => {
                    let bit = draw_below(random, 8 * piece.len);
                    piece.bytes[bit / 8] ^= 1 << (bit % 8);
                }
                FaultKind::LinkBurst { bytes, .. } => {
                    let len = (bytes as usize).min(piece.len);
                    let from = draw_below(random, piece.len - len + 1);
                    random.fill_bytes(&mut piece.bytes[from..from + len]);
                }
                FaultKind::LinkDuplicate { .. } => doubled = true,
                FaultKind::LinkReorder { .. } => overtaken = true,
                _ => {}
            }
        }
        // The lone byte of a piece was lost. Nothing is left that could be held, or read as the end of a wait.
        if piece.is_empty() {
            return;
        }
        let held = || Held { piece, release: (!stalls).then_some(release) };
        let waiting = self.overtaken.take();
        if overtaken {
            self.overtaken = Some(held());
        } else {
            self.hold(held());
        }
        if doubled {
            self.hold(held());
        }
        if let Some(waiting) = waiting {
            self.hold(waiting);
        }
    }

    fn hold(&mut self, held: Held) {
        if self.held.len() == ROOM {
            self.held.pop_front();
        }
        self.held.push_back(held);
    }

    /// The next frame that may pass by now.
    pub(super) fn next_due(&mut self, step: Option<u32>, now: Instant) -> Option<Piece> {
        let due = self.next_release(step, now)? <= now;
        if due { self.held.pop_front().map(|held| held.piece) } else { None }
    }

    /// When the next frame may pass; `None` if there is none, or as long as the line stalls. Outside the run nothing is
    /// wrong with the line, so nothing is held.
    pub(super) fn next_release(&self, step: Option<u32>, now: Instant) -> Option<Instant> {
        if step.is_none() {
            return self.held.front().map(|_| now);
        }
        let stalls = self.faults.iter().any(|fault| {
            matches!(fault.kind, FaultKind::LinkStall { .. })
                && step.is_some_and(|step| fault.schedule.contains(step))
        });
        let first = self.held.front().filter(|_| !stalls)?;
        Some(first.release.unwrap_or(now))
    }
}

fn way_of(kind: &FaultKind) -> Option<Way> {
    match kind {
        FaultKind::LinkByteLoss { way, .. }
        | FaultKind::LinkBitFlip { way, .. }
        | FaultKind::LinkBurst { way, .. }
        | FaultKind::LinkDuplicate { way, .. }
        | FaultKind::LinkReorder { way, .. }
        | FaultKind::LinkDelay { way, .. }
        | FaultKind::LinkStall { way } => Some(*way),
        _ => None,
    }
}

fn share_of(kind: &FaultKind) -> Option<f64> {
    match kind {
        FaultKind::LinkByteLoss { share, .. }
        | FaultKind::LinkBitFlip { share, .. }
        | FaultKind::LinkBurst { share, .. }
        | FaultKind::LinkDuplicate { share, .. } => Some(*share),
        _ => None,
    }
}

#[cfg(test)]
mod tests;
