//! The run's side of the feed: collects buckets and publishes them at most thirty times a second.

use std::sync::Arc;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use lashloop_bench::run::{Event, RunStart, Step};
use lashloop_bench::timing::ClockName;
use lashloop_plant::Signal;
use lashloop_record::samples::{Encoder, Place, StepTimes};
use serde::Serialize;

use super::envelope::{Bucketing, History};
use super::feed::Feed;
use super::foxglove;
use super::messages::Message;
use super::panels::{Panel, columns, panels};
use super::status::Status;

/// Shortest time between two publications.
const FRAME: Duration = Duration::from_millis(33);
/// Buckets of the whole run.
const OVERVIEW_BUCKETS: u32 = 4000;
/// Duration of a bucket of the latest part, and their number.
const RECENT_BUCKET_S: f64 = 0.01;
const RECENT_BUCKETS: u32 = 2000;

/// Publishes the steps of one run.
pub struct Publisher {
    feed: Arc<Feed>,
    tiers: Vec<Tier>,
    /// The values of a step, one per column.
    values: Vec<f32>,
    /// From the start of the run on.
    encoder: Option<Encoder>,
    /// Encoded and not yet published.
    messages: Vec<Message>,
    published: Option<Instant>,
    status: Option<Arc<str>>,
}

/// Buckets of one width.
struct Tier {
    bucketing: Bucketing,
    /// Completed and not yet published.
    completed: Vec<f32>,
}

/// What a reader needs to know before the samples.
#[derive(Serialize)]
struct Description<'a> {
    kind: &'static str,
    title: &'a str,
    scenario: &'a str,
    device: &'a str,
    controller: &'a str,
    clock: ClockName,
    duration_s: f64,
    /// Buckets that each history keeps at most.
    histories: Vec<u32>,
    columns: &'a [Signal],
    panels: Vec<Panel>,
}

impl Publisher {
    pub(super) fn new(feed: Arc<Feed>) -> Self {
        Self {
            feed,
            tiers: Vec::new(),
            values: Vec::new(),
            encoder: None,
            messages: Vec::new(),
            published: None,
            status: None,
        }
    }

    /// The run is about to start; `now` is wall-clock time.
    pub fn begin(&mut self, start: &RunStart<'_>, now: SystemTime) {
        let RunStart { scenario, clock, device, signals } = *start;
        let columns = columns(signals);
        let widths = bucket_widths(scenario.run.steps(), scenario.run.control_period_s());
        let tier = |&(width, _): &(u32, u32)| Tier {
            bucketing: Bucketing::new(width, columns.len()),
            completed: Vec::new(),
        };
        self.tiers = widths.iter().map(tier).collect();
        self.values = Vec::with_capacity(columns.len());
        let description = Description {
            kind: "description",
            title: &scenario.title,
            scenario: &scenario.name,
            device: &device.description(),
            controller: &scenario.controller.name,
            clock: clock.name(),
            duration_s: scenario.run.duration_s,
            histories: widths.iter().map(|(_, kept)| *kept).collect(),
            columns: &columns,
            panels: panels(&columns, clock.name()),
        };
        let start_ns = now.duration_since(UNIX_EPOCH).unwrap_or_default().as_nanos() as u64;
        let times = StepTimes { start_ns, period_us: scenario.run.control_period_us };
        let encoder = Encoder::new(signals, times, 0);
        let clock = clock.name().to_string();
        let metadata = [
            ("scenario", &*scenario.name),
            ("device", description.device),
            ("controller", &scenario.controller.name),
            ("clock", &clock),
        ];
        let name = format!("lashloop: {}", scenario.name);
        let introduction = foxglove::introduction(&name, &metadata, &start_ns.to_string(), &encoder.topics());
        self.encoder = Some(encoder);
        let description = json(&description);
        self.feed.change(|state| {
            state.description = Some(description);
            state.introduction = Some(Arc::new(introduction));
            state.histories =
                widths.iter().map(|(_, kept)| History::new(columns.len(), *kept as usize)).collect();
        });
    }

