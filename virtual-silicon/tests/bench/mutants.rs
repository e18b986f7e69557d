//! Images with one careless place: the measurements of `off` have to notice each.

use std::time::Duration;

use lashloop_silicon::symbols::Symbols;
use lashloop_silicon::thumb::{Code, FOREVER, RETURN};

use crate::bench::{image, odrive_image};
use crate::causes::{CAUSES, Cause, cause};
use crate::time_to_off::of_each;

/// Control period, and the fraction of it at which a cause comes.
const INSTANT: (Duration, f64) = (Duration::from_millis(1), 0.17);

/// Whether the measurement of a cause notices this image.
fn is_noticed(cause: &Cause, image: &Symbols) -> bool {
    let times = cause.times_to_off(image, &[INSTANT]);
    times.iter().any(|off| off.is_none_or(|off| off > (cause.limit)(INSTANT.0)))
}

#[test]
fn an_image_that_never_switches_off_is_noticed_by_every_cause_of_software() {
    let careless = image().without("switch_off").expect("the function");
    let by_hardware = [
        "all tasks stopped",
        "lock-up: a fault at the priority of HardFault",
        "break input",
        "break wire open",
    ];
    let software: Vec<_> = CAUSES.iter().filter(|cause| !by_hardware.contains(&cause.name)).collect();
    let noticed = of_each(&software, |cause| (cause.name, is_noticed(cause, &careless)));
    for (name, is_noticed) in noticed {
        assert!(is_noticed, "{name}");
    }
    for name in by_hardware {
        assert!(!is_noticed(cause(name), &careless), "{name} needs no software");
    }
}

#[test]
fn a_handler_that_halts_without_switching_off_is_noticed() {
    for (name, handler) in [
        ("panic", "rust_begin_unwind"),
        ("HardFault", "__cortex_m_rt_HardFault"),
        ("unexpected interrupt", "DefaultHandler"),
    ] {
        let careless =
            image().with_code(handler, |_| Code::default().halfword(FOREVER)).expect("the handler");
        // Interrupts stay on in such a handler, at a priority above that of every task.
        assert!(is_noticed(cause(name), &careless), "{name}");
    }
}

#[test]
fn a_watchdog_that_never_times_out_is_noticed() {
    // The result by reference, Ok as the code after the last one of a fault: movs r1, #20; strb r1, [r0, #12].
    let ok = Code::default().halfwords(&[0x2114, 0x7301, RETURN]);
    let careless = image().with_code("Watchdog::check", |_| ok).expect("the watchdog");
    assert!(is_noticed(cause("host silent"), &careless));
    assert!(!is_noticed(cause("Stop"), &careless), "everything else works");
}

#[test]
fn a_monitor_of_the_tick_that_does_nothing_is_noticed() {
    let careless = image().without_calls("TIM2", "switch_off").expect("a call");
    assert!(is_noticed(cause("step that never ends"), &careless));
}

#[test]
fn a_request_that_is_not_applied_to_the_stage_is_noticed() {
    // The image without the call of `Actuator::follow` in the task that serves requests: later tasks switch off.
    let careless = image().without_calls("OTG_FS", "follow").expect("a call");
    let off = cause("Stop").times_to_off(&careless, &[INSTANT])[0];
    let careful = cause("Stop").times_to_off(&image(), &[INSTANT])[0].expect("the bridge off");
    assert!(off.is_none_or(|off| off > careful), "{off:?} {careful:?}");
}

#[test]
fn a_break_input_that_is_not_enabled_is_noticed() {
    // The value of TIM1's BDTR is lock level 1, off-state idle, break enabled and active high, and the dead time. movw rN, #0x3554,
    // and the same without the break.
    let pieces = (0..13_u16).map(|register| {
        let [with, without] =
            [0xf243, 0xf240].map(|movw| Code::default().halfwords(&[movw, 0x5054 | register << 8]));
        image().with_piece("__rtic_init_resources", &with, &without)
    });
    let careless = pieces.flatten().next().expect("the value of BDTR in a register");
    assert!(is_noticed(cause("break input"), &careless));
}

#[test]
fn an_image_that_switches_off_one_of_two_half_bridges_is_noticed() {
    // TIM1's CCER with channel 2 and its complement alone: movs r1, #0x50; str r1, [r0].
    let one = Code::default().load(0, 0x4001_0020).halfwords(&[0x2150, 0x6001, RETURN]);
    let careless = odrive_image().with_code("switch_off", |_| one).expect("the function");
    for name in ["Stop", "host silent", "panic"] {
        assert!(is_noticed(cause(name), &careless), "{name}");
    }
}
