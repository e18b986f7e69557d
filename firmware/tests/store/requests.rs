//! The requests on the wire.

use lashloop_firmware::drive::{Drive, ManualClock, PinParameters};
use lashloop_firmware::law::{LawSet, Parameter, ParameterGroup, Range};
use lashloop_firmware::store::{Progress, Store, entry};
use lashloop_firmware::{Laws, input_filter::FILTERS};
use lashloop_protocol::enums::{Capabilities, Outcome, ParameterValue, State};
use lashloop_protocol::message::{
    Arm, DescribeParameter, ForgetParameters, GetParameter, Hello, RecallParameters, Reset, SetParameter,
    StoreParameters,
};
use lashloop_protocol::{Decoder, DriveMessage, HostMessage, Message};

use crate::flash::{Cells, Flash};

const SESSION: u32 = 7;

struct Host {
    drive: Drive,
    clock: ManualClock,
}

impl Host {
    /// A host of a drive that has just had its power-up with this memory.
    fn of(flash: Option<&'static Flash>) -> Self {
        let hardware = lashloop_firmware::drive::PinHardware {
            largest_move_counts: 32_767,
            filters: &FILTERS,
            stage_modes: &[lashloop_firmware::stage_mode::StageMode::Amplifier],
            longest_period_us: 65_535,
            measures_current: true,
            has_index: [true, false],
        };
        let drive = Drive::with_pins("test", hardware);
        let drive = match flash {
            Some(flash) => drive.with_store(Store::open(flash)),
            None => drive,
        };
        let mut host = Self { drive, clock: ManualClock::default() };
        host.send(Hello::new(SESSION));
        host
    }

    fn send(&mut self, message: impl Into<HostMessage>) -> Vec<DriveMessage> {
        let frame = message.into().frame();
        assert_eq!(self.drive.receive(&frame, &self.clock), frame.len());
        while self.drive.continue_storing() {}
        let bytes = self.drive.output().to_vec();
        self.drive.clear_output();
        let (mut decoder, mut rest, mut messages) = (Decoder::new(), &bytes[..], Vec::new());
        while let Some(message) = decoder.next::<DriveMessage>(&mut rest) {
            messages.push(message.expect("a whole frame").message);
        }
        messages
    }

    fn command(&mut self, message: impl Into<HostMessage>) -> (Outcome, u32, State) {
        match self.send(message)[..] {
            [DriveMessage::CommandResult(it)] => (it.outcome, it.detail, it.state),
            ref other => panic!("{other:?}"),
        }
    }

    fn set(&mut self, name: &str, value: ParameterValue) {
        let answers = self.send(SetParameter { index: index(name), value });
        assert!(
            matches!(answers[..], [DriveMessage::ParameterReport(it)] if it.outcome == Outcome::Accepted)
        );
    }

    /// Value in force, and default.
    fn values(&mut self, name: &str) -> (ParameterValue, ParameterValue) {
        let index = index(name);
        match (&self.send(GetParameter { index })[..], &self.send(DescribeParameter { index })[..]) {
            ([DriveMessage::ParameterReport(report)], [DriveMessage::ParameterDescription(it)]) => {
                (report.value, it.default)
            }
            other => panic!("{other:?}"),
        }
    }

    fn capabilities(&mut self) -> Capabilities {
        match self.send(Hello::new(SESSION))[..] {
            [DriveMessage::Identity(it)] => it.capabilities,
            ref other => panic!("{other:?}"),
        }
    }
}

fn table() -> impl Iterator<Item = &'static Parameter> {
    Laws::PARAMETERS.iter().chain(PinParameters::TABLE)
}

fn index(name: &str) -> u8 {
    table().position(|it| it.name == name).unwrap_or_else(|| panic!("no parameter {name}")) as u8
}

const LIMIT: &str = "torque_limit_nm";
const RIG: &str = "rig_id";
const ACCEPTED: (Outcome, u32, State) = (Outcome::Accepted, 0, State::Idle);

fn both(value: ParameterValue) -> (ParameterValue, ParameterValue) {
    (value, value)
}

#[test]
fn a_stored_set_is_in_force_after_reset_and_after_power_up() {
    let flash = Flash::new(Cells::blank(true));
    let mut host = Host::of(Some(flash));
    host.set(LIMIT, ParameterValue::F32(3.5));
    host.set(RIG, ParameterValue::U32(41));
    host.set("controller", ParameterValue::U32(2));
    assert_eq!(host.values(RIG), (ParameterValue::U32(41), ParameterValue::U32(0)));
    assert_eq!(host.command(StoreParameters {}), ACCEPTED);
    assert_eq!(host.values(RIG), both(ParameterValue::U32(41)));
    host.set(LIMIT, ParameterValue::F32(9.0));
    host.send(Reset {});
    host.send(Hello::new(SESSION));
    assert_eq!(host.values(LIMIT), both(ParameterValue::F32(3.5)));
    let mut host = Host::of(Some(Flash::new(flash.take())));
    assert_eq!(host.values(LIMIT), both(ParameterValue::F32(3.5)));
    assert_eq!(host.values("controller"), both(ParameterValue::U32(2)));
    assert_eq!(host.values("period_us"), both(ParameterValue::U32(1000)));
}

#[test]
fn every_parameter_is_stored() {
    let flash = Flash::new(Cells::blank(true));
    let mut host = Host::of(Some(flash));
    for it in table() {
        host.set(it.name, it.range.max());
    }
    assert_eq!(host.command(StoreParameters {}), ACCEPTED);
    let mut host = Host::of(Some(Flash::new(flash.take())));
    for it in table() {
        assert_eq!(host.values(it.name), both(it.range.max()), "{}", it.name);
    }
}

