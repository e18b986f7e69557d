//! Mutants by systematic operators: every decision, number, field, state and message of a drive passes a *site*, and every
//! operator for a value of its type makes a mutant there.

mod sites;
mod value;

use std::collections::BTreeSet;
use std::fmt;

use lashloop_protocol::enums::State;

pub use sites::{Recorder, Sites};
pub use value::{Operator, Value, Width};

/// A site: what it belongs to, and which part of it.
pub type Key = (&'static str, &'static str);

/// When a mutant is wrong. Times count from power-up and `Reset`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum When {
    Always,
    Once,
    /// From the second time on.
    Later,
    /// After this many times.
    After(u32),
    In(State),
    Positive,
    Negative,
}

/// The times of the first operator of a site; the others are always wrong.
const TIMES: [When; 3] = [When::Once, When::Later, When::After(8)];

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mutant {
    pub key: Key,
    pub operator: Operator,
    pub when: When,
}

/// What a mutant remembers of its site.
#[derive(Default)]
pub struct Memory {
    reached: u32,
    previous: Option<Value>,
}

impl Mutant {
    /// Every mutant at a site with values of this type.
    pub fn all_at(key: Key, value: &Value) -> Vec<Self> {
        let operators = value.operators();
        let always = operators.iter().map(|operator| (*operator, When::Always));
        let states = State::ALL.iter().map(|state| When::In(*state));
        let first = operators[0];
        let now_and_then = TIMES.into_iter().chain(states).map(|when| (first, when));
        let signs = [When::Positive, When::Negative];
        let of_one_sign = match value {
            Value::Number { .. } => vec![Operator::Zero, Operator::Scale(2.0)],
            _ => vec![],
        };
        let of_one_sign = of_one_sign.into_iter().flat_map(|operator| signs.map(|sign| (operator, sign)));
        let all = always.chain(now_and_then).chain(of_one_sign);
        all.map(|(operator, when)| Self { key, operator, when }).collect()
    }

    fn apply(&self, memory: &mut Memory, state: State, value: &Value) -> Value {
        let reached = memory.reached;
        memory.reached += 1;
        let acts = match self.when {
            When::Always => true,
            When::Once => reached == 0,
            When::Later => reached > 0,
            When::After(times) => reached >= times,
            When::In(wanted) => state == wanted,
            When::Positive => value.is_negative() == Some(false),
            When::Negative => value.is_negative() == Some(true),
        };
        let mutated =
            if acts { value.mutated(self.operator, memory.previous.as_ref()) } else { value.clone() };
        memory.previous = Some(value.clone());
        mutated
    }
}

impl fmt::Display for Mutant {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { key: (site, part), operator, when } = self;
        write!(out, "{site} | {part} | {operator:?} {when:?}")
    }
}

/// The checks in which a mutant has an effect.
pub type Checks = BTreeSet<usize>;
