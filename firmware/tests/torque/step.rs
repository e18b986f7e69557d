//! Steps of the torque.

use super::bench::{Bench, at_10_khz, believed};
use lashloop_plant::electrical::{ElectricalParameters, ReverseCurrent};

/// The torque in each of these periods after a step to `torque_nm`.
fn response(bench: &mut Bench, torque_nm: f64, periods: usize) -> Vec<f64> {
    (0..periods).map(|_| bench.period(torque_nm)).collect()
}

#[test]
fn a_step_is_63_percent_done_in_300_us_and_overshoots_by_at_most_10_percent() {
    for parameters in [at_10_khz(), ElectricalParameters::example()] {
        let mut bench = Bench::new(parameters, believed(&parameters, 1.0, 1.0));
        let torques = response(&mut bench, 5.0, 100);
        // A sample is in the middle of its period.
        let at = torques.iter().position(|torque_nm| *torque_nm >= 0.63 * 5.0).expect("a rise");
        let rise_s = at as f64 / parameters.pwm_hz;
        let overshoot = torques.iter().fold(0.0_f64, |most, it| most.max(*it)) / 5.0 - 1.0;
        println!(
            "{} Hz: 63 % after {:.0} us, overshoot {:.1} %",
            parameters.pwm_hz,
            1e6 * rise_s,
            100.0 * overshoot
        );
        assert!(rise_s <= 3e-4, "{rise_s} s");
        assert!(overshoot <= 0.1, "{overshoot}");
    }
}

/// A period of three time constants, as a modulation of 300 Hz has at this motor.
#[test]
fn a_modulation_slower_than_the_motor_leaves_the_loop_stable() {
    for pwm_hz in [1e3, 1.5e3, 3e3] {
        let parameters = ElectricalParameters { pwm_hz, inductance_h: 1.7e-4, ..at_10_khz() };
        let mut bench = Bench::new(parameters, believed(&parameters, 1.0, 1.0));
        let torques = response(&mut bench, 5.0, 200);
        let overshoot = torques.iter().fold(0.0_f64, |most, it| most.max(*it)) / 5.0 - 1.0;
        let ripple = torques[100..].iter().fold(0.0_f64, |most, it| most.max((it - 5.0).abs()));
        println!("{pwm_hz} Hz: overshoot {:.1} %, {ripple:.4} N m off in the end", 100.0 * overshoot);
        assert!(overshoot <= 0.1 && ripple <= 0.02, "{pwm_hz} Hz: {overshoot}, {ripple} N m");
    }
}

#[test]
fn resistance_and_inductance_off_by_30_percent_leave_the_loop_stable() {
    for resistance in [0.7, 1.0, 1.3] {
        for inductance in [0.7, 1.0, 1.3] {
            let parameters = at_10_khz();
            let mut bench = Bench::new(parameters, believed(&parameters, resistance, inductance));
            let torques = response(&mut bench, 5.0, 400);
            let overshoot = torques.iter().fold(0.0_f64, |most, it| most.max(*it)) / 5.0 - 1.0;
            assert!(overshoot <= 0.25, "R x {resistance}, L x {inductance}: {overshoot}");
            let ripple = torques[300..].iter().fold(0.0_f64, |most, it| most.max((it - 5.0).abs()));
            assert!(ripple <= 0.02, "R x {resistance}, L x {inductance}: {ripple} N m off in the end");
        }
    }
}

#[test]
fn an_offset_of_the_sensor_and_noise_leave_a_thousandth_of_the_limit() {
    let parameters =
        ElectricalParameters { sense_offset_a: 2.0, sense_noise_a: 0.05, ..ElectricalParameters::example() };
    let limit_nm = 20.0;
    for torque_nm in [-8.0, -0.5, 0.0, 0.5, 8.0] {
        let mut bench = Bench::new(parameters, believed(&parameters, 1.0, 1.0));
        let torques = response(&mut bench, torque_nm, 2000);
        let mean_nm = torques[1000..].iter().sum::<f64>() / 1000.0;
        assert!((mean_nm - torque_nm).abs() <= 1e-3 * limit_nm, "{mean_nm} N m for {torque_nm}");
    }
}

#[test]
fn a_turning_motor_keeps_its_torque_up_to_the_voltage_of_the_bus() {
    let parameters = ElectricalParameters::example();
    let mut bench = Bench::new(parameters, believed(&parameters, 1.0, 1.0));
    for speed_rad_s in [-100.0, 0.0, 100.0] {
        bench.speed_rad_s = speed_rad_s;
        let torques = response(&mut bench, 5.0, 200);
        assert!((torques[199] - 5.0).abs() < 0.02, "{} N m at {speed_rad_s} rad/s", torques[199]);
    }
    // 190 rad/s leave 2.4 V of the 48 V: 1.2 N m.
    bench.speed_rad_s = 190.0;
    let torques = response(&mut bench, 5.0, 200);
    assert!((0.9..1.2).contains(&torques[199]), "{} N m at 190 rad/s", torques[199]);
}

#[test]
fn a_weak_supply_winds_nothing_up() {
    let weak = ElectricalParameters { supply_v: 12.0, ..ElectricalParameters::example() };
    let mut bench = Bench::new(weak, believed(&weak, 1.0, 1.0));
    // 20 N m need 42 V. The limit lasts for 0.5 s.
    response(&mut bench, 20.0, 10_000);
    let torques = response(&mut bench, 2.0, 60);
    // As from 2 N m above: a time constant or two later the torque is there.
    let late = torques.iter().skip(20).fold(0.0_f64, |most, it| most.max((it - 2.0).abs()));
    assert!(late < 0.1, "{late} N m off 1 ms after the end of the limit");
}

#[test]
fn a_braking_motor_raises_a_bus_whose_supply_blocks() {
    for (reverse_current, rises) in [(ReverseCurrent::Taken, false), (ReverseCurrent::Blocked, true)] {
        let parameters = ElectricalParameters { reverse_current, ..ElectricalParameters::example() };
        let mut bench = Bench::new(parameters, believed(&parameters, 1.0, 1.0));
        bench.speed_rad_s = 150.0;
        // 36 V times 20.8 A, less 0.5 Ohm of losses: 530 W for 10 ms into 1 mF.
        response(&mut bench, -5.0, 200);
        assert_eq!(bench.circuit.bus_v() > 60.0, rises, "{reverse_current:?}: {} V", bench.circuit.bus_v());
    }
}
