//! Answers to descriptions.

use lashloop_protocol::HostMessage;
use lashloop_protocol::enums::{Outcome, ParameterFlags};
use lashloop_protocol::message::{
    ChoiceDescription, DescribeChoice, LawDescription, ParameterDescription, SignalDescription,
};
use lashloop_protocol::text::Text;

use super::Drive;
use super::description::{CONTROLLER, LAWS, OUTPUTS, SIGNALS, Table};
use super::requests::whole;

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
            HostMessage::DescribeChoice(it) => match choice(self.values.table, *it) {
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
                let parameter = &self.values.table[usize::from(it.index).min(self.values.table.len() - 1)];
                self.send(ParameterDescription {
                    index: it.index,
                    flags: parameter.flags,
                    laws: parameter.laws,
                    default: parameter.default,
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
        use lashloop_protocol::Message;
        let count = self.at.whole(request.layout().name, "number of indices", count as i64);
        i64::from(index) < count
    }

    fn unknown(&mut self, request: &HostMessage) {
        self.result(request, Outcome::UnknownIndex);
    }
}

fn choice(table: &Table, request: DescribeChoice) -> Option<&'static str> {
    let index = usize::from(request.parameter);
    let parameter = table.get(index).filter(|it| it.flags.contains(ParameterFlags::CHOICES))?;
    let names: &[&str] = if index == CONTROLLER { &LAWS } else { &OUTPUTS };
    let place = u32::from(request.choice).checked_sub(whole(parameter.min))?;
    names.get(place as usize).copied()
}
