//! The drive of a place, opened.

use lashloop_bench::device::Device;
use lashloop_bench::run::{self, Clock, DeviceUnderTest, Observers, Outcome, StepObserver, check_bench_mode};
use lashloop_bench::scenario::Scenario;
use lashloop_bench::supervisor::Supervisor;
use lashloop_link::Link;
use lashloop_record::writer::RecordWriter;

use super::error::ExecutionError;
use super::place::Place;
use crate::rig::TakenRig;
use crate::rig::limits::Excess;

/// Wraps the link to a drive on the bench's side, such as a capture does.
pub type Middleware<'a> = Box<dyn FnOnce(Box<dyn Link>) -> Box<dyn Link> + 'a>;

/// A drive that is open, with the limits of its rig.
pub struct OpenDrive<'a> {
    under_test: DeviceUnderTest,
    rig: Option<&'a TakenRig>,
    excess: Excess,
    clock: Clock,
    supervisor: &'a Supervisor,
}

impl<'a> OpenDrive<'a> {
    /// Opens the drive for the first of several runs.
    ///
    /// # Errors
    /// The scenario exceeds the rig, or the drive can't be reached, is on another board or can't make runs in this mode.
    pub fn open(
        scenario: &Scenario,
        place: Place<'a>,
        clock: Clock,
        supervisor: &'a Supervisor,
    ) -> Result<Self, ExecutionError> {
        Self::open_through(scenario, place, clock, supervisor, Box::new(|link| link))
    }

    pub(super) fn open_through(
        scenario: &Scenario,
        place: Place<'a>,
        clock: Clock,
        supervisor: &'a Supervisor,
        middleware: Middleware<'_>,
    ) -> Result<Self, ExecutionError> {
        let rig = place.rig();
        place.check(scenario)?;
        let on_rig = rig.map(|taken| taken.rig.on_line(scenario));
        let scenario = on_rig.as_ref().unwrap_or(scenario);
        let under_test =
            DeviceUnderTest::open(scenario, place.choice(), clock.name(), supervisor, middleware)?;
        let device = &under_test.device;
        if let Some(taken) = rig {
            taken.rig.check_board(device)?;
        }
        if !scenario.run.mode.is_hil() {
            check_bench_mode(device, clock.name())?;
        }
        if let Some(taken) = rig {
            taken.rig.check_reference(scenario, &device.session)?;
        }
        Ok(Self { under_test, rig, excess: Excess::Rejected, clock, supervisor })
    }

    /// The same drive, with another rule for what exceeds the rig.
    #[must_use]
    pub fn with_excess(self, excess: Excess) -> Self {
        Self { excess, ..self }
    }

    /// The drive.
    #[must_use]
    pub fn device(&self) -> &Device {
        &self.under_test.device
    }

    /// The device without its rig: no run is left to make.
    pub(super) fn end(self) -> DeviceUnderTest {
        self.under_test
    }

    /// Makes a run, which a signal of the user ends. Each step goes to the watchers, then to the record. On a rig the scenario is
    /// completed with its limits.
    ///
    /// # Errors
    /// The scenario doesn't fit the drive or its rig; drive, link, plant or an observer failed.
    pub fn run(
        &mut self,
        scenario: &mut Scenario,
        watchers: Vec<&mut dyn StepObserver>,
        record: Option<&mut RecordWriter>,
    ) -> Result<Outcome, ExecutionError> {
        if let Some(taken) = self.rig {
            taken.rig.bound(scenario, &self.under_test.device.session, self.excess)?;
        }
        let (mut interrupt, mut watchers) = (Interrupt(self.supervisor), Observers(watchers));
        let mut all: Vec<&mut dyn StepObserver> = vec![&mut interrupt, &mut watchers];
        all.extend(record.map(|it| it as &mut dyn StepObserver));
        Ok(run::run(scenario, &mut self.under_test, self.clock, &mut Observers(all))?)
    }
}

/// Ends a run at a signal of the user.
struct Interrupt<'a>(&'a Supervisor);

