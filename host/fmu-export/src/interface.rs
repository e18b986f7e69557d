//! The variables of an FMU and what it can do.

use std::ops::Range;

use crate::variable::{Role, Value, Variable};

/// The variables of an FMU and what it can do.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Interface {
    /// Time, inputs, outputs, parameters.
    pub(crate) variables: Vec<Variable>,
    pub(crate) inputs: Range<usize>,
    pub(crate) outputs: Range<usize>,
    /// Whether it takes steps that aren't multiples of the control period.
    pub(crate) takes_any_step: bool,
    pub(crate) can_be_saved: bool,
}

impl Interface {
    pub(crate) fn new(inputs: Vec<Variable>, outputs: Vec<Variable>, parameters: Vec<Variable>) -> Self {
        let time = Variable::new(Role::Time, "time", "s", Value::Real(0.0), "Time of the simulation");
        let inputs_end = 1 + inputs.len();
        let outputs_end = inputs_end + outputs.len();
        Self {
            variables: [time].into_iter().chain(inputs).chain(outputs).chain(parameters).collect(),
            inputs: 1..inputs_end,
            outputs: inputs_end..outputs_end,
            takes_any_step: false,
            can_be_saved: false,
        }
    }
}
