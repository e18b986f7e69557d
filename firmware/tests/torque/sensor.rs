//! A sensor of the current that is wrong, and circuits that only look so.

use super::bench::{Bench, at_10_khz, believed};
use lashloop_plant::electrical::ElectricalParameters;

#[test]
fn a_sensor_that_shows_nothing_or_the_reverse_is_found_within_2_ms() {
    for (sense, supply_v) in [(0.0, 24.0), (0.0, 48.0), (-1.0, 24.0), (-1.0, 48.0)] {
        for (torque_nm, speed_rad_s) in [(5.0, 0.0), (-0.5, 0.0), (5.0, 40.0), (5.0, -40.0), (-8.0, 40.0)] {
            let parameters = ElectricalParameters { supply_v, ..ElectricalParameters::example() };
            let mut bench = Bench::new(parameters, believed(&parameters, 1.0, 1.0));
            bench.speed_rad_s = speed_rad_s;
            (0..200).for_each(|_| {
                bench.period(0.0);
            });
            assert!(!bench.is_doubted);
            bench.sense = sense;
            let found = (1..=40).find(|_| {
                bench.period(torque_nm);
                bench.is_doubted
            });
            let case = format!("{sense} of the current, {supply_v} V, {torque_nm} N m, {speed_rad_s} rad/s");
            let found = found.unwrap_or_else(|| panic!("{case}: not found"));
            println!("{case}: after {} us, at {:.0} A", 50 * found, bench.circuit.current_a());
        }
    }
}

#[test]
fn no_weak_supply_dead_time_or_wrong_resistance_makes_a_sensor_wrong() {
    for (resistance, inductance) in [(0.7, 0.7), (0.7, 1.3), (1.0, 1.0), (1.3, 0.7), (1.3, 1.3)] {
        for supply_v in [12.0, 24.0, 48.0] {
            for speed_rad_s in [-120.0, -40.0, 0.0, 40.0, 120.0] {
                let parameters = ElectricalParameters {
                    supply_v,
                    dead_time_s: 1e-6,
                    sense_noise_a: 0.2,
                    supply_resistance_ohm: 0.1,
                    ..at_10_khz()
                };
                let mut bench = Bench::new(parameters, believed(&parameters, resistance, inductance));
                bench.speed_rad_s = speed_rad_s;
                for torque_nm in [5.0, -5.0, 0.0, 0.3, -0.3, 12.0, -12.0, 1.0, -1.0] {
                    for _ in 0..60 {
                        bench.period(torque_nm);
                    }
                    let case =
                        format!("R x {resistance}, L x {inductance}, {supply_v} V, {speed_rad_s} rad/s");
                    assert!(!bench.is_doubted, "{case}: doubted at {torque_nm} N m");
                }
            }
        }
    }
}
