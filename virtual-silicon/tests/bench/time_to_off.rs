//! How long each cause takes to turn the bridge off.

use std::num::NonZero;
use std::thread;
use std::time::Duration;

use lashloop_protocol::message::{ClearFault, FaultReport, Reset};
use lashloop_silicon::symbols::Symbols;

use crate::bench::image;
use crate::causes::{Cause, fail, last_tick};
use crate::failures::{failing, place};
use crate::host::{Host, SESSION};

const MS: Duration = Duration::from_millis(1);

/// A measurement of each cause, or of something else, as many at once as there are cores.
pub fn of_each<C: Sync, T: Send>(causes: &[&C], measure: impl Fn(&C) -> T + Sync) -> Vec<T> {
    let cores = thread::available_parallelism().map_or(1, NonZero::get);
    let measure = &measure;
    thread::scope(|scope| {
        let chunks = causes.chunks(causes.len().div_ceil(cores));
        let threads: Vec<_> = chunks
            .map(|chunk| scope.spawn(move || chunk.iter().map(|it| measure(it)).collect::<Vec<_>>()))
            .collect();
        threads.into_iter().flat_map(|thread| thread.join().expect("measurements")).collect()
    })
}

impl Cause {
    /// The image with a place for the failure.
    pub fn image(&self, image: &Symbols) -> Symbols {
        if self.code.is_some() { failing(image) } else { image.clone() }
    }

    /// Puts the failure into its place.
    pub fn place(&self, host: &mut Host, image: &Symbols) {
        let Some(code) = self.code else { return };
        place(host, &code(image));
    }

    /// Device time from the cause to the bridge off in this image, at each of these control periods and fractions of it after a
    /// tick at which the cause comes; `None` if the bridge is on for 5 ms more than it may.
    pub fn times_to_off(&self, image: &Symbols, instants: &[(Duration, f64)]) -> Vec<Option<Duration>> {
        let mut host = Host::under_torque(&self.image(image), instants[0].0);
        self.place(&mut host, image);
        // A handler of a fatal failure ends the frame on the line.
        host.expects_cut_frame = self.halts;
        let mut times = Vec::new();
        for (k, (period, phase)) in instants.iter().enumerate() {
            if k > 0 {
                host.period = *period;
                recover(&mut host);
            }
            (self.prepare)(&mut host);
            let tick = last_tick(&mut host);
            host.bench.advance_to(tick + 2 * *period + period.mul_f64(*phase));
            let instant = (self.happen)(&mut host);
            let limit = (self.limit)(*period);
            let end = instant + limit + 5 * MS;
            while host.bench.now() < end {
                if self.is_referred {
                    host.refer(1.0);
                }
                host.bench.advance(MS);
            }
            let off = host.bench.time_to_off(instant);
            if off.is_some_and(|off| off <= limit) {
                let faults: Vec<_> = host.faults().iter().map(|report| report.code).collect();
                assert_eq!(faults, Vec::from_iter(self.fault), "{}", self.name);
            } else {
                // The test fails, or the image is a mutant whose watchdog resets it.
                host.bench.allow_resets();
            }
            assert!(off.is_some() || k == 0, "{}: off and on again", self.name);
            times.push(off);
            if off.is_none() {
                break;
            }
        }
        times
    }
}

/// From any state of a drive that is not halted to a run under torque.
fn recover(host: &mut Host) {
    host.bench.turn(0.0, 0.0);
    host.bench.act(|chip, _| chip.drive_break(Some(false)));
    host.bench.advance(2 * MS);
    host.shake_hands(SESSION);
    host.command(ClearFault {});
    // The identity repeats a latched fault.
    host.faults();
    host.command(Reset {});
    host.shake_hands(SESSION);
    host.set_all(&[]);
    host.run_under_torque();
    // Ticks of the former period don't measure lateness.
    host.bench.act(|_, site| site.log.ticks.clear());
    host.steps(3, 1.0);
}

/// The fault report of a failure of the firmware, which comes while the report of a step is on the line.
pub fn report_of(cause: &Cause) -> FaultReport {
    let mut host = Host::under_torque(&cause.image(&image()), MS);
    cause.place(&mut host, &image());
    host.expects_cut_frame = true;
    // Whatever lies below the stack is taken for a frame by a handler that believes it.
    let guard = image().variable("STACK_GUARD").expect("the guard below the stack");
    host.bench.act(move |chip, _| {
        for address in (guard..guard + 1_024).step_by(4) {
            chip.set_word(address, 0x0bad_0bad).expect("memory");
        }
    });
    fail(&mut host);
    let [report] = host.faults()[..] else { panic!("{}: one report", cause.name) };
    report
}
