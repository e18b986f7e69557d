//! Which of two lines a drive serves: its serial line or its USB port.
//!
//! A drive has one session. Its answers go to the line of the last bytes that it took. During a run the other line is
//! ignored: noise on an open USART, or a second host, can't disturb it. The watchdog ends a run whose host sends nothing, so no
//! line stays bound.

use lashloop_protocol::enums::State;

/// A line to a host.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Line {
    /// The serial line.
    Usart,
    /// The USB port.
    Usb,
}

/// The line that a drive serves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LineSelection {
    served: Line,
}

impl Default for LineSelection {
    /// The USART, which needs no enumeration: the log lines of the start go there.
    fn default() -> Self {
        Self { served: Line::Usart }
    }
}

impl LineSelection {
    /// The line that the drive's output goes to.
    #[must_use]
    pub fn served(self) -> Line {
        self.served
    }

    /// Whether the drive, in this state, takes bytes that have arrived on `line`. Bytes that it doesn't take are discarded.
    pub fn admits(&mut self, line: Line, state: State) -> bool {
        if state != State::Running {
            self.served = line;
        }
        self.served == line
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_of_the_last_bytes_is_served() {
        let mut selection = LineSelection::default();
        assert_eq!(selection.served(), Line::Usart);
        for state in [State::Boot, State::Idle, State::Armed, State::Faulted] {
            for line in [Line::Usb, Line::Usart] {
                assert!(selection.admits(line, state), "{line:?} in {state:?}");
                assert_eq!(selection.served(), line);
            }
        }
    }

    #[test]
    fn a_second_host_is_ignored_during_a_run() {
        let mut selection = LineSelection::default();
        assert!(selection.admits(Line::Usb, State::Armed));
        assert!(!selection.admits(Line::Usart, State::Running));
        assert!(selection.admits(Line::Usb, State::Running));
        assert!(selection.admits(Line::Usart, State::Faulted));
    }
}
