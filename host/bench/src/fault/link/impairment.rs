//! One direction of the link: frames are hit by faults, held, and released when they are due.
//!
//! Whether and where a frame is hit is drawn once for the whole frame, in any number of pieces.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use lashloop_plant::random::{Pcg64Mcg, uniform};
use rand_pcg::rand_core::Rng;

use super::link_faults::LinkFaults;
use super::piece::Piece;
use crate::fault::random::{stream, uniform_below};
use crate::fault::schedule::{FaultGroups, Schedule};
use crate::scenario::Scenario;
use crate::scenario::fault::{FrameFault, Way};

/// Frames held at most; a longer stall loses the oldest.
const CAPACITY: usize = 1024;

struct Held {
    piece: Piece,
    /// When the frame is due; `None` for a stalled frame, which is due when the stall ends.
    release: Option<Instant>,
}

struct ActiveFault {
    index: usize,
    schedule: Schedule,
    fault: FrameFault,
    random: Pcg64Mcg,
}

/// What the active faults make of one frame.
struct Passage {
    piece: Piece,
    release: Instant,
    is_stalled: bool,
    is_duplicated: bool,
    is_overtaken: bool,
}

/// One direction of the link.
pub(super) struct Impairment {
    faults: Vec<ActiveFault>,
    partial: Piece,
    /// Frames keep their order under any delay, so only the first can be due.
    held: VecDeque<Held>,
    /// A frame that waits for its successor to overtake it.
    overtaken: Option<Held>,
}

impl Impairment {
    pub(super) fn new(scenario: &Scenario, to_drive: bool) -> Self {
        let faults = FaultGroups::of(scenario).frames.into_iter().filter(|(_, _, (_, way))| match way {
            Way::ToDrive => to_drive,
            Way::ToBench => !to_drive,
            Way::Both => true,
        });
        let faults = faults.map(|(index, schedule, (fault, _))| ActiveFault {
            index,
            schedule,
            fault,
            random: stream(scenario, index, u64::from(to_drive)),
        });
        Self {
            faults: faults.collect(),
            partial: Piece::EMPTY,
            held: VecDeque::with_capacity(CAPACITY),
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

    /// Takes bytes from the sender.
    pub(super) fn admit(&mut self, bytes: &[u8], shared: &LinkFaults, now: Instant) {
        for byte in bytes {
            self.partial.push(*byte);
            if self.partial.is_whole() {
                let piece = std::mem::replace(&mut self.partial, Piece::EMPTY);
                self.admit_piece(piece, shared, now);
            }
        }
    }

    fn admit_piece(&mut self, piece: Piece, shared: &LinkFaults, now: Instant) {
        let mut passage =
            Passage { piece, release: now, is_stalled: false, is_duplicated: false, is_overtaken: false };
        if let Some(step) = shared.step() {
            let may_wait = self.overtaken.is_none();
            for active in self.faults.iter_mut().filter(|active| active.schedule.contains(step)) {
                if passage.is_hit_by(active.fault, &mut active.random, may_wait) {
                    shared.count_hit(active.index);
                }
            }
        }
        // A piece of one byte has lost it. An empty one would read as the end of a wait.
        if passage.piece.is_empty() {
            return;
        }
        let waiting = self.overtaken.take();
        if passage.is_overtaken {
            self.overtaken = Some(passage.held());
        } else {
            self.hold(passage.held());
        }
        if passage.is_duplicated {
            self.hold(passage.held());
        }
        if let Some(waiting) = waiting {
            self.hold(waiting);
        }
    }

    fn hold(&mut self, held: Held) {
        if self.held.len() == CAPACITY {
            self.held.pop_front();
        }
        self.held.push_back(held);
    }

    /// The next frame, if it is due.
    pub(super) fn next_due(&mut self, step: Option<u32>, now: Instant) -> Option<Piece> {
        let is_due = self.next_release(step, now)? <= now;
        if is_due { self.held.pop_front().map(|held| held.piece) } else { None }
    }

    /// When the next frame is due; `None` if no frame is held, or during a stall. Outside the run, no frame is held back.
    pub(super) fn next_release(&self, step: Option<u32>, now: Instant) -> Option<Instant> {
        let first = self.held.front()?;
        let Some(step) = step else { return Some(now) };
        let mut active = self.faults.iter().filter(|active| active.schedule.contains(step));
        let is_stalled = active.any(|active| active.fault == FrameFault::Stall {});
        (!is_stalled).then(|| first.release.unwrap_or(now))
    }
}

impl Passage {
    /// Applies a fault and returns whether it hits the frame. Every fault draws for every frame, regardless of other
    /// faults, so that streams stay independent of each other.
    fn is_hit_by(&mut self, fault: FrameFault, random: &mut Pcg64Mcg, may_wait: bool) -> bool {
        let is_empty = self.piece.is_empty();
        let mut draw_hit = |share| uniform(random) < share && !is_empty;
        match fault {
            FrameFault::ByteLoss { share } => {
                let is_hit = draw_hit(share);
                if is_hit {
                    self.piece.remove(uniform_below(random, self.piece.len()));
                }
                is_hit
            }
            FrameFault::BitFlip { share } => {
                let is_hit = draw_hit(share);
                if is_hit {
                    self.piece.flip_bit(uniform_below(random, 8 * self.piece.len()));
                }
                is_hit
            }
            FrameFault::Burst { share, bytes } => {
                let is_hit = draw_hit(share);
                if is_hit {
                    let len = (bytes as usize).min(self.piece.len());
                    let from = uniform_below(random, self.piece.len() - len + 1);
                    random.fill_bytes(&mut self.piece.bytes_mut()[from..from + len]);
                }
                is_hit
            }
            FrameFault::Duplicate { share } => {
                let is_hit = draw_hit(share);
                self.is_duplicated |= is_hit;
                is_hit
            }
            FrameFault::Reorder { share } => {
                // Of two frames that wait to be overtaken, neither would ever be released.
                let is_hit = draw_hit(share) && may_wait && !self.is_overtaken;
                self.is_overtaken |= is_hit;
                is_hit
            }
            FrameFault::Delay { delay_ms, jitter_ms } => {
                self.release += Duration::from_secs_f64((delay_ms + jitter_ms * uniform(random)) / 1e3);
                !is_empty
            }
            FrameFault::Stall {} => {
                self.is_stalled = true;
                !is_empty
            }
        }
    }

    fn held(&self) -> Held {
        Held { piece: self.piece, release: (!self.is_stalled).then_some(self.release) }
    }
}

#[cfg(test)]
mod tests;
