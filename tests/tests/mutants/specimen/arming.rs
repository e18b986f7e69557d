//! Requests with an order of checks: `Subscribe` and `Arm`.

use lashloop_protocol::HostMessage;
use lashloop_protocol::enums::{Outcome, State};
use lashloop_protocol::message::{Arm, Subscribe};

use super::Drive;
use super::description::{CONTROLLER, DAMPING, GAIN, SIGNALS, SPEED_LIMITS};
use super::requests::{refused, whole};
use super::run::{Run, Values, faster, longest_gap, number};
use super::table::{Cell, cell};

const MOST_SIGNALS: i64 = 13;
/// A larger gain needs at least this damping.
const HIGH_GAIN_NM_RAD: f64 = 9e5;
const LEAST_DAMPING_NM_S_RAD: f64 = 1.0;

/// The refusals of a request, in the order of their checks.
type Refusals<const N: usize> = [(&'static str, Option<Outcome>); N];

impl Drive {
    /// The first refusal in the order of the checks; a mutant changes the order of two.
    pub(super) fn refusal<const N: usize>(
        &self,
        request: &'static str,
        orders: [&'static str; N],
        mut refusals: Refusals<N>,
    ) -> Option<Outcome> {
        // Only the order of two reasons that both apply matters.
        let first = refusals.iter().position(|(_, refusal)| refusal.is_some()).unwrap_or(N);
        let next = refusals.iter().skip(first + 1).position(|(_, refusal)| refusal.is_some());
        if let Some(next) = next.map(|it| first + 1 + it)
            && refusals[first].1 != refusals[next].1
            && self.at.flag(request, orders[first], false)
        {
            refusals.swap(first, next);
        }
        refusals.into_iter().find_map(|(check, refusal)| self.at.refusal(request, check, refusal))
    }

    /// The index of the first signal wanted that the law in force lacks.
    pub(super) fn lacked(&self, signals: u32) -> Option<usize> {
        let law = whole(self.is_set(CONTROLLER));
        let first = self.first_law.filter(|first| *first != law);
        let law =
            first.filter(|_| self.at.flag("law in force", "is that of the first Arm", false)).unwrap_or(law);
        let wanted = SIGNALS.iter().enumerate().filter(|(index, _)| signals >> index & 1 == 1);
        wanted.into_iter().find(|(_, (_, _, laws))| laws >> law & 1 == 0).map(|(index, _)| index)
    }

    pub(super) fn subscribe(&mut self, wanted: Subscribe) {
        let state = cell(&self.at, "Subscribe");
        let lacked = self.lacked(wanted.signals);
        let lacks = lacked.is_some() && matches!(self.state(), State::Armed | State::Running);
        let is_too_many =
            i64::from(wanted.signals.count_ones()) > self.at.whole("Subscribe", "most signals", MOST_SIGNALS);
        let refusal = self.refusal(
            "Subscribe",
            ["before the state", "before a bit without a signal", "before too many", ""],
            [
                ("refused for the state", refused(state)),
                (
                    "a bit without a signal",
                    (wanted.signals >> SIGNALS.len() != 0).then_some(Outcome::UnknownIndex),
                ),
                ("too many", is_too_many.then_some(Outcome::OutOfRange)),
                ("a signal that the law lacks", lacks.then_some(Outcome::SignalOfOtherLaw)),
            ],
        );
        let stores = refusal.is_none();
        if self.at.flag("Subscribe", if stores { "is stored" } else { "is stored though refused" }, stores) {
            (self.signals, self.every) = (wanted.signals, wanted.every);
        }
        if let (Cell::Done(state), None) = (state, refusal) {
            self.set_state(state);
        }
        self.done_or_refused(&wanted.into(), refusal, lacked);
    }

    /// Sends the result of a request; `lacked` is the signal that another law has.
    fn done_or_refused(&mut self, request: &HostMessage, refusal: Option<Outcome>, lacked: Option<usize>) {
        let index = match refusal {
            Some(Outcome::SignalOfOtherLaw) => lacked,
            Some(Outcome::Inconsistent) => {
                Some(if is_too_stiff(&self.values) { DAMPING } else { SPEED_LIMITS[faster(&self.values)] })
            }
            _ => None,
        };
        let outcome = refusal.unwrap_or(Outcome::Accepted);
        self.result_with(request, outcome, index.unwrap_or(0) as u32);
    }

    pub(super) fn arm(&mut self, row: &'static str) {
        let state = cell(&self.at, row);
        let is_idle = self.state() == State::Idle;
        let lacked = self.lacked(self.signals).filter(|_| {
            self.every != 0 || is_idle && self.at.flag("Arm", "checks signals without telemetry", false)
        });
        let is_ambiguous = refused(state).is_none() && longest_gap(&self.at, &self.values) == 0;
        let is_too_stiff = is_too_stiff(&self.values);
        let refusal = self.refusal(
            "Arm",
            ["before session and state", "", "", ""],
            [
                ("session and state", refused(state)),
                ("a gain without damping", is_too_stiff.then_some(Outcome::Inconsistent)),
                ("ambiguous positions", is_ambiguous.then_some(Outcome::Inconsistent)),
                ("a signal that the law lacks", lacked.map(|_| Outcome::SignalOfOtherLaw)),
            ],
        );
        if let (Cell::Done(state), None) = (state, refusal) {
            let mut run = self.run.take().unwrap_or_else(|| Run::new(self.values));
            run.settings = self.values;
            self.first_law = self.first_law.or(Some(whole(self.is_set(CONTROLLER))));
            self.run = Some(run);
            self.set_state(state);
        }
        self.done_or_refused(&Arm { session: 0 }.into(), refusal, lacked);
    }
}

/// Whether the gain contradicts the damping.
pub(super) fn is_too_stiff(values: &Values) -> bool {
    number(values.set[GAIN]) > HIGH_GAIN_NM_RAD && number(values.set[DAMPING]) < LEAST_DAMPING_NM_S_RAD
}
