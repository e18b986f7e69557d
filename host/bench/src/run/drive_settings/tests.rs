//! Scenarios against the description of a drive: Lashloop's own, and one with laws of its own.

use lashloop_firmware::Laws;
use lashloop_firmware::law::{
    ControlLaw, ControlOutput, DriveParameters, LawSet, Measurement, ParameterError,
};
use lashloop_link::in_process::InProcess;

use super::*;
use crate::scenario::Override;

lashloop_firmware::signals! {
    /// More signals than a telemetry holds.
    pub struct ManySignals {
        a: "", b: "", c: "", d: "", e: "", f: "", g: "", h: "", i: "", j: "", k: "", l: "rad", m: "",
    }
}

/// A law without parameters. Torque zero.
pub struct Talkative;

impl ControlLaw for Talkative {
    const NAME: &'static str = "talkative";
    type Parameters = ();
    type Signals = ManySignals;

    fn new((): (), _: &DriveParameters) -> Result<Self, ParameterError> {
        Ok(Self)
    }

    fn step(&mut self, _: &Measurement<f32>) -> ControlOutput<ManySignals> {
        let [a, b, c, d, e, f, g, h, i, j, k, l, m] = [0.0; 13];
        ControlOutput { torque_nm: 0.0, signals: ManySignals { a, b, c, d, e, f, g, h, i, j, k, l, m } }
    }
}

lashloop_firmware::laws! {
    /// One law.
    pub enum OwnLaws {
        /// The law.
        Talkative(Talkative),
    }
}

fn session<L: LawSet + 'static>() -> Session {
    Session::open(Box::new(InProcess::<L>::default()), 1).expect("a drive")
}

fn scenario(law: &str, more: &str, options: &[&str]) -> Scenario {
    let text = format!(
        "title = \"a run\"\n[run]\nduration_s = 1.0\n[plant]\nmodel = \"smooth\"\n[reference]\n\
         profile = \"constant\"\nposition_rad = 0.0\n[controller]\nname = \"{law}\"\n{more}"
    );
    let options: Vec<_> = options.iter().map(|option| Override::Set((*option).to_owned())).collect();
    Scenario::from_str("x.toml", &text, &options).unwrap_or_else(|errors| panic!("{errors}"))
}

/// The errors of a scenario with the drive, or the names of the signals and the notes.
fn settings<L: LawSet + 'static>(scenario: &Scenario) -> Result<(Vec<String>, Vec<String>), String> {
    let session = session::<L>();
    let settings = DriveSettings::new(scenario, &session, None).map_err(|errors| errors.to_string())?;
    let signals = settings.subscription.signals().iter().map(|it| it.signal.name.to_string());
    Ok((signals.collect(), settings.notes))
}

#[test]
fn an_unknown_law_is_refused_with_the_laws_of_the_drive() {
    let refused = settings::<Laws>(&scenario("merzuki", "", &[])).expect_err("no such law");
    assert_eq!(
        refused,
        "x.toml:10: controller.name: \"merzuki\" is refused: the drive has no law of this name (did you mean merzouki?); \
         it has pd, merzouki, merzouki-as-printed, backlash-inverse, braking-curve, open-loop"
    );
    let refused = settings::<OwnLaws>(&scenario("pd", "", &[])).expect_err("no such law");
    assert!(refused.ends_with("the drive has no law of this name; it has talkative"), "{refused}");
}

#[test]
fn a_parameter_of_the_pins_has_its_section_alone() {
    let of_pins = "[controller.parameters]\nload_direction = \"reverse\"\ntwist_limit_rad = 40.0\n";
    let refused = settings::<Laws>(&scenario("pd", of_pins, &[])).expect_err("parameters of [bench]");
    for line in [
        "x.toml:12: controller.parameters.load_direction: \"reverse\" is set by bench.load_direction; set it there",
        "x.toml:13: controller.parameters.twist_limit_rad: 40 is set by bench.twist_limit_rad; set it there",
    ] {
        assert!(refused.contains(line), "{refused}");
    }
}

