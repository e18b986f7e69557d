//! What becomes of frames on one way of the line.

use std::time::{Duration, Instant};

use super::{Impairment, LinkFaults};
use crate::fault::tests::{scenario, seeded};
use crate::scenario::Scenario;

/// A passage to the drive, with a time of its own.
struct Line {
    passage: Impairment,
    faults: LinkFaults,
    start: Instant,
}

impl Line {
    fn new(faults: &[&str]) -> Self {
        Self::of(&scenario(faults))
    }

    fn of(scenario: &Scenario) -> Self {
        let faults = LinkFaults::new(scenario).expect("faults of the link");
        Self { passage: Impairment::new(scenario, true), faults, start: Instant::now() }
    }

    fn at(&self, ms: u64) -> Instant {
        self.start + Duration::from_millis(ms)
    }

    /// Bytes come in in a step, at a time.
    fn admit(&mut self, step: u32, ms: u64, bytes: &[u8]) {
        self.faults.set_step(Some(step));
        self.passage.admit(bytes, &self.faults, self.at(ms));
    }

    /// What comes out in a step, at a time.
    fn out(&mut self, step: u32, ms: u64) -> Vec<Vec<u8>> {
        let now = self.at(ms);
        std::iter::from_fn(|| self.passage.next_due(Some(step), now)).map(|piece| piece.to_vec()).collect()
    }

    /// What comes out of frames that go in one after the other.
    fn through(&mut self, frames: impl IntoIterator<Item = Vec<u8>>) -> Vec<Vec<u8>> {
        frames.into_iter().for_each(|frame| self.admit(0, 0, &frame));
        self.out(0, 0)
    }
}

/// A frame that tells which one it is.
fn frame(number: u8) -> Vec<u8> {
    vec![5, number, 0x55, 0xaa, number, 0]
}

fn frames(count: u8) -> Vec<Vec<u8>> {
    (1..=count).map(frame).collect()
}

/// Frames without the fault after them: what differs is what was hit.
fn damaged(out: &[Vec<u8>]) -> usize {
    out.iter().zip(frames(200)).filter(|(out, sent)| *out != sent).count()
}

#[test]
fn frames_pass_untouched_outside_the_fault_and_outside_steps() {
    let mut line = Line::new(&["kind = \"link-bit-flip\"\nshare = 1\nat_s = 0.1\nfor_s = 0.1"]);
    for step in [99, 200] {
        line.admit(step, 0, &frame(1));
        assert_eq!(line.out(step, 0), [frame(1)]);
    }
    line.faults.set_step(None);
    line.passage.admit(&frame(1), &line.faults, line.start);
    assert_eq!(line.out(0, 0), [frame(1)]);
    line.admit(100, 0, &frame(1));
    assert_ne!(line.out(100, 0), [frame(1)]);
    assert_eq!(line.faults.hits(0), 1);
}

#[test]
fn a_fault_of_the_other_way_leaves_this_one_alone() {
    let mut line = Line::new(&["kind = \"link-bit-flip\"\nshare = 1\nway = \"to-bench\"\nat_s = 0"]);
    assert_eq!(line.through(frames(20)), frames(20));
    assert_eq!(line.faults.hits(0), 0);
}

#[test]
fn a_frame_in_pieces_passes_when_it_is_whole_and_is_hit_once() {
    let mut line = Line::new(&["kind = \"link-bit-flip\"\nshare = 1\nat_s = 0"]);
    let sent = frame(9);
    for byte in &sent[..sent.len() - 1] {
        line.admit(0, 0, &[*byte]);
        assert!(line.out(0, 0).is_empty());
    }
    line.admit(0, 0, &[0]);
    let out = line.out(0, 0);
    let bits: u32 = out[0].iter().zip(&sent).map(|(out, sent)| (out ^ sent).count_ones()).sum();
    assert_eq!((out.len(), bits, line.faults.hits(0)), (1, 1, 1));
}

