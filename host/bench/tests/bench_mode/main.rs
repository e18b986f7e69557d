//! Runs in bench mode: a drive with encoders, power stage and plant in this process.

mod line;
mod real_time;
mod run;

use lashloop_bench::run::{End, RunError};
use lashloop_bench::scenario::{Override, Scenario};
use lashloop_bench::timing::StepOutcome;
use lashloop_bench::verdict::{AnswerRule, Verdict};
use lashloop_plant::metrics::{Measured, Metric};
use lashloop_protocol::EncoderCounts;
use lashloop_protocol::enums::FaultCode;

use line::{Action, Line};
use run::{SMOOTH_AFTER, on_pins, read, scenario, without_pins};

/// 0.2 s of a move without an expectation.
const SHORT: [&str; 2] = ["run.duration_s=0.2", "expect=[]"];

#[test]
fn the_paper_scenarios_pass_and_repeat_bit_for_bit() {
    for text in run::PAPER {
        let scenario = scenario(text, &[]);
        let runs = [(); 2].map(|()| on_pins(&scenario, Line::default()).expect("a run"));
        let [first, second] = runs.map(|run| run.outcome);
        assert_eq!(
            (first.judgement.verdict, &first.end),
            (Verdict::Pass, &End::Complete),
            "{}",
            scenario.title
        );
        assert_eq!(first.torque_sha256, second.torque_sha256, "{}", scenario.title);
        assert_eq!((first.steps, first.link.lost), (25_000, 0));
    }
}

#[test]
fn positions_are_those_of_the_encoders_and_the_plant_has_no_columns_of_numbers() {
    let run = on_pins(&scenario(SMOOTH_AFTER, &SHORT), Line::default()).expect("a run");
    assert!(
        run.outcome.signals.plant.iter().any(|signal| signal.name == "twist_rad"),
        "columns as in HIL mode"
    );
    let count_rad = std::f64::consts::TAU / 131_072.0;
    for step in &run.steps {
        assert!(step.plant.iter().all(|value| value.is_nan()));
        let counts = (step.row.load_position_rad - std::f64::consts::FRAC_PI_2) / count_rad;
        assert!((counts - counts.round()).abs() < 1e-6, "a whole number of counts: {counts}");
    }
    let moved = |step: usize| run.steps[step].row.motor_position_rad - run.steps[0].row.motor_position_rad;
    assert!(moved(100) < -1.0, "the motor moves towards the reference, by {} rad", moved(100));
}

#[test]
fn metrics_that_need_truth_are_not_measured() {
    let metrics = on_pins(&scenario(SMOOTH_AFTER, &SHORT), Line::default()).expect("a run").outcome.metrics;
    for metric in [Metric::DeadZoneError, Metric::DisturbingTorqueRmsError] {
        assert_eq!(metrics.get(metric), Measured::NoTruth, "{metric}");
        assert_eq!(metrics.get(metric).to_string(), "not measured on a bench");
    }
    assert!(metrics.get(Metric::PeakTorque).value().is_some());
}

#[test]
fn an_expectation_on_truth_is_rejected_before_the_run() {
    for quantity in ["metric = \"dead_zone_error_rad\"", "signal = \"twist_rad\"\nstatistic = \"max\""] {
        let text = format!("{SMOOTH_AFTER}\n[[expect]]\n{quantity}\nunit = \"rad\"\nmax = 1.0\n");
        let error = read(&text, &[]).expect_err("an expectation on truth");
        assert!(error.contains("is not measured on a bench"), "{error}");
        read(&text, &[Override::Mode("hil".to_owned())]).expect("HIL mode measures it");
    }
}

#[test]
fn what_acts_on_a_simulated_loop_is_rejected_by_name() {
    for (more, want) in [
        ("[[fault]]\nat_s = 1.0\nkind = \"encoder-stuck\"\n", "fault.0.kind: encoder-stuck"),
        ("[[fault]]\nat_s = 1.0\nkind = \"torque-dead\"\n", "fault.0.kind: torque-dead"),
        ("[[fault]]\nat_s = 1.0\nkind = \"link-duplicate\"\nshare = 0.1\n", "fault.0.kind: link-duplicate"),
        ("[link]\non_loss = \"resume\"\n", "link.on_loss: resume"),
        ("[plant.initial]\nload_velocity_rad_s = 1.0\n", "plant.initial"),
    ] {
        let error = read(&format!("{SMOOTH_AFTER}\n{more}"), &[]).expect_err("not in bench mode");
        assert!(error.replace('"', "").contains(want), "{want}: {error}");
    }
    for key in ["noise_counts", "motor_noise_counts", "load_eccentricity_rad"] {
        let error = Override::Set(format!("encoders.{key}=0.1"));
        assert!(read(SMOOTH_AFTER, &[error]).expect_err("an error of an encoder").contains(key));
    }
    for kind in ["link-cut", "link-stall"] {
        let text = format!("{SMOOTH_AFTER}\n[[fault]]\nat_s = 1.0\nfor_s = 0.1\nkind = \"{kind}\"\n");
        read(&text, &[]).expect("the link can be lost in bench mode");
    }
}

