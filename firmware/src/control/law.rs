//! The choice of a control law at run time.

use crate::control::faithful::{Faithful, FaithfulState};
use crate::control::literal::{Literal, LiteralState};
use crate::control::pd::Pd;
use crate::control::{ControlOutput, Controller, Measurement, Real};

/// Any of the control laws.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Law<F> {
    /// The cascade before compensation.
    Pd(Pd<F>),
    /// The cascade after compensation, in the reading that meets the paper's figures.
    Faithful(Faithful<F>),
    /// The cascade after compensation, as printed.
    Literal(Literal<F>),
}

/// The state of any of the control laws.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LawState<F> {
    /// [`Pd`] remembers nothing.
    Pd,
    /// State of [`Faithful`].
    Faithful(FaithfulState<F>),
    /// State of [`Literal`].
    Literal(LiteralState<F>),
}

impl<F: Real> Controller<F> for Law<F> {
    type State = LawState<F>;

    fn initial_state(&self) -> Self::State {
        match self {
            Self::Pd(_) => LawState::Pd,
            Self::Faithful(law) => LawState::Faithful(law.initial_state()),
            Self::Literal(law) => LawState::Literal(law.initial_state()),
        }
    }

    /// One sample. The state of another law is replaced by this one's initial state first: after a change of law
    /// nothing the old one remembered has a meaning for the new one.
    fn step(&self, state: &mut Self::State, measurement: &Measurement<F>) -> ControlOutput<F> {
        match (self, state) {
            (Self::Pd(law), LawState::Pd) => law.step(&mut (), measurement),
            (Self::Faithful(law), LawState::Faithful(state)) => law.step(state, measurement),
            (Self::Literal(law), LawState::Literal(state)) => law.step(state, measurement),
            (_, foreign) => {
                *foreign = self.initial_state();
                self.step(foreign, measurement)
            }
        }
    }
}
