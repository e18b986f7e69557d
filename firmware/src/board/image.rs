//! The program of the board: the library's drive between its line and the device clock.

/// Makes an image for the board: a drive with these laws between its line and the device clock.
///
/// The image is a file of three lines, with `lashloop-firmware` under the feature `image`:
///
/// ```text
/// #![no_std]
/// #![no_main]
/// lashloop_firmware::image!(my_law::Laws);
/// ```
///
/// It has eight tasks. `usart` queues every byte on arrival, and sends queued ones. `tick` counts the device clock and checks
/// the watchdog every millisecond. `serve` feeds received bytes of the USART and the USB port to the drive and passes its
/// output on. In HIL mode the control law has no timer: the encoder frame is the tick. `step` is the tick of bench mode; the
/// emulator has no timer for it. `monitor` switches the power stage off if the next tick is overdue, and `overdue` latches
/// the fault. `sample` is the current loop of a bridge. Each task that may change the state of the drive applies it to the power stage before it ends.
///
/// | task | bound to | priority | why there |
/// |---|---|---|---|
/// | `monitor` | TIM2 | 4 | a step that never ends leaves no torque on |
/// | `sample` | the converters of the board | 4 | a duty is due half a period after its sample |
/// | `usart` | the serial port of the board | 3 | 11 us from one byte to the next |
/// | `tick` | SysTick | 2 | the watchdog counts while `serve` is sending |
/// | `step` | TIM5 | 2 | a control step waits for one request at most |
/// | `overdue` | EXTI0, pended by `monitor` | 2 | the drive belongs to tasks of this priority |
/// | `serve` | OTG_FS, pended by the others too | 1 | a pended interrupt is never lost, however often it is pended |
/// | `idle` | | 0 | sleeps |
#[macro_export]
macro_rules! image {
    ($laws:ty) => {
        $crate::image_of_board!($laws);
    };
    ($laws:ty, $usart:ident, $sensor:ident) => {
        type LawsOfImage = $laws;

        // RTIC's expansion takes the peripherals and unmasks interrupts. Nothing else here is unsafe.
        #[allow(unsafe_code)]
        #[$crate::board::rtic::app(device = $crate::board::pac)]
        mod app {
            use core::sync::atomic::{AtomicU32, Ordering};

            use $crate::drive::{Clock, Drive};
            use $crate::board::pac::Interrupt;
            use $crate::board::{self, BenchTasks, Board, BridgeLoop, DeviceClock, LineError, Lines, Memory, Stage, Tick, TickMonitor, Ticker, UsartInterrupt};
            use $crate::board::{cortex_m, rtic};

            use super::LawsOfImage;

            #[shared]
            struct Shared {
                drive: Drive<LawsOfImage>,
                stage: Option<Stage>,
                monitor: Option<TickMonitor>,
                clock: DeviceClock,
                line_errors: AtomicU32,
            }

            #[local]
            struct Local {
                ticker: Ticker,
                steps: Option<Tick>,
                bridge: Option<BridgeLoop>,
                usart: UsartInterrupt,
                lines: Lines,
            }

            #[init(local = [memory: Memory = Memory::new()])]
            fn init(cx: init::Context) -> (Shared, Local) {
                let Board { drive, bench, clock, ticker, usart, lines } =
                    board::start((cx.core.SYST, &cx.core.MPU), cx.device, cx.local.memory);
                let (stage, steps, monitor, bridge) = match bench {
                    Some(BenchTasks { stage, steps, monitor, bridge }) => {
                        (Some(stage), Some(steps), Some(monitor), Some(bridge))
                    }
                    None => (None, None, None, None),
                };
                let shared = Shared { drive, stage, monitor, clock, line_errors: AtomicU32::new(0) };
                (shared, Local { ticker, steps, bridge, usart, lines })
            }

            #[task(binds = $usart, priority = 3, local = [usart], shared = [&line_errors])]
            fn usart(cx: usart::Context) {
                let to_serve = cx.local.usart.serve().unwrap_or_else(|LineError| {
                    cx.shared.line_errors.fetch_add(1, Ordering::Relaxed);
                    true
                });
                if to_serve {
                    rtic::pend(Interrupt::OTG_FS);
                }
            }

            #[task(binds = SysTick, priority = 2, local = [ticker], shared = [drive, stage])]
            fn tick(cx: tick::Context) {
                let now = cx.local.ticker.count_millisecond();
                let to_send = (cx.shared.drive, cx.shared.stage).lock(|drive, stage| {
                    drive.tick(now);
                    if let Some(stage) = stage {
                        stage.follow(drive.stage_command());
                    }
                    if drive.enters_loader(now) {
                        board::loader::enter();
                    }
                    drive.has_output()
                });
                if to_send {
                    rtic::pend(Interrupt::OTG_FS);
                }
            }

            #[task(binds = TIM5, priority = 2, local = [steps], shared = [drive, stage, monitor])]
            fn step(cx: step::Context) {
                let mut monitor = cx.shared.monitor;
                let to_send = (cx.shared.drive, cx.shared.stage).lock(|drive, stage| {
                    if let (Some(steps), Some(stage)) = (cx.local.steps, stage) {
                        steps.step(drive, stage, &mut monitor);
                    }
                    drive.has_output()
                });
                if to_send {
                    rtic::pend(Interrupt::OTG_FS);
                }
            }

            #[task(binds = TIM2, priority = 4, shared = [monitor])]
            fn monitor(mut cx: monitor::Context) {
                cx.shared.monitor.lock(|monitor| {
                    if let Some(monitor) = monitor {
                        monitor.trip();
                    }
                });
                rtic::pend(Interrupt::EXTI0);
            }

            #[task(binds = $sensor, priority = 4, local = [bridge])]
            fn sample(cx: sample::Context) {
                if let Some(bridge) = cx.local.bridge {
                    bridge.step();
                }
            }

            #[task(binds = EXTI0, priority = 2, shared = [drive, stage, &clock])]
            fn overdue(cx: overdue::Context) {
                let now = cx.shared.clock.now();
                (cx.shared.drive, cx.shared.stage).lock(|drive, stage| {
                    drive.miss_tick(now);
                    if let Some(stage) = stage {
                        stage.follow(drive.stage_command());
                    }
                });
                rtic::pend(Interrupt::OTG_FS);
            }

            #[task(binds = OTG_FS, priority = 1, local = [lines], shared = [drive, stage, &clock, &line_errors])]
            fn serve(mut cx: serve::Context) {
                let lost = cx.shared.line_errors.swap(0, Ordering::Relaxed);
                if lost > 0 {
                    cx.shared.drive.lock(|drive| drive.note_overruns(lost));
                }
                let lines = cx.local.lines;
                lines.poll();
                loop {
                    let has_moved = (&mut cx.shared.drive, &mut cx.shared.stage).lock(|drive, stage| {
                        let has_moved = lines.exchange(drive, cx.shared.clock) | drive.continue_storing();
                        if let Some(stage) = stage {
                            stage.follow(drive.stage_command());
                        }
                        has_moved
                    });
                    if !has_moved {
                        break;
                    }
                    // By polling it takes longer than a control step, so it runs outside the lock, where the others can
                    // interrupt it.
                    lines.send();
                }
            }

            #[idle]
            fn idle(_: idle::Context) -> ! {
                loop {
                    cortex_m::asm::wfi();
                }
            }
        }
    };
}

// `image_of_board!`: the image with the interrupts of the board's link and converters.
include!(concat!(env!("OUT_DIR"), "/image_of_board.rs"));