#[test]
fn a_parameter_of_another_law_is_an_error_at_its_place() {
    let of_merzouki = "[controller.parameters]\nk_21 = 0.02\nk_p1 = 1.0\nhold_fraction = 0.5\n";
    let refused = settings::<Laws>(&scenario("pd", of_merzouki, &[])).expect_err("parameters of others");
    assert_eq!(
        refused,
        "x.toml:12: controller.parameters.k_21: 0.02 is given, but k_21 belongs to merzouki and merzouki-as-printed, and \
         this run uses pd\n\
         x.toml:14: controller.parameters.hold_fraction: 0.5 is given, but hold_fraction belongs to backlash-inverse, and \
         this run uses pd"
    );
    assert!(settings::<Laws>(&scenario("merzouki", "[controller.parameters]\nk_21 = 0.02\n", &[])).is_ok());
}

#[test]
fn a_law_chosen_by_an_option_leaves_out_the_file_s_parameters_of_others() {
    let file = "[controller.parameters]\nk_21 = 0.02\nk_p1 = 1.5\n";
    let replaced = scenario("merzouki", file, &["controller.name=pd"]);
    let session = session::<Laws>();
    let settings = DriveSettings::new(&replaced, &session, None).expect("settings");
    let set: Vec<_> = settings.parameters.iter().map(|setting| &*setting.name).collect();
    assert_eq!(set, ["k_p1"]);
    assert_eq!(
        settings.notes,
        [
            "controller.parameters.k_21 of x.toml:12 is left out: it belongs to merzouki and merzouki-as-printed, and \
          --set controller.name=pd chooses pd"
        ]
    );
    // What the command line itself gives must fit.
    let options = ["controller.name=pd", "controller.parameters.k_21=0.03"];
    let both = scenario("merzouki", file, &options);
    assert!(DriveSettings::new(&both, &session, None).is_err());
}

#[test]
fn unknown_parameters_choices_and_signals_are_refused_at_once() {
    let more = "[controller.parameters]\nk_q1 = 1.0\ndisturbing_torque_source = \"observer\"\ncontroller = 1\n\
                torque_limit_nm = \"high\"\n\
                [telemetry]\nsignals = [\"load_eror_rad\", \"load_error_rad\", \"load_error_rad\"]\n";
    let refused = settings::<Laws>(&scenario("merzouki", more, &[])).expect_err("five mistakes");
    let lines: Vec<_> = refused.lines().map(|line| line.split("; it has").next().unwrap_or(line)).collect();
    assert_eq!(
        lines,
        [
            "x.toml:12: controller.parameters.k_q1: 1 is refused: the drive has no parameter of this name (did you mean k_1?)",
            "x.toml:13: controller.parameters.disturbing_torque_source: \"observer\" is refused: this parameter has no choice \
             of this name (did you mean observed?)",
            "x.toml:14: controller.parameters.controller: 1 is set by controller.name; set it there",
            "x.toml:15: controller.parameters.torque_limit_nm: \"high\" is refused: it is a text; the drive takes 0 to 1000 N m",
            "x.toml:17: telemetry.signals: \"load_eror_rad\" is refused: the drive has no signal of this name (did you mean \
             load_error_rad?)",
            "x.toml:17: telemetry.signals: \"load_error_rad\" is refused: it is given twice",
        ]
    );
}

#[test]
fn signals_are_subscribed_by_name_in_the_order_of_the_drive() {
    let more = "[telemetry]\nsignals = [\"load_error_rad\", \"requested_torque_nm\"]\n";
    let (signals, _) = settings::<Laws>(&scenario("pd", more, &[])).expect("settings");
    assert_eq!(signals, ["requested_torque_nm", "load_error_rad"]);
    let (signals, notes) = settings::<Laws>(&scenario("pd", "", &[])).expect("settings");
    assert!(signals.len() > 4 && notes.is_empty(), "{signals:?}, {notes:?}");
    let (signals, _) =
        settings::<Laws>(&scenario("pd", "[telemetry]\nevery_steps = 0\n", &[])).expect("settings");
    assert!(signals.is_empty(), "{signals:?}");
}

#[test]
fn a_telemetry_takes_thirteen_signals_and_the_rest_is_noted() {
    let (signals, notes) = settings::<OwnLaws>(&scenario("talkative", "", &[])).expect("settings");
    assert_eq!(signals.len(), 13);
    assert_eq!(signals[0], "requested_torque_nm");
    assert!(notes[0].ends_with("so it lacks h, i, j, k, l, m; telemetry.signals selects them"), "{notes:?}");
    let all = format!(
        "[telemetry]\nsignals = {:?}\n",
        ["requested_torque_nm", "a", "b", "c", "d", "e", "f", "g", "h", "i", "j", "k", "l", "m"]
    );
    let refused = settings::<OwnLaws>(&scenario("talkative", &all, &[])).expect_err("fourteen");
    assert!(
        refused.contains("\"m\" is refused: it is one too many; a telemetry has 13 signals at most"),
        "{refused}"
    );
}