#[test]
fn the_pins_of_the_scenario_survive_being_printed() {
    let first = scenario(SMOOTH_AFTER, &["bench.load_direction=reverse"]);
    let printed = first.to_toml().expect("TOML");
    let again = read(&printed, &[]).unwrap_or_else(|errors| panic!("{errors}\n{printed}"));
    let values = |it: &Scenario| {
        it.bench.parameters.iter().map(|it| (it.name.clone(), it.value.clone())).collect::<Vec<_>>()
    };
    assert_eq!((values(&again), again.run), (values(&first), first.run));
}

#[test]
fn a_drive_without_bench_mode_is_rejected_before_arm() {
    let error = without_pins(&scenario(SMOOTH_AFTER, &SHORT)).expect_err("no bench mode");
    assert!(matches!(error, RunError::Device(_)), "{error}");
    assert!(error.to_string().contains("no parameter sample_source"), "{error}");
}

#[test]
fn a_wrong_direction_is_named_within_two_rad() {
    for key in ["motor_direction", "torque_direction"] {
        for [load_rad, motor_rad] in [[1.5, 4.5], [-0.5, -1.5]] {
            let start = [("load", load_rad), ("motor", motor_rad)]
                .map(|(mass, rad)| format!("plant.initial.{mass}_position_rad={rad}"));
            let reverse = format!("bench.{key}=reverse");
            let scenario = scenario(SMOOTH_AFTER, &[&reverse, &start[0], &start[1]]);
            let end = on_pins(&scenario, Line::default()).expect("a run").outcome.end;
            let text = end.to_string();
            let End::DriveFault(fault) = end else { panic!("{text}") };
            assert_eq!(fault.message.code, FaultCode::MotorAgainstTorque, "{text}");
            // The load behind a soft shaft may not have moved yet.
            assert!(text.contains("reverse ") && text.contains(key), "{text}");
            assert!((1.0..2.0).contains(&fault.message.value), "{text}");
        }
    }
}

#[test]
fn a_load_beyond_its_travel_ends_the_run() {
    // The open loop pushes the load away from its start at pi/2 rad.
    let push = [
        "controller.name=open-loop",
        "controller.parameters={}",
        "reference.position_rad=4",
        "bench.twist_limit_rad=1000",
        "run.duration_s=5",
        "expect=[]",
        "meant=[\"start\", \"large-angle\", \"mismatch\"]",
    ];
    for (limit, start, zero_rad, limit_rad) in [
        ("bench.load_travel_limit_rad=2", "initial", 0.0, 2.0),
        ("bench.load_travel_limit_rad=0.5", "anywhere", std::f64::consts::FRAC_PI_2, 0.5),
    ] {
        let start = format!("bench.start={start}");
        let run = on_pins(&scenario(SMOOTH_AFTER, &[&push[..], &[limit, &start]].concat()), Line::default())
            .expect("a run");
        let reached_rad = match &run.outcome.end {
            // The drive knows its zero, and stops without the host.
            End::DriveFault(report) if zero_rad == 0.0 => {
                assert_eq!(report.code, FaultCode::LoadTravel);
                f64::from(report.value) + std::f64::consts::FRAC_PI_2
            }
            End::BeyondTravel { reached_rad, .. } if zero_rad != 0.0 => *reached_rad,
            other => panic!("{other}"),
        };
        assert_eq!(run.outcome.judgement.verdict, Verdict::Fail);
        assert!(reached_rad > limit_rad && reached_rad < limit_rad + 0.02, "{reached_rad}");
        let travels: Vec<_> =
            run.steps.iter().map(|step| (step.row.load_position_rad - zero_rad).abs()).collect();
        let (last, before) = travels.split_last().expect("steps");
        assert!(before.iter().all(|travel| *travel <= limit_rad), "ended at once");
        let is_end_of_drive = matches!(run.outcome.end, End::DriveFault(_));
        // The drive's fault takes the place of its last step.
        let next_rad = if is_end_of_drive { 2.0 * last - before.last().expect("steps") } else { *last };
        let a_count_rad = std::f64::consts::TAU / 131_072.0;
        let tolerance_rad = if is_end_of_drive { 2.0 * a_count_rad } else { 0.0 };
        assert!((next_rad - reached_rad).abs() <= tolerance_rad, "{reached_rad}");
    }
}

