//! A commissioning as runs of the drive in this process.

use lashloop::execution::OpenDrive;
use lashloop::{Bench, Scenario};
use lashloop_bench::run::Clock;
use lashloop_bench::scenario::{Override, RunMode, ScenarioErrors};
use lashloop_bench::supervisor::Supervisor;
use lashloop_hardware::commission::{OnDevice, settings};
use lashloop_hardware::identify::files::{DriveUse, drive_toml, plant_toml, table};
use lashloop_identify::excitation::{Commissioned, CommissioningError, Limits, commission};
use lashloop_identify::{Identified, Instruments, Start};

const SCENARIO: &str = include_str!("../../../../scenarios/commission.toml");
const LIMITS: Limits =
    Limits { torque_nm: 20.0, motor_speed_rad_s: 400.0, load_speed_rad_s: 10.0, load_travel_rad: 1.5 };
/// Another bench than the paper's, on which the estimation starts.
const PLANT: [&str; 6] = [
    "plant.motor_inertia_kg_m2=1.3e-3",
    "plant.load_inertia_kg_m2=5.0",
    "plant.stiffness_nm_rad=1.4",
    "plant.dead_zone_rad=0.09",
    "plant.load_friction_asymmetry=0.1",
    "plant.reduction_ratio=4.0",
];

fn commissioned(
    limits: &Limits,
    more: &[&str],
) -> Result<Commissioned, CommissioningError<lashloop_hardware::commission::MotionError>> {
    let scenario = |settings_of_motion: &[String]| -> Result<Scenario, ScenarioErrors> {
        let plant = PLANT.iter().chain(more).map(|it| (*it).to_owned());
        let all = plant.chain(settings(limits)).chain(settings_of_motion.iter().cloned());
        Scenario::from_str("commission.toml", SCENARIO, &all.map(Override::Set).collect::<Vec<_>>())
    };
    let folder = tempfile::tempdir().expect("a folder");
    let supervisor = Supervisor::without_signals(None).expect("threads");
    let instruments = Instruments::exact(4000, 4000, 1000);
    let device = Bench::new().device("inproc").expect("a device");
    let template = scenario(&[]).expect("a scenario");
    let drive = OpenDrive::open(&template, (&device).into(), Clock::Lockstep, &supervisor);
    let mut drive_train = OnDevice {
        scenario: &scenario,
        drive: drive.expect("a drive"),
        mode: template.run.mode,
        instruments,
        period_s: 1e-3,
        folder: folder.path(),
        writer: &|_| Ok(None),
        record: &mut |_| Ok(()),
    };
    commission(&mut drive_train, &instruments, limits, 1000, &Start::default())
}

fn of_drive(mode: RunMode) -> DriveUse {
    DriveUse { mode, torque_limit_nm: LIMITS.torque_nm }
}

/// Asserts that the interval of a quantity contains a value and is no wider than a fraction of it.
pub fn assert_shown(identified: &Identified, name: &str, truth: f64, fraction: f64) {
    let estimate = identified.quantity(name).and_then(|it| it.estimate);
    let estimate = estimate.unwrap_or_else(|| panic!("{name} is not observed"));
    assert!((estimate.low..=estimate.high).contains(&truth), "{name}: {estimate:?}, truth {truth}");
    assert!(estimate.high - estimate.low < fraction * truth, "{name}: {estimate:?} is wide");
}

#[test]
fn runs_of_the_open_loop_law_show_the_plant_of_the_scenario() {
    let Commissioned { identified, breakaway, records, .. } = commissioned(&LIMITS, &[]).expect("estimates");
    assert!(identified.is_followed(), "{:?}", identified.residual_counts);
    for (name, truth) in [
        ("motor_inertia_kg_m2", 1.3e-3),
        ("load_inertia_kg_m2", 5.0),
        ("stiffness_nm_rad", 1.4),
        ("gap_width_rad", 0.18),
        ("reduction_ratio", 4.0),
        ("load_coulomb_forward_nm", 3.40 * 1.1),
        ("load_coulomb_backward_nm", 3.40 * 0.9),
        ("load_stiction_forward_nm", 3.82 * 1.1),
    ] {
        assert_shown(&identified, name, truth, 0.05);
    }
    // Stiction of the load at the motor, and a little more: the load has to move by counts.
    let stiction_nm = 3.82 / 4.0;
    assert!(
        breakaway.forward_nm > 1.1 * stiction_nm && breakaway.forward_nm < 2.0 * stiction_nm,
        "{breakaway:?}"
    );
    assert_eq!(records.len(), 3);
    assert!(table(&identified).contains("gap_width_rad"));

    // The file is a scenario's plant.
    let text = format!(
        "title = \"t\"\n[run]\nduration_s = 1.0\n{}\n[controller]\nname = \"pd\"\n[reference]\nprofile = \"constant\"\n\
         position_rad = 0.0\n",
        plant_toml(&identified)
    );
    let meant = Override::Set(r#"meant=["start", "mismatch", "large-angle"]"#.to_owned());
    let scenario = Scenario::from_str("plant.toml", &text, &[meant]).expect("a scenario");
    let stiffness_nm_rad = scenario.plant.number("stiffness_nm_rad").expect("a number");
    assert!((stiffness_nm_rad - 1.4).abs() < 1e-3, "{stiffness_nm_rad}");

    let parameters = drive_toml(&identified, of_drive(RunMode::Bench), |name| name != "load_direction");
    assert!(parameters.contains("\nmotor_direction = \"forward\""), "{parameters}");
    assert!(parameters.contains("\n# the drive lacks it: load_direction = \"forward\""), "{parameters}");
}

#[test]
fn bench_mode_shows_the_same_plant_behind_the_pins() {
    // The encoders behind the pins count forward, for any direction that the drive has in force meanwhile.
    let bench = [
        "run.mode=bench",
        "bench.torque_per_duty_nm=60",
        "bench.load_direction=reverse",
        "plant.initial.load_position_rad=1.0",
        "plant.initial.motor_position_rad=4.0",
    ];
    let Commissioned { identified, .. } = commissioned(&LIMITS, &bench).expect("estimates");
    let parameters = drive_toml(&identified, of_drive(RunMode::Bench), |_| true);
    for name in ["motor_direction", "load_direction"] {
        assert!(parameters.contains(&format!("\n{name} = \"forward\"")), "{parameters}");
    }
    assert!(!drive_toml(&identified, of_drive(RunMode::Hil), |_| true).contains("_direction"));
    // The duty is in steps, so the torque is only nearly what the drive commands.
    for (name, truth) in [("stiffness_nm_rad", 1.4), ("gap_width_rad", 0.18), ("reduction_ratio", 4.0)] {
        let likely = identified.likely(name).expect(name);
        assert!((likely / truth - 1.0).abs() < 0.05, "{name}: {likely}, truth {truth}");
    }
}

#[test]
fn limit_of_the_travel_ends_the_run_and_names_the_motion() {
    let error = commissioned(&Limits { load_travel_rad: 0.002, ..LIMITS }, &[]).expect_err("a limit");
    let CommissioningError::Exceeded { motion, exceeded } = error else { panic!("{error}") };
    assert_eq!((motion.as_str(), exceeded.quantity), ("breakaway-forward", "load travel"));
    // The guard has a step two periods later, in which the load barely moves.
    assert!(exceeded.value < 0.006, "{exceeded}");
}
