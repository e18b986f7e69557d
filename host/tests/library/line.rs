//! `[line]`: a modelled line between the law and the motor.

use lashloop::{Bench, Outcome};

use super::in_process;

const SHAFT: &str = "../scenarios/shaft-braking-curve.toml";

fn on_line(settings: &[&str]) -> Outcome {
    let settings = [&["run.duration_s=3", "expect=[]"], settings].concat();
    in_process(&Bench::new(), SHAFT, &settings).expect("a run")
}

#[test]
fn a_constant_line_is_the_plants_own_delay_bit_for_bit() {
    for whole_and_part in [["line.delay_us=2000", "3000"], ["line.delay_us=250", "1250"]] {
        let [line, together] = whole_and_part;
        let plant = format!("plant.torque_delay_us={together}");
        let [line, plant] = [on_line(&[line]), on_line(&[&plant])];
        assert_eq!(line.torque_sha256(), plant.torque_sha256());
        assert_ne!(line.torque_sha256(), on_line(&[]).torque_sha256());
    }
}

#[test]
fn jitter_and_loss_repeat_with_the_seed_of_the_run() {
    for setting in ["line.jitter_us=5000", "line.loss=0.1"] {
        let with_seed = |seed: &str| on_line(&[setting, seed]).torque_sha256().to_owned();
        assert_eq!(with_seed("run.seed=1"), with_seed("run.seed=1"), "{setting}");
        assert_ne!(with_seed("run.seed=1"), with_seed("run.seed=2"), "{setting}");
        assert_ne!(with_seed("run.seed=1"), on_line(&["run.seed=1"]).torque_sha256(), "{setting}");
    }
}

#[test]
fn the_motor_of_a_line_that_loses_every_torque_stays_at_rest() {
    let outcome = on_line(&["line.loss=1"]);
    let motor_rad = outcome.signal("motor_position_rad").expect("a column");
    let torque_nm = outcome.signal("torque_nm").expect("a column");
    assert!(torque_nm.iter().any(|torque_nm| *torque_nm != 0.0), "the law commands torque");
    let moved_rad = motor_rad.iter().map(|rad| (rad - motor_rad[0]).abs()).fold(0.0, f64::max);
    assert!(moved_rad < 1e-9, "the motor moved by {moved_rad} rad");
}

#[test]
fn bench_mode_rejects_a_modelled_line() {
    for setting in ["line.delay_us=1", "line.jitter_us=1", "line.loss=0.5"] {
        let settings = ["run.mode=bench", setting];
        let error =
            Bench::new().scenario("../scenarios/bench-smooth-after.toml", &settings).expect_err(setting);
        assert!(error.to_string().contains("no effect in bench mode"), "{error}");
    }
}
