//! Answers to descriptions.

use lashloop_protocol::enums::{FaultCode, Outcome, ParameterFlags, State, TorqueFlags};
use lashloop_protocol::layout::ValueList;
use lashloop_protocol::limits::{FAULT_NAMES, FLAG_NAMES, KIND_NAMES, OUTCOME_NAMES, STATE_NAMES};
use lashloop_protocol::message::{
    ChoiceDescription, DescribeChoice, LawDescription, ParameterDescription, SignalDescription,
};
use lashloop_protocol::text::Text;
use lashloop_protocol::{DriveMessage, HostMessage, Message};

use super::Drive;
use super::description::{CONTROLLER, LAWS, OUTPUTS, SIGNALS, Table};
use super::requests::whole;

/// The last fault code of a drive without pins that never halts.
const LAST_FAULT: u8 = 6;
/// Names of what a drive without pins and boot loader has not.
const OF_PINS: [&str; 6] =
    ["PowerStageFault", "EncoderImplausible", "Reference", "EnterLoader", "SetZero", "BenchSample"];

impl Drive {
    pub(super) fn describe(&mut self, request: &HostMessage) {
        match request {
            HostMessage::DescribeLaw(it) if self.is_known(request, it.index, LAWS.len()) => {
                let name = LAWS.get(usize::from(it.index)).unwrap_or(&"");
                self.send(LawDescription { index: it.index, name: Text::new(name) });
            }
            HostMessage::DescribeSignal(it) if self.is_known(request, it.index, SIGNALS.len()) => {
                let (name, unit, laws) = SIGNALS.get(usize::from(it.index)).copied().unwrap_or_default();
                let (name, unit) = (Text::new(name), Text::new(unit));
                self.send(SignalDescription { index: it.index, laws, name, unit });
            }
            HostMessage::DescribeChoice(it) => match choice(self.values.table, *it)
                .or_else(|| own_name(*it).filter(|name| self.knows(name)))
            {
                Some(name) if self.at.flag("DescribeChoice", "is known", true) => {
                    self.send(ChoiceDescription {
                        parameter: it.parameter,
                        choice: it.choice,
                        name: Text::new(name),
                    });
                }
                _ => self.unknown(request),
            },
            HostMessage::DescribeParameter(it)
                if self.is_known(request, it.index, self.values.table.len()) =>
            {
                let place = usize::from(it.index).min(self.values.table.len() - 1);
                let parameter = &self.values.table[place];
                self.send(ParameterDescription {
                    index: it.index,
                    flags: parameter.flags,
                    laws: parameter.laws,
                    default: self.defaults().set[place],
                    min: parameter.min,
                    max: parameter.max,
                    name: Text::new(parameter.name),
                    unit: Text::new(parameter.unit),
                });
            }
            HostMessage::DescribeParameter(it) => self.report(it.index, Outcome::UnknownIndex, None),
            HostMessage::GetParameter(it) => {
                let is_known = self.is_known(request, it.index, self.values.table.len());
                self.report(it.index, if is_known { Outcome::Accepted } else { Outcome::UnknownIndex }, None);
            }
            _ => self.unknown(request),
        }
    }

    fn is_known(&self, request: &HostMessage, index: u8, count: usize) -> bool {
        let name = request.layout().name;
        let count = self.at.whole(name, "number of indices", count as i64);
        let is_high = (100..200).contains(&index);
        i64::from(index) < count || is_high && self.at.flag(name, "takes indices from 100 to 199", false)
    }

    fn unknown(&mut self, request: &HostMessage) {
        self.result(request, Outcome::UnknownIndex);
    }
}

/// The identifier of a value or kind of the drive.
fn own_name(DescribeChoice { parameter, choice }: DescribeChoice) -> Option<&'static str> {
    let listed = |list: ValueList| list.name_of(choice);
    match parameter {
        FAULT_NAMES => listed(FaultCode::LIST).filter(|_| choice <= LAST_FAULT),
        OUTCOME_NAMES => listed(Outcome::LIST).filter(|name| !OF_PINS.contains(name)),
        STATE_NAMES => listed(State::LIST),
        FLAG_NAMES => TorqueFlags::SET.name_of(choice),
        KIND_NAMES => {
            let layouts = HostMessage::LAYOUTS.iter().chain(DriveMessage::LAYOUTS);
            let known = layouts.filter(|it| !OF_PINS.contains(&it.name));
            known.into_iter().find(|it| it.kind == choice).map(|it| it.name)
        }
        _ => None,
    }
}

fn choice(table: &Table, request: DescribeChoice) -> Option<&'static str> {
    let index = usize::from(request.parameter);
    let parameter = table.get(index).filter(|it| it.flags.contains(ParameterFlags::CHOICES))?;
    let names: &[&str] = if index == CONTROLLER { &LAWS } else { &OUTPUTS };
    let place = u32::from(request.choice).checked_sub(whole(parameter.min))?;
    names.get(place as usize).copied()
}