#[test]
fn a_bit_flip_changes_one_bit_of_a_fraction_of_frames() {
    let mut line = Line::new(&["kind = \"link-bit-flip\"\nshare = 0.25\nat_s = 0"]);
    let out = line.through(frames(200));
    assert_eq!(out.len(), 200);
    for (out, sent) in out.iter().zip(frames(200)) {
        let bits: u32 = out.iter().zip(&sent).map(|(out, sent)| (out ^ sent).count_ones()).sum();
        assert!(bits <= 1, "{bits} bits");
    }
    let hit = damaged(&out);
    // 50 on average, with a standard deviation of 6.
    assert!((25..=75).contains(&hit), "{hit} of 200");
    assert_eq!(line.faults.hits(0), hit as u64);
}

#[test]
fn a_lost_byte_is_one_and_the_others_keep_their_order() {
    let mut line = Line::new(&["kind = \"link-byte-loss\"\nshare = 1\nat_s = 0"]);
    let sent = [1, 2, 3, 4, 5, 0];
    let out = line.through([sent.to_vec(), sent.to_vec()]);
    assert_eq!(out.len(), 2);
    for out in out {
        let lost: Vec<_> =
            (0..sent.len()).filter(|at| [&sent[..*at], &sent[at + 1..]].concat() == out).collect();
        assert_eq!(lost.len(), 1, "{out:?}");
    }
}

#[test]
fn a_lone_byte_that_is_lost_leaves_nothing_behind() {
    let mut line = Line::new(&["kind = \"link-byte-loss\"\nshare = 1\nat_s = 0"]);
    line.admit(0, 0, &[0]);
    assert!(line.out(0, 0).is_empty() && line.passage.is_empty());
}

#[test]
fn a_burst_replaces_a_run_of_bytes_and_no_more() {
    let mut line = Line::new(&["kind = \"link-burst\"\nshare = 1\nbytes = 3\nat_s = 0"]);
    let out = line.through(frames(200));
    for (out, sent) in out.iter().zip(frames(200)) {
        assert_eq!(out.len(), sent.len());
        let changed: Vec<_> = (0..sent.len()).filter(|at| out[*at] != sent[*at]).collect();
        let spread = changed.last().zip(changed.first()).map_or(0, |(last, first)| last - first + 1);
        assert!(spread <= 3, "{changed:?}");
    }
    assert!(damaged(&out) > 190, "{}", damaged(&out));
}

#[test]
fn a_burst_longer_than_the_frame_ends_with_it() {
    let mut line = Line::new(&["kind = \"link-burst\"\nshare = 1\nbytes = 64\nat_s = 0"]);
    assert_eq!(line.through([frame(1)])[0].len(), frame(1).len());
}

#[test]
fn a_doubled_frame_comes_twice_in_a_row() {
    let mut line = Line::new(&["kind = \"link-duplicate\"\nshare = 1\nat_s = 0"]);
    assert_eq!(line.through(frames(2)), [frame(1), frame(1), frame(2), frame(2)]);
    assert_eq!(line.faults.hits(0), 2);
}

#[test]
fn an_overtaken_frame_follows_the_next_one_and_is_not_lost() {
    let mut line = Line::new(&["kind = \"link-reorder\"\nshare = 1\nat_s = 0\nfor_s = 0.004"]);
    assert_eq!(line.through(frames(4)), [frame(2), frame(1), frame(4), frame(3)]);
    assert_eq!(line.faults.hits(0), 2, "a frame that overtakes is not hit itself");
    line.admit(3, 0, &frame(5));
    assert!(line.out(3, 0).is_empty());
    line.admit(4, 0, &frame(6));
    assert_eq!(line.out(4, 0), [frame(6), frame(5)], "it comes when the fault is over as well");
}

#[test]
fn a_delay_holds_every_frame_for_its_time() {
    let mut line = Line::new(&["kind = \"link-delay\"\ndelay_ms = 10\nat_s = 0"]);
    line.admit(0, 0, &frame(1));
    line.admit(0, 4, &frame(2));
    assert!(line.out(0, 9).is_empty());
    assert_eq!(line.passage.next_release(Some(0), line.at(9)), Some(line.at(10)));
    assert_eq!(line.out(0, 10), [frame(1)]);
    assert_eq!(line.out(0, 14), [frame(2)]);
}