#[test]
fn names_of_another_law_s_signals_are_refused_with_that_law() {
    lashloop_firmware::laws! {
        /// Two laws that differ in their signals.
        pub enum Two {
            /// Without the signals `a` to `m`.
            Pd(lashloop_firmware::control::pd::Pd),
            /// With them.
            Talkative(Talkative),
        }
    }
    let refused = settings::<Two>(&scenario("pd", "[telemetry]\nsignals = [\"l\"]\n", &[]))
        .expect_err("of another law");
    assert_eq!(
        refused,
        "x.toml:12: telemetry.signals: \"l\" is refused: it belongs to talkative, and this run uses pd"
    );
}

#[test]
fn a_plant_that_is_not_the_drive_s_is_refused_unless_meant() {
    let wider = "plant.dead_zone_rad=0.2";
    let refused = settings::<Laws>(&scenario("pd", "", &[wider])).expect_err("another gap");
    assert_eq!(
        refused,
        "--set plant.dead_zone_rad=0.2: plant.dead_zone_rad: 0.2 is not the drive's default of 0.16; set \
         controller.parameters.dead_zone_rad = 0.2, or write meant = [\"mismatch\"] at the top of the scenario"
    );
    assert!(settings::<Laws>(&scenario("pd", "", &[wider, "meant=mismatch"])).is_ok());
    assert!(
        settings::<Laws>(&scenario("pd", "", &[wider, "controller.parameters.dead_zone_rad=0.2"])).is_ok()
    );
    // This law has no such parameter.
    assert!(settings::<OwnLaws>(&scenario("talkative", "", &[wider])).is_ok());
}

const SCOPE_OF_TWIST: &str = "[scope]\nsignals = [\"measured_twist_rad\", \"requested_torque_nm\"]\n";

#[test]
fn a_capture_has_the_signals_and_the_event_of_the_scenario() {
    let more = format!("{SCOPE_OF_TWIST}trigger = \"falling\"\nlevel = -0.5\nbefore_rows = 7\n");
    let (scenario, session) = (scenario("pd", &more, &[]), session::<Laws>());
    let capture =
        DriveSettings::new(&scenario, &session, None).expect("settings").capture.expect("a capture");
    let names: Vec<_> = capture.signals().iter().map(|it| &*it.signal.name).collect();
    assert_eq!(names, ["requested_torque_nm", "measured_twist_rad"]);
    assert_eq!((capture.every, capture.before, capture.level), (1, 7, -0.5));
    assert_eq!((capture.trigger, capture.trigger_signal), (CaptureTrigger::Falling, 3), "the first named");
}

#[test]
fn every_error_of_a_capture_is_reported_at_its_place() {
    let more = "[scope]\nsignals = [\"requested_torque_nm\", \"twist\", \"load_error_rad\", \"motor_error_rad\", \
                \"measured_twist_rad\", \"elastic_error_nm\"]\ntrigger_signal = \"twist\"\n";
    let refused = settings::<Laws>(&scenario("pd", more, &[])).expect_err("a bad capture");
    for line in [
        "x.toml:12: scope.signals: \"twist\" is refused: the drive has no signal of this name",
        "x.toml:12: scope.signals: \"elastic_error_nm\" is refused: it is one too many; a capture has 4 signals at most",
        "x.toml:13: scope.trigger_signal: \"twist\" is refused: the capture has no signal of this name",
    ] {
        assert!(refused.contains(line), "{refused}");
    }
}

#[test]
fn a_drive_without_a_scope_refuses_the_section() {
    let mut session = session::<Laws>();
    session.identity.capabilities.remove(lashloop_protocol::enums::Capabilities::CAPTURE);
    let of_twist = scenario("pd", SCOPE_OF_TWIST, &[]);
    let refused = DriveSettings::new(&of_twist, &session, None).map(drop).expect_err("no scope").to_string();
    assert_eq!(
        refused,
        "x.toml:12: scope.signals: \"measured_twist_rad\" is refused: the drive captures no signals: its Identity lacks the \
         capability CAPTURE; take a firmware that has it"
    );
    assert!(DriveSettings::new(&scenario("pd", "", &[]), &session, None).is_ok());
}