#[test]
fn a_cut_link_ends_the_run_without_a_verdict() {
    let cut = format!("{SMOOTH_AFTER}\n[[fault]]\nat_s = 0.1\nfor_s = 1.0\nkind = \"link-cut\"\n");
    let error = on_pins(&scenario(&cut, &SHORT), Line::default()).expect_err("a lost drive");
    assert!(matches!(error, RunError::Device(_)), "{error}");
    assert!(error.to_string().contains("closed the line"), "{error}");
}

#[test]
fn a_silent_host_trips_the_watchdog_of_the_drive() {
    // Two periods, for each of which a bench in lockstep waits a second of the drive's time.
    let stall = format!("{SMOOTH_AFTER}\n[[fault]]\nat_s = 0.1\nfor_s = 0.002\nkind = \"link-stall\"\n");
    let run = on_pins(&scenario(&stall, &SHORT), Line::default()).expect("a run");
    let End::DriveFault(fault) = &run.outcome.end else { panic!("{}", run.outcome.end) };
    assert_eq!(fault.code, FaultCode::Watchdog);
    assert_eq!(
        run.outcome.judgement.verdict,
        Verdict::Invalid,
        "the host judges no drive by its own silence"
    );
}

#[test]
fn a_lost_report_repeats_the_last_measurement() {
    let lossy = || Line::at(50, Action::Drop);
    let run = on_pins(&scenario(SMOOTH_AFTER, &SHORT), lossy()).expect("a run");
    assert_eq!((run.outcome.link.lost, run.outcome.steps), (1, 200));
    assert_eq!(run.outcome.judgement.verdict, Verdict::Invalid);
    let [before, lost] = [&run.steps[49], &run.steps[50]];
    assert_eq!(lost.timing.outcome, StepOutcome::Unanswered);
    assert_eq!(
        (lost.row.load_position_rad, lost.row.torque_nm),
        (before.row.load_position_rad, before.row.torque_nm)
    );
    assert_eq!(lost.row.time_s, 0.05);
    let allowed = scenario(SMOOTH_AFTER, &[SHORT[0], SHORT[1], "allow.lost=1"]);
    assert_eq!(on_pins(&allowed, lossy()).expect("a run").outcome.judgement.verdict, Verdict::Pass);
}

#[test]
fn a_report_that_breaks_a_rule_fails_the_run() {
    type IsBroken = fn(&AnswerRule) -> bool;
    let actions: [(Action, IsBroken); 3] = [
        (Action::Torque(26.0), |rule| matches!(rule, AnswerRule::WithinLimit { .. })),
        (Action::Torque(f32::NAN), |rule| matches!(rule, AnswerRule::Finite { .. })),
        (Action::Reference(4000), |rule| matches!(rule, AnswerRule::ReferenceSent { number: 4000 })),
    ];
    for (action, is_broken) in actions {
        let outcome = on_pins(&scenario(SMOOTH_AFTER, &SHORT), Line::at(50, action)).expect("a run").outcome;
        let broken = outcome.end.broken_rule().unwrap_or_else(|| panic!("{action:?}: {}", outcome.end));
        assert!(is_broken(&broken.rule) && broken.step == 50, "{broken}");
        assert_eq!(outcome.judgement.verdict, Verdict::Fail);
    }
}

#[test]
fn a_plant_behind_the_pins_needs_the_scale_of_its_amplifier() {
    let text = SMOOTH_AFTER.replace("torque_per_duty_nm = 62.5\n", "");
    let error = on_pins(&scenario(&text, &SHORT), Line::default()).expect_err("no scale").to_string();
    assert!(error.contains("set bench.torque_per_duty_nm"), "{error}");
}

#[test]
fn a_load_away_from_its_start_is_rejected_at_the_first_step() {
    let moved = Line::always(Action::LoadOffset(EncoderCounts::wrapping(2_000)));
    let error = on_pins(&scenario(SMOOTH_AFTER, &SHORT), moved).expect_err("a load away from its start");
    assert!(error.to_string().contains("bring the load to its start"), "{error}");
}