#[test]
fn frames_keep_their_order_under_jitter() {
    let mut line = Line::new(&["kind = \"link-delay\"\ndelay_ms = 1\njitter_ms = 50\nat_s = 0"]);
    (0..100_u8).for_each(|number| line.admit(0, number.into(), &frame(number + 1)));
    let mut late = 0;
    let mut out = Vec::new();
    for ms in 0..200 {
        let now = line.out(0, ms);
        late += usize::from(now.len() > 1);
        out.extend(now);
    }
    assert_eq!(out, frames(100));
    assert!(late > 5, "a jitter of 50 ms on frames 1 ms apart makes them come in bunches, not {late} times");
}

#[test]
fn a_delay_that_is_over_does_not_let_later_frames_overtake() {
    let mut line = Line::new(&["kind = \"link-delay\"\ndelay_ms = 10\nat_s = 0\nfor_s = 0.001"]);
    line.admit(0, 0, &frame(1));
    line.admit(1, 2, &frame(2));
    assert!(line.out(1, 9).is_empty());
    assert_eq!(line.out(1, 10), [frame(1), frame(2)]);
}

#[test]
fn a_stall_gives_everything_back_in_order_when_it_is_over() {
    let mut line = Line::new(&["kind = \"link-stall\"\nat_s = 0\nfor_s = 0.002"]);
    for number in 1..=50 {
        line.admit(0, 0, &frame(number));
    }
    assert!(line.out(1, 1_000_000).is_empty());
    assert_eq!(line.passage.next_release(Some(1), line.at(0)), None);
    line.admit(2, 0, &frame(51));
    assert_eq!(line.out(2, 0), frames(51));
}

#[test]
fn a_stall_also_holds_what_was_delayed_before_it() {
    let mut line = Line::new(&[
        "kind = \"link-delay\"\ndelay_ms = 5\nat_s = 0\nfor_s = 0.001",
        "kind = \"link-stall\"\nat_s = 0.001\nfor_s = 0.001",
    ]);
    line.admit(0, 0, &frame(1));
    assert!(line.out(1, 100).is_empty());
    assert_eq!(line.out(2, 100), [frame(1)]);
}

#[test]
fn a_stall_beyond_the_buffer_loses_the_oldest_frames() {
    let mut line = Line::new(&["kind = \"link-stall\"\nat_s = 0\nfor_s = 0.001"]);
    for number in 0..super::CAPACITY + 3 {
        line.admit(0, 0, &frame((number % 200) as u8 + 1));
    }
    let out = line.out(1, 0);
    assert_eq!((out.len(), &out[0]), (super::CAPACITY, &frame(4)));
}

#[test]
fn hits_depend_on_seed_and_direction_only() {
    let flips = "kind = \"link-bit-flip\"\nshare = 0.5\nat_s = 0";
    let out = |seed, to_drive| {
        let scenario = seeded(seed, &[flips]);
        let mut line = Line { passage: Impairment::new(&scenario, to_drive), ..Line::of(&scenario) };
        line.through(frames(100))
    };
    assert_eq!(out(3, true), out(3, true));
    assert_ne!(out(3, true), out(4, true));
    assert_ne!(out(3, true), out(3, false));
}

#[test]
fn a_stream_without_delimiters_passes_in_pieces() {
    let mut line = Line::new(&["kind = \"link-delay\"\ndelay_ms = 0\nat_s = 0"]);
    line.admit(0, 0, &[7; 200]);
    let out = line.out(0, 0).concat();
    assert_eq!(out, [7; 192], "three pieces of 64 bytes, and the rest waits for its end");
}

#[test]
fn what_is_discarded_is_gone() {
    let mut line = Line::new(&["kind = \"link-reorder\"\nshare = 1\nat_s = 0"]);
    line.admit(0, 0, &[frame(1), vec![5, 5]].concat());
    line.passage.clear();
    line.admit(0, 0, &frame(2));
    line.admit(0, 0, &frame(3));
    assert_eq!(line.out(0, 0), [frame(3), frame(2)]);
}