impl StepObserver for Interrupt<'_> {
    fn stop_asked(&self) -> bool {
        self.0.interrupted()
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::Bench;

    const RIG: &str = "title = \"t\"\ncontact = \"c\"\nboard = \"in-process\"\n[port]\ndevice = \"tcp:rack:PORT\"\n\
                       [limits]\ntorque_nm = 5.0\nload_travel_rad = 0.49\n";

    /// A rig whose drive is one in this process. Each port is a lock of its own.
    fn rig(text: &str, port: &str) -> TakenRig {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("rig.toml");
        std::fs::write(&file, text.replace("PORT", port)).expect("a rig file");
        let bench = Bench::new();
        let mut taken = TakenRig::take(&file, &bench.devices(), "test").expect("a rig");
        taken.rig.port.device = bench.device("inproc").expect("a device");
        taken
    }

    fn scenario(settings: &[&str]) -> Scenario {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/shaft-pd-sine.toml");
        let short = ["run.duration_s=0.05", "expect=[]", "meant=[\"start\", \"mismatch\", \"large-angle\"]"];
        Bench::new().scenario(path, &[&short, settings].concat()).expect("a scenario")
    }

    /// A sine of 0.5 rad from rest.
    const SINE: [&str; 3] = [
        "plant.initial.load_position_rad=0",
        "plant.initial.motor_position_rad=0",
        "reference={ profile = \"sine\", amplitude_rad = 0.5, offset_rad = 0.0, frequency_hz = 10.0 }",
    ];

    fn run(rig: &TakenRig, mut scenario: Scenario) -> Result<Option<f32>, String> {
        let supervisor = Supervisor::without_signals(None).expect("threads");
        let opened = OpenDrive::open(&scenario, rig.into(), Clock::Lockstep, &supervisor);
        let mut drive = opened.map_err(|error| error.to_string())?;
        drive.run(&mut scenario, Vec::new(), None).map_err(|error| error.to_string())?;
        let session = &drive.device().session;
        let limit = session.parameter("torque_limit_nm").map(|limit| session.in_force(limit));
        Ok(limit.and_then(|limit| match limit {
            lashloop_protocol::enums::ParameterValue::F32(limit_nm) => Some(limit_nm),
            _ => None,
        }))
    }

    #[test]
    fn a_run_on_a_rig_keeps_a_limit_that_its_scenario_leaves_open() {
        let rig = rig(RIG, "1");
        let unlimited =
            ["controller.parameters={}", "reference={ profile = \"constant\", position_rad = 0.0 }"];
        assert_eq!(run(&rig, scenario(&unlimited)), Ok(Some(5.0)));
    }

    #[test]
    fn the_drive_of_a_rig_is_opened_and_run_at_the_speed_of_its_port() {
        let rig = rig(&RIG.replace("[limits]", "baud = 115200\n[limits]"), "4");
        let supervisor = Supervisor::without_signals(None).expect("threads");
        let mut still = scenario(&[
            "controller.parameters={}",
            "reference={ profile = \"constant\", position_rad = 0.0 }",
        ]);
        assert_eq!(rig.rig.on_line(&still).link.baud, 115_200);
        let mut drive =
            OpenDrive::open(&still, (&rig).into(), Clock::Lockstep, &supervisor).expect("a drive");
        drive.run(&mut still, Vec::new(), None).expect("a run");
        assert_eq!(still.link.baud, 115_200, "as its record has it");
    }

    #[test]
    fn a_position_keeps_the_travel_of_the_rig_and_a_torque_has_none() {
        let rig = rig(RIG, "2");
        let pd = ["controller.parameters={}"];
        let error = run(&rig, scenario(&[&SINE[..], &pd].concat())).expect_err("0.5 rad");
        assert!(error.contains("allows limits.load_travel_rad = 0.49 rad"), "{error}");
        let torque = ["controller.name=open-loop", "controller.parameters={}"];
        assert_eq!(run(&rig, scenario(&[&SINE[..], &torque].concat())), Ok(Some(5.0)));
    }

    #[test]
    fn a_drive_on_another_board_than_the_rigs_is_not_run() {
        let rig = rig(&RIG.replace("in-process", "stm32f405"), "3");
        let error = run(&rig, scenario(&["controller.parameters={}"])).expect_err("another board");
        assert!(error.contains("that of") && error.contains("is stm32f405"), "{error}");
    }
}
