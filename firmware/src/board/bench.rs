//! The pins of bench mode and their tick.

use core::time::Duration;

use cortex_m::peripheral::NVIC;
use lashloop_protocol::enums::State;
use rtic::Mutex;

use super::Fitted;
use super::bridge_exchange;
use super::chip::Chip;
use super::device_clock::DeviceClock;
use super::encoder::Encoder;
use super::pac::Interrupt;
use super::parts::{
    BridgeSensor as _, ContactInputs as _, EncoderInput as _, PeriodTimer as _, StageLines as _,
};
use super::pwm_stage::PwmStage;
use super::tick_monitor::TickMonitor;
use crate::actuator::Actuator;
use crate::drive::{Clock, Drive, PinHardware, PinReadings};
use crate::input_filter::FILTERS;
use crate::law::LawSet;
use crate::quadrature::LARGEST_MOVE_COUNTS;

/// The power stage as the drive commands it.
pub type Stage = Actuator<PwmStage<<Fitted as Chip>::Pwm, <Fitted as Chip>::StageLines>>;

/// Limits of 16-bit encoder counters and their filters, and of a tick whose timer counts microseconds in 32 bits.
pub(super) const HARDWARE: PinHardware = PinHardware {
    largest_move_counts: LARGEST_MOVE_COUNTS,
    filters: &FILTERS,
    stage_modes: <Fitted as Chip>::StageLines::MODES,
    longest_period_us: u32::MAX,
    measures_current: <Fitted as Chip>::Sensor::EXISTS,
    has_index: [<Fitted as Chip>::MotorEncoder::HAS_INDEX, <Fitted as Chip>::LoadEncoder::HAS_INDEX],
};

/// The tick and the encoders, for the task of TIM5.
pub struct Tick {
    timer: <Fitted as Chip>::Tick,
    period: Duration,
    /// The next tick is overdue after this time: 1.5 periods.
    overdue_us: u32,
    /// Pulses that the filters of the encoders are to stop.
    filter_ns: u32,
    motor: Encoder<<Fitted as Chip>::MotorEncoder>,
    load: Encoder<<Fitted as Chip>::LoadEncoder>,
    contacts: <Fitted as Chip>::Contacts,
    clock: DeviceClock,
}

impl Tick {
    /// Starts ticking with this period.
    pub(super) fn start(
        timer: <Fitted as Chip>::Tick,
        (motor, load, contacts): (
            <Fitted as Chip>::MotorEncoder,
            <Fitted as Chip>::LoadEncoder,
            <Fitted as Chip>::Contacts,
        ),
        clock: DeviceClock,
        period: Duration,
    ) -> Self {
        let (motor, load) = (Encoder::new(motor), Encoder::new(load));
        let mut tick = Self {
            timer,
            period: Duration::ZERO,
            overdue_us: u32::MAX,
            filter_ns: 0,
            motor,
            load,
            contacts,
            clock,
        };
        tick.set_period(period);
        tick
    }

    /// Makes the control step that is due. To be called once per interrupt.
    pub fn step<L: LawSet>(
        &mut self,
        drive: &mut Drive<L>,
        stage: &mut Stage,
        monitor: &mut impl Mutex<T = Option<TickMonitor>>,
    ) {
        self.timer.clear();
        // A run that continues has the period at hand; otherwise reading it is a tenth of a step.
        let period = match drive.state() {
            State::Running => drive.run_period().unwrap_or(self.period),
            _ => drive.period(),
        };
        if period != self.period {
            // A run may have started since the last tick. Its first tick is a period of its own after this one.
            self.set_period(period);
            self.restart(monitor);
            return;
        }
        self.restart(monitor);
        let filter_ns = drive.encoder_filter_ns();
        if filter_ns != self.filter_ns {
            self.filter_ns = filter_ns;
            self.motor.set_filter(filter_ns);
            self.load.set_filter(filter_ns);
        }
        let since_due = Duration::from_micros(self.timer.count_us().into());
        let due = self.clock.now().saturating_sub(since_due);
        let needs_sensor = drive.measures_current();
        let measured = bridge_exchange::take_measured();
        stage.stage_mut().expect_sensor(needs_sensor, measured.is_some(), self.period);
        // Until the first offset it measures in any case.
        <Fitted as Chip>::Sensor::listen(
            needs_sensor || bridge_exchange::OFFSET_IS_PLAUSIBLE.get().is_none(),
        );
        let readings = PinReadings {
            motor: self.motor.read(),
            load: self.load.read(),
            contacts: self.contacts.closed(),
            stage_fault: stage.fault(),
            torque_nm: measured.map(|[torque_nm, _]| torque_nm),
            bridge_voltage_v: measured.map_or(0.0, |[_, voltage_v]| voltage_v),
        };
        drive.sample(&readings, due, &self.clock);
        if let Some(side) = drive.awaited_index() {
            let index = if side == 0 { self.motor.take_index() } else { self.load.take_index() };
            drive.note_index(side, index);
        }
        // The next tick is due already. The timer shows it even if device time has lost milliseconds in a step that kept
        // SysTick waiting.
        if self.timer.has_ended() {
            drive.miss_tick(self.clock.now());
        }
        stage.follow(drive.stage_command());
    }

    fn restart(&self, monitor: &mut impl Mutex<T = Option<TickMonitor>>) {
        monitor.lock(|monitor| {
            if let Some(monitor) = monitor {
                monitor.restart(self.overdue_us);
            }
        });
    }

    /// Sets the period of the tick; one that the timer can't count leaves it unchanged, and the drive doesn't arm.
    fn set_period(&mut self, period: Duration) {
        self.period = period;
        if let Ok(micros) = u32::try_from(period.as_micros()) {
            self.timer.restart(micros);
            // A period may have ended before the restart, and its interrupt may pend.
            self.timer.clear();
            NVIC::unpend(Interrupt::TIM5);
            self.overdue_us = micros.saturating_add(micros / 2);
        }
    }
}