#[test]
fn recall_gives_every_parameter_its_default_again() {
    let mut host = Host::of(Some(Flash::new(Cells::blank(true))));
    host.set(LIMIT, ParameterValue::F32(3.5));
    host.set(RIG, ParameterValue::U32(41));
    assert_eq!(host.command(RecallParameters {}), ACCEPTED);
    assert_eq!(host.values(LIMIT), both(ParameterValue::F32(20.0)));
    host.set(LIMIT, ParameterValue::F32(3.5));
    assert_eq!(host.command(StoreParameters {}), ACCEPTED);
    host.set(LIMIT, ParameterValue::F32(9.0));
    assert_eq!(host.command(RecallParameters {}), ACCEPTED);
    assert_eq!(host.values(LIMIT), both(ParameterValue::F32(3.5)));
}

#[test]
fn a_forgotten_set_leaves_the_defaults_of_the_firmware() {
    let flash = Flash::new(Cells::blank(true));
    let mut host = Host::of(Some(flash));
    assert_eq!(host.command(ForgetParameters {}), ACCEPTED);
    assert_eq!(flash.cells().instants, 0, "nothing is to be forgotten");
    host.set(LIMIT, ParameterValue::F32(3.5));
    assert_eq!(host.command(StoreParameters {}), ACCEPTED);
    assert_eq!(host.command(ForgetParameters {}), ACCEPTED);
    assert_eq!(host.values(LIMIT), both(ParameterValue::F32(20.0)));
    let mut host = Host::of(Some(Flash::new(flash.take())));
    assert_eq!(host.values(LIMIT), both(ParameterValue::F32(20.0)));
}

#[test]
fn the_requests_are_for_an_idle_drive_with_a_store() {
    let mut without = Host::of(None);
    let mut with = Host::of(Some(Flash::new(Cells::blank(true))));
    assert!(!without.capabilities().contains(Capabilities::STORE));
    assert!(with.capabilities().contains(Capabilities::STORE));
    assert_eq!(with.command(Arm { session: SESSION }).2, State::Armed);
    let requests: [HostMessage; 3] =
        [StoreParameters {}.into(), RecallParameters {}.into(), ForgetParameters {}.into()];
    for request in requests {
        assert_eq!(without.command(request), (Outcome::UnknownRequest, 0, State::Idle));
        assert_eq!(with.command(request), (Outcome::WrongState, 0, State::Armed));
    }
}

#[test]
fn a_request_says_why_nothing_was_stored() {
    let flash = Flash::new(Cells::blank(true));
    let mut host = Host::of(Some(flash));
    host.set(LIMIT, ParameterValue::F32(3.5));
    flash.cells().refuses = true;
    assert_eq!(host.command(StoreParameters {}), (Outcome::StoreFailed, 1, State::Idle));
    assert_eq!(host.values(LIMIT), (ParameterValue::F32(3.5), ParameterValue::F32(20.0)));
    flash.cells().refuses = false;
    for _ in 0..128 {
        assert_eq!(host.command(StoreParameters {}), ACCEPTED);
    }
    assert_eq!(host.command(StoreParameters {}), (Outcome::StoreFailed, 2, State::Idle));
    assert_eq!(host.command(ForgetParameters {}), (Outcome::StoreFailed, 2, State::Idle));
    assert_eq!(host.values(LIMIT), both(ParameterValue::F32(3.5)));
}

#[test]
fn a_drive_takes_no_further_request_while_it_stores() {
    let mut host = Host::of(Some(Flash::new(Cells::blank(true))));
    let frame = HostMessage::from(StoreParameters {}).frame();
    assert_eq!(host.drive.receive(&frame, &host.clock), frame.len());
    assert!(host.drive.continue_storing());
    assert_eq!((host.drive.receive(&frame, &host.clock), host.drive.has_output()), (0, false));
    while host.drive.continue_storing() {}
    assert!(host.drive.has_output());
}

/// Stores pairs as another firmware may have.
fn stored(pairs: &[[u32; 2]]) -> &'static Flash {
    let flash = Flash::new(Cells::blank(true));
    let mut store = Store::open(flash);
    assert_eq!(store.begin(pairs.len()), Ok(()));
    while store.step(|at| pairs[at]) == Progress::Writing {}
    flash
}

#[test]
fn another_firmware_recalls_what_it_knows_and_can_have() {
    let [limit, period, controller] = [LIMIT, "period_us", "controller"]
        .map(|name| *table().find(|it| it.name == name).expect("a parameter"));
    // A law that has another index there, and one that is not here.
    const NAMES: &[&str] = &["unheard-of", Laws::NAMES[3]];
    let other = Range::Choice { default: 0, names: NAMES };
    let [unknown, moved] = [0, 1].map(|index| [entry::key(&controller), entry::stored(other, index)]);
    let ours = [entry::key(&limit), 7.25_f32.to_bits()];
    let beyond = [entry::key(&period), 7];
    let of_another_type = Parameter { range: Range::U32 { default: 1, min: 1, max: 9 }, ..limit };
    let stranger = [entry::key(&of_another_type), 1];
    let mut host = Host::of(Some(stored(&[stranger, [1, 2], moved, ours, beyond])));
    assert_eq!(host.values(LIMIT), both(ParameterValue::F32(7.25)));
    assert_eq!(host.values("period_us"), both(ParameterValue::U32(1000)));
    assert_eq!(host.values("controller"), both(ParameterValue::U32(3)));
    let mut host = Host::of(Some(stored(&[unknown])));
    assert_eq!(host.values("controller"), both(ParameterValue::U32(0)));
}
