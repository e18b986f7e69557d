//! The lines of a servo amplifier, or of a bridge without a gate driver to configure: ready and enable.

use super::parts::{PwmTimer, StageLines};
use crate::power_stage::{PowerStageFault, StageMode};

/// Both lines of a board.
pub trait AmplifierLines: Send + 'static {
    /// The timer of the power stage.
    type Timer: PwmTimer;

    /// Whether the ready line, which is also the break input of the timer, is high: the power stage isn't ready.
    fn is_broken(&self) -> bool;

    /// Raises the enable line.
    fn raise_enable(&mut self);

    /// Lowers the enable line, from any code: by a store that has no other effect.
    fn lower_enable();

    /// Sets the line of a brake resistor, from any code: by a store that has no other effect. A board may have none.
    fn set_brake(_is_high: bool) {}
}

impl<L: AmplifierLines> StageLines for L {
    const MODES: &'static [StageMode] = &[
        StageMode::Amplifier,
        StageMode::PwmDirection,
        StageMode::TwoPwmCoast,
        StageMode::TwoPwmBrake,
        StageMode::Complementary,
    ];
    // 500 ns: more than drivers with their own dead time and discrete switches for 24 to 48 V need.
    const DEAD_TIME_CYCLES: u8 = 84;
    const HAS_BREAK: bool = true;

    fn enable(&mut self) {
        self.raise_enable();
    }

    fn fault(&mut self, _is_off: bool) -> Option<PowerStageFault> {
        self.is_broken().then_some(PowerStageFault::BreakInput)
    }

    fn set_brake(is_on: bool) {
        L::set_brake(is_on);
    }

    #[inline(never)]
    fn switch_off() {
        L::Timer::disable_outputs();
        L::lower_enable();
        // A loop that still samples a bus above its limit raises it again.
        L::set_brake(false);
    }
}
