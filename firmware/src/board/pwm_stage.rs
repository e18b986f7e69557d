//! The power stage: pulse-width modulation. A board has its lines to amplifier or bridge.

use core::time::Duration;

use super::bridge_exchange::{self, BridgeCommand, COMMAND, FAULT, HAS_BUS, OFFSET_IS_PLAUSIBLE, RUN};
use super::parts::{CORE_HZ, Outputs, PwmTimer, StageLines};
use crate::actuator::PowerStage;
use crate::power_stage::{Modulation, PowerStageFault, StageMode};
use crate::torque::TorqueSource;

/// Longest time of a run by the current without a sample, unless its modulation is slow.
const MOST_UNMEASURED: Duration = Duration::from_millis(1);

/// The power stage of a board.
pub struct PwmStage<T, S> {
    timer: T,
    lines: S,
    modulation: Option<Modulation>,
    /// High time of a duty of 1, in counts of the timer.
    period_counts: u16,
    /// Whether the next run needs the sensor of the current.
    needs_sensor: bool,
    /// Time of a run since the tick that last had a measurement.
    unmeasured: Duration,
}

impl<T: PwmTimer, S: StageLines> PwmStage<T, S> {
    /// The stage with a timer that runs with its main output off.
    pub(super) fn new(timer: T, lines: S) -> Self {
        let mut stage = Self {
            timer,
            lines,
            modulation: None,
            period_counts: 0,
            needs_sensor: false,
            unmeasured: Duration::ZERO,
        };
        if let Some(mode) = S::MODES.first() {
            stage.select(*mode, 20_000, false);
        }
        stage.timer.update();
        stage
    }

    /// Selects outputs and frequency, while the outputs are off. Those that the mode doesn't use are not driven.
    fn select(&mut self, mode: StageMode, frequency_hz: u32, is_centred: bool) {
        let cycles = CORE_HZ / (frequency_hz.max(1) * if is_centred { 2 } else { 1 });
        let cycles_per_count = cycles / u32::from(u16::MAX) + 1;
        // Both fit in 16 bits from 1 Hz on.
        self.period_counts = (cycles / cycles_per_count) as u16;
        let outputs = Outputs {
            has_second: mode != StageMode::Amplifier,
            has_complements: mode == StageMode::Complementary,
        };
        self.timer.select(cycles_per_count as u16, self.period_counts, is_centred, outputs);
    }

    /// Tells whether the next run needs the sensor of the current, and whether it has measured since the last tick, of this period.
    pub(super) fn expect_sensor(&mut self, needs_sensor: bool, has_measured: bool, period: Duration) {
        self.needs_sensor = needs_sensor;
        self.unmeasured =
            if has_measured || self.modulation.is_none() { Duration::ZERO } else { self.unmeasured + period };
    }

    /// Whether a run by the current continues without samples: the bridge keeps its last duty, and nothing finds an overcurrent.
    fn is_blind(&self) -> bool {
        let by_current = |it: &&Modulation| it.source == TorqueSource::Current;
        self.modulation.as_ref().filter(by_current).is_some_and(|modulation| {
            // A tick may come before the first sample, and a slow modulation has ticks without one.
            let period = Duration::from_secs(1) / modulation.frequency_hz.max(1);
            self.unmeasured > (3 * period).max(MOST_UNMEASURED)
        })
    }

    /// Sets the high times of both channels, 0 to 1.
    fn set_channels(&mut self, high: [f32; 2]) {
        let [first, second] = high.map(|high| (high * f32::from(self.period_counts) + 0.5) as u16);
        // Both take effect in the same period of the modulation: an update between the two would turn one half-bridge alone.
        let before = self.timer.count();
        self.timer.set_high(first, second);
        // An update that was due meanwhile is lost, and a modulation at the rate of the tick could lose every one.
        if self.timer.count() < before {
            self.timer.update();
        }
    }
}

impl<T: PwmTimer, S: StageLines> PowerStage for PwmStage<T, S> {
    fn enable(&mut self, modulation: &Modulation) {
        self.modulation = Some(*modulation);
        let is_measured = modulation.source == TorqueSource::Current;
        self.select(modulation.mode, modulation.frequency_hz, is_measured);
        if is_measured && OFFSET_IS_PLAUSIBLE.get() != Some(true) {
            // The stage stays off, and the next tick finds the fault.
            FAULT.set(Some(PowerStageFault::CurrentSensor));
            return;
        }
        if is_measured {
            self.set_channels(modulation.bridge_channels(0.0));
            bridge_exchange::begin(*modulation, self.period_counts);
        } else {
            self.set_channels(modulation.channels(0.0, 0.0));
        }
        // From the preload to counter and comparator before the output is on.
        self.timer.update();
        // The monitor of the tick and the loop interrupt tasks; between read and write their trip would be undone, and so would one
        // since the run began.
        cortex_m::interrupt::free(|_| {
            if FAULT.get().is_none() {
                self.timer.enable_outputs();
                self.lines.enable();
            }
        });
    }

    fn apply(&mut self, torque_nm: f32, speed_rad_s: f32) {
        match &self.modulation {
            Some(modulation) if modulation.source == TorqueSource::Current => {
                COMMAND.set(BridgeCommand { torque_nm, speed_rad_s });
            }
            Some(modulation) => self.set_channels(modulation.channels(torque_nm, speed_rad_s)),
            None => {}
        }
    }

    fn disable(&mut self) {
        S::switch_off();
        RUN.set(None);
        self.modulation = None;
    }

    fn fault(&mut self) -> Option<PowerStageFault> {
        // The timer keeps a pulse of the input; the pin has the level.
        if self.timer.take_break() {
            return Some(PowerStageFault::BreakInput);
        }
        let of_lines = self.lines.fault(self.modulation.is_none());
        let of_loop = of_lines.or_else(bridge_exchange::take_fault);
        let has_no_offset = self.needs_sensor && OFFSET_IS_PLAUSIBLE.get() != Some(true);
        let of_sensor = (has_no_offset || self.is_blind()).then_some(PowerStageFault::CurrentSensor);
        let is_off = self.needs_sensor && self.modulation.is_none() && !HAS_BUS.get();
        of_loop.or(of_sensor).or(is_off.then_some(PowerStageFault::NoSupply))
    }
}
