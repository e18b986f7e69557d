//! Running an image from reset until its surroundings end it.

use std::ops::ControlFlow;
use std::time::Duration;

use anyhow::{Context, Result};
use rigless::emulator::{self, AccessKind, Driver, Hit, Host, Settled, Start, Stop};
use rigless::image::Image;
use rigless::session::Session;
use rigless::time::VirtualNanos;

use crate::access::Violations;
use crate::chip::Chip;
use crate::converter_trigger::ConverterTrigger;
use crate::inputs::Inputs;
use crate::lsi_capture::LsiCapture;
use crate::pins::{Bridge, Pins};
use crate::surroundings::{Arrival, End, Surroundings};
use crate::wiring::Wiring;

/// Device time of the surroundings' first turn.
const FIRST_TURN: VirtualNanos = VirtualNanos(50_000);

/// A run that has ended.
pub struct Ended<S> {
    /// The surroundings as the run left them.
    pub surroundings: S,
    /// Why the run ended; `None` after a violation.
    pub end: Option<End>,
    /// Accesses that the chip would not have served.
    pub violations: Violations,
    /// Device time since reset.
    pub device_time: Duration,
    /// Instructions since reset.
    pub instructions: u64,
    /// Resets of the chip after the first.
    pub resets: usize,
}

/// Boots an image from reset and runs it until its surroundings end it, or until an access that the chip would not have
/// served.
///
/// # Errors
/// The image can't be placed, or the processor locked up.
pub fn run<S: Surroundings + 'static>(image: Image, wiring: Wiring, surroundings: S) -> Result<Ended<S>> {
    let chip = Chip::new(&wiring, surroundings.crystal_hz(), surroundings.has_mpu())?;
    let images: Vec<_> = [image].into_iter().chain(surroundings.kept()).collect();
    let session = Session::new(Box::new(chip), 0, FIRST_TURN).context("the chip can't be set up")?;
    let machine = Machine {
        surroundings,
        wiring,
        inputs: Inputs::default(),
        lsi: LsiCapture::after_reset(VirtualNanos(0)),
        due: FIRST_TURN,
        edge: None,
        trigger: ConverterTrigger::default(),
        resets: 0,
        end: None,
        bridge: None,
    };
    let finished = emulator::run(session, &Start::new(&images), machine).context("the image can't run")?;
    let stop = finished.stop.context("the image ended the emulation itself")?;
    Ok(Ended {
        surroundings: finished.driver.surroundings,
        end: finished.driver.end,
        violations: Violations::of(&finished.session),
        device_time: Duration::from_nanos(stop.at.0),
        instructions: stop.instruction_count,
        resets: finished.session.resets().len(),
    })
}

/// The surroundings as the emulator calls them.
struct Machine<S> {
    surroundings: S,
    wiring: Wiring,
    inputs: Inputs,
    lsi: LsiCapture,
    /// The surroundings' next turn.
    due: VirtualNanos,
    /// The next edge of the low-speed oscillator.
    edge: Option<VirtualNanos>,
    trigger: ConverterTrigger,
    /// Resets of the chip that the inputs have followed.
    resets: usize,
    end: Option<End>,
    /// The bridge as last reported.
    bridge: Option<Bridge>,
}

/// Reports the bridge to surroundings that watch it, if it isn't the one last reported.
fn watch_bridge(surroundings: &mut impl Surroundings, last: &mut Option<Bridge>, chip: &mut Pins<'_>) {
    if surroundings.watches_bridge() {
        let bridge = chip.bridge();
        if last.replace(bridge) != Some(bridge) {
            surroundings.bridge_changed(chip.now(), bridge);
        }
    }
}

impl<S: Surroundings> Driver<Chip> for Machine<S> {
    fn on_settled(&mut self, session: &mut Session<Chip>, host: &mut dyn Host, settled: Settled) {
        let at = match settled {
            Settled::Access { access, .. } => {
                let at = Duration::from_nanos(access.virtual_time.0);
                self.surroundings.accessed(at, &access);
                // No reading changes the bridge, and an image polls.
                if access.kind == AccessKind::Read {
                    return;
                }
                let ports = session.board_mut().part.registers().ports;
                self.inputs.note_write(ports, access.address);
                if !self.surroundings.crystal_starts() {
                    session.board_mut().hold_crystal(access.virtual_time, access.address);
                }
                access.virtual_time
            }
            Settled::Hit(Hit { address, at, instruction_count: instructions, .. }) => {
                let at = Duration::from_nanos(at.0);
                self.surroundings.arrived(Arrival { address, at, instructions });
                return;
            }
            Settled::Stop(stop) => stop.at,
            _ => return,
        };
        let mut chip = Pins::new(session, host, at, &self.wiring, &mut self.inputs);
        watch_bridge(&mut self.surroundings, &mut self.bridge, &mut chip);
    }

    fn on_stop(
        &mut self,
        session: &mut Session<Chip>,
        stop: Stop,
        host: &mut dyn Host,
    ) -> Option<VirtualNanos> {
        if Violations::are_in(session) {
            return None;
        }
        if session.resets().len() != self.resets {
            self.resets = session.resets().len();
            self.inputs = Inputs::default();
            self.lsi = LsiCapture::after_reset(stop.at);
            self.trigger = ConverterTrigger::default();
        }
        let edge = self.lsi.turn(session.board_mut(), stop.at);
        let is_for_edge = std::mem::replace(&mut self.edge, edge) == Some(stop.at);
        let samples = self.trigger.is_due(stop.at);
        let next_of = |due: VirtualNanos, others: [Option<VirtualNanos>; 2]| {
            Some(others.into_iter().flatten().fold(due, VirtualNanos::min))
        };
        if is_for_edge && stop.at < self.due && !samples {
            let trigger = self.trigger.turn(session.board_mut(), stop.at);
            return next_of(self.due, [edge, trigger]);
        }
        self.inputs.settle(session.board_mut(), &self.wiring, stop.at);
        let chip = Pins::new(session, host, stop.at, &self.wiring, &mut self.inputs);
        let mut chip = chip.at_sample(samples);
        let next = self.surroundings.turn(&mut chip);
        watch_bridge(&mut self.surroundings, &mut self.bridge, &mut chip);
        // The surroundings have put their voltages on the pins.
        let trigger = self.trigger.turn(session.board_mut(), stop.at);
        match next {
            ControlFlow::Continue(next) => {
                let nanoseconds = u64::try_from(next.as_nanos()).unwrap_or(u64::MAX);
                self.due = VirtualNanos(nanoseconds.max(stop.at.0 + 1));
                next_of(self.due, [edge, trigger])
            }
            ControlFlow::Break(end) => {
                self.end = Some(end);
                None
            }
        }
    }
}
