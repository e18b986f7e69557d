use lashloop_protocol::enums::FaultCode;
use lashloop_protocol::message::FaultReport;
use rand_pcg::Pcg64;
use rand_pcg::rand_core::{Rng, SeedableRng};

use super::*;
use crate::campaign::quantiles::{Quantile, Quantiles};
use lashloop_bench::session::AtStep;
use lashloop_plant::metrics::{Measurement, Sample, SignalTable};
use lashloop_plant::{PlantError, Signal};

/// Metrics of a run without any error.
fn perfect() -> Metrics {
    metrics(0.0, 0.16, 0.0)
}

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

#[test]
fn run_that_ended_early_has_no_score() {
    let metrics = perfect();
    let of = |end: &End, verdict| {
        let scores = Scores::judged(end, verdict, &metrics, 2e-3);
        Criterion::ALL.map(|criterion| scores.get(criterion))
    };
    assert_eq!(of(&End::Complete, Verdict::Fail), [Score::Value(0.0); Criterion::ALL.len()]);
    let fault =
        FaultReport { code: FaultCode::MotorEncoderJump, sequence: 40, value: 1.0, limit: 1.0, detail: 0 };
    let fault = AtStep { step: 40, message: fault };
    let chattering = End::Diverged(PlantError::Chattering { substep_s: 1e-3 });
    let away = End::Diverged(PlantError::NotFinite { torque_nm: 1e300 });
    for (end, verdict, reason) in [
        (chattering, Verdict::Invalid, MissingReason::NotFinite),
        (away, Verdict::Fail, MissingReason::NotFinite),
        (End::DriveFault(fault), Verdict::Fail, MissingReason::CutShort),
        (End::DriveRestarted, Verdict::Invalid, MissingReason::CutShort),
        (End::Complete, Verdict::Invalid, MissingReason::CutShort),
    ] {
        assert_eq!(of(&end, verdict), [Score::Missing(reason); Criterion::ALL.len()], "{end:?}");
    }
}

#[test]
fn estimate_scores_where_the_drive_claims_it() {
    let of = |deviation_rad| {
        let metrics = metrics(0.0, 0.26, deviation_rad);
        Scores::judged(&End::Complete, Verdict::Pass, &metrics, 2e-3).get(Criterion::LearntDeadZoneError)
    };
    let learnt = of(LEARNT_DEVIATION_RAD).value().expect("a claim");
    assert!((learnt - 0.1).abs() < 1e-12, "have {learnt} rad");
    assert_eq!(of(LEARNT_DEVIATION_RAD * 1.001), Score::Missing(MissingReason::NotLearnt));
    let quantiles =
        |scores: &[Score]| Quantiles::of(scores.iter().copied()).expect("runs").get(Quantile::Max);
    let unclaimed = Score::Missing(MissingReason::NotLearnt);
    assert_eq!(
        quantiles(&[Score::Value(0.1), unclaimed]),
        Score::Value(0.1),
        "an unclaimed estimate is omitted"
    );
    assert_eq!(quantiles(&[unclaimed]), unclaimed);
}

#[test]
fn static_error_in_bands_is_relative_to_the_wider_of_2_mrad_and_a_count() {
    let metrics = metrics(-3e-3, 0.16, 0.0);
    for (band_rad, want) in [(2e-3, -1.5), (6e-3, -0.5)] {
        let scores = Scores::judged(&End::Complete, Verdict::Pass, &metrics, band_rad);
        let have = scores.get(Criterion::StaticErrorInBands).value().expect("a value");
        assert!((have - want).abs() < 1e-12, "have {have}, want {want}");
    }
}

#[test]
fn missing_and_non_finite_scores_rank_last() {
    let huge = Score::Value(f64::MAX);
    for worse in [
        Score::Value(f64::NAN),
        Score::Value(-f64::NAN),
        Score::Value(f64::INFINITY),
        Score::Value(f64::NEG_INFINITY),
        Score::Missing(MissingReason::Unmeasured),
        Score::Missing(MissingReason::Never),
        Score::Missing(MissingReason::CutShort),
        Score::Missing(MissingReason::NotFinite),
        Score::Missing(MissingReason::NotLearnt),
    ] {
        assert_eq!(huge.order(&worse), Ordering::Less, "{worse:?}");
        assert_eq!(worse.order(&huge), Ordering::Greater, "{worse:?}");
    }
}

#[test]
fn scores_read_back_to_the_same_bits() {
    // serde_json's default parser is off by one bit for some percent of all numbers.
    let mut random = Pcg64::seed_from_u64(1);
    let values = (0..10_000).map(|_| f64::from_bits(random.next_u64())).filter(|value| value.is_finite());
    let reasons = [
        MissingReason::Unmeasured,
        MissingReason::Never,
        MissingReason::CutShort,
        MissingReason::NotFinite,
        MissingReason::NotLearnt,
    ]
    .map(Score::Missing);
    for score in values.chain([-0.0, 5e-324]).map(Score::Value).chain(reasons) {
        let text = serde_json::to_string(&score).expect("a score is JSON");
        let read: Score = serde_json::from_str(&text).expect("what was written is read");
        assert_eq!(read, score, "{text}");
        assert_eq!(read.value().map(f64::to_bits), score.value().map(f64::to_bits), "{text}");
    }
}
