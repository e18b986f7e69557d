//! Names and units of telemetry values, from the descriptions and the subscription in the same stream.

use std::collections::BTreeMap;

use lashloop_protocol::enums::Outcome;
use lashloop_protocol::message::{Reset, Subscribe, Telemetry};
use lashloop_protocol::wire::Payload;
use lashloop_protocol::{DriveMessage, HostMessage};
use lashloop_session::printable;

use super::message::AnyMessage;

/// Name and unit of a telemetry value.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Label {
    /// `signal N` if the stream has no description of signal N.
    pub name: String,
    /// Empty for a pure number, and without a description.
    pub unit: String,
}

/// The subscription of a stream, as of the last message.
#[derive(Debug, Default)]
pub(super) struct Subscription {
    described: BTreeMap<u8, Label>,
    /// Signals of the last request. In force once the drive accepts it.
    requested: Option<u32>,
    in_force: Option<u32>,
}

impl Subscription {
    /// The labels of the values, if `message` is telemetry of a subscription that is part of the stream; else none.
    pub fn follow(&mut self, message: &AnyMessage) -> Vec<Label> {
        match message {
            AnyMessage::Host(HostMessage::Subscribe(request)) => self.requested = Some(request.signals),
            AnyMessage::Drive(DriveMessage::CommandResult(result)) if result.outcome == Outcome::Accepted => {
                if result.request == Subscribe::LAYOUT.kind {
                    self.in_force = self.requested.take();
                } else if result.request == Reset::LAYOUT.kind {
                    self.in_force = None;
                }
            }
            AnyMessage::Drive(DriveMessage::SignalDescription(signal)) => {
                let [name, unit] = [signal.name.as_str(), signal.unit.as_str()].map(printable);
                let label = Label { name, unit };
                self.described.insert(signal.index, label);
            }
            AnyMessage::Drive(DriveMessage::Telemetry(telemetry)) => return self.labels(telemetry),
            _ => {}
        }
        Vec::new()
    }

    /// Empty if the number of values is not that of the subscription: a stream may begin after a change.
    fn labels(&self, telemetry: &Telemetry) -> Vec<Label> {
        let signals = self.in_force.unwrap_or(0);
        if signals.count_ones() as usize != telemetry.values.as_slice().len() {
            return Vec::new();
        }
        let subscribed = (0..u32::BITS as u8).filter(|index| signals >> index & 1 == 1);
        let unknown = |index| Label { name: format!("signal {index}"), unit: String::new() };
        subscribed
            .map(|index| self.described.get(&index).cloned().unwrap_or_else(|| unknown(index)))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use lashloop_protocol::TelemetryValues;
    use lashloop_protocol::enums::State;
    use lashloop_protocol::message::{CommandResult, SignalDescription};
    use lashloop_protocol::text::Text;

    use super::*;

    fn description(index: u8, name: &str, unit: &str) -> AnyMessage {
        let (name, unit) = (Text::new(name), Text::new(unit));
        AnyMessage::Drive(SignalDescription { index, laws: 1, name, unit }.into())
    }

    fn subscribe(signals: u32) -> AnyMessage {
        AnyMessage::Host(Subscribe { signals, every: 1 }.into())
    }

    fn result(request: u8, outcome: Outcome) -> AnyMessage {
        let (state, detail, device_time_us) = (State::Idle, 0, None);
        AnyMessage::Drive(CommandResult { request, outcome, state, detail, device_time_us }.into())
    }

    /// The names of `count` telemetry values after these messages.
    fn names_after(messages: &[AnyMessage], count: usize) -> Vec<String> {
        let mut subscription = Subscription::default();
        for message in messages {
            assert_eq!(subscription.follow(message), []);
        }
        let values = TelemetryValues::new(&[0.5; 13][..count]).expect("at most 13 values");
        let telemetry = AnyMessage::Drive(Telemetry { sequence: 0, values }.into());
        subscription.follow(&telemetry).into_iter().map(|label| label.name).collect()
    }

    #[test]
    fn values_have_the_names_of_the_accepted_subscription() {
        let accepted = result(0x0e, Outcome::Accepted);
        let described = [description(9, "speed_rad_s", "rad/s"), description(2, "twist_rad", "rad")];
        let start = [&described[..], &[subscribe(1 << 2 | 1 << 5 | 1 << 9), accepted]].concat();
        assert_eq!(names_after(&start, 3), ["twist_rad", "signal 5", "speed_rad_s"]);

        let none: [&str; 0] = [];
        assert_eq!(names_after(&start, 2), none, "values of another subscription");
        assert_eq!(names_after(&described, 3), none, "the stream begins after the subscription");
        let reset = [&start[..], &[result(0x0a, Outcome::Accepted)]].concat();
        assert_eq!(names_after(&reset, 3), none, "a reset ends the subscription");

        let refused = [&start[..], &[subscribe(1 << 2), result(0x0e, Outcome::WrongState)]].concat();
        assert_eq!(names_after(&refused, 3).len(), 3, "a refused request changes nothing");
    }
}
