//! The power stage: pulse-width modulation. A board has its lines to amplifier or bridge.

use super::parts::{CORE_HZ, Outputs, PwmTimer, StageLines};
use crate::power_stage::{Modulation, PowerStage, PowerStageFault, StageMode};

/// The power stage of a board.
pub struct PwmStage<T, S> {
    timer: T,
    lines: S,
    modulation: Option<Modulation>,
    /// Counts of the timer in a period of the modulation.
    period_counts: u16,
}

impl<T: PwmTimer, S: StageLines> PwmStage<T, S> {
    /// The stage with a timer that runs with its main output off.
    pub(super) fn new(timer: T, lines: S) -> Self {
        let mut stage = Self { timer, lines, modulation: None, period_counts: 0 };
        if let Some(mode) = S::MODES.first() {
            stage.select(*mode, 20_000);
        }
        stage.timer.update();
        stage
    }

    /// Selects outputs and frequency, while the outputs are off. Those that the mode doesn't use are not driven.
    fn select(&mut self, mode: StageMode, frequency_hz: u32) {
        let cycles = CORE_HZ / frequency_hz.max(1);
        let cycles_per_count = cycles / u32::from(u16::MAX) + 1;
        // Both fit in 16 bits from 1 Hz on.
        self.period_counts = (cycles / cycles_per_count) as u16;
        let outputs = Outputs {
            has_second: mode != StageMode::Amplifier,
            has_complements: mode == StageMode::Complementary,
        };
        self.timer.select(cycles_per_count as u16, self.period_counts, outputs);
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
        self.select(modulation.mode, modulation.frequency_hz);
        self.set_channels(modulation.channels(0.0));
        // From the preload to counter and comparator before the output is on.
        self.timer.update();
        // The monitor of the tick interrupts tasks; between read and write its trip would be undone.
        cortex_m::interrupt::free(|_| self.timer.enable_outputs());
        self.lines.enable();
    }

    fn apply(&mut self, torque_nm: f32) {
        if let Some(modulation) = &self.modulation {
            self.set_channels(modulation.channels(torque_nm));
        }
    }

    fn disable(&mut self) {
        S::switch_off();
        self.modulation = None;
    }

    fn fault(&mut self) -> Option<PowerStageFault> {
        // The timer keeps a pulse of the input; the pin has the level.
        if self.timer.take_break() {
            Some(PowerStageFault::BreakInput)
        } else {
            self.lines.fault(self.modulation.is_none())
        }
    }
}
