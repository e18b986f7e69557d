//! What a step of HIL mode leaves besides its torque: its row of a capture, and telemetry.

use super::lifecycle::Lifecycle;
use super::machine::Drive;
use super::safety::Violation;
use crate::law::LawSet;

impl<L: LawSet> Drive<L> {
    /// To be called after a control step and before its fault is latched.
    // Never inlined: the values of all signals would take registers from the way to the torque.
    #[inline(never)]
    pub(super) fn observe(&mut self, sequence: u16, fault: Option<&Violation>) {
        let Lifecycle::Running { run, .. } = &self.lifecycle else { return };
        self.scope.step(fault, || run.signals());
        if fault.is_none()
            && self.subscription.is_due(sequence)
            && let Some(telemetry) = self.subscription.telemetry(sequence, &run.signals())
        {
            self.output.send(telemetry);
        }
    }
}
