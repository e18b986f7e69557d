use lashloop_plant::metrics::{Measurement, Sample, SignalTable};
use lashloop_plant::{PlantError, Signal};
use lashloop_protocol::enums::FaultCode;
use lashloop_protocol::message::FaultReport;
use lashloop_session::AtStep;

use super::*;

const LEARNT_RAD: f64 = 0.015;

/// Metrics of a load that rests at an error, with an estimate of j0 and its deviation.
fn metrics(error_rad: f64, dead_zone_rad: f64, deviation_rad: f64) -> Metrics {
    let signal = |name: &'static str| Signal::new(name, "");
    let signals = SignalTable {
        plant: vec![signal("dead_zone_rad"), signal("disturbing_torque_nm")],
        drive: ["dead_zone_estimate_rad", "disturbing_torque_estimate_nm", "dead_zone_deviation_rad"]
            .map(signal)
            .to_vec(),
    };
    let mut measurement = Measurement::new(0.5, &signals);
    for step in 0..40 {
        measurement.push(&Sample {
            time_s: f64::from(step) * 0.5,
            reference_rad: 0.0,
            // Overshoot needs an initial error.
            load_position_rad: if step == 0 { 0.01 } else { error_rad },
            motor_position_rad: 0.0,
            torque_nm: 0.0,
            plant: &[0.16, 0.0],
            drive: Some(&[dead_zone_rad, 0.0, deviation_rad]),
        });
    }
    measurement.metrics()
}

/// A case whose encoders have these counts, and whose plant settles within a quarter of a second at best.
struct Case(f64);

impl CaseNumbers for Case {
    fn number(&self, _: &str) -> Option<f64> {
        Some(self.0)
    }

    fn quantity(&self, _: Divisor) -> Option<f64> {
        Some(0.25)
    }
}

fn derived() -> [Derived; 3] {
    let bands = Derived {
        name: "static_error_bands".to_owned(),
        metric: Metric::StaticError,
        per: Some(2e-3),
        or_count_of: Some("encoders.load_counts_per_rev".to_owned()),
        over: None,
        only_if: None,
    };
    let learnt = Derived {
        name: "learnt".to_owned(),
        metric: Metric::DeadZoneError,
        per: None,
        or_count_of: None,
        over: None,
        only_if: Some((Metric::DeadZoneDeviation, LEARNT_RAD)),
    };
    let relative = Derived {
        name: "over_minimum".to_owned(),
        metric: Metric::PeakTrackingError,
        per: None,
        or_count_of: None,
        over: Some(Divisor::MinimumSettleTime),
        only_if: None,
    };
    [bands, relative, learnt]
}

fn of(end: &End, verdict: Verdict, metrics: &Metrics, counts: f64) -> Vec<Cell> {
    judged(end, verdict, metrics, &derived(), &Case(counts))
}

#[test]
fn run_that_ended_early_has_no_number() {
    let metrics = metrics(0.0, 0.16, 0.0);
    let complete = of(&End::Complete, Verdict::Fail, &metrics, 1e4);
    assert_eq!(complete[Metric::SettleTime as usize], Cell::Value(0.0));
    let (code, device_time_us) = (FaultCode::MotorEncoderJump, None);
    let fault = FaultReport { code, sequence: 40, value: 1.0, limit: 1.0, detail: 0, device_time_us };
    let fault = AtStep { step: 40, message: fault }.into();
    let chattering = End::Diverged(PlantError::Chattering { substep_s: 1e-3 });
    let away = End::Diverged(PlantError::NotFinite { torque_nm: 1e300 });
    for (end, verdict, reason) in [
        (chattering, Verdict::Invalid, Missing::NotFinite),
        (away, Verdict::Fail, Missing::NotFinite),
        (End::DriveFault(fault), Verdict::Fail, Missing::CutShort),
        (End::DriveRestarted, Verdict::Invalid, Missing::CutShort),
        (End::Complete, Verdict::Invalid, Missing::CutShort),
    ] {
        let cells = of(&end, verdict, &metrics, 1e4);
        assert!(cells.iter().all(|cell| *cell == Cell::Missing(reason)), "{end:?}: {cells:?}");
    }
}

#[test]
fn conditional_column_has_a_value_where_its_condition_holds() {
    let learnt = |deviation_rad| {
        let cells = of(&End::Complete, Verdict::Pass, &metrics(0.0, 0.26, deviation_rad), 1e4);
        *cells.last().expect("the last column")
    };
    let value = learnt(LEARNT_RAD).value().expect("a value");
    assert!((value - 0.1).abs() < 1e-12, "have {value} rad");
    assert_eq!(learnt(LEARNT_RAD * 1.001), Cell::Missing(Missing::Omitted));
}

#[test]
fn static_error_in_bands_is_relative_to_the_wider_of_2_mrad_and_a_count() {
    let metrics = metrics(-3e-3, 0.16, 0.0);
    for (counts, want) in [(1e4, -1.5), (TAU / 6e-3, -0.5)] {
        let cells = of(&End::Complete, Verdict::Pass, &metrics, counts);
        let have = cells[Metric::ALL.len()].value().expect("a value");
        assert!((have - want).abs() < 1e-12, "have {have}, want {want}");
    }
}

#[test]
fn a_column_over_a_quantity_of_the_run_is_divided_by_it() {
    let cells = of(&End::Complete, Verdict::Pass, &metrics(0.02, 0.16, 0.0), 1e4);
    let have = cells[Metric::ALL.len() + 1].value().expect("a value");
    assert!((have - 0.08).abs() < 1e-12, "have {have}, want 0.02 / 0.25");
}

#[test]
fn missing_values_rank_behind_every_number_and_read_back() {
    let huge = Cell::Value(f64::MAX);
    for reason in Missing::ALL {
        let missing = Cell::Missing(reason);
        assert_eq!(huge.order(&missing), Ordering::Less, "{reason}");
        assert_eq!(missing.order(&huge), Ordering::Greater, "{reason}");
        assert_eq!(Cell::parse(reason.word()), Some(missing));
    }
    for value in [0.1 + 0.2, -0.0, 5e-324, f64::MAX] {
        let read = Cell::parse(zmij::Buffer::new().format(value)).and_then(Cell::value);
        assert_eq!(read.map(f64::to_bits), Some(value.to_bits()));
    }
    for wrong in ["", "NaN", "inf", "nothing"] {
        assert_eq!(Cell::parse(wrong), None, "{wrong}");
    }
}