    /// Takes a step; `now` is wall-clock time.
    pub fn step(&mut self, step: &Step, now: Instant) {
        let row = &step.row;
        self.values.clear();
        let fixed = [row.reference_rad, row.load_position_rad, row.motor_position_rad, row.torque_nm];
        self.values
            .extend(fixed.iter().chain(&step.plant).chain(&step.drive.values).map(|&value| value as f32));
        let microseconds = |time: Duration| time.as_nanos() as f32 / 1e3;
        let round_trip = step.timing.round_trip.map_or(f32::NAN, |trip| microseconds(trip.total()));
        self.values.extend([microseconds(step.timing.lateness), round_trip]);
        for tier in &mut self.tiers {
            tier.bucketing.push(row.time_s, &self.values, &mut tier.completed);
        }
        let Self { encoder, messages, .. } = self;
        if let Some(encoder) = encoder {
            encoder.step(step, |place, data| messages.push(message(place, data)));
        }
        if self.published.is_none_or(|last| now.saturating_duration_since(last) >= FRAME) {
            // While a reader copies, the next step tries again.
            let Self { feed, tiers, messages, status, .. } = self;
            let is_published = feed.try_change(|state| {
                state.messages.append(messages);
                for (history, tier) in state.histories.iter_mut().zip(tiers) {
                    history.append(&tier.completed);
                    tier.completed.clear();
                }
                if let Some(status) = status.take() {
                    state.set_status(status);
                }
            });
            if is_published {
                self.published = Some(now);
            }
        }
    }

    /// Takes an event of a step; the next publication has it.
    pub fn event(&mut self, step: u32, event: &Event) {
        let Self { encoder, messages, .. } = self;
        if let Some(encoder) = encoder {
            encoder.event(step, event, |place, data| messages.push(message(place, data)));
        }
    }

    /// Shows a status with the next publication.
    pub fn show(&mut self, status: &Status) {
        self.status = Some(json(status));
    }

    /// Publishes what is left.
    pub fn finish(&mut self) {
        let Self { feed, tiers, messages, status, .. } = self;
        feed.change(|state| {
            state.messages.append(messages);
            for (history, tier) in state.histories.iter_mut().zip(tiers) {
                tier.bucketing.finish(&mut tier.completed);
                history.append(&tier.completed);
            }
            if let Some(status) = status.take() {
                state.set_status(status);
            }
        });
    }

    /// Whether a reader has asked for the end of the run.
    #[must_use]
    pub fn stop_asked(&self) -> bool {
        self.feed.stop_asked()
    }
}

fn message(Place { topic, log_time_ns, .. }: Place, data: &[u8]) -> Message {
    Message { topic, log_time_ns, data: data.into() }
}

/// Steps per bucket and number of buckets: those of the whole run, and finer ones of its latest part if they are finer.
fn bucket_widths(steps: u32, period_s: f64) -> Vec<(u32, u32)> {
    let overview = steps.div_ceil(OVERVIEW_BUCKETS);
    let recent = ((RECENT_BUCKET_S / period_s).round() as u32).max(1);
    // In bench mode the drive's clock decides, and a run has more steps than planned.
    let overview = (overview, OVERVIEW_BUCKETS + OVERVIEW_BUCKETS / 4);
    if recent < overview.0 { vec![overview, (recent, RECENT_BUCKETS)] } else { vec![overview] }
}

/// # Panics
/// Never: the values have names and numbers only.
pub(super) fn json(value: &impl Serialize) -> Arc<str> {
    serde_json::to_string(value).expect("strings and finite or null numbers").into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_run_has_fine_buckets_of_its_latest_part() {
        assert_eq!(bucket_widths(25_000, 1e-3), [(7, 5000)]);
        assert_eq!(bucket_widths(600_000, 1e-3), [(150, 5000), (10, 2000)]);
        assert_eq!(bucket_widths(100, 1e-1), [(1, 5000)]);
    }
}
