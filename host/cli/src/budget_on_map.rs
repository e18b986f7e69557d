//! `lashloop budget --measured`: measures a line and prints where it lies on a map.

use std::time::Duration;

use lashloop_bench::device::{DeviceChoice, LineSpeed};
use lashloop_bench::run::real_time::PERIOD_MARGIN;
use lashloop_bench::scenario::Scenario;
use lashloop_bench::verdict::Exit;
use lashloop_campaign::budget::line_map::{LineMap, MapError};
use lashloop_campaign::budget::placement::Placement;
use lashloop_campaign::budget::point::Point;
use lashloop_campaign::map::PlaceError;
use lashloop_hardware::doctor::measured_line::MeasuredLine;
use lashloop_hardware::doctor::round_trip::Timing;
use lashloop_link::latency_timer::LatencyTimer;

use super::error::CliError;
use super::options::DEFAULT_BAUD;
use super::output::outln;
use super::supervision::start_supervisor;

/// A line to measure, and the map that it is placed on.
pub(super) struct Placing<'a> {
    pub(super) port: &'a DeviceChoice,
    /// Instead of the scenario's, in bit/s.
    pub(super) baud: Option<u32>,
    /// Instead of the scenario's.
    pub(super) period_us: Option<u32>,
    /// Samples of the measurement.
    pub(super) rounds: u32,
    pub(super) map: &'a LineMap,
    /// The scenario whose law decides; without one, every law of the map does.
    pub(super) scenario: Option<&'a Scenario>,
}

impl Placing<'_> {
    pub(super) fn run(&self) -> Result<Exit, CliError> {
        let chosen = self.scenario.map(|scenario| self.map.of_law(scenario)).transpose()?;
        let line = MeasuredLine::measure(self.port, self.speed(), self.rounds, &start_supervisor()?)?;
        let Timing { p50, p99, max, answered, lost, .. } = line.timing;
        let [p50_us, p99_us, max_us] = [p50, p99, max].map(|time| time.as_secs_f64() * 1e6);
        outln!(
            "{:<15}{}: {} samples answered, {} lost; round trip p50 {p50_us:.1} us, p99 {p99_us:.1} us, max {max_us:.1} us",
            "line",
            self.port,
            answered,
            lost
        );
        let law = chosen.map(|variant| variant.scenario.controller.name.as_str());
        let is_inside = match Placement::new(self.map, Point::of(p50, p99, answered, lost)) {
            Ok(placement) => {
                outln!("{placement}");
                placement.is_inside(law)
            }
            // Nothing shows that a law tolerates such a line.
            Err(beyond @ PlaceError::Beyond { .. }) => {
                outln!("{:<15}{}", "map", MapError::from(beyond));
                false
            }
            Err(error) => return Err(MapError::from(error).into()),
        };
        if let Some(difference) = chosen.zip(self.scenario).and_then(|(it, scenario)| it.difference(scenario))
        {
            outln!(
                "{:<15}{difference}: the map is of another loop, and may not hold; run a campaign of this scenario",
                "warning"
            );
        }
        self.real_time(p99);
        if let Some(LatencyTimer::Shortened { from_ms }) = line.latency_timer {
            outln!("{:<15}was {from_ms} ms, set to 1 ms until the adapter is unplugged", "latency timer");
        }
        if !is_inside {
            outln!("{:<15}{}", "remedy", remedy(&line));
        }
        Ok(if is_inside { Exit::Pass } else { Exit::Fail })
    }

    fn speed(&self) -> LineSpeed {
        let of_scenario = self.scenario.map(|scenario| LineSpeed::from(&scenario.link));
        let speed = of_scenario.unwrap_or_else(|| DEFAULT_BAUD.into());
        let chosen = |baud| self.baud.unwrap_or(baud);
        LineSpeed { baud: chosen(speed.baud), modelled_baud: speed.modelled_baud.map(chosen) }
    }

    /// What the bench makes of the round trip in real time: no delay, but steps without a torque.
    fn real_time(&self, p99: Duration) {
        let of_map = || self.map.variants.first().map_or(1000, |it| it.scenario.run.control_period_us);
        let of_scenario = self.scenario.map(|scenario| scenario.run.control_period_us);
        let period_us = self.period_us.or(of_scenario).unwrap_or_else(of_map);
        let deadline_us = period_us - period_us / PERIOD_MARGIN;
        let effect = if p99 <= Duration::from_micros(deadline_us.into()) {
            "p99 meets it"
        } else {
            "p99 exceeds it: the torque is late, the last one is held, INVALID unless [allow] permits it; lockstep waits"
        };
        outln!("{:<15}deadline {deadline_us} us of a period of {period_us} us; {effect}", "real time");
    }
}

fn remedy(line: &MeasuredLine) -> String {
    let timer = line.latency_timer.as_ref();
    if let Some(remedy) = timer.and_then(LatencyTimer::remedy) {
        return format!("the latency timer is {remedy}");
    }
    "shorten the round trip: a latency timer of 1 ms (`lashloop doctor` has the command), no hub, no virtual machine, \
     a higher baud rate; or take a law that is inside"
        .to_owned()
}
