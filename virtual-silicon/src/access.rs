//! Accesses of the image that the chip would not have served as the image expects.

use std::fmt;

use rigless::session::Session;

use crate::chip::Chip;

/// Accesses that must not occur, one sentence each: none for an image that fits the chip.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Violations(pub Vec<String>);

impl Violations {
    /// Those of a run so far.
    #[must_use]
    pub fn of(session: &Session<Chip>) -> Self {
        let unmapped = session.unmapped().into_iter().map(|access| access.to_string());
        let refused = session.refused().values().map(|fault| format!("refused: {fault}"));
        let unimplemented = session.unimplemented().iter().map(|(address, access)| {
            format!(
                "not modelled: {}.{} at {address:#010x}, {} reads and {} writes, first at pc {:#010x}",
                access.instance, access.register, access.reads, access.writes, access.program_counter
            )
        });
        let undefined = session.undefined().iter().map(|(address, access)| {
            format!(
                "no register: {} at {address:#010x}, first at pc {:#010x}",
                access.instance, access.program_counter
            )
        });
        let unrouted = session
            .unrouted()
            .iter()
            .map(|(instance, line)| format!("interrupt without a line: {instance}, output {line}"));
        let told = session
            .told()
            .map(|told| format!("against the manual: {}.{}, {}", told.instance, told.register, told.reason));
        Self(
            unmapped
                .chain(refused)
                .chain(unimplemented)
                .chain(undefined)
                .chain(unrouted)
                .chain(told)
                .collect(),
        )
    }

    /// Whether a run has any. Cheaper than [`Self::of`].
    #[must_use]
    pub fn are_in(session: &Session<Chip>) -> bool {
        !session.refused().is_empty()
            || !session.unimplemented().is_empty()
            || !session.undefined().is_empty()
            || !session.unrouted().is_empty()
            || session.told().next().is_some()
            || !session.unmapped().is_empty()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

impl fmt::Display for Violations {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(&self.0.join("\n"))
    }
}
